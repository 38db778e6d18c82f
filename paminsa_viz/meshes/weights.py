"""Counterweights: discs on the bars, or beyond their ends on a stub of the bar's tube."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Final

import numpy as np

from paminsa_viz.meshes import layers as at
from paminsa_viz.meshes.part import MeshPart
from paminsa_viz.meshes.solids import ACROSS, ALONG, moved, rod
from paminsa_viz.model.counterweight_clearance import counterweight_clearance
from paminsa_viz.model.design import Geometry, KneeBranch
from paminsa_viz.model.leg_points import bar_length
from paminsa_viz.model.parameters import BAR_ENDS, Counterweight

DENSITY: Final = 7850.0
"""Of steel; turns a mass into the size of its disc [kg/m^3]."""

SMALLEST: Final = 0.004
"""Radius below which no disc is drawn any smaller [m]; that of 10 g."""

SEGMENTS: Final = 22
HUB: Final = 0.34
"""Radius of the colored hub as a part of the disc's."""


def disc_radius(mass: float) -> float:
    """Return the radius of a disc of a mass [kg]; as thick as a barrel, whatever its mass [m].

    So it stays within its bar's layer, and its volume is in proportion to the mass.
    """
    return max(float(np.sqrt(max(mass, 0.0) / (DENSITY * np.pi * at.BARREL))), SMALLEST)


def place_along(geometry: Geometry, weight: Counterweight) -> float:
    """Return where a counterweight is on its bar: x in the bar's frame [m].

    See `paminsa_viz.meshes.placement` for the frames.
    """
    length = bar_length(geometry, weight.bar)
    # B3's frame is at joint 3, the others' at their bar's first end.
    first = -length * (1 - 1 / geometry.magnification) if weight.bar == "b3" else 0.0
    if weight.joint == BAR_ENDS[weight.bar][0]:
        return first - weight.beyond
    return first + length + weight.beyond


def counterweight(geometry: Geometry, weight: Counterweight) -> MeshPart:
    """Return a counterweight in its bar's frame [m]."""
    x, y = place_along(geometry, weight), at.LAYER[weight.bar]
    half, radius = at.BARREL / 2, disc_radius(weight.mass)
    part = MeshPart()
    if weight.beyond > at.BARREL_RADIUS:
        end = x - weight.beyond if weight.joint == BAR_ENDS[weight.bar][1] else x + weight.beyond
        low, high = sorted((x, end))
        tube = rod(at.TUBE_RADIUS[weight.bar], low, high, 0.0, 12)
        part.add("accent", moved(tube, (0.0, y, 0.0), ALONG))
    disc = rod(radius, -half, half, 0.002, SEGMENTS)
    hub = rod(HUB * radius, -half - 0.001, half + 0.001, 0.0, 14)
    part.add("body", moved(disc, (x, y, 0.0), ACROSS))
    return part.add("accent", moved(hub, (x, y, 0.0), ACROSS))


@lru_cache(maxsize=64)
def counterweight_glb(geometry: Geometry, weight: Counterweight, color: str) -> bytes:
    """Return a counterweight as a GLB in its bar's frame, its hub in ``color`` (``#rrggbb``)."""
    return counterweight(geometry, weight).glb(color)


def clearance_text(geometry: Geometry, weight: Counterweight) -> str:
    """Return a text on the clearance of a counterweight as a disc of steel.

    See `counterweight_clearance`; the text holds in every pose.
    """
    radius = disc_radius(weight.mass)
    room = counterweight_clearance(geometry, weight, radius)
    if room is None:
        return "The robot can take no pose."
    extent = (
        f"A steel disc of {_mm(radius)} radius there reaches at most {_mm(room.inward)} inward and "
        f"{_mm(room.outward)} outward of its leg axis, {_mm(-room.low)} below and "
        f"{_mm(room.high)} above the guides."
    )
    meet = "can meet neither the platform nor the robot's axis, where M4 stands"
    if room.clear_depth == 0:
        return f"{extent} It {meet}."
    if not np.isfinite(room.clear_depth):
        return f"{extent} It may run into the platform, or M4, at any height."
    z = -geometry.knee.sign * room.clear_depth - geometry.platform_joint_height
    side, bound = ("below", np.floor) if geometry.knee is KneeBranch.LOWER else ("above", np.ceil)
    return f"{extent} It {meet}, while the platform is {side} z = {_mm(z, bound)}."


def _mm(length: float, rounded: Callable[[float], float] = np.ceil) -> str:
    """Return a length in whole mm, rounded to the safe side."""
    return f"{rounded(round(1e3 * length, 6)):.0f} mm".replace("-", "\N{MINUS SIGN}")
