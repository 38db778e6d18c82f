"""One leg: its pantograph, its motion, and the forces of its energies on platform and actuators.

The functions here and in `robot.py` are the only place where the mechanics is stated. Each
is a plain formula of numbers, without branches, loops or memory: called with NumPy arrays it works
elementwise (also on complex numbers), and `compiled.py` compiles the same source into loops.

Leg plane: (r, z) with r from the leg axis toward the platform, unit vectors u (radial), w = z x u
(tangential). ``rho`` is the paper's X_1, ``zeta`` its Z_1 = z_5k, ``r9`` its H, ``z9`` its F.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from paminsa_viz.model.design import Geometry

ROUNDING = 2.0**-48
"""What rounding may change of a number, as a share of the numbers that it is the difference of.

It is 16 units of the last place.
"""

SINGULAR = 2.0**-40
"""Distance to a singularity that counts as zero, as a share of the lengths that it is the
difference of.

Torques go with its inverse, and of a moving robot at a limit of reach with its power -3/2. Within
256 times `ROUNDING` they would be of the rounding of the pose, in size and in their digits.
"""


class Mechanism(NamedTuple):
    """The lengths of a geometry in the form the formulas need [m]; ratios have no unit.

    Reciprocals [1/m] are here as well, since products are cheaper than quotients.
    """

    span_ratio: float  # k/(k-1): horizontal distance 8 to 5 over rho [1]
    guide_ratio: float  # 1/(k-1): |X_4| over rho [1]
    k: float  # magnification of the pantographs [1]
    inverse_k: float  # 1/k [1]
    base_radius: float
    platform_radius: float
    joint_height: float  # l_B5
    shaft: float  # l_B2
    crank: float  # l_B8
    coupler: float  # l_B4
    inverse_span_ratio: float  # [1]
    inverse_crank: float  # [1/m]
    inverse_coupler: float  # [1/m]
    root: float  # +1: published root of Appendix 1, -1: its mirror
    stroke: float  # largest |X_4|
    clearance: float  # least X_1
    rho2_min: float  # the last two as bounds of rho^2 [m^2]
    rho2_max: float  # [m^2]
    reach2_min: float  # (l_B4 - l_B8)^2, (l_B4 + l_B8)^2: bounds of |85|^2 less rounding [m^2]
    reach2_max: float  # [m^2]


def mechanism(geometry: Geometry) -> Mechanism:
    """Return the numbers of a geometry in the form the formulas need."""
    numbers = mechanism_of_lengths(
        geometry.magnification, geometry.base_radius, geometry.platform_radius,
        geometry.platform_joint_height, geometry.shaft_length,
        geometry.crank_length, geometry.coupler_length,
        geometry.stroke, geometry.axis_clearance, geometry.knee.sign,
    )  # fmt: skip
    return Mechanism(*map(float, numbers))


def mechanism_of_lengths(
    k: Any, base_radius: Any, platform_radius: Any, joint_height: Any, shaft: Any,
    crank: Any, coupler: Any, stroke: Any, clearance: Any, root: Any,
) -> Mechanism:  # fmt: skip
    """Return the numbers that the formulas need, from the lengths of Appendix 4.

    Args:
        k: Magnification of the pantographs, above 1.
        base_radius, platform_radius: R_b and R_pl [m].
        joint_height, shaft, crank, coupler: l_B5, l_B2, l_B3 = l_B8 and l_B4 [m].
        stroke: Largest |X_4| of joint 8 on its guide [m].
        clearance: Least distance X_1 of joint 5 from its leg axis [m].
        root: +1 for the published root of the knee, -1 for its mirror image.
    """
    span_ratio = k / (k - 1.0)
    blur = SINGULAR * (base_radius + platform_radius)
    reach_blur = SINGULAR * (crank + coupler) + span_ratio * blur
    rho_min = np.maximum(clearance, blur)
    rho_max = stroke * (k - 1.0)
    reach_min = np.abs(coupler - crank) + reach_blur
    reach_max = crank + coupler - reach_blur
    return Mechanism(
        span_ratio,
        1.0 / (k - 1.0),
        k,
        1.0 / k,
        base_radius,
        platform_radius,
        joint_height,
        shaft,
        crank,
        coupler,
        1.0 / span_ratio,
        1.0 / crank,
        1.0 / coupler,
        root,
        stroke,
        clearance,
        rho_min * rho_min,
        rho_max * rho_max,
        reach_min * reach_min,
        reach_max * reach_max,
    )


class Pantograph(NamedTuple):
    """Triangle 8-9-5: foot of 9 on the line 8-5, and the height over it, with derivatives.

    With W the horizontal distance and D the distance from 8 to 5: ``foot`` is the fraction of 8-5
    at the foot of 9, ``rise`` is W times the height of 9 over 8-5, divided by D. Derivatives are
    by rho^2 (suffix _s) and zeta (suffix _z). All of it is free of rho itself, so that the static
    torques need no square root for it.
    """

    foot: Any  # [1]
    rise: Any  # [m]
    foot_s: Any  # [1/m^2]
    rise_s: Any  # [1/m]
    foot_z: Any  # [1/m]
    rise_z: Any  # [1]


def pantograph(m: Mechanism, rho2: Any, zeta: Any) -> Pantograph:
    """Solve the triangle 8-9-5; NaN where the bars cannot close it (Appendix 1).

    This is the quadratic equation of F in Appendix 1, written with lengths of the triangle.

    Args:
        m: The mechanism.
        rho2: Square of X_1 [m^2].
        zeta: Height Z_1 of joint 5 [m].
    """
    ratio2 = m.span_ratio * m.span_ratio
    crank2 = m.crank * m.crank
    difference = 0.5 * (crank2 - m.coupler * m.coupler)
    w2 = ratio2 * rho2
    inverse = 1.0 / (w2 + zeta * zeta)  # 1/D^2
    foot = 0.5 + difference * inverse
    foot_d = -difference * inverse * inverse
    # rise^2 = W^2 h^2, where h D is the height of 9 over 8-5
    h2 = crank2 * inverse - foot * foot
    h2_d = (2.0 * foot * difference - crank2) * inverse * inverse
    rise = np.sqrt(h2 * w2)
    half = 0.5 / rise
    return Pantograph(
        foot,
        rise,
        foot_d * ratio2,
        (h2 + h2_d * w2) * ratio2 * half,
        2.0 * zeta * foot_d,
        2.0 * zeta * h2_d * w2 * half,
    )


def knee_height(m: Mechanism, p: Pantograph, zeta: Any) -> tuple[Any, Any, Any]:
    """Return z9 [m], its derivative by rho divided by rho [1/m], and that by zeta [1].

    z9 is F of Appendix 1; arguments as in `pantograph`.
    """
    z9 = p.foot * zeta - m.root * p.rise
    by_rho = 2.0 * (p.foot_s * zeta - m.root * p.rise_s)
    by_zeta = p.foot + p.foot_z * zeta - m.root * p.rise_z
    return z9, by_rho, by_zeta


def knee_radius(
    m: Mechanism, p: Pantograph, rho: Any, inverse_rho: Any, zeta: Any
) -> tuple[Any, Any, Any]:
    """Return r9 [m], its derivative by rho [1], and that by zeta [1]; r9 is H of Appendix 1.

    Arguments are X_1 = ``rho`` [m], its reciprocal [1/m], and as in `pantograph`.
    """
    inverse_w = inverse_rho * m.inverse_span_ratio
    w = m.span_ratio * rho
    height = p.rise * inverse_w
    r9 = w * (p.foot - m.inverse_k) + m.root * height * zeta
    rise_rho = 2.0 * rho * p.rise_s
    by_rho = (
        m.span_ratio * (p.foot - m.inverse_k)
        + w * 2.0 * rho * p.foot_s
        + m.root * zeta * (rise_rho * inverse_w - height * inverse_rho)
    )
    by_zeta = w * p.foot_z + m.root * (height + zeta * p.rise_z * inverse_w)
    return r9, by_rho, by_zeta


class LegVector(NamedTuple):
    """Horizontal vectors of a leg [m]: platform center to 5 (p), leg axis to 5 (d), and rho^2."""

    px: Any
    py: Any
    dx: Any
    dy: Any
    rho2: Any  # square of X_1 [m^2]


def leg_vector(m: Mechanism, ax: Any, ay: Any, x: Any, y: Any, c: Any, s: Any) -> LegVector:
    """Return the vectors [m] of the leg whose axis is at R_b (ax, ay) (P_5k, Appendix 1).

    Args:
        m: The mechanism.
        ax, ay: Direction from the base center to the leg axis, a unit vector.
        x, y: Platform position [m].
        c, s: cos theta, sin theta.
    """
    px = m.platform_radius * (ax * c - ay * s)
    py = m.platform_radius * (ay * c + ax * s)
    dx = x + (px - m.base_radius * ax)
    dy = y + (py - m.base_radius * ay)
    return LegVector(px, py, dx, dy, dx * dx + dy * dy)


class LegPosition(NamedTuple):
    """Position of a leg and the first derivatives of its knee [1] and its bars' angles [rad/m]."""

    px: Any  # platform center to joint 5 [m]
    py: Any
    ux: Any  # radial direction, (cos beta, sin beta)
    uy: Any
    rho: Any  # X_1 [m]
    inverse_rho: Any  # [1/m]
    zeta: Any  # Z_1 = z_5k [m]
    r9: Any  # H [m]
    z9: Any  # F [m]
    r9_rho: Any
    z9_rho: Any
    r9_zeta: Any
    z9_zeta: Any
    cos_psi: Any  # psi: elevation of B4, from 9 to 5
    sin_psi: Any
    cos_phi: Any  # phi: elevation of B8, from 8 to 9
    sin_phi: Any
    psi_rho: Any
    psi_zeta: Any
    phi_rho: Any
    phi_zeta: Any


