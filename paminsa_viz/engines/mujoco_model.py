"""The robot in MuJoCo (Google DeepMind), loaded from the very MJCF text that is exported."""

from __future__ import annotations

from typing import Any

import numpy as np

from paminsa_viz.engines import EngineMissing
from paminsa_viz.engines.closed_loop import ClosedLoopRobot
from paminsa_viz.engines.mechanism import PLATFORM
from paminsa_viz.engines.mjcf import mjcf_text
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.load import LoadFrame


def load_mujoco() -> Any:
    """Import MuJoCo.

    Raises:
        EngineMissing: If it is not installed or does not load.
    """
    try:
        import mujoco
    except ImportError as error:
        raise EngineMissing("MuJoCo", error) from error
    return mujoco


class MujocoRobot(ClosedLoopRobot):
    """The robot in MuJoCo.

    Attributes:
        model: The compiled ``mujoco.MjModel``.
        data: The ``mujoco.MjData`` that the computations use.
    """

    def __init__(self, design: Design, *, xml: str | None = None) -> None:
        """Build the model.

        Args:
            design: The robot.
            xml: Load this text instead of the design's own: an exported model, possibly changed.
                Joints and closures are found by their names.

        Raises:
            EngineMissing: If MuJoCo is not installed.
            InvalidDesign: If a bar's inertias belong to no rigid body.
            InvalidInput: If the given text is another robot's.
            UnreachablePose: If the design cannot be in its start pose.
            ValueError: If MuJoCo cannot read the text.
        """
        super().__init__(design)
        self._mujoco = mujoco = load_mujoco()
        text = mjcf_text(design) if xml is None else xml
        self.model = model = mujoco.MjModel.from_xml_string(text)
        model.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
        self.data = mujoco.MjData(model)
        self._set_order(model.joint(index).name for index in range(model.njnt))

    def _tree(self, q: Array) -> tuple[Array, Array]:
        mujoco, model, data = self._mujoco, self.model, self.data
        data.qpos[:] = q
        mujoco.mj_fwdPosition(model, data)
        mass = np.empty((model.nv, model.nv))
        for row, unit in zip(mass, np.eye(model.nv), strict=True):
            mujoco.mj_mulM(model, data, row, unit)
        rows = data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY
        return data.efc_J.reshape(-1, model.nv)[rows], mass

    def _bias(self, q: Array, v: Array, wrench: Array | None) -> tuple[Array, Array]:
        mujoco, model, data = self._mujoco, self.model, self.data
        data.qpos[:] = q
        data.qvel[:] = v
        data.qacc[:] = 0.0
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_fwdVelocity(model, data)
        # What the sites accelerate by when no joint does; gravity is in both and drops out.
        mujoco.mj_rnePostConstraint(model, data)
        drift = [
            self._acceleration(first) - self._acceleration(second)
            for first, second in zip(model.eq_obj1id, model.eq_obj2id, strict=True)
        ]
        bias = data.qfrc_bias.copy()
        if wrench is not None:
            self.push(wrench)
            mujoco.mj_fwdAcceleration(model, data)
            # All forces on the joints but the closures': the bias and what was applied.
            bias = data.qfrc_passive + data.qfrc_applied + data.qfrc_actuator - data.qfrc_smooth
        return np.concatenate(drift), bias

    def push(self, wrench: Array) -> None:
        """Set ``xfrc_applied`` of the platform to a wrench (6,) at the load's point [N, N m].

        The platform is where ``data`` has it; the wrench is in the load's directions.
        """
        data, load = self.data, self.design.load
        body = self.model.body(PLATFORM).id
        turn = data.xmat[body].reshape(3, 3)
        force, moment = np.asarray(wrench[:3]), np.asarray(wrench[3:])
        if load.frame is LoadFrame.PLATFORM:
            force, moment = turn @ force, turn @ moment
        arm = data.xpos[body] + turn @ np.array(load.point) - data.xipos[body]
        data.xfrc_applied[body] = [*force, *(moment + np.cross(arm, force))]

    def _acceleration(self, site: int) -> Array:
        """Linear acceleration of a site (3,) in world axes; not `mj_jacDot`, wrong before 3.3.1."""
        found = np.empty(6)
        kind = self._mujoco.mjtObj.mjOBJ_SITE
        self._mujoco.mj_objectAcceleration(self.model, self.data, kind, site, found, 0)
        return found[3:]
