"""Numbers that a page sends inside a message of its own script, read with every doubt."""

from __future__ import annotations

import math
from typing import Any


def number(value: Any) -> float | None:
    """Return a finite number as a float, or None for anything else."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return None
    try:
        read = float(value)
    except OverflowError:  # JSON knows integers beyond all floats
        return None
    return read if math.isfinite(read) else None
