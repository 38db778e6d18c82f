"""Natural frequencies and mode shapes from a stiffness and a mass matrix, (K - w^2 M) v = 0.

Solved as an eigenproblem of the compliance, K^-1 M v = v / w^2: the lowest frequencies are its
largest eigenvalues, and so the most accurate ones, and a mass matrix may be singular or, from
inertias below those of a slender bar, not quite positive.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.model.arrays import Array, unfolded

LEAST_STIFFNESS = 1e-11
"""Least eigenvalue of a stiffness with unit diagonal that is more than rounding."""


@dataclass(frozen=True, eq=False)
class Modes:
    """Small vibrations about an equilibrium; batch shape (...).

    Attributes:
        frequencies: (..., n) natural frequencies, lowest first [Hz]; infinite for coordinates
            without mass, NaN where the robot does not vibrate.
        shapes: (..., coordinates, n) the modes' shapes in the columns, with v^T M v = 1.
        ok: (...) whether the stiffness is positive definite. It is not where the robot is
            singular, or where weight or load push it away from the pose harder than it is held.
    """

    frequencies: Array
    shapes: Array
    ok: NDArray[np.bool_]


@np.errstate(all="ignore")
def natural_modes(stiffness: Array, mass: Array, count: int | None = None) -> Modes:
    """Return the lowest natural frequencies and modes of (K - w^2 M) v = 0.

    Args:
        stiffness: K, (..., n, n), symmetric.
        mass: M, (..., n, n), symmetric, in the same coordinates.
        count: How many modes; all of them by default.
    """
    k, m = np.broadcast_arrays(stiffness, mass)
    shape, size = k.shape[:-2], k.shape[-1]
    kept = size if count is None else min(count, size)
    k, m = k.reshape(-1, size, size), m.reshape(-1, size, size)
    frequencies = np.full((len(k), kept), np.nan)
    shapes = np.full((len(k), size, kept), np.nan)
    stable = np.zeros(len(k), dtype=bool)
    known = np.all(np.isfinite(k), axis=(1, 2)) & np.all(np.isfinite(m), axis=(1, 2))
    known &= (np.einsum("nii->ni", k) > 0).all(axis=1)
    if known.any():
        scale = 1 / np.sqrt(np.einsum("nii->ni", k[known]))
        unit = k[known] * scale[:, :, None] * scale[:, None, :]
        values, axes = np.linalg.eigh(unit)
        firm = values[:, 0] > LEAST_STIFFNESS
        good = np.flatnonzero(known)[firm]
        stable[good] = True
        # B with B^T K B = 1
        basis = scale[firm, :, None] * axes[firm] / np.sqrt(values[firm, None, :])
        inertia, vectors = np.linalg.eigh(np.swapaxes(basis, 1, 2) @ m[good] @ basis)
        inertia, vectors = inertia[:, ::-1][:, :kept], vectors[:, :, ::-1][:, :, :kept]
        inertia = np.maximum(inertia, 0.0)
        frequencies[good] = 1 / (2 * np.pi * np.sqrt(inertia))
        shapes[good] = basis @ vectors / np.sqrt(inertia)[:, None, :]
    return Modes(*unfolded((frequencies, shapes, stable), shape))
