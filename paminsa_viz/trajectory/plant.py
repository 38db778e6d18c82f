"""The robot and its controller as plain formulas of numbers, for simulation in time.

The same source runs in Python and compiled (`plant_kernel`). Unlike `robot.drive` it works in the
platform's coordinates and never divides by the closure's determinant, so that it stays exact close
to a type-2 singularity.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple, TypeAlias

from paminsa_viz.model.leg import LegPosition, Mechanism, leg_motion, leg_position
from paminsa_viz.model.leg_forces import leg_forces
from paminsa_viz.model.load import wrench_at_center
from paminsa_viz.model.lumped import EnergyTerms
from paminsa_viz.model.robot import (
    AXIS_X,
    AXIS_Y,
    _vector,
    mass_matrix,
    platform_determinant,
    solve_wrench,
)


class Losses(NamedTuple):
    """Gravity [m/s^2], friction of the actuators and the load, see `Friction` and `LoadCase`."""

    gravity: float
    viscous_rotary: float
    coulomb_rotary: float
    viscous_linear: float
    coulomb_linear: float
    transition: float
    fx: float
    fy: float
    fz: float
    mz: float
    px: float
    py: float
    turns: float


Robot: TypeAlias = tuple[Mechanism, EnergyTerms, Losses]
"""A robot as the formulas take it."""


class Gains(NamedTuple):
    """Gains of the controller; ``mode`` is the index in `control.ControlMode`.

    With computed torque ``rate`` and ``damping`` turn errors of the pose into an acceleration
    [1/s^2, 1/s]; with PD the others turn errors of the actuators into torques.
    """

    mode: float
    rate: float
    damping: float
    p1: float
    p2: float
    p3: float
    p4: float
    d1: float
    d2: float
    d3: float
    d4: float


def legs(m: Mechanism, pose: Any) -> tuple[LegPosition, LegPosition, LegPosition]:
    """Solve the three legs at a pose (x, y, theta, z)."""
    x, y, theta, z = pose
    c, s = math.cos(theta), math.sin(theta)
    return (
        leg_position(m, AXIS_X[0], AXIS_Y[0], x, y, c, s, z),
        leg_position(m, AXIS_X[1], AXIS_Y[1], x, y, c, s, z),
        leg_position(m, AXIS_X[2], AXIS_Y[2], x, y, c, s, z),
    )


def turn_rate(g: LegPosition, vx: Any, vy: Any, vt: Any) -> Any:
    """Return theta_k' for a platform velocity."""
    return (vy * g.ux - vx * g.uy + vt * (g.px * g.ux + g.py * g.uy)) * g.inverse_rho


def speeds(m: Mechanism, a: Any, b: Any, d: Any, velocity: Any) -> Any:
    """Return the actuators' speeds."""
    vx, vy, vt, vz = velocity
    return (
        turn_rate(a, vx, vy, vt),
        turn_rate(b, vx, vy, vt),
        turn_rate(d, vx, vy, vt),
        vz * m.inverse_k,
    )


def _leg_load(
    m: Mechanism, e: EnergyTerms, g: LegPosition, velocity: Any, acceleration: Any
) -> Any:
    """Return the load of a leg on the platform: forces along x, y, z and the moment about z."""
    vx, vy, vt, vz = velocity
    ax, ay, at, az = acceleration
    f = leg_forces(m, e, g, leg_motion(m, g, vx, vy, vt, vz, ax, ay, at, az))
    across = f.tangential + f.torque * g.inverse_rho
    fx = f.radial * g.ux - across * g.uy
    fy = f.radial * g.uy + across * g.ux
    return fx, fy, g.px * fy - g.py * fx, f.vertical + f.lift * m.inverse_k


