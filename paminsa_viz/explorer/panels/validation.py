"""Numbers that a page sends in messages of its own script or in vectors, read with every doubt."""

from __future__ import annotations

import math
from typing import Any

from paminsa_viz.model import InvalidInput


def number(value: Any) -> float | None:
    """Return a finite number as a float, or None for anything else."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return None
    try:
        read = float(value)
    except OverflowError:  # JSON knows integers beyond all floats
        return None
    return read if math.isfinite(read) else None


def pair(value: Any) -> tuple[float, float]:
    """Return the two finite numbers of a vector input.

    Raises:
        InvalidInput: If the page sent something else.
    """
    if not isinstance(value, (tuple, list)) or len(value) != 2:
        raise InvalidInput("input", "two numbers are needed")
    first, second = number(value[0]), number(value[1])
    if first is None or second is None:
        raise InvalidInput("input", "two finite numbers are needed")
    return first, second