def leg_position(
    m: Mechanism, ax: Any, ay: Any, x: Any, y: Any, c: Any, s: Any, z: Any
) -> LegPosition:
    """Return where a leg is [m] (Appendix 1).

    Arguments as in `leg_vector`, and z of the platform [m].
    """
    v = leg_vector(m, ax, ay, x, y, c, s)
    rho = np.sqrt(v.rho2)
    inverse_rho = 1.0 / rho
    zeta = z + m.joint_height
    p = pantograph(m, v.rho2, zeta)
    z9, z9_by, z9_zeta = knee_height(m, p, zeta)
    r9, r9_rho, r9_zeta = knee_radius(m, p, rho, inverse_rho, zeta)
    z9_rho = z9_by * rho
    cos_psi = (rho - r9) * m.inverse_coupler
    sin_psi = (zeta - z9) * m.inverse_coupler
    cos_phi = (r9 + m.guide_ratio * rho) * m.inverse_crank
    sin_phi = z9 * m.inverse_crank
    return LegPosition(
        v.px, v.py, v.dx * inverse_rho, v.dy * inverse_rho, rho, inverse_rho, zeta,
        r9, z9, r9_rho, z9_rho, r9_zeta, z9_zeta,
        cos_psi, sin_psi, cos_phi, sin_phi,
        (-cos_psi * z9_rho - sin_psi * (1.0 - r9_rho)) * m.inverse_coupler,
        (cos_psi * (1.0 - z9_zeta) + sin_psi * r9_zeta) * m.inverse_coupler,
        (cos_phi * z9_rho - sin_phi * (r9_rho + m.guide_ratio)) * m.inverse_crank,
        (cos_phi * z9_zeta - sin_phi * r9_zeta) * m.inverse_crank,
    )  # fmt: skip


