"""The robot in Pinocchio (INRIA, LAAS), built joint by joint from the mechanism."""

from __future__ import annotations

from typing import Any

import numpy as np

from paminsa_viz.engines.closed_loop import ClosedLoopRobot
from paminsa_viz.engines.mechanism import PLATFORM, Link, Point
from paminsa_viz.engines.missing import EngineMissing
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.load import LoadFrame


def load_pinocchio() -> Any:
    """Import Pinocchio.

    Raises:
        EngineMissing: If it is not installed or does not load.
    """
    try:
        import pinocchio
    except ImportError as error:
        raise EngineMissing("Pinocchio", error) from error
    # A package called pinocchio that is another project's (a plug-in for nose) has no Model.
    if not hasattr(pinocchio, "Model"):
        raise EngineMissing("Pinocchio")
    return pinocchio


class PinocchioRobot(ClosedLoopRobot):
    """The robot in Pinocchio.

    Attributes:
        model: The ``pinocchio.Model`` of the open tree; every closure is a pair of frames in it.
        data: The ``pinocchio.Data`` that the computations use.
    """

    def __init__(self, design: Design) -> None:
        """Build the model.

        Raises:
            EngineMissing: If Pinocchio is not installed.
            InvalidDesign: If a bar's inertias belong to no rigid body.
        """
        super().__init__(design)
        self._pin = pin = load_pinocchio()
        self.model = model = pin.Model()
        model.name = "PAMINSA"
        model.gravity.linear = np.array([0.0, 0.0, -design.gravity])
        carriers: dict[str | None, int] = {None: 0}
        for link in self.mechanism.links:
            carriers[link.name] = self._add_link(link, carriers[link.parent])
        self._platform = carriers[PLATFORM]
        self._pins = [
            (
                self._add_frame(f"{p.name}_a", carriers[p.first], p.first_point),
                self._add_frame(f"{p.name}_b", carriers[p.second], p.second_point),
            )
            for p in self.mechanism.pins
        ]
        for joint, drive in zip(self.mechanism.actuated, self.mechanism.drives, strict=True):
            if drive is not None:
                index = model.joints[model.getJointId(joint)].idx_v
                model.rotorInertia[index] = drive.inertia
                model.rotorGearRatio[index] = drive.ratio
        # What Pinocchio's algorithms use; the two above are only kept by it.
        model.armature[:] = model.rotorInertia * np.square(model.rotorGearRatio)
        self.data = model.createData()
        self._set_order(list(model.names)[1:])

    def _add_link(self, link: Link, carrier: int) -> int:
        """Add a link's joints and masses; return the index of its last joint, which carries it."""
        pin, model = self._pin, self.model
        kinds = {
            "hinge": pin.JointModelRevoluteUnaligned,
            "slide": pin.JointModelPrismaticUnaligned,
        }
        place = pin.SE3(pin.utils.rotate("z", link.heading), np.asarray(link.place, float))
        for joint in link.joints:
            kind = kinds[joint.kind](np.asarray(joint.axis, float))
            carrier = model.addJoint(carrier, kind, place, joint.name)
            place = pin.SE3.Identity()
        for part in link.parts:
            inertia = pin.Inertia(
                part.mass, np.asarray(part.center, float), np.diag(part.inertia).astype(float)
            )
            model.appendBodyToJoint(carrier, inertia, pin.SE3.Identity())
        return int(carrier)

    def _add_frame(self, name: str, carrier: int, point: Point) -> int:
        pin, model = self._pin, self.model
        place = pin.SE3(np.eye(3), np.asarray(point, float))
        frame = pin.Frame(name, carrier, 0, place, pin.FrameType.OP_FRAME)
        return int(model.addFrame(frame))

    def _tree(self, q: Array) -> tuple[Array, Array]:
        pin, model, data = self._pin, self.model, self.data
        upper = np.triu(pin.crba(model, data, q))
        mass = upper + np.triu(upper, 1).T
        pin.computeJointJacobians(model, data, q)
        pin.updateFramePlacements(model, data)
        axes = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        rows = []
        for first, second in self._pins:
            one = pin.getFrameJacobian(model, data, first, axes)[:3]
            rows.append(one - pin.getFrameJacobian(model, data, second, axes)[:3])
        return np.concatenate(rows), mass

    def _bias(self, q: Array, v: Array, wrench: Array | None) -> tuple[Array, Array]:
        pin, model, data = self._pin, self.model, self.data
        if wrench is None:
            bias = np.array(pin.nonLinearEffects(model, data, q, v))
        else:
            still, forces = np.zeros(model.nv), self._external_forces(q, wrench)
            bias = np.array(pin.rnea(model, data, q, v, still, forces))
        pin.forwardKinematics(model, data, q, v, np.zeros(model.nv))
        axes = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        drift = []
        for first, second in self._pins:
            one = pin.getFrameClassicalAcceleration(model, data, first, axes).linear
            drift.append(one - pin.getFrameClassicalAcceleration(model, data, second, axes).linear)
        return np.concatenate(drift), bias

    def _external_forces(self, q: Array, wrench: Array) -> Any:
        """Return a wrench (6,) on the platform as Pinocchio takes it: in the frames of joints."""
        pin, load = self._pin, self.design.load
        pin.forwardKinematics(self.model, self.data, q)
        force, moment = wrench[:3], wrench[3:]
        if load.frame is LoadFrame.WORLD:
            turn = self.data.oMi[self._platform].rotation.T
            force, moment = turn @ force, turn @ moment
        forces = pin.StdVec_Force()
        for index in range(self.model.njoints):
            on_platform = index == self._platform
            forces.append(
                pin.Force(force, moment + np.cross(load.point, force))
                if on_platform
                else pin.Force.Zero()
            )
        return forces
