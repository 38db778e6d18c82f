"""Sizes and places of what hangs on the robot: the payload, and counterweights on the bars."""

from __future__ import annotations

from typing import Final

import numpy as np

from paminsa_viz.dimensions import layers as at
from paminsa_viz.dimensions.body_scale import times_body_scale
from paminsa_viz.dimensions.fixed_parts import PAYLOAD_RATIO
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Geometry, KneeBranch
from paminsa_viz.model.leg_points import bar_length
from paminsa_viz.model.parameters import BAR_ENDS, Counterweight

LOAD_DENSITY: Final = 3500.0
"""Density that turns the payload's mass into the size it is drawn at [kg/m^3]."""

PAYLOAD_HEIGHT: Final = PAYLOAD_RATIO * (1.0 / LOAD_DENSITY / (PAYLOAD_RATIO * np.pi)) ** (1 / 3)
"""Height of a payload of 1 kg: a drum `PAYLOAD_RATIO` times as high as its radius [m]."""


def payload_scale(mass: float) -> float:
    """Return the size of the payload's drum for a mass [kg]; its volume is in proportion."""
    return float(np.cbrt(max(mass, 0.0)))


@times_body_scale
def payload_offset(geometry: Geometry) -> tuple[float, float, float]:
    """Return where the payload's upper face sits in the platform's frame [m].

    It hangs below the platform where the robot hangs, and stands on it with the upper knee
    (there the drum is turned over).
    """
    top = geometry.platform_joint_height - at.PLATE_BELOW_5
    below = geometry.knee is KneeBranch.LOWER
    return (0.0, 0.0, top - 0.0215 if below else top + 0.0025)


def payload_center(geometry: Geometry, mass: float) -> Array:
    """Return the middle of the payload in the platform's frame, (3,) [m]."""
    x, y, top = payload_offset(geometry)
    half = PAYLOAD_HEIGHT * payload_scale(mass) / 2
    return np.array([x, y, top - half if geometry.knee is KneeBranch.LOWER else top + half])


STEEL: Final = 7850.0
"""Density that turns a counterweight's mass into the size of its disc [kg/m^3]."""

SMALLEST: Final = 0.004
"""Radius below which no disc is drawn any smaller [m]; that of 10 g."""


def disc_radius(mass: float, scale: float = 1.0) -> float:
    """Return the radius of a disc of a mass [kg]; as thick as a barrel, whatever its mass [m].

    So it stays within its bar's layer, and its volume is in proportion to the mass.

    Args:
        mass: Its mass [kg].
        scale: Size of the robot's bodies over the prototype's.
    """
    own = max(mass, 0.0) / scale**3
    return scale * max(float(np.sqrt(own / (STEEL * np.pi * at.BARREL))), SMALLEST)


def place_along(geometry: Geometry, weight: Counterweight) -> float:
    """Return where a counterweight is on its bar: x in the bar's frame [m].

    See `paminsa_viz.dimensions.placement` for the frames.
    """
    length = bar_length(geometry, weight.bar)
    # B3's frame is at joint 3, the others' at their bar's first end.
    first = -length * (1 - 1 / geometry.magnification) if weight.bar == "b3" else 0.0
    if weight.joint == BAR_ENDS[weight.bar][0]:
        return first - weight.beyond
    return first + length + weight.beyond


def stub(geometry: Geometry, weight: Counterweight) -> tuple[float, float] | None:
    """Return from where to where a stub carries a counterweight beyond its bar, x [m].

    None for one that sits on the bar, or on the barrel at its end.
    """
    if weight.beyond <= at.BARREL_RADIUS * geometry.body_scale:
        return None
    x = place_along(geometry, weight)
    outward = weight.joint == BAR_ENDS[weight.bar][1]
    end = x - weight.beyond if outward else x + weight.beyond
    return min(x, end), max(x, end)
