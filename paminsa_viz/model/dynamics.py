"""Dynamics of the robot (Eqs. 9-21): torques for a motion, motion for torques.

Lagrange's equations are set up in the paper's eight coordinates (x, y, theta, z, theta_1..3, Z);
the first four give the multipliers of the closure equations, the last four the actuator torques.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from paminsa_viz.checks import require_kind
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model import backend
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array, as_vectors, together
from paminsa_viz.model.design import Design
from paminsa_viz.model.jacobians import (
    actuator_acceleration,
    actuator_velocity,
    inverse_jacobian,
    leg_vectors,
)
from paminsa_viz.model.kinematic_formulas import friction as friction_formula
from paminsa_viz.model.kinematics import leg_states
from paminsa_viz.model.leg import mechanism
from paminsa_viz.model.leg_forces import LegForces, leg_forces
from paminsa_viz.model.load import NO_LOAD, flat_load, generalized_force
from paminsa_viz.model.lumped import Misprint, term_factors
from paminsa_viz.model.parameters import ActuatorFriction, Friction
from paminsa_viz.model.reach import Limit, OfLimits, reach_status
from paminsa_viz.model.robot import acceleration_of_force
from paminsa_viz.model.statics import load_torques


@dataclass(frozen=True, eq=False)
class InverseDynamics(OfLimits):
    """Torques that make a motion; batch shape (...), NaN where there is none.

    Attributes:
        torque: (..., 4) torques of M1..M3 [N m] and force of M4 [N]; friction and the inertia of
            drives included.
        multipliers: (..., 4) Lagrange multipliers lambda_i of s_1..s_4 (Eq. 15) [N]. As generalized
            forces in (x, y, theta, z) they are sum_i lambda_i A_ij, see `closure_matrix`: the
            first three act across the legs, the fourth along z by lambda_4/k.
        status: (...) values of `Limit`; ``SINGULAR`` where a torque has no bound.
        leg: (...) index of the leg that is the reason, -1 for none.
    """

    torque: Array
    multipliers: Array
    status: NDArray[np.uint8]
    leg: NDArray[np.int8]


@dataclass(frozen=True, eq=False)
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


@np.errstate(invalid="ignore")
def _finite_rows(values: Array) -> NDArray[np.bool_]:
    """Whether all of a row is finite; zero times anything else is NaN. As fast as one pass."""
    return np.einsum("ij,j->i", values, np.zeros(values.shape[1])) == 0.0


@of_design
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
    result = backend.inverse_dynamics_kernel(
        m, term_factors(design, misprints), design.gravity, p, v, a
    )
    status, leg = reach_status(design.geometry, p)
    lost = np.flatnonzero((status == Limit.OK) & ~_finite_rows(result))
    moves = _finite_rows(v[lost]) & _finite_rows(a[lost])
    status[lost] = np.where(moves, np.uint8(Limit.SINGULAR), np.uint8(Limit.NOT_FINITE))
    result[status != Limit.OK] = np.nan
    torque, multipliers = result[:, :4], result[:, 4:]
    if design.load.acts or load is not None:
        against = load_torques(design.geometry, design.load, p, flat_load(load, shape))
        torque = torque + against
        against[:, :3] /= -np.sqrt(leg_vectors(design.geometry, p).rho2)
        multipliers = multipliers + against
    torque = _with_drives(design, torque, p, v, a)
    if not design.actuator_friction.zero:
        torque = torque + _friction(design, p, v)
    return InverseDynamics(
        torque=torque.reshape(*shape, 4),
        multipliers=multipliers.reshape(*shape, 4),
        status=status.reshape(shape),
        leg=leg.reshape(shape),
    )


@np.errstate(all="ignore")
def _with_drives(design: Design, torque: Array, p: Array, v: Array, a: Array) -> Array:
    """Return torques with those that accelerate the drives' own inertia."""
    if not any(design.drive_inertia):
        return torque
    growth = actuator_acceleration(design.geometry, p, v, a)
    return torque + np.array(design.drive_inertia) * growth


def _friction(design: Design, p: Array, v: Array) -> Array:
    return friction_torque(design.actuator_friction, actuator_velocity(design, p, v))


