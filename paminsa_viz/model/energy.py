"""Energies of the robot (Eqs. 11-14) and the power of its actuators."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array, aligned, together
from paminsa_viz.model.design import Design
from paminsa_viz.model.jacobians import actuator_velocity
from paminsa_viz.model.kinematics import inverse_kinematics, leg_states
from paminsa_viz.model.lumped import Misprint, lumped_coefficients, potential_constant, term_factors


@of_design
def potential_energy(design: Design, pose: ArrayLike) -> Array:
    """Return V, (...) [J] (Eq. 11): zero height is the plane of the guides.

    As in the paper the joints 8 and the guide links, which never change height, do not count, and
    the platform's mass center is at height z, a payload's at z + h_load. A load is no part of it:
    one that turns with the platform has no potential.

    Args:
        design: The robot.
        pose: (..., 4) [m, m, rad, m].

    Returns:
        NaN where the bars cannot close. Limits of reach are not looked at otherwise.

    Raises:
        InvalidInput: If the pose has another shape or is not real.
    """
    configuration = inverse_kinematics(design.geometry, pose)
    c = lumped_coefficients(design)
    z5, z9 = configuration.points[5][..., 2], configuration.points[9][..., 2]
    legs = (
        c[0] * z5 + c[1] * z9 + c[2] * configuration.actuators[..., 3:] + potential_constant(design)
    )
    payload = design.payload
    rest = c[16] * configuration.pose[..., 3] + payload.mass * payload.height
    return design.gravity * rest + legs.sum(axis=-1)


@of_design
@np.errstate(all="ignore")
def kinetic_energy(
    design: Design, pose: ArrayLike, velocity: ArrayLike, misprints: Misprint = Misprint.NONE
) -> Array:
    """Return T, (...) [J], term by term as in Eqs. 12-14 with Appendix 3, and the drives' share.

    Args:
        design: The robot.
        pose: (..., 4) [m, m, rad, m].
        velocity: (..., 4) [m/s, m/s, rad/s, m/s].
        misprints: Formulas to take as published; none by default.

    Returns:
        NaN where the bars cannot close. Limits of reach are not looked at otherwise.

    Raises:
        InvalidInput: If a shape is another one, or a value is not real.
    """
    shape, (p, v) = together(pose=pose, velocity=velocity)
    e = term_factors(design, misprints)
    g, q = leg_states(design.geometry, p, v, np.zeros_like(p))
    lift = v[:, 3:] / design.geometry.magnification
    translation = (
        e.xy5 * (q.rho_rate**2 + (g.rho * q.beta_rate) ** 2)
        + e.z5 * q.zeta_rate**2
        + e.p9 * (q.r9_rate**2 + (g.r9 * q.beta_rate) ** 2 + q.z9_rate**2)
        + e.xy59 * (q.rho_rate * q.r9_rate + g.rho * g.r9 * q.beta_rate**2)
        + e.z59 * q.zeta_rate * q.z9_rate
        + e.lift * lift**2
        + e.z5_lift * q.zeta_rate * lift
        + e.lift_linear * lift
        + e.turn * v[:, 2:3] ** 2
    )
    rotation = (
        e.psi * q.psi_rate**2
        + e.phi * q.phi_rate**2
        + q.beta_rate**2
        * (
            e.spin
            + e.spin_sin_psi * g.sin_psi**2
            + e.spin_cos_psi * g.cos_psi**2
            + e.spin_sin_phi * g.sin_phi**2
            + e.spin_cos_phi * g.cos_phi**2
        )
    )
    platform = e.mass * (v[:, 0] ** 2 + v[:, 1] ** 2 + v[:, 3] ** 2) + e.inertia * v[:, 2] ** 2
    total = 0.5 * platform + (translation + rotation).sum(axis=-1)
    if any(design.drive_inertia):
        total = total + 0.5 * actuator_velocity(design, p, v) ** 2 @ np.array(design.drive_inertia)
    return total.reshape(shape)


@of_design
@np.errstate(all="ignore")
def actuator_power(
    design: Design, pose: ArrayLike, velocity: ArrayLike, torque: ArrayLike
) -> Array:
    """Return the power of each actuator, Q_j q_j', (..., 4) [W].

    It is positive where the actuator drives.

    Args:
        design: The robot.
        pose: (..., 4) [m, m, rad, m].
        velocity: Of the platform, (..., 4) [m/s, m/s, rad/s, m/s].
        torque: Q, (..., 4) [N m, N m, N m, N].

    Raises:
        InvalidInput: If a shape is another one, or a value is not real.
    """
    p, v, q = aligned(pose=pose, velocity=velocity, torque=torque)
    return q * actuator_velocity(design, p, v)
