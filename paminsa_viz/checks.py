"""Checks of arguments that are no arrays, each in one line: which, what is allowed, what came.

Those of arrays are in `model.arrays`, those of robots in `model.arguments`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

import numpy as np

from paminsa_viz.errors import InvalidInput


def kind_of(value: object) -> str:
    """Return the type of a value that is refused, with its article."""
    name = type(value).__name__
    return f"{'an' if name[0] in 'aeiouAEIOU' else 'a'} {name}"


def require_kind(value: object, argument: str, *kinds: type) -> None:
    """Raise `InvalidInput` unless a value is of one of some types."""
    if not isinstance(value, kinds):
        allowed = " or ".join(kind.__name__ for kind in kinds)
        article = "an" if allowed[0] in "aeiouAEIOU" else "a"
        raise InvalidInput(argument, f"{article} {allowed} is needed, not {kind_of(value)}")


def require_each(values: Iterable[Any], argument: str, *kinds: type) -> None:
    """Raise `InvalidInput` unless values are a list or tuple of such types."""
    allowed = " or ".join(kind.__name__ for kind in kinds)
    if not isinstance(values, list | tuple):
        raise InvalidInput(argument, f"a list of {allowed} is needed, not {kind_of(values)}")
    for value in values:
        if not isinstance(value, kinds):
            raise InvalidInput(argument, f"each has to be a {allowed}, not {kind_of(value)}")


def require_count(value: Any, argument: str, most: int) -> None:
    """Raise `InvalidInput` unless a value is a whole number from 1 to the most."""
    whole = isinstance(value, int | np.integer) and not isinstance(value, bool)
    if not (whole and 1 <= value <= most):
        raise InvalidInput(argument, f"1 to {most} are possible, not {value!r}")


def require_positive(value: Any, argument: str, what: str = "a number above 0") -> None:
    """Raise `InvalidInput` unless a value is a finite number above 0.

    Args:
        value: The value.
        argument: Its name.
        what: What is needed, in words.
    """
    number = isinstance(value, int | float | np.integer | np.floating) and not isinstance(
        value, bool
    )
    if not (number and math.isfinite(value) and value > 0):
        raise InvalidInput(argument, f"{what} is needed, not {value!r}")
