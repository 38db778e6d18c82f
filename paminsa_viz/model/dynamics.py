"""Dynamics of the robot (Eqs. 9-21): torques for a motion, motion for torques, energies.

Lagrange's equations are set up in the paper's eight coordinates (x, y, theta, z, theta_1..3, Z);
the first four give the multipliers of the closure equations, the last four the actuator torques.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from paminsa_viz.errors import InvalidInput
from paminsa_viz.model import backend
from paminsa_viz.model.arrays import Array, aligned, as_vectors, together
from paminsa_viz.model.design import Design, Geometry
from paminsa_viz.model.jacobians import actuator_acceleration, inverse_jacobian
from paminsa_viz.model.kinematics import LEG_AXES, leg_states
from paminsa_viz.model.leg import leg_vector, mechanism
from paminsa_viz.model.leg_forces import LegForces, leg_forces
from paminsa_viz.model.load import NO_LOAD, generalized_force
from paminsa_viz.model.lumped import EnergyTerms, Misprint, energy_terms, lumped_coefficients
from paminsa_viz.model.parameters import ActuatorFriction, Friction
from paminsa_viz.model.reach import Limit, reach_status
from paminsa_viz.model.statics import load_torques


@dataclass(frozen=True)
class InverseDynamics:
    """Torques that make a motion; batch shape (...), NaN where there is none.

    Attributes:
        torque: (..., 4) torques of M1..M3 [N m] and force of M4 [N]; friction and the inertia of
            drives included.
        multipliers: (..., 4) Lagrange multipliers of s_1..s_4 (Eq. 15): forces on the platform
            across the legs, and along z in units of Z [N].
        status: (...) values of `Limit`; ``SINGULAR`` where a torque has no bound.
        leg: (...) index of the leg that is the reason, -1 for none.
    """

    torque: Array
    multipliers: Array
    status: NDArray[np.uint8]
    leg: NDArray[np.int8]


@dataclass(frozen=True)
class TorqueBreakdown:
    """The parts of an actuator torque, each (..., 4) [N m, N]; they add up to ``total``.

    Attributes:
        gravity: Of the weights, at rest.
        inertial: Of the accelerations.
        velocity: Of the squared speeds: centrifugal and Coriolis terms.
        friction: Of the friction at the actuators.
        load: Of the external load on the platform.
    """

    gravity: Array
    inertial: Array
    velocity: Array
    friction: Array
    load: Array

    @property
    def total(self) -> Array:
        """Sum of the parts, (..., 4) [N m, N]."""
        return self.gravity + self.inertial + self.velocity + self.friction + self.load


def _terms(design: Design, misprints: Misprint) -> EnergyTerms:
    terms = energy_terms(lumped_coefficients(design, misprints), misprints)
    return EnergyTerms(*map(float, terms))


@np.errstate(invalid="ignore")
def _finite_rows(values: Array) -> NDArray[np.bool_]:
    """Whether all of a row is finite; zero times anything else is NaN. As fast as one pass."""
    return np.einsum("ij,j->i", values, np.zeros(values.shape[1])) == 0.0


def inverse_dynamics(
    design: Design,
    pose: ArrayLike,
    velocity: ArrayLike,
    acceleration: ArrayLike,
    misprints: Misprint = Misprint.NONE,
    *,
    load: ArrayLike | None = None,
) -> InverseDynamics:
    """Return the actuator torques for a platform motion (Eqs. 15-21) under the design's load.

    Args:
        design: The robot.
        pose: (..., 4) [m, m, rad, m].
        velocity: (..., 4) [m/s, m/s, rad/s, m/s].
        acceleration: (..., 4) [m/s^2, m/s^2, rad/s^2, m/s^2].
        misprints: Formulas to take as published; none by default.
        load: (..., 6) a wrench on top of the design's load, see `load.center_wrench` [N, N m].

    Raises:
        InvalidInput: If shapes do not fit or values are not real. Poses out of reach raise
            nothing; they are NaN, with the reason in ``status``.
    """
    shape, (p, v, a) = together(pose=pose, velocity=velocity, acceleration=acceleration)
    m = mechanism(design.geometry)
    result = backend.inverse_dynamics_kernel(m, _terms(design, misprints), design.gravity, p, v, a)
    status, leg = reach_status(design.geometry, p)
    lost = np.flatnonzero((status == Limit.OK) & ~_finite_rows(result))
    moves = _finite_rows(v[lost]) & _finite_rows(a[lost])
    status[lost] = np.where(moves, np.uint8(Limit.SINGULAR), np.uint8(Limit.NOT_FINITE))
    result[status != Limit.OK] = np.nan
    torque, multipliers = result[:, :4], result[:, 4:]
    if design.load.acts or load is not None:
        against = load_torques(design.geometry, design.load, p, flat_load(load, shape))
        torque = torque + against
        against[:, :3] /= -_distances(design.geometry, p)
        multipliers = multipliers + against
    if any(design.drive_inertia):
        growth = actuator_acceleration(design.geometry, p, v, a)
        torque = torque + np.array(design.drive_inertia) * growth
    if not design.actuator_friction.zero:
        speed = actuator_velocity(design, p, v)
        torque = torque + friction_torque(design.actuator_friction, speed)
    return InverseDynamics(
        torque=torque.reshape(*shape, 4),
        multipliers=multipliers.reshape(*shape, 4),
        status=status.reshape(shape),
        leg=leg.reshape(shape),
    )


@np.errstate(all="ignore")
def platform_wrench(
    design: Design,
    pose: ArrayLike,
    velocity: ArrayLike,
    acceleration: ArrayLike,
    *,
    load: ArrayLike | None = None,
) -> Array:
    """Return F = M a + h + g - w, what the actuators have to make on the platform, (..., 4).

    The torques follow from F = G^T tau, G the inverse Jacobian. Unlike them it is finite at type-2
    singularities. The drives' inertia is part of it, the friction at the actuators is not.

    Args:
        design: The robot.
        pose: (..., 4) [m, m, rad, m].
        velocity: (..., 4) [m/s, m/s, rad/s, m/s].
        acceleration: (..., 4) [m/s^2, m/s^2, rad/s^2, m/s^2].
        load: (..., 6) a wrench on top of the design's load, see `load.center_wrench` [N, N m].

    Returns:
        In the coordinates x, y, theta, z [N, N, N m, N]; NaN where the bars cannot close.

    Raises:
        InvalidInput: If shapes do not fit or values are not real.
    """
    shape, (p, v, a) = together(pose=pose, velocity=velocity, acceleration=acceleration)
    e, geometry = _terms(design, Misprint.NONE), design.geometry
    g, q = leg_states(geometry, p, v, a)
    f = LegForces(*np.broadcast_arrays(*leg_forces(mechanism(geometry), e, g, q)))
    x = f.radial * g.ux - f.tangential * g.uy
    y = f.radial * g.uy + f.tangential * g.ux
    on_point = np.stack([x, y, g.px * y - g.py * x, f.vertical], axis=-1).sum(axis=1)
    actuators = np.concatenate([f.torque, f.lift.sum(axis=1, keepdims=True)], axis=1)
    if any(design.drive_inertia):
        growth = actuator_acceleration(geometry, p, v, a)
        actuators = actuators + np.array(design.drive_inertia) * growth
    on_actuators = np.einsum("nji,nj->ni", inverse_jacobian(geometry, p), actuators)
    masses = np.array([e.mass, e.mass, e.inertia + 6.0 * e.turn, e.mass])
    weight = np.array([0.0, 0.0, 0.0, e.mass * design.gravity])
    held = generalized_force(design.load, p[:, 2], flat_load(load, shape))
    return (on_point + on_actuators + masses * a + weight - held).reshape(*shape, 4)


def flat_load(load: ArrayLike | None, shape: tuple[int, ...]) -> Array | None:
    """Return a load (..., 6) for every state of a batch, (n, 6)."""
    if load is None:
        return None
    wrench = as_vectors(load, "load", 6)
    try:
        return np.broadcast_to(wrench, (*shape, 6)).reshape(-1, 6)
    except ValueError:
        raise InvalidInput("load", f"shape {wrench.shape} does not fit {(*shape, 6)}") from None


def _distances(geometry: Geometry, pose: Array) -> Array:
    """Return X_1, the distances of the joints 5 from their leg axes, (n, 3) [m]."""
    x, y, theta, _ = pose.T[..., None]
    axes = LEG_AXES.T
    v = leg_vector(mechanism(geometry), axes[0], axes[1], x, y, np.cos(theta), np.sin(theta))
    return np.sqrt(v.rho2)


def torque_breakdown(
    design: Design,
    pose: ArrayLike,
    velocity: ArrayLike,
    acceleration: ArrayLike,
    misprints: Misprint = Misprint.NONE,
    *,
    load: ArrayLike | None = None,
) -> TorqueBreakdown:
    """Split the torque of `inverse_dynamics`, with the same arguments, by its causes.

    Gravity is the torque at rest; the inertial part is what the acceleration adds in a world
    without gravity; the velocity part (centrifugal and Coriolis) what the velocity adds there.
    """
    shape, (p, v, a) = together(pose=pose, velocity=velocity, acceleration=acceleration)
    plain = replace(design.without_friction(), load=NO_LOAD)
    weightless = replace(plain, gravity=0.0)
    still = np.zeros_like(p)
    at_rest = inverse_dynamics(plain, p, still, still, misprints)
    inertial = inverse_dynamics(weightless, p, still, a, misprints)
    moving = inverse_dynamics(weightless, p, v, still, misprints)
    friction = np.zeros_like(p)
    if not design.actuator_friction.zero:
        speed = actuator_velocity(design, p, v)
        friction = friction_torque(design.actuator_friction, speed)
    against = np.zeros_like(p)
    if design.load.acts or load is not None:
        against = load_torques(design.geometry, design.load, p, flat_load(load, shape))
    return TorqueBreakdown(
        gravity=at_rest.torque.reshape(*shape, 4),
        inertial=inertial.torque.reshape(*shape, 4),
        velocity=moving.torque.reshape(*shape, 4),
        friction=friction.reshape(*shape, 4),
        load=against.reshape(*shape, 4),
    )


@np.errstate(all="ignore")
def actuator_velocity(design: Design, pose: ArrayLike, velocity: ArrayLike) -> Array:
    """Return the actuators' speeds for a platform velocity, (..., 4) [rad/s, m/s]."""
    p, v = aligned(pose=pose, velocity=velocity)
    return np.einsum("...ij,...j->...i", inverse_jacobian(design.geometry, p), v)


