"""What hangs on the robot: the payload, and counterweights on the bars or on stubs beyond them."""

from __future__ import annotations

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
from paminsa_viz.dimensions.body_scale import geometry_over_scale, weight_over_scale
from paminsa_viz.kept import kept
from paminsa_viz.meshes.part import MeshPart, fixed_part
from paminsa_viz.meshes.solids import ACROSS, ALONG, Array, moved, rod, turn
from paminsa_viz.model.design import Geometry, KneeBranch
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
    scale = geometry.body_scale
    if scale != 1.0:
        own = weight_over_scale(weight, scale)
        return counterweight(geometry_over_scale(geometry), own).times(scale)
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
