"""Reach and singularities over a whole region of poses, in closed form.

A region is an upright cylinder or box of positions, with all headings of a range. A leg's X_1 is
the distance of the position from P = R_b a - R_pl u, which is on an arc as theta turns, so that its
extremes are distances between an arc and a disc or a rectangle. All margins of reach follow from
these and from the largest and least |z_5|, as z varies on its own.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import Enum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Geometry
from paminsa_viz.model.kinematics import LEG_AXES
from paminsa_viz.model.reach import Limit
from paminsa_viz.quantities.requirements import Range, WorkspaceShape

ROUND = 2.0**-44
"""Bound on the rounding of a margin, as a share of the lengths that it follows from."""

_ANGLE = 1e-9
"""By how much an arc is taken longer at both ends when it is looked for an extreme [rad]."""

Point = tuple[float, float, float]

Grows = tuple[bool, bool, bool]
"""Which extents of a region along (x, y, z) grow."""


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
        x, y, _ = self.center
        if self.shape is WorkspaceShape.CYLINDER:
            return math.hypot(x, y) + self.half[0]
        return math.hypot(abs(x) + self.half[0], abs(y) + self.half[1])


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

    def holds(self, least: float = 0.0) -> bool:
        """Whether every pose can be taken, at least so far from every limit [m], none singular."""
        return self.least_reach > max(least, 0.0) and min(self.circle, self.turn) > 0.0

    def cause(self, least: float = 0.0) -> str:
        """Say what does not hold, empty if all does."""
        if self.circle <= 0.0 or self.turn <= 0.0:
            return Limit.SINGULAR.word
        if self.holds(least):
            return ""
        leg, limit = divmod(int(np.argmin(self.reach)), 4)
        return (
            f"{(Limit.STRETCHED, Limit.FOLDED, Limit.GUIDE, Limit.AXIS)[limit].word}:leg{leg + 1}"
        )


def region_margins(geometry: Geometry, region: PoseRegion) -> RegionMargins:
    """Return the margins of reach and to singularities over a region, in closed form."""
    g = geometry
    low, high = leg_distances(g, region)
    (_, _, z0), (_, _, z1) = region.low, region.high
    z5 = np.array([z0, z1]) + g.platform_joint_height
    most = float(np.abs(z5).max())
    least = 0.0 if z5[0] <= 0.0 <= z5[1] else float(np.abs(z5).min())
    bars, difference = g.crank_length + g.coupler_length, abs(g.crank_length - g.coupler_length)
    reach = np.stack(
        [
            bars - np.hypot(g.span_ratio * high, most),
            np.hypot(g.span_ratio * low, least) - difference,
            g.stroke - high / (g.magnification - 1),
            low - g.axis_clearance,
        ],
        axis=-1,
    )
    size = bars + g.stroke + most + g.span_ratio * (region.farthest + _arms(g))
    rb, rp = g.base_radius, g.platform_radius
    cos_low, cos_high = _cosines(region.theta)
    turn = rb * cos_low - rp if rb > rp else rp - rb * cos_high
    # of two nearly equal radii the difference is small, and rounding large beside it
    square = rb * rb + rp * rp - 2.0 * rb * rp * cos_high - ROUND * _arms(g) ** 2
    blur = ROUND * (_arms(g) + region.farthest)
    circle = math.sqrt(max(square, 0.0)) - region.farthest - blur
    return RegionMargins(reach - ROUND * size, circle, turn - blur)


def _arms(geometry: Geometry) -> float:
    return geometry.base_radius + geometry.platform_radius


def _cosines(theta: Range) -> Range:
    """Return the least and the largest cosine of a range of angles."""
    low, high = theta
    ends = math.cos(low), math.cos(high)
    most = 1.0 if _within(np.array([0.0]), low, high)[0] else max(ends)
    least = -1.0 if _within(np.array([math.pi]), low, high)[0] else min(ends)
    return least, most


def _within(angle: Array, low: Array | float, high: Array | float) -> NDArray[np.bool_]:
    """Say which angles are in a range, counted with every whole turn."""
    after = np.mod(angle - low + _ANGLE, 2 * np.pi)
    return after <= high - low + 2 * _ANGLE


def leg_distances(geometry: Geometry, region: PoseRegion) -> tuple[Array, Array]:
    """Return the least and the largest X_1 of each leg over a region, each (3,) [m]."""
    g = geometry
    axis = g.base_radius * LEG_AXES  # centers of the arcs
    start = region.theta[0] + np.arctan2(LEG_AXES[:, 1], LEG_AXES[:, 0]) + np.pi
    ends = start, start + (region.theta[1] - region.theta[0])
    (x0, y0, _), (x1, y1, _) = region.low, region.high

    def extremes(point: Array) -> tuple[Array, Array]:
        """Return the least and the largest distance of a point from each arc, (3,)."""
        to = point - axis
        toward = np.arctan2(to[:, 1], to[:, 0])
        angle = np.stack([*ends, toward, toward + np.pi])
        on_arc = np.concatenate([np.ones((2, 3), bool), _within(angle[2:], *ends)])
        x = axis[:, 0] + g.platform_radius * np.cos(angle) - point[0]
        y = axis[:, 1] + g.platform_radius * np.sin(angle) - point[1]
        distance = np.hypot(x, y)
        return (
            np.where(on_arc, distance, np.inf).min(axis=0),
            np.where(on_arc, distance, -np.inf).max(axis=0),
        )

    if region.shape is WorkspaceShape.CYLINDER:
        least, most = extremes(np.array(region.center[:2]))
        return np.maximum(least - region.half[0], 0.0), most + region.half[0]
    corners = [np.array([x, y]) for x in (x0, x1) for y in (y0, y1)]
    most = np.max([extremes(corner)[1] for corner in corners], axis=0)
    # The arc is nearest to the rectangle at an end, toward a corner, at a right angle to a side,
    # or where it crosses one.
    with np.errstate(invalid="ignore"):
        across_x = np.arccos(np.stack([x0 - axis[:, 0], x1 - axis[:, 0]]) / g.platform_radius)
        across_y = np.arcsin(np.stack([y0 - axis[:, 1], y1 - axis[:, 1]]) / g.platform_radius)
    quarter = np.tile(0.5 * np.pi * np.arange(4)[:, None], (1, 3))
    toward = [np.arctan2(*(corner - axis).T[::-1]) for corner in corners]
    angle = np.asarray(
        np.concatenate(
            [np.stack([*ends, *toward]), quarter, across_x, -across_x, across_y, np.pi - across_y]
        ),
        np.float64,
    )
    on_arc = np.concatenate([np.ones((2, 3), bool), _within(angle[2:], *ends)])
    x = axis[:, 0] + g.platform_radius * np.cos(angle)
    y = axis[:, 1] + g.platform_radius * np.sin(angle)
    gap = np.hypot(x - np.clip(x, x0, x1), y - np.clip(y, y0, y1))
    least = np.where(on_arc & np.isfinite(gap), gap, np.inf).min(axis=0)
    return least, most