@np.errstate(all="ignore")
def friction_torque(friction: Friction | ActuatorFriction, speed: ArrayLike) -> Array:
    """Return what the actuators need against friction at their speeds (..., 4) [rad/s, m/s].

    `Design.actuator_friction` is that of joints and drives together.
    """
    speed = as_vectors(speed, "speed")
    if isinstance(friction, Friction):
        friction = friction.by_actuator
    viscous, coulomb = np.array(friction.viscous), np.array(friction.coulomb)
    return viscous * speed + coulomb * np.tanh(speed / friction.transition_speed)


def mass_matrix(
    design: Design,
    pose: ArrayLike,
    misprints: Misprint = Misprint.NONE,
) -> Array:
    """Return M with T = v.M v/2, v = (x', y', theta', z'), (..., 4, 4) [kg, kg m, kg m^2].

    Symmetric positive definite wherever the pose can be taken, type-2 singularities included. NaN
    where the bars cannot close. The drives add G^T diag(N^2 J) G.
    """
    pose = as_vectors(pose, "pose")
    m = mechanism(design.geometry)
    upper = backend.mass_matrix(m, _terms(design, misprints), pose.reshape(-1, 4))
    matrix = np.empty((len(upper), 4, 4))
    rows, columns = np.triu_indices(4)
    matrix[:, rows, columns] = upper
    matrix[:, columns, rows] = upper
    matrix = matrix.reshape(*pose.shape[:-1], 4, 4)
    if any(design.drive_inertia):
        g = inverse_jacobian(design.geometry, pose)
        matrix = matrix + np.einsum("...ki,k,...kj->...ij", g, np.array(design.drive_inertia), g)
    return matrix


