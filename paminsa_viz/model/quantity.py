"""Declares the numbers of a design: their symbol, unit and name, and what is allowed for them."""

from __future__ import annotations

import math
from dataclasses import field, fields
from typing import Any

import numpy as np

from paminsa_viz.errors import InvalidDesign

_NUMBERS = (int, float, np.integer, np.floating)


def quantity(
    default: float | None,
    symbol: str,
    unit: str,
    label: str,
    *,
    positive: bool = False,
    signed: bool = False,
) -> Any:
    """Declare a design value with its paper symbol, SI unit and plain name.

    It may be zero unless it has to be ``positive``, and negative only if it is ``signed``.
    """
    return field(
        default=default,
        metadata={
            "symbol": symbol,
            "unit": unit,
            "label": label,
            "positive": positive,
            "signed": signed,
        },
    )


def check_numbers(group: object, path: str) -> None:
    """Raise `InvalidDesign` unless every quantity of ``group`` is a finite, allowed number.

    Whole numbers are stored as floats, or each of them would have the formulas compiled again.
    """
    for item in fields(group):  # type: ignore[arg-type]
        if "unit" not in item.metadata:
            continue
        value = getattr(group, item.name)
        if value is None and item.default is None:
            continue
        name = f"{path}.{item.name}"
        positive, signed = item.metadata["positive"], item.metadata["signed"]
        allowed = "a finite number is needed"
        if not signed:
            allowed = f"a finite number {'above' if positive else 'of at least'} 0 is needed"
        if item.metadata["unit"]:
            allowed += f" [{item.metadata['unit']}]"
        if isinstance(value, bool) or not isinstance(value, _NUMBERS):
            raise InvalidDesign(name, value, allowed)
        try:
            number = float(value)
        except OverflowError:
            number = math.inf
        out_of_range = not signed and (number < 0 or (positive and number == 0))
        if not math.isfinite(number) or out_of_range:
            raise InvalidDesign(name, value, allowed)
        object.__setattr__(group, item.name, number)
