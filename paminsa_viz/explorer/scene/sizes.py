"""How large symbols are drawn: arrows, handles and marks, which are no part of the machine."""

from __future__ import annotations

from typing import Final

from paminsa_viz.model import Geometry
from paminsa_viz.model.resizing import length_ratio

LEAST: Final = 0.5
"""Smallest size: bars and motors of a small robot are drawn as thick as those of any."""


def symbol_size(geometry: Geometry) -> float:
    """Return how large symbols are, next to those at Appendix 4's lengths.

    In proportion to its lengths.
    """
    return round(max(length_ratio(geometry), LEAST), 2)
