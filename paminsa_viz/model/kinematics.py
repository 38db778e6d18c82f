"""Configurations from poses (Appendix 1) and poses from actuator positions, both in closed form."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from paminsa_viz.model.arrays import Array, aligned, as_vectors, together
from paminsa_viz.model.design import Geometry
from paminsa_viz.model.leg import (
    ROUNDING,
    LegMotion,
    LegPosition,
    leg_motion,
    leg_position,
    mechanism,
)
from paminsa_viz.model.leg_points import point_weights
from paminsa_viz.model.reach import Reach, check_reach
from paminsa_viz.model.robot import AXIS_X, AXIS_Y

LEG_AXES: Array = np.stack([AXIS_X, AXIS_Y], axis=-1)
"""Directions from the base center to the leg axes, (3, 2); e_k = R_b times this."""
LEG_AXES.setflags(write=False)

AXIS_ANGLES: Array = np.radians([210.0, -30.0, 90.0])
"""Directions of the leg axes seen from the base center, (3,) [rad]."""
AXIS_ANGLES.setflags(write=False)

HEADINGS: Array = np.radians([30.0, 150.0, 270.0])
"""beta_k at theta_k = 0, (3,) [rad] (Appendix 1)."""
HEADINGS.setflags(write=False)


def wrap(angle: ArrayLike) -> Array:
    """Return angles in (-pi, pi] [rad]."""
    angle = np.asarray(angle, dtype=np.float64)
    with np.errstate(invalid="ignore"):
        return np.pi - np.mod(np.pi - angle, 2 * np.pi)


@dataclass(frozen=True)
class Configuration:
    """The robot in poses of batch shape (...); what hangs on bars that cannot close is NaN.

    Attributes:
        geometry: The lengths it was solved for.
        pose: (..., 4) = (x, y, theta, z) [m, m, rad, m].
        reach: Whether each pose can be taken; check it before using numbers of a configuration.
        actuators: (..., 4) = (theta_1, theta_2, theta_3, Z) [rad, rad, rad, m].
        beta: (..., 3) headings of the leg planes, from the leg axis toward the platform [rad].
        psi: (..., 3) elevation of B4 and B7, seen from 9 to 5 [rad].
        phi: (..., 3) elevation of B8 and B3, seen from 8 to 9 [rad].
        points: By the paper's joint number (2, 3, 4, 5, 7, 8, 9), (..., 3 legs, 3) in the base
            frame [m].
    """

    geometry: Geometry
    pose: Array
    reach: Reach
    actuators: Array
    beta: Array
    psi: Array
    phi: Array
    points: Mapping[int, Array]


@np.errstate(all="ignore")
def _leg_positions(geometry: Geometry, pose: Array) -> LegPosition:
    """Solve all three legs; every field (..., 3)."""
    x, y, theta, z = np.moveaxis(pose, -1, 0)[..., None]
    return leg_position(
        mechanism(geometry), LEG_AXES[:, 0], LEG_AXES[:, 1],
        x, y, np.cos(theta), np.sin(theta), z,
    )  # fmt: skip


def inverse_kinematics(geometry: Geometry, pose: ArrayLike) -> Configuration:
    """Solve the inverse kinematics (Appendix 1).

    Args:
        geometry: Lengths of the mechanism.
        pose: (..., 4) = (x, y, theta, z) [m, m, rad, m], base frame.

    Raises:
        InvalidInput: If the pose has another shape or is not real.
    """
    pose = as_vectors(pose, "pose")
    g = _leg_positions(geometry, pose)
    beta = np.arctan2(g.uy, g.ux)
    points = {}
    with np.errstate(all="ignore"):
        psi = np.arctan2(g.sin_psi, g.cos_psi)
        phi = np.arctan2(g.sin_phi, g.cos_phi)
        for number, w in point_weights(geometry).items():
            r = w.r5 * g.rho + (w.r9 * g.r9 if w.r9 else 0.0)
            z = w.z5 * g.zeta + (w.r9 * g.z9 if w.r9 else 0.0) + w.z0
            points[number] = np.stack(
                np.broadcast_arrays(
                    geometry.base_radius * LEG_AXES[:, 0] + r * g.ux,
                    geometry.base_radius * LEG_AXES[:, 1] + r * g.uy,
                    z,
                ),
                axis=-1,
            )
    lift = (pose[..., 3:] + geometry.platform_joint_height) / geometry.magnification
    actuators = np.concatenate([wrap(beta - HEADINGS), lift + geometry.shaft_length], axis=-1)
    return Configuration(
        geometry, pose, check_reach(geometry, pose), actuators, beta, psi, phi, points
    )


@dataclass(frozen=True)
class JointMotion:
    """Velocities and accelerations of everything, batch shape (...).

    Attributes:
        configuration: The configuration it starts from.
        actuators_velocity, actuators_acceleration: (..., 4) [rad/s, m/s], [rad/s^2, m/s^2].
        psi_rate, phi_rate, psi_acceleration, phi_acceleration: (..., 3) [rad/s], [rad/s^2].
        velocity, acceleration: By the paper's joint number, (..., 3 legs, 3) [m/s], [m/s^2].
    """

    configuration: Configuration
    actuators_velocity: Array
    actuators_acceleration: Array
    psi_rate: Array
    phi_rate: Array
    psi_acceleration: Array
    phi_acceleration: Array
    velocity: Mapping[int, Array]
    acceleration: Mapping[int, Array]


def leg_states(
    geometry: Geometry, pose: Array, velocity: Array, acceleration: Array
) -> tuple[LegPosition, LegMotion]:
    """Return position and motion of all legs, every field (..., 3); inputs (..., 4)."""
    g = _leg_positions(geometry, pose)
    v = np.moveaxis(velocity, -1, 0)[..., None]
    a = np.moveaxis(acceleration, -1, 0)[..., None]
    with np.errstate(all="ignore"):
        return g, leg_motion(mechanism(geometry), g, *v, *a)


def joint_rates(
    geometry: Geometry, pose: ArrayLike, velocity: ArrayLike, acceleration: ArrayLike
) -> JointMotion:
    """Return velocities and accelerations of every joint for a platform motion.

    Args:
        geometry: Lengths of the mechanism.
        pose: (..., 4) [m, m, rad, m].
        velocity: (..., 4) [m/s, m/s, rad/s, m/s].
        acceleration: (..., 4) [m/s^2, m/s^2, rad/s^2, m/s^2].
    """
    shape, flat = together(pose=pose, velocity=velocity, acceleration=acceleration)
    p, v, a = (values.reshape(*shape, 4) for values in flat)
    g, q = leg_states(geometry, p, v, a)
    velocities, accelerations = {}, {}
    with np.errstate(all="ignore"):
        for number, w in point_weights(geometry).items():
            # The knee may be NaN, so it enters only where a joint hangs on it.
            r, r_rate, r_acc = w.r5 * g.rho, w.r5 * q.rho_rate, w.r5 * q.rho_acc
            z_rate, z_acc = w.z5 * q.zeta_rate, w.z5 * q.zeta_acc
            if w.r9:
                r, r_rate, r_acc = (
                    r + w.r9 * g.r9,
                    r_rate + w.r9 * q.r9_rate,
                    r_acc + w.r9 * q.r9_acc,
                )
                z_rate, z_acc = z_rate + w.r9 * q.z9_rate, z_acc + w.r9 * q.z9_acc
            velocities[number] = _in_base(g, r_rate, r * q.beta_rate, z_rate)
            accelerations[number] = _in_base(
                g, r_acc - r * q.beta_rate**2, r * q.beta_acc + 2 * r_rate * q.beta_rate, z_acc
            )
    k = geometry.magnification
    return JointMotion(
        inverse_kinematics(geometry, p),
        np.concatenate([q.beta_rate, v[..., 3:] / k], axis=-1),
        np.concatenate([q.beta_acc, a[..., 3:] / k], axis=-1),
        q.psi_rate, q.phi_rate, q.psi_acc, q.phi_acc,
        velocities, accelerations,
    )  # fmt: skip


def _in_base(g: LegPosition, radial: Array, tangential: Array, vertical: Array) -> Array:
    """Turn leg components into the base frame, (..., 3, 3)."""
    return np.stack(
        np.broadcast_arrays(
            radial * g.ux - tangential * g.uy, radial * g.uy + tangential * g.ux, vertical
        ),
        axis=-1,
    )


@dataclass(frozen=True)
class AssemblyModes:
    """Platform assemblies for actuator positions of batch shape (...): at most two.

    Attributes:
        pose: (..., 2, 4) candidate poses; NaN where there is none [m, m, rad, m].
        valid: (..., 2) whether the pose exists and every leg points from its axis to the platform.
    """

    pose: Array
    valid: NDArray[np.bool_]


@np.errstate(all="ignore")
def forward_kinematics(geometry: Geometry, actuators: ArrayLike) -> AssemblyModes:
    """Return all poses for given actuator positions, in closed form.

    The closure equations (Eq. 16) are linear in x, y, cos theta and sin theta; with
    cos^2 + sin^2 = 1 that is one quadratic. At cos theta = R_pl/R_b its roots are the same, and
    known to half of the digits, some 1e-8. There is no isolated pose, and NaN is returned, where
    the platform can move with locked actuators: where all leg lines are parallel, and on the
    singular circle, where they meet in one point and turn by -120 degrees from leg to leg. A
    pantograph limit is not looked at; see `reach`.

    Args:
        geometry: Lengths of the mechanism.
        actuators: (..., 4) = (theta_1, theta_2, theta_3, Z) [rad, rad, rad, m].
    """
    q = as_vectors(actuators, "actuators")
    beta = q[..., :3] + HEADINGS
    sin_b, cos_b = np.sin(beta), np.cos(beta)
    gamma = beta - AXIS_ANGLES
    # Weights with sum_k n_k (sin beta_k, cos beta_k) = 0 take x and y out of Eq. 16.
    following, last = np.roll(beta, -1, axis=-1), np.roll(beta, -2, axis=-1)
    n = np.sin(following - last)
    a = np.sum(n * np.sin(gamma), axis=-1)
    b = np.sum(n * np.cos(gamma), axis=-1)
    size = np.hypot(a, b)
    size = np.where(size > 1e-12, size, np.nan)
    ratio = geometry.base_radius / geometry.platform_radius * a / size
    # At a double root it is 1 in size, but for rounding.
    slack = 4 * ROUNDING * geometry.base_radius / geometry.platform_radius / size
    half = np.arccos(np.where(np.abs(ratio) <= 1 + slack, np.clip(ratio, -1, 1), np.nan))
    middle = np.arctan2(b, a)
    theta = wrap(np.stack([-middle + half, -middle - half], axis=-1))
    # s_k = sin b (x + p_x - e_x) - cos b (y + p_y - e_y) = 0 for all three legs, as least squares
    angle = theta[..., None] + AXIS_ANGLES
    px = geometry.platform_radius * np.cos(angle) - geometry.base_radius * LEG_AXES[:, 0]
    py = geometry.platform_radius * np.sin(angle) - geometry.base_radius * LEG_AXES[:, 1]
    sin_b, cos_b = sin_b[..., None, :], cos_b[..., None, :]
    right = cos_b * py - sin_b * px
    ss, cc, sc = (np.sum(v, axis=-1) for v in (sin_b**2, cos_b**2, sin_b * cos_b))
    rs, rc = np.sum(sin_b * right, axis=-1), np.sum(cos_b * right, axis=-1)
    det = ss * cc - sc**2
    x = (cc * rs - sc * rc) / det
    y = (sc * rs - ss * rc) / det
    z = geometry.magnification * (q[..., 3] - geometry.shaft_length)
    z = np.broadcast_to((z - geometry.platform_joint_height)[..., None], x.shape)
    pose = np.stack([x, y, theta, z], axis=-1)
    along = cos_b * (x[..., None] + px) + sin_b * (y[..., None] + py)
    valid = np.isfinite(pose).all(axis=-1) & (along > 0).all(axis=-1)
    return AssemblyModes(np.where(np.isfinite(x)[..., None], pose, np.nan), valid)


@np.errstate(all="ignore")
def nearest_solution(geometry: Geometry, actuators: ArrayLike, near: ArrayLike) -> Array:
    """Return the valid assembly mode that lies nearest to a given pose, (..., 4).

    Distance is taken in x, y and R_pl times theta. NaN where there is no valid one.
    """
    q, near = aligned(actuators=actuators, near=near)
    found = forward_kinematics(geometry, q)
    near = near[..., None, :]
    turn = geometry.platform_radius * wrap(found.pose[..., 2] - near[..., 2])
    distance = np.hypot(np.hypot(*np.moveaxis(found.pose - near, -1, 0)[:2]), turn)
    distance = np.where(found.valid, distance, np.inf)
    best = np.argmin(distance, axis=-1)[..., None, None]
    pose = np.take_along_axis(found.pose, best, axis=-2)[..., 0, :].copy()
    pose[..., 2] = near[..., 0, 2] + wrap(pose[..., 2] - near[..., 0, 2])
    return np.where(np.isfinite(distance.min(axis=-1))[..., None], pose, np.nan)