def platform_load(
    m: Mechanism, e: EnergyTerms, gravity: Any, a: Any, b: Any, d: Any,
    velocity: Any, acceleration: Any,
) -> Any:  # fmt: skip
    """Return the generalized force (x, y, theta, z) that makes a motion of the whole robot."""
    la = _leg_load(m, e, a, velocity, acceleration)
    lb = _leg_load(m, e, b, velocity, acceleration)
    ld = _leg_load(m, e, d, velocity, acceleration)
    return (
        la[0] + lb[0] + ld[0] + e.mass * acceleration[0],
        la[1] + lb[1] + ld[1] + e.mass * acceleration[1],
        la[2] + lb[2] + ld[2] + (e.inertia + 6.0 * e.turn) * acceleration[2],
        la[3] + lb[3] + ld[3] + e.mass * (acceleration[3] + gravity),
    )


def to_actuators(m: Mechanism, pose: Any, a: Any, b: Any, d: Any, load: Any) -> Any:
    """Return the torques with the same power as a generalized force of the platform."""
    va, vb, vd = _vector(a), _vector(b), _vector(d)
    determinant = platform_determinant(m, pose[0], pose[1], math.cos(pose[2]))
    t = solve_wrench(determinant, va, vb, vd, load[0], load[1], load[2])
    return t.t1 * va.rho2, t.t2 * vb.rho2, t.t3 * vd.rho2, load[3] * m.k


def to_platform(m: Mechanism, a: Any, b: Any, d: Any, torque: Any) -> Any:
    """Return the generalized force of the platform with the same power as torques."""
    fa, fb, fd = torque[0] * a.inverse_rho, torque[1] * b.inverse_rho, torque[2] * d.inverse_rho
    return (
        -fa * a.uy - fb * b.uy - fd * d.uy,
        fa * a.ux + fb * b.ux + fd * d.ux,
        fa * (a.px * a.ux + a.py * a.uy)
        + fb * (b.px * b.ux + b.py * b.uy)
        + fd * (d.px * d.ux + d.py * d.uy),
        torque[3] * m.inverse_k,
    )


def friction(o: Losses, speed: Any) -> Any:
    """Return the friction torques at the actuators' speeds."""
    inverse = 1.0 / o.transition
    return (
        o.viscous_rotary * speed[0] + o.coulomb_rotary * math.tanh(speed[0] * inverse),
        o.viscous_rotary * speed[1] + o.coulomb_rotary * math.tanh(speed[1] * inverse),
        o.viscous_rotary * speed[2] + o.coulomb_rotary * math.tanh(speed[2] * inverse),
        o.viscous_linear * speed[3] + o.coulomb_linear * math.tanh(speed[3] * inverse),
    )


def push(o: Losses, theta: Any, extra: Any) -> Any:
    """Return the load as a generalized force (x, y, theta, z).

    ``extra`` is (F_x, F_y, F_z, M_z) on top of the load, at its point and in its directions.
    """
    fx, fy, fz, _, _, mz = wrench_at_center(
        o.fx + extra[0], o.fy + extra[1], o.fz + extra[2], 0.0, 0.0, o.mz + extra[3],
        o.px, o.py, 0.0, o.turns, math.cos(theta), math.sin(theta),
    )  # fmt: skip
    return fx, fy, mz, fz


def inverse_torques(
    m: Mechanism, e: EnergyTerms, o: Losses, pose: Any, velocity: Any, acceleration: Any,
    extra: Any,
) -> Any:  # fmt: skip
    """Return the torques that make a motion under the load, friction included."""
    a, b, d = legs(m, pose)
    own = platform_load(m, e, o.gravity, a, b, d, velocity, acceleration)
    w = push(o, pose[2], extra)
    load = (own[0] - w[0], own[1] - w[1], own[2] - w[2], own[3] - w[3])
    drive = to_actuators(m, pose, a, b, d, load)
    loss = friction(o, speeds(m, a, b, d, velocity))
    return drive[0] + loss[0], drive[1] + loss[1], drive[2] + loss[2], drive[3] + loss[3]


