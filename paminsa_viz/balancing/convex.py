"""Convex functions of a program's state, and affine functions that support them from below.

A term F(s) is a sum of parts, each of which is enclosed by affine functions (`Cuts`) that are added
where a trial solution breaks them; a norm may go to the solver whole, as a second-order cone.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol

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


def no_cuts(size: int) -> Cuts:
    """Return no cuts at all, for states of a size."""
    return Cuts(np.empty(0, np.intp), np.empty((0, size)), np.empty(0))


class ConvexTerm(Protocol):
    """A convex function of a state that a program can minimize or hold below a limit."""

    @property
    def parts(self) -> int:
        """Number of functions that add up to it."""
        ...

    @property
    def nonnegative(self) -> bool:
        """Whether none of its parts is ever negative."""
        ...

    def value(self, state: Array) -> float:
        """Return the function at a state (d,)."""
        ...

    def cuts(self, state: Array, known: Array, slack: float) -> Cuts:
        """Return cuts that exceed ``known`` (parts,) by more than ``slack`` at a state."""
        ...


@dataclass(frozen=True, eq=False)
class MaxAbs:
    """max_i |matrix_i . s + offset_i|, or without the bars if not ``absolute``."""

    matrix: Array  # (m, d)
    offset: Array  # (m,)
    absolute: bool = True

    parts = 1

    @property
    def nonnegative(self) -> bool:
        """See `ConvexTerm`."""
        return self.absolute

    def value(self, state: Array) -> float:
        """See `ConvexTerm`."""
        found = self.matrix @ state + self.offset
        return float(np.abs(found).max() if self.absolute else found.max())

    def cuts(self, state: Array, known: Array, slack: float) -> Cuts:
        """See `ConvexTerm`."""
        found = self.matrix @ state + self.offset
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
class Norm:
    """The Euclidean norm |matrix . s + offset|, which a conic solver takes as it is."""

    matrix: Array  # (m, d)
    offset: Array  # (m,)

    parts = 1
    nonnegative = True

    def value(self, state: Array) -> float:
        """See `ConvexTerm`."""
        return float(np.linalg.norm(self.matrix @ state + self.offset))

    def cuts(self, state: Array, known: Array, slack: float) -> Cuts:
        """See `ConvexTerm`; the cone leaves nothing to cut off."""
        return no_cuts(len(state))


@dataclass(frozen=True, eq=False)
class PositivePartSum:
    """sum_i max(matrix_i . s + offset_i, 0); the samples of a group are one part."""

    matrix: Array  # (m, d)
    offset: Array  # (m,)
    starts: NDArray[np.intp]  # first samples of the groups

    nonnegative = True

    @property
    def parts(self) -> int:
        """See `ConvexTerm`."""
        return len(self.starts)

    def value(self, state: Array) -> float:
        """See `ConvexTerm`."""
        return float(np.maximum(self.matrix @ state + self.offset, 0.0).sum())

    def cuts(self, state: Array, known: Array, slack: float) -> Cuts:
        """See `ConvexTerm`."""
        found = self.matrix @ state + self.offset
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
