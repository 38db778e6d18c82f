"""What masses and springs can be chosen for: one entry a goal."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from paminsa_viz.balancing.changes import MASS
from paminsa_viz.balancing.convex import ConvexTerm, MaxAbs, PositivePartSum
from paminsa_viz.balancing.terms import GROUP
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arrays import Array
from paminsa_viz.synthesis.inner_space import InnerSpace
from paminsa_viz.trajectory.integrals import time_weights
from paminsa_viz.trajectory.solved import SolvedTrajectory

MotionRows = tuple[SolvedTrajectory, Array, Array]
"""A solved motion with its torques as matrix . s + offset, see `inner_space.motion_rows`."""


def peak_term(motions: Sequence[MotionRows], actuators: tuple[int, ...]) -> ConvexTerm:
    """Return the largest torque, in size, of some actuators (0 to 3) on motions [N m, N]."""
    # samples of one actuator stay neighbors, so that a part of the list is a part of time
    rows = [m[:, j] for _, m, _ in motions for j in actuators]
    offsets = [b[:, j] for _, _, b in motions for j in actuators]
    return MaxAbs(np.concatenate(rows), np.concatenate(offsets))


def energy_term(motions: Sequence[MotionRows]) -> ConvexTerm:
    """Return the energy that all four actuators put in on motions; braking gives none back [J]."""
    rows, offsets, starts, first = [], [], [], 0
    for solved, matrix, offset in motions:
        weight = time_weights(solved.trajectory.t)[:, None] * solved.speed
        for j in range(4):
            rows.append(matrix[:, j] * weight[:, j, None])
            offsets.append(offset[:, j] * weight[:, j])
            starts.append(np.arange(first, first + len(weight), GROUP))
            first += len(weight)
    return PositivePartSum(np.concatenate(rows), np.concatenate(offsets), np.concatenate(starts))


def _moving_mass(space: InnerSpace, motions: Sequence[MotionRows]) -> ConvexTerm:
    del motions
    row = np.eye(1, len(space.start), MASS)
    return MaxAbs(row, np.array([-space.design.payload.mass]), absolute=False)


@dataclass(frozen=True)
class InnerGoal:
    """A convex measure of a robot of given lengths.

    Attributes:
        key: Its name.
        label: The same in words.
        unit: Its SI unit.
        needs_motion: Whether it is one of motions.
        term: ``term(space, motions)`` as a function of the program's state.
    """

    key: str
    label: str
    unit: str
    needs_motion: bool
    term: Callable[[InnerSpace, Sequence[MotionRows]], ConvexTerm]


GOALS: dict[str, InnerGoal] = {
    goal.key: goal
    for goal in (
        InnerGoal(
            "peak_torque", "peak torque of M1-M3 on the motions", "N m", True,
            lambda space, motions: peak_term(motions, (0, 1, 2)),
        ),
        InnerGoal(
            "energy", "driving energy on the motions", "J", True,
            lambda space, motions: energy_term(motions),
        ),
        InnerGoal("moving_mass", "moving mass without payload", "kg", False, _moving_mass),
    )
}  # fmt: skip
"""Goals by key."""

_STATIC = (
    "the static torque of M1..M3 is no goal where masses or springs are free: M_p2 = 0, or a "
    "spring that does the same, makes it zero at every pose, whatever the lengths"
)


def find_goal(key: str, *, free: bool, motions: int) -> InnerGoal:
    """Return a goal.

    Args:
        key: Its key.
        free: Whether masses or springs are free.
        motions: How many motions there are.

    Raises:
        InvalidInput: If there is no such goal, or it makes no sense here.
    """
    if key in ("static_torque", "max_torque", "rms_torque") and free:
        raise InvalidInput("goal", f"{_STATIC}; choose {', '.join(GOALS)}")
    goal = GOALS.get(key)
    if goal is None:
        raise InvalidInput("goal", f"{', '.join(GOALS)} are known, not {key!r}")
    if goal.needs_motion and not motions:
        raise InvalidInput("motions", f"the {goal.label} needs at least one motion")
    return goal
