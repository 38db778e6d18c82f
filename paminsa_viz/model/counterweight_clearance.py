"""The room that a counterweight needs in its leg's plane, over the singularity-free workspace.

A leg has two freedoms in its plane: the elevations phi of B8 and psi of B4. Every point of a bar is
a cos phi + b cos psi from the leg axis toward the platform, and c sin phi + d sin psi above the
guides. On a grid of cells (phi, psi) no point moves by more than |a| + |b|, or |c| + |d|, times
half a cell, so that what is found at the cells' middles, with that much added, holds for all poses.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Geometry
from paminsa_viz.model.leg_points import counterweight_point
from paminsa_viz.model.parameters import Counterweight

CELLS = 480
"""Cells of a full turn: what they add to distances is some 5 mm on a robot of Appendix 4's size."""


@dataclass(frozen=True)
class CounterweightClearance:
    """Bounds that no pose of the singularity-free workspace exceeds.

    It is what can be reached from home without passing a type-2 singularity, on the natural side
    of the guides: joints 5 below them with the lower knee, above them with the upper one.

    Attributes:
        inward: Farthest from the leg axis toward the platform, negative if it stays outward [m].
        outward: Farthest from the leg axis away from the platform, negative if it stays inward [m].
        low, high: Lowest and highest, from the plane of the guides up [m].
        clear_depth: Distance of joints 5 from the plane of the guides beyond which it can meet
            neither the platform nor the robot's axis, where M4 stands [m]: it stays on the guides'
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
    beside = r + rim_r + part * slack >= rho[taken]
    meets = (level & beside) | (_from_robot_axis(g, r) <= rim_r)
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
