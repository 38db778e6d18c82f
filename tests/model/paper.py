"""The paper's formulas typed again from its text, for the tests to hold the model against.

Eqs. 11-17 and Appendices 1 to 3, on numbers, arrays, complex numbers or jets. `Misprint` chooses
what is taken as published; everything else of READING's table is corrected. Lagrange's left side is
differentiated here to rounding: L is a polynomial of second degree in the rates, so that a central
difference of any size gives its slope exactly, and complex steps give the rest.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from paminsa_viz.model import Design, Geometry, Misprint
from tests.jets import Jet, cos, sin, sqrt

STEP = 1e-30


@dataclass(frozen=True)
class PaperLeg:
    """Appendix 1's quantities of one leg, in the paper's letters."""

    e1: float
    e2: float
    beta: Any
    x5: Any
    y5: Any
    z5: Any
    X1: Any
    X4: Any
    Z1: Any
    A: Any
    B: Any
    C: Any
    D: Any
    E: Any
    K: Any
    F: Any
    H: Any
    x9: Any
    y9: Any
    z9: Any


def base_points(g: Geometry) -> list[tuple[float, float]]:
    """(e_1k, e_2k), with the indices of the third leg's in their right order."""
    e11, e21 = -np.sqrt(3) / 2 * g.base_radius, -g.base_radius / 2
    e12, e22 = -e11, e21
    e13, e23 = 0.0, g.base_radius
    return [(e11, e21), (e12, e22), (e13, e23)]


def appendix_1(g: Geometry, q: Any) -> list[PaperLeg]:
    """Appendix 1 for the eight coordinates q = (x, y, theta, z, theta_1, theta_2, theta_3, Z)."""
    x, y, theta, z, *thetas, _ = q
    k, rpl = g.magnification, g.platform_radius
    l3, l4 = g.crank_length, g.coupler_length
    points5 = [
        (x - rpl * cos(theta + np.pi / 6), y - rpl * sin(theta + np.pi / 6)),
        (x + rpl * cos(-1.0 * theta + np.pi / 6), y - rpl * sin(-1.0 * theta + np.pi / 6)),
        (x - rpl * sin(theta), y + rpl * cos(theta)),
    ]
    betas = [thetas[0] + np.pi / 6, thetas[1] + 5 * np.pi / 6, thetas[2] + 3 * np.pi / 2]
    legs = []
    for (x5, y5), (e1, e2), beta in zip(points5, base_points(g), betas, strict=True):
        z5 = z + g.platform_joint_height
        X1 = sqrt((x5 - e1) * (x5 - e1) + (y5 - e2) * (y5 - e2))
        X4 = -1.0 * X1 / (k - 1)
        Z1 = z5
        A = (l4**2 - l3**2 - X1 * X1 + X4 * X4 - Z1 * Z1) / (2 * k * X4)
        B = Z1 / (k * X4)
        C = l3**2 - X4 * X4 + 2 * A * X4 - A * A
        D = 2 * B * (X4 - A)
        E = -1.0 * (B * B + 1)
        K = sqrt(D * D - 4 * E * C)
        F = -1.0 * (D - g.knee.sign * K) / (2 * E)
        H = A + B * F
        x9, y9, z9 = e1 + H * cos(beta), e2 + H * sin(beta), F
        legs.append(
            PaperLeg(e1, e2, beta, x5, y5, z5, X1, X4, Z1, A, B, C, D, E, K, F, H, x9, y9, z9)
        )
    return legs


def closure(g: Geometry, q: Any) -> list[Any]:
    """s_1..s_4, Eqs. 16 and 17."""
    found = [
        (leg.x5 - leg.e1) * sin(leg.beta) - (leg.y5 - leg.e2) * cos(leg.beta)
        for leg in appendix_1(g, q)
    ]
    return [*found, (q[3] + g.platform_joint_height) / g.magnification - q[7] + g.shaft_length]


