"""Points of a leg as weighted sums of its joints 5 and 9.

A pantograph copies: each joint, and so every point of a bar or of its extension, is an affine
function of 5 and 9 with constant weights. They follow from |85| = k |83| and from the parallelogram
8-9-4-7 (see `docs/model.md`).

A leg has two freedoms in its plane: the elevations phi of B8 and psi of B4. Every point of a bar is
a cos phi + b cos psi from the leg axis toward the platform, and c sin phi + d sin psi above the
guides. `counterweight_clearance` takes a grid of cells (phi, psi): no point moves by more than
|a| + |b|, or |c| + |d|, times half a cell, so that what is found at the cells' middles, with that
much added, holds for all poses.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Geometry
from paminsa_viz.model.leg import LegPosition
from paminsa_viz.model.parameters import BAR_ENDS, Counterweight


class PointWeights(NamedTuple):
    """A point of a leg: r = r5 rho + r9 H + r0, z = z5 z_5 + r9 z_9 + z0."""

    r5: Any
    r9: Any
    z5: Any
    z0: Any = 0.0
    r0: Any = 0.0

    def of(self, g: LegPosition) -> tuple[Any, Any]:
        """Return r and z of the point [m]; where it does not depend on joint 9, without that."""
        r9, z9 = (self.r9 * g.r9, self.r9 * g.z9) if self.r9 else (0.0, 0.0)
        return self.r5 * g.rho + r9 + self.r0, self.z5 * g.zeta + z9 + self.z0

    def toward(self, other: PointWeights, share: Any) -> PointWeights:
        """Return the point at ``share`` of the way from here to another point."""
        return PointWeights(*(a + share * (b - a) for a, b in zip(self, other, strict=True)))


def point_weights(geometry: Geometry) -> dict[int, PointWeights]:
    """Return the weights of every joint of a leg, by the paper's number."""
    k = geometry.magnification
    return {
        2: PointWeights(0.0, 0.0, 1 / k, geometry.shaft_length),
        3: PointWeights(0.0, 0.0, 1 / k),
        4: PointWeights(1 / k, (k - 1) / k, 1 / k),
        5: PointWeights(1.0, 0.0, 1.0),
        7: PointWeights(-1 / (k * (k - 1)), -1 / k, 1 / k),
        8: PointWeights(-1 / (k - 1), 0.0, 0.0),
        9: PointWeights(0.0, 1.0, 0.0),
    }


def bar_length(geometry: Geometry, bar: str) -> float:
    """Return the length of B3, B4, B7 or B8, given as ``"b3"`` and so on [m]."""
    return {
        "b3": geometry.crank_length,
        "b4": geometry.coupler_length,
        "b7": geometry.short_coupler_length,
        "b8": geometry.crank_length,
    }[bar]


def bar_point(geometry: Geometry, bar: str, joint: int, beyond: Any) -> PointWeights:
    """Return a point of a bar or of its extension; arguments as in `Counterweight`.

    ``beyond`` may be an array; the weights that depend on it then have its shape.
    """
    first, second = BAR_ENDS[bar]
    joints = point_weights(geometry)
    other = joints[second if joint == first else first]
    return joints[joint].toward(other, -beyond / bar_length(geometry, bar))


def counterweight_point(geometry: Geometry, weight: Counterweight) -> PointWeights:
    """Return where a counterweight is."""
    return bar_point(geometry, weight.bar, weight.joint, weight.beyond)


CELLS = 480
"""Cells of a full turn: what they add to distances is some 5 mm on a robot of Appendix 4's size."""


@dataclass(frozen=True)
class CounterweightClearance:
    """Bounds that no pose of the singularity-free workspace exceeds.

    It is what can be reached from home without passing a type-2 singularity, on home's side
    of the guides: joints 5 below them with the lower knee, above them with the upper one.

    Attributes:
        inward: Farthest from the leg axis toward the platform, negative if it stays outward [m].
        outward: Farthest from the leg axis away from the platform, negative if it stays inward [m].
        low, high: Lowest and highest, from the plane of the guides up [m].
        clear_depth: Distance of joints 5 from the plane of the guides beyond which it can meet
            neither the platform nor the robot's axis, where M4 is [m]: it stays on the guides'
            side of its leg's joint 5, or on the leg's side. Zero if it never can meet them,
            infinite if it may at any height.
    """

    inward: float
    outward: float
    low: float
    high: float
    clear_depth: float


