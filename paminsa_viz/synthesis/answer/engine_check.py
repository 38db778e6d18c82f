"""A design's requirements checked by MuJoCo, where they have a meaning there: torques and forces.

MuJoCo has the masses, the loops and, as tendons, the springs; none of the formulas is used. Joint
friction is left out on both sides, see `engines.verification`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from paminsa_viz.balancing import spring_torques
from paminsa_viz.engines.mujoco_model import SprungMujocoRobot, load_mujoco
from paminsa_viz.engines.verification import TOLERANCE, Comparison, torque_scale
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arrays import Array, as_vectors
from paminsa_viz.model.design import Design
from paminsa_viz.model.dynamics import inverse_dynamics
from paminsa_viz.model.parameters import BAR_ENDS
from paminsa_viz.model.statics import static_torques
from paminsa_viz.synthesis.answer.checks import AnswerMargins
from paminsa_viz.synthesis.masses.space import ACTUATORS_OF, bound_margins, within

POSES = 60
"""Poses of the workspace that are compared, besides the worst of each requirement."""

WORST = 5
"""Poses of each requirement at which it is nearest to its bound."""

ACCEPTED = 1e-6
"""By how much of itself (or of 1) a bound may be broken: what the formulas may differ by."""


@dataclass(frozen=True)
class MujocoRow:
    """One requirement, by the formulas and by the engine.

    Attributes:
        label: What is required, in words.
        unit: Its SI unit.
        poses: Poses or samples at which it was compared.
        computed, engine: Least margins to the bound, negative where it is broken [SI].
        met: Whether the engine says so, within `ACCEPTED`.
    """

    label: str
    unit: str
    poses: int
    computed: float
    engine: float
    met: bool


@dataclass(frozen=True, eq=False)
class MujocoCheck:
    """What MuJoCo says of a design's requirements.

    Attributes:
        version: MuJoCo's version.
        rows: Requirements that mean something to MuJoCo.
        left_out: Keys of those that mean nothing to it.
        difference: Largest difference of a torque over the largest of its actuator.
    """

    version: str
    rows: tuple[MujocoRow, ...]
    left_out: tuple[str, ...]
    difference: float

    @property
    def passed(self) -> bool:
        """Whether torques agree and all bounds are met."""
        return self.difference <= TOLERANCE and all(row.met for row in self.rows)


def check_by_mujoco(
    design: Design,
    asked: AnswerMargins,
    pose: Array | None = None,
    *,
    count: int = POSES,
) -> MujocoCheck:
    """Compare a design's torques with MuJoCo's, and check the bounds on them by MuJoCo's.

    Args:
        design: The robot.
        asked: Its requirements, of which those on torques and forces are checked, with its springs
            and motions.
        pose: (n, 4) poses of the workspace, of which ``count`` random ones and the worst of each
            bound are taken [m, m, rad, m]; None for those of ``asked``.
        count: Random poses.

    Raises:
        EngineMissing: If MuJoCo is not installed.
        InvalidDesign: If there are motions, and a bar's inertias belong to no rigid body.
        InvalidInput: If there is no pose, or one is out of reach.
    """
    design, springs = design.without_friction(), asked.springs
    pose = asked.poses() if pose is None else as_vectors(pose, "pose").reshape(-1, 4)
    held = static_torques(design, pose) + spring_torques(design.geometry, springs, pose)
    if not (len(pose) and np.isfinite(held).all()):
        raise InvalidInput("pose", "at least one pose, and none out of reach, is needed")
    bounds = asked.requirements.bounds
    checked = [bound for bound in bounds if bound.quantity in ACTUATORS_OF]
    rng = np.random.default_rng(0)
    chosen = {int(i) for i in rng.permutation(len(pose))[:count]}
    for bound in checked:
        inside = within(bound, pose)
        order = inside[np.argsort(bound_margins(bound, held[inside]), kind="stable")]
        chosen |= set(order[:WORST].tolist())
    index = np.array(sorted(chosen), np.intp)
    robot = SprungMujocoRobot(design if asked.motions else _at_rest(design), springs)
    found = robot.static_torques(pose[index])
    compared = [Comparison(held[index], found, torque_scale(design, pose[index], found))]
    rows = []
    for bound in checked:
        at = within(bound, pose[index])
        if len(at):
            ours, engine = (bound_margins(bound, t[at]).min() for t in (held[index], found))
            limit = next(b for b in (bound.high, bound.low) if b is not None)
            rows.append(_row(bound.entry.title, bound.entry.unit, len(at), ours, engine, limit))
    for motion in asked.motions:
        states = motion.pose, motion.velocity, motion.acceleration
        more = spring_torques(design.geometry, springs, motion.pose)
        computed = inverse_dynamics(design, *states, load=motion.load).torque + more
        reference = robot.inverse_dynamics(*states, load=motion.load)
        scale = torque_scale(design, motion.pose, reference)
        compared.append(Comparison(computed, reference, scale))
        margins = (asked.motion_margins(motion, torque) for torque in (computed, reference))
        for (label, unit, limit, ours), (*_, engine) in zip(*margins, strict=True):
            rows.append(_row(label, unit, motion.size, ours, engine, limit))
    return MujocoCheck(
        load_mujoco().__version__,
        tuple(rows),
        tuple(dict.fromkeys(b.quantity for b in bounds if b.quantity not in ACTUATORS_OF)),
        float(np.max([one.relative for one in compared])),
    )


def _at_rest(design: Design) -> Design:
    """Return a design with inertias that a rigid body can have; none of them counts at rest.

    Bars that are short for their mass by `resized` may have too much about their own axis.
    """
    numbers: dict[str, float | None] = {}
    for bar in BAR_ENDS:
        axial, transverse = (f"inertias.{bar}_{axis}" for axis in ("axial", "transverse"))
        numbers[axial] = min(design.value(axial), 1.9 * design.value(transverse))
    return design.vary(numbers)


def _row(
    label: str, unit: str, poses: int, computed: float, engine: float, limit: float
) -> MujocoRow:
    met = engine >= -ACCEPTED * max(1.0, abs(limit))
    return MujocoRow(label, unit, poses, float(computed), float(engine), bool(met))
