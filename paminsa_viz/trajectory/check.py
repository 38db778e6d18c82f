"""Whether the robot can run a trajectory: every sample, and what lies between samples.

The pose is followed by the polynomials of `Trajectory.at`. In addition to the limits of `reach`, a
motion must not cross a type-2 singularity, nor come closer to one than a clearance: torques grow
there without bound.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.checks import require_at_least
from paminsa_viz.errors import PaminsaError
from paminsa_viz.model.arguments import of_geometry
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Geometry
from paminsa_viz.model.reach import MARGINS, Limit, OfLimits, check_reach, status_words
from paminsa_viz.model.resizing import radius_ratio
from paminsa_viz.model.singularity import type2_distances
from paminsa_viz.trajectory.sampled import Passage, Trajectory

SINGULAR_CLEARANCE = 0.005
"""Least distance from a singular position at Appendix 4's lengths [m]; a turn counts as the path of
the joints 5. See `singular_clearance` for others.

At 5 mm the static torques of Appendix 4's robot are some fifty times what they are at the center.
"""

_BETWEEN = 32  # parts into which a step is cut where something may happen between its ends

_FEW = 300  # number of samples up to which every step is looked into: they may lie far apart

_FAR = 1e6  # distance from what does not exist [m]
_LIMITS = (*(MARGINS * 3), Limit.SINGULAR, Limit.SINGULAR)
GUIDES = np.array([limit is Limit.GUIDE for limit in _LIMITS])
"""Which of the 14 limits are those of the guides; up to their end they may be used."""
_LEGS = (*(leg for leg in range(3) for _ in MARGINS), -1, -1)


@dataclass(frozen=True)
class PathEvent:
    """A limit that a trajectory runs into, or comes near to.

    Attributes:
        t: When [s].
        limit: Which limit.
        leg: Index of the leg, 0 to 2, or -1 if no single leg is concerned.
        margin: Distance left to the limit, negative beyond it [m].
        pose: (x, y, theta, z) at that time [m, m, rad, m].
        reason: What happens there, where it is more than the limit's own explanation.
    """

    t: float
    limit: Limit
    leg: int
    margin: float
    pose: tuple[float, ...]
    reason: str = ""

    @property
    def explanation(self) -> str:
        """Text of the event."""
        if self.reason:
            what = self.reason
        elif self.limit is Limit.SINGULAR:
            what = "the platform comes too close to a singular pose; torques have no bound there"
        else:
            what = self.limit.explanation
        return f"at {self.t:.4g} s{f', leg {self.leg + 1}' if self.leg >= 0 else ''}: {what}"


@dataclass(frozen=True, eq=False)
class PathCheck(OfLimits):
    """Result of `check_path` along n samples.

    Attributes:
        status: (n,) values of `Limit`. Beyond a type-2 singularity that the motion would have to
            cross, and closer to one than the clearance, it is ``SINGULAR``.
        leg: (n,) index of the leg that fails, -1 for none.
        first: The first failure, also between samples; None if the robot can run it all.
        closest: The least distance to any limit but planned loci, before the first failure.
        until: Number of samples before the first failure.
        side: (+1 or -1) for the position and for the turn: on which side of the type-2
            singularities the motion starts, as the signs of `measure_singularity`'s distances.
        windows: Planned crossings.
    """

    status: NDArray[np.uint8]
    leg: NDArray[np.int8]
    first: PathEvent | None
    closest: PathEvent
    until: int
    side: tuple[float, float]
    windows: tuple[PassageWindow, ...] = ()

    @property
    def possible(self) -> bool:
        """Whether the robot can run the whole trajectory."""
        return self.first is None

    def words(self) -> NDArray[np.str_]:
        """Return the status as words for tables, such as ``ok`` or ``guide:leg2``, (n,)."""
        return status_words(self.status, self.leg)

    def require(self) -> None:
        """Raise `ImpossibleTrajectory` if there is a failure."""
        if self.first is not None:
            raise ImpossibleTrajectory(self.first)


class ImpossibleTrajectory(PaminsaError):
    """A trajectory that the robot cannot run.

    Attributes:
        event: The first failure.
    """

    def __init__(self, event: PathEvent) -> None:
        self.event = event
        super().__init__(f"the trajectory cannot be run: {event.explanation}")


@of_geometry
def singular_clearance(geometry: Geometry) -> float:
    """Return `SINGULAR_CLEARANCE` in proportion to R_b [m].

    So torques beside a singularity grow by the same factor on robots of one shape, and the presets,
    which grow with R_b, keep it on small ones.

    Args:
        geometry: Lengths of the mechanism.
    """
    return SINGULAR_CLEARANCE * radius_ratio(geometry)


@of_geometry
def check_path(
    geometry: Geometry, trajectory: Trajectory, clearance: float | None = None
) -> PathCheck:
    """Check a trajectory; both branches of the knee alike.

    Args:
        geometry: Lengths and limits.
        trajectory: The motion.
        clearance: Least distance from type-2 singular positions [m]; `singular_clearance` if None.

    Raises:
        InvalidInput: If the clearance is negative or not finite.
    """
    clearance = singular_clearance(geometry) if clearance is None else clearance
    require_at_least(clearance, "clearance", what="a length of at least 0 m")
    distances = _singular_distances(geometry, trajectory.pose)
    side = np.where(distances[0] < 0, -1.0, 1.0)
    windows = tuple(_window(trajectory, item, distances, clearance) for item in trajectory.passages)

    def margins_at(t: Array, pose: Array) -> Array:
        return limit_margins(geometry, pose, *allowed(t, side, clearance, windows))

    margins = margins_at(trajectory.t, trajectory.pose)
    # A guide may be used to its end; on the other limits the mechanism is singular.
    exceeded = np.where(beyond(margins), margins, np.inf)
    worst = np.argmin(exceeded, axis=1)
    failed = np.any(exceeded < np.inf, axis=1)
    status = np.where(failed, np.array(_LIMITS, np.uint8)[worst], np.uint8(Limit.OK))
    leg = np.where(failed, np.array(_LEGS, np.int8)[worst], np.int8(-1))
    first, until = _first_failure(trajectory, margins, exceeded, margins_at)
    left = margins[: max(until, 1)].copy()
    left[:, [len(_LIMITS) - 2 + passage.locus.value for passage in trajectory.passages]] = _FAR
    row = int(np.argmin(left.min(axis=1)))
    closest = worst_event(trajectory.t[row], trajectory.pose[row], left[row])
    start = (float(side[0]), float(side[1]))
    return PathCheck(status, leg, first, closest, until, start, windows)


def _singular_distances(geometry: Geometry, pose: Array) -> Array:
    """Return signed distances (n, 2) to both type-2 loci [m], turns as the path of the joints 5.

    Each of them changes sign where its factor of the determinant does.
    """
    circle, turn = type2_distances(geometry, pose)
    if geometry.platform_radius > geometry.base_radius:  # no turn is singular everywhere
        turn = np.full(len(pose), _FAR)
    return np.stack([circle, turn], axis=1)


def limit_margins(geometry: Geometry, pose: Array, side: Array, clearance: float | Array) -> Array:
    """Return the distances of poses (n, 4) to every limit, (n, 14) [m], negative beyond it.

    Args:
        geometry: Lengths and limits.
        pose: (n, 4) [m, m, rad, m].
        side: (2,) or (n, 2) signs of the singular distances that are allowed, see `allowed`.
        clearance: Least distance from singular positions [m], (n, 2) if it varies.
    """
    reach = check_reach(geometry, pose).margins.reshape(-1, 12)
    return np.concatenate([reach, side * _singular_distances(geometry, pose) - clearance], axis=1)


class PassageWindow(NamedTuple):
    """A planned crossing, and the time around it that is spent nearer than the clearance [s]."""

    passage: Passage
    begin: float
    end: float


def _window(
    trajectory: Trajectory, passage: Passage, distances: Array, clearance: float
) -> PassageWindow:
    """Return the samples around a crossing between which the motion is near its locus."""
    far = np.abs(distances[:, passage.locus.value]) >= clearance
    after = int(np.searchsorted(trajectory.t, passage.t))
    begin = np.flatnonzero(far[:after])
    end = np.flatnonzero(far[after:])
    return PassageWindow(
        passage,
        float(trajectory.t[begin[-1]]) if begin.size else -np.inf,
        float(trajectory.t[after + end[0]]) if end.size else np.inf,
    )


def allowed(
    t: Array, side: Array, clearance: float, windows: tuple[PassageWindow, ...]
) -> tuple[Array, Array]:
    """Return the sides of the loci that are allowed at times (n,), and clearances, (n, 2) each.

    Each planned crossing changes the side of its locus; near it, the distance does not matter.

    Args:
        t: Times [s].
        side: (2,) sides at the start, see `PathCheck.side`.
        clearance: Least distance elsewhere [m].
        windows: Planned crossings.
    """
    sides = np.tile(side, (t.size, 1))
    distances = np.full((t.size, 2), clearance)
    for (at, locus, _), begin, end in windows:
        sides[t >= at, locus.value] *= -1.0
        distances[(t > begin) & (t < end), locus.value] = -_FAR
    return sides, distances


def beyond(margins: Array) -> NDArray[np.bool_]:
    """Return which limits are exceeded, of the shape of `limit_margins`' result (..., 14)."""
    return (margins < 0) | ((margins == 0) & ~GUIDES)


