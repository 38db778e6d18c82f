"""The payload: a drum whose volume is in proportion to its mass."""

from __future__ import annotations

from functools import lru_cache
from typing import Final

import numpy as np

from paminsa_viz.meshes import layers as at
from paminsa_viz.meshes.library import fixed_part
from paminsa_viz.meshes.solids import Array, turn
from paminsa_viz.model.design import Geometry, KneeBranch

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