def appendix_2(design: Design) -> dict[str, float]:
    """M_p1, M_p2, M_p3 and e_3."""
    k, g, lb2 = design.geometry.magnification, design.gravity, design.geometry.shaft_length
    m = {i: getattr(design.joints, f"j{i}") for i in (2, 3, 4, 5, 7, 8, 9)}
    mb = {i: getattr(design.links, f"b{i}") for i in (1, 2, 3, 4, 7, 8, 10)}
    return {
        "Mp1": g
        * (
            m[5]
            + sum(m[i] / k for i in (2, 3, 4, 7))
            + mb[4] / 2
            + sum(mb[i] / (2 * k) for i in (1, 7))
            + sum(mb[i] / k for i in (2, 3))
        ),
        "Mp2": g
        * (
            ((k - 1) * m[4] - m[7] + k * m[9]) / k
            + ((k - 2) * mb[3] - mb[7]) / (2 * k)
            + (mb[4] + mb[8]) / 2
        ),
        "Mp3": g * mb[1] / 2,
        "e3": g * lb2 * (m[2] + (mb[1] + mb[2]) / 2),
    }


def appendix_3(design: Design, misprints: Misprint = Misprint.NONE) -> dict[str, float]:
    """M_c1 to M_c13."""
    k = design.geometry.magnification
    m = {i: getattr(design.joints, f"j{i}") for i in (2, 3, 4, 5, 7, 8, 9)}
    mb = {i: getattr(design.links, f"b{i}") for i in (1, 2, 3, 4, 7, 8, 10)}
    xx = {i: getattr(design.inertias, f"b{i}_axial") for i in (3, 4, 7, 8)}
    yy = {i: getattr(design.inertias, f"b{i}_transverse") for i in (3, 4, 7, 8)}
    seven = 1 if Misprint.APP3_MC4 in misprints else 2
    terms = {
        1: m[4] / k**2
        + m[5]
        + m[7] / (k * (k - 1)) ** 2
        + m[8] / (k - 1) ** 2
        + mb[3] * (k - 2) ** 2 / (2 * k * (k - 1)) ** 2
        + mb[4] / 4
        + mb[7] * (k + 1) ** 2 / (2 * k * (k - 1)) ** 2
        + mb[8] / (2 * (k - 1)) ** 2,
        2: sum(m[i] / k**2 for i in (2, 3, 4, 7))
        + m[5]
        + sum(mb[i] / (4 * k**2) for i in (1, 7))
        + sum(mb[i] / k**2 for i in (2, 3))
        + mb[4] / 4,
        3: (k - 1) ** 2 * m[4] / k**2
        + m[7] / k**2
        + m[9]
        + mb[3] * (k - 2) ** 2 / (4 * k**2)
        + mb[4] / 4
        + mb[7] / (4 * k**2)
        + mb[8] / 4,
        4: 2 * (k - 1) * m[4] / k**2
        + seven * m[7] / (k**2 * (k - 1))
        + mb[3] * (k - 2) ** 2 / (2 * k**2 * (k - 1))
        + mb[4] / 2
        + mb[7] * (k + 1) / (2 * k**2 * (k - 1))
        - mb[8] / (2 * (k - 1)),
        5: (4 * ((k - 1) * m[4] - m[7]) - mb[7] + 2 * mb[3] * (k - 2)) / (2 * k**2) + mb[4] / 2,
        6: mb[1] / 4,
        7: mb[1] / (2 * k),
        8: mb[10] * design.geometry.guide_link_length**2 / 4,
        9: yy[4] + yy[7],
        10: xx[4] + xx[7],
        11: yy[3] + yy[8],
        12: xx[3] + xx[8],
        13: design.inertias.b2_vertical + design.inertias.b10_vertical,
    }
    return {f"Mc{i}": value / 2 for i, value in terms.items()}


