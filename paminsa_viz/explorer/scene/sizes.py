"""How large symbols are drawn: arrows, handles and marks, which are no part of the machine."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.model import Geometry
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.resizing import length_ratio

LEAST: Final = 0.5
"""Smallest size beside that of the bodies: bars and motors are as thick however short they are."""

_FIRST: Final = 0.09
"""Distance of the first label below the platform's center [m]."""

_LINE: Final = 0.056
"""Height of a label in the 3D view, where all of the robot is in a small window [m]."""

LABELS_BELOW: Final = (
    "drive_errors", "escape_twist", "force_polygon", "mode_shape", "deflection", "compliance",
    "wrench_solid",
)  # fmt: skip
"""Layers whose labels are below the platform, from its center downward."""


def symbol_size(geometry: Geometry) -> float:
    """Return how large symbols are, next to those at Appendix 4's lengths.

    In proportion to its lengths.
    """
    bodies = geometry.body_scale
    return bodies * round(max(length_ratio(geometry) / bodies, LEAST), 2)


def below(center: ArrayLike, layer: str, size: float) -> Array:
    """Return where the label of one of `LABELS_BELOW` is, clear of the others, (3,) [m].

    Args:
        center: The platform's center (3,) [m].
        layer: Key of the layer.
        size: Of the symbols, see `symbol_size`.
    """
    down = _FIRST + _LINE * LABELS_BELOW.index(layer)
    return np.asarray(center) - [0.0, 0.0, size * down]
