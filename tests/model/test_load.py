"""The external load: virtual work, bearings, engines, and every way that torques are computed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.errors import InvalidDesign, InvalidInput
from paminsa_viz.model import (
    APPENDIX_4,
    Design,
    Grid,
    LoadCase,
    LoadFrame,
    center_wrench,
    closure_matrix,
    forward_dynamics,
    generalized_force,
    inverse_dynamics,
    inverse_kinematics,
    jacobian,
    load_torques,
    rotary_torques,
    solve_field,
    static_breakdown,
    static_torques,
    torque_breakdown,
)
from paminsa_viz.model.load import NO_LOAD
from tests.support import samples

forces, moments, offsets = (st.floats(-size, size) for size in (500.0, 50.0, 0.3))
loads = st.builds(
    LoadCase, forces, forces, forces, moments, moments, moments, offsets, offsets, offsets,
    st.sampled_from(LoadFrame),
)  # fmt: skip
seeds = st.integers(0, 2**32 - 1)


def robot(seed: int, load: LoadCase) -> tuple[Design, np.random.Generator]:
    rng = np.random.default_rng(seed)
    return replace(samples.random_design(rng), load=load), rng


def close(found: np.ndarray, expected: np.ndarray, relative: float) -> None:
    scale = max(np.abs(expected).max(), 1.0)
    assert np.abs(found - expected).max() <= relative * scale


def work(load: LoadCase, pose: np.ndarray, step: np.ndarray) -> np.ndarray:
    """Work of a load on a small step of the pose: force times the path of its own point.

    In complex numbers, so that a step of 1e-30 leaves no error of differences.
    """
    x, y, theta, z = np.moveaxis(pose + 1e-30j * step, -1, 0)
    c, s = np.cos(theta), np.sin(theta)
    px, py, pz = load.point
    point = np.stack([x + c * px - s * py, y + s * px + c * py, z + pz], axis=-1)
    force = np.broadcast_to(load.wrench[:3], point.shape).astype(complex)
    if load.frame is LoadFrame.PLATFORM:
        fx, fy, fz = load.wrench[:3]
        force = np.stack([c * fx - s * fy, s * fx + c * fy, fz + 0 * c], axis=-1)
    moment = load.moment_z * theta.imag / 1e-30
    return (force.real * point.imag / 1e-30).sum(axis=-1) + moment


@pytest.mark.slow
@given(load=loads, seed=seeds)
def test_torques_do_the_work_of_the_load(load: LoadCase, seed: int) -> None:
    """Virtual work by differences: what the actuators give is what the load takes."""
    design, rng = robot(seed, load)
    pose = samples.random_poses(rng, design, 10)
    torque = static_torques(design, pose) - static_torques(replace(design, load=NO_LOAD), pose)
    j = jacobian(design.geometry, pose)
    for actuator in range(4):
        step = j[..., actuator]
        close(torque[:, actuator], -work(load, pose, step), 1e-10)


@pytest.mark.slow
@given(load=loads, seed=seeds)
def test_torques_are_the_slope_of_the_potential_of_a_dead_load(load: LoadCase, seed: int) -> None:
    """By central differences along each actuator, without any Jacobian."""
    load = replace(load, frame=LoadFrame.WORLD)
    design, rng = robot(seed, load)
    geometry = design.geometry
    pose = samples.random_poses(rng, design, 5)
    torque = load_torques(geometry, load, pose)
    h = 1e-6

    def potential(at: np.ndarray) -> np.ndarray:
        c, s = np.cos(at[:, 2]), np.sin(at[:, 2])
        px, py, _ = load.point
        return -(
            load.force_x * (at[:, 0] + c * px - s * py)
            + load.force_y * (at[:, 1] + s * px + c * py)
            + load.force_z * at[:, 3]
            + load.moment_z * at[:, 2]
        )

    slope = np.empty((5, 4, 4))
    for axis, unit in enumerate(np.eye(4)):
        ends = (pose + h * unit, pose - h * unit)
        q = [inverse_kinematics(geometry, end).actuators for end in ends]
        slope[:, :, axis] = (q[0] - q[1]) / (2 * h)
    by_pose = np.stack(
        [(potential(pose + h * u) - potential(pose - h * u)) / (2 * h) for u in np.eye(4)], axis=-1
    )
    expected = np.linalg.solve(np.swapaxes(slope, 1, 2), by_pose[..., None])[..., 0]
    close(torque, expected, 1e-5)


@given(load=loads, seed=seeds)
def test_actuators_see_neither_horizontal_moments_nor_the_height_of_the_point(
    load: LoadCase, seed: int
) -> None:
    design, rng = robot(seed, load)
    states = samples.random_states(rng, design, 5)
    found = inverse_dynamics(design, *states)
    other = replace(load, moment_x=load.moment_x + 7.0, moment_y=-3.0, point_z=load.point_z + 0.4)
    same = inverse_dynamics(replace(design, load=other), *states)
    assert np.array_equal(found.torque, same.torque)
    assert np.array_equal(found.multipliers, same.multipliers)
    moved = center_wrench(other, states[0][:, 2]) - center_wrench(load, states[0][:, 2])
    assert np.abs(moved[:, [0, 1, 2, 5]]).max() == 0


@given(load=loads, seed=seeds)
def test_multipliers_carry_the_load_to_the_platform(load: LoadCase, seed: int) -> None:
    """Lagrange's first four equations: what a load adds to A^T lambda is its opposite."""
    design, rng = robot(seed, load)
    states = samples.random_states(rng, design, 5)
    actuators = inverse_kinematics(design.geometry, states[0]).actuators
    a = closure_matrix(design.geometry, states[0], actuators)[..., :4]
    bare = inverse_dynamics(replace(design, load=NO_LOAD), *states).multipliers
    change = inverse_dynamics(design, *states).multipliers - bare
    found = np.einsum("nij,ni->nj", a, change)
    close(found, -generalized_force(load, states[0][:, 2]), 1e-9)


