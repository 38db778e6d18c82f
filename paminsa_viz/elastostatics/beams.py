"""Beam elements: the 12x12 stiffness matrix of a straight bar, Euler-Bernoulli or Timoshenko.

Element axes: e along the bar from its first node, n in the plane of the leg, b = e x n across it. A
node has the displacements along (e, n, b) and the rotations about them, in this order.
Reference: Przemieniecki, Theory of Matrix Structural Analysis (1968), chapter 5.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.model.arrays import Array
from paminsa_viz.model.elastic import BeamSection, Elastic


def beam_stiffness(
    length: ArrayLike, section: BeamSection, elastic: Elastic, *, shear: bool = False
) -> Array:
    """Return the stiffness of a bar in element axes, (..., 12, 12).

    Args:
        length: Its length (...) [m].
        section: Its section; ``inertia_in`` bends it in plane (e, n), ``inertia_out`` in (e, b).
        elastic: E and G.
        shear: Whether it deforms by shear as well (Timoshenko).

    Returns:
        Forces [N] and moments [N m] on the two nodes for displacements [m] and rotations [rad].
    """
    length = np.asarray(length, dtype=np.float64)
    young, rigidity = elastic.young_modulus, elastic.shear_modulus
    k = np.zeros((*length.shape, 12, 12))
    _add_pair(k, 0, 6, young * section.area / length)
    _add_pair(k, 3, 9, rigidity * section.torsion / length)
    stiff = rigidity * section.area * section.shear
    # bending in the plane (e, n) turns about b, in (e, b) about -n
    for across, turn, inertia, sign in (
        (1, 5, section.inertia_in, 1.0),
        (2, 4, section.inertia_out, -1.0),
    ):
        bending = young * inertia
        soft = 12 * bending / (stiff * length**2) if shear else np.zeros_like(length)
        unit = bending / (length**3 * (1 + soft))
        index = [across, turn, across + 6, turn + 6]
        lever = sign * length
        near, far = (4 + soft) * length**2, (2 - soft) * length**2
        block = np.empty((*length.shape, 4, 4))
        block[..., 0, 0] = block[..., 2, 2] = 12.0
        block[..., 0, 2] = block[..., 2, 0] = -12.0
        block[..., 0, 1] = block[..., 0, 3] = block[..., 1, 0] = block[..., 3, 0] = 6 * lever
        block[..., 1, 2] = block[..., 2, 1] = block[..., 2, 3] = block[..., 3, 2] = -6 * lever
        block[..., 1, 1] = block[..., 3, 3] = near
        block[..., 1, 3] = block[..., 3, 1] = far
        k[..., np.ix_(index, index)[0], np.ix_(index, index)[1]] = unit[..., None, None] * block
    return k


def _add_pair(k: Array, first: int, second: int, stiffness: Array) -> None:
    """Add a spring between two freedoms."""
    k[..., first, first] += stiffness
    k[..., second, second] += stiffness
    k[..., first, second] -= stiffness
    k[..., second, first] -= stiffness


def rotated(matrix: Array, axes: Array) -> Array:
    """Return an element's 12x12 matrix in the axes in which its own ones are given.

    Args:
        matrix: (..., 12, 12) in element axes.
        axes: (..., 3, 3) rows e, n, b.
    """
    shape = np.broadcast_shapes(matrix.shape[:-2], axes.shape[:-2])
    split = np.broadcast_to(matrix, (*shape, 12, 12)).reshape(*shape, 4, 3, 4, 3)
    turned = np.einsum("...ia,...piqj,...jb->...paqb", axes, split, axes, optimize=True)
    return turned.reshape(*shape, 12, 12)