class LegMotion(NamedTuple):
    """Velocities and accelerations of a leg in its own radial, tangential and vertical axes.

    Of lengths they are in [m/s] and [m/s^2], of angles in [rad/s] and [rad/s^2].
    """

    rho_rate: Any
    zeta_rate: Any
    beta_rate: Any  # theta_k'
    r9_rate: Any
    z9_rate: Any
    psi_rate: Any
    phi_rate: Any
    rho_acc: Any
    zeta_acc: Any
    beta_acc: Any
    r9_acc: Any
    z9_acc: Any
    psi_acc: Any
    phi_acc: Any
    a5r: Any  # acceleration of point 5
    a5t: Any
    a9r: Any  # acceleration of point 9
    a9t: Any


def leg_motion(
    m: Mechanism,
    g: LegPosition,
    vx: Any, vy: Any, vt: Any, vz: Any,
    ax: Any, ay: Any, at: Any, az: Any,
) -> LegMotion:  # fmt: skip
    """Return the motion of a leg for a platform velocity and acceleration.

    It is Appendix 1 derived twice by time. The second derivatives of the knee come from the two
    bar lengths: s.s'' + s'.s' = 0 for B8 (s = 9 - 8) and the same for B4 (t = 9 - 5).

    Args:
        m: The mechanism.
        g: Position of the leg.
        vx, vy, vt, vz: Platform velocity [m/s, m/s, rad/s, m/s].
        ax, ay, at, az: Platform acceleration [m/s^2, m/s^2, rad/s^2, m/s^2].
    """
    v5x = vx - vt * g.py
    v5y = vy + vt * g.px
    a5x = ax - at * g.py - vt * vt * g.px
    a5y = ay + at * g.px - vt * vt * g.py
    rho_rate = v5x * g.ux + v5y * g.uy
    beta_rate = (v5y * g.ux - v5x * g.uy) * g.inverse_rho
    a5r = a5x * g.ux + a5y * g.uy
    a5t = a5y * g.ux - a5x * g.uy
    rho_acc = a5r + g.rho * beta_rate * beta_rate
    beta_acc = (a5t - 2.0 * rho_rate * beta_rate) * g.inverse_rho
    r9_rate = g.r9_rho * rho_rate + g.r9_zeta * vz
    z9_rate = g.z9_rho * rho_rate + g.z9_zeta * vz

    sr, sz = m.crank * g.cos_phi, m.crank * g.sin_phi
    tr, tz = -m.coupler * g.cos_psi, -m.coupler * g.sin_psi
    sr_rate = r9_rate + m.guide_ratio * rho_rate
    tr_rate = r9_rate - rho_rate
    tz_rate = z9_rate - vz
    s_rate2 = sr_rate * sr_rate + z9_rate * z9_rate
    t_rate2 = tr_rate * tr_rate + tz_rate * tz_rate
    inverse = 1.0 / (sr * tz - sz * tr)
    r9_acc = g.r9_rho * rho_acc + g.r9_zeta * az + (sz * t_rate2 - tz * s_rate2) * inverse
    z9_acc = g.z9_rho * rho_acc + g.z9_zeta * az + (tr * s_rate2 - sr * t_rate2) * inverse

    psi_rate = g.psi_rho * rho_rate + g.psi_zeta * vz
    phi_rate = g.phi_rho * rho_rate + g.phi_zeta * vz
    psi_acc = (g.cos_psi * (az - z9_acc) - g.sin_psi * (rho_acc - r9_acc)) * m.inverse_coupler
    phi_acc = (
        g.cos_phi * z9_acc - g.sin_phi * (r9_acc + m.guide_ratio * rho_acc)
    ) * m.inverse_crank
    return LegMotion(
        rho_rate, vz, beta_rate, r9_rate, z9_rate, psi_rate, phi_rate,
        rho_acc, az, beta_acc, r9_acc, z9_acc, psi_acc, phi_acc,
        a5r, a5t,
        r9_acc - g.r9 * beta_rate * beta_rate,
        g.r9 * beta_acc + 2.0 * r9_rate * beta_rate,
    )  # fmt: skip
