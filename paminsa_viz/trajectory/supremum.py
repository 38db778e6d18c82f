"""The largest value that functions take along a curve, exact to rounding."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from paminsa_viz.model.arrays import Array

NODES = 480
"""Instants looked at first, shared between the pieces of a curve, some to each."""

LEAST_NODES = 24

GAP = 1e-12
"""How far from a break its two sides are looked at."""

_SLACK = 0.02  # local maxima this close to the largest are followed up
_PARTS = 16
_ROUNDS = 10


class Supremum(NamedTuple):
    """The largest value found, where, and in which column of the function's values."""

    value: float
    u: float
    column: int


def nodes(breaks: Array) -> Array:
    """Return instants between breaks, both sides of each among them, increasing."""
    each = max(LEAST_NODES, NODES // max(1, len(breaks) - 1))
    pieces = [
        np.linspace(begin + GAP, end - GAP, each)
        for begin, end in pairwise(breaks)
        if end - begin > 4 * GAP
    ]
    return np.concatenate([[breaks[0]], *pieces, [breaks[-1]]])


def supremum(function: Callable[[Array], Array], breaks: Array) -> Supremum:
    """Return the largest value of a function (n,) -> (n, columns) that is smooth between breaks.

    Brackets around every local maximum that may be the largest are cut into parts again and again,
    until they are a 1e-12th of a first step wide. Infinite values are fine, NaN are not.
    """
    u = nodes(breaks)
    values = function(u)
    top = values.max(axis=1)
    best = _best(values, u)
    if not np.isfinite(best.value) or best.value <= 0:
        return best
    high = top >= (1.0 - _SLACK) * best.value
    left = np.concatenate([[-np.inf], top[:-1]])
    right = np.concatenate([top[1:], [-np.inf]])
    peaks = np.flatnonzero(high & (top >= left) & (top >= right))
    low = u[np.maximum(peaks - 1, 0)]
    up = u[np.minimum(peaks + 1, len(u) - 1)]
    share = np.linspace(0.0, 1.0, _PARTS + 1)
    for _ in range(_ROUNDS):
        if low.size == 0:
            break
        inside = low[:, None] + (up - low)[:, None] * share
        values = function(inside.ravel())
        best = max(best, _best(values, inside.ravel()), key=lambda found: found.value)
        if not np.isfinite(best.value):
            break
        top = values.max(axis=1).reshape(inside.shape)
        which = np.argmax(top, axis=1)
        rows = np.arange(len(low))
        kept = top[rows, which] >= (1.0 - _SLACK) * best.value
        low = inside[rows, np.maximum(which - 1, 0)][kept]
        up = inside[rows, np.minimum(which + 1, _PARTS)][kept]
    return best


def _best(values: Array, u: Array) -> Supremum:
    row, column = divmod(int(np.argmax(values)), values.shape[1])
    return Supremum(float(values[row, column]), float(u[row]), column)
