"""What hangs on the robot: the payload, and counterweights on the bars or on stubs beyond them."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np

from paminsa_viz.dimensions import layers as at
from paminsa_viz.dimensions.attached import (
    disc_radius,
    payload_offset,
    payload_scale,
    place_along,
    stub,
)
from paminsa_viz.kept import kept
from paminsa_viz.meshes.part import MeshPart, fixed_part
from paminsa_viz.meshes.solids import ACROSS, ALONG, Array, moved, rod, turn
from paminsa_viz.model.design import Geometry, KneeBranch
from paminsa_viz.model.leg_points import counterweight_clearance
from paminsa_viz.model.parameters import Counterweight


@lru_cache(maxsize=1)
def payload_glb() -> bytes:
    """Return the payload of 1 kg as a GLB in its own frame."""
    return fixed_part("payload").glb()


def payload_transform(geometry: Geometry, mass: float) -> Array:
    """Return the payload's size and place in the platform's frame as a matrix, (4, 4)."""
    over = geometry.knee is KneeBranch.UPPER
    out = np.eye(4)
    out[:3, :3] = payload_scale(mass) * (turn("x", np.pi) if over else np.eye(3))
    out[:3, 3] = payload_offset(geometry)
    return out


def counterweight(geometry: Geometry, weight: Counterweight) -> MeshPart:
    """Return a counterweight in its bar's frame [m]."""
    x, y = place_along(geometry, weight), at.LAYER[weight.bar]
    half, radius = at.BARREL / 2, disc_radius(weight.mass)
    part = MeshPart()
    ends = stub(geometry, weight)
    if ends is not None:
        tube = rod(at.TUBE_RADIUS[weight.bar], *ends, 0.0, 12)
        part.add("accent", moved(tube, (0.0, y, 0.0), ALONG))
    disc = rod(radius, -half, half, 0.002, 22)
    hub = rod(0.34 * radius, -half - 0.001, half + 0.001, 0.0, 14)
    part.add("body", moved(disc, (x, y, 0.0), ACROSS))
    return part.add("accent", moved(hub, (x, y, 0.0), ACROSS))


@kept(64)
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
