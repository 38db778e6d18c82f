"""What hangs on the robot: the payload, and counterweights on the bars or on stubs beyond them."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Final

import numpy as np

from paminsa_viz.meshes import layers as at
from paminsa_viz.meshes.library import fixed_part
from paminsa_viz.meshes.part import MeshPart
from paminsa_viz.meshes.solids import ACROSS, ALONG, Array, moved, rod, turn
from paminsa_viz.model.design import Geometry, KneeBranch
from paminsa_viz.model.leg_points import bar_length, counterweight_clearance
from paminsa_viz.model.parameters import BAR_ENDS, Counterweight

LOAD_DENSITY: Final = 3500.0
"""Density that turns the payload's mass into the size it is drawn at [kg/m^3]."""

PAYLOAD_HEIGHT: Final = 1.25 * (1.0 / LOAD_DENSITY / (1.25 * np.pi)) ** (1 / 3)
"""Height of a payload of 1 kg: a drum 1.25 times as high as its radius [m]."""


@lru_cache(maxsize=1)
def payload_glb() -> bytes:
    """Return the payload of 1 kg as a GLB in its own frame."""
    return fixed_part("payload").glb()


def payload_scale(mass: float) -> float:
    """Return the size of the payload's mesh for a mass [kg]; its volume is in proportion."""
    return float(np.cbrt(max(mass, 0.0)))


def payload_offset(geometry: Geometry) -> tuple[float, float, float]:
    """Return where the payload's upper face sits in the platform's frame [m].

    It hangs below the platform where the robot hangs, and stands on it with the upper knee
    (there the mesh is turned over).
    """
    top = geometry.platform_joint_height - at.PLATE_BELOW_5
    below = geometry.knee is KneeBranch.LOWER
    return (0.0, 0.0, top - 0.0215 if below else top + 0.0025)


def payload_transform(geometry: Geometry, mass: float) -> Array:
    """Return the payload's size and place in the platform's frame as a matrix, (4, 4)."""
    over = geometry.knee is KneeBranch.UPPER
    out = np.eye(4)
    out[:3, :3] = payload_scale(mass) * (turn("x", np.pi) if over else np.eye(3))
    out[:3, 3] = payload_offset(geometry)
    return out


def payload_center(geometry: Geometry, mass: float) -> Array:
    """Return the middle of the payload in the platform's frame, (3,) [m]."""
    x, y, top = payload_offset(geometry)
    half = PAYLOAD_HEIGHT * payload_scale(mass) / 2
    return np.array([x, y, top - half if geometry.knee is KneeBranch.LOWER else top + half])


STEEL: Final = 7850.0
"""Density that turns a counterweight's mass into the size of its disc [kg/m^3]."""

SMALLEST: Final = 0.004
"""Radius below which no disc is drawn any smaller [m]; that of 10 g."""


def disc_radius(mass: float) -> float:
    """Return the radius of a disc of a mass [kg]; as thick as a barrel, whatever its mass [m].

    So it stays within its bar's layer, and its volume is in proportion to the mass.
    """
    return max(float(np.sqrt(max(mass, 0.0) / (STEEL * np.pi * at.BARREL))), SMALLEST)


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
    disc = rod(radius, -half, half, 0.002, 22)
    hub = rod(0.34 * radius, -half - 0.001, half + 0.001, 0.0, 14)
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
    meet = "can meet neither the platform nor the robot's axis, where M4 is"
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
