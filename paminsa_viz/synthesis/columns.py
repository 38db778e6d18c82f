"""Quantities over positions, headings and heights, solved without a rectangle around them."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from paminsa_viz.model import backend
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.backend import Formula
from paminsa_viz.model.design import Geometry
from paminsa_viz.model.grids import Field, Grid
from paminsa_viz.model.leg import mechanism
from paminsa_viz.model.reach import LEAST_MARGIN, Limit, decode


@dataclass(frozen=True)
class Columns(Grid):
    """Poses at positions that need not form a grid, with every heading and every height.

    The shape is (positions, headings, heights).

    Attributes:
        positions: (n, 2) x and y [m].
    """

    positions: Array = field(default_factory=lambda: np.zeros((0, 2)))

    @classmethod
    def at(cls, positions: Array, theta: Array, z: Array) -> Columns:
        """Return the poses at positions (n, 2) [m] with headings [rad] and heights [m]."""
        axes = (("x", positions[:, 0]), ("theta", theta), ("z", z))
        return cls(axes, np.zeros(4), positions)

    def poses(self) -> Array:
        """Return every pose, (positions, headings, heights, 4) [m, m, rad, m]."""
        pose = np.empty((*self.shape, 4))
        pose[..., :2] = self.positions[:, None, None]
        pose[..., 2] = self.axes[1][1][:, None]
        pose[..., 3] = self.axes[2][1]
        return pose


@dataclass(frozen=True, eq=False)
class ColumnField(Field):
    """What the geometry says about the poses of `Columns`; formulas are solved on demand."""

    grid: Columns

    def solve(self, formula: Formula) -> Array:
        """Return the results of a formula, (results, positions, headings, heights)."""
        found = self._solved.get(formula)
        if found is None:
            found = self._solved[formula] = _evaluate(formula, self.geometry, self.grid)
        return found


def solve_columns(geometry: Geometry, columns: Columns, *, status: bool = True) -> ColumnField:
    """Return a field of columns.

    Args:
        geometry: Lengths of the mechanism.
        columns: The poses.
        status: Whether to work out which poses can be taken. Without it all count as if they can;
            for formulas that are NaN where they cannot.
    """
    if not status:
        ok = np.full(columns.shape, Limit.OK, np.uint8)
        return ColumnField(columns, geometry, ok, np.full(columns.shape, -1, np.int8), 1, {})
    margin = _evaluate(LEAST_MARGIN, geometry, columns)
    found, leg = decode(*margin)
    return ColumnField(columns, geometry, found, leg, 1, {LEAST_MARGIN: margin})


def _evaluate(formula: Formula, geometry: Geometry, columns: Columns) -> Array:
    count, headings, heights = columns.shape
    outer = np.zeros((count, headings, 4))
    outer[..., :2] = columns.positions[:, None]
    outer[..., 2] = columns.axes[1][1]
    inner = np.zeros((heights, 4))
    inner[:, 3] = columns.axes[2][1]
    out = np.empty((count * headings, formula.results, heights))
    outer = outer.reshape(-1, 4)
    backend.over_grid(formula, mechanism(geometry), outer, inner)(slice(None), slice(None), out)
    return np.moveaxis(out, 1, 0).reshape(formula.results, *columns.shape)
