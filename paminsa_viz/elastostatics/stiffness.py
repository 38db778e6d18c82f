"""Stiffness of the whole robot at the platform's center P: 6x6, deflection, what to stiffen first.

A wrench W at P meets the joints 5 by equilibrium alone, two forces a leg, so that the twist of P is
C W with C = H^-T (C_legs + (k^2 / k_4) z z^T) H^-1. The columns of H are the wrenches of unit
forces along w and z at the joints 5, C_legs is block diagonal (`leg_compliance`), and M4, which all
legs share, adds the rest. K = H (..)^-1 H^T exists at every pose. At the type-2 singularities of
the rigid robot it is singular, as no leg has a stiffness along u, and there is no compliance.
Small displacements, no preload; W in base axes, with moments about P.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from paminsa_viz.checks import kinds_checked
from paminsa_viz.elastostatics.leg_frame import LegFrame, leg_frame
from paminsa_viz.elastostatics.leg_loads import (
    APPLIED,
    COLUMNS,
    FORCE_Z,
    PARTS,
    StrainRow,
    leg_rows,
)
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array, as_vectors, in_blocks, own_vectors
from paminsa_viz.model.design import Design
from paminsa_viz.model.elastic import Elastic
from paminsa_viz.model.grids import Field
from paminsa_viz.model.jacobians import inverse_jacobian
from paminsa_viz.model.load import center_wrench
from paminsa_viz.model.reach import Limit, OfLimits

ALIKE = 1e-9
"""Compliances whose difference is a smaller part of them are the same but for rounding."""

# --------------------------------------------------------- compliance of a leg, by the force method
# A leg carries a force along w and one along z at joint 5, and none along u. Besides them, five
# redundants X act: the arm's force S along w and moment about u on the shaft at joint 2, and, where
# B7 is cut from B3 at joint 7, a force along w and moments about u and z. With s the internal
# forces for unit loads (`leg_loads`) and D their flexibilities, f = s^T D s; the redundants follow
# from f_XX X + f_Xa a = 0 (Castigliano, Menabrea), and the compliance is f_aa - f_aX f_XX^-1 f_Xa.


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


# ------------------------------------------------------------------------------------- the platform

SINGULAR = 1e-12
"""Smallest eigenvalue of K over its largest, from which on a pose counts as singular; rotations are
counted as displacements at R_pl."""

BLOCK = 1024
"""Poses worked on at a time, so that their arrays stay in the cache."""

SHARES = (*PARTS, "M4")
"""Parts in the order of `StrainShares.energy`."""

SHARE_LABELS = tuple("M1–M3" if name == "drive" else name for name in SHARES)
"""The same for people."""

ACTUATED = [0, 1, 5, 2]
"""Places of x, y, theta and z in a twist or wrench."""


@dataclass(frozen=True, eq=False)
class PlatformStiffness(OfLimits):
    """Stiffness and compliance of the platform, batch shape (...).

    NaN where a pose cannot be reached; the compliance, and all that follows from it, also where the
    stiffness is singular.

    Attributes:
        design: The robot.
        pose: (..., 4) [m, m, rad, m].
        status: (...) values of `Limit`: why there is no number.
        leg: (...) index of the leg that is the reason, -1 for none.
        compliance: (..., 6, 6) inverse of `matrix` [m/N, 1/N, rad/(N m)].
        shear: Whether bars deform by shear as well (Timoshenko).
    """

    design: Design
    pose: Array
    status: NDArray[np.uint8]
    leg: NDArray[np.int8]
    compliance: Array
    shear: bool

    @cached_property
    def matrix(self) -> Array:
        """K: wrench (F_x, F_y, F_z, M_x, M_y, M_z) for a twist of P, in base axes, (..., 6, 6).

        [N/m, N, N m/rad]. It is worked out when asked for: maps need the compliance alone, which
        takes as much memory.
        """

        def solved(poses: Array) -> list[Array]:
            frame = leg_frame(self.design.geometry, poses)
            return [_stiffness(self.design, frame, self.shear)]

        return in_blocks(solved, self.pose, BLOCK)[0]

    def along(self, axis: int) -> Array:
        """Return the stiffness along or about a base axis (...) [N/m or N m/rad].

        That is force over displacement with everything else free, 1 / C_ii; axes 0 to 5 are those
        of a wrench.
        """
        with np.errstate(divide="ignore"):
            return 1 / self.compliance[..., axis, axis]

    @property
    def horizontal(self) -> Array:
        """Stiffness in the softest horizontal direction (...) [N/m]."""
        return _softest(self.compliance[..., :2, :2])

    @property
    def softest_direction(self) -> Array:
        """Softest horizontal direction, its angle from x in [0, pi) (...) [rad].

        NaN where all are alike, as in the middle of the workspace: there rounding would choose one.
        """
        block = self.compliance[..., :2, :2]
        shear, normal = 2 * block[..., 0, 1], block[..., 0, 0] - block[..., 1, 1]
        angle = np.mod(0.5 * np.arctan2(shear, normal), np.pi)
        alike = np.hypot(shear, normal) <= ALIKE * np.trace(block, axis1=-2, axis2=-1)
        return np.where(alike, np.nan, angle)

    @property
    def tilt(self) -> Array:
        """Stiffness about the softest horizontal axis (...) [N m/rad]."""
        return _softest(self.compliance[..., 3:5, 3:5])

    def deflection(self, wrench: ArrayLike | None = None) -> Array:
        """Return the twist of P under a wrench, (..., 6) [m, rad].

        Args:
            wrench: (..., 6) at P in base axes [N, N m]; payload and load of the design by default.
        """
        w = load_wrench(self.design, self.pose) if wrench is None else as_vectors(wrench, "w", 6)
        return np.einsum("...ij,...j->...i", self.compliance, w)

    def ellipsoid(self) -> tuple[Array, Array]:
        """Return the compliance ellipsoid: where unit forces move P to.

        Returns:
            Semi-axes (..., 3) in ascending order [m/N], and their directions as columns
            (..., 3, 3).
        """
        block = self.compliance[..., :3, :3]
        good = np.all(np.isfinite(block), axis=(-1, -2))[..., None]
        axes, directions = np.linalg.eigh(np.where(good[..., None], block, np.eye(3)))
        return np.where(good, axes, np.nan), np.where(good[..., None], directions, np.nan)


@kinds_checked
def field_stiffness(field: Field, design: Design) -> PlatformStiffness:
    """Return the stiffness over a solved grid; kept until elastic data change."""
    design = replace(design, geometry=field.geometry)
    found = field.keep(
        "stiffness", design.elastic, lambda: platform_stiffness(design, field.grid.poses())
    )
    return replace(found, design=design)


@of_design
def platform_stiffness(
    design: Design, pose: ArrayLike, *, shear: bool = False
) -> PlatformStiffness:
    """Return the stiffness of the robot with its motors locked.

    Args:
        design: The robot with its elastic data.
        pose: (..., 4) [m, m, rad, m].
        shear: Whether bars deform by shear as well (Timoshenko).
    """
    pose = own_vectors(pose, "pose")

    def solved(poses: Array) -> tuple[Any, ...]:
        frame = leg_frame(design.geometry, poses)
        matrix = _stiffness(design, frame, shear)
        inverse, singular = _inverse(matrix, design.geometry.platform_radius)
        lost = np.where(singular & (frame.status == Limit.OK), Limit.SINGULAR, frame.status)
        return lost.astype(np.uint8), frame.leg, inverse

    return PlatformStiffness(design, pose, *in_blocks(solved, pose, BLOCK), shear=shear)


def _stiffness(design: Design, frame: LegFrame, shear: bool) -> Array:
    """Return K (n, 6, 6) from the legs at n poses."""
    compliance = leg_compliance(frame, design.elastic, shear=shear).matrix
    return _at_platform(design, frame.joint5_map[..., 1:, :], compliance)


def _at_platform(design: Design, maps: Array, compliance: Array) -> Array:
    """Return K from the maps (n, 3, 2, 6) and compliances (n, 3, 2, 2) of the legs.

    The rank-one part of M4 is inverted by Sherman and Morrison's formula.
    """
    a, b, d = compliance[..., 0, 0], compliance[..., 0, 1], compliance[..., 1, 1]
    inverse = np.stack([np.stack([d, -b], -1), np.stack([-b, a], -1)], -2)
    inverse /= (a * d - b * b)[..., None, None]
    carried = inverse @ maps
    n = len(maps)
    forces = carried.reshape(n, 6, 6)
    k = np.swapaxes(maps.reshape(n, 6, 6), -1, -2) @ forces
    lift = carried[:, :, 1].sum(axis=1)  # wrench for a unit strain of all z
    soft = design.geometry.magnification**2 / design.elastic.drive_linear
    factor = soft / (1 + soft * inverse[..., 1, 1].sum(axis=-1))
    k -= factor[:, None, None] * lift[:, :, None] * lift[:, None, :]
    return 0.5 * (k + np.swapaxes(k, -1, -2))


def _inverse(matrix: Array, length: float) -> tuple[Array, NDArray[np.bool_]]:
    """Return the inverses, and where there is none; rotations count times a length."""
    scale = np.array([1.0, 1.0, 1.0, length, length, length])
    good = np.all(np.isfinite(matrix), axis=(-1, -2))
    scaled = np.where(good[:, None, None], matrix / scale / scale[:, None], np.eye(6))
    values, vectors = np.linalg.eigh(scaled)
    singular = good & ~(values[:, 0] > SINGULAR * values[:, -1])
    values[singular] = np.nan
    inverse = (vectors / values[:, None, :]) @ np.swapaxes(vectors, -1, -2) / scale
    inverse /= scale[:, None]
    return np.where(good[:, None, None], inverse, np.nan), singular


def _softest(block: Array) -> Array:
    """Return 1 over the largest eigenvalue of 2x2 compliances."""
    a, b, d = block[..., 0, 0], block[..., 0, 1], block[..., 1, 1]
    with np.errstate(divide="ignore"):
        return 1 / (0.5 * (a + d) + np.hypot(0.5 * (a - d), b))


@of_design
def load_wrench(design: Design, pose: ArrayLike) -> Array:
    """Return the wrench of a design's payload and load at P, (..., 6) [N, N m], in base axes.

    The payload's weight acts along the vertical through P, however high its center is.

    Args:
        design: The robot.
        pose: (..., 4) [m, m, rad, m]; of it theta alone matters, for a load that turns.

    Returns:
        (F_x, F_y, F_z, M_x, M_y, M_z).

    Raises:
        InvalidInput: If the pose has another shape or is not real.
    """
    pose = as_vectors(pose, "pose")
    wrench = center_wrench(design.load, pose[..., 2])
    wrench[..., 2] -= design.payload.mass * design.gravity
    return wrench


@dataclass(frozen=True, eq=False)
class StrainShares:
    """Where a wrench at P stores energy, batch shape (...).

    Attributes:
        energy: (..., 3 legs, parts) in the order of `SHARES`; M4's is a third in each leg's column
            [J].
        total: (...) half the work of the wrench [J].
    """

    energy: Array
    total: Array

    @property
    def share(self) -> Array:
        """Share of each kind of part in all legs, (..., parts); sums to 1."""
        with np.errstate(invalid="ignore"):
            return self.energy.sum(axis=-2) / self.total[..., None]


@of_design
def strain_shares(
    design: Design, pose: ArrayLike, wrench: ArrayLike | None = None, *, shear: bool = False
) -> StrainShares:
    """Return the strain energy of every part under a wrench at P: what to stiffen first.

    Args:
        design: The robot with its elastic data.
        pose: (..., 4) [m, m, rad, m].
        wrench: (..., 6) in base axes [N, N m]; payload and load of the design by default.
        shear: Whether bars deform by shear as well (Timoshenko).
    """
    pose = as_vectors(pose, "pose")
    w = load_wrench(design, pose) if wrench is None else as_vectors(wrench, "wrench", 6)
    found = platform_stiffness(design, pose, shear=shear)
    twist = found.deflection(w)
    frame = leg_frame(design.geometry, pose)
    legs = leg_compliance(frame, design.elastic, shear=shear)
    force = joint5_forces(found, frame, legs, twist)
    lift = design.geometry.magnification * force[..., 1].sum(axis=-1)
    drive = 0.5 * lift**2 / design.elastic.drive_linear
    whole = np.broadcast_to(drive[..., None, None] / 3, (*force.shape[:-1], 1))
    energy = np.concatenate([legs.energy(force), whole], axis=-1)
    return StrainShares(energy, energy.sum(axis=(-1, -2)))


def joint5_forces(
    found: PlatformStiffness, frame: LegFrame, legs: LegCompliance, twist: Array
) -> Array:
    """Return the forces of the platform on the legs at the joints 5, (..., 3 legs, 2) [N].

    Along w and z of each leg, for a twist of P; they follow from equilibrium, whatever the
    elasticity, if the twist is a deflection.
    """
    moved = np.einsum("...kij,...j->...ki", frame.joint5_map[..., 1:, :], twist)
    design = found.design
    inverse = np.linalg.inv(np.where(np.isfinite(legs.matrix), legs.matrix, np.eye(2)))
    soft = design.geometry.magnification**2 / design.elastic.drive_linear
    free = np.einsum("...ij,...j->...i", inverse, moved)
    lifted = free[..., 1].sum(axis=-1) / (1 + soft * inverse[..., 1, 1].sum(axis=-1))
    return free - soft * lifted[..., None, None] * inverse[..., :, 1]


@dataclass(frozen=True, eq=False)
class Compensation:
    """What the motors do against a deflection, batch shape (...).

    Attributes:
        deflection: (..., 6) twist of P under the wrench [m, rad].
        actuators: (..., 4) how far the motors M1..M4 move to bring x, y, theta and z back
            [rad, rad, rad, m].
        tilt: (...) angle that is left [rad]: the platform has no actuator against it.
    """

    deflection: Array
    actuators: Array
    tilt: Array


@of_design
def compensate(
    design: Design, pose: ArrayLike, wrench: ArrayLike | None = None, *, shear: bool = False
) -> Compensation:
    """Return the static compensation of a deflection, to first order.

    Motors that move strain no bar: their motion adds to the deflection as that of the rigid robot.
    Arguments as in `strain_shares`.
    """
    pose = as_vectors(pose, "pose")
    twist = platform_stiffness(design, pose, shear=shear).deflection(wrench)
    back = -np.einsum(
        "...ij,...j->...i", inverse_jacobian(design.geometry, pose), twist[..., ACTUATED]
    )
    return Compensation(twist, back, np.hypot(twist[..., 3], twist[..., 4]))
