"""Convex functions of a program's state, and affine functions that support them from below.

A term F(s) is a sum of parts, each of which is enclosed by affine functions (`Cuts`) that are added
where a trial solution breaks them; a norm may go to the solver whole, as a second-order cone.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import Any, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.model.arrays import Array

BLOCKS = 32
"""Parts of a list of samples of which each may give a cut in one round."""


class Cuts(NamedTuple):
    """Affine functions matrix . s + offset, none of which exceeds its part of the term anywhere."""

    part: NDArray[np.intp]  # (r,)
    matrix: Array  # (r, d)
    offset: Array  # (r,)


@dataclass(frozen=True, eq=False)
class ConvexTerm(ABC):
    """A convex function of matrix . s + offset that a program can minimize or hold below a limit.

    It is the sum of ``parts`` functions, none of which is ever negative if ``nonnegative``.
    """

    matrix: Array  # (m, d)
    offset: Array  # (m,)

    @property
    def parts(self) -> int:
        return 1

    @property
    def nonnegative(self) -> bool:
        return True

    def at(self, state: Array) -> Array:
        """Return matrix . s + offset, (m,)."""
        return self.matrix @ state + self.offset

    def over(self, unit: float) -> Self:
        """Return the function divided by a number above 0."""
        return replace(self, matrix=self.matrix / unit, offset=self.offset / unit)

    @abstractmethod
    def value(self, state: Array) -> float:
        """Return the function at a state (d,)."""

    def most(self, state: Array) -> float:
        """Return what the function is of at states up to one (d,), if no shares cancel."""
        return replace(self, matrix=abs(self.matrix), offset=abs(self.offset)).value(abs(state))

    def cuts(self, state: Array, known: Array, slack: float) -> Cuts:
        """Return cuts that exceed ``known`` (parts,) by more than ``slack`` at a state.

        There are none of a norm: as a cone, the solver takes it whole.
        """
        return Cuts(np.empty(0, np.intp), np.empty((0, len(state))), np.empty(0))


@dataclass(frozen=True, eq=False)
class MaxAbs(ConvexTerm):
    """max_i |matrix_i . s + offset_i|, or without the bars if not ``absolute``."""

    absolute: bool = True

    @property
    def nonnegative(self) -> bool:
        return self.absolute

    def value(self, state: Array) -> float:
        found = self.at(state)
        return float(np.abs(found).max() if self.absolute else found.max())

    def cuts(self, state: Array, known: Array, slack: float) -> Cuts:
        found = self.at(state)
        size = np.abs(found) if self.absolute else found
        # the largest of each block of the list, as neighbors are almost the same function
        starts = np.unique(np.linspace(0, len(size), BLOCKS + 1).astype(int)[:-1])
        ends = np.append(starts[1:], len(size))
        index = np.array([a + np.argmax(size[a:b]) for a, b in zip(starts, ends, strict=True)])
        index = index[size[index] > known[0] + slack]
        sign = np.where(found[index] < 0, -1.0, 1.0) if self.absolute else np.ones(len(index))
        return Cuts(
            np.zeros(len(index), np.intp),
            sign[:, None] * self.matrix[index],
            sign * self.offset[index],
        )


@dataclass(frozen=True, eq=False)
class Norm(ConvexTerm):
    """The Euclidean norm |matrix . s + offset|, which a conic solver takes as it is."""

    @classmethod
    def of_many(cls, matrix: Array, offset: Array) -> Norm:
        """Return the norm of many rows: that of the triangle of their QR factors."""
        used = matrix.any(axis=0)
        triangle: Any = np.linalg.qr(np.column_stack([matrix[:, used], offset]), mode="r")
        triangle = triangle[np.abs(triangle).max(axis=1) > 1e-15 * np.abs(triangle).max()]
        rows = np.zeros((len(triangle), matrix.shape[1]))
        rows[:, used] = triangle[:, :-1]
        return cls(rows, triangle[:, -1])

    def value(self, state: Array) -> float:
        return float(np.linalg.norm(self.at(state)))


@dataclass(frozen=True, eq=False)
class PositivePartSum(ConvexTerm):
    """sum_i max(matrix_i . s + offset_i, 0); the samples of a group are one part."""

    starts: NDArray[np.intp]  # first samples of the groups

    @property
    def parts(self) -> int:
        return len(self.starts)

    def value(self, state: Array) -> float:
        return float(np.maximum(self.at(state), 0.0).sum())

    def cuts(self, state: Array, known: Array, slack: float) -> Cuts:
        found = self.at(state)
        on = (found > 0).astype(np.float64)
        sums = np.add.reduceat(found * on, self.starts)
        part = np.flatnonzero(sums > known + slack / max(len(self.starts), 1))
        ends = np.append(self.starts[1:], len(found))
        matrix, offset = np.empty((len(part), self.matrix.shape[1])), np.empty(len(part))
        for row, i in enumerate(part):
            group = slice(self.starts[i], ends[i])
            matrix[row] = on[group] @ self.matrix[group]
            offset[row] = on[group] @ self.offset[group]
        return Cuts(part, matrix, offset)
