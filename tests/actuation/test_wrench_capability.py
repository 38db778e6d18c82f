"""Capability of a pose against linear programs, pycapacity, MuJoCo, and sampled directions."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import linprog

from paminsa_viz.actuation.polytope import _point_inside, wrench_polytope
from paminsa_viz.actuation.wrench_capability import (
    DEFAULT_LIMITS,
    TRANSMISSION,
    _least,
    actuator_limits,
    capability,
    field_capability,
    transmission_indices,
)
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model import (
    APPENDIX_4,
    Design,
    Grid,
    LoadCase,
    actuator_velocity,
    backend,
    inverse_dynamics,
    inverse_kinematics,
    jacobian,
    singular_rotation,
    solve_field,
    static_torques,
)
from paminsa_viz.model.drive import Drive
from paminsa_viz.model.leg import mechanism
from paminsa_viz.trajectory import PRESETS, analyze
from tests.support import samples

LOAD = LoadCase(12.0, -7.0, -30.0, moment_z=1.5, point_x=0.04)
SERVO = Drive("servo", gear_ratio=100.0, rated_torque=0.3, peak_torque=0.9, top_speed=400.0)
SCREW = Drive(
    "axis", transmission="screw", lead=0.01, rated_torque=2.0, peak_torque=5.0, top_speed=300.0
)
DRIVEN = replace(APPENDIX_4, drives=(SERVO, SERVO, SERVO, SCREW), load=LOAD)
DESIGNS = pytest.mark.parametrize("design", [APPENDIX_4, DRIVEN], ids=["default", "driven"])
seeds = st.integers(0, 2**32 - 1)


def poses(seed: int, count: int) -> np.ndarray:
    """Poses about home, where the default limits hold the robot."""
    drawn = np.random.default_rng(seed).uniform(-1, 1, (count, 4))
    return np.array([0, 0, 0, -0.55]) + drawn * [0.08, 0.08, 0.4, 0.1]


@pytest.mark.slow
@DESIGNS
def test_support_of_the_polytope_is_that_of_a_linear_program(design: Design) -> None:
    """In 60 random directions: max n.w with |tau_0 - J^T w| <= T."""
    rng = np.random.default_rng(1)
    for pose in poses(2, 4):
        found = wrench_polytope(design, pose)
        j = jacobian(design.geometry, pose)[:3, :3]
        torque = static_torques(design, pose)[:3]
        limits = actuator_limits(design).rated[:3]
        a = np.concatenate([-j.T, j.T])
        b = np.concatenate([limits - torque, limits + torque])
        for n in rng.normal(size=(15, 3)):
            best = linprog(-n, A_ub=a, b_ub=b, bounds=[(None, None)] * 3)
            support = (found.vertices @ n).max()
            assert support == pytest.approx(-best.fun, rel=1e-9)
        normals, distances = found.normals
        scaled = found.vertices / [1, 1, found.length]
        assert (scaled @ normals.T - distances).max() < 1e-9 * np.abs(scaled).max()


def test_corners_are_those_of_pycapacity() -> None:
    robot = pytest.importorskip("pycapacity.robot", reason="pycapacity is not installed")
    for pose in poses(3, 10):
        found = wrench_polytope(DRIVEN, pose)
        # forces that the robot exerts: |J^T f + tau_0| <= T, the opposite of what it holds
        limits = found.limits
        other = robot.force_polytope(
            found.rows, limits[:, None], -limits[:, None], found.torque[:, None]
        )
        mine, theirs = -found.vertices, np.asarray(other.vertices).T
        for corner in mine:
            assert np.abs(theirs - corner).max(axis=1).min() < 1e-9 * np.abs(mine).max()


@DESIGNS
def test_disc_is_the_largest_in_the_force_polygon(design: Design) -> None:
    for pose in poses(4, 5):
        found, at = wrench_polytope(design, pose), capability(design, pose)
        polygon = found.section()
        edges = np.roll(polygon, -1, axis=0) - polygon
        distance = np.abs(edges[:, 0] * polygon[:, 1] - edges[:, 1] * polygon[:, 0])
        distance /= np.linalg.norm(edges, axis=1)
        assert at.horizontal_force == pytest.approx(distance.min(), rel=1e-9)
        index, sign = at.horizontal_limit
        assert sign in (-1, 1)
        nearest = found.sectors[int(np.argmin(distance))]
        assert nearest == f"M{index + 1} at {'+' if sign > 0 else '−'}T"
        j, limits = found.rows, found.limits
        for k, name in enumerate(found.sectors):  # all along a side its actuator is at its limit
            for share in (0.0, 0.4, 1.0):
                force = (1 - share) * polygon[k] + share * polygon[(k + 1) % len(polygon)]
                use = (found.torque - j[0] * force[0] - j[1] * force[1]) / limits
                assert use[int(name[1]) - 1] == pytest.approx(1.0 if "+" in name else -1.0)
        for corner in polygon:  # two actuators at their limits in every corner
            use = np.sort(np.abs(found.torque - j[0] * corner[0] - j[1] * corner[1]) / limits)
            np.testing.assert_allclose(use[1:], 1.0, rtol=1e-8)
            assert use[0] <= 1 + 1e-8


@DESIGNS
def test_faces_are_where_their_actuator_is_at_its_limit(design: Design) -> None:
    for pose in poses(6, 3):
        found = wrench_polytope(design, pose)
        np.testing.assert_allclose(found.rows.T @ found.center, found.torque, atol=1e-9)
        left = (found.torque[:, None] - found.rows.T @ found.vertices.T) / found.limits[:, None]
        np.testing.assert_allclose(left.T, list(product((-1.0, 1.0), repeat=3)))
        normals, distances = found.normals
        at = found.vertices / [1.0, 1.0, found.length] @ normals.T
        for face, name in enumerate(found.faces):
            on = np.isclose(at[:, face], distances[face], rtol=1e-9)
            sign = 1.0 if "+" in name else -1.0
            np.testing.assert_array_equal(on, left[int(name[1]) - 1] * sign > 0)
        assert found.holds
        assert distances[found.limiting_face] == distances.min() > 0
        most = np.abs(found.vertices[:, 2]).max()
        for moment in (-0.1 * most, 0.1 * most):
            polygon = found.section(moment)
            wrenches = np.column_stack([polygon, np.full(len(polygon), moment)])
            use = np.abs(found.torque - wrenches @ found.rows) / found.limits
            assert len(polygon) > 2
            np.testing.assert_allclose(np.sort(use)[:, 1:], 1.0, rtol=1e-8)
        assert found.section(1.01 * most).shape == (0, 2)


def test_a_robot_that_does_not_hold_itself_has_zero_outside() -> None:
    pose, weak = poses(7, 1)[0], replace(SERVO, rated_torque=1e-3)
    torque = np.abs(static_torques(DRIVEN, pose)[:3])
    found = wrench_polytope(replace(DRIVEN, drives=(weak, weak, weak, SCREW)), pose)
    assert (torque > found.limits).any()
    assert not found.holds
    assert found.normals[1].min() < 0
    just = replace(found, limits=np.abs(found.torque))
    assert just.holds
    assert replace(just, torque=-found.torque).holds
    for actuator in range(3):
        less = just.limits.copy()
        less[actuator] *= 1 - 1e-12
        for torque in (found.torque, -found.torque):
            assert not replace(just, torque=torque, limits=less).holds


def test_sides_of_a_polygon_far_from_zero_have_their_own_actuators() -> None:
    """Of a robot that is far from holding itself; all along a side its actuator is at its limit."""
    found = wrench_polytope(DRIVEN, poses(9, 1)[0])
    shifted = found.torque + found.rows[:2].T @ [4000.0, -2500.0]
    found = replace(found, torque=shifted, limits=found.limits * [1.0, 0.6, 1.7])
    polygon = found.section()
    assert len(polygon) == len(found.sectors) > 3
    for k, name in enumerate(found.sectors):
        for force in (polygon[k], polygon[(k + 1) % len(polygon)]):
            use = (found.torque - found.rows[:2].T @ force) / found.limits
            assert use[int(name[1]) - 1] == pytest.approx(1.0 if "+" in name else -1.0, rel=1e-6)


def test_a_disc_in_half_planes_needs_bounds_that_are_lines() -> None:
    """The largest disc in a square; none where a bound is no line, or is not finite."""
    square = np.array([[1.0, 0.0, -3.0], [-1.0, 0.0, 1.0], [0.0, 2.0, -2.0], [0.0, -2.0, -2.0]])
    assert _point_inside(square) == pytest.approx([2.0, 0.0], abs=1e-9)
    small = square * [1.0, 1.0, 1e-3]
    assert _point_inside(small) == pytest.approx([2e-3, 0.0], abs=1e-9)
    assert _point_inside(np.concatenate([square, [[-1.0, 0.0, 3.1]]])) is None  # x >= 3.1 as well
    for place, value in (((1, 2), -np.inf), ((1, 2), np.nan), ((0, 0), 0.0), ((0, 2), 1.0)):
        broken = square.copy()
        broken[place] = value
        assert _point_inside(broken) is None


@pytest.mark.slow
def test_capability_is_where_pushing_in_mujoco_meets_a_limit() -> None:
    from paminsa_viz.engines.mujoco_model import MujocoRobot

    pose = poses(5, 1)[0]
    design = replace(DRIVEN, load=replace(LOAD, point_x=0.0))  # pushed at the center
    robot, at, found = MujocoRobot(design), capability(design, pose), wrench_polytope(design, pose)
    limits = at.limits.rated
    still = np.zeros((1, 4))

    def use(wrench: np.ndarray) -> float:
        torque = robot.inverse_dynamics(pose[None], still, still, load=wrench)[0]
        return float((np.abs(torque) / limits).max())

    def pushed(direction: np.ndarray) -> float:
        """How far a wrench in a direction can grow until an actuator is at its limit."""
        low, high = 0.0, 1.0
        while use(high * direction) < 1:
            high *= 2
        for _ in range(36):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if use(middle * direction) < 1 else (low, middle)
        return low

    normals, distances = found.normals
    reached = []
    for angle in np.linspace(0, 2 * np.pi, 5, endpoint=False):
        direction = np.array([np.cos(angle), np.sin(angle), 0.0])
        along = normals @ direction
        expected = (distances[along > 0] / along[along > 0]).min()
        reached.append(pushed(direction[[0, 1, 2]] @ np.eye(3, 6)))
        assert reached[-1] == pytest.approx(expected, rel=1e-9)
    assert at.horizontal_force <= min(reached) * (1 + 1e-9)
    up, down = pushed(np.eye(6)[2]), pushed(-np.eye(6)[2])
    assert at.vertical_force == pytest.approx(min(up, down), rel=1e-9)
    turned = pushed(np.eye(6)[5]), pushed(-np.eye(6)[5])
    assert at.moment == pytest.approx(min(turned), rel=1e-9)


@pytest.mark.slow
@given(seed=seeds)
def test_payload_brings_m4_to_its_limit_and_no_other(seed: int) -> None:
    pose = poses(seed, 1)[0]
    most = float(capability(DRIVEN, pose).payload)
    heavier = DRIVEN.vary({"payload.mass": most + 10.0})
    assert capability(heavier, pose).payload == pytest.approx(most, rel=1e-9)
    loaded = DRIVEN.vary({"payload.mass": most})
    torque = static_torques(loaded, pose)
    assert torque[3] == pytest.approx(capability(DRIVEN, pose).limits.rated[3], rel=1e-12)
    assert capability(loaded, pose).payload == pytest.approx(most, rel=1e-9)
    np.testing.assert_allclose(torque[:3], static_torques(DRIVEN, pose)[:3], rtol=1e-12)


SLOW = replace(SCREW, lead=1e-3, top_speed=100.0, rated_torque=0.1, peak_torque=0.11)
"""An axis that limits speed and acceleration before M1 to M3 do."""


@DESIGNS
def test_inertia_is_what_each_acceleration_adds_to_the_torques(design: Design) -> None:
    smooth, batch, rest = design.without_friction(), poses(9, 5), np.zeros((5, 4))
    still = inverse_dynamics(smooth, batch, rest, rest).torque
    for axis, unit in enumerate(np.eye(4)):
        added = inverse_dynamics(smooth, batch, rest, rest + unit).torque - still
        np.testing.assert_allclose(
            capability(design, batch).inertia[..., axis], added, rtol=1e-9, atol=1e-9
        )


@pytest.mark.parametrize("axis", [SCREW, SLOW], ids=["fast axis", "slow axis"])
def test_speed_and_acceleration_just_reach_a_limit_in_the_worst_direction(axis: Drive) -> None:
    """That of an actuator is along what unit velocities and accelerations ask of it."""
    batch = poses(10, 20)
    robot = replace(DRIVEN, drives=(SERVO, SERVO, SERVO, axis))
    at, smooth, rest = capability(robot, batch), robot.without_friction(), np.zeros((20, 4))
    still = inverse_dynamics(smooth, batch, rest, rest).torque
    rates, torques = (
        np.stack([found(rest + unit) for unit in np.eye(4)], axis=-1)
        for found in (
            lambda velocity: actuator_velocity(robot, batch, velocity),
            lambda growth: inverse_dynamics(smooth, batch, rest, growth).torque - still,
        )
    )
    room = at.limits.peak - np.abs(still)
    assert (room > 0).all()
    first = set()
    for most, slopes, limit in (
        (at.speed, rates[..., [0, 1, 3]], at.limits.speed),
        (at.turn_speed, rates[..., [2]], at.limits.speed),
        (at.acceleration, torques[..., [0, 1, 3]], room),
        (at.turn_acceleration, torques[..., [2]], room),
    ):
        size = np.linalg.norm(slopes, axis=-1, keepdims=True)
        directions = slopes / np.maximum(size, 1e-12)
        used = np.abs(np.einsum("pjd,pid->pij", slopes, directions)).max(axis=1)
        share = used * most[:, None] / limit
        np.testing.assert_allclose(share.max(axis=1), 1.0, rtol=1e-9)
        first |= set(share.argmax(axis=1).tolist())
    assert first >= ({0, 1, 2} if axis is SCREW else {3})


def test_a_robot_that_cannot_hold_itself_can_hold_nothing() -> None:
    weak = replace(SERVO, rated_torque=1e-3, peak_torque=1e-3)
    lift = replace(weak, transmission="screw", lead=0.01)
    pose = (0.05, 0.02, 0.2, -0.5)
    for drives in ((weak, weak, weak, None), (None, None, None, lift)):
        design = replace(APPENDIX_4, drives=drives)
        at = capability(design, pose)
        values = (at.horizontal_force, at.vertical_force, at.payload, at.moment)
        assert values == (0, 0, 0, 0)
        assert (at.acceleration, at.turn_acceleration) == (0, 0)
        assert at.speed > 0
        assert wrench_polytope(design, pose).holds == (drives[0] is None)


def test_a_drive_without_any_room_left_still_holds() -> None:
    pose = (0.05, 0.02, 0.2, -0.5)
    at = capability(DRIVEN, pose)
    for actuator in range(3):
        rated = at.limits.rated.copy()
        rated[actuator] = abs(at.torque[actuator])
        full = replace(at, limits=at.limits._replace(rated=rated))
        assert full.room[actuator] == 0.0
        assert (full.horizontal_force, full.moment) == (0.0, 0.0)
        assert full.vertical_force == at.vertical_force > 0
        assert full.payload == at.payload > 0
        rated[actuator] *= 1 - 1e-12
        assert (full.vertical_force, full.payload) == (0.0, 0.0)


def test_capability_of_a_batch_is_that_of_its_poses() -> None:
    batch = poses(6, 6)
    apart = [capability(DRIVEN, pose) for pose in batch]
    for shape in ((6,), (2, 3), (3, 1, 2)):
        at = capability(DRIVEN, batch.reshape(*shape, 4))
        for name in (
            "payload", "horizontal_force", "vertical_force", "moment", "speed", "turn_speed",
            "acceleration", "turn_acceleration", "inertia",
        ):  # fmt: skip
            found, alone = getattr(at, name), np.array([getattr(one, name) for one in apart])
            np.testing.assert_allclose(found, alone.reshape(*shape, *alone.shape[1:]), rtol=1e-9)
        np.testing.assert_allclose(
            np.moveaxis(at.room, 0, -1).reshape(6, 4), [one.room for one in apart], rtol=1e-9
        )


def test_what_does_not_move_an_actuator_is_not_limited_by_it() -> None:
    """Unless it has no room: room over size along an axis, where the size is not zero."""
    room = np.array([[4.0, 4.0, 4.0, 0.0, -2.0], [9.0, 1.0, 9.0, 5.0, 5.0]])
    size = np.array([[2.0, 2.0, 0.0, 0.0, 0.0], [0.5, 0.5, 3.0, 0.0, 1.0]])
    expected = [2.0, 2.0, 3.0, np.inf, -2.0]
    np.testing.assert_array_equal(_least(room, size), expected)
    np.testing.assert_array_equal(_least(room.T, size.T, axis=1), expected)
    np.testing.assert_array_equal(_least(np.array([[np.nan]]), np.ones((1, 1))), [np.nan])


def test_at_a_singular_pose_nothing_is_known_also_what_m4_alone_decides() -> None:
    """The platform as large as the base and not turned; beside it, all is finite."""
    design = DRIVEN.vary({"geometry.platform_radius": DRIVEN.geometry.base_radius})
    at = capability(design, [(0.05, 0.0, 0.0, -0.55), (0.05, 0.0, 0.3, -0.55)])
    assert np.isfinite(at.torque[3]).all()
    assert not np.isfinite(at.torque[:3, 0]).any()
    for values in (at.payload, at.vertical_force, at.speed, at.turn_speed, at.moment):
        assert np.isnan(values).tolist() == [True, False]


def test_limits_are_the_drives_or_the_default() -> None:
    limits = actuator_limits(APPENDIX_4)
    assert limits.rated.tolist() == [own.rated for own in DEFAULT_LIMITS]
    assert limits.speed.tolist() == [own.speed for own in DEFAULT_LIMITS]
    driven = actuator_limits(DRIVEN)
    np.testing.assert_allclose(driven.rated[:3], 30.0)
    np.testing.assert_allclose(driven.peak[:3], 90.0)
    np.testing.assert_allclose(driven.speed[:3], 4.0)
    one = replace(APPENDIX_4, drives=(Drive(rated_torque=0.5, gear_ratio=10.0), None, None, None))
    assert actuator_limits(one).peak[0] == actuator_limits(one).rated[0] == 5.0
    for drive in (Drive(peak_torque=0.5), Drive(rated_torque=0.5)):
        limits = actuator_limits(replace(APPENDIX_4, drives=(drive, None, None, None)))
        assert limits.peak[0] == limits.rated[0] == 0.5
    assert actuator_limits(one).rated[1] == DEFAULT_LIMITS[1].rated


@pytest.mark.slow
def test_default_limits_are_above_what_presets_require_as_stated() -> None:
    found = [analyze(APPENDIX_4, one.build(APPENDIX_4).sample()) for one in PRESETS]
    torque = np.max([np.abs(one.torque).max(axis=0) for one in found], axis=0)
    speed = np.max([np.abs(one.solved.speed).max(axis=0) for one in found], axis=0)
    required = (torque[:3].max(), speed[:3].max(), torque[3], speed[3])
    np.testing.assert_allclose(required, (5.5, 2.7, 290.0, 0.16), rtol=0.03)
    limits = actuator_limits(APPENDIX_4)
    assert (torque < limits.rated).all()
    assert (speed < limits.speed).all()


def test_a_map_has_the_same_capability_as_its_poses() -> None:
    grid = Grid.over((0.0, 0.0, 0.1, -0.5), y=np.linspace(-0.1, 0.1, 5), x=[-0.05, 0.9, 0.1])
    field = solve_field(DRIVEN.geometry, grid)
    over, at = field_capability(field, DRIVEN), capability(DRIVEN, grid.poses())
    for name in (
        "payload", "horizontal_force", "vertical_force", "moment", "speed", "turn_speed",
        "acceleration", "turn_acceleration",
    ):  # fmt: skip
        np.testing.assert_allclose(getattr(over, name), getattr(at, name), rtol=1e-9)
        assert np.isnan(getattr(over, name)[:, 1]).all()  # out of reach
    assert np.isfinite(over.speed[:, 0]).all()


@given(seed=seeds)
def test_transmission_index_is_the_cosine_between_force_and_motion(seed: int) -> None:
    """Force across the leg's plane, motion about where the two other lines of force meet."""
    rng = np.random.default_rng(seed)
    design = samples.random_design(rng)
    pose = samples.random_poses(rng, design, 1)
    (index,) = backend.over_list(TRANSMISSION, mechanism(design.geometry), pose)
    assert index.shape == (3,)
    configuration = inverse_kinematics(design.geometry, pose[0])
    points = configuration.points[5][:, :2]
    across = np.stack([-np.sin(configuration.beta), np.cos(configuration.beta)], axis=-1)
    for leg in range(3):
        others = [other for other in range(3) if other != leg]
        # lines of force: point + s across
        a, b = (points[i] for i in others)
        u, w = (across[i] for i in others)
        s = np.linalg.solve(np.stack([u, -w], axis=-1), b - a)[0]
        lever = points[leg] - (a + s * u)
        motion = np.array([-lever[1], lever[0]]) / np.linalg.norm(lever)
        assert index[leg] == pytest.approx(abs(motion @ across[leg]), rel=1e-9)
    assert (index > 0).all()
    assert (index <= 1 + 1e-12).all()


def test_transmission_vanishes_at_a_singularity() -> None:
    m = mechanism(APPENDIX_4.geometry)
    theta = np.arccos(0.1 / 0.35)
    near = transmission_indices(m, 0.05, 0.02, np.cos(theta - 1e-6), np.sin(theta - 1e-6), -0.5)
    assert max(near) < 1e-4


def test_poses_without_a_polytope_are_refused() -> None:
    fold = singular_rotation(APPENDIX_4)
    for pose, problem in (
        ((0.0, 0.0, 0.0, -3.0), "is needed; out of reach: leg 1 over-stretched"),
        ((0.0, 0.0, fold, -0.5), "is needed; it is singular"),
        ((np.nan,) * 4, "is needed; out of reach"),
        (np.zeros((2, 4)), r"one pose \(4,\) is needed; got \(2, 4\)"),
    ):
        with pytest.raises(InvalidInput, match=f"pose: .*{problem}"):
            wrench_polytope(APPENDIX_4, pose)