@lru_cache(maxsize=64)
def counterweight_clearance(
    geometry: Geometry, weight: Counterweight, radius: float = 0.0
) -> CounterweightClearance | None:
    """Return the room of a counterweight, or None if the leg can take no pose.

    The bounds hold for sure; the true extremes lie within them, by millimeters where
    the leg itself ends its way, by centimeters where other legs do first.

    Args:
        geometry: Lengths of the mechanism.
        weight: The counterweight, of which only the place counts.
        radius: Of the disc about its mass center, in the plane of the leg [m].
    """
    g, k, sign = geometry, geometry.magnification, geometry.knee.sign
    crank, coupler, half = g.crank_length, g.coupler_length, np.pi / CELLS
    angle = (2 * np.arange(CELLS) + 1) * half - np.pi
    phi, psi = angle[:, None], angle[None, :]
    part = (k - 1) / k  # of the distance 8-5 that lies between leg axis and 5
    rho = part * (crank * np.cos(phi) + coupler * np.cos(psi))
    height = crank * np.sin(phi) + coupler * np.sin(psi)
    slack = (crank + coupler) * half
    nearest, farthest = _distances(g)
    # The knee is beyond the line 8-5 as seen from the platform's side: below it as published.
    bent = sign * np.sin(psi - phi)
    taken = (
        (rho >= nearest - part * slack)
        & (rho <= farthest + part * slack)
        & (sign * height <= slack)
        & (bent >= -2 * half)
    )
    if not taken.any():
        return None
    at = counterweight_point(g, weight)
    # r9 = -rho/(k - 1) + l_B8 cos phi
    along = at.r5 - at.r9 / (k - 1)
    across = (along * part + at.r9) * crank, along * part * coupler
    upward = (at.z5 + at.r9) * crank, at.z5 * coupler
    r = (across[0] * np.cos(phi) + across[1] * np.cos(psi) + at.r0)[taken]
    z = (upward[0] * np.sin(phi) + upward[1] * np.sin(psi) + at.z0)[taken]
    rim_r = radius + (abs(across[0]) + abs(across[1])) * half
    rim_z = radius + (abs(upward[0]) + abs(upward[1])) * half
    depth = slack - sign * height[taken]
    level = sign * z + depth - slack <= rim_z + slack
    outside = r + rim_r + part * slack >= rho[taken]
    meets = (level & outside) | (_from_robot_axis(g, r) <= rim_r)
    deepest = float(depth[meets].max()) if meets.any() else 0.0
    return CounterweightClearance(
        inward=float(r.max()) + rim_r,
        outward=rim_r - float(r.min()),
        low=float(z.min()) - rim_z,
        high=float(z.max()) + rim_z,
        clear_depth=np.inf if deepest >= float(depth.max()) else deepest,
    )


def _distances(geometry: Geometry) -> tuple[float, float]:
    """Return the least and largest distance of joint 5 from its leg axis [m].

    With the platform at the center it is the radius of the singular circle, and within that circle
    at most twice as much. That radius is largest at the singular angle, which no turn passes.
    """
    rb, rp = geometry.base_radius, geometry.platform_radius
    circle = np.sqrt(rb**2 - rp**2) if rp < rb else rb + rp
    most = min(2 * float(circle), (geometry.magnification - 1) * geometry.stroke)
    return geometry.axis_clearance, most


def _from_robot_axis(geometry: Geometry, r: Array) -> Array:
    """Return least distances from the robot's axis of points at r from their leg axis [m].

    Within the singular circle a leg points at most 90 degrees away from where it points with the
    platform at the center, and there at most asin(R_pl/R_b) away from the robot's axis.
    """
    rb, rp = geometry.base_radius, geometry.platform_radius
    if rp >= rb:
        return rb - np.abs(r)
    return np.where(r > 0, rb - r, np.sqrt(rb**2 - rp**2))
