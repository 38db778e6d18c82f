"""Masses, counterweights and springs of a robot of given lengths as the state of one program.

The state is that of `balancing.changes.MassSpace`, then K [N/m] and K L [N] of each spring. Torques
at rest and in motion are linear in it, so that their bounds and peaks are convex.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.balancing import Changes, Spring, SpringPlace
from paminsa_viz.balancing.changes import MassSpace, mass_space
from paminsa_viz.balancing.convex import ConvexTerm, MaxAbs
from paminsa_viz.balancing.program import Levers
from paminsa_viz.balancing.springs import spring_variable, springs_of, unit_spring_torques
from paminsa_viz.balancing.terms import MP1, MP2, MP3, PLATFORM, trajectory_rows
from paminsa_viz.errors import InvalidInput, PaminsaError
from paminsa_viz.model import backend
from paminsa_viz.model.arrays import Array, as_vectors
from paminsa_viz.model.design import Design, Geometry
from paminsa_viz.model.jacobians import inverse_jacobian
from paminsa_viz.model.leg import mechanism
from paminsa_viz.model.lumped import Misprint
from paminsa_viz.model.reach import LEAST_MARGIN, Limit, decode
from paminsa_viz.model.regressor import torque_regressor
from paminsa_viz.model.singularity import type2_distances
from paminsa_viz.model.statics import load_torques, unit_torques
from paminsa_viz.quantities.requirements import Requirement
from paminsa_viz.trajectory.check import PathCheck, PathEvent
from paminsa_viz.trajectory.sampled import Trajectory
from paminsa_viz.trajectory.solved import SolvedTrajectory

ACTUATORS_OF: dict[str, tuple[int, ...]] = {
    "tau_1": (0,), "tau_2": (1,), "tau_3": (2,), "max_torque": (0, 1, 2), "f_4": (3,),
}  # fmt: skip
"""Quantities that are linear in masses and springs at every pose, and their actuators."""

ALL = (0, 1, 2, 3)
"""M1..M4."""


@dataclass(frozen=True, eq=False)
class InnerSpace(MassSpace):
    """A `MassSpace` with springs.

    Attributes:
        springs: Places of springs; their K and K L are the last entries of the state.
    """

    springs: tuple[SpringPlace, ...]

    @property
    def first_spring(self) -> int:
        """Where K of the first spring is in the state."""
        return len(self.start) - 2 * len(self.springs)

    def design_of(self, levers: Levers) -> Design:
        """See `MassSpace`; the springs are no part of a design."""
        return super().design_of(levers[: len(levers) - len(self.springs)])

    def springs_of(self, state: Array) -> tuple[Spring, ...]:
        """Return the springs for a state, in the order of their places."""
        return springs_of(self.springs, state[self.first_spring :])


def inner_space(design: Design, changes: Changes, springs: Sequence[SpringPlace]) -> InnerSpace:
    """Return what changes of masses and springs can make of a design.

    Raises:
        InvalidInput: If a path is not that of a mass.
    """
    space = mass_space(design, changes)
    first = len(space.start)
    size = first + 2 * len(springs)
    own = [
        replace(v, effect=np.pad(v.effect, ((0, 0), (0, size - first)))) for v in space.variables
    ]
    more = [spring_variable(place, first + 2 * i, size) for i, place in enumerate(springs)]
    return InnerSpace(
        design, changes, np.pad(space.start, (0, size - first)), (*own, *more),
        np.pad(space.before, (0, size - first)), space.counts, tuple(springs),
    )  # fmt: skip


def _add_springs(space: InnerSpace, pose: Array, matrix: Array) -> None:
    """Write the columns of the springs at poses (n, 4) into a matrix (n, 4, d)."""
    for number, place in enumerate(space.springs):
        column = space.first_spring + 2 * number
        found = unit_spring_torques(space.design.geometry, place, pose)
        matrix[..., column], matrix[..., column + 1] = found


def static_rows(space: InnerSpace, pose: Array) -> tuple[Array, Array]:
    """Return static torques at poses (n, 4) as matrix . s + offset, (n, 4, d), (n, 4) [N m, N].

    NaN where a pose cannot be taken.
    """
    design = space.design
    k = design.geometry.magnification
    matrix = np.zeros((len(pose), 4, len(space.start)))
    matrix[..., MP2] = unit_torques(design.geometry, pose)
    matrix[:, 3, MP1], matrix[:, 3, MP3] = 3 * k, 3.0
    matrix[:, 3, PLATFORM] = k * design.gravity
    _add_springs(space, pose, matrix)
    if design.load.acts:
        return matrix, load_torques(design.geometry, design.load, pose)
    return matrix, np.zeros((len(pose), 4))


def motion_rows(space: InnerSpace, solved: SolvedTrajectory) -> tuple[Array, Array]:
    """Return torques along a motion as matrix . s + offset, (n, 4, d), (n, 4) [N m, N].

    Raises:
        InvalidInput: If the robot cannot run the motion.
    """
    matrix, offset = trajectory_rows(space, solved, ALL)
    _add_springs(space, solved.trajectory.pose, matrix)
    return matrix, offset


def sampled_solution(
    geometry: Geometry, trajectory: Trajectory, gravity: float
) -> SolvedTrajectory:
    """Solve a motion for a geometry, looking for limits at its samples alone.

    A tenth of the time of `solve_trajectory`, which also looks between the samples and keeps a
    clearance from singularities: for the trials of a search.

    Args:
        geometry: Lengths and limits.
        trajectory: The motion.
        gravity: Gravitational acceleration [m/s^2].
    """
    pose = trajectory.pose
    worst, which = backend.over_list(LEAST_MARGIN, mechanism(geometry), pose).T
    status, leg = decode(worst, which)
    circle, turn = type2_distances(geometry, pose)
    crossed = np.sign(circle) != np.sign(circle[0])
    if np.isfinite(turn).all():
        crossed |= np.sign(turn) != np.sign(turn[0])
    status = np.where(crossed & (status == Limit.OK), np.uint8(Limit.SINGULAR), status)
    bad = status != Limit.OK
    at = int(np.argmax(bad)) if bad.any() else int(np.argmin(worst))
    event = PathEvent(
        float(trajectory.t[at]), Limit(int(status[at])), int(leg[at]),
        -float(np.abs(circle[at])) if status[at] == Limit.SINGULAR else float(worst[at]),
        tuple(map(float, pose[at])),
    )  # fmt: skip
    until = at if bad.any() else len(pose)
    side = (float(np.sign(circle[0])), float(np.sign(np.nan_to_num(turn[0], nan=1.0))))
    check = PathCheck(status, leg, event if bad.any() else None, event, until, side)
    y = torque_regressor(
        geometry, pose, trajectory.velocity, trajectory.acceleration, gravity=gravity
    )
    speed = np.einsum("nij,nj->ni", inverse_jacobian(geometry, pose), trajectory.velocity)
    y[bad], speed[bad] = np.nan, np.nan
    return SolvedTrajectory(geometry, trajectory, Misprint.NONE, gravity, 0.0, check, y, speed)


EDGE = 1e-9
"""How far outside of a bound's headings and heights a pose still counts [rad, m]."""


