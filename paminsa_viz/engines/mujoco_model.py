"""The robot in MuJoCo (Google DeepMind), loaded from the very MJCF text that is exported.

`MujocoRobot` has exact inverse dynamics. `play` simulates forward, the softer of two comparisons:
MuJoCo holds the loops together with stiff springs and steps in time, so its motion differs from the
exact one; and the robot is open-loop unstable, so that any difference grows. The result therefore
comes with the gaps of the loops.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cached_property
from typing import Any, NamedTuple
from xml.etree import ElementTree

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.balancing import Anchor, Spring
from paminsa_viz.engines.closed_loop import ClosedLoopRobot
from paminsa_viz.engines.mechanism import PLATFORM, leg_name
from paminsa_viz.engines.missing import EngineMissing
from paminsa_viz.engines.mjcf import mjcf_text
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array, as_numbers
from paminsa_viz.model.design import Design
from paminsa_viz.model.kinematics import leg_states
from paminsa_viz.model.load import LoadFrame
from paminsa_viz.model.reach import home_pose
from paminsa_viz.model.robot import AXIS_X, AXIS_Y


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


def compiled_model(text: str, argument: str = "design") -> Any:
    """Return MuJoCo's model of an MJCF text.

    Args:
        text: The text.
        argument: What it was made from or given as, for the error.

    Raises:
        EngineMissing: If MuJoCo is not installed.
        InvalidInput: If MuJoCo cannot use the text.
    """
    try:
        return load_mujoco().MjModel.from_xml_string(text)
    except ValueError as error:
        reason = " ".join(str(error).split())
        raise InvalidInput(argument, f"MuJoCo cannot use it: {reason}") from error


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
            InvalidInput: If the given text is another robot's, or MuJoCo cannot use the text.
            UnreachablePose: If the design cannot be in its start pose.
        """
        super().__init__(design)
        self._mujoco = mujoco = load_mujoco()
        model = compiled_model(mjcf_text(design)) if xml is None else compiled_model(xml, "model")
        self.model = model
        model.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
        self.data = mujoco.MjData(model)
        self._set_order(model.joint(index).name for index in range(model.njnt))

    @cached_property
    def _platform(self) -> int:
        """Number of the platform's body, which only a load needs."""
        return int(self.model.body(PLATFORM).id)

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
        data, load, body = self.data, self.design.load, self._platform
        turn = data.xmat[body].reshape(3, 3)
        force, moment = np.asarray(wrench[:3]), np.asarray(wrench[3:])
        if load.frame is LoadFrame.PLATFORM:
            force, moment = turn @ force, turn @ moment
        arm = data.xpos[body] + turn @ np.array(load.point) - data.xipos[body]
        data.xfrc_applied[body] = [*force, *(moment + np.cross(arm, force))]

    def _acceleration(self, site: int) -> Array:
        """Acceleration of a site (3,) in world axes; not by ``mj_jacDot``, wrong before 3.3.1."""
        found = np.empty(6)
        kind = self._mujoco.mjtObj.mjOBJ_SITE
        self._mujoco.mj_objectAcceleration(self.model, self.data, kind, site, found, 0)
        return found[3:]


class Played(NamedTuple):
    """A simulated motion.

    Attributes:
        poses: Platform poses (n, 4) at the given times [m, m, rad, m]; NaN after it was stopped.
        drift: Poses minus the wanted ones (n, 4).
        stray: How far a joint 5 is from where it should be, at most (n,) [m].
        gap: Largest opening of any loop at the given times (n,) [m].
        until: Number of times before it was stopped or went out of bounds; n if neither.
    """

    poses: Array
    drift: Array
    stray: Array
    gap: Array
    until: int


