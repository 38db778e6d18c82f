"""The robot from its three legs: torques, inertia, singularity, reach, as plain formulas.

The same source serves NumPy and the compiler; see `leg.py` for notation and conventions. Outputs
of an unreachable pose are NaN: each formula starts from the square root that fails there.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from paminsa_viz.model.leg import (
    SINGULAR,
    LegPosition,
    LegVector,
    Mechanism,
    knee_height,
    leg_motion,
    leg_position,
    leg_vector,
    pantograph,
)
from paminsa_viz.model.leg_forces import leg_forces, leg_inertia
from paminsa_viz.model.lumped import EnergyTerms

HALF_ROOT_3 = 0.8660254037844386
AXIS_X = (-HALF_ROOT_3, HALF_ROOT_3, 0.0)
AXIS_Y = (-0.5, -0.5, 1.0)
"""Directions from the base center to the leg axes, at 210, -30 and 90 degrees (e_k / R_b)."""


def where(condition: Any, yes: Any, no: Any) -> Any:
    """Elementwise ``yes if condition else no``; compiled to a branchless select."""
    return np.where(condition, yes, no)


def lesser(value: Any, other: Any) -> Any:
    """Return the lesser of two values, units as of the values; a first one that is NaN stays.

    A helper, not in the paper.
    """
    return where(other < value, other, value)


class TangentialForces(NamedTuple):
    """Solution t of sum_k t_k (w_k rho_k, p_k x w_k rho_k) = (fx, fy, ft), w_k tangential [N/m]."""

    t1: Any
    t2: Any
    t3: Any


def platform_determinant(m: Mechanism, x: Any, y: Any, c: Any) -> Any:
    """Return det of the rows (w_k rho_k, p_k . d_k) [m^4], zero at type-2 singularities.

    The rows are the derivatives of Eq. 16 by x, y and theta. It has the closed form
    -(3 sqrt(3)/2) R_pl (R_b cos theta - R_pl) (r_s^2 - x^2 - y^2) with
    r_s^2 = R_b^2 + R_pl^2 - 2 R_b R_pl cos theta. It is zero where one of the
    two factors is within `SINGULAR` of zero.
    """
    turn, place = determinant_factors(m, x, y, c)
    size = m.base_radius + m.platform_radius
    decided = (np.abs(turn) > SINGULAR * size) & (np.abs(place) > SINGULAR * size * size)
    return where(decided, -3.0 * HALF_ROOT_3 * m.platform_radius * turn * place, 0.0)


def determinant_factors(m: Mechanism, x: Any, y: Any, c: Any) -> tuple[Any, Any]:
    """Return R_b cos theta - R_pl [m] and r_s^2 - x^2 - y^2 [m^2], zero at type-2 singularities.

    They are the factors of `platform_determinant`, the determinant of Eq. 16's derivatives.
    """
    rb, rp = m.base_radius, m.platform_radius
    locus = rb * rb + rp * rp - 2.0 * rb * rp * c
    return rb * c - rp, locus - x * x - y * y


def solve_wrench(
    determinant: Any, a: LegVector, b: LegVector, d: LegVector, fx: Any, fy: Any, ft: Any
) -> TangentialForces:
    """Split a horizontal force and a vertical moment on the platform over the three legs.

    These are the first three equations of Eq. 15 for the multipliers, by Cramer's rule.

    Args:
        determinant: `platform_determinant` [m^4].
        a, b, d: Vectors of the legs 1, 2, 3.
        fx, fy, ft: The force [N, N] and the moment [N m].
    """
    ma = a.px * a.dx + a.py * a.dy
    mb = b.px * b.dx + b.py * b.dy
    md = d.px * d.dx + d.py * d.dy
    inverse = 1.0 / determinant
    t1 = (
        fx * (b.dx * md - mb * d.dx)
        + fy * (b.dy * md - mb * d.dy)
        + ft * (b.dx * d.dy - b.dy * d.dx)
    )
    t2 = (
        fx * (d.dx * ma - md * a.dx)
        + fy * (d.dy * ma - md * a.dy)
        + ft * (d.dx * a.dy - d.dy * a.dx)
    )
    t3 = (
        fx * (a.dx * mb - ma * b.dx)
        + fy * (a.dy * mb - ma * b.dy)
        + ft * (a.dx * b.dy - a.dy * b.dx)
    )
    return TangentialForces(t1 * inverse, t2 * inverse, t3 * inverse)


def _slope(m: Mechanism, v: LegVector, zeta: Any) -> tuple[Any, Any]:
    """Return the derivatives of z9 = F (Appendix 1) that statics needs, see `knee_height`.

    They are that by rho divided by rho [1/m], and that by zeta [1].
    """
    _, by_rho, by_zeta = knee_height(m, pantograph(m, v.rho2, zeta), zeta)
    return by_rho, by_zeta


def _usable(m: Mechanism, v: LegVector, zeta: Any) -> Any:
    """Whether joint 8 is on its guide, joint 5 off its leg axis, and the pantograph bent.

    Then the square roots of Appendix 1 are real; ``zeta`` is the height of joint 5 [m].
    """
    reach2 = m.span_ratio * m.span_ratio * v.rho2 + zeta * zeta
    on_guide = (v.rho2 <= m.rho2_max) & (v.rho2 > m.rho2_min)
    return on_guide & (reach2 > m.reach2_min) & (reach2 < m.reach2_max)


def unit_torques(m: Mechanism, x: Any, y: Any, c: Any, s: Any, z: Any) -> tuple[Any, Any, Any, Any]:
    """Return Gamma, the static torques [m] and force [1] of M1..M4 for M_p2 = 1 N.

    The potential energy depends on x, y and theta through the knees alone, so that
    Q_j = M_p2 Gamma_j for j = 1, 2, 3 (Eq. 5); for M4 a constant comes on top.
    """
    zeta = z + m.joint_height
    v1 = leg_vector(m, AXIS_X[0], AXIS_Y[0], x, y, c, s)
    v2 = leg_vector(m, AXIS_X[1], AXIS_Y[1], x, y, c, s)
    v3 = leg_vector(m, AXIS_X[2], AXIS_Y[2], x, y, c, s)
    f1, h1 = _slope(m, v1, zeta)
    f2, h2 = _slope(m, v2, zeta)
    f3, h3 = _slope(m, v3, zeta)
    fx = f1 * v1.dx + f2 * v2.dx + f3 * v3.dx
    fy = f1 * v1.dy + f2 * v2.dy + f3 * v3.dy
    ft = (
        f1 * (v1.px * v1.dy - v1.py * v1.dx)
        + f2 * (v2.px * v2.dy - v2.py * v2.dx)
        + f3 * (v3.px * v3.dy - v3.py * v3.dx)
    )
    t = solve_wrench(platform_determinant(m, x, y, c), v1, v2, v3, fx, fy, ft)
    usable = _usable(m, v1, zeta) & _usable(m, v2, zeta) & _usable(m, v3, zeta)
    return (
        where(usable, t.t1 * v1.rho2, np.nan),
        where(usable, t.t2 * v2.rho2, np.nan),
        where(usable, t.t3 * v3.rho2, np.nan),
        where(usable, (h1 + h2 + h3) * m.k, np.nan),
    )


def _vector(g: LegPosition) -> LegVector:
    """Return the vectors [m] of a leg by its position (P_5k, Appendix 1)."""
    return LegVector(g.px, g.py, g.ux * g.rho, g.uy * g.rho, g.rho * g.rho)


class ActuatorForces(NamedTuple):
    """Actuator torques [N m] and force [N], and the multipliers of Eqs. 16 and 17, s_1..s_4 [N]."""

    tau1: Any
    tau2: Any
    tau3: Any
    f4: Any
    lambda1: Any
    lambda2: Any
    lambda3: Any
    lambda4: Any


def inverse_dynamics_kernel(
    m: Mechanism, e: EnergyTerms, gravity: Any,
    x: Any, y: Any, c: Any, s: Any, z: Any,
    vx: Any, vy: Any, vt: Any, vz: Any,
    ax: Any, ay: Any, at: Any, az: Any,
) -> ActuatorForces:  # fmt: skip
    """Inverse dynamics as the paper solves it (Eqs. 15-21).

    The first four Lagrange equations (x, y, theta, z) give the multipliers, the last four
    (theta_1..3, Z) the torques.

    Args:
        m: The mechanism.
        e: Factors of the energies.
        gravity: It acts on the platform; the legs' weights are in the factors [m/s^2].
        x, y, c, s, z: Platform position [m], cos theta and sin theta.
        vx, vy, vt, vz: Platform velocity [m/s, m/s, rad/s, m/s].
        ax, ay, at, az: Platform acceleration [m/s^2, m/s^2, rad/s^2, m/s^2].
    """
    g1 = leg_position(m, AXIS_X[0], AXIS_Y[0], x, y, c, s, z)
    g2 = leg_position(m, AXIS_X[1], AXIS_Y[1], x, y, c, s, z)
    g3 = leg_position(m, AXIS_X[2], AXIS_Y[2], x, y, c, s, z)
    f1 = leg_forces(m, e, g1, leg_motion(m, g1, vx, vy, vt, vz, ax, ay, at, az))
    f2 = leg_forces(m, e, g2, leg_motion(m, g2, vx, vy, vt, vz, ax, ay, at, az))
    f3 = leg_forces(m, e, g3, leg_motion(m, g3, vx, vy, vt, vz, ax, ay, at, az))
    # horizontal forces on the points 5
    x1, y1 = f1.radial * g1.ux - f1.tangential * g1.uy, f1.radial * g1.uy + f1.tangential * g1.ux
    x2, y2 = f2.radial * g2.ux - f2.tangential * g2.uy, f2.radial * g2.uy + f2.tangential * g2.ux
    x3, y3 = f3.radial * g3.ux - f3.tangential * g3.uy, f3.radial * g3.uy + f3.tangential * g3.ux
    fx = x1 + x2 + x3 + e.mass * ax
    fy = y1 + y2 + y3 + e.mass * ay
    ft = (
        (g1.px * y1 - g1.py * x1)
        + (g2.px * y2 - g2.py * x2)
        + (g3.px * y3 - g3.py * x3)
        + (e.inertia + 6.0 * e.turn) * at
    )
    fz = f1.vertical + f2.vertical + f3.vertical + e.mass * (az + gravity)

    v1, v2, v3 = _vector(g1), _vector(g2), _vector(g3)
    t = solve_wrench(platform_determinant(m, x, y, c), v1, v2, v3, fx, fy, ft)
    usable = _usable(m, v1, g1.zeta) & _usable(m, v2, g2.zeta) & _usable(m, v3, g3.zeta)
    # A_ij: d s_k/d theta_k = rho_k; by x, y, theta it is -1/rho_k times a row of
    # `solve_wrench`; d s_4 = 1/k, -1
    lambda1, lambda2, lambda3 = -g1.rho * t.t1, -g2.rho * t.t2, -g3.rho * t.t3
    lambda4 = fz * m.k
    return ActuatorForces(
        where(usable, f1.torque - lambda1 * g1.rho, np.nan),
        where(usable, f2.torque - lambda2 * g2.rho, np.nan),
        where(usable, f3.torque - lambda3 * g3.rho, np.nan),
        where(usable, f1.lift + f2.lift + f3.lift + lambda4, np.nan),
        where(usable, lambda1, np.nan),
        where(usable, lambda2, np.nan),
        where(usable, lambda3, np.nan),
        where(usable, lambda4, np.nan),
    )


def _leg_mass(
    m: Mechanism, e: EnergyTerms, leg: int, x: Any, y: Any, c: Any, s: Any, z: Any
) -> tuple[Any, ...]:
    """Return the part of one leg in `mass_matrix` (Eqs. 13 and 14) [kg, kg m, kg m^2].

    The first leg has the number 0; other arguments as in `mass_matrix`.
    """
    g = leg_position(m, AXIS_X[leg], AXIS_Y[leg], x, y, c, s, z)
    i = leg_inertia(m, e, g)
    cross_p = g.px * g.uy - g.py * g.ux  # d rho / d theta
    dot_p = g.px * g.ux + g.py * g.uy  # rho d theta_k / d theta
    turn = i.beta * g.inverse_rho * g.inverse_rho
    return (
        i.rho * g.ux * g.ux + turn * g.uy * g.uy,
        (i.rho - turn) * g.ux * g.uy,
        i.rho * g.ux * cross_p - turn * g.uy * dot_p,
        i.cross * g.ux,
        i.rho * g.uy * g.uy + turn * g.ux * g.ux,
        i.rho * g.uy * cross_p + turn * g.ux * dot_p,
        i.cross * g.uy,
        i.rho * cross_p * cross_p + turn * dot_p * dot_p,
        i.cross * cross_p,
        i.zeta,
    )


def mass_matrix(
    m: Mechanism, e: EnergyTerms, x: Any, y: Any, c: Any, s: Any, z: Any
) -> tuple[Any, ...]:
    """Return the upper triangle of the mass matrix in (x, y, theta, z), row by row (10 values).

    T = v.M v/2 is the kinetic energy of Eqs. 12-14 [kg; kg m in theta's row or column; kg m^2].

    Args:
        m: The mechanism.
        e: Factors of the energies.
        x, y, c, s, z: Platform position [m], cos theta and sin theta.
    """
    a = _leg_mass(m, e, 0, x, y, c, s, z)
    b = _leg_mass(m, e, 1, x, y, c, s, z)
    d = _leg_mass(m, e, 2, x, y, c, s, z)
    return (
        a[0] + b[0] + d[0] + e.mass,
        a[1] + b[1] + d[1],
        a[2] + b[2] + d[2],
        a[3] + b[3] + d[3],
        a[4] + b[4] + d[4] + e.mass,
        a[5] + b[5] + d[5],
        a[6] + b[6] + d[6],
        a[7] + b[7] + d[7] + e.inertia + 6.0 * e.turn,
        a[8] + b[8] + d[8],
        a[9] + b[9] + d[9] + e.mass,
    )


class Acceleration(NamedTuple):
    """Solution of M a = f, and the least pivot of M: not positive if some motion has no inertia."""

    x: Any  # [m/s^2]
    y: Any  # [m/s^2]
    theta: Any  # [rad/s^2]
    z: Any  # [m/s^2]
    pivot: Any  # of elimination, in the units of its column [kg, kg m^2]


def acceleration_of_force(
    a0: Any, a1: Any, a2: Any, a3: Any, a4: Any, a5: Any, a6: Any, a7: Any, a8: Any, a9: Any,
    fx: Any, fy: Any, ft: Any, fz: Any,
) -> Acceleration:  # fmt: skip
    """Solve M a = f in (x, y, theta, z) by M = L D L^T: Eq. 15 for the accelerations.

    Args:
        a0, a1, a2, a3, a4, a5, a6, a7, a8, a9: Upper triangle of M as of `mass_matrix`.
        fx, fy, ft, fz: The generalized force [N, N, N m, N].
    """
    l10, l20, l30 = a1 / a0, a2 / a0, a3 / a0
    d1 = a4 - l10 * a1
    e21 = a5 - l20 * a1
    e31 = a6 - l30 * a1
    l21, l31 = e21 / d1, e31 / d1
    d2 = a7 - l20 * a2 - l21 * e21
    e32 = a8 - l30 * a2 - l31 * e21
    l32 = e32 / d2
    d3 = a9 - l30 * a3 - l31 * e31 - l32 * e32
    b1 = fy - l10 * fx
    b2 = ft - l20 * fx - l21 * b1
    b3 = fz - l30 * fx - l31 * b1 - l32 * b2
    z = b3 / d3
    theta = b2 / d2 - l32 * z
    y = b1 / d1 - l21 * theta - l31 * z
    x = fx / a0 - l10 * y - l20 * theta - l30 * z
    return Acceleration(x, y, theta, z, lesser(lesser(lesser(a0, d1), d2), d3))
