"""Regions of poses: reach and singularities in closed form, and a search for their worst pose.

A region is an upright cylinder or box of positions, with all headings of a range. A leg's X_1 is
the distance of the position from P = R_b a - R_pl u, which is on an arc as theta turns, so that its
extremes are distances between an arc and a disc or a rectangle. All margins of reach follow from
these and from the largest and least |z_5|, as z varies on its own.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import Enum
from typing import NamedTuple

import numpy as np

from paminsa_viz.model import backend
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Geometry
from paminsa_viz.model.leg import mechanism
from paminsa_viz.model.reach import LEAST_MARGIN
from paminsa_viz.model.singularity import singular_radius
from paminsa_viz.quantities.requirements import Range, WorkspaceShape
from paminsa_viz.synthesis.volume.reach import cosine_range, leg_distances

ROUND = 2.0**-44
"""Bound on the rounding of a margin, as a share of the lengths that it follows from."""

Point = tuple[float, float, float]

Grows = tuple[bool, bool, bool]
"""Which extents of a region along (x, y, z) grow; those along x and y do so together."""


class Growth(Enum):
    """Which extents of a workspace are to be found; the others are kept."""

    ALL = "all extents, in proportion"
    HORIZONTAL = "extents along x and y, in proportion"
    VERTICAL = "height"

    @property
    def axes(self) -> Grows:
        """Whether the extents along (x, y, z) grow."""
        flat = self is not Growth.VERTICAL
        return flat, flat, self is not Growth.HORIZONTAL


@dataclass(frozen=True)
class PoseRegion:
    """Positions in an upright cylinder or box, and a range of headings.

    Attributes:
        shape: Cylinder or box.
        center: (x, y, z) [m].
        half: Half extents along (x, y, z) [m]; a cylinder's first two are its radius.
        theta: Headings (least, largest) [rad].
    """

    shape: WorkspaceShape
    center: Point
    half: Point
    theta: Range

    def scaled(self, scale: float, grows: Grows) -> PoseRegion:
        """Return the region with the extents that grow times a number."""
        half = tuple(h * scale if g else h for h, g in zip(self.half, grows, strict=True))
        return replace(self, half=half)

    @property
    def low(self) -> Point:
        """Lower corner of the box around it [m]."""
        x, y, z = (c - h for c, h in zip(self.center, self.half, strict=True))
        return x, y, z

    @property
    def high(self) -> Point:
        """Upper corner of the box around it [m]."""
        x, y, z = (c + h for c, h in zip(self.center, self.half, strict=True))
        return x, y, z

    @property
    def farthest(self) -> float:
        """Largest distance from the vertical axis through the base center [m]."""
        return self.shape.section.farthest(self.center[:2], self.half)

    def leg_distances(self, geometry: Geometry) -> tuple[Array, Array]:
        """Return the least and the largest X_1 of each leg, each (3,) [m]."""
        base, platform = np.array([[geometry.base_radius], [geometry.platform_radius]])
        center, half = np.array(self.center[:2]), np.array([self.half])
        (low,), (high,) = leg_distances(base, platform, center, half, self.theta, self.shape)
        return low, high


def box(low: Point, high: Point, theta: Range) -> PoseRegion:
    """Return the box between two corners [m], with a range of headings [rad]."""
    middle, half = 0.5 * (np.array(low) + high), 0.5 * (np.array(high) - low)
    return PoseRegion(WorkspaceShape.BOX, tuple(middle.tolist()), tuple(half.tolist()), theta)


class RegionMargins(NamedTuple):
    """How far a region is from what no pose may come to; what rounding may change is taken off.

    Attributes:
        reach: (3 legs, 4 limits) least margin to each limit of reach over the region, negative
            beyond it, in the order of `reach.MARGINS` [m].
        circle: Least distance to the circle of singular positions, for every heading [m].
        turn: Least distance of R_b cos theta - R_pl from zero, with the sign that it has at
            theta = 0 counted positive [m].
    """

    reach: Array
    circle: float
    turn: float

    @property
    def least_reach(self) -> float:
        """Least margin of reach of all legs and limits [m]."""
        return float(self.reach.min())

    def holds(self) -> bool:
        """Whether every pose can be taken, and none is singular."""
        return self.least_reach > 0.0 and min(self.circle, self.turn) > 0.0


def region_margins(geometry: Geometry, region: PoseRegion) -> RegionMargins:
    """Return the margins of reach and to singularities over a region, in closed form."""
    g = geometry
    low, high = region.leg_distances(g)
    (_, _, z0), (_, _, z1) = region.low, region.high
    z5 = np.array([z0, z1]) + g.platform_joint_height
    most = float(np.abs(z5).max())
    least = 0.0 if z5[0] <= 0.0 <= z5[1] else float(np.abs(z5).min())
    bars, difference = g.crank_length + g.coupler_length, abs(g.crank_length - g.coupler_length)
    reach = np.column_stack(
        [
            bars - np.hypot(g.span_ratio * high, most),
            np.hypot(g.span_ratio * low, least) - difference,
            g.stroke - high / (g.magnification - 1),
            low - g.axis_clearance,
        ]
    )
    size = bars + g.stroke + most + g.span_ratio * (region.farthest + _arms(g))
    rb, rp = g.base_radius, g.platform_radius
    cos_low, cos_high = map(float, cosine_range(*region.theta))
    turn = rb * cos_low - rp if rb > rp else rp - rb * cos_high
    # of two nearly equal radii the difference is small, and rounding large beside it
    square = rb * rb + rp * rp - 2.0 * rb * rp * cos_high - ROUND * _arms(g) ** 2
    blur = ROUND * (_arms(g) + region.farthest)
    circle = math.sqrt(max(square, 0.0)) - region.farthest - blur
    return RegionMargins(reach - ROUND * size, circle, turn - blur)


def _arms(geometry: Geometry) -> float:
    return geometry.base_radius + geometry.platform_radius


FIRST = 4096
"""Random poses looked at first."""

KEPT = 32
"""Best poses that are followed up, by as many others near to each."""

_ROUNDS = 24
_SHRINK = 0.6

SEED = 15
"""Seed of the random poses: an answer comes out the same again."""


def from_unit(region: PoseRegion, unit: Array) -> Array:
    """Return poses of a region, (n, 4), from numbers between -1 and 1, (n, 4).

    Where the region is no box, the first two are moved into it.
    """
    share = np.clip(unit, -1.0, 1.0)
    plan = region.shape.section.clipped(share[:, :2], (1.0, 1.0))
    x, y, z = region.center
    low, high = region.theta
    return np.column_stack(
        [
            x + region.half[0] * plan[:, 0],
            y + region.half[1] * plan[:, 1],
            0.5 * (low + high) + 0.5 * (high - low) * share[:, 2],
            z + region.half[2] * share[:, 3],
        ]
    )


def lowest(value: Callable[[Array], Array], region: PoseRegion) -> tuple[Array, float]:
    """Return the pose of a region at which a function is least, as far as sampling finds it.

    Args:
        value: The function, of poses (n, 4), (n,); NaN counts as the least.
        region: The poses.
    """
    rng = np.random.default_rng(SEED)
    unit = 1.3 * rng.uniform(-1.0, 1.0, (FIRST, 4))

    def values(unit: Array) -> Array:
        return np.nan_to_num(value(from_unit(region, unit)), nan=-np.inf)

    found = values(unit)
    width = 0.3
    for _ in range(_ROUNDS):
        best = np.argsort(found, kind="stable")[:KEPT]
        unit, found = unit[best], found[best]
        near = np.repeat(unit, KEPT, axis=0)
        near = np.clip(near, -1.0, 1.0) + width * rng.normal(size=near.shape)
        unit = np.concatenate([unit, near])
        found = np.concatenate([found, values(near)])
        width *= _SHRINK
    best = int(np.argmin(found))
    return from_unit(region, unit[best : best + 1])[0], float(found[best])


def freedom(geometry: Geometry, poses: Array) -> Array:
    """Return how far poses (n, 4) are from limits of reach and from singular positions, (2, n) [m].

    The first is the least margin of reach. The second is the distance inside the singular circle or
    |R_b cos theta - R_pl|, with the sign that it has at theta = 0 counted positive.
    """
    margin = backend.over_list(LEAST_MARGIN, mechanism(geometry), poses)[:, 0]
    x, y, theta, _ = poses.T
    circle = singular_radius(geometry, theta) - np.hypot(x, y)
    difference = geometry.base_radius - geometry.platform_radius
    turn = geometry.base_radius * np.cos(theta) - geometry.platform_radius
    return np.stack([margin, np.minimum(circle, np.copysign(1.0, difference) * turn)])


def least_free(geometry: Geometry, region: PoseRegion) -> tuple[Array, float, str]:
    """Return the pose of a region with the least `freedom`, that [m], and what limits it."""
    pose, value = lowest(lambda poses: freedom(geometry, poses).min(axis=0), region)
    reach, singular = freedom(geometry, pose[None])[:, 0]
    return pose, value, "reach" if reach <= singular else "singularity"
