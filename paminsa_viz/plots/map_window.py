"""The piece of the x-y plane that a map covers, and its cells."""

from __future__ import annotations

import numpy as np

from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Geometry
from paminsa_viz.model.reach import workspace_radius

LEAST_HALF_WIDTH = 0.1
"""Half width of a map of a robot that reaches next to nothing [m]."""


def half_width(geometry: Geometry) -> float:
    """Return half the side of the square that maps of a geometry cover [m].

    It holds every position within reach at any theta and z, so that a map stays where it is while
    they are dragged; rounded up to a centimeter.
    """
    radius = max(1.005 * workspace_radius(geometry), LEAST_HALF_WIDTH)
    return float(np.ceil(round(100 * radius, 6)) / 100)


def cell_centers(half: float, cells: int) -> Array:
    """Return the centers of ``cells`` equal cells from ``-half`` to ``half``, (cells,) [m]."""
    return half * ((2 * np.arange(cells) + 1) / cells - 1)
