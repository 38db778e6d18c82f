"""Compliance of a leg at joint 5 by the force method: exact, and quick enough for maps.

A leg carries a force along w and one along z at joint 5, and none along u. Besides them, five
redundants X act: the arm's force S along w and moment about u on the shaft at joint 2, and, where
B7 is cut from B3 at joint 7, a force along w and moments about u and z. With s the internal forces
for unit loads (`leg_loads`) and D their flexibilities, f = s^T D s; the redundants follow from
f_XX X + f_Xa a = 0 (Castigliano, Menabrea), and the compliance is f_aa - f_aX f_XX^-1 f_Xa.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from paminsa_viz.elastostatics.leg_frame import LegFrame
from paminsa_viz.elastostatics.leg_loads import (
    APPLIED,
    COLUMNS,
    FORCE_Z,
    PARTS,
    StrainRow,
    leg_rows,
)
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.elastic import Elastic


@dataclass(frozen=True, eq=False)
class LegCompliance:
    """Flexibilities of legs, batch shape (..., 3 legs).

    Attributes:
        rows: Internal forces and moments of all parts for unit loads.
        matrix: (..., 2, 2) compliance at joint 5 along w and z, the drive of M4 left out [m/N].
        redundant: (..., 5, 2) redundants for unit forces at joint 5 [1, m].
    """

    rows: tuple[StrainRow, ...]
    matrix: Array
    redundant: Array

    def energy(self, force: Array) -> Array:
        """Return the strain energy in the parts under forces at joint 5.

        Args:
            force: (..., 3 legs, 2) along w and z [N].

        Returns:
            (..., 3 legs, parts) in the order of `PARTS` [J].
        """
        inside = np.einsum("...ij,...j->...i", self.redundant, force)
        loads = [*np.moveaxis(force, -1, 0), *np.moveaxis(inside, -1, 0)]
        energy = np.zeros((*inside.shape[:-1], len(PARTS)))
        for row in self.rows:
            stress: Any = sum(value * loads[column] for column, value in row.loads.items())
            energy[..., PARTS.index(row.part)] += 0.5 * row.flexibility * stress**2
        return energy


@np.errstate(all="ignore")
def leg_compliance(frame: LegFrame, elastic: Elastic, *, shear: bool = False) -> LegCompliance:
    """Return the compliance of the legs; NaN where a pose cannot be reached.

    Args:
        frame: Where the legs are.
        elastic: Sections, material, stiffness of drives and joints.
        shear: Whether bars deform by shear as well (Timoshenko).
    """
    rows = leg_rows(frame, elastic, shear=shear)
    f = np.zeros((COLUMNS, COLUMNS, *frame.rho.shape))
    for row in rows:
        for column, value in row.loads.items():
            weighted = row.flexibility * value
            for other, factor in row.loads.items():
                if other <= column:
                    f[column, other] += weighted * factor
    matrix, redundant = _without_redundants(f)
    return LegCompliance(rows, matrix, redundant)


def _without_redundants(f: Array) -> tuple[Array, Array]:
    """Eliminate the redundants from f, of which the lower triangle is given, (7, 7, ...).

    Returns the compliance (..., 2, 2), and the redundants for unit loads (..., 5, 2). f_XX is
    positive definite, so that no pivots have to be chosen.
    """
    f[..., :] = np.where(np.isnan(f[FORCE_Z, FORCE_Z]), np.nan, f)
    last = COLUMNS - 1
    factors: dict[tuple[int, int], Array] = {}
    for pivot in range(last, APPLIED - 1, -1):
        inverse = 1 / f[pivot, pivot]
        for row in range(pivot):
            factors[pivot, row] = f[pivot, row] * inverse
        for row in range(pivot):
            for column in range(row + 1):
                f[row, column] -= factors[pivot, row] * f[pivot, column]
    redundant = np.empty((*f.shape[2:], COLUMNS - APPLIED, APPLIED))
    solved = np.empty((COLUMNS, APPLIED, *f.shape[2:]))
    for load in range(APPLIED):
        for row in range(APPLIED):
            solved[row, load] = float(row == load)
        for pivot in range(APPLIED, COLUMNS):
            solved[pivot, load] = -sum(
                factors[pivot, row] * solved[row, load] for row in range(pivot)
            )
            redundant[..., pivot - APPLIED, load] = solved[pivot, load]
    matrix = np.empty((*f.shape[2:], APPLIED, APPLIED))
    matrix[..., 0, 0], matrix[..., 1, 1] = f[0, 0], f[1, 1]
    matrix[..., 0, 1] = matrix[..., 1, 0] = f[1, 0]
    return matrix, redundant
