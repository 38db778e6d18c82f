"""First-order kinematics: closure equations (Eqs. 16-17), their derivatives A_ij, the Jacobian."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.model.arrays import Array, aligned, as_vectors, together
from paminsa_viz.model.design import Design, Geometry
from paminsa_viz.model.kinematics import HEADINGS, LEG_AXES
from paminsa_viz.model.leg import LegVector, leg_vector, mechanism
from paminsa_viz.model.robot import platform_determinant


@np.errstate(all="ignore")
def leg_vectors(geometry: Geometry, pose: Array) -> LegVector:
    """Return the legs' horizontal vectors at poses (..., 4), every field (..., 3) [m]."""
    x, y, theta, _ = np.moveaxis(pose, -1, 0)[..., None]
    return leg_vector(
        mechanism(geometry), LEG_AXES[:, 0], LEG_AXES[:, 1], x, y, np.cos(theta), np.sin(theta)
    )


@np.errstate(all="ignore")
def closure(geometry: Geometry, pose: ArrayLike, actuators: ArrayLike) -> Array:
    """Return s_1..s_4 of Eqs. 16 and 17, (..., 4) [m]; zero where pose and actuators agree.

    Args:
        geometry: Lengths of the mechanism.
        pose: (..., 4) [m, m, rad, m].
        actuators: (..., 4) [rad, rad, rad, m].
    """
    p, q = aligned(pose=pose, actuators=actuators)
    d = leg_vectors(geometry, p)
    beta = q[..., :3] + HEADINGS
    s = d.dx * np.sin(beta) - d.dy * np.cos(beta)
    lift = (p[..., 3] + geometry.platform_joint_height) / geometry.magnification
    return np.concatenate([s, (lift - q[..., 3] + geometry.shaft_length)[..., None]], axis=-1)


@np.errstate(all="ignore")
def closure_matrix(geometry: Geometry, pose: ArrayLike, actuators: ArrayLike) -> Array:
    """Return A_ij, the derivatives of s_i by (x, y, theta, z, theta_1..3, Z), (..., 4, 8)."""
    p, q = aligned(pose=pose, actuators=actuators)
    d = leg_vectors(geometry, p)
    beta = q[..., :3] + HEADINGS
    sin_b, cos_b = np.sin(beta), np.cos(beta)
    a = np.zeros((*p.shape[:-1], 4, 8))
    a[..., :3, 0] = sin_b
    a[..., :3, 1] = -cos_b
    a[..., :3, 2] = -d.py * sin_b - d.px * cos_b
    for leg in range(3):
        a[..., leg, 4 + leg] = (d.dx * cos_b + d.dy * sin_b)[..., leg]
    a[..., 3, 3] = 1 / geometry.magnification
    a[..., 3, 7] = -1.0
    return a


@np.errstate(all="ignore")
def inverse_jacobian(geometry: Geometry, pose: ArrayLike) -> Array:
    """Return G with (theta_1', theta_2', theta_3', Z') = G (x', y', theta', z'), (..., 4, 4)."""
    pose = as_vectors(pose, "pose")
    d = leg_vectors(geometry, pose)
    g = np.zeros((*pose.shape[:-1], 4, 4))
    g[..., :3, 0] = -d.dy / d.rho2
    g[..., :3, 1] = d.dx / d.rho2
    g[..., :3, 2] = (d.px * d.dx + d.py * d.dy) / d.rho2
    g[..., 3, 3] = 1 / geometry.magnification
    return g


@np.errstate(all="ignore")
def jacobian(geometry: Geometry, pose: ArrayLike) -> Array:
    """Return J, the inverse of `inverse_jacobian`, (..., 4, 4); not finite where it is singular.

    Singular is what rounding cannot tell from it, see `singularity`.

    J is the general Jacobian of Eqs. 2 and 3: (x', y', theta', z') = J (theta_1', .., Z').
    """
    g = inverse_jacobian(geometry, pose)
    columns = g[..., :3, :3]
    a, b, c = columns[..., 0, :], columns[..., 1, :], columns[..., 2, :]
    cofactors = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=-1)
    x, y, theta, _ = np.moveaxis(as_vectors(pose, "pose"), -1, 0)
    singular = platform_determinant(mechanism(geometry), x, y, np.cos(theta)) == 0.0
    det = np.where(singular, 0.0, np.sum(a * cofactors[..., 0], axis=-1))[..., None, None]
    j = np.zeros_like(g)
    j[..., :3, :3] = cofactors / det
    j[..., 3, 3] = geometry.magnification
    return j


@np.errstate(all="ignore")
def inverse_jacobian_rate(geometry: Geometry, pose: ArrayLike, velocity: ArrayLike) -> Array:
    """Return dG/dt along a platform velocity, (..., 4, 4).

    The actuator acceleration is then G a + (dG/dt) v, for platform velocity v, acceleration a.
    """
    shape, (p, v) = together(pose=pose, velocity=velocity)
    d = leg_vectors(geometry, p)
    vx, vy, turn = v[:, 0:1], v[:, 1:2], v[:, 2:3]
    px_rate, py_rate = -turn * d.py, turn * d.px
    dx_rate, dy_rate = vx + px_rate, vy + py_rate
    rho2_rate = 2 * (d.dx * dx_rate + d.dy * dy_rate)
    moment = d.px * d.dx + d.py * d.dy
    moment_rate = px_rate * d.dx + py_rate * d.dy + d.px * dx_rate + d.py * dy_rate
    rate = np.zeros((len(p), 4, 4))
    rate[:, :3, 0] = (-dy_rate + d.dy * rho2_rate / d.rho2) / d.rho2
    rate[:, :3, 1] = (dx_rate - d.dx * rho2_rate / d.rho2) / d.rho2
    rate[:, :3, 2] = (moment_rate - moment * rho2_rate / d.rho2) / d.rho2
    return rate.reshape(*shape, 4, 4)


@np.errstate(all="ignore")
def actuator_velocity(design: Design, pose: ArrayLike, velocity: ArrayLike) -> Array:
    """Return the actuators' speeds for a platform velocity, (..., 4) [rad/s, m/s]."""
    p, v = aligned(pose=pose, velocity=velocity)
    return np.einsum("...ij,...j->...i", inverse_jacobian(design.geometry, p), v)


@np.errstate(all="ignore")
def actuator_acceleration(
    geometry: Geometry, pose: ArrayLike, velocity: ArrayLike, acceleration: ArrayLike
) -> Array:
    """Return the actuators' accelerations, G a + (dG/dt) v, (..., 4) [rad/s^2, m/s^2]."""
    p, v, a = aligned(pose=pose, velocity=velocity, acceleration=acceleration)
    g, rate = inverse_jacobian(geometry, p), inverse_jacobian_rate(geometry, p, v)
    return np.einsum("...ij,...j->...i", g, a) + np.einsum("...ij,...j->...i", rate, v)
