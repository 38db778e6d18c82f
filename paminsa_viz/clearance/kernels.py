"""The search for least distances, compiled by Numba once that pays."""

from __future__ import annotations

from functools import cache
from typing import Any

from paminsa_viz.clearance import search
from paminsa_viz.model import backend

WORK = 3_000
"""Poses of a simple formula that a pose counts as where compiling is weighed against Python."""


def least_distances(poses: int) -> Any:
    """Return `search.least_distances` for a number of poses: compiled if that pays."""
    if backend.worth_compiled(WORK * poses):
        return compiled()
    return search.least_distances


@cache
def compiled() -> Any:
    """Return the compiled search, from disk if it is there."""
    from numba import njit  # slow to load

    from paminsa_viz.model.compiled import OPTIONS, register

    function = search.least_distances
    digest = register(function, inline=False)

    @njit(**OPTIONS)
    def least(s, position, quaternion, first, second, slot, distance, nearest, points):  # type: ignore[no-untyped-def]
        if digest < 0:
            return
        function(s, position, quaternion, first, second, slot, distance, nearest, points)

    return least
