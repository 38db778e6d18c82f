"""Beam elements: stiffness and mass matrices of a straight bar, and of what is fixed to its nodes.

Element axes: e along the bar from its first node, n in the plane of the leg, b = e x n across it. A
node has the displacements along (e, n, b) and the rotations about them, in this order. Bars are
those of Euler and Bernoulli or Timoshenko. Masses are consistent and uniform; what a bar's
transverse inertia has over m l^2/12 is spread as rotary inertia, so that the rigid bar has its
design's inertia.
Reference: Przemieniecki, Theory of Matrix Structural Analysis (1968), chapters 5 and 11.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.elastic import BeamSection, Elastic
from paminsa_viz.model.leg_points import bar_length
from paminsa_viz.model.parameters import PANTOGRAPH

_SPRING = np.array([[1, -1], [-1, 1]], float)
_BENDING = np.array([[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]], float)
"""Of E I/l^3, in (deflection, l slope) of both ends."""

_SHEAR = np.array([[0, 0, 0, 0], [0, 1, 0, -1], [0, 0, 0, 0], [0, -1, 0, 1]], float)
"""What the share of shear in the deflection adds to `_BENDING`."""

_LINEAR = np.array([[2, 1], [1, 2]], float)
"""Of m/6, in a linear coordinate of both ends."""

_CUBIC = np.array(
    [[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]], float
)
"""Of m/420, in (deflection, l slope) of both ends: cubic shapes."""

_SLOPE = np.array([[36, 3, -36, 3], [3, 4, -3, -1], [-36, -3, 36, -3], [3, -1, -3, 4]], float)
"""Of j/(30 l), j the rotary inertia per length: the squared slope of the same shapes."""

_AXIAL, _ROLL = (0, 6), (3, 9)
_IN_PLANE, _ACROSS = (1, 5, 7, 11), (2, 4, 8, 10)
"""Coordinates of bending along n and along b, where a slope is minus the turn about n."""


@cache
def _block(places: tuple[int, ...]) -> Any:
    """Return the index of the rows and columns of some coordinates."""
    return (..., *np.ix_(places, places))


def _bending(length: Array) -> Iterator[tuple[Any, Array]]:
    """Yield the blocks of both planes, and what scales a matrix of (deflection, l slope) there."""
    for places, sign in ((_IN_PLANE, 1.0), (_ACROSS, -1.0)):
        scale = np.stack([np.ones_like(length), sign * length] * 2, axis=-1)
        yield _block(places), scale[..., :, None] * scale[..., None, :]


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
    length = np.asarray(length, dtype=np.float64)[..., None, None]
    young, rigidity = elastic.young_modulus, elastic.shear_modulus
    k = np.zeros((*length.shape[:-2], 12, 12))
    k[_block(_AXIAL)] = young * section.area / length * _SPRING
    k[_block(_ROLL)] = rigidity * section.torsion / length * _SPRING
    inertias = section.inertia_in, section.inertia_out
    for inertia, (block, scale) in zip(inertias, _bending(length[..., 0, 0]), strict=True):
        bending = young * inertia
        soft = np.zeros_like(length)
        if shear:
            soft = 12 * bending / (rigidity * section.area * section.shear * length**2)
        k[block] = bending / (length**3 * (1 + soft)) * (_BENDING + soft * _SHEAR) * scale
    return k


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
    whole, m, j, r = (a[..., None, None] for a in np.broadcast_arrays(length, mass, axial, rotary))
    out = np.zeros((*whole.shape[:-2], 12, 12))
    out[_block(_AXIAL)] = m * whole / 6 * _LINEAR
    out[_block(_ROLL)] = j * whole / 6 * _LINEAR
    for block, scale in _bending(whole[..., 0, 0]):
        out[block] = (m * whole / 420 * _CUBIC + r / (30 * whole) * _SLOPE) * scale
    return out


def point_mass(mass: float, ahead: float = 0.0) -> Array:
    """Return the matrix of a point mass fixed to a node at some way ahead along e, (6, 6).

    Args:
        mass: [kg].
        ahead: From the node [m].
    """
    return body_mass(mass, mass * ahead, mass * ahead**2)


def body_mass(
    mass: Array | float,
    first: Array | float,
    second: Array | float,
    rotary: Array | float = 0.0,
) -> Array:
    """Return the matrix of a slender rigid body along e, fixed to a node, (..., 6, 6).

    Args:
        mass: [kg].
        first, second: First and second moments of the mass along e, from the node [kg m, kg m^2].
        rotary: What it has across e on top of the second moment [kg m^2].
    """
    m, a, b, r = np.broadcast_arrays(mass, first, second, rotary)
    out = np.zeros((*m.shape, 6, 6))
    for i in range(3):
        out[..., i, i] = m
    out[..., 4, 4] = out[..., 5, 5] = b + r
    out[..., 2, 4] = out[..., 4, 2] = -a
    out[..., 1, 5] = out[..., 5, 1] = a
    return out


# ------------------------------------------------------------- tubes beside the masses of the links
# Appendix 4 gives masses and inertias, not sections. A tube of any wall can have a link's mass, but
# its inertia about its middle then lies between m l^2 / 12 and little more, while Appendix 4's are
# larger: what is at the bars' ends (forks, bearings) is in them. So sections cannot be read from
# the paper, and have to be given.


class TubeFit(NamedTuple):
    """A bar's tube beside the mass and inertias of the design; ratios are the design's over the
    tube's.

    Attributes:
        bar: Name, ``"B4"``.
        length: [m].
        mass: Mass of the tube [kg].
        mass_ratio: The link's mass over it.
        slender: m l^2 / 12 for the link's mass [kg m^2].
        slender_ratio: I_YY over it.
        transverse: The tube's inertia across, scaled to the link's mass [kg m^2].
        transverse_ratio: I_YY over it.
        axial: The tube's inertia along, scaled to the link's mass [kg m^2].
        axial_ratio: I_XX over it.
    """

    bar: str
    length: float
    mass: float
    mass_ratio: float
    slender: float
    slender_ratio: float
    transverse: float
    transverse_ratio: float
    axial: float
    axial_ratio: float


@of_design
def tube_fits(design: Design) -> tuple[TubeFit, ...]:
    """Compare the tubes of the pantograph's bars with the design's masses and inertias."""
    found = []
    for bar in PANTOGRAPH:
        length = bar_length(design.geometry, bar)
        section = design.elastic.section(bar)
        link = design.value(f"links.{bar}")
        mass = design.elastic.density * section.area * length
        slender = link * length**2 / 12
        squares = design.value(f"elastic.{bar}_outer") ** 2
        squares += design.value(f"elastic.{bar}_inner") ** 2
        across, along = slender + link * squares / 16, link * squares / 8
        given_across = design.value(f"inertias.{bar}_transverse")
        given_along = design.value(f"inertias.{bar}_axial")
        found.append(
            TubeFit(
                bar.upper(), length, mass, link / mass, slender, _ratio(given_across, slender),
                across, _ratio(given_across, across), along, _ratio(given_along, along),
            )
        )  # fmt: skip
    return tuple(found)


def _ratio(value: float, of: float) -> float:
    return value / of if of else float("nan")
