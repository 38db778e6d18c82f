"""Checks of the arrays of a map."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from paminsa_viz.errors import InvalidInput


def equal_steps(name: str, data: ArrayLike) -> NDArray[np.float64]:
    """Return cell centers (n,) [m].

    Raises:
        InvalidInput: If they do not rise in equal steps.
    """
    array = np.asarray(data, dtype=np.float64)
    if array.ndim != 1 or array.size < 2 or not np.isfinite(array).all():
        raise InvalidInput(name, "a row of at least 2 finite numbers is needed [m]")
    steps = np.diff(array)
    mean = (array[-1] - array[0]) / steps.size
    if mean <= 0 or np.abs(steps - mean).max() > 1e-6 * mean:
        raise InvalidInput(name, "cell centers rising in equal steps are needed [m]")
    return array


def numbers_of_shape(
    name: str, data: ArrayLike | Sequence[float], shape: tuple[int, ...]
) -> NDArray[Any]:
    """Return numbers of a shape.

    Raises:
        InvalidInput: If they have another one.
    """
    array = np.asarray(data, dtype=np.float64)
    if array.shape != shape:
        raise InvalidInput(name, f"shape {shape} is needed, not {array.shape}")
    return array


def codes_of_shape(
    name: str, data: ArrayLike, shape: tuple[int, ...], least: int, most: int
) -> NDArray[Any]:
    """Return integers of a shape and range.

    Raises:
        InvalidInput: If they are something else.
    """
    array = np.asarray(data)
    integers = array.shape == shape and array.dtype.kind in "iub"
    if not integers or array.min() < least or array.max() > most:
        raise InvalidInput(name, f"integers from {least} to {most} of shape {shape} are needed")
    return array