def solve(w: Any, f: Any) -> Any:
    """Solve M q = f for a symmetric positive definite M (4, 4), given as its upper triangle."""
    m00, m01, m02, m03, m11, m12, m13, m22, m23, m33 = w
    l00 = math.sqrt(m00)
    l10, l20, l30 = m01 / l00, m02 / l00, m03 / l00
    l11 = math.sqrt(m11 - l10 * l10)
    l21, l31 = (m12 - l20 * l10) / l11, (m13 - l30 * l10) / l11
    l22 = math.sqrt(m22 - l20 * l20 - l21 * l21)
    l32 = (m23 - l30 * l20 - l31 * l21) / l22
    l33 = math.sqrt(m33 - l30 * l30 - l31 * l31 - l32 * l32)
    y0 = f[0] / l00
    y1 = (f[1] - l10 * y0) / l11
    y2 = (f[2] - l20 * y0 - l21 * y1) / l22
    y3 = (f[3] - l30 * y0 - l31 * y1 - l32 * y2) / l33
    q3 = y3 / l33
    q2 = (y2 - l32 * q3) / l22
    q1 = (y1 - l21 * q2 - l31 * q3) / l11
    q0 = (y0 - l10 * q1 - l20 * q2 - l30 * q3) / l00
    return q0, q1, q2, q3


def acceleration_under(
    m: Mechanism, e: EnergyTerms, gravity: Any, pose: Any, velocity: Any, torque: Any, w: Any
) -> Any:
    """Return the platform's acceleration under torques that reach the mechanism, and a load w."""
    a, b, d = legs(m, pose)
    own = platform_load(m, e, gravity, a, b, d, velocity, (0.0, 0.0, 0.0, 0.0))
    bias = (own[0] - w[0], own[1] - w[1], own[2] - w[2], own[3] - w[3])
    force = to_platform(m, a, b, d, torque)
    inertia = mass_matrix(m, e, pose[0], pose[1], math.cos(pose[2]), math.sin(pose[2]), pose[3])
    return solve(
        inertia,
        (force[0] - bias[0], force[1] - bias[1], force[2] - bias[2], force[3] - bias[3]),
    )


def turn_error(wanted: LegPosition, actual: LegPosition) -> Any:
    """Return theta_k wanted minus actual, without jumps of a full turn."""
    return math.atan2(
        actual.ux * wanted.uy - actual.uy * wanted.ux,
        actual.ux * wanted.ux + actual.uy * wanted.uy,
    )


def _toward(k: Gains, i: int, wanted: Any, rate: Any, growth: Any, pose: Any, velocity: Any) -> Any:
    """Return the acceleration of a coordinate that brings its error back."""
    return growth[i] + k.rate * (wanted[i] - pose[i]) + k.damping * (rate[i] - velocity[i])


def command(
    m: Mechanism, e: EnergyTerms, o: Losses, k: Gains,
    wanted: Any, wanted_velocity: Any, wanted_acceleration: Any, pose: Any, velocity: Any,
    extra: Any,
) -> Any:  # fmt: skip
    """Return the torques that the controller commands; m, e and o are its model.

    It knows the load that varies with time, ``extra``, as it knows the wanted motion.
    """
    if k.mode == 2:  # computed torque
        growth = (
            _toward(k, 0, wanted, wanted_velocity, wanted_acceleration, pose, velocity),
            _toward(k, 1, wanted, wanted_velocity, wanted_acceleration, pose, velocity),
            _toward(k, 2, wanted, wanted_velocity, wanted_acceleration, pose, velocity),
            _toward(k, 3, wanted, wanted_velocity, wanted_acceleration, pose, velocity),
        )
        return inverse_torques(m, e, o, pose, velocity, growth, extra)
    torque = inverse_torques(m, e, o, wanted, wanted_velocity, wanted_acceleration, extra)
    if k.mode == 0:  # feed-forward alone
        return torque
    a, b, d = legs(m, wanted)
    aa, bb, dd = legs(m, pose)
    w, v = speeds(m, a, b, d, wanted_velocity), speeds(m, aa, bb, dd, velocity)
    lift = (wanted[3] - pose[3]) * m.inverse_k
    return (
        torque[0] + k.p1 * turn_error(a, aa) + k.d1 * (w[0] - v[0]),
        torque[1] + k.p2 * turn_error(b, bb) + k.d2 * (w[1] - v[1]),
        torque[2] + k.p3 * turn_error(d, dd) + k.d3 * (w[2] - v[2]),
        torque[3] + k.p4 * lift + k.d4 * (w[3] - v[3]),
    )


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


