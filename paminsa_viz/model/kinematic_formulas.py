"""Angles, Jacobians, assembly modes and friction as plain formulas.

The same source serves NumPy, the compiler and the printers of `paminsa_viz.codegen`; see `leg.py`
for notation and conventions.
"""

from __future__ import annotations

from math import pi, radians
from typing import Any, NamedTuple

import numpy as np

from paminsa_viz.model.leg import ROUNDING, LegPosition, LegVector, Mechanism, leg_vector
from paminsa_viz.model.robot import (
    AXIS_X,
    AXIS_Y,
    lesser,
    platform_determinant,
    solve_wrench,
    where,
)

PI = pi
TWO_PI = 2 * pi

HEADING = (radians(30.0), radians(150.0), radians(270.0))
"""beta_k at theta_k = 0 [rad] (Appendix 1)."""

SMALLEST_SIZE = 1e-12
"""Below it the three leg lines of given actuator positions count as parallel."""


def wrap_angle(angle: Any) -> Any:
    """Return an angle in (-pi, pi] [rad]; not in the paper."""
    return PI - np.mod(PI - angle, TWO_PI)


class LegAngles(NamedTuple):
    """Angles of a leg."""

    theta: Any  # actuator, theta_k [rad]
    beta: Any  # heading of the leg's plane [rad]
    psi: Any  # elevation of B4, from 9 to 5 [rad]
    phi: Any  # elevation of B8, from 8 to 9 [rad]


def leg_angles(g: LegPosition, heading: Any) -> LegAngles:
    """Return the angles of a leg (Appendix 1); ``heading`` is its beta at theta_k = 0 [rad].

    theta_k is in (-pi, pi].
    """
    beta = np.arctan2(g.uy, g.ux)
    return LegAngles(
        wrap_angle(beta - heading),
        beta,
        np.arctan2(g.sin_psi, g.cos_psi),
        np.arctan2(g.sin_phi, g.cos_phi),
    )


def lift_position(m: Mechanism, z: Any) -> Any:
    """Return Z, the position of M4, for the platform's z, both [m] (Eq. 17)."""
    return (z + m.joint_height) / m.k + m.shaft


class JointRow(NamedTuple):
    """Row k of the inverse Jacobian: theta_k' for a unit x', y', theta'."""

    x: Any  # [rad/m]
    y: Any  # [rad/m]
    theta: Any  # [1]


def joint_row(v: LegVector) -> JointRow:
    """Return row k of the inverse Jacobian (Eq. 16 derived by time) [rad/m, rad/m, 1]."""
    return JointRow(-v.dy / v.rho2, v.dx / v.rho2, (v.px * v.dx + v.py * v.dy) / v.rho2)


def joint_row_rate(v: LegVector, vx: Any, vy: Any, vt: Any) -> JointRow:
    """Return the derivative of `joint_row` by time for a platform velocity [m/s, m/s, rad/s].

    It is Eq. 16 derived twice by time.
    """
    px_rate, py_rate = -vt * v.py, vt * v.px
    dx_rate, dy_rate = vx + px_rate, vy + py_rate
    rho2_rate = 2.0 * (v.dx * dx_rate + v.dy * dy_rate)
    moment = v.px * v.dx + v.py * v.dy
    moment_rate = px_rate * v.dx + py_rate * v.dy + v.px * dx_rate + v.py * dy_rate
    return JointRow(
        (-dy_rate + v.dy * rho2_rate / v.rho2) / v.rho2,
        (dx_rate - v.dx * rho2_rate / v.rho2) / v.rho2,
        (moment_rate - moment * rho2_rate / v.rho2) / v.rho2,
    )


def speed_rows(m: Mechanism, x: Any, y: Any, c: Any, s: Any, z: Any) -> tuple[Any, ...]:
    """Return the rows of J^-1 for M1..M3 and (x, y, theta), row by row (9 values) [1/m, 1/m, 1].

    They are Eq. 16 derived by time. Arguments are the platform's position [m], cos and sin theta.
    """
    a = joint_row(leg_vector(m, AXIS_X[0], AXIS_Y[0], x, y, c, s))
    b = joint_row(leg_vector(m, AXIS_X[1], AXIS_Y[1], x, y, c, s))
    d = joint_row(leg_vector(m, AXIS_X[2], AXIS_Y[2], x, y, c, s))
    return (a.x, a.y, a.theta, b.x, b.y, b.theta, d.x, d.y, d.theta)


