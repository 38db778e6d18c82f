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
from typing import Any, NamedTuple

import numpy as np

from paminsa_viz.model.arguments import of_design, of_geometry, require_gravity
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

    V has ``v5 z_5 + v9 z_9 + vz Z`` [N]; T has the rest, in the order of Eqs. 13 and 14: [kg] where
    lengths move, [kg m^2] where angles do.
    """

    v5: Any  # M_p1
    v9: Any  # M_p2
    vz: Any  # M_p3
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


class Masses(NamedTuple):
    """Masses and inertias by the paper's symbols, in the order of `MASS_PATHS` [kg, kg m^2]."""

    m2: Any
    m3: Any
    m4: Any
    m5: Any
    m7: Any
    m8: Any
    m9: Any
    B1: Any
    B2: Any
    B3: Any
    B4: Any
    B7: Any
    B8: Any
    B10: Any
    Ixx3: Any
    Iyy3: Any
    Ixx4: Any
    Iyy4: Any
    Ixx7: Any
    Iyy7: Any
    Ixx8: Any
    Iyy8: Any
    I2: Any
    I10: Any
    mpl: Any
    Ipl: Any
    mload: Any
    Iload: Any


def coefficients_of_masses(
    masses: Masses, k: Any, guide_link: Any, g: Any, m7_factor: Any
) -> tuple[Any, ...]:
    """Return c without counterweights (18 values), see `COEFFICIENTS`, as a plain formula.

    Args:
        masses: Masses and inertias.
        k: Magnification of the pantographs.
        guide_link: l_B10 [m].
        g: Gravitational acceleration [m/s^2].
        m7_factor: 2, or 1 for M_c4 as Appendix 3 prints it.
    """
    m = masses
    k1, k2 = k - 1.0, k - 2.0
    kk, kk1 = k * k, k * k1
    kk1_2, k1_2 = kk1 * kk1, k1 * k1
    joints = m.m2 + m.m3 + m.m4 + m.m7
    mp1 = g * (m.m5 + joints / k + m.B4 / 2.0 + (m.B1 + m.B7) / (2.0 * k) + (m.B2 + m.B3) / k)
    mp2 = g * (
        (k1 * m.m4 - m.m7 + k * m.m9) / k + (k2 * m.B3 - m.B7) / (2.0 * k) + (m.B4 + m.B8) / 2.0
    )
    mp3 = g * m.B1 / 2.0
    mc1 = 0.5 * (
        m.m4 / kk
        + m.m5
        + m.m7 / kk1_2
        + m.m8 / k1_2
        + m.B3 * (k2 * k2) / (4.0 * kk1_2)
        + m.B4 / 4.0
        + m.B7 * ((k + 1.0) * (k + 1.0)) / (4.0 * kk1_2)
        + m.B8 / (4.0 * k1_2)
    )
    mc2 = 0.5 * (joints / kk + m.m5 + (m.B1 + m.B7) / (4.0 * kk) + (m.B2 + m.B3) / kk + m.B4 / 4.0)
    mc3 = 0.5 * (
        k1_2 * m.m4 / kk
        + m.m7 / kk
        + m.m9
        + m.B3 * (k2 * k2) / (4.0 * kk)
        + m.B4 / 4.0
        + m.B7 / (4.0 * kk)
        + m.B8 / 4.0
    )
    mc4 = 0.5 * (
        2.0 * k1 * m.m4 / kk
        + m7_factor * m.m7 / (kk * k1)
        + m.B3 * (k2 * k2) / (2.0 * kk * k1)
        + m.B4 / 2.0
        + m.B7 * (k + 1.0) / (2.0 * kk * k1)
        - m.B8 / (2.0 * k1)
    )
    mc5 = 0.5 * ((4.0 * (k1 * m.m4 - m.m7) - m.B7 + 2.0 * m.B3 * k2) / (2.0 * kk) + m.B4 / 2.0)
    mc6 = m.B1 / 8.0
    mc7 = m.B1 / (4.0 * k)
    mc8 = m.B10 * (guide_link * guide_link) / 8.0
    return (
        mp1, mp2, mp3,
        mc1, mc2, mc3, mc4, mc5, mc6, mc7, mc8,
        (m.Iyy4 + m.Iyy7) / 2.0,
        (m.Ixx4 + m.Ixx7) / 2.0,
        (m.Iyy3 + m.Iyy8) / 2.0,
        (m.Ixx3 + m.Ixx8) / 2.0,
        (m.I2 + m.I10) / 2.0,
        m.mpl + m.mload,
        m.Ipl + m.Iload,
    )  # fmt: skip


def _lumped(geometry: Geometry, gravity: float, masses: Masses, misprints: Misprint) -> list[Any]:
    """Appendices 2 and 3 as published, but for the one misprint in them."""
    m7_factor = 1.0 if misprints & Misprint.APP3_MC4 else 2.0
    k, guide_link = geometry.magnification, geometry.guide_link_length
    return list(coefficients_of_masses(masses, k, guide_link, gravity, m7_factor))


@of_design
def mass_vector(design: Design) -> Array:
    """Return the masses and inertias in the order of `MASS_PATHS`, (28,) [kg, kg m^2]."""
    return np.array(_MASS_VALUES(design), dtype=np.float64)


@of_design
def lumped_coefficients(design: Design, misprints: Misprint = Misprint.NONE) -> Array:
    """Return c, (18,), in the order of `COEFFICIENTS` (Appendices 2 and 3).

    M_p are weights [N]; M_c1..7 and m_pl are masses [kg]; M_c8..13 and I_pl are [kg m^2]. The
    payload is part of m_pl and I_pl, counterweights are part of M_p and M_c.

    Args:
        design: The robot.
        misprints: Formulas to take as published; of c that is M_c4 alone.
    """
    geometry, gravity = design.geometry, design.gravity
    c = np.array(_lumped(geometry, gravity, Masses(*mass_vector(design)), misprints))
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
    k = np.array([geometry.magnification for geometry in geometries])
    guide_link = np.array([geometry.guide_link_length for geometry in geometries])
    columns = coefficients_of_masses(Masses(*masses.T), k, guide_link, gravity, 2.0)
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

    Args:
        geometry: Lengths of the mechanism.
        gravity: Gravitational acceleration [m/s^2].
        misprints: As in `lumped_coefficients`.

    Raises:
        InvalidInput: If the gravity is none that a design has.
    """
    require_gravity(gravity)
    units = Masses(*np.eye(len(MASS_PATHS)))
    return np.array(
        [row + np.zeros(len(MASS_PATHS)) for row in _lumped(geometry, gravity, units, misprints)]
    )


def potential_constant(design: Design) -> float:
    """Return e_3 of Appendix 2, the part of a leg's potential energy that never changes [J].

    Counterweights add nothing to it.
    """
    m = Masses(*mass_vector(design))
    height = design.geometry.shaft_length
    return float(design.gravity * height * (m.m2 + (m.B1 + m.B2) / 2))


def energy_terms(c: Array, misprints: Misprint) -> EnergyTerms:
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
