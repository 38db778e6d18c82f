"""The closed-form loci against the sign of a determinant, and distances to them by search."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.model import (
    APPENDIX_4,
    Geometry,
    check_reach,
    inverse_jacobian,
    inverse_kinematics,
    measure_singularity,
    singular_radius,
    singular_rotation,
)
from paminsa_viz.model.kinematics import LEG_AXES, wrap
from tests import oracle
from tests.support.cases import BY_HAND, Case, assert_within, cases


def rows_determinant(case: Case, pose: Any) -> Any:
    """det of the tangential speeds of joints 5 for x', y', theta' = 1 in turn, by complex steps."""
    g, angles = case.geometry, oracle.AXIS_ANGLES
    rows = []
    for step in np.eye(4)[:3]:
        q = np.asarray(pose) + 1e-30j * step
        dx, dy = (
            q[..., i, None]
            + g.platform_radius * of(q[..., 2, None] + angles)
            - g.base_radius * of(angles)
            for i, of in enumerate((np.cos, np.sin))
        )
        turning = (dx.real * dy.imag - dy.real * dx.imag) / 1e-30
        rows.append(turning / np.hypot(dx.real, dy.real))
    return np.linalg.det(np.stack(rows, axis=-1))


def anywhere(case: Case, n: int = 200) -> Any:
    """Poses on all sides of the loci, at a height that plays no part."""
    rng = np.random.default_rng(case.seed)
    rb = case.geometry.base_radius
    return np.stack(
        [
            rng.uniform(-1.2 * rb, 1.2 * rb, n),
            rng.uniform(-1.2 * rb, 1.2 * rb, n),
            rng.uniform(-np.pi, np.pi, n),
            np.full(n, -0.3),
        ],
        axis=-1,
    )


@given(case=cases())
def test_the_determinant_changes_sign_on_the_loci_and_nowhere_else(case: Case) -> None:
    g, pose = case.geometry, anywhere(case)
    det = rows_determinant(case, pose)
    inside = singular_radius(g, pose[:, 2]) - np.hypot(pose[:, 0], pose[:, 1])
    turn = singular_rotation(g) - np.abs(pose[:, 2])
    assert np.all(np.sign(det) == -np.sign(inside) * np.sign(turn))
    assert (det > 0).any()
    assert (det < 0).any()


@given(case=cases(), theta=st.floats(-3.1, 3.1), heading=st.floats(-np.pi, np.pi))
def test_crossing_the_circle(case: Case, theta: float, heading: float) -> None:
    """From just inside to just outside of the closed-form radius."""
    g = case.geometry
    radius = float(singular_radius(g, theta))
    assert radius**2 == pytest.approx(
        (g.base_radius - g.platform_radius * np.cos(theta)) ** 2
        + (g.platform_radius * np.sin(theta)) ** 2
    )
    r = radius * np.array([1 - 1e-7, 1 + 1e-7])
    pose = np.stack([r * np.cos(heading), r * np.sin(heading), 0 * r + theta, 0 * r - 0.3], -1)
    det = rows_determinant(case, pose)
    far = rows_determinant(case, pose[0] * [0.5, 0.5, 1, 1])
    if abs(abs(theta) - singular_rotation(g)) > 1e-3:
        assert det[0] * det[1] < 0
        assert np.abs(det).max() < 1e-3 * abs(far)


@given(case=cases(), x=st.floats(-0.5, 0.5), y=st.floats(-0.5, 0.5), side=st.sampled_from([-1, 1]))
def test_crossing_the_rotation(case: Case, x: float, y: float, side: int) -> None:
    g = case.geometry
    turn = singular_rotation(g)
    assert np.cos(turn) == pytest.approx(g.platform_radius / g.base_radius, rel=1e-12)
    assert 0 < turn < np.pi / 2
    theta = side * turn * np.array([1 - 1e-7, 1 + 1e-7])
    at = np.zeros(2)
    pose = np.stack([at + x * g.base_radius, at + y * g.base_radius, theta, at - 0.3], -1)
    det = rows_determinant(case, pose)
    assert det[0] * det[1] < 0


def test_the_rotation_of_appendix_4() -> None:
    assert np.degrees(singular_rotation(APPENDIX_4.geometry)) == pytest.approx(73.4, abs=0.05)
    assert singular_radius(APPENDIX_4.geometry, 0.0) == pytest.approx(0.25, rel=1e-15)
    wide = Geometry(platform_radius=0.36)
    assert np.isnan(singular_rotation(wide))