def speed_row_rates(
    m: Mechanism, x: Any, y: Any, c: Any, s: Any, vx: Any, vy: Any, vt: Any
) -> tuple[Any, ...]:
    """Return the derivatives by time of the values of `speed_rows` for a platform velocity.

    It is Eq. 16 derived twice by time; the velocity is in [m/s, m/s, rad/s].
    """
    a = joint_row_rate(leg_vector(m, AXIS_X[0], AXIS_Y[0], x, y, c, s), vx, vy, vt)
    b = joint_row_rate(leg_vector(m, AXIS_X[1], AXIS_Y[1], x, y, c, s), vx, vy, vt)
    d = joint_row_rate(leg_vector(m, AXIS_X[2], AXIS_Y[2], x, y, c, s), vx, vy, vt)
    return (a.x, a.y, a.theta, b.x, b.y, b.theta, d.x, d.y, d.theta)


def wrench_torques(m: Mechanism, x: Any, y: Any, c: Any, s: Any, z: Any) -> tuple[Any, ...]:
    """Return J for (x, y, theta) and M1..M3, row by row: rows [m], [m], [1] (9 values).

    Column j is the platform's velocity for a unit speed of M_j; row i is also the torques that
    balance a unit force along x, along y, a unit moment about z (Eqs. 2 and 3). Not finite at a
    singularity.
    """
    v1 = leg_vector(m, AXIS_X[0], AXIS_Y[0], x, y, c, s)
    v2 = leg_vector(m, AXIS_X[1], AXIS_Y[1], x, y, c, s)
    v3 = leg_vector(m, AXIS_X[2], AXIS_Y[2], x, y, c, s)
    det = platform_determinant(m, x, y, c)
    jx = solve_wrench(det, v1, v2, v3, 1.0, 0.0, 0.0)
    jy = solve_wrench(det, v1, v2, v3, 0.0, 1.0, 0.0)
    jt = solve_wrench(det, v1, v2, v3, 0.0, 0.0, 1.0)
    r1, r2, r3 = v1.rho2, v2.rho2, v3.rho2
    return (
        jx.t1 * r1, jx.t2 * r2, jx.t3 * r3,
        jy.t1 * r1, jy.t2 * r2, jy.t3 * r3,
        jt.t1 * r1, jt.t2 * r2, jt.t3 * r3,
    )  # fmt: skip


class Heading(NamedTuple):
    """Direction of a leg's plane, and how far it is turned from the direction of the leg axis."""

    c: Any  # cos beta
    s: Any  # sin beta
    turn_c: Any  # cosine of beta less the direction of the leg axis
    turn_s: Any


class Assembly(NamedTuple):
    """A pose of the platform for given actuator positions; NaN if there is none."""

    x: Any  # [m]
    y: Any  # [m]
    c: Any  # cos theta
    s: Any  # sin theta
    along: Any  # least distance of a joint 5 from its leg axis, along its leg's plane [m]


class Closing(NamedTuple):
    """Cosine and sine of the middle of both solutions for theta, and of half their distance."""

    c: Any
    s: Any
    half_c: Any
    half_s: Any


def plane_heading(ax: Any, ay: Any, c: Any, s: Any) -> Heading:
    """Return the heading of the leg whose axis is at R_b (ax, ay); c, s: cos and sin beta_k.

    All are cosines and sines, with no unit (Appendix 1).
    """
    return Heading(c, s, c * ax + s * ay, s * ax - c * ay)


def closing_angles(m: Mechanism, h1: Heading, h2: Heading, h3: Heading) -> Closing:
    """Return where the three leg lines can meet the platform's joints (Eq. 16).

    The closure equations are linear in x, y, cos theta and sin theta. Weights with
    sum_k n_k (sin beta_k, cos beta_k) = 0 take x and y out; with cos^2 + sin^2 = 1 one quadratic
    is left. All are cosines and sines, with no unit.
    """
    n1 = h2.s * h3.c - h2.c * h3.s
    n2 = h3.s * h1.c - h3.c * h1.s
    n3 = h1.s * h2.c - h1.c * h2.s
    a = n1 * h1.turn_s + n2 * h2.turn_s + n3 * h3.turn_s
    b = n1 * h1.turn_c + n2 * h2.turn_c + n3 * h3.turn_c
    length = np.sqrt(a * a + b * b)
    size = where(length > SMALLEST_SIZE, length, np.nan)
    radii = m.base_radius / m.platform_radius
    ratio = radii * a / size
    # At a double root it is 1 in size, but for rounding.
    slack = 4.0 * ROUNDING * radii / size
    clipped = where(ratio > 1.0, 1.0, where(ratio < -1.0, -1.0, ratio))
    half_c = where(np.abs(ratio) <= 1.0 + slack, clipped, np.nan)
    half_s = np.sqrt((1.0 - half_c) * (1.0 + half_c))
    return Closing(a / size, -b / size, half_c, half_s)


