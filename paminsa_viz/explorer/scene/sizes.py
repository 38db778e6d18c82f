"""How large symbols are drawn: arrows, handles and marks, which are no part of the machine."""

from __future__ import annotations

from typing import Final

from paminsa_viz.model import Geometry
from paminsa_viz.model.resizing import length_ratio

LEAST: Final = 0.5
"""Smallest size beside that of the bodies: bars and motors are as thick however short they are."""


def symbol_size(geometry: Geometry) -> float:
    """Return how large symbols are, next to those at Appendix 4's lengths.

    In proportion to its lengths.
    """
    bodies = geometry.body_scale
    return bodies * round(max(length_ratio(geometry) / bodies, LEAST), 2)