def test_an_offset_of_a_vertical_force_loads_the_bearings() -> None:
    load = LoadCase(force_z=-100.0, point_x=0.1, point_y=-0.2)
    np.testing.assert_allclose(center_wrench(load, 0.0), [0, 0, -100, 20, 10, 0])
    np.testing.assert_allclose(generalized_force(load, 0.0), [0, 0, 0, -100])
    turned = replace(load, force_z=0.0, force_x=10.0, frame=LoadFrame.PLATFORM)
    np.testing.assert_allclose(center_wrench(turned, np.pi / 2)[:3], [0, 10, 0], atol=1e-14)
    np.testing.assert_allclose(center_wrench(turned, np.pi / 2)[5], 2.0)


@pytest.mark.slow
@given(load=loads, seed=seeds)
def test_every_way_to_a_torque_has_the_same_load(load: LoadCase, seed: int) -> None:
    design, rng = robot(seed, load)
    pose, velocity, acceleration = samples.random_states(rng, design, 10)
    extra = rng.normal(size=(10, 6)) * 50
    result = inverse_dynamics(design, pose, velocity, acceleration, load=extra)
    parts = torque_breakdown(design, pose, velocity, acceleration, load=extra)
    close(parts.total, result.torque, 1e-12)
    bare = replace(design, load=NO_LOAD)
    plain = inverse_dynamics(bare, pose, velocity, acceleration).torque
    against = load_torques(design.geometry, load, pose, extra)
    close(result.torque, plain + against, 1e-12)
    again = forward_dynamics(design, pose, velocity, result.torque, load=extra)
    close(again, acceleration, 1e-9)
    still = np.zeros_like(pose)
    close(static_torques(design, pose), inverse_dynamics(design, pose, still, still).torque, 1e-12)
    close(static_breakdown(design, pose).total, static_torques(design, pose), 1e-12)
    near = dict(zip("xy", pose[0, :2, None] + [0.0, 1e-3], strict=True))
    near["theta"] = pose[0, 2] + np.array([0.0, 0.01])
    for names in (("y", "theta"), ("theta", "x"), ("y", "theta", "x"), ("theta", "x", "y")):
        grid = Grid.over(pose[0], **{name: near[name] for name in names})
        field = solve_field(design.geometry, grid)
        expected = np.moveaxis(static_torques(design, grid.poses()), -1, 0)
        close(field.torques(design), expected, 1e-12)
        close(rotary_torques(design, grid), expected[:3], 1e-12)


@pytest.mark.parametrize("name", ["mujoco", "pinocchio"])
@pytest.mark.parametrize("seed", range(4))
def test_engines_push_the_platform_alike(name: str, seed: int) -> None:
    """MuJoCo by ``xfrc_applied``, Pinocchio by external forces: 1e-10 of the largest torque."""
    pytest.importorskip(name, reason=f"{name} comes with the extra 'verify'")
    from paminsa_viz.engines.mujoco_model import MujocoRobot
    from paminsa_viz.engines.pinocchio_model import PinocchioRobot

    rng = np.random.default_rng(seed)
    frame = list(LoadFrame)[seed % 2]
    load = LoadCase(*(rng.normal(size=9) * [200, 200, 200, 20, 20, 20, 0.1, 0.1, 0.1]), frame)
    design, rng = robot(seed, load)
    states = samples.random_states(rng, design, 50)
    extra = rng.normal(size=(50, 6)) * 30
    engine = (MujocoRobot if name == "mujoco" else PinocchioRobot)(design)
    for further in (None, extra):
        found = engine.inverse_dynamics(*states, load=further)
        expected = inverse_dynamics(design, *states, load=further).torque
        difference = np.abs(found - expected).max(axis=0) / np.abs(expected).max(axis=0)
        assert difference.max() < 1e-10
    close(engine.static_torques(states[0]), static_torques(design, states[0]), 1e-10)


def test_a_map_is_not_solved_again_when_the_load_changes(monkeypatch: pytest.MonkeyPatch) -> None:
    from paminsa_viz.model import grids

    field = solve_field(APPENDIX_4.geometry, Grid.over((0.0, 0.0, 0.1, -0.5), x=[0.0, 0.05]))
    field.torques(APPENDIX_4.vary({"load.force_x": 1.0}))
    monkeypatch.setattr(grids, "_evaluate", None)
    loaded = APPENDIX_4.vary({"load.force_x": 20.0, "load.point_y": 0.1, "load.moment_z": -3.0})
    close(field.torques(loaded).T, static_torques(loaded, field.grid.poses()), 1e-13)


def test_impossible_loads_are_refused() -> None:
    with pytest.raises(InvalidDesign, match=r"load\.frame"):
        LoadCase(frame="world")  # type: ignore[arg-type]
    pose = np.zeros((3, 4))
    for wrench in (np.zeros((2, 6)), np.zeros((3, 4)), "push"):
        with pytest.raises(InvalidInput, match="load"):
            inverse_dynamics(APPENDIX_4, pose, pose, pose, load=wrench)


@given(seed=seeds)
def test_no_load_changes_no_bit(seed: int) -> None:
    design, rng = robot(seed, NO_LOAD)
    states = samples.random_states(rng, design, 5)
    turned = replace(design, load=LoadCase(point_x=0.1, frame=LoadFrame.PLATFORM))
    found, same = inverse_dynamics(design, *states), inverse_dynamics(turned, *states)
    assert np.array_equal(found.torque, same.torque)
    none = inverse_dynamics(design, *states, load=np.zeros(6))
    assert np.array_equal(found.torque, none.torque)