def assembly(m: Mechanism, h1: Heading, h2: Heading, h3: Heading, c: Any, s: Any) -> Assembly:
    """Return the position [m] for an orientation of the platform, by least squares of Eq. 16.

    ``c`` and ``s`` are cos and sin theta, the others the headings of the legs.
    """
    v1 = leg_vector(m, AXIS_X[0], AXIS_Y[0], 0.0, 0.0, c, s)
    v2 = leg_vector(m, AXIS_X[1], AXIS_Y[1], 0.0, 0.0, c, s)
    v3 = leg_vector(m, AXIS_X[2], AXIS_Y[2], 0.0, 0.0, c, s)
    right1 = h1.c * v1.dy - h1.s * v1.dx
    right2 = h2.c * v2.dy - h2.s * v2.dx
    right3 = h3.c * v3.dy - h3.s * v3.dx
    ss = h1.s * h1.s + h2.s * h2.s + h3.s * h3.s
    cc = h1.c * h1.c + h2.c * h2.c + h3.c * h3.c
    sc = h1.s * h1.c + h2.s * h2.c + h3.s * h3.c
    rs = h1.s * right1 + h2.s * right2 + h3.s * right3
    rc = h1.c * right1 + h2.c * right2 + h3.c * right3
    det = ss * cc - sc * sc
    x = (cc * rs - sc * rc) / det
    y = (sc * rs - ss * rc) / det
    along1 = h1.c * (x + v1.dx) + h1.s * (y + v1.dy)
    along2 = h2.c * (x + v2.dx) + h2.s * (y + v2.dy)
    along3 = h3.c * (x + v3.dx) + h3.s * (y + v3.dy)
    return Assembly(x, y, c, s, lesser(lesser(along1, along2), along3))


def assembly_mode(
    m: Mechanism, c1: Any, s1: Any, c2: Any, s2: Any, c3: Any, s3: Any, branch: Any
) -> Assembly:
    """Return one of the two poses for actuator positions, in closed form (Eq. 16) [m].

    There is none, and all is NaN, where the platform can move with locked actuators. It counts
    only if ``along`` is positive: then every leg points from its axis to the platform.

    Args:
        m: The mechanism.
        c1, s1, c2, s2, c3, s3: Cosine and sine of beta_k, theta_k plus the leg's `HEADING`.
        branch: +1 or -1, which solution of the quadratic.
    """
    h1 = plane_heading(AXIS_X[0], AXIS_Y[0], c1, s1)
    h2 = plane_heading(AXIS_X[1], AXIS_Y[1], c2, s2)
    h3 = plane_heading(AXIS_X[2], AXIS_Y[2], c3, s3)
    t = closing_angles(m, h1, h2, h3)
    half_s = branch * t.half_s
    return assembly(m, h1, h2, h3, t.c * t.half_c - t.s * half_s, t.s * t.half_c + t.c * half_s)


def platform_height(m: Mechanism, lift: Any) -> Any:
    """Return z of the platform for a position of M4, both [m] (Eq. 17)."""
    return m.k * (lift - m.shaft) - m.joint_height


def friction(viscous: Any, coulomb: Any, transition_speed: Any, speed: Any) -> Any:
    """Return the friction of an actuator at a speed [N m or N]; not in the paper.

    It is viscous speed + coulomb tanh(speed / transition_speed): a smooth step about rest.

    Args:
        viscous: [N m s/rad or N s/m].
        coulomb: [N m or N].
        transition_speed, speed: [rad/s or m/s].
    """
    return viscous * speed + coulomb * np.tanh(speed / transition_speed)
