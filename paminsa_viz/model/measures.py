"""How far a pose is from the robot's limits and from its singularities, as plain formulas.

The same source serves NumPy and the compiler; see `leg.py` for notation and conventions.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from paminsa_viz.model.leg import LegVector, Mechanism, leg_vector
from paminsa_viz.model.robot import (
    AXIS_X,
    AXIS_Y,
    lesser,
    platform_determinant,
    solve_wrench,
    where,
)

THIRD = 1.0 / 3.0
INVERSE_SQRT_6 = 0.408248290463863


class LegMargins(NamedTuple):
    """How far a leg is from each of its limits; negative: by how much it is exceeded [m]."""

    stretch: Any  # l_B4 + l_B8 - |85|
    fold: Any  # |85| - |l_B4 - l_B8|
    guide: Any  # stroke - |X_4|
    axis: Any  # X_1 - clearance


def leg_margins(
    m: Mechanism, ax: Any, ay: Any, x: Any, y: Any, c: Any, s: Any, z: Any
) -> LegMargins:
    """Return the margins of one leg [m]; not in the paper. Arguments as in `leg_position`.

    A margin to a singularity that may be one of rounding is zero.
    """
    v = leg_vector(m, ax, ay, x, y, c, s)
    rho = np.sqrt(v.rho2)
    zeta = z + m.joint_height
    reach2 = m.span_ratio * m.span_ratio * v.rho2 + zeta * zeta
    distance = np.sqrt(reach2)
    stretch = m.crank + m.coupler - distance
    fold = distance - np.abs(m.coupler - m.crank)
    axis = rho - m.clearance
    return LegMargins(
        where(reach2 >= m.reach2_max, lesser(stretch, 0.0), stretch),
        where(reach2 <= m.reach2_min, lesser(fold, 0.0), fold),
        m.stroke - m.guide_ratio * rho,
        where(v.rho2 <= m.rho2_min, lesser(axis, 0.0), axis),
    )


class LeastMargin(NamedTuple):
    """The smallest of several margins."""

    margin: Any  # [m]
    which: Any  # 4 * leg + limit, legs from 0, limits in the order of `LegMargins`


def least_margin(m: Mechanism, x: Any, y: Any, c: Any, s: Any, z: Any) -> LeastMargin:
    """Return the smallest margin of all legs and limits [m], and which one it is.

    It is not in the paper. The second value is 4 * leg + limit, legs from 0, limits in the order
    of `LegMargins`. Arguments are the platform's position [m], cos and sin theta.
    """
    a = leg_margins(m, AXIS_X[0], AXIS_Y[0], x, y, c, s, z)
    worst, which = _lesser_margin(a.stretch, 0.0, a.fold, 1.0)
    worst, which = _lesser_margin(worst, which, a.guide, 2.0)
    worst, which = _lesser_margin(worst, which, a.axis, 3.0)
    b = leg_margins(m, AXIS_X[1], AXIS_Y[1], x, y, c, s, z)
    worst, which = _lesser_margin(worst, which, b.stretch, 4.0)
    worst, which = _lesser_margin(worst, which, b.fold, 5.0)
    worst, which = _lesser_margin(worst, which, b.guide, 6.0)
    worst, which = _lesser_margin(worst, which, b.axis, 7.0)
    d = leg_margins(m, AXIS_X[2], AXIS_Y[2], x, y, c, s, z)
    worst, which = _lesser_margin(worst, which, d.stretch, 8.0)
    worst, which = _lesser_margin(worst, which, d.fold, 9.0)
    worst, which = _lesser_margin(worst, which, d.guide, 10.0)
    return _lesser_margin(worst, which, d.axis, 11.0)


def serial_margin(m: Mechanism, x: Any, y: Any, c: Any, s: Any, z: Any) -> tuple[Any]:
    """Return the smallest margin of all legs to a pantograph stretched, folded or on its axis [m].

    It is `least_margin` without the ends of the guides, which are no singularity.
    """
    a = _leg_serial_margin(leg_margins(m, AXIS_X[0], AXIS_Y[0], x, y, c, s, z))
    b = _leg_serial_margin(leg_margins(m, AXIS_X[1], AXIS_Y[1], x, y, c, s, z))
    d = _leg_serial_margin(leg_margins(m, AXIS_X[2], AXIS_Y[2], x, y, c, s, z))
    return (lesser(lesser(a, b), d),)


def _leg_serial_margin(leg: LegMargins) -> Any:
    """Return the smallest margin of a leg to a singularity [m]; NaN stays."""
    return lesser(lesser(leg.stretch, leg.fold), leg.axis)


def _lesser_margin(value: Any, tag: Any, other: Any, other_tag: Any) -> LeastMargin:
    """Return the lesser of two margins [m] and its tag; a first one that is NaN stays.

    A helper, not in the paper.
    """
    second = other < value
    return LeastMargin(where(second, other, value), where(second, other_tag, tag))


def _largest_eigenvalue(xx: Any, yy: Any, zz: Any, xy: Any, yz: Any, xz: Any) -> Any:
    """Return the largest eigenvalue of a symmetric 3x3 matrix, by the trigonometric formula.

    Units as of the matrix; not in the paper.
    """
    mean = (xx + yy + zz) * THIRD
    dx, dy, dz = xx - mean, yy - mean, zz - mean
    spread = (
        np.sqrt(dx * dx + dy * dy + dz * dz + 2.0 * (xy * xy + yz * yz + xz * xz)) * INVERSE_SQRT_6
    )
    det = dx * (dy * dz - yz * yz) - xy * (xy * dz - yz * xz) + xz * (xy * yz - dy * xz)
    cube = spread * spread * spread
    ratio = 0.5 * det / where(cube > 0.0, cube, 1.0)
    ratio = where(ratio > 1.0, 1.0, where(ratio < -1.0, -1.0, ratio))
    return mean + 2.0 * spread * np.cos(np.arccos(ratio) * THIRD)


def dexterity(m: Mechanism, x: Any, y: Any, c: Any, s: Any, z: Any) -> tuple[Any, Any]:
    """Return the determinant of the rows (w_k, p_k x w_k) [m], and the condition number of J [1].

    J is that of Eq. 3. The condition number is that of the 2-norm of the map from
    (x', y', R_pl theta') to (theta_1', theta_2', theta_3'): R_pl is the characteristic length.
    Neither depends on z, but both are NaN where the pose cannot be reached.
    """
    v1 = leg_vector(m, AXIS_X[0], AXIS_Y[0], x, y, c, s)
    v2 = leg_vector(m, AXIS_X[1], AXIS_Y[1], x, y, c, s)
    v3 = leg_vector(m, AXIS_X[2], AXIS_Y[2], x, y, c, s)
    det = platform_determinant(m, x, y, c)
    # rows of the inverse Jacobian over R_pl, and columns of its inverse
    i1, i2, i3 = 1.0 / v1.rho2, 1.0 / v2.rho2, 1.0 / v3.rho2
    l1, l2, l3 = (_lever(m, v1), _lever(m, v2), _lever(m, v3))
    forward = _largest_eigenvalue(
        i1 * i1 * v1.dy * v1.dy + i2 * i2 * v2.dy * v2.dy + i3 * i3 * v3.dy * v3.dy,
        i1 * i1 * v1.dx * v1.dx + i2 * i2 * v2.dx * v2.dx + i3 * i3 * v3.dx * v3.dx,
        i1 * i1 * l1 * l1 + i2 * i2 * l2 * l2 + i3 * i3 * l3 * l3,
        -(i1 * i1 * v1.dx * v1.dy + i2 * i2 * v2.dx * v2.dy + i3 * i3 * v3.dx * v3.dy),
        i1 * i1 * v1.dx * l1 + i2 * i2 * v2.dx * l2 + i3 * i3 * v3.dx * l3,
        -(i1 * i1 * v1.dy * l1 + i2 * i2 * v2.dy * l2 + i3 * i3 * v3.dy * l3),
    )
    jx = solve_wrench(det, v1, v2, v3, 1.0, 0.0, 0.0)
    jy = solve_wrench(det, v1, v2, v3, 0.0, 1.0, 0.0)
    jt = solve_wrench(det, v1, v2, v3, 0.0, 0.0, m.platform_radius)
    r1, r2, r3 = v1.rho2, v2.rho2, v3.rho2
    backward = _largest_eigenvalue(
        r1 * r1 * jx.t1 * jx.t1 + r2 * r2 * jx.t2 * jx.t2 + r3 * r3 * jx.t3 * jx.t3,
        r1 * r1 * jy.t1 * jy.t1 + r2 * r2 * jy.t2 * jy.t2 + r3 * r3 * jy.t3 * jy.t3,
        r1 * r1 * jt.t1 * jt.t1 + r2 * r2 * jt.t2 * jt.t2 + r3 * r3 * jt.t3 * jt.t3,
        r1 * r1 * jx.t1 * jy.t1 + r2 * r2 * jx.t2 * jy.t2 + r3 * r3 * jx.t3 * jy.t3,
        r1 * r1 * jy.t1 * jt.t1 + r2 * r2 * jy.t2 * jt.t2 + r3 * r3 * jy.t3 * jt.t3,
        r1 * r1 * jx.t1 * jt.t1 + r2 * r2 * jx.t2 * jt.t2 + r3 * r3 * jx.t3 * jt.t3,
    )
    condition = where(det == 0.0, np.inf, np.sqrt(forward * backward))
    worst, which = least_margin(m, x, y, c, s, z)
    # A guide may be used to its end; at the other limits the mechanism is singular.
    guide = (which == 2.0) | (which == 6.0) | (which == 10.0)
    reachable = (worst > 0.0) | ((worst == 0.0) & guide)
    return (
        where(reachable, det / np.sqrt(r1 * r2 * r3), np.nan),
        where(reachable, condition, np.nan),
    )


def _lever(m: Mechanism, v: LegVector) -> Any:
    """Return rho_k^2 d theta_k / d theta over the characteristic length R_pl [m] (Eq. 16)."""
    return (v.px * v.dx + v.py * v.dy) / m.platform_radius


class SingularDistances(NamedTuple):
    """Signed distances to the type-2 singularities, positive on the side of the robot's home."""

    position: Any  # from (x, y) to the singular circle at this theta, positive inside [m]
    rotation: Any  # turn to the nearest theta at which this (x, y) is singular [rad]


