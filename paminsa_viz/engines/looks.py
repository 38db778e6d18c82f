"""Looks of the links in other programs' files: colors, and where each rod stands."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from paminsa_viz.engines.mechanism import PLATFORM, Link, Point, Rod
from paminsa_viz.palette import LEG_COLORS, LIFT_COLOR, rgb
from paminsa_viz.palette import PLATFORM as PLATFORM_COLOR

LEAST_ROD = 1e-9
"""Shortest rod that is drawn as one [m]; MuJoCo's own limit is 1e-14 m."""


def link_color(link: Link) -> list[float]:
    """Return red, green and blue of a link, 0 to 1."""
    if link.name == PLATFORM:
        color = PLATFORM_COLOR
    else:
        color = LIFT_COLOR if link.leg is None else LEG_COLORS[link.leg]
    return [round(channel / 255, 4) for channel in rgb(color)]


class Bar(NamedTuple):
    """A rod as a cylinder along z: middle [m], turn from z to the rod, length and radius [m]."""

    middle: Point
    turn: Rotation
    length: float
    radius: float


def as_cylinder(rod: Rod) -> Bar | None:
    """Return a rod as a cylinder, or None where it has no length."""
    start, end = np.asarray(rod.start, float), np.asarray(rod.end, float)
    length = math.dist(rod.start, rod.end)
    if length < LEAST_ROD:
        return None
    turn = Rotation.align_vectors([(end - start) / length], [(0.0, 0.0, 1.0)])[0]
    x, y, z = (0.5 * (start + end)).tolist()
    return Bar((x, y, z), turn, length, rod.radius)
