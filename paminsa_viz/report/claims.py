"""What the documentation says in numbers, each worked out again when it is asked for.

A claim names the page that makes it, how it is checked, and what is allowed: identities in another
way than the formulas go, durations by planning again. Nothing is kept: the figure is that of the
run. Claims whose checks take minutes, or programs that are no part of the installation, are held by
the tests alone.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from paminsa_viz.balancing import balance
from paminsa_viz.elastostatics import joint_forces
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import APPENDIX_4
from paminsa_viz.model.dynamics import inverse_dynamics
from paminsa_viz.model.energy import kinetic_energy, potential_energy
from paminsa_viz.model.jacobians import inverse_jacobian, jacobian
from paminsa_viz.model.kinematics import inverse_kinematics, nearest_solution
from paminsa_viz.model.lumped import lumped_coefficients
from paminsa_viz.model.regressor import regressor_torques, torque_regressor
from paminsa_viz.model.singularity import escape_twist, singular_radius, singular_rotation
from paminsa_viz.model.statics import static_imbalance, static_torques
from paminsa_viz.precision import nominal_lengths, solve_pose
from paminsa_viz.report.claim import Claim, MeasuredClaim
from paminsa_viz.report.worked_claims import WORKED
from paminsa_viz.trajectory import (
    PRESET,
    MotionLimits,
    circle,
    point_to_point,
    shortest_motion,
    shortest_stretch,
    straight_path,
    time_optimal,
)

POSES = 200
"""Random poses of a check."""

TURN = ([0.03, 0.02, 0.8, -0.5], [0.03, 0.02, 1.75, -0.5])
"""The turn through a singularity of `docs/crossing.md`."""

LINE = ([0.1, 0.0, 0.2, -0.5], [0.36, 0.02, 0.5, -0.5])
"""Its line."""


def measured_claims() -> Iterator[MeasuredClaim]:
    """Yield the claims, each measured now."""
    for claim in CLAIMS:
        yield MeasuredClaim(claim, claim.measure())


def _poses() -> Array:
    box = np.array([0.12, 0.12, 0.5, 0.06])
    middle = np.array([0.0, 0.0, 0.0, -0.52])
    return middle + box * np.random.default_rng(0).uniform(-1.0, 1.0, (POSES, 4))


def _states() -> tuple[Array, Array, Array]:
    rng = np.random.default_rng(1)
    return _poses(), rng.uniform(-1, 1, (POSES, 4)), rng.uniform(-5, 5, (POSES, 4))


def _relative(difference: Array, size: Array) -> float:
    return float((np.abs(difference).max(axis=0) / np.abs(size).max(axis=0)).max())


def _round_trip() -> float:
    poses = _poses()
    actuators = inverse_kinematics(APPENDIX_4, poses).actuators
    return float(np.abs(nearest_solution(APPENDIX_4, actuators, poses) - poses).max())


def _determinant(pose: Array) -> float:
    return float(np.linalg.det(inverse_jacobian(APPENDIX_4, pose)[:3, :3]))


def _root(along: Callable[[float], Array], low: float, high: float) -> float:
    from scipy.optimize import brentq

    return float(brentq(lambda at: _determinant(along(at)), low, high, xtol=1e-14))  # type: ignore[arg-type]


def _singular_turn() -> float:
    found = _root(lambda at: np.array([0.03, 0.02, at, -0.5]), 1.0, 1.5)
    return found - singular_rotation(APPENDIX_4.geometry)


def _singular_circle() -> float:
    off = []
    for theta in (-0.4, 0.0, 0.3, 0.9):
        edge = float(singular_radius(APPENDIX_4.geometry, theta))
        across = np.array([np.cos(0.7), np.sin(0.7)])
        found = _root(
            lambda r, t=theta, d=across: np.array([*r * d, t, -0.5]), edge - 0.02, edge + 0.02
        )
        off.append(found - edge)
    return float(np.abs(off).max())


def _escape() -> float:
    turn = singular_rotation(APPENDIX_4.geometry)
    pose = np.array([0.03, 0.02, turn, -0.5])
    return float(np.abs(inverse_jacobian(APPENDIX_4, pose) @ escape_twist(APPENDIX_4, pose)).max())


def _statics() -> float:
    """Virtual work: the gradient of the potential energy, by central differences, through J."""
    poses, h = _poses(), 1e-6
    step = h * np.eye(4)
    slope = np.stack(
        [
            (potential_energy(APPENDIX_4, poses + one) - potential_energy(APPENDIX_4, poses - one))
            / (2 * h)
            for one in step
        ],
        axis=1,
    )
    torque = np.einsum("nij,ni->nj", jacobian(APPENDIX_4, poses), slope)
    return _relative(torque - static_torques(APPENDIX_4, poses), torque)


def _power() -> float:
    """Power of the actuators against the change of the energy, along a motion."""
    motion = PRESET["arch"].build(APPENDIX_4.geometry)
    h, t = 1e-5, np.linspace(0.05, 0.95, 181) * motion.duration

    def energy(at: Array) -> Array:
        state = motion.at(at)
        still = kinetic_energy(APPENDIX_4, state.pose, state.velocity)
        return still + potential_energy(APPENDIX_4, state.pose)

    change = (energy(t + h) - energy(t - h)) / (2 * h)
    state = motion.at(t)
    torque = inverse_dynamics(APPENDIX_4, *state).torque
    speed = np.einsum("nij,nj->ni", inverse_jacobian(APPENDIX_4, state.pose), state.velocity)
    return float(np.abs((torque * speed).sum(axis=1) - change).max() / np.abs(change).max())


def _regressor() -> float:
    states = _states()
    torque = inverse_dynamics(APPENDIX_4, *states).torque
    y = torque_regressor(APPENDIX_4.geometry, *states, gravity=APPENDIX_4.gravity)
    return _relative(regressor_torques(y, lumped_coefficients(APPENDIX_4)) - torque, torque)


def _third_turn() -> float:
    poses = _poses()
    cosine, sine = np.cos(2 * np.pi / 3), np.sin(2 * np.pi / 3)
    turned = poses.copy()
    turned[:, 0] = cosine * poses[:, 0] - sine * poses[:, 1]
    turned[:, 1] = sine * poses[:, 0] + cosine * poses[:, 1]
    before, after = static_torques(APPENDIX_4, poses), static_torques(APPENDIX_4, turned)
    pairs = [
        np.abs(np.sort(a[:3]) - np.sort(b[:3])).max() for a, b in zip(before, after, strict=True)
    ]
    return float(np.max(pairs) / np.abs(before[:, :3]).max())


def _one_scalar() -> float:
    """Gravity torques of M1..M3 go with M_p2, whichever mass it comes from."""
    poses = _poses()
    heavier = APPENDIX_4.vary({"links.b4": 1.3})
    ratio = static_imbalance(heavier) / static_imbalance(APPENDIX_4)
    torque = static_torques(heavier, poses)[:, :3]
    return _relative(torque - ratio * static_torques(APPENDIX_4, poses)[:, :3], torque)


def _balanced() -> float:
    left = static_torques(balance(APPENDIX_4).after, _poses())[:, :3]
    return float(np.abs(left).max() / np.abs(static_torques(APPENDIX_4, _poses())[:, :3]).max())


def _joint_loads() -> float:
    poses = _poses()
    torque = static_torques(APPENDIX_4, poses)
    return _relative(joint_forces(APPENDIX_4, poses).torque - torque, torque)


def _unequal_legs() -> float:
    poses = _poses()[:50]
    actuators = inverse_kinematics(APPENDIX_4, poses).actuators
    lengths = nominal_lengths(APPENDIX_4.geometry)
    found = solve_pose(APPENDIX_4.geometry, lengths, actuators, poses + 1e-3)
    return float(np.abs(found.coordinates[:, :4] - poses).max())


def _crossing_time(balanced: bool) -> float:
    design = balance(APPENDIX_4).after if balanced else APPENDIX_4
    return time_optimal(design, straight_path(*TURN), MotionLimits(torque=10.0)).plan.duration


def _line_time() -> float:
    design = balance(APPENDIX_4).after
    return time_optimal(design, straight_path(*LINE), MotionLimits(torque=10.0)).plan.duration


def _crossing_torque() -> float:
    """Inverse dynamics of the samples, which knows nothing of the program, off the crossing."""
    plan = time_optimal(APPENDIX_4, straight_path(*TURN), MotionLimits(torque=10.0)).plan
    motion = plan.sample()
    torque = inverse_dynamics(APPENDIX_4, motion.pose, motion.velocity, motion.acceleration).torque
    near = np.abs(motion.t - motion.passages[0].t) < 2e-3
    return float(np.abs(torque[~near, :3]).max() / 10.0 - 1.0)


def _straight_time() -> float:
    start = np.array([-0.05, 0.0, 0.0, -0.5])
    move = point_to_point(start, start + np.array([0.1, 0.0, 0.0, 0.0]))
    expected = 2.0 * np.sqrt(0.1 / 2.0)
    return shortest_motion(move, MotionLimits(acceleration=2.0)).plan.duration / expected - 1.0


def _circle_time() -> float:
    """z = a r sin(2 s/r) until the whole acceleration is centripetal, then held."""
    r, a = 0.08, 3.0
    s = np.pi * r / 4.0 * np.sin(np.linspace(0.0, np.pi / 2, 200_001)) ** 2
    rate = np.sqrt(a * r * np.sin(2.0 * s / r))
    up = float(np.sum(2.0 * np.diff(s) / (rate[1:] + rate[:-1])))
    expected = 2.0 * up + 1.5 * np.pi * r / np.sqrt(a * r)
    found = shortest_motion(circle([0.0, 0.0, 0.0, -0.5], r), MotionLimits(acceleration=a))
    return found.plan.duration / expected - 1.0


def _arch_ratio() -> float:
    plan, limits = PRESET["arch"].build(APPENDIX_4.geometry), _MOTION_LIMITS
    best = shortest_motion(plan, limits, APPENDIX_4).plan.duration
    return best / shortest_stretch(plan, limits, APPENDIX_4).plan.duration


def _between_samples() -> float:
    plan = shortest_motion(
        PRESET["arch"].build(APPENDIX_4.geometry), _MOTION_LIMITS, APPENDIX_4
    ).plan
    motion = plan.sample(9973.0)
    torque = inverse_dynamics(APPENDIX_4, motion.pose, motion.velocity, motion.acceleration).torque
    return float((np.abs(torque) / _MOTION_LIMITS.actuators).max() - 1.0)


_MOTION_LIMITS = MotionLimits(
    speed=1.0, turn_speed=6.0, acceleration=10.0, turn_acceleration=60.0, torque=6.0, force=400.0
)

CLAIMS: tuple[Claim, ...] = (
    Claim(
        "model.md",
        "The inverse kinematics and the closed-form forward kinematics are inverse",
        "200 random poses there and back",
        "m",
        1e-12,
        _round_trip,
    ),
    Claim(
        "model.md",
        "det J is zero where cos θ = R_pl/R_b",
        "root of the numeric determinant",
        "rad",
        1e-10,
        _singular_turn,
    ),
    Claim(
        "model.md",
        "det J is zero on a circle of closed-form radius, for every θ",
        "roots of the numeric determinant on a ray, four headings",
        "m",
        1e-10,
        _singular_circle,
    ),
    Claim(
        "crossing.md",
        "G t_s = 0 at a singular pose",
        "the product, element by element",
        "",
        1e-12,
        _escape,
    ),
    Claim(
        "forces.md",
        "Static torques are the gradient of the potential energy through J",
        "central differences of the energy, 200 poses",
        "",
        1e-7,
        _statics,
    ),
    Claim(
        "loads.md",
        "Power of the actuators is the change of kinetic and potential energy",
        "central differences of the energies along the arch",
        "",
        2e-6,
        _power,
    ),
    Claim(
        "model.md",
        "Torques are linear in the lumped coefficients, Q = Y c",
        "regressor against inverse dynamics, 200 states",
        "",
        1e-12,
        _regressor,
    ),
    Claim(
        "model.md",
        "Turning x, y by 120° permutes the actuators",
        "200 poses and their turns",
        "",
        1e-12,
        _third_turn,
    ),
    Claim(
        "model.md",
        "Gravity torques of M1..M3 are one scalar, M_p2, times a map of the geometry",
        "another mass of B4: torques over the ratio of M_p2",
        "",
        1e-12,
        _one_scalar,
    ),
    Claim(
        "balancing.md",
        "The balanced robot has no static torques of M1..M3",
        "200 poses, over those of Appendix 4",
        "",
        1e-9,
        _balanced,
    ),
    Claim(
        "loads.md",
        "Joint forces give the torques of statics",
        "equilibrium of the bodies, 200 poses",
        "",
        1e-10,
        _joint_loads,
    ),
    Claim(
        "calibration.md",
        "Legs of nominal lengths have the closed-form pose",
        "Newton’s method from 1 mm away, 50 poses",
        "m",
        1e-9,
        _unequal_legs,
    ),
    Claim(
        "crossing.md",
        "The turn takes 0.372 s by 10 N·m, Appendix 4",
        "planned again",
        "s",
        5e-4,
        lambda: _crossing_time(False),
        0.372,
    ),
    Claim(
        "crossing.md",
        "The turn takes 0.346 s by 10 N·m, balanced",
        "planned again",
        "s",
        5e-4,
        lambda: _crossing_time(True),
        0.346,
    ),
    Claim(
        "crossing.md",
        "The line through the circle takes 1.275 s, balanced",
        "planned again",
        "s",
        5e-4,
        _line_time,
        1.275,
    ),
    Claim(
        "crossing.md",
        "Torques keep 10 N·m on both sides of the crossing",
        "inverse dynamics of the samples, excess in parts of the limit",
        "",
        3e-3,
        _crossing_torque,
    ),
    Claim(
        "motions.md",
        "The time-optimal law is bang-bang on a line: T = 2 √(d/a)",
        "closed form, difference in parts",
        "",
        5e-4,
        _straight_time,
    ),
    Claim(
        "motions.md",
        "On a circle z = a r sin(2 s/r), then constant",
        "quadrature of that law",
        "",
        1e-3,
        _circle_time,
    ),
    Claim(
        "motions.md",
        "The arch takes 0.70 of the stretched law’s time",
        "both planned again",
        "",
        5e-3,
        _arch_ratio,
        0.70,
    ),
    Claim(
        "motions.md",
        "Between the points of the program limits are kept to 0.5 %",
        "inverse dynamics at 10 kHz, excess in parts",
        "",
        5e-3,
        _between_samples,
    ),
    *WORKED,
)
"""The claims; the page groups them."""
