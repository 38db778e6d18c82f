"""First-order kinematics: closure equations (Eqs. 16-17), their derivatives A_ij, the Jacobian."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.model.arguments import of_geometry
from paminsa_viz.model.arrays import Array, aligned, as_vectors
from paminsa_viz.model.design import Geometry
from paminsa_viz.model.kinematic_formulas import speed_row_rates, speed_rows, wrench_torques
from paminsa_viz.model.kinematics import HEADINGS, LEG_AXES
from paminsa_viz.model.leg import LegVector, leg_vector, mechanism


@np.errstate(all="ignore")
def leg_vectors(geometry: Geometry, pose: Array) -> LegVector:
    """Return the legs' horizontal vectors at poses (..., 4), every field (..., 3) [m]."""
    x, y, theta, _ = np.moveaxis(pose, -1, 0)[..., None]
    return leg_vector(
        mechanism(geometry), LEG_AXES[:, 0], LEG_AXES[:, 1], x, y, np.cos(theta), np.sin(theta)
    )


@of_geometry
@np.errstate(all="ignore")
def closure(geometry: Geometry, pose: ArrayLike, actuators: ArrayLike) -> Array:
    """Return s_1..s_4 of Eqs. 16 and 17, (..., 4) [m]; zero where pose and actuators agree.

    Args:
        geometry: Lengths of the mechanism.
        pose: (..., 4) [m, m, rad, m].
        actuators: (..., 4) [rad, rad, rad, m].

    Raises:
        InvalidInput: If a shape is another one, or a value is not real.
    """
    p, q = aligned(pose=pose, actuators=actuators)
    d = leg_vectors(geometry, p)
    beta = q[..., :3] + HEADINGS
    s = d.dx * np.sin(beta) - d.dy * np.cos(beta)
    lift = (p[..., 3] + geometry.platform_joint_height) / geometry.magnification
    return np.concatenate([s, (lift - q[..., 3] + geometry.shaft_length)[..., None]], axis=-1)


@of_geometry
@np.errstate(all="ignore")
def closure_matrix(geometry: Geometry, pose: ArrayLike, actuators: ArrayLike) -> Array:
    """Return A_ij, the derivatives of s_i by (x, y, theta, z, theta_1..3, Z), (..., 4, 8).

    These are the factors of the Lagrange multipliers in Eq. 15: [1] in the columns of lengths, [m]
    in those of angles. Arguments and what is raised as in `closure`.
    """
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


def _matrix(rows: tuple[Array, ...], lift: float, shape: tuple[int, ...]) -> Array:
    """Return matrices (..., 4, 4) from the 9 values of their part in x, y, theta and from z's."""
    matrix = np.zeros((*shape, 4, 4))
    for index, row in enumerate(rows):
        matrix[..., index // 3, index % 3] = row
    matrix[..., 3, 3] = lift
    return matrix


@of_geometry
@np.errstate(all="ignore")
def inverse_jacobian(geometry: Geometry, pose: ArrayLike) -> Array:
    """Return G with (theta_1', theta_2', theta_3', Z') = G (x', y', theta', z'), (..., 4, 4).

    Velocities are those of the platform's center in the base frame.

    Args:
        geometry: Lengths of the mechanism.
        pose: (..., 4) [m, m, rad, m].

    Returns:
        Rows of M1..M3 [1/m, 1/m, 1] for x, y and theta, and 0 for z; the last row is
        (0, 0, 0, 1/k). NaN or not finite where a joint 5 is on its leg axis. Limits of reach are
        not looked at.

    Raises:
        InvalidInput: If the pose has another shape or is not real.
    """
    x, y, theta, z = np.moveaxis(as_vectors(pose, "pose"), -1, 0)
    rows = speed_rows(mechanism(geometry), x, y, np.cos(theta), np.sin(theta), z)
    return _matrix(rows, 1 / geometry.magnification, x.shape)


@of_geometry
@np.errstate(all="ignore")
def jacobian(geometry: Geometry, pose: ArrayLike) -> Array:
    """Return J, the inverse of `inverse_jacobian`, (..., 4, 4); not finite where it is singular.

    Singular is what rounding cannot tell from it, see `singularity`.

    J is the general Jacobian of Eq. 3: (x', y', theta', z') = J (theta_1', .., Z'). Its columns of
    M1..M3 are [m, m, 1] for x, y and theta, and 0 for z; the last one is (0, 0, 0, k). Arguments
    and what is raised as in `inverse_jacobian`.
    """
    x, y, theta, z = np.moveaxis(as_vectors(pose, "pose"), -1, 0)
    rows = wrench_torques(mechanism(geometry), x, y, np.cos(theta), np.sin(theta), z)
    return _matrix(rows, geometry.magnification, x.shape)


@of_geometry
@np.errstate(all="ignore")
def inverse_jacobian_rate(geometry: Geometry, pose: ArrayLike, velocity: ArrayLike) -> Array:
    """Return dG/dt along a platform velocity, (..., 4, 4).

    The actuator acceleration is then G a + (dG/dt) v, for platform velocity v, acceleration a.

    Args:
        geometry: Lengths of the mechanism.
        pose: (..., 4) [m, m, rad, m].
        velocity: (..., 4) [m/s, m/s, rad/s, m/s].

    Returns:
        In the units of `inverse_jacobian` per second.

    Raises:
        InvalidInput: If a shape is another one, or a value is not real.
    """
    p, v = aligned(pose=pose, velocity=velocity)
    x, y, theta, _ = np.moveaxis(p, -1, 0)
    vx, vy, vt, _ = np.moveaxis(v, -1, 0)
    m = mechanism(geometry)
    rates = speed_row_rates(m, x, y, np.cos(theta), np.sin(theta), vx, vy, vt)
    return _matrix(rates, 0.0, x.shape)


@of_geometry
@np.errstate(all="ignore")
def actuator_velocity(geometry: Geometry, pose: ArrayLike, velocity: ArrayLike) -> Array:
    """Return the actuators' speeds for a platform velocity, (..., 4) [rad/s, m/s].

    Arguments and what is raised as in `inverse_jacobian_rate`.
    """
    p, v = aligned(pose=pose, velocity=velocity)
    return np.einsum("...ij,...j->...i", inverse_jacobian(geometry, p), v)


@of_geometry
@np.errstate(all="ignore")
def actuator_acceleration(
    geometry: Geometry, pose: ArrayLike, velocity: ArrayLike, acceleration: ArrayLike
) -> Array:
    """Return the actuators' accelerations, G a + (dG/dt) v, (..., 4) [rad/s^2, m/s^2].

    Args:
        geometry: Lengths of the mechanism.
        pose: (..., 4) [m, m, rad, m].
        velocity: v, (..., 4) [m/s, m/s, rad/s, m/s].
        acceleration: a, (..., 4) [m/s^2, m/s^2, rad/s^2, m/s^2].

    Raises:
        InvalidInput: If a shape is another one, or a value is not real.
    """
    p, v, a = aligned(pose=pose, velocity=velocity, acceleration=acceleration)
    g, rate = inverse_jacobian(geometry, p), inverse_jacobian_rate(geometry, p, v)
    return np.einsum("...ij,...j->...i", g, a) + np.einsum("...ij,...j->...i", rate, v)
