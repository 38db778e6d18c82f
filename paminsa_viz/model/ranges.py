"""Ranges of a design's numbers by their units; outside of them formulas overflow or lose digits."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from paminsa_viz.errors import InvalidDesign

LARGEST = {
    "": 100.0, "m": 100.0, "kg": 1e4, "kg m^2": 1e4, "m/s^2": 1e3,
    "Pa": 1e18, "N/m": 1e18, "N m/rad": 1e18, "kg/m^3": 1e5, "m^2": 1.0, "m^4": 1.0,
}  # fmt: skip
"""Largest number of each unit; any other unit has `LARGEST_OTHER`."""

SMALLEST_OF = {"m^2": 1e-10, "m^4": 1e-18}
"""Smallest number of a unit where zero is refused, if it is not `SMALLEST`."""

LARGEST_OTHER = 1e4

SMALLEST = 1e-6
"""Smallest length, k - 1 or speed where zero is refused."""

SMALLEST_LOAD = 1e-30
"""Smallest mass, inertia and gravity that is not zero: all torques are products of them."""


def possible_range(unit: str, positive: bool) -> tuple[float, float]:
    """Return the smallest number that is not zero, and the largest [SI]."""
    least = SMALLEST_OF.get(unit, SMALLEST) if positive else 0.0
    loads = ("kg", "kg m^2", "m/s^2")
    return (SMALLEST_LOAD if unit in loads else least), LARGEST.get(unit, LARGEST_OTHER)


def range_text(least: float, most: float, unit: str, *, positive: bool, signed: bool) -> str:
    """Return what is needed of a number in a range, in words; ends and unit as they are read."""
    if signed:
        text = f"a finite number of at most {most:g} in size is needed"
    elif positive:
        text = f"a finite number above 0, from {least:g} to {most:g}, is needed"
    else:
        text = f"a finite number of at least 0 and at most {most:g} is needed"
    return f"{text} [{unit}]" if unit else text


def checked_number(
    value: Any,
    path: str,
    limits: tuple[float, float] | None,
    *,
    unit: str,
    positive: bool,
    signed: bool,
    **_: Any,
) -> float:
    """Return a number as a float.

    Raises:
        InvalidDesign: If it is none, or not in its range.
    """
    least, most = limits or possible_range(unit, positive)
    number = math.nan
    if isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(value, bool):
        try:
            number = float(value)
        except OverflowError:
            number = math.inf
    if signed:
        possible = abs(number) <= most
    else:
        possible = (number == 0 and not positive) or least <= number <= most
    if possible:
        return number
    allowed = range_text(least, most, unit, positive=positive, signed=signed)
    if 0 < number < least and not positive:
        allowed += f"; below {least:g} it has to be 0"
    raise InvalidDesign(path, value, allowed)
