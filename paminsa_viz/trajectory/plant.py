"""The robot and its controller as plain formulas of one state, for simulation in time.

The same source runs in Python and compiled (`equations`). Unlike `robot.inverse_dynamics_kernel`
the motion is computed in the platform's coordinates, without the closure's determinant, so that
it stays exact close to a type-2 singularity. Vectors (4,) are (x, y, theta, z) of the platform or
M1..M4 of the actuators; they are worked out entry by entry, since Numba takes three times as long
to compile operations on whole arrays and matrices.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from paminsa_viz.model.arrays import Array
from paminsa_viz.model.kinematic_formulas import friction, joint_row
from paminsa_viz.model.leg import LegVector, Mechanism, leg_motion, leg_position, leg_vector
from paminsa_viz.model.leg_forces import leg_forces
from paminsa_viz.model.load import wrench_at_center
from paminsa_viz.model.lumped import EnergyTerms
from paminsa_viz.model.robot import (
    AXIS_X,
    AXIS_Y,
    Acceleration,
    acceleration_of_force,
    mass_matrix,
    platform_determinant,
    solve_wrench,
)

Vectors: TypeAlias = tuple[LegVector, LegVector, LegVector]


class Drivetrain(NamedTuple):
    """Gravity [m/s^2], friction and drives' inertia (4,) at the actuators, and the load.

    ``load`` (10,) is its wrench, its point, and whether it turns with the platform; see `Design`.
    """

    gravity: float
    transition: float
    viscous: Array
    coulomb: Array
    inertia: Array
    load: Array


Robot: TypeAlias = tuple[Mechanism, EnergyTerms, Drivetrain]
"""A robot as the formulas take it."""


class Gains(NamedTuple):
    """Gains of the controller; ``mode`` is the index in `control.ControlMode`.

    With computed torque ``rate`` and ``damping`` turn errors of the pose into an acceleration
    [1/s^2, 1/s]; with PD the others (4,) turn errors of the actuators into torques.
    """

    mode: float
    rate: float
    damping: float
    proportional: Array
    derivative: Array


def leg_vectors(m: Mechanism, pose: Any) -> Vectors:
    """Return the horizontal vectors of the three legs at a pose [m]."""
    c, s = math.cos(pose[2]), math.sin(pose[2])
    return (
        leg_vector(m, AXIS_X[0], AXIS_Y[0], pose[0], pose[1], c, s),
        leg_vector(m, AXIS_X[1], AXIS_Y[1], pose[0], pose[1], c, s),
        leg_vector(m, AXIS_X[2], AXIS_Y[2], pose[0], pose[1], c, s),
    )


def actuator_speeds(m: Mechanism, vectors: Vectors, velocity: Any) -> Array:
    """Return the speeds of the actuators for a velocity of the platform."""
    speed = np.empty(4)
    for i, v in enumerate(vectors):
        row = joint_row(v)
        speed[i] = row.x * velocity[0] + row.y * velocity[1] + row.theta * velocity[2]
    speed[3] = m.inverse_k * velocity[3]
    return speed


def force_of_torques(m: Mechanism, vectors: Vectors, torque: Any) -> Array:
    """Return the generalized force on the platform of torques at the actuators."""
    force = np.zeros(4)
    for i, v in enumerate(vectors):
        row = joint_row(v)
        force[0] += row.x * torque[i]
        force[1] += row.y * torque[i]
        force[2] += row.theta * torque[i]
    force[3] = m.inverse_k * torque[3]
    return force


def torques_of_force(m: Mechanism, pose: Any, force: Any) -> Array:
    """Return the torques whose generalized force is this one; not finite where singular."""
    v1, v2, v3 = leg_vectors(m, pose)
    determinant = platform_determinant(m, pose[0], pose[1], math.cos(pose[2]))
    t = solve_wrench(determinant, v1, v2, v3, force[0], force[1], force[2])
    torque = np.empty(4)
    torque[0], torque[1], torque[2] = t.t1 * v1.rho2, t.t2 * v2.rho2, t.t3 * v3.rho2
    torque[3] = m.k * force[3]
    return torque


def platform_load(robot: Robot, pose: Any, velocity: Any, acceleration: Any) -> Array:
    """Return the generalized force on the platform that makes a motion of the whole robot."""
    m, e, o = robot
    c, s = math.cos(pose[2]), math.sin(pose[2])
    load = np.empty(4)
    load[0], load[1] = e.mass * acceleration[0], e.mass * acceleration[1]
    load[2] = e.inertia * acceleration[2]
    load[3] = e.mass * (acceleration[3] + o.gravity)
    load[3] += o.inertia[3] * m.inverse_k * m.inverse_k * acceleration[3]
    for i in range(3):
        g = leg_position(m, AXIS_X[i], AXIS_Y[i], pose[0], pose[1], c, s, pose[3])
        motion = leg_motion(
            m, g, velocity[0], velocity[1], velocity[2], velocity[3],
            acceleration[0], acceleration[1], acceleration[2], acceleration[3],
        )  # fmt: skip
        f = leg_forces(m, e, g, motion)
        across = f.tangential + (f.torque + o.inertia[i] * motion.beta_acc) * g.inverse_rho
        fx = f.radial * g.ux - across * g.uy
        fy = f.radial * g.uy + across * g.ux
        load[0] += fx
        load[1] += fy
        load[2] += g.px * fy - g.py * fx
        load[3] += f.vertical + f.lift * m.inverse_k
    return load


def friction_torques(o: Drivetrain, speed: Any) -> Array:
    """Return the friction torques at the actuators' speeds."""
    torque = np.empty(4)
    for i in range(4):
        torque[i] = friction(o.viscous[i], o.coulomb[i], o.transition, speed[i])
    return torque