@of_design
def play(
    design: Design,
    times: ArrayLike,
    poses: ArrayLike,
    velocities: ArrayLike,
    torques: ArrayLike,
    *,
    step: float = 1e-4,
    limit: float = math.inf,
    loads: ArrayLike | None = None,
) -> Played:
    """Let the robot move under actuator forces alone, from the first state of a motion.

    Args:
        design: The robot.
        times: Times (n,), increasing [s].
        poses: Wanted platform poses (n, 4); the simulation starts at the first one.
        velocities: Wanted rates of the pose (n, 4); the simulation starts with the first one.
        torques: Actuator forces (n, 4) [N m, N m, N m, N], linear in between.
        step: Longest time step; it also sets how stiff the loops are [s].
        limit: Stop once the platform strays by more [m]: the robot is unstable, and the further it
            is off, the less its motion says.
        loads: Wrenches (n, 6) on top of the design's load, linear in between [N, N m].

    Raises:
        EngineMissing: If MuJoCo is not installed.
        InvalidInput: If shapes do not match or times do not increase.
        UnreachablePose: If the first pose has no configuration.
    """
    t = as_numbers(times, "times")
    wanted, u = as_numbers(poses, "poses"), as_numbers(velocities, "velocities")
    force = as_numbers(torques, "torques")
    for name, array in (("poses", wanted), ("velocities", u), ("torques", force)):
        if array.shape != (t.size, 4):
            raise InvalidInput(name, f"shape {array.shape} where {(t.size, 4)} is needed")
    if t.ndim != 1 or t.size < 1 or not np.all(np.diff(t) > 0):
        raise InvalidInput("times", "increasing numbers are needed")
    mujoco = load_mujoco()
    robot = MujocoRobot(design, xml=mjcf_text(design, pose=wanted[0].tolist()))
    model, data = robot.model, robot.data
    model.eq_solref[:] = (2 * step, 1)
    data.qpos[:], data.qvel[:] = robot.state(wanted[0], u[0])
    wrench = np.array(design.load.wrench) + np.zeros((t.size, 6))
    if loads is not None:
        wrench = wrench + as_numbers(loads, "loads")
    pushed = bool(wrench.any())
    found, gap = np.full_like(wanted, np.nan), np.full(t.size, np.nan)
    stray, until = np.full(t.size, np.nan), 0
    for index, now in enumerate(t):
        if index:
            before = t[index - 1]
            count = max(1, int(np.ceil((now - before) / step - 1e-9)))
            model.opt.timestep = (now - before) / count
            for part in (np.arange(count) + 0.5) / count:
                data.ctrl[:] = (1 - part) * force[index - 1] + part * force[index]
                if pushed:
                    mujoco.mj_kinematics(model, data)
                    robot.push((1 - part) * wrench[index - 1] + part * wrench[index])
                mujoco.mj_step(model, data)
        mujoco.mj_fwdPosition(model, data)
        pose = robot.pose(data.qpos)
        off = _stray(pose - wanted[index], design.geometry.platform_radius)
        # After a warning it has started over by itself.
        if not np.isfinite(off) or np.any(data.warning.number):
            break
        found[index], stray[index] = pose, off
        gap[index] = np.abs(data.efc_pos).max()
        until = index + 1
        if off > limit:
            break
    return Played(found, found - wanted, stray, gap, until)


def _stray(drift: Array, radius: float) -> float:
    """Return how far points at a radius of a platform are off at most [m]; drift (4,) of a pose."""
    return float(np.linalg.norm(drift[[0, 1, 3]]) + radius * abs(drift[2]))


# ------------------------------------------------------------------------------------- with springs


class SprungMujocoRobot(MujocoRobot):
    """The robot in MuJoCo with springs on every leg; none of their formulas is used.

    Each anchor is a site, fixed to its link where it is at one pose; MuJoCo has the springs' forces
    from the distances of the sites.
    """

    def __init__(self, design: Design, springs: Sequence[Spring]) -> None:
        """Build MuJoCo's model.

        Args:
            design: The robot.
            springs: The springs of each leg.

        Raises:
            EngineMissing: If MuJoCo is not installed.
            InvalidDesign: If a bar's inertias belong to no rigid body.
            UnreachablePose: If the design cannot be in its start pose.
        """
        plain = MujocoRobot(design)
        pose = np.array(home_pose(design.geometry))
        q, _ = plain.state(pose, np.zeros(4))
        plain.data.qpos[:] = q
        load_mujoco().mj_fwdPosition(plain.model, plain.data)
        root = ElementTree.fromstring(mjcf_text(design))
        bodies = {body.get("name"): body for body in root.iter("body")}
        tendons = ElementTree.SubElement(root, "tendon")
        for number, spring in enumerate(springs):
            for leg in range(3):
                tendon = ElementTree.SubElement(
                    tendons, "spatial", name=f"spring{number}_{leg}",
                    stiffness=repr(spring.stiffness),
                    springlength=f"{spring.free_length!r} {spring.free_length!r}",
                )  # fmt: skip
                for end, anchor in (("a", spring.first), ("b", spring.second)):
                    body = leg_name(leg, _link(anchor))
                    frame = plain.data.body(body)
                    offset = _place(design, anchor, pose, leg) - frame.xpos
                    local = frame.xmat.reshape(3, 3).T @ offset
                    site = f"spring{number}_{leg}{end}"
                    at = " ".join(map(repr, local.tolist()))
                    ElementTree.SubElement(bodies[body], "site", name=site, pos=at)
                    ElementTree.SubElement(tendon, "site", site=site)
        super().__init__(design, xml=ElementTree.tostring(root, encoding="unicode"))

    def _bias(self, q: Array, v: Array, wrench: Array | None) -> tuple[Array, Array]:
        drift, bias = super()._bias(q, v, wrench)
        return drift, bias - self.data.qfrc_passive


def _link(anchor: Anchor) -> str:
    """Return the link that an anchor is fixed to."""
    if anchor.kind == "joint":
        return "slider" if anchor.joint == 8 else f"joint{anchor.joint}"
    return {"bar": anchor.bar.upper(), "guide": "B10", "slider": "slider"}[anchor.kind]


def _place(design: Design, anchor: Anchor, pose: Array, leg: int) -> Array:
    """Return where an anchor of a leg is at a pose (4,), (3,) [m]."""
    g, still = design.geometry, np.zeros(4)
    legs = leg_states(g, pose, still, still)[0]
    w = anchor.weights(g)
    out = w.r5 * legs.rho[leg] + w.r9 * legs.r9[leg] + w.r0
    up = w.z5 * legs.zeta[0] + w.r9 * legs.z9[leg] + w.z0
    axis = g.base_radius * np.array([AXIS_X[leg], AXIS_Y[leg]])
    x, y = axis + out * np.array([legs.ux[leg], legs.uy[leg]])
    return np.array([x, y, up])