def extra_load(t: Any, times: Any, states: Any) -> Any:
    """Return the motion's own load (F_x, F_y, F_z, M_z), linear between ``times`` (n,).

    It is in the last four columns of ``states`` (n, 16); with (n, 12) there is none.
    """
    if states.shape[1] < 16:
        return 0.0, 0.0, 0.0, 0.0
    low = interval(t, times)
    u = min(max((t - times[low]) / (times[low + 1] - times[low]), 0.0), 1.0)
    a, b = states[low], states[low + 1]
    return (
        a[12] + u * (b[12] - a[12]),
        a[13] + u * (b[13] - a[13]),
        a[14] + u * (b[14] - a[14]),
        a[15] + u * (b[15] - a[15]),
    )


def interval(t: Any, times: Any) -> Any:
    """Return the index of the last of ``times`` but the final one that is not after t."""
    low, high = 0, times.size - 1
    while high - low > 1:
        middle = (low + high) // 2
        if times[middle] <= t:
            low = middle
        else:
            high = middle
    return low


def reference(t: Any, times: Any, states: Any) -> Any:
    """Return the wanted pose, velocity and acceleration; ``states`` (n, 12+) at ``times`` (n,)."""
    low = interval(t, times)
    h = times[low + 1] - times[low]
    u = min(max((t - times[low]) / h, 0.0), 1.0)
    a, b = states[low], states[low + 1]
    x = hermite(u, h, a[0], a[4], a[8], b[0], b[4], b[8])
    y = hermite(u, h, a[1], a[5], a[9], b[1], b[5], b[9])
    o = hermite(u, h, a[2], a[6], a[10], b[2], b[6], b[10])
    z = hermite(u, h, a[3], a[7], a[11], b[3], b[7], b[11])
    return (x[0], y[0], o[0], z[0]), (x[1], y[1], o[1], z[1]), (x[2], y[2], o[2], z[2])


def commanded(t: Any, state: Any, believed: Any, k: Gains, times: Any, states: Any) -> Any:
    """Return the commanded torques at a time and a state (pose, velocity, ...)."""
    m, e, o = believed
    pose = (state[0], state[1], state[2], state[3])
    velocity = (state[4], state[5], state[6], state[7])
    wanted, rate, growth = reference(t, times, states)
    extra = extra_load(t, times, states)
    return command(m, e, o, k, wanted, rate, growth, pose, velocity, extra)


def derivative(
    t: Any, state: Any, plant: Any, believed: Any, k: Gains, times: Any, states: Any, out: Any
) -> None:
    """Write the derivative of (pose, velocity, work of the actuators, friction losses) (10,).

    A state (11,) has the work of the load as well.
    """
    m, e, o = plant
    torque = commanded(t, state, believed, k, times, states)
    pose = (state[0], state[1], state[2], state[3])
    velocity = (state[4], state[5], state[6], state[7])
    a, b, d = legs(m, pose)
    speed = speeds(m, a, b, d, velocity)
    loss = friction(o, speed)
    net = (torque[0] - loss[0], torque[1] - loss[1], torque[2] - loss[2], torque[3] - loss[3])
    w = push(o, pose[2], extra_load(t, times, states))
    growth = acceleration_under(m, e, o.gravity, pose, velocity, net, w)
    out[0], out[1], out[2], out[3] = velocity
    out[4], out[5], out[6], out[7] = growth
    out[8] = (
        torque[0] * speed[0] + torque[1] * speed[1] + torque[2] * speed[2] + torque[3] * speed[3]
    )
    out[9] = loss[0] * speed[0] + loss[1] * speed[1] + loss[2] * speed[2] + loss[3] * speed[3]
    if out.size > 10:
        out[10] = w[0] * velocity[0] + w[1] * velocity[1] + w[2] * velocity[2] + w[3] * velocity[3]
