"""Ticks of an axis over time."""

from __future__ import annotations

from dataclasses import dataclass

GRID_TEXT = "#3b4754"


@dataclass(frozen=True)
class Mark:
    """A tick: where it is, from 0 to 1 along the axis, what it says, and its value."""

    where: float
    words: str
    value: float
