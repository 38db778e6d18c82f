"""Lumped mass coefficients (Appendices 2 and 3) and the terms of the energies that they multiply.

Everything the robot's mass distribution does to its torques passes through 18 numbers

    c = (M_p1, M_p2, M_p3, M_c1 .. M_c13, m_pl, I_pl),

which are linear in the masses and inertias and depend on the geometry only through k and lengths.
The energies (Eqs. 11-14) are then linear in c: `energy_terms` says which coefficient multiplies
which square of a velocity. The misprints of the paper live here and nowhere else, because each of
them moves a coefficient to a wrong place; see `Misprint`.

A counterweight adds to seven of the 18 and needs no other: whatever bar it is on, it is at a
combination of joints 5 and 9, so that its energies are made of the terms that are there already.
"""

from __future__ import annotations

from collections.abc import Sequence
from enum import Flag, auto
from operator import attrgetter
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from paminsa_viz.model.arguments import of_design, of_geometry
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import PARAMETERS, Design, Geometry
from paminsa_viz.model.leg_points import PointWeights, counterweight_point


class Misprint(Flag):
    """The published formulas that differ from the correct ones; combine them with ``|``.

    The misprints of Appendix 1 (indices of the base points) and of Appendix 4 (a unit, a symbol)
    name things wrongly and leave nothing to evaluate, so they are not in this list.
    """

    NONE = 0
    EQ13_LIFT_SPEED = auto()
    """Eq. 13 prints M_c6 Z' instead of M_c6 Z'^2."""
    EQ13_LEG_SPIN = auto()
    """Eq. 13 prints M_c8 theta'^2 (the platform's) instead of M_c8 theta_k'^2."""
    APP3_MC4 = auto()
    """Appendix 3, M_c4 prints m_7 / (k^2 (k-1)) instead of twice that."""
    EQ14_PHI_SPEED = auto()
    """Eq. 14 prints M_c10 phi'^2 instead of M_c11 phi'^2."""
    EQ14_SINE_SIGNS = auto()
    """Eq. 14 prints -M_c10 sin^2 psi and -M_c12 sin^2 phi instead of +."""
    ALL = EQ13_LIFT_SPEED | EQ13_LEG_SPIN | APP3_MC4 | EQ14_PHI_SPEED | EQ14_SINE_SIGNS
    """The formulas exactly as published."""


COEFFICIENTS: tuple[str, ...] = (
    "Mp1", "Mp2", "Mp3", *(f"Mc{i}" for i in range(1, 14)), "m_pl", "I_pl",
)  # fmt: skip
"""Names of the entries of c."""

MASS_PATHS: tuple[str, ...] = tuple(
    p.path
    for p in PARAMETERS
    if p.group in ("joints", "links", "inertias", "platform", "payload") and p.unit != "m"
)
"""Design values in which c is linear."""

_MASS_VALUES = attrgetter(*MASS_PATHS)


class EnergyTerms(NamedTuple):
    """Factors of the energies, one for each kind of term; a leg unless said otherwise.

    V has ``v5 z_5 + v9 z_9 + vz Z``; T has the rest, in the order of Eqs. 13 and 14.
    """

    v5: Any
    v9: Any
    vz: Any
    xy5: Any  # x_5'^2 + y_5'^2
    z5: Any  # z_5'^2
    p9: Any  # x_9'^2 + y_9'^2 + z_9'^2
    xy59: Any  # x_5' x_9' + y_5' y_9'
    z59: Any  # z_5' z_9'
    lift: Any  # Z'^2
    z5_lift: Any  # z_5' Z'
    spin: Any  # theta_k'^2, constant part
    psi: Any  # psi'^2
    phi: Any  # phi'^2
    spin_sin_psi: Any  # theta_k'^2 sin^2 psi
    spin_cos_psi: Any  # theta_k'^2 cos^2 psi
    spin_sin_phi: Any  # theta_k'^2 sin^2 phi
    spin_cos_phi: Any  # theta_k'^2 cos^2 phi
    lift_linear: Any  # Z', only in the formula as published
    turn: Any  # theta'^2 of the platform, counted a leg; only in the formula as published
    mass: Any  # m_pl (x'^2 + y'^2 + z'^2)/2, platform and payload, counted once
    inertia: Any  # I_pl theta'^2 / 2, counted once