def singular_distances(m: Mechanism, x: Any, y: Any, c: Any, turn: Any) -> SingularDistances:
    """Return how far a pose is from the type-2 singularities; ``turn`` is |theta| [rad].

    They are where the derivatives of Eq. 16 by x, y, theta have no inverse; the closed form is not
    in the paper. Position in [m], c is cos theta.
    """
    rb, rp = m.base_radius, m.platform_radius
    locus = rb * rb + rp * rp - 2.0 * rb * rp * c
    radius2 = x * x + y * y
    position = np.sqrt(where(locus < 0.0, 0.0, locus)) - np.sqrt(radius2)
    everywhere = np.arccos(rp / rb) - turn
    on_circle = np.arccos((rb * rb + rp * rp - radius2) / (2.0 * rb * rp))
    circle = np.abs(turn - on_circle)
    # What does not exist is NaN, and infinitely far.
    first = where(everywhere == everywhere, np.abs(everywhere), np.inf)
    second = where(circle == circle, circle, np.inf)
    nearest = lesser(first, second)
    before = (everywhere >= 0.0) | (everywhere != everywhere)
    inside = before & (position >= 0.0)
    known = radius2 + turn == radius2 + turn
    return SingularDistances(position, where(known, where(inside, nearest, -nearest), np.nan))


def workspace_circle(m: Mechanism) -> Any:
    """Return the radius of the smallest circle about the origin that holds every position [m].

    At the best theta and height all three legs have X_1 <= r. The points 5 then lie within r of
    axes that are off the center by c = |R_b - R_pl|, at 120 degrees from each other.
    """
    bars = (m.crank + m.coupler) / m.span_ratio
    guide = m.stroke * (m.k - 1.0)
    longest = lesser(bars, guide)
    offset = np.abs(m.base_radius - m.platform_radius)
    inside = 4.0 * (longest * longest) - 3.0 * (offset * offset)
    return np.maximum(0.0, (np.sqrt(np.maximum(inside, 0.0)) - offset) / 2.0)