class InnerLimit(NamedTuple):
    """A limit of the program.

    Attributes:
        label: What is limited, in words.
        unit: Its SI unit.
        side: ``"low"`` or ``"high"``; a bound on a magnitude is ``"high"``.
        bound: Its value.
        requirement: The bound at rest that it comes from; None for one on motions.
        term: The program's function; of a ``"low"`` side it is the negative of the quantity.
    """

    label: str
    unit: str
    side: str
    bound: float
    requirement: Requirement | None
    term: ConvexTerm

    @property
    def limit(self) -> float:
        """What the function may be at most."""
        return -self.bound if self.side == "low" else self.bound


class InnerInfeasible(PaminsaError):
    """No masses and springs within their bounds do what is asked.

    Attributes:
        excess: The least by which the worst limit is broken, as a part of it (or of 1); infinite
            where a pose or a motion is out of reach.
        reason: Why, in words.
    """

    def __init__(self, excess: float, reason: str) -> None:
        self.excess = excess
        self.reason = reason
        super().__init__(reason)


def within(bound: Requirement, pose: Array) -> NDArray[np.intp]:
    """Return which poses (n, 4) are among a bound's headings and heights, their indices."""
    inside = np.ones(len(pose), bool)
    for axis, limits in ((2, bound.theta), (3, bound.z)):
        if limits is not None:
            inside &= (limits[0] - EDGE <= pose[:, axis]) & (pose[:, axis] <= limits[1] + EDGE)
    return np.flatnonzero(inside)


def bound_margins(bound: Requirement, torque: Array) -> Array:
    """Return margins to a bound of torques (n, 4), the least of its actuators (n,)."""
    part = torque[:, list(ACTUATORS_OF[bound.quantity])]
    return bound.margin(np.abs(part) if bound.quantity == "max_torque" else part).min(axis=1)


def limits_at_rest(space: InnerSpace, bound: Requirement, pose: Array) -> list[InnerLimit]:
    """Return a bound on torques at rest as limits of the program.

    Args:
        space: Masses and springs as states.
        bound: The bound, on one of `ACTUATORS_OF`.
        pose: (n, 4) poses at which bounds count [m, m, rad, m].

    Raises:
        InnerInfeasible: If one of the poses is out of reach.
        InvalidInput: If none is among the bound's headings and heights.
    """
    pose = as_vectors(pose, "pose").reshape(-1, 4)
    pose = pose[within(bound, pose)]
    if not len(pose):
        raise InvalidInput(bound.quantity, "there is no pose at which it has to hold")
    matrix, offset = static_rows(space, pose)
    if not np.isfinite(matrix).all():
        raise InnerInfeasible(np.inf, "a pose at which a torque is bounded is out of reach")
    actuators = ACTUATORS_OF[bound.quantity]
    plain = not space.springs and not space.design.load.acts
    rows, offsets = [], []
    for j in actuators:
        use = slice(None)
        if plain:  # M_p2 is the only factor of the pose: its two extremes bound all others
            gamma = matrix[:, j, MP2]
            use = [int(gamma.argmin()), int(gamma.argmax())]
        rows.append(matrix[use, j])
        offsets.append(offset[use, j])
    m, b = np.concatenate(rows), np.concatenate(offsets)
    label, unit = bound.entry.title, bound.entry.unit
    both = bound.quantity == "max_torque" or (bound.high is not None and bound.low == -bound.high)
    if both and bound.high is not None:
        return [InnerLimit(label, unit, "high", bound.high, bound, MaxAbs(m, b))]
    found = []
    if bound.high is not None:
        term = MaxAbs(m, b, absolute=False)
        found.append(InnerLimit(label, unit, "high", bound.high, bound, term))
    if bound.low is not None:
        term = MaxAbs(-m, -b, absolute=False)
        found.append(InnerLimit(label, unit, "low", bound.low, bound, term))
    return found
