"""Checks on the arrays that come in, and the fold between any batch shape and a flat list."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from paminsa_viz.errors import InvalidInput

Array = NDArray[np.float64]

Pose: TypeAlias = tuple[float, float, float, float]
"""(x, y, theta, z) as plain numbers, [m, m, rad, m] where nothing else is said."""


def as_vectors(values: ArrayLike, argument: str, size: int = 4) -> Array:
    """Return ``values`` as float64 with a last axis of ``size`` entries.

    Raises:
        InvalidInput: If the values are no real numbers, or the last axis has another length.
    """
    array = as_numbers(values, argument)
    if array.ndim == 0 or array.shape[-1] != size:
        raise InvalidInput(
            argument, f"the last axis has to have {size} entries; the shape is {array.shape}"
        )
    return array


def own_vectors(values: ArrayLike, argument: str, size: int = 4) -> Array:
    """Return what `as_vectors` does as an array of its own, for results that keep it.

    Otherwise such a result would change with the caller's array, often half of it.

    Raises:
        InvalidInput: As of `as_vectors`.
    """
    return as_vectors(values, argument, size).copy()


def as_pose(values: ArrayLike, argument: str = "pose") -> Array:
    """Return one pose as float64, (4,).

    Raises:
        InvalidInput: If the values are no real numbers, or not one pose.
    """
    pose = as_vectors(values, argument)
    if pose.ndim > 1:
        raise InvalidInput(argument, f"one pose (4,) is needed; got {pose.shape}")
    return pose


def as_numbers(values: ArrayLike, argument: str) -> Array:
    """Return ``values`` as float64 of any shape; what a masked array hides is NaN.

    Raises:
        InvalidInput: If the values are no real numbers.
    """
    try:
        array = np.asarray(values)
    except ValueError:
        raise InvalidInput(argument, "the rows have different lengths") from None
    if array.dtype.kind not in "buif":
        came = array.dtype.name if array.dtype.kind not in "OSU" else _of_objects(array)
        raise InvalidInput(argument, f"real numbers are needed, not {came}")
    numbers = array.astype(np.float64, copy=False)
    if isinstance(values, np.ma.MaskedArray):  # or what lies below the mask would count
        return np.where(np.ma.getmaskarray(values), np.nan, numbers)
    return numbers


def _of_objects(array: NDArray[Any]) -> str:
    """Return what is in an array of texts or objects, as mixed columns or a None make one."""
    if array.dtype.kind != "O":  # such as cells of a CSV file
        return "text: array.astype(float) makes numbers of it"
    for value in array.flat:
        if not isinstance(value, int | float | np.number):
            return "None" if value is None else type(value).__name__
    return "objects: array.astype(float) makes them numbers"


def aligned(**vectors: Any) -> list[Array]:
    """Broadcast vectors of four against each other, each (..., 4).

    Raises:
        InvalidInput: If a vector is unusable or the batch shapes do not fit each other.
    """
    arrays = {name: as_vectors(values, name) for name, values in vectors.items()}
    try:
        shape = np.broadcast_shapes(*(array.shape for array in arrays.values()))
    except ValueError:
        shapes = ", ".join(f"{name} {array.shape}" for name, array in arrays.items())
        raise InvalidInput(
            next(iter(arrays)), f"the batch shapes do not fit each other: {shapes}"
        ) from None
    return [np.broadcast_to(array, shape) for array in arrays.values()]


def together(**vectors: Any) -> tuple[tuple[int, ...], list[Array]]:
    """Broadcast vectors of four against each other and flatten their batch axes.

    Returns:
        The batch shape, and each vector as (n, 4).

    Raises:
        InvalidInput: If a vector is unusable or the batch shapes do not fit each other.
    """
    arrays = aligned(**vectors)
    return arrays[0].shape[:-1], [array.reshape(-1, 4) for array in arrays]


def unfolded(arrays: Iterable[Any], shape: tuple[int, ...]) -> tuple[Any, ...]:
    """Return arrays (n, ...) of a list with a batch shape instead, (*shape, ...)."""
    return tuple(array.reshape((*shape, *array.shape[1:])) for array in arrays)


def in_blocks(
    function: Callable[[Array], Iterable[Any]], vectors: Array, size: int
) -> tuple[Any, ...]:
    """Return arrays (..., results) for vectors (..., 4), worked out a block of a list at a time.

    Args:
        function: Takes vectors (n, 4) and returns arrays (n, results).
        vectors: (..., 4).
        size: Vectors of a block, which bounds the memory.
    """
    flat = vectors.reshape(-1, vectors.shape[-1])
    found = by_blocks(lambda part: function(flat[part]), len(flat), size)
    return unfolded(found, vectors.shape[:-1])


def by_blocks(
    function: Callable[[slice], Iterable[Any]], count: int, size: int
) -> Iterator[NDArray[Any]]:
    """Yield arrays (count, ...), each joined from what is worked out a block at a time.

    Args:
        function: Takes which of the ``count`` are worked out and returns arrays (n, ...) of them.
        count: How many there are.
        size: How many are in a block, which bounds the memory.
    """
    parts = [function(slice(i, i + size)) for i in range(0, max(count, 1), size)]
    return (np.concatenate(values) for values in zip(*parts, strict=True))


def as_kernels_take(array: Array) -> Array:
    """Return an array contiguous and read-only: for another kind a kernel is compiled again."""
    found = np.ascontiguousarray(array).view()
    found.flags.writeable = False
    return found