def push(o: Drivetrain, theta: float, extra: Any) -> tuple[Any, Any, Any, Any]:
    """Return the load with an extra wrench (6,) as a generalized force on the platform."""
    w = o.load
    force = wrench_at_center(
        w[0] + extra[0], w[1] + extra[1], w[2] + extra[2],
        w[3] + extra[3], w[4] + extra[4], w[5] + extra[5],
        w[6], w[7], w[8], w[9], math.cos(theta), math.sin(theta),
    )  # fmt: skip
    return force[0], force[1], force[5], force[2]


def inverse_torques(robot: Robot, pose: Any, velocity: Any, acceleration: Any, extra: Any) -> Array:
    """Return the torques that make a motion under the load and an extra one (6,), with friction."""
    load = platform_load(robot, pose, velocity, acceleration)
    pushed = push(robot[2], pose[2], extra)
    for i in range(4):
        load[i] -= pushed[i]
    torque = torques_of_force(robot[0], pose, load)
    speed = actuator_speeds(robot[0], leg_vectors(robot[0], pose), velocity)
    loss = friction_torques(robot[2], speed)
    for i in range(4):
        torque[i] += loss[i]
    return torque


def turn_error(wanted: LegVector, actual: LegVector) -> float:
    """Return theta_k wanted minus actual, without jumps of a full turn."""
    return math.atan2(
        actual.dx * wanted.dy - actual.dy * wanted.dx, actual.dx * wanted.dx + actual.dy * wanted.dy
    )


def command(model: Robot, k: Gains, wanted: Any, pose: Any, velocity: Any) -> Array:
    """Return the torques that the controller commands for a wanted state, by its model.

    What is wanted comes with the load that varies with time, which the controller knows.
    """
    goal, rate, growth, extra = wanted
    if k.mode == 2:  # computed torque
        corrected = np.empty(4)
        for i in range(4):
            feedback = k.rate * (goal[i] - pose[i]) + k.damping * (rate[i] - velocity[i])
            corrected[i] = growth[i] + feedback
        return inverse_torques(model, pose, velocity, corrected, extra)
    torque = inverse_torques(model, goal, rate, growth, extra)
    if k.mode == 0:  # feed-forward alone
        return torque
    m = model[0]
    there, here = leg_vectors(m, goal), leg_vectors(m, pose)
    wanted_speed = actuator_speeds(m, there, rate)
    speed = actuator_speeds(m, here, velocity)
    for i in range(4):
        error = turn_error(there[i], here[i]) if i < 3 else (goal[3] - pose[3]) * m.inverse_k
        torque[i] += k.proportional[i] * error + k.derivative[i] * (wanted_speed[i] - speed[i])
    return torque


