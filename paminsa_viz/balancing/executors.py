"""Runs a function over a list anywhere: here, in a pool of processes, on a Dask cluster."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any, cast

from paminsa_viz.model.errors import InvalidInput

Mapper = Callable[[Callable[[Any], Any], Iterable[Any]], Iterable[Any]]
"""Like the built-in ``map``: results in the order of the items."""


def as_mapper(executor: Any) -> Mapper:
    """Return a map-like function for what a person has.

    Args:
        executor: None for this process; an executor of `concurrent.futures`; a client of
            ``dask.distributed``; or any function like the built-in ``map``.

    Raises:
        InvalidInput: If it is none of them.
    """
    if executor is None:
        return map
    spread: Any = getattr(executor, "map", None)
    gather: Any = getattr(executor, "gather", None)
    if spread is not None and gather is not None:

        def run(function: Callable[[Any], Any], items: Iterable[Any]) -> Iterable[Any]:
            return gather(spread(function, list(items), pure=False))

        return run
    if spread is not None:
        return spread
    if callable(executor):
        return cast(Mapper, executor)
    raise InvalidInput("executor", "something with a map method, or like map itself, is needed")


@dataclass(frozen=True)
class _Each:
    """Runs a function on every item of a part; can be sent to another process."""

    function: Callable[[Any], Any]

    def __call__(self, part: Sequence[Any]) -> list[Any]:
        return [self.function(item) for item in part]


def in_parts(mapper: Mapper, size: int) -> Mapper:
    """Return a mapper that hands out ``size`` items at a time, so that sending them pays."""

    def run(function: Callable[[Any], Any], items: Iterable[Any]) -> list[Any]:
        listed = list(items)
        parts = [listed[start : start + size] for start in range(0, len(listed), size)]
        return [value for part in mapper(_Each(function), parts) for value in part]

    return run