def _first_failure(
    trajectory: Trajectory,
    margins: Array,
    exceeded: Array,
    margins_at: Callable[[Array, Array], Array],
) -> tuple[PathEvent | None, int]:
    """Return the first failure, and the number of samples before it; kept margins are infinite."""
    t, pose = trajectory.t, trajectory.pose
    failed = np.any(exceeded < np.inf, axis=1)
    until = int(np.argmax(failed)) if failed.any() else t.size
    if until == 0:
        return worst_event(t[0], pose[0], exceeded[0]), 0
    # A margin may dip below zero within a step only if it is small against its change there.
    step = np.abs(np.diff(margins[: until + 1], axis=0))
    change = np.maximum(step[:-1], step[1:])
    near = np.zeros(len(step), dtype=bool)
    low = np.any(margins[1 : len(step)] < change, axis=1)
    near[:-1] |= low
    near[1:] |= low
    if t.size <= _FEW:
        near[:] = True
    if until < t.size:
        near[-1] = True
    starts = np.flatnonzero(near)
    if starts.size == 0:
        return None, until
    share = np.arange(1, _BETWEEN + 1) / _BETWEEN
    inside = t[starts, None] + (t[starts + 1] - t[starts])[:, None] * share

    def fails(times: Array) -> NDArray[np.bool_]:
        return np.any(beyond(margins_at(times, trajectory.at(times).pose)), axis=1)

    wrong = fails(inside.ravel())
    if not wrong.any():  # or only the sample itself, by a rounding error
        if until == t.size:
            return None, until
        return worst_event(t[until], pose[until], exceeded[until]), until
    index = int(np.argmax(wrong))
    until = int(starts[index // _BETWEEN]) + 1
    after = float(inside.ravel()[index])
    before = after - float(t[until] - t[until - 1]) / _BETWEEN
    for _ in range(8):  # to 1e-12 of a step
        times = np.linspace(before, after, _BETWEEN + 1)[1:]
        wrong = fails(times)
        if not wrong.any():
            break
        index = int(np.argmax(wrong))
        before, after = (before if index == 0 else float(times[index - 1])), float(times[index])
    there = trajectory.at([after]).pose
    return worst_event(after, there[0], margins_at(np.array([after]), there)[0]), until


def worst_event(t: float, pose: Array, margins: Array) -> PathEvent:
    """Return the event of the least of 14 margins at a time and a pose (4,)."""
    column = int(np.argmin(margins))
    place = tuple(float(value) for value in pose)
    return PathEvent(float(t), _LIMITS[column], _LEGS[column], float(margins[column]), place)
