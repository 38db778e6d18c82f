"""The tests' own mechanics has to be right before anything is measured against it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from paminsa_viz.model.design import APPENDIX_4, Design, KneeBranch
from tests import oracle
from tests.support import samples
from tests.support.cases import BOTH, PROTOTYPES
from tests.support.samples import with_knee

RANDOM = samples.random_design(np.random.default_rng(0))
EACH = samples.each_robot(range(4))


def joints(design: Design, pose: Any) -> list[dict[int, Any]]:
    """Joint points of the three legs as arrays (n, 3)."""
    found = []
    for index in range(3):
        solved = oracle.leg(design, oracle.split(pose), index)
        found.append(
            {
                number: np.stack(np.broadcast_arrays(*point), axis=-1)
                for number, point in solved.points.items()
            }
        )
    return found


def slope(f: Callable[[float], Any], h: float) -> Any:
    """Derivative at 0 by central differences of sixth order with a step."""
    near, middle, far = (f(n * h) - f(-n * h) for n in (1, 2, 3))
    return (45 * near - 9 * middle + far) / (60 * h)


def length(a: Any, b: Any) -> Any:
    return np.linalg.norm(a - b, axis=-1)


@pytest.mark.slow
@EACH
def test_every_leg_is_the_mechanism_of_the_paper(design: Design) -> None:
    g, k = design.geometry, design.geometry.magnification
    pose = samples.random_poses(np.random.default_rng(1), design, 50, natural=False)
    for index, p in enumerate(joints(design, pose)):
        angle = oracle.AXIS_ANGLES[index]
        axis = g.base_radius * np.array([np.cos(angle), np.sin(angle)])
        near = np.hypot(*(p[5] - np.append(axis, 0.0))[:, :2].T)
        tight = {"rtol": 0, "atol": 1e-13}
        np.testing.assert_allclose(length(p[9], p[8]), g.crank_length, **tight)
        np.testing.assert_allclose(length(p[4], p[7]), g.crank_length, **tight)
        np.testing.assert_allclose(length(p[9], p[5]), g.coupler_length, **tight)
        np.testing.assert_allclose(length(p[7], p[8]), g.coupler_length / k, **tight)
        np.testing.assert_allclose(length(p[2], p[3]), g.shaft_length, **tight)
        np.testing.assert_allclose(p[4] - p[9], p[7] - p[8], **tight)
        np.testing.assert_allclose(p[5] - p[8], k * (p[3] - p[8]), **tight)
        # Joint 3 lies on B3 and on the leg axis, joint 8 at the guides' height beyond the axis.
        np.testing.assert_allclose(p[3] - p[7], (p[4] - p[7]) / k, **tight)
        np.testing.assert_allclose(p[3][:, :2], np.broadcast_to(axis, (50, 2)), **tight)
        np.testing.assert_allclose(p[8][:, 2], 0.0, **tight)
        np.testing.assert_allclose(length(p[8][:, :2], axis), near / (k - 1), **tight)
        # The knee is the lower or the upper one of the two, seen from the line 8-5.
        line = np.cross(p[5] - p[8], p[9] - p[8])
        plane = np.cross([0.0, 0.0, 1.0], p[5] - p[8])
        assert np.all(np.einsum("ni,ni->n", line, plane) * design.geometry.knee.sign > 0)
        # One plane through the leg axis holds the whole leg.
        heading = (p[5] - p[3])[:, :2] / near[:, None]
        for point in p.values():
            x, y = (point[:, :2] - axis).T
            np.testing.assert_allclose(x * heading[:, 1] - y * heading[:, 0], 0.0, **tight)


@EACH
def test_static_forces_are_the_slope_of_the_potential(design: Design) -> None:
    pose = samples.random_poses(np.random.default_rng(2), design, 30)
    forces = oracle.pose_forces(design, pose, np.zeros(4), np.zeros(4))
    step = 1e-30
    slope = np.stack(
        [oracle.potential(design, pose + 1j * step * e).imag / step for e in np.eye(4)],
        axis=-1,
    )
    np.testing.assert_allclose(forces, slope, rtol=0, atol=1e-12 * np.abs(slope).max())


@EACH
def test_actuator_rates_follow_the_actuators(design: Design) -> None:
    pose, velocity, _ = samples.random_states(np.random.default_rng(3), design, 30)
    h = 1e-4
    measured = slope(lambda t: oracle.actuators(design, pose + t * velocity), h)
    rates = oracle.actuator_rates(design, pose, velocity)
    np.testing.assert_allclose(rates, measured, rtol=0, atol=1e-8 * np.abs(rates).max())


@EACH
def test_kinetic_energy_from_measured_speeds(design: Design) -> None:
    """Speeds of points from differences of places; turning from differences of the axes."""
    pose, velocity, _ = samples.random_states(np.random.default_rng(4), design, 10)
    h = 1e-3
    runs = {
        n: oracle.bodies(design, oracle.split(pose + n * h * velocity))
        for n in (-3, -2, -1, 0, 1, 2, 3)
    }

    def speed(pick: Any) -> Any:
        a = {
            n: np.stack(np.broadcast_arrays(*pick(run), pose[:, 0])[:3], -1)
            for n, run in runs.items()
        }
        return (45 * (a[1] - a[-1]) - 9 * (a[2] - a[-2]) + (a[3] - a[-3])) / (60 * h)

    total: Any = 0.0
    for index, body in enumerate(runs[0]):
        v = speed(lambda run, i=index: run[i].center)
        total = total + 0.5 * body.mass * np.sum(v * v, axis=-1)
        if body.axes is None:
            continue
        # sum over axes of J_a |e_a'|^2 / 2 with J = tr(I)/2 - I is the energy of turning.
        for a in range(3):
            e = speed(lambda run, i=index, a=a: run[i].axes[a])
            spread = 0.5 * sum(body.inertia) - body.inertia[a]
            total = total + 0.5 * spread * np.sum(e * e, axis=-1)
    np.testing.assert_allclose(oracle.kinetic(design, pose, velocity), total, rtol=1e-7)


@EACH
def test_power_of_the_actuators_is_the_growth_of_energy(design: Design) -> None:
    pose, velocity, acceleration = samples.random_states(np.random.default_rng(5), design, 30)
    torque = oracle.inverse_dynamics(design, pose, velocity, acceleration)
    power = np.sum(torque * oracle.actuator_rates(design, pose, velocity), axis=-1)

    def energy(t: float) -> Any:
        q, v = pose + velocity * t + acceleration * t * t / 2, velocity + acceleration * t
        return oracle.kinetic(design, q, v) + oracle.potential(design, q)

    h = 2e-4
    np.testing.assert_allclose(power, slope(energy, h), rtol=0, atol=1e-8 * np.abs(power).max())


@pytest.mark.slow
@BOTH
def test_lagrange_from_the_energies_gives_the_same_forces(knee: KneeBranch) -> None:
    """d/dt dT/dv - dT/dq + dV/dq, differentiated numerically from T and V alone."""
    design = RANDOM.with_knee(knee)
    pose, velocity, acceleration = samples.random_states(np.random.default_rng(6), design, 10)
    h = 2e-4

    columns = []
    for e in np.eye(4):

        def momentum(t: float, e: Any = e) -> Any:
            # T is quadratic in the rates, so one central difference of any size is exact.
            q, v = pose + velocity * t + acceleration * t * t / 2, velocity + acceleration * t
            up, down = (oracle.kinetic(design, q, v + s * e) for s in (1.0, -1.0))
            return 0.5 * (up - down)

        def action(t: float, e: Any = e) -> Any:
            q = pose + t * e
            return oracle.kinetic(design, q, velocity) - oracle.potential(design, q)

        columns.append(slope(momentum, h) - slope(action, h))
    forces = oracle.pose_forces(design, pose, velocity, acceleration)
    np.testing.assert_allclose(
        forces, np.stack(columns, axis=-1), rtol=0, atol=1e-8 * np.abs(forces).max()
    )


@BOTH
def test_only_the_lift_carries_the_platform(knee: KneeBranch) -> None:
    pose = samples.random_poses(np.random.default_rng(7), with_knee(APPENDIX_4, knee), 20)
    light = oracle.static_torques(with_knee(APPENDIX_4, knee), pose)
    heavy = oracle.static_torques(with_knee(APPENDIX_4.vary({"payload.mass": 12.0}), knee), pose)
    np.testing.assert_allclose(heavy[:, :3], light[:, :3], rtol=0, atol=1e-12)
    np.testing.assert_allclose(heavy[:, 3] - light[:, 3], 12.0 * 9.81 * 3.0, rtol=1e-13)


def test_mirror_image_has_opposite_gravity_torques() -> None:
    pose = samples.random_poses(np.random.default_rng(8), APPENDIX_4, 20)
    mirrored = pose.copy()
    mirrored[:, 3] = -pose[:, 3] - 2 * APPENDIX_4.geometry.platform_joint_height
    below = oracle.static_torques(APPENDIX_4, pose)
    above = oracle.static_torques(with_knee(APPENDIX_4, KneeBranch.UPPER), mirrored)
    np.testing.assert_allclose(above[:, :3], -below[:, :3], rtol=0, atol=1e-12)


@PROTOTYPES
def test_one_state_and_batches_of_any_shape_agree(design: Design) -> None:
    states = samples.random_states(np.random.default_rng(9), design, 6)
    flat = oracle.inverse_dynamics(design, *states)
    grid = oracle.inverse_dynamics(design, *(s.reshape(2, 3, 4) for s in states))
    np.testing.assert_allclose(grid.reshape(6, 4), flat, rtol=1e-13)
    one = oracle.inverse_dynamics(design, *(s[4] for s in states))
    np.testing.assert_allclose(one, flat[4], rtol=1e-13)


@pytest.mark.slow
@BOTH
def test_random_designs_leave_room_to_move(knee: KneeBranch) -> None:
    rng = np.random.default_rng(10)
    for _ in range(10):
        design = samples.random_design(rng)
        pose = samples.random_poses(rng, with_knee(design, knee), 50)
        assert pose.shape == (50, 4)
        assert samples.usable(design, pose).all()
        assert np.all((pose[:, 3] + design.geometry.platform_joint_height) * knee.sign < 0)