@given(case=cases())
def test_determinant_and_condition_at_poses_that_can_be_taken(case: Case) -> None:
    g, pose = case.geometry, case.poses(32)
    measured = measure_singularity(g, pose)
    exact = rows_determinant(case, pose)
    assert_within(measured.determinant, exact, 1e-12 * np.abs(exact).max())
    scaled = oracle.actuator_jacobian(case.design, pose)[..., :3, :3].copy()
    scaled[..., 2] /= g.platform_radius
    np.testing.assert_allclose(measured.condition, np.linalg.cond(scaled), rtol=1e-9)
    assert (measured.condition >= 1).all()


@given(case=cases(), heading=st.floats(-np.pi, np.pi), power=st.integers(2, 9))
def test_condition_close_to_the_circle(case: Case, heading: float, power: int) -> None:
    """Up to 1e9, as far as the singular value decomposition can follow."""
    g = case.geometry
    radius = float(singular_radius(g, 0.1)) * (1 - 10.0**-power)
    pose = np.array([radius * np.cos(heading), radius * np.sin(heading), 0.1, 0.0])
    pose[3] = -0.5 * g.coupler_length - g.platform_joint_height
    scaled = inverse_jacobian(g, pose)[:3, :3] / [1, 1, g.platform_radius]
    if check_reach(g, pose).ok:
        expected = np.linalg.cond(scaled)
        assert expected > 0.1 * 10**power
        measured = measure_singularity(g, pose)
        assert measured.condition == pytest.approx(expected, rel=1e-14 * 10**power + 1e-9)


def test_on_the_circle_the_condition_is_infinite() -> None:
    """Lengths that are exact in binary, so that the determinant is exactly zero."""
    g = Geometry(base_radius=0.5, platform_radius=0.25, crank_length=0.5, coupler_length=0.7)
    measured = measure_singularity(g, [[0.25, 0.0, 0.0, -0.5], [0.0, -0.25, 0.0, -0.5]])
    np.testing.assert_array_equal(measured.determinant, 0.0)
    np.testing.assert_array_equal(measured.condition, np.inf)
    np.testing.assert_array_equal(measured.position_distance, 0.0)
    np.testing.assert_array_equal(measured.rotation_distance, 0.0)
    at_turn = measure_singularity(g, [0.1, 0.1, singular_rotation(g), -0.5])
    assert at_turn.condition > 1e14
    assert abs(at_turn.rotation_distance) < 1e-15


@given(case=cases())
def test_distance_to_the_circle_by_search(case: Case) -> None:
    g, pose = case.geometry, anywhere(case, 50)
    around = np.linspace(-np.pi, np.pi, 4001)
    radius = np.hypot(
        g.base_radius - g.platform_radius * np.cos(pose[:, 2]),
        g.platform_radius * np.sin(pose[:, 2]),
    )
    circle = radius[:, None, None] * np.stack([np.cos(around), np.sin(around)], -1)
    nearest = np.linalg.norm(pose[:, None, :2] - circle, axis=-1).min(axis=-1)
    found = measure_singularity(g, pose).position_distance
    # the polygon of 4000 corners lies within radius * (step/2)^2/2 and half a step of the circle
    assert_within(np.abs(found), nearest, 1e-3 * g.base_radius)
    moved = pose.copy()
    moved[:, :2] *= (1 + found / np.hypot(pose[:, 0], pose[:, 1]))[:, None]
    assert_within(np.hypot(moved[:, 0], moved[:, 1]), radius, 1e-12)
    assert_within(measure_singularity(g, moved).position_distance, np.zeros(50), 1e-12)


