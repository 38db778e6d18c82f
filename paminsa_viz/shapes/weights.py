"""Counterweights: discs on the bars, or beyond their ends on a stub of the bar's tube."""

from __future__ import annotations

from functools import lru_cache
from typing import Final

import numpy as np

from paminsa_viz.model.counterweight import BAR_ENDS, Counterweight
from paminsa_viz.model.design import Geometry
from paminsa_viz.model.leg_points import bar_length
from paminsa_viz.shapes import layers as at
from paminsa_viz.shapes.part import Part
from paminsa_viz.shapes.solids import ACROSS, ALONG, moved, rod

DENSITY: Final = 7850.0
"""Of steel; turns a mass into the size of its disc [kg/m^3]."""

SMALLEST: Final = 0.004
"""Radius below which no disc is drawn any smaller [m]; that of 10 g."""

SEGMENTS: Final = 22
HUB: Final = 0.34
"""Radius of the coloured hub as a part of the disc's."""


def disc_radius(mass: float) -> float:
    """Return the radius of a disc of a mass [kg]; as thick as a barrel, whatever its mass [m].

    So it stays within its bar's layer, and its volume is in proportion to the mass.
    """
    return max(float(np.sqrt(max(mass, 0.0) / (DENSITY * np.pi * at.BARREL))), SMALLEST)


def place_along(geometry: Geometry, weight: Counterweight) -> float:
    """Return where a counterweight is on its bar: x in the bar's frame [m].

    See `paminsa_viz.shapes.placement` for the frames.
    """
    length = bar_length(geometry, weight.bar)
    # B3's frame is at joint 3, the others' at their bar's first end.
    first = -length * (1 - 1 / geometry.magnification) if weight.bar == "b3" else 0.0
    if weight.joint == BAR_ENDS[weight.bar][0]:
        return first - weight.beyond
    return first + length + weight.beyond


def counterweight(geometry: Geometry, weight: Counterweight) -> Part:
    """Return a counterweight in its bar's frame [m]."""
    x, y = place_along(geometry, weight), at.LAYER[weight.bar]
    half, radius = at.BARREL / 2, disc_radius(weight.mass)
    part = Part()
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
def counterweight_glb(geometry: Geometry, weight: Counterweight, colour: str) -> bytes:
    """Return a counterweight as a GLB in its bar's frame, its hub in ``colour`` (``#rrggbb``)."""
    return counterweight(geometry, weight).glb(colour)
