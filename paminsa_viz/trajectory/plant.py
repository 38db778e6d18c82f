"""The robot and its controller as plain formulas of one state, for simulation in time.

The same source runs in Python and compiled (`equations`). Unlike `robot.inverse_dynamics_kernel`
the motion is computed in the platform's coordinates, without the closure's determinant, so that
it stays exact close to a type-2 singularity. Vectors (4,) are (x, y, theta, z) of the platform or
M1..M4 of the actuators.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from paminsa_viz.model.arrays import Array
from paminsa_viz.model.leg import LegPosition, Mechanism, leg_motion, leg_position
from paminsa_viz.model.leg_forces import leg_forces
from paminsa_viz.model.load import wrench_at_center
from paminsa_viz.model.lumped import EnergyTerms
from paminsa_viz.model.robot import AXIS_X, AXIS_Y, mass_matrix

Legs: TypeAlias = tuple[LegPosition, LegPosition, LegPosition]


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


def solve_legs(m: Mechanism, pose: Array) -> Legs:
    """Solve the three legs at a pose."""
    x, y, theta, z = pose
    c, s = math.cos(theta), math.sin(theta)
    return (
        leg_position(m, AXIS_X[0], AXIS_Y[0], x, y, c, s, z),
        leg_position(m, AXIS_X[1], AXIS_Y[1], x, y, c, s, z),
        leg_position(m, AXIS_X[2], AXIS_Y[2], x, y, c, s, z),
    )


def actuator_rows(m: Mechanism, legs: Legs) -> Array:
    """Return the matrix (4, 4) that turns the platform's velocity into the actuators' speeds."""
    rows = np.zeros((4, 4))
    for i, g in enumerate(legs):
        rows[i, 0] = -g.uy * g.inverse_rho
        rows[i, 1] = g.ux * g.inverse_rho
        rows[i, 2] = (g.px * g.ux + g.py * g.uy) * g.inverse_rho
    rows[3, 3] = m.inverse_k
    return rows


def platform_load(robot: Robot, legs: Legs, velocity: Array, acceleration: Array) -> Array:
    """Return the generalized force on the platform that makes a motion of the whole robot."""
    m, e, o = robot
    vx, vy, vt, vz = velocity
    ax, ay, at, az = acceleration
    load = np.array([e.mass * ax, e.mass * ay, e.inertia * at, e.mass * (az + o.gravity)])
    load[3] += o.inertia[3] * m.inverse_k * m.inverse_k * az
    for i, g in enumerate(legs):
        motion = leg_motion(m, g, vx, vy, vt, vz, ax, ay, at, az)
        f = leg_forces(m, e, g, motion)
        across = f.tangential + (f.torque + o.inertia[i] * motion.beta_acc) * g.inverse_rho
        fx = f.radial * g.ux - across * g.uy
        fy = f.radial * g.uy + across * g.ux
        load += np.array([fx, fy, g.px * fy - g.py * fx, f.vertical + f.lift * m.inverse_k])
    return load


def friction(o: Drivetrain, speed: Array) -> Array:
    """Return the friction torques at the actuators' speeds."""
    return o.viscous * speed + o.coulomb * np.tanh(speed / o.transition)


def push(o: Drivetrain, theta: float, extra: Array) -> Array:
    """Return the load with an extra wrench (6,) as a generalized force on the platform."""
    w, p = o.load[:6] + extra, o.load[6:]
    force = wrench_at_center(
        w[0], w[1], w[2], w[3], w[4], w[5], p[0], p[1], p[2], p[3],
        math.cos(theta), math.sin(theta),
    )  # fmt: skip
    return np.array([force[0], force[1], force[5], force[2]])


def inverse_torques(
    robot: Robot, pose: Array, velocity: Array, acceleration: Array, extra: Array
) -> Array:
    """Return the torques that make a motion under the load and an extra one (6,), with friction."""
    legs = solve_legs(robot[0], pose)
    rows = actuator_rows(robot[0], legs)
    load = platform_load(robot, legs, velocity, acceleration) - push(robot[2], pose[2], extra)
    return np.linalg.solve(rows.T, load) + friction(robot[2], rows @ velocity)


def turn_error(wanted: LegPosition, actual: LegPosition) -> float:
    """Return theta_k wanted minus actual, without jumps of a full turn."""
    return math.atan2(
        actual.ux * wanted.uy - actual.uy * wanted.ux, actual.ux * wanted.ux + actual.uy * wanted.uy
    )


def command(model: Robot, k: Gains, wanted: Any, pose: Array, velocity: Array) -> Array:
    """Return the torques that the controller commands for a wanted state, by its model.

    What is wanted comes with the load that varies with time, which the controller knows.
    """
    goal, rate, growth, extra = wanted
    if k.mode == 2:  # computed torque
        growth = growth + k.rate * (goal - pose) + k.damping * (rate - velocity)
        return inverse_torques(model, pose, velocity, growth, extra)
    torque = inverse_torques(model, goal, rate, growth, extra)
    if k.mode == 0:  # feed-forward alone
        return torque
    m = model[0]
    there, here = solve_legs(m, goal), solve_legs(m, pose)
    error = (goal - pose) * m.inverse_k
    for i in range(3):
        error[i] = turn_error(there[i], here[i])
    slip = actuator_rows(m, there) @ rate - actuator_rows(m, here) @ velocity
    return torque + k.proportional * error + k.derivative * slip


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
    motion = hermite(u, h, a[:4], a[4:8], a[8:12], b[:4], b[4:8], b[8:12])
    return motion[0], motion[1], motion[2], a[12:] + u * (b[12:] - a[12:])


def acceleration_under(
    robot: Robot, pose: Array, velocity: Array, torque: Array, force: Array
) -> Array:
    """Return the acceleration under torques that reach the mechanism, and a platform's force."""
    m, e, o = robot
    legs = solve_legs(m, pose)
    bias = platform_load(robot, legs, velocity, np.zeros(4))
    upper = mass_matrix(m, e, pose[0], pose[1], math.cos(pose[2]), math.sin(pose[2]), pose[3])
    inertia = np.empty((4, 4))
    number = 0
    for i in range(4):
        for j in range(i, 4):
            inertia[i, j] = inertia[j, i] = upper[number]
            number += 1
    rows = actuator_rows(m, legs)
    inertia += rows.T @ (np.diag(o.inertia) @ rows)
    found: Any = np.linalg.solve(inertia, rows.T @ torque + force - bias)
    return found


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
    commanded[:] = torque
    speed = actuator_rows(robot[0], solve_legs(robot[0], pose)) @ velocity
    loss = friction(robot[2], speed)
    force = push(robot[2], pose[2], wanted[3])
    growth = np.empty(state.size)
    growth[:4] = velocity
    growth[4:8] = acceleration_under(robot, pose, velocity, torque - loss, force)
    growth[8], growth[9] = torque @ speed, loss @ speed
    if state.size > 10:
        growth[10] = force @ velocity
    return growth
