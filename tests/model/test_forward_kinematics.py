"""From actuators to poses: all of them, only them, and the one that continues a motion."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.model import (
    APPENDIX_4,
    Geometry,
    closure,
    forward_kinematics,
    inverse_kinematics,
    nearest_solution,
    singular_radius,
    singular_rotation,
)
from paminsa_viz.model.kinematic_formulas import Heading, closing_angles
from paminsa_viz.model.kinematics import HEADINGS, wrap
from paminsa_viz.model.leg import ROUNDING, mechanism
from tests import oracle
from tests.support.cases import BY_HAND, Case, assert_within, cases


def apart(a: Any, b: Any) -> Any:
    """Largest difference of poses (..., 4), angles taken on the circle."""
    difference = np.asarray(a) - b
    difference[..., 2] = wrap(difference[..., 2])
    return np.abs(difference).max(axis=-1)


@pytest.mark.slow
@given(case=cases())
def test_forward_after_inverse_finds_the_pose(case: Case) -> None:
    pose = case.poses(32)
    actuators = inverse_kinematics(case.geometry, pose).actuators
    found = forward_kinematics(case.geometry, actuators)
    assert found.pose.shape == (32, 2, 4)
    distance = np.where(found.ok, apart(found.pose, pose[:, None]), np.inf)
    assert distance.min(axis=-1).max() < 1e-11


@pytest.mark.slow
@given(case=cases())
def test_every_assembly_mode_found_has_these_actuators(case: Case) -> None:
    """Also for actuators that were not made from a pose: both closure and inverse agree."""
    rng = np.random.default_rng(case.seed)
    chosen = inverse_kinematics(case.geometry, case.poses(32)).actuators + rng.normal(
        0, 0.4, (32, 4)
    )
    found = forward_kinematics(case.geometry, chosen)
    exists = np.isfinite(found.pose).all(axis=-1)
    assert exists.any()
    assert np.all(exists | ~found.ok)
    assert np.isnan(found.pose[~exists]).all()
    # A pose can lie very far away, where leg lines are nearly parallel.
    size = 1 + np.hypot(found.pose[..., 0], found.pose[..., 1])
    residual = np.abs(closure(case.geometry, found.pose, chosen[:, None])).max(axis=-1) / size
    assert residual[exists].max() < 1e-12
    back = inverse_kinematics(case.geometry, found.pose[found.ok]).actuators
    wanted = np.broadcast_to(chosen[:, None], found.pose.shape)[found.ok]
    assert_within(wrap(back[:, :3] - wanted[:, :3]), np.zeros((len(back), 3)), 1e-9)
    assert_within(back[:, 3], wanted[:, 3], 1e-12)


@given(case=cases())
def test_an_assembly_mode_is_valid_where_all_legs_point_at_the_platform(case: Case) -> None:
    """The other solutions of Eq. 16 have a leg turned round, with joint 5 behind its axis."""
    rng = np.random.default_rng(case.seed)
    chosen = rng.uniform(-1, 1, (200, 4)) * rng.choice([0.3, np.pi], (200, 1))
    found = forward_kinematics(case.geometry, chosen)
    exists = np.isfinite(found.pose).all(axis=-1)
    p5 = inverse_kinematics(case.geometry, found.pose).points[5][..., :2]
    axes = np.stack([np.cos(oracle.AXIS_ANGLES), np.sin(oracle.AXIS_ANGLES)], -1)
    heading = chosen[:, None, :3] + HEADINGS
    ahead = np.stack([np.cos(heading), np.sin(heading)], -1)
    along = np.sum((p5 - case.geometry.base_radius * axes) * ahead, -1)
    np.testing.assert_array_equal(found.ok, exists & (along > 0).all(axis=-1))
    assert found.ok.any()
    assert (exists & ~found.ok).any()


def meetings(geometry: Geometry, actuators: Any) -> int:
    """How often in a turn of the platform its three leg lines meet in one point."""
    theta = np.linspace(-np.pi, np.pi, 20000, endpoint=False)
    beta = actuators[:3] + HEADINGS
    angle = theta[:, None] + oracle.AXIS_ANGLES
    across = (
        geometry.platform_radius * np.cos(angle) - geometry.base_radius * np.cos(oracle.AXIS_ANGLES)
    ) * np.sin(beta) - (
        geometry.platform_radius * np.sin(angle) - geometry.base_radius * np.sin(oracle.AXIS_ANGLES)
    ) * np.cos(beta)
    rows = np.broadcast_to(np.stack([np.sin(beta), -np.cos(beta)], -1), (len(theta), 3, 2))
    gap = np.linalg.det(np.concatenate([rows, across[..., None]], axis=-1))
    return int(np.sum(np.sign(gap) != np.sign(np.roll(gap, 1))))


@pytest.mark.slow
@given(case=cases())
def test_there_are_no_more_than_those_found(case: Case) -> None:
    """Counted by turning the platform through all angles."""
    rng = np.random.default_rng(case.seed)
    for chosen in rng.uniform(-np.pi, np.pi, (3, 4)):
        found = forward_kinematics(case.geometry, chosen)
        assert np.isfinite(found.pose).all(axis=-1).sum() == meetings(case.geometry, chosen)


def test_poses_of_appendix_4_by_hand() -> None:
    actuators = inverse_kinematics(APPENDIX_4.geometry, BY_HAND).actuators
    found = forward_kinematics(APPENDIX_4.geometry, actuators)
    assert found.ok.any(axis=-1).all()
    # At home the legs also point at the platform if it is turned by 180 degrees.
    z = BY_HAND[0, 3]
    home = found.pose[0][np.argsort(np.abs(found.pose[0, :, 2]))]
    assert apart(home, [[0.0, 0.0, 0.0, z], [0.0, 0.0, np.pi, z]]).max() < 1e-14
    assert found.ok[0].all()


@given(values=st.lists(st.sampled_from([np.nan, np.inf, -np.inf, 0.1]), min_size=4, max_size=4))
def test_actuators_that_are_not_finite_give_no_pose(values: list[float]) -> None:
    found = forward_kinematics(APPENDIX_4.geometry, values)
    assert found.ok.any() <= bool(np.isfinite(values).all())
    assert np.isfinite(found.pose).all(axis=-1).any() == np.isfinite(values).all()


@given(case=cases(), turns=st.integers(-2, 2))
def test_the_continued_pose_is_the_one_it_came_from(case: Case, turns: int) -> None:
    """Also after whole turns of the platform, whose count is kept."""
    pose = case.poses(16) + np.array([0.0, 0.0, 2 * np.pi * turns, 0.0])
    rng = np.random.default_rng(case.seed)
    actuators = inverse_kinematics(case.geometry, pose).actuators
    near = pose + 1e-3 * rng.normal(size=pose.shape)
    assert_within(nearest_solution(case.geometry, actuators, near), pose, 1e-11)


def test_the_nearer_of_two_assembly_modes_is_taken() -> None:
    geometry = APPENDIX_4.geometry
    actuators = inverse_kinematics(geometry, BY_HAND).actuators
    found = forward_kinematics(geometry, actuators)
    for q, poses, valid in zip(actuators, found.pose, found.ok, strict=True):
        for pose in poses[valid]:
            assert apart(nearest_solution(geometry, q, pose), pose) < 1e-12


@given(case=cases(), power=st.integers(6, 16), side=st.sampled_from([-1, 1]))
def test_double_roots_are_found(case: Case, power: int, side: int) -> None:
    """Where a quadratic loses half of the digits, but not its roots."""
    g, rng = case.geometry, np.random.default_rng(case.seed)
    theta = side * singular_rotation(g) + 10.0**-power * rng.uniform(-1, 1, 400)
    x, y = rng.uniform(-0.5, 0.5, (2, 400)) * g.base_radius
    pose = np.stack([x, y, theta, np.full(400, -0.3)], -1)
    actuators = inverse_kinematics(g, pose).actuators
    found = forward_kinematics(g, actuators)
    assert found.ok.any(axis=-1).all()
    assert_within(nearest_solution(g, actuators, pose), pose, 1e-6)


@given(case=cases(), theta=st.floats(-1.0, 1.0), heading=st.floats(-np.pi, np.pi))
def test_no_isolated_pose_where_the_platform_moves_with_locked_actuators(
    case: Case, theta: float, heading: float
) -> None:
    """On the singular circle leg lines meet and follow at -120 degrees; parallel lines slide."""
    g = case.geometry
    radius = singular_radius(g, theta)
    pose = np.array([radius * np.cos(heading), radius * np.sin(heading), theta, -0.3])
    parallel = np.append(wrap(heading - HEADINGS), 0.3)
    for actuators in (inverse_kinematics(g, pose).actuators, parallel):
        found = forward_kinematics(g, actuators)
        assert np.isnan(found.pose).all()
        assert not found.ok.any()
        assert np.isnan(nearest_solution(g, actuators, pose)).all()


def test_where_leg_lines_are_parallel_and_where_both_modes_meet() -> None:
    """The ends of what rounding leaves open, of headings at which all numbers are exact."""

    def half_angle(radii: float, length: float = 1.0) -> Any:
        m = mechanism(Geometry(base_radius=0.5, platform_radius=0.5))._replace(
            base_radius=radii, platform_radius=1.0
        )
        along = Heading(0.0, 0.0, 0.0, 1.0), Heading(0.0, 1.0, 0.0, 0.0)
        with np.errstate(invalid="ignore"):
            return closing_angles(m, *along, Heading(length, 0.0, 0.0, 0.0)).half_c

    for length in (0.5, 1.0, 2.0):
        last = 1.0 + 4 * ROUNDING / length  # R_b/R_pl at which both modes meet, but for rounding
        assert half_angle(1.0, length) == half_angle(last, length) == 1.0
        assert np.isnan(half_angle(np.nextafter(last, 2.0), length))
    assert half_angle(0.75) == 0.75
    assert np.isnan(half_angle(0.5, 1e-12))
    assert half_angle(0.5, np.nextafter(1e-12, 1.0)) == 0.5


def test_the_only_valid_mode_is_the_nearest_from_anywhere() -> None:
    """With a platform larger than its base, at which legs of one mode may point away from it."""
    rng, g = np.random.default_rng(2), Geometry(platform_radius=0.4)
    chosen = np.append(rng.uniform(-1.5, 1.5, (200, 3)), np.full((200, 1), 0.3), axis=1)
    found = forward_kinematics(g, chosen)
    one = found.ok.sum(axis=1) == 1
    assert one.sum() > 5
    nearest = nearest_solution(g, chosen[one], [9.0, -9.0, 0.0, 0.0])
    assert_within(nearest, found.pose[found.ok & one[:, None]], 1e-12)