@np.errstate(all="ignore")
def forward_dynamics(
    design: Design,
    pose: ArrayLike,
    velocity: ArrayLike,
    torque: ArrayLike,
    *,
    load: ArrayLike | None = None,
) -> Array:
    """Return the platform acceleration that actuator torques and the load cause, (..., 4).

    Args:
        design: The robot, friction and load included.
        pose: (..., 4) [m, m, rad, m].
        velocity: (..., 4) [m/s, m/s, rad/s, m/s].
        torque: (..., 4) [N m, N m, N m, N].
        load: (..., 6) a wrench on top of the design's load, see `load.center_wrench` [N, N m].

    Returns:
        [m/s^2, m/s^2, rad/s^2, m/s^2]; NaN where the pose cannot be taken.
    """
    shape, (p, v, q) = together(pose=pose, velocity=velocity, torque=torque)
    bias = inverse_dynamics(design, p, v, np.zeros_like(p), load=flat_load(load, shape)).torque
    g = inverse_jacobian(design.geometry, p)
    matrix = mass_matrix(design, p)
    force = np.einsum("nji,nj->ni", g, q - bias)
    good = np.isfinite(force).all(axis=-1) & np.isfinite(matrix).all(axis=(-1, -2))
    acceleration = np.full_like(p, np.nan)
    acceleration[good] = np.linalg.solve(matrix[good], force[good, :, None])[..., 0]
    return acceleration.reshape(*shape, 4)


@np.errstate(all="ignore")
def kinetic_energy(
    design: Design,
    pose: ArrayLike,
    velocity: ArrayLike,
    misprints: Misprint = Misprint.NONE,
) -> Array:
    """Return T, (...) [J], term by term as in Eqs. 12-14 with Appendix 3, and the drives' share."""
    shape, (p, v) = together(pose=pose, velocity=velocity)
    e = _terms(design, misprints)
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


@np.errstate(all="ignore")
def actuator_power(
    design: Design, pose: ArrayLike, velocity: ArrayLike, torque: ArrayLike
) -> Array:
    """Return the power of each actuator, Q_j q_j', (..., 4) [W]."""
    p, v, q = aligned(pose=pose, velocity=velocity, torque=torque)
    return q * actuator_velocity(design, p, v)
