"""How large symbols are drawn: arrows, handles and marks, which are no part of the machine."""

from __future__ import annotations

from typing import Final

from paminsa_viz.model import Geometry
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
"""Layers whose labels are below the platform on the screen, from its center downward."""


def symbol_size(geometry: Geometry) -> float:
    """Return how large symbols are, next to those at Appendix 4's lengths.

    In proportion to its lengths.
    """
    bodies = geometry.body_scale
    return bodies * round(max(length_ratio(geometry) / bodies, LEAST), 2)


def hanging(layer: str, size: float) -> float:
    """Return how far below the platform's center the label of one of `LABELS_BELOW` is [m].

    Args:
        layer: Key of the layer.
        size: Of the symbols, see `symbol_size`.
    """
    return size * (_FIRST + _LINE * LABELS_BELOW.index(layer))
