"""Consistent mass matrices of beams and of what is fixed to them (Przemieniecki 1968, ch. 11).

Coordinates as of the stiffness in `beams`: (u, v, w) and small turns about (x, y, z) of the first
end, then of the second; x along the beam. A bar's mass is uniform. What its transverse inertia has
over m l^2/12 is spread as rotary inertia, so that the rigid bar has its design's inertia.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from paminsa_viz.model.arrays import Array

_BENDING = np.array(
    [[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]], float
)
"""Of m/420, in (deflection, l slope) of both ends: cubic shapes."""

_SLOPE = np.array([[36, 3, -36, 3], [3, 4, -3, -1], [-36, -3, 36, -3], [3, -1, -3, 4]], float)
"""Of j/(30 l), j the rotary inertia per length: the squared slope of the same shapes."""

_LINEAR = np.array([[2, 1], [1, 2]], float)
"""Of m/6, in a linear coordinate of both ends."""

_AXIAL, _ROLL = (0, 6), (3, 9)
_UP, _SIDE = (2, 4, 8, 10), (1, 5, 7, 11)
"""Coordinates of bending along z, where a slope is minus the turn about y, and along y."""


def beam_mass(
    length: Array | float, mass: Array | float, axial: Array | float, rotary: Array | float
) -> Array:
    """Return the consistent mass matrix of uniform beams, (..., 12, 12).

    Args:
        length: l, (...) [m].
        mass: Per length [kg/m].
        axial: Inertia about the beam, per length [kg m].
        rotary: Rotary inertia across the beam, per length [kg m]; it may be negative.
    """
    whole, m, j, r = np.broadcast_arrays(length, mass, axial, rotary)
    out = np.zeros((*whole.shape, 12, 12))
    out[_block(_AXIAL)] = (m * whole / 6)[..., None, None] * _LINEAR
    out[_block(_ROLL)] = (j * whole / 6)[..., None, None] * _LINEAR
    for places, sign in ((_UP, -1.0), (_SIDE, 1.0)):
        scale = np.stack([np.ones_like(whole), sign * whole] * 2, axis=-1)
        bending = (m * whole / 420)[..., None, None] * _BENDING
        bending = bending + (r / (30 * whole))[..., None, None] * _SLOPE
        out[_block(places)] = bending * scale[..., :, None] * scale[..., None, :]
    return out


@cache
def _block(places: tuple[int, ...]) -> Any:
    """Return the index of the rows and columns of some coordinates."""
    return (..., *np.ix_(places, places))


def point_mass(mass: float, ahead: float = 0.0) -> Array:
    """Return the matrix of a point mass fixed to a node at some way ahead along x, (6, 6).

    Args:
        mass: [kg].
        ahead: From the node [m].
    """
    return body_mass(mass, mass * ahead, mass * ahead**2)


def body_mass(
    mass: Array | float,
    first: Array | float,
    second: Array | float,
    axial: Array | float = 0.0,
    rotary: Array | float = 0.0,
) -> Array:
    """Return the matrix of a slender rigid body along x, fixed to a node, (..., 6, 6).

    Args:
        mass: [kg].
        first, second: First and second moments of the mass along x, from the node [kg m, kg m^2].
        axial: Inertia about x [kg m^2].
        rotary: What it has across x on top of the second moment [kg m^2].
    """
    m, a, b, j, r = np.broadcast_arrays(mass, first, second, axial, rotary)
    out = np.zeros((*m.shape, 6, 6))
    for i in range(3):
        out[..., i, i] = m
    out[..., 3, 3] = j
    out[..., 4, 4] = out[..., 5, 5] = b + r
    out[..., 2, 4] = out[..., 4, 2] = -a
    out[..., 1, 5] = out[..., 5, 1] = a
    return out