def _lumped(
    geometry: Geometry, gravity: float, m: SimpleNamespace, misprints: Misprint
) -> tuple[list[Any], Any]:
    """Appendices 2 and 3 as published, but for the one misprint in them; ``m`` by paper symbol."""
    k, g = geometry.magnification, gravity
    joints = m.m2 + m.m3 + m.m4 + m.m7
    mp1 = g * (m.m5 + joints / k + m.B4 / 2 + (m.B1 + m.B7) / (2 * k) + (m.B2 + m.B3) / k)
    mp2 = g * (
        ((k - 1) * m.m4 - m.m7 + k * m.m9) / k
        + ((k - 2) * m.B3 - m.B7) / (2 * k)
        + (m.B4 + m.B8) / 2
    )
    mp3 = g * m.B1 / 2
    e3 = g * geometry.shaft_length * (m.m2 + (m.B1 + m.B2) / 2)
    mc1 = 0.5 * (
        m.m4 / k**2
        + m.m5
        + m.m7 / (k * (k - 1)) ** 2
        + m.m8 / (k - 1) ** 2
        + m.B3 * (k - 2) ** 2 / (2 * k * (k - 1)) ** 2
        + m.B4 / 4
        + m.B7 * (k + 1) ** 2 / (2 * k * (k - 1)) ** 2
        + m.B8 / (2 * (k - 1)) ** 2
    )
    mc2 = 0.5 * (
        joints / k**2 + m.m5 + (m.B1 + m.B7) / (4 * k**2) + (m.B2 + m.B3) / k**2 + m.B4 / 4
    )
    mc3 = 0.5 * (
        (k - 1) ** 2 * m.m4 / k**2
        + m.m7 / k**2
        + m.m9
        + m.B3 * (k - 2) ** 2 / (4 * k**2)
        + m.B4 / 4
        + m.B7 / (4 * k**2)
        + m.B8 / 4
    )
    m7_factor = 1 if misprints & Misprint.APP3_MC4 else 2
    mc4 = 0.5 * (
        2 * (k - 1) * m.m4 / k**2
        + m7_factor * m.m7 / (k**2 * (k - 1))
        + m.B3 * (k - 2) ** 2 / (2 * k**2 * (k - 1))
        + m.B4 / 2
        + m.B7 * (k + 1) / (2 * k**2 * (k - 1))
        - m.B8 / (2 * (k - 1))
    )
    mc5 = 0.5 * ((4 * ((k - 1) * m.m4 - m.m7) - m.B7 + 2 * m.B3 * (k - 2)) / (2 * k**2) + m.B4 / 2)
    mc6 = m.B1 / 8
    mc7 = m.B1 / (4 * k)
    mc8 = m.B10 * geometry.guide_link_length**2 / 8
    mc9 = (m.Iyy4 + m.Iyy7) / 2
    mc10 = (m.Ixx4 + m.Ixx7) / 2
    mc11 = (m.Iyy3 + m.Iyy8) / 2
    mc12 = (m.Ixx3 + m.Ixx8) / 2
    mc13 = (m.I2 + m.I10) / 2
    inertial = [mc1, mc2, mc3, mc4, mc5, mc6, mc7, mc8, mc9, mc10, mc11, mc12, mc13]
    return [mp1, mp2, mp3, *inertial, m.mpl + m.mload, m.Ipl + m.Iload], e3


# fmt: off
_SYMBOLS = (
    "m2", "m3", "m4", "m5", "m7", "m8", "m9",
    "B1", "B2", "B3", "B4", "B7", "B8", "B10",
    "Ixx3", "Iyy3", "Ixx4", "Iyy4", "Ixx7", "Iyy7", "Ixx8", "Iyy8", "I2", "I10",
    "mpl", "Ipl", "mload", "Iload",
)
# fmt: on


def _masses(values: Any) -> SimpleNamespace:
    """Name the values that come in the order of `MASS_PATHS` by the symbols of the formulas."""
    return SimpleNamespace(**dict(zip(_SYMBOLS, values, strict=True)))


@of_design
def mass_vector(design: Design) -> Array:
    """Return the masses and inertias in the order of `MASS_PATHS`, (28,) [kg, kg m^2]."""
    return np.array(_MASS_VALUES(design), dtype=np.float64)


@of_design
def lumped_coefficients(design: Design, misprints: Misprint = Misprint.NONE) -> Array:
    """Return c, (18,), in the order of `COEFFICIENTS` (Appendices 2 and 3).

    M_p are weights [N]; M_c1..7 and m_pl are masses [kg]; M_c8..13 and I_pl are [kg m^2].
    """
    geometry, gravity = design.geometry, design.gravity
    c = np.array(_lumped(geometry, gravity, _masses(mass_vector(design)), misprints)[0])
    for weight in design.counterweights:
        c += weight.mass * point_mass_column(counterweight_point(geometry, weight), gravity)
    return c