def hermite(u: Any, h: Any, p0: Any, v0: Any, a0: Any, p1: Any, v1: Any, a1: Any) -> Any:
    """Return value and two derivatives at the share u of a step h; see `Trajectory.at`."""
    v0, a0, v1, a1 = v0 * h, a0 * h * h, v1 * h, a1 * h * h
    gap, dv, da = p1 - p0 - v0 - 0.5 * a0, v1 - v0 - a0, a1 - a0
    c3 = 10.0 * gap - 4.0 * dv + 0.5 * da
    c4 = -15.0 * gap + 7.0 * dv - da
    c5 = 6.0 * gap - 3.0 * dv + 0.5 * da
    return (
        p0 + u * (v0 + u * (0.5 * a0 + u * (c3 + u * (c4 + u * c5)))),
        (v0 + u * (a0 + u * (3.0 * c3 + u * (4.0 * c4 + u * 5.0 * c5)))) / h,
        (a0 + u * (6.0 * c3 + u * (12.0 * c4 + u * 20.0 * c5))) / (h * h),
    )


def wanted_at(t: float, times: Array, states: Array) -> Any:
    """Return the wanted pose, velocity, acceleration and load; ``states`` (n, 18) at ``times``."""
    right = min(max(np.searchsorted(times, t, "right"), 1), times.size - 1)
    a, b = states[right - 1], states[right]
    h = times[right] - times[right - 1]
    u = min(max((t - times[right - 1]) / h, 0.0), 1.0)
    motion, load = np.empty((3, 4)), np.empty(6)
    for i in range(4):
        motion[0, i], motion[1, i], motion[2, i] = hermite(
            u, h, a[i], a[4 + i], a[8 + i], b[i], b[4 + i], b[8 + i]
        )
    for i in range(6):
        load[i] = a[12 + i] + u * (b[12 + i] - a[12 + i])
    return motion[0], motion[1], motion[2], load


def acceleration_under(
    robot: Robot, pose: Any, velocity: Any, torque: Any, force: Any
) -> Acceleration:
    """Return the acceleration under torques that reach the mechanism, and a platform's force."""
    m, e, o = robot
    bias = platform_load(robot, pose, velocity, np.zeros(4))
    a = mass_matrix(m, e, pose[0], pose[1], math.cos(pose[2]), math.sin(pose[2]), pose[3])
    vectors = leg_vectors(m, pose)
    xx, xy, xt, yy, yt, tt = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0  # of the drives of M1..M3
    for i, v in enumerate(vectors):
        row = joint_row(v)
        xx += o.inertia[i] * row.x * row.x
        xy += o.inertia[i] * row.x * row.y
        xt += o.inertia[i] * row.x * row.theta
        yy += o.inertia[i] * row.y * row.y
        yt += o.inertia[i] * row.y * row.theta
        tt += o.inertia[i] * row.theta * row.theta
    zz = o.inertia[3] * m.inverse_k * m.inverse_k
    total = force_of_torques(m, vectors, torque)
    for i in range(4):
        total[i] += force[i] - bias[i]
    return acceleration_of_force(
        a[0] + xx, a[1] + xy, a[2] + xt, a[3], a[4] + yy, a[5] + yt, a[6], a[7] + tt, a[8],
        a[9] + zz, total[0], total[1], total[2], total[3],
    )  # fmt: skip


def derivative(
    t: float, state: Array, robot: Robot, model: Robot, k: Gains, times: Array, states: Array,
    commanded: Array,
) -> Array:  # fmt: skip
    """Return the derivative of (pose, velocity, work of the actuators, friction losses) (10,).

    A state (11,) has the work of the load as well. The wanted motion is given by ``states``
    (n, 18) at ``times`` (n,), see `wanted_at`; the torques that the controller commands are
    written into ``commanded`` (4,).
    """
    pose, velocity = state[:4], state[4:8]
    wanted = wanted_at(t, times, states)
    torque = command(model, k, wanted, pose, velocity)
    speed = actuator_speeds(robot[0], leg_vectors(robot[0], pose), velocity)
    loss = friction_torques(robot[2], speed)
    force = push(robot[2], pose[2], wanted[3])
    net = np.empty(4)
    for i in range(4):
        commanded[i] = torque[i]
        net[i] = torque[i] - loss[i]
    acceleration = acceleration_under(robot, pose, velocity, net, force)
    growth = np.zeros(state.size)
    for i in range(4):
        growth[i], growth[4 + i] = velocity[i], acceleration[i]
        growth[8] += torque[i] * speed[i]
        growth[9] += loss[i] * speed[i]
        if state.size > 10:
            growth[10] += force[i] * velocity[i]
    return growth
