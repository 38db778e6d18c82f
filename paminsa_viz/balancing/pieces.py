"""Convex functions of a program's state, and the half-spaces that enclose their epigraphs.

A state s (d,) is affine in what may change. A piece is a convex function of s (and of the amounts
z) that a linear programme can close in on: it has auxiliary unknowns, the first of which is never
less than its value once enough of its `Rows` are there. `cuts` returns the rows that a trial
solution breaks; a trial that breaks none is exact.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.model.arrays import Array

BLOCKS = 32
"""Parts of a list of samples of which each may give a row in one round."""

FIRST_SLOPES = (-1.0, -0.5, 0.5, 1.0)
"""Ratios v_i / |v| at which a norm is enclosed from the start."""


class Rows(NamedTuple):
    """Inequalities state . s + amounts . z + own . aux <= rhs, one a row."""

    state: Array  # (r, d)
    amounts: Array  # (r, carriers)
    own: Array  # (r, aux of the piece)
    rhs: Array  # (r,)


class Piece(Protocol):
    """A convex function that a programme can make small or hold below a limit."""

    @property
    def aux(self) -> int:
        """Number of auxiliary unknowns."""
        ...

    def value(self, state: Array, amounts: Array) -> float:
        """Return the function at one state (d,) and its amounts (carriers,)."""
        ...

    def bounds(self, low: Array, high: Array) -> tuple[float, float]:
        """Return numbers that all auxiliary unknowns lie between for states in a box."""
        ...

    def first(self, size: int, carriers: int) -> Rows:
        """Return rows to start with, for states of a size."""
        ...

    def cuts(self, state: Array, amounts: Array, aux: Array, slack: float) -> Rows:
        """Return rows that a trial solution breaks by more than ``slack``."""
        ...


def rows(state: Array, own: Array, rhs: Array, amounts: Array | int) -> Rows:
    """Make rows; ``amounts`` may be the number of carriers, on which the rows then do not bear."""
    if isinstance(amounts, int):
        amounts = np.zeros((len(rhs), amounts))
    return Rows(state, amounts, own, rhs)


def _largest(matrix: Array, offset: Array, low: Array, high: Array) -> tuple[Array, Array]:
    """Return the least and the largest of matrix . s + offset over a box of s."""
    center, reach = 0.5 * (low + high), 0.5 * (high - low)
    middle, spread = matrix @ center + offset, np.abs(matrix) @ reach
    return middle - spread, middle + spread


@dataclass(frozen=True, eq=False)
class Largest:
    """max_i |matrix_i . s + offset_i|, or without the bars if not ``absolute``."""

    matrix: Array  # (m, d)
    offset: Array  # (m,)
    absolute: bool = True

    aux = 1

    def samples(self, state: Array) -> Array:
        """Return what the largest is taken of, (m,)."""
        return self.matrix @ state + self.offset

    def value(self, state: Array, amounts: Array) -> float:
        """See `Piece`."""
        found = self.samples(state)
        return float(np.abs(found).max() if self.absolute else found.max())

    def bounds(self, low: Array, high: Array) -> tuple[float, float]:
        """See `Piece`."""
        least, most = _largest(self.matrix, self.offset, low, high)
        if self.absolute:
            return 0.0, float(max(np.abs(least).max(), np.abs(most).max()))
        return float(least.max()), float(most.max())

    def _rows(self, index: NDArray[np.intp], sign: Array, carriers: int) -> Rows:
        return rows(
            sign[:, None] * self.matrix[index],
            -np.ones((len(index), 1)),
            -sign * self.offset[index],
            carriers,
        )

    def first(self, size: int, carriers: int) -> Rows:
        """See `Piece`."""
        few = np.arange(len(self.offset) if len(self.offset) <= 4 else 0)
        signs = [1.0, -1.0] if self.absolute else [1.0]
        index = np.tile(few, len(signs))
        return self._rows(index, np.repeat(signs, len(few)), carriers)

    def cuts(self, state: Array, amounts: Array, aux: Array, slack: float) -> Rows:
        """See `Piece`."""
        found = self.samples(state)
        size = np.abs(found) if self.absolute else found
        # the largest of each part of the list, for neighbors say almost the same
        starts = np.unique(np.linspace(0, len(size), BLOCKS + 1).astype(int)[:-1])
        ends = np.append(starts[1:], len(size))
        index = np.array([a + np.argmax(size[a:b]) for a, b in zip(starts, ends, strict=True)])
        index = index[size[index] > aux[0] + slack]
        sign = np.where(found[index] < 0, -1.0, 1.0) if self.absolute else np.ones(len(index))
        return self._rows(index, sign, len(amounts))


@dataclass(frozen=True, eq=False)
class Norm:
    """The Euclidean norm |matrix . s + offset|.

    With t for the norm and v for the vector: v_i^2 <= s_i t and sum s_i <= t. Each of these cones
    has tangents with one parameter, the ratio v_i / t, so that few of them enclose it closely.
    """

    matrix: Array  # (m, d)
    offset: Array  # (m,)

    @property
    def aux(self) -> int:
        """See `Piece`."""
        return 1 + len(self.offset)

    def value(self, state: Array, amounts: Array) -> float:
        """See `Piece`."""
        return float(np.linalg.norm(self.matrix @ state + self.offset))

    def bounds(self, low: Array, high: Array) -> tuple[float, float]:
        """See `Piece`."""
        least, most = _largest(self.matrix, self.offset, low, high)
        return 0.0, float(np.linalg.norm(np.maximum(np.abs(least), np.abs(most))))

    def _tangents(self, index: NDArray[np.intp], ratio: Array, carriers: int) -> Rows:
        """Return 2 q v_i - q^2 t - s_i <= 0 for ratios q."""
        own = np.zeros((len(index), self.aux))
        own[:, 0] = -(ratio**2)
        own[np.arange(len(index)), 1 + index] = -1.0
        twice = 2.0 * ratio
        return rows(twice[:, None] * self.matrix[index], own, -twice * self.offset[index], carriers)

    def first(self, size: int, carriers: int) -> Rows:
        """See `Piece`."""
        count = len(self.offset)
        ratios = np.tile(FIRST_SLOPES, count)
        tangents = self._tangents(np.repeat(np.arange(count), len(FIRST_SLOPES)), ratios, carriers)
        total = np.ones((1, self.aux))
        total[0, 0] = -1.0
        closing = rows(np.zeros((1, self.matrix.shape[1])), total, np.zeros(1), carriers)
        return stacked([closing, tangents])

    def cuts(self, state: Array, amounts: Array, aux: Array, slack: float) -> Rows:
        """See `Piece`."""
        v = self.matrix @ state + self.offset
        size = np.linalg.norm(v)
        ratio = v / size if size > 0 else np.zeros_like(v)
        broken = 2.0 * ratio * v - ratio**2 * aux[0] - aux[1:]
        index = np.flatnonzero(broken > slack / len(v))
        return self._tangents(index, ratio[index], len(amounts))


@dataclass(frozen=True, eq=False)
class PositivePartSum:
    """sum_i max(matrix_i . s + offset_i, 0), summed by neighboring samples first."""

    matrix: Array  # (m, d)
    offset: Array  # (m,)
    starts: NDArray[np.intp]  # first samples of the groups

    @property
    def aux(self) -> int:
        """See `Piece`."""
        return 1 + len(self.starts)

    def value(self, state: Array, amounts: Array) -> float:
        """See `Piece`."""
        return float(np.maximum(self.matrix @ state + self.offset, 0.0).sum())

    def bounds(self, low: Array, high: Array) -> tuple[float, float]:
        """See `Piece`."""
        _, most = _largest(self.matrix, self.offset, low, high)
        return 0.0, float(np.maximum(most, 0.0).sum())

    def first(self, size: int, carriers: int) -> Rows:
        """See `Piece`."""
        total = np.ones((1, self.aux))
        total[0, 0] = -1.0
        return rows(np.zeros((1, self.matrix.shape[1])), total, np.zeros(1), carriers)

    def cuts(self, state: Array, amounts: Array, aux: Array, slack: float) -> Rows:
        """See `Piece`."""
        found = self.matrix @ state + self.offset
        on = (found > 0).astype(np.float64)
        sums = np.add.reduceat(found * on, self.starts)
        index = np.flatnonzero(sums > aux[1:] + slack / len(self.starts))
        ends = np.append(self.starts[1:], len(found))
        own = np.zeros((len(index), self.aux))
        own[np.arange(len(index)), 1 + index] = -1.0
        matrix = np.empty((len(index), self.matrix.shape[1]))
        offset = np.empty(len(index))
        for row, i in enumerate(index):
            part = slice(self.starts[i], ends[i])
            matrix[row], offset[row] = on[part] @ self.matrix[part], on[part] @ self.offset[part]
        return rows(matrix, own, -offset, len(amounts))


@dataclass(frozen=True, eq=False)
class Deviations:
    """sum_i weight_i dist(z_i, [low_i, high_i]) of the amounts; infinite ends cost nothing."""

    low: Array  # (carriers,)
    high: Array
    weight: Array
    most: float  # no value is larger

    @property
    def aux(self) -> int:
        """See `Piece`."""
        return 1 + len(self.weight)

    def value(self, state: Array, amounts: Array) -> float:
        """See `Piece`."""
        return float(self.weight @ self.each(amounts))

    def each(self, amounts: Array) -> Array:
        """Return how far each amount is outside, (carriers,)."""
        return np.maximum(np.maximum(self.low - amounts, amounts - self.high), 0.0)

    def bounds(self, low: Array, high: Array) -> tuple[float, float]:
        """See `Piece`."""
        return 0.0, self.most

    def first(self, size: int, carriers: int) -> Rows:
        """See `Piece`."""
        count = len(self.weight)
        above, below = np.isfinite(self.high), np.isfinite(self.low)
        eye, column = np.eye(count), np.zeros((count, 1))
        own = np.hstack([column, -eye])
        total = np.concatenate([[-1.0], self.weight])[None]
        state = np.zeros((1 + above.sum() + below.sum(), size))
        return Rows(
            state,
            np.vstack([np.zeros((1, count)), eye[above], -eye[below]]),
            np.vstack([total, own[above], own[below]]),
            np.concatenate([[0.0], self.high[above], -self.low[below]]),
        )

    def cuts(self, state: Array, amounts: Array, aux: Array, slack: float) -> Rows:
        """See `Piece`; its first rows are all of them."""
        return rows(np.empty((0, len(state))), np.empty((0, self.aux)), np.empty(0), len(amounts))


def stacked(parts: list[Rows]) -> Rows:
    """Return rows one below the other."""
    return Rows(*(np.concatenate(column) for column in zip(*parts, strict=True)))
