"""How large symbols are drawn: arrows, handles and marks, which are no part of the machine."""

from __future__ import annotations

from typing import Final

from paminsa_viz.model import APPENDIX_4, Geometry

LEAST: Final = 0.5
"""Smallest size: bars and motors of a small robot are drawn as thick as those of any."""


def symbol_size(geometry: Geometry) -> float:
    """Return how large symbols are, next to those at Appendix 4's lengths.

    In proportion to crank plus coupler, with which the reach grows.
    """
    return round(max(_span(geometry) / _span(APPENDIX_4.geometry), LEAST), 2)


def _span(geometry: Geometry) -> float:
    return geometry.crank_length + geometry.coupler_length