def kinetic(design: Design, q: Any, v: Any, misprints: Misprint = Misprint.NONE) -> Any:
    """T of Eqs. 12 to 14 at the eight coordinates q and their rates v."""
    g = design.geometry
    c = appendix_3(design, misprints)
    moving = [Jet(*pair) for pair in zip(q, v, strict=True)]
    mass = design.platform.mass + design.payload.mass
    inertia = design.platform.inertia + design.payload.inertia
    total = (mass * (v[0] ** 2 + v[1] ** 2 + v[3] ** 2) + inertia * v[2] ** 2) / 2
    lift = v[7]
    for number, leg in enumerate(appendix_1(g, moving)):
        spin = v[4 + number]
        x5, y5, z5 = leg.x5.rate, leg.y5.rate, leg.z5.rate
        x9, y9, z9 = leg.x9.rate, leg.y9.rate, leg.z9.rate
        # psi: elevation of 5 seen from 9; phi: elevation of 9 seen from 8
        sin_psi, cos_psi = (leg.z5 - leg.F) / g.coupler_length, (leg.X1 - leg.H) / g.coupler_length
        sin_phi, cos_phi = leg.F / g.crank_length, (leg.H - leg.X4) / g.crank_length
        psi = cos_psi.a * sin_psi.rate - sin_psi.a * cos_psi.rate
        phi = cos_phi.a * sin_phi.rate - sin_phi.a * cos_phi.rate
        total = total + (
            c["Mc1"] * (x5**2 + y5**2)
            + c["Mc2"] * z5**2
            + c["Mc3"] * (x9**2 + y9**2 + z9**2)
            + c["Mc4"] * (x5 * x9 + y5 * y9)
            + c["Mc5"] * z5 * z9
            + c["Mc6"] * (lift if Misprint.EQ13_LIFT_SPEED in misprints else lift**2)
            + c["Mc7"] * z5 * lift
            + c["Mc8"] * (v[2] ** 2 if Misprint.EQ13_LEG_SPIN in misprints else spin**2)
        )
        sine = -1 if Misprint.EQ14_SINE_SIGNS in misprints else 1
        total = total + (
            c["Mc9"] * psi**2
            + (c["Mc10"] if Misprint.EQ14_PHI_SPEED in misprints else c["Mc11"]) * phi**2
            + spin**2
            * (
                c["Mc13"]
                + sine * c["Mc10"] * sin_psi.a**2
                + c["Mc9"] * cos_psi.a**2
                + sine * c["Mc12"] * sin_phi.a**2
                + c["Mc11"] * cos_phi.a**2
            )
        )
    return total


def potential(design: Design, q: Any) -> Any:
    """V of Eq. 11 at the eight coordinates q."""
    c = appendix_2(design)
    mass = design.platform.mass + design.payload.mass
    return mass * design.gravity * q[3] + sum(
        c["Mp1"] * leg.z5 + c["Mp2"] * leg.z9 + c["Mp3"] * q[7] + c["e3"]
        for leg in appendix_1(design.geometry, q)
    )


def slopes(f: Any, q: Any) -> Any:
    """Derivatives of f by the eight coordinates, (..., 8); (..., n, 8) for a list of n results."""
    found = []
    for j in range(8):
        result = f([value + 1j * STEP * (i == j) for i, value in enumerate(q)])
        values = np.stack(np.broadcast_arrays(*result), -1) if isinstance(result, list) else result
        found.append(values.imag / STEP)
    return np.stack(np.broadcast_arrays(*found), axis=-1)


def lagrange(design: Design, q: Any, v: Any, a: Any, misprints: Misprint = Misprint.NONE) -> Any:
    """d/dt(dL/dq') - dL/dq of Eq. 15 for arrays q, v, a (..., 8), as (..., 8)."""
    q, v, a = (list(np.moveaxis(np.asarray(values, float), -1, 0)) for values in (q, v, a))
    # along the motion, one complex step of time later
    q_next = [value + 1j * STEP * rate for value, rate in zip(q, v, strict=True)]
    v_next = [rate + 1j * STEP * second for rate, second in zip(v, a, strict=True)]
    columns = []
    for j in range(8):
        up, down = (
            kinetic(design, q_next, [r + s * (i == j) for i, r in enumerate(v_next)], misprints)
            for s in (1.0, -1.0)
        )
        columns.append((0.5 * (up - down)).imag / STEP)
    growth = np.stack(np.broadcast_arrays(*columns), axis=-1)
    by_place = slopes(
        lambda p: kinetic(design, p, [r + 0j for r in v], misprints) - potential(design, p), q
    )
    return growth - by_place