@of_design
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
    Arguments as in `inverse_dynamics`.

    Returns:
        In the coordinates x, y, theta, z [N, N, N m, N]; NaN where the bars cannot close.

    Raises:
        InvalidInput: If shapes do not fit or values are not real.
    """
    shape, (p, v, a) = together(pose=pose, velocity=velocity, acceleration=acceleration)
    e, geometry = term_factors(design, Misprint.NONE), design.geometry
    g, q = leg_states(geometry, p, v, a)
    f = LegForces(*np.broadcast_arrays(*leg_forces(mechanism(geometry), e, g, q)))
    x = f.radial * g.ux - f.tangential * g.uy
    y = f.radial * g.uy + f.tangential * g.ux
    on_point = np.stack([x, y, g.px * y - g.py * x, f.vertical], axis=-1).sum(axis=1)
    actuators = np.concatenate([f.torque, f.lift.sum(axis=1, keepdims=True)], axis=1)
    actuators = _with_drives(design, actuators, p, v, a)
    on_actuators = np.einsum("nji,nj->ni", inverse_jacobian(geometry, p), actuators)
    masses = np.array([e.mass, e.mass, e.inertia + 6.0 * e.turn, e.mass])
    weight = np.array([0.0, 0.0, 0.0, e.mass * design.gravity])
    held = generalized_force(design.load, p[:, 2], flat_load(load, shape))
    return (on_point + on_actuators + masses * a + weight - held).reshape(*shape, 4)


@of_design
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
    friction, against = np.zeros_like(p), np.zeros_like(p)
    if not design.actuator_friction.zero:
        friction = _friction(design, p, v)
    if design.load.acts or load is not None:
        against = load_torques(design.geometry, design.load, p, flat_load(load, shape))
    parts = (
        inverse_dynamics(plain, p, still, still, misprints).torque,
        inverse_dynamics(weightless, p, still, a, misprints).torque,
        inverse_dynamics(weightless, p, v, still, misprints).torque,
        friction,
        against,
    )
    return TorqueBreakdown(*(part.reshape(*shape, 4) for part in parts))


@np.errstate(all="ignore")
def friction_torque(friction: Friction | ActuatorFriction, speed: ArrayLike) -> Array:
    """Return what the actuators need against friction at their speeds, (..., 4) [N m, N].

    Args:
        friction: Of the joints; `Design.actuator_friction` is that of joints and drives together.
        speed: (..., 4) of M1..M4 [rad/s, rad/s, rad/s, m/s].

    Raises:
        InvalidInput: If the friction is neither, or the speed has another shape or is not real.
    """
    speed = as_vectors(speed, "speed")
    require_kind(friction, "friction", Friction, ActuatorFriction)
    if isinstance(friction, Friction):
        friction = friction.by_actuator
    viscous, coulomb = np.array(friction.viscous), np.array(friction.coulomb)
    return friction_formula(viscous, coulomb, friction.transition_speed, speed)


@of_design
def mass_matrix(design: Design, pose: ArrayLike, misprints: Misprint = Misprint.NONE) -> Array:
    """Return M with T = v.M v/2, v = (x', y', theta', z'), (..., 4, 4) [kg, kg m, kg m^2].

    Symmetric positive definite wherever the pose can be taken, type-2 singularities included. NaN
    where the bars cannot close. The drives add G^T diag(N^2 J) G.
    """
    pose = as_vectors(pose, "pose")
    m = mechanism(design.geometry)
    upper = backend.mass_matrix(m, term_factors(design, misprints), pose.reshape(-1, 4))
    matrix = np.empty((len(upper), 4, 4))
    rows, columns = np.triu_indices(4)
    matrix[:, rows, columns] = upper
    matrix[:, columns, rows] = upper
    matrix = matrix.reshape(*pose.shape[:-1], 4, 4)
    if any(design.drive_inertia):
        g = inverse_jacobian(design.geometry, pose)
        matrix = matrix + np.einsum("...ki,k,...kj->...ij", g, np.array(design.drive_inertia), g)
    return matrix


@of_design
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

    Raises:
        InvalidInput: If nothing of the robot has inertia in some direction.
    """
    shape, (p, v, q) = together(pose=pose, velocity=velocity, torque=torque)
    bias = inverse_dynamics(design, p, v, np.zeros_like(p), load=flat_load(load, shape)).torque
    g = inverse_jacobian(design.geometry, p)
    matrix = mass_matrix(design, p)
    force = np.einsum("nji,nj->ni", g, q - bias)
    good = np.isfinite(force).all(axis=-1) & np.isfinite(matrix).all(axis=(-1, -2))
    rows, columns = np.triu_indices(4)
    found = acceleration_of_force(*matrix[:, rows, columns].T, *force.T)
    if not (found.pivot[good] > 0.0).all():
        raise InvalidInput(
            "design", "without any inertia in some direction its acceleration has no bound there; "
            "platform.inertia above 0 gives it one in theta"
        )  # fmt: skip
    acceleration = np.stack(found[:4], axis=-1)
    return np.where(good[:, None], acceleration, np.nan).reshape(*shape, 4)