def lumped_of_masses(geometries: Sequence[Geometry], gravity: float, masses: Array) -> Array:
    """Return c of many robots without counterweights, (n, 18), see `lumped_coefficients`.

    Args:
        geometries: Their lengths.
        gravity: [m/s^2].
        masses: (n, 28) in the order of `MASS_PATHS` [kg, kg m^2].
    """
    lengths: Any = SimpleNamespace(
        **{
            name: np.array([getattr(g, name) for g in geometries])
            for name in ("magnification", "guide_link_length", "shaft_length")
        }
    )
    columns = _lumped(lengths, gravity, _masses(masses.T), Misprint.NONE)[0]
    return np.stack(np.broadcast_arrays(*columns), axis=-1)


def point_mass_column(point: PointWeights, gravity: float) -> Array:
    """Return what 1 kg at a point of each leg adds to c, (18,), or (18, n) for n points.

    Its height is z5 z_5 + r9 z_9, and its velocity the same sum of those of 5 and 9, so that
    V = m g z has two terms and T = m v^2 / 2 the squares and products of the weights.
    """
    r5, r9, z5 = np.broadcast_arrays(point.r5, point.r9, point.z5)
    column = np.zeros((len(COEFFICIENTS), *r9.shape))
    column[0], column[1] = gravity * z5, gravity * r9
    column[3], column[4], column[5] = 0.5 * r5 * r5, 0.5 * z5 * z5, 0.5 * r9 * r9
    column[6], column[7] = r5 * r9, z5 * r9
    return column


@of_geometry
def lumped_matrix(
    geometry: Geometry, gravity: float = 9.81, misprints: Misprint = Misprint.NONE
) -> Array:
    """Return N, (18, 28): c = N @ mass_vector(design) for a design without counterweights.

    Each of those adds its mass times its `point_mass_column`.
    """
    units = _masses(np.eye(len(MASS_PATHS)))
    return np.array(
        [row + np.zeros(len(MASS_PATHS)) for row in _lumped(geometry, gravity, units, misprints)[0]]
    )


def potential_constant(design: Design) -> float:
    """Return e_3 of Appendix 2, the part of a leg's potential energy that never changes [J].

    Counterweights add nothing to it.
    """
    return float(
        _lumped(design.geometry, design.gravity, _masses(mass_vector(design)), Misprint.NONE)[1]
    )


def energy_terms(c: Array, misprints: Misprint = Misprint.NONE) -> EnergyTerms:
    """Say which entry of c multiplies which term of the energies (Eqs. 11-14).

    Args:
        c: Lumped coefficients, (18,) or (18, n); the result's entries have the rest of its shape.
        misprints: Terms to take as published instead of corrected.
    """
    mp1, mp2, mp3, c1, c2, c3, c4, c5, c6, c7, c8, c9, c10, c11, c12, c13, mass, inertia = c
    none = 0.0 * mass
    lift_published = bool(misprints & Misprint.EQ13_LIFT_SPEED)
    spin_published = bool(misprints & Misprint.EQ13_LEG_SPIN)
    sine = -1.0 if misprints & Misprint.EQ14_SINE_SIGNS else 1.0
    return EnergyTerms(
        v5=mp1, v9=mp2, vz=mp3,
        xy5=c1, z5=c2, p9=c3, xy59=c4, z59=c5,
        lift=none if lift_published else c6,
        z5_lift=c7,
        spin=c13 + (none if spin_published else c8),
        psi=c9,
        phi=c10 if misprints & Misprint.EQ14_PHI_SPEED else c11,
        spin_sin_psi=sine * c10, spin_cos_psi=c9,
        spin_sin_phi=sine * c12, spin_cos_phi=c11,
        lift_linear=c6 if lift_published else none,
        turn=c8 if spin_published else none,
        mass=mass, inertia=inertia,
    )  # fmt: skip


def term_factors(design: Design, misprints: Misprint = Misprint.NONE) -> EnergyTerms:
    """Return the factors of a design's energy terms, as floats."""
    terms = energy_terms(lumped_coefficients(design, misprints), misprints)
    return EnergyTerms(*map(float, terms))


def term_matrix(misprints: Misprint = Misprint.NONE) -> Array:
    """Return S, (21, 18), such that the energy terms are S @ c."""
    return np.array(energy_terms(np.eye(len(COEFFICIENTS)), misprints))
