"""Configurations from poses (Appendix 1) and poses from actuator positions, both in closed form."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from paminsa_viz.model.arguments import of_geometry
from paminsa_viz.model.arrays import Array, aligned, as_vectors, own_vectors, together
from paminsa_viz.model.design import Geometry
from paminsa_viz.model.kinematic_formulas import (
    HEADING,
    assembly_mode,
    leg_angles,
    lift_position,
    platform_height,
    wrap_angle,
)
from paminsa_viz.model.leg import (
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

HEADINGS: Array = np.array(HEADING)
"""beta_k at theta_k = 0, (3,) [rad] (Appendix 1)."""
HEADINGS.setflags(write=False)


def wrap(angle: ArrayLike) -> Array:
    """Return angles in (-pi, pi] [rad]."""
    with np.errstate(invalid="ignore"):
        return wrap_angle(np.asarray(angle, dtype=np.float64))


@dataclass(frozen=True, eq=False)
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


@of_geometry
def inverse_kinematics(geometry: Geometry, pose: ArrayLike) -> Configuration:
    """Solve the inverse kinematics (Appendix 1).

    Args:
        geometry: Lengths of the mechanism.
        pose: (..., 4) = (x, y, theta, z) [m, m, rad, m], base frame.

    Raises:
        InvalidInput: If the pose has another shape or is not real.
    """
    pose = own_vectors(pose, "pose")
    g = _leg_positions(geometry, pose)
    points = {}
    with np.errstate(all="ignore"):
        angles = leg_angles(g, HEADINGS)
        for number, w in point_weights(geometry).items():
            r, z = w.of(g)
            points[number] = np.stack(
                np.broadcast_arrays(
                    geometry.base_radius * LEG_AXES[:, 0] + r * g.ux,
                    geometry.base_radius * LEG_AXES[:, 1] + r * g.uy,
                    z,
                ),
                axis=-1,
            )
    lift = lift_position(mechanism(geometry), pose[..., 3:])
    return Configuration(
        geometry, pose, check_reach(geometry, pose),
        np.concatenate([angles.theta, lift], axis=-1), angles.beta, angles.psi, angles.phi, points,
    )  # fmt: skip


@dataclass(frozen=True, eq=False)
class JointMotion:
    """Velocities and accelerations of everything, batch shape (...).

    Attributes:
        configuration: The configuration it starts from.
        actuators_velocity, actuators_acceleration: (..., 4) [rad/s, m/s], [rad/s^2, m/s^2].
        psi_rate, phi_rate: (..., 3) [rad/s].
        psi_acceleration, phi_acceleration: (..., 3) [rad/s^2].
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


@of_geometry
def joint_rates(
    geometry: Geometry, pose: ArrayLike, velocity: ArrayLike, acceleration: ArrayLike
) -> JointMotion:
    """Return velocities and accelerations of every joint for a platform motion.

    Args:
        geometry: Lengths of the mechanism.
        pose: (..., 4) [m, m, rad, m].
        velocity: (..., 4) [m/s, m/s, rad/s, m/s].
        acceleration: (..., 4) [m/s^2, m/s^2, rad/s^2, m/s^2].

    Raises:
        InvalidInput: If a shape is another one, or a value is not real.
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


@dataclass(frozen=True, eq=False)
class AssemblyModes:
    """Platform assemblies for actuator positions of batch shape (...): at most two.

    Attributes:
        pose: (..., 2, 4) candidate poses; NaN where there is none [m, m, rad, m].
        ok: (..., 2) whether the pose exists and every leg points from its axis to the platform.
    """

    pose: Array
    ok: NDArray[np.bool_]


@of_geometry
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

    Raises:
        InvalidInput: If a shape is another one, or a value is not real.
    """
    q = as_vectors(actuators, "actuators")
    beta = np.moveaxis(q[..., :3] + HEADINGS, -1, 0)[..., None]
    (c1, c2, c3), (s1, s2, s3) = np.cos(beta), np.sin(beta)
    m = mechanism(geometry)
    found = assembly_mode(m, c1, s1, c2, s2, c3, s3, _BRANCHES)
    z = np.broadcast_to(platform_height(m, q[..., 3])[..., None], found.x.shape)
    pose = np.stack([found.x, found.y, wrap(np.arctan2(found.s, found.c)), z], axis=-1)
    valid = np.isfinite(pose).all(axis=-1) & (found.along > 0)
    return AssemblyModes(np.where(np.isfinite(found.x)[..., None], pose, np.nan), valid)


_BRANCHES = np.array([1.0, -1.0])
"""Both solutions, in the order of `AssemblyModes`."""


@of_geometry
@np.errstate(all="ignore")
def nearest_solution(geometry: Geometry, actuators: ArrayLike, near: ArrayLike) -> Array:
    """Return the valid assembly mode that lies nearest to a given pose, (..., 4).

    Distance is taken in x, y and R_pl times theta, which is within half a turn of the given one.

    Args:
        geometry: Lengths of the mechanism.
        actuators: (..., 4) = (theta_1, theta_2, theta_3, Z) [rad, rad, rad, m].
        near: The given pose, (..., 4) [m, m, rad, m].

    Returns:
        (x, y, theta, z) [m, m, rad, m]; NaN where there is no valid one.

    Raises:
        InvalidInput: If a shape is another one, or a value is not real.
    """
    q, near = aligned(actuators=actuators, near=near)
    found = forward_kinematics(geometry, q)
    near = near[..., None, :]
    turn = geometry.platform_radius * wrap(found.pose[..., 2] - near[..., 2])
    distance = np.hypot(np.hypot(*np.moveaxis(found.pose - near, -1, 0)[:2]), turn)
    distance = np.where(found.ok, distance, np.inf)
    best = np.argmin(distance, axis=-1)[..., None, None]
    pose = np.take_along_axis(found.pose, best, axis=-2)[..., 0, :].copy()
    pose[..., 2] = near[..., 0, 2] + wrap(pose[..., 2] - near[..., 0, 2])
    return np.where(np.isfinite(distance.min(axis=-1))[..., None], pose, np.nan)
