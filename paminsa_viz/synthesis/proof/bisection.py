"""The poses of a region that break a requirement: the nearest to its center, between two bounds.

How far out a pose is, is its gauge: the scale of the smallest region of the shape that it is in.
Boxes of poses are bounded, those that are proven dropped and the others cut in two, those nearest
to the center first (best-first branch and bound; Moore, Kearfott and Cloud 2009). At any time no
pose nearer than the nearest box that is left breaks a requirement, and poses looked at in the boxes
say from where on one does.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.model.arrays import Array
from paminsa_viz.model.backend import WorkClock
from paminsa_viz.model.resizing import turn_length
from paminsa_viz.progress import Progress, go_on
from paminsa_viz.synthesis.proof.families import SLACK, BoundGroup, Symmetry, symmetry
from paminsa_viz.synthesis.proof.regions import Grows, PoseRegion

BATCH = 8192
"""Boxes worked on at a time."""

SMALLEST = 1e-9
"""Width of a box that is not cut any more [m, rad]."""

MOST_BOXES = 20_000_000
"""Boxes that may wait; beyond them the search ends as if its time was over."""

_ROUND = 1e-13
"""Rounding of a gauge, as a share of it."""

_SPECK = 1e-14
"""Rounding of a coordinate [m, rad]."""


@dataclass(frozen=True)
class Gauge:
    """The scale at which a pose comes into a region that grows about its center.

    Attributes:
        region: The region at scale 1.
        grows: Which of its extents along (x, y, z) grow; outside the others is never in it.
    """

    region: PoseRegion
    grows: Grows

    def of_boxes(self, middle: Array, half: Array) -> Array:
        """Return the least gauge of the poses of boxes (n, 4), rounded down (n,)."""
        away = np.abs(middle[:, [0, 1, 3]] - self.region.center) - half[:, [0, 1, 3]]
        return self._of(np.maximum(away - _SPECK, 0.0)) * (1.0 - _ROUND)

    def of_poses(self, poses: Array) -> Array:
        """Return the gauge of poses (n, 4), (n,)."""
        return self._of(np.abs(poses[:, [0, 1, 3]] - self.region.center))

    def _of(self, away: Array) -> Array:
        with np.errstate(divide="ignore", invalid="ignore"):
            plan = self.region.shape.section.gauge_squared(away[:, 0], away[:, 1], self.region.half)
            share = np.column_stack([np.sqrt(plan), away[:, 2] / self.region.half[2]])
        share = np.where(np.isnan(share), 0.0, share)  # nothing of an extent of zero
        share = np.where(self.grows[1:], share, np.where(share > 1.0 + _ROUND, np.inf, 0.0))
        return share.max(axis=1)


class Control:
    """When to stop, and who wants to know how far it is.

    Attributes:
        boxes: How many boxes have been bounded.
    """

    def __init__(self, time_limit: float, progress: Progress = go_on) -> None:
        self._clock = WorkClock()
        self._limit = time_limit
        self._progress = progress
        self._stopped = False
        self.boxes = 0

    @property
    def elapsed(self) -> float:
        """Time since the start, without that of compiling [s]."""
        return self._clock.elapsed

    @property
    def left(self) -> float:
        """Time that is left [s]."""
        return self._limit - self.elapsed

    @property
    def over(self) -> bool:
        """Whether to stop: the time is over, or the progress function said so."""
        if not self._stopped:
            done = min(1.0, self.elapsed / max(self._limit, 1e-9))
            self._stopped = bool(self._progress(done))
        return self._stopped or self.left < 0.0


@dataclass(frozen=True)
class Nearest:
    """Where the nearest pose is that breaks a requirement of a group.

    Attributes:
        lower: No pose of a lower gauge breaks one: proven.
        upper: Gauge from which on one does, or at which the search ended.
        pose: (4,) the pose of gauge ``upper`` that does; None if none was found.
        requirement: Index of the requirement that it breaks; -1 for none.
        margins: (requirements,) margins proven over all poses of gauge up to ``lower``.
        boxes: How many boxes were bounded.
        remaining: (n, 2, 4) least and largest poses of the boxes that are left.
    """

    lower: float
    upper: float
    pose: Array | None
    requirement: int
    margins: Array
    boxes: int
    remaining: Array = field(default_factory=lambda: np.empty((0, 2, 4)))


class _Pool:
    """Boxes that wait, (n, 2, 4) by middles and half widths, with their gauges."""

    def __init__(self, gauge: Gauge, middle: Array, half: Array) -> None:
        self._of = gauge
        self.boxes, self.gauge = np.empty((0, 2, 4)), np.empty(0)
        self.add(middle, half)

    def add(self, middle: Array, half: Array) -> None:
        self.boxes = np.concatenate([self.boxes, np.stack([middle, half], axis=1)])
        self.gauge = np.concatenate([self.gauge, self._of.of_boxes(middle, half)])

    def keep(self, chosen: NDArray[np.bool_]) -> None:
        self.boxes, self.gauge = self.boxes[chosen], self.gauge[chosen]

    def take(self, count: int) -> tuple[Array, Array, Array]:
        """Remove the boxes of least gauge, of equal ones the first, and return them."""
        chosen = np.ones(len(self.gauge), bool)
        if len(self.gauge) > count:
            most = np.partition(self.gauge, count - 1)[count - 1]
            chosen, last = self.gauge < most, np.flatnonzero(self.gauge == most)
            chosen[last[: count - np.count_nonzero(chosen)]] = True
        taken, near = self.boxes[chosen], self.gauge[chosen]
        self.keep(~chosen)
        return taken[:, 0], taken[:, 1], near


def first_box(group: BoundGroup, region: PoseRegion, same: Symmetry) -> tuple[Array, Array] | None:
    """Return the box around the poses of a region that a group is about; None for none.

    Only headings that stand for others by symmetry are in it. A coordinate that the group does not
    depend on has no width.
    """
    least = 0.0 if same.mirror else group.theta[0]
    low = np.array([*region.low[:2], least, max(region.low[2], group.z[0])])
    high = np.array([*region.high[:2], group.theta[1], min(region.high[2], group.z[1])])
    if (low > high).any():
        return None
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    half = np.where(half > 0.0, half * (1.0 + _ROUND) + _SPECK, 0.0)
    if not group.family.by_height:
        # the height nearest to the center's, for the gauge
        middle[3], half[3] = np.clip(region.center[2], low[3], high[3]), 0.0
    return middle[None], half[None]


def nearest_violation(
    group: BoundGroup,
    gauge: Gauge,
    upper: float,
    tolerance: float | None,
    control: Control,
    time_limit: float = np.inf,
) -> Nearest:
    """Find the poses nearest to a region's center that break a requirement.

    Args:
        group: The requirements.
        gauge: How far out a pose is.
        upper: Gauge up to which poses are looked at.
        tolerance: Difference of ``upper`` and ``lower`` at which to stop. None: stop at the first
            pose that breaks a requirement.
        control: When to stop at the latest.
        time_limit: When to stop at the latest, from now on [s].
    """
    count = len(group.requirements)
    same = symmetry(group, gauge.region)
    start = first_box(group, gauge.region.scaled(upper, gauge.grows), same)
    if start is None:
        return Nearest(upper, upper, None, -1, np.full(count, np.inf), 0)
    pool = _Pool(gauge, *start)
    first, pose, broken, lower = control.boxes, None, -1, np.inf
    end = control.elapsed + time_limit
    turn = turn_length(group.design.geometry)
    proven: list[tuple[Array, Array]] = []
    spare = group.sizes * (SLACK if same.any else 0.0)
    while len(pool.gauge):
        if tolerance is None:
            pool.keep(pool.gauge <= upper)
        else:
            beyond = pool.gauge >= upper - tolerance
            lower = min(lower, pool.gauge[beyond].min(initial=np.inf))
            pool.keep(~beyond)
        if not len(pool.gauge) or len(pool.gauge) > MOST_BOXES:
            break
        if control.over or control.elapsed > end:
            break
        middle, half, near = pool.take(BATCH)
        margins = group.margins(middle, half)
        control.boxes += len(near)
        good = (margins >= spare).all(axis=1)
        proven.append((near[good], margins[good]))
        middle, half, near = middle[~good], half[~good], near[~good]
        found = _broken(group, gauge, middle, half, upper)
        if found is not None:
            upper, pose, broken = found
            if tolerance is None:
                pool.add(middle, half)
                break
        stuck = (half <= SMALLEST).all(axis=1)
        lower = min(lower, near[stuck].min(initial=np.inf))
        middle, half = _cut(middle[~stuck], half[~stuck], turn)
        kept = same.kept(middle, half)
        pool.add(middle[kept], half[kept])
    lower = min(lower, upper, pool.gauge.min(initial=np.inf))
    worst = np.full(count, np.inf)
    for near, margins in proven:
        worst = np.minimum(worst, margins[near <= lower].min(axis=0, initial=np.inf))
    middle, half = np.moveaxis(pool.boxes, 1, 0)
    remaining = np.stack([middle - half, middle + half], axis=1)
    boxes = control.boxes - first
    return Nearest(float(lower), upper, pose, broken, worst, boxes, remaining)


def _broken(
    group: BoundGroup, gauge: Gauge, middle: Array, half: Array, upper: float
) -> tuple[float, Array, int] | None:
    """Return the pose of least gauge, below ``upper``, that breaks a requirement, if any.

    Looked at are the poses of each box that are nearest to the region's center, and its middle.
    """
    if not len(middle):
        return None
    x, y, z = gauge.region.center
    target = np.where([True, True, False, True], [x, y, 0.0, z], middle)
    nearest = np.clip(target, middle - half, middle + half)
    poses = np.concatenate([nearest, middle])
    far = gauge.of_poses(poses)
    poses, far = poses[far <= upper], far[far <= upper]
    if not len(poses):
        return None
    margins = group.pose_margins(poses)
    # a pose that cannot be taken has no value, and breaks every requirement
    bad = ~(margins >= 0.0)
    rows = np.flatnonzero(bad.any(axis=1))
    if not len(rows):
        return None
    row = rows[np.argmin(far[rows])]
    return float(far[row]), poses[row], int(np.argmax(bad[row]))


def _cut(middle: Array, half: Array, turn: float) -> tuple[Array, Array]:
    """Cut boxes (n, 4) in two along their longest side, where 1 rad counts as a length [m]."""
    side = np.argmax(half * np.array([1.0, 1.0, turn, 1.0]), axis=1)
    rows = np.arange(len(side))
    half = half.copy()
    half[rows, side] *= 0.5
    step = np.zeros_like(half)
    step[rows, side] = half[rows, side]
    # the halves overlap by what rounding may leave between them
    half[rows, side] += 4e-16 * (np.abs(middle[rows, side]) + half[rows, side])
    return np.concatenate([middle - step, middle + step]), np.concatenate([half, half])