@given(case=cases())
def test_distance_in_rotation_by_search(case: Case) -> None:
    """Every sign change of the determinant in a turn of the platform, by bisection."""
    g, pose = case.geometry, anywhere(case, 6)
    found = measure_singularity(g, pose).rotation_distance
    turn = np.linspace(-np.pi, np.pi, 1501)
    corner = singular_radius(g, singular_rotation(g))
    for one, distance in zip(pose, found, strict=True):
        if abs(np.hypot(one[0], one[1]) - corner) < 0.02 * g.base_radius:
            continue  # both loci in one step of the search

        def det(theta: Any, at: Any = one) -> Any:
            poses = np.broadcast_to(at, (*np.shape(theta), 4)).copy()
            poses[..., 2] = theta
            return rows_determinant(case, poses)

        values = det(turn)
        (crossings,) = np.nonzero(np.sign(values[1:]) != np.sign(values[:-1]))
        low, high = turn[crossings], turn[crossings + 1]
        for _ in range(40):
            middle = (low + high) / 2
            left = np.sign(det(middle)) == np.sign(values[crossings])
            low, high = np.where(left, middle, low), np.where(left, high, middle)
        assert len(low) in (2, 4)
        assert abs(distance) == pytest.approx(np.abs(wrap(low - one[2])).min(), abs=1e-7)
        inside = np.hypot(one[0], one[1]) < singular_radius(g, one[2])
        assert (distance > 0) == (inside and abs(one[2]) < singular_rotation(g))


@given(case=cases())
def test_serial_distance_is_the_room_to_stretch_fold_and_axis(case: Case) -> None:
    """The guide's stroke is no singularity, and a clearance moves no axis."""
    g, pose = case.geometry, case.poses(16)
    for geometry in (g, replace(g, axis_clearance=0.02, guide_stroke=10.0)):
        p = inverse_kinematics(geometry, pose).points
        span = np.linalg.norm(p[5] - p[8], axis=-1)
        near = np.linalg.norm(p[5][..., :2] - g.base_radius * LEG_AXES, axis=-1)
        room = np.minimum(g.crank_length + g.coupler_length - span, near)
        room = np.minimum(room, span - abs(g.crank_length - g.coupler_length))
        found = measure_singularity(geometry, pose).serial_distance
        assert_within(found, room.min(axis=-1), 1e-12)


@given(case=cases(), turns=st.integers(1, 2))
def test_measures_are_the_same_a_third_of_a_turn_on_and_mirrored(case: Case, turns: int) -> None:
    pose = case.poses(16)
    angle = 2 * np.pi / 3 * turns
    turned = pose.copy()
    turned[:, 0] = np.cos(angle) * pose[:, 0] - np.sin(angle) * pose[:, 1]
    turned[:, 1] = np.sin(angle) * pose[:, 0] + np.cos(angle) * pose[:, 1]
    mirrored = pose.copy()
    mirrored[:, 3] = -pose[:, 3] - 2 * case.geometry.platform_joint_height
    one = measure_singularity(case.geometry, pose)
    for other in (turned, mirrored):
        two = measure_singularity(case.geometry, other)
        for name in ("determinant", "condition", "position_distance", "rotation_distance"):
            np.testing.assert_allclose(
                getattr(two, name), getattr(one, name), rtol=1e-9, atol=1e-12, err_msg=name
            )
        assert_within(two.serial_distance, one.serial_distance, 1e-12)


def test_a_platform_larger_than_its_base() -> None:
    """No rotation is singular everywhere; the circle remains."""
    g = Geometry(platform_radius=0.45)
    pose = [[0.0, 0.0, 0.0, -0.5], [0.05, 0.0, 0.8, -0.5], [0.3, 0.0, 0.0, -0.5]]
    found = measure_singularity(g, pose)
    assert np.isfinite(found.determinant).all()
    np.testing.assert_array_equal(found.rotation_distance[0], np.inf)
    assert found.rotation_distance[2] < 0
    assert_within(found.position_distance[0], 0.1, 1e-15)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("coordinate", range(4))
def test_poses_that_are_not_finite(bad: float, coordinate: int) -> None:
    pose = BY_HAND.copy()
    pose[0, coordinate] = bad
    found = measure_singularity(APPENDIX_4.geometry, pose)
    assert np.isnan(found.determinant[0])
    assert np.isnan(found.condition[0])
    assert not np.isfinite(found.serial_distance[0]) or coordinate == 2
    if np.isnan(bad) and coordinate < 3:
        assert np.isnan(found.rotation_distance[0])
    for values in (found.determinant, found.condition, found.rotation_distance):
        assert np.isfinite(values[1:]).all()


def test_out_of_reach_there_is_no_condition_but_a_distance() -> None:
    found = measure_singularity(APPENDIX_4.geometry, [0.0, 0.0, 0.0, -2.0])
    assert np.isnan(found.determinant)
    assert np.isnan(found.condition)
    assert found.position_distance == pytest.approx(0.25)
    assert found.serial_distance < 0
