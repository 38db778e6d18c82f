"""The closed-form loci against the sign of a determinant, distances to them, and rounding."""

from __future__ import annotations

import contextlib
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.model import (
    APPENDIX_4,
    Geometry,
    Grid,
    Limit,
    check_reach,
    inverse_dynamics,
    inverse_jacobian,
    inverse_kinematics,
    measure_singularity,
    rotary_torques,
    singular_radius,
    singular_rotation,
    solve_field,
    static_breakdown,
    static_torques,
)
from paminsa_viz.model.backend import compile_now, use_numpy
from paminsa_viz.model.kinematics import LEG_AXES, wrap
from paminsa_viz.model.leg import ROUNDING, SINGULAR, Mechanism, mechanism_of_lengths
from paminsa_viz.model.measures import _largest_eigenvalue
from paminsa_viz.model.robot import platform_determinant
from tests import oracle
from tests.support.cases import Case, assert_within, cases


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


def test_the_rotation_of_appendix_4() -> None:
    assert np.degrees(singular_rotation(APPENDIX_4.geometry)) == pytest.approx(73.4, abs=0.05)
    assert singular_radius(APPENDIX_4.geometry, 0.0) == pytest.approx(0.25, rel=1e-15)
    wide = Geometry(platform_radius=0.36)
    assert np.isnan(singular_rotation(wide))


@pytest.mark.slow
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


@pytest.mark.slow
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


def test_a_platform_larger_than_its_base() -> None:
    """No rotation is singular everywhere; the circle remains."""
    g = Geometry(platform_radius=0.45)
    pose = [[0.0, 0.0, 0.0, -0.5], [0.05, 0.0, 0.8, -0.5], [0.3, 0.0, 0.0, -0.5]]
    found = measure_singularity(g, pose)
    assert np.isfinite(found.determinant).all()
    np.testing.assert_array_equal(found.rotation_distance[0], np.inf)
    assert found.rotation_distance[2] < 0
    assert_within(found.position_distance[0], 0.1, 1e-15)


def on_the_circle(g: Geometry, rng: np.random.Generator, off: float, n: int = 400) -> Any:
    theta, heading = rng.uniform(-3.1, 3.1, n), rng.uniform(-np.pi, np.pi, n)
    radius = singular_radius(g, theta) + off
    return np.stack([radius * np.cos(heading), radius * np.sin(heading), theta, low(g, n)], -1)


def at_the_rotation(g: Geometry, rng: np.random.Generator, off: float, n: int = 400) -> Any:
    x, y = rng.uniform(-0.5, 0.5, (2, n)) * g.base_radius
    theta = (singular_rotation(g) + off) * rng.choice([-1, 1], n)
    return np.stack([x, y, theta, low(g, n)], -1)


def stretched(g: Geometry, rng: np.random.Generator, off: float, n: int = 400) -> Any:
    x, y, theta = rng.uniform(-0.3, 0.3, (3, n)) * [[g.base_radius], [g.base_radius], [1.0]]
    pose = np.stack([x, y, theta, low(g, n)], -1)
    points = inverse_kinematics(g, pose).points
    rho = np.linalg.norm((points[5] - points[3])[..., :2], axis=-1).max(axis=-1)
    height = (g.crank_length + g.coupler_length - off) ** 2 - (g.span_ratio * rho) ** 2
    pose[:, 3] = -np.sqrt(height) - g.platform_joint_height
    return pose


def on_a_leg_axis(g: Geometry, rng: np.random.Generator, off: float, n: int = 400) -> Any:
    theta, heading = rng.uniform(-1.0, 1.0, n), rng.uniform(-np.pi, np.pi, n)
    angle = oracle.AXIS_ANGLES[rng.integers(0, 3, n)]
    x, y = (
        g.base_radius * of(angle) - g.platform_radius * of(angle + theta) + off * of(heading)
        for of in (np.cos, np.sin)
    )
    return np.stack([x, y, theta, low(g, n)], -1)


def low(g: Geometry, n: int) -> Any:
    return np.full(n, -0.6 * (g.crank_length + g.coupler_length))


@pytest.mark.slow
@pytest.mark.parametrize("compiled", [False, True], ids=["arrays", "kernels"])
@pytest.mark.parametrize(
    ("draw", "limit"),
    [
        (on_the_circle, Limit.SINGULAR),
        (at_the_rotation, Limit.SINGULAR),
        (stretched, Limit.STRETCHED),
        (on_a_leg_axis, Limit.AXIS),
    ],
)
@given(case=cases())
def test_a_pose_is_singular_where_rounding_decides(compiled, draw, limit, case: Case) -> None:
    """No torque at computed singular poses of either type; torques again 1e-6 m or rad away.

    However they were computed: also as much off as the roundings of some other formula.
    """
    g, rng = case.geometry, np.random.default_rng(case.seed)
    # bars and guides long enough for all of both loci
    bars = {"crank_length": 10 * g.crank_length, "coupler_length": 10 * g.coupler_length}
    g = replace(g, **bars, guide_stroke=50.0)
    design = replace(case.design, geometry=g)
    if compiled:
        compile_now()
    with contextlib.nullcontext() if compiled else use_numpy():
        for off in (0.0, 1e-6):
            pose = draw(g, rng, off)
            if off == 0.0:
                assert len(pose) == 400
                pose[100:200, 2] += 2 * np.pi * rng.integers(-30, 30, 100)
                pose[200:] += rng.integers(-100, 100, (200, 4)) * np.spacing(np.abs(pose[200:]))
            result = inverse_dynamics(design, pose, np.full(4, 0.3), np.full(4, -0.7))
            measured = measure_singularity(g, pose)
            field = solve_field(g, Grid.over(pose[0], x=pose[:1, 0]))
            assert field.status == result.status[0]
            if off == 0.0:
                assert (result.status == limit).all()
                assert not np.isfinite(static_torques(design, pose)[:, :3]).any()
                assert not np.isfinite(static_breakdown(design, pose).per_leg[:, :3]).any()
                assert not np.isfinite(rotary_torques(design, Grid.over(pose[0]))).any()
                assert np.isnan(result.torque).all()
                assert not np.isfinite(measured.condition).any()
            else:
                ok = result.status == Limit.OK
                assert ok.all()
                assert np.isfinite(result.torque).all()
                assert np.isfinite(measured.condition).all()


def test_what_counts_as_singular_ends_at_the_documented_shares_of_lengths() -> None:
    """Of numbers that are exact in binary: at the end itself a pose is singular, beyond it not."""
    assert 16 * np.finfo(float).eps == ROUNDING
    assert SINGULAR == 256 * ROUNDING == 2.0**-40
    lengths = {"joint_height": 0.0, "shaft": 0.0, "crank": 1.0, "coupler": 3.0, "root": 1.0}

    def robot(rb: float, rp: float, k: float = 2.0, clearance: float = 0.0) -> Mechanism:
        return mechanism_of_lengths(
            k=k, base_radius=rb, platform_radius=rp, stroke=9.0, clearance=clearance, **lengths
        )

    # R_b cos theta - R_pl = 2^-40 (R_b + R_pl)
    rb, rp = 1 + SINGULAR, 1 - SINGULAR
    assert platform_determinant(robot(rb, rp), 0.5, 0.0, 1.0) == 0.0
    assert platform_determinant(robot(np.nextafter(rb, 2), rp), 0.5, 0.0, 1.0) > 0.0
    # the square of the circle's radius, less that of the position, = 2^-40 (R_b + R_pl)^2
    c = (5 - 9 * SINGULAR) / 4
    assert platform_determinant(robot(2.0, 1.0), 0.0, 0.0, c) == 0.0
    assert platform_determinant(robot(2.0, 1.0), 0.0, 0.0, np.nextafter(c, 0.0)) < 0.0
    # X_1, and |85| at both ends of its way, here with k/(k - 1) = 2
    m = robot(0.75, 0.25)
    assert m.rho2_min == SINGULAR**2
    assert m.reach2_min == (2 + 6 * SINGULAR) ** 2
    assert m.reach2_max == (4 - 6 * SINGULAR) ** 2
    assert robot(0.75, 0.25, clearance=0.5).rho2_min == 0.25
    assert (m.rho2_max, robot(0.75, 0.25, k=4.0).rho2_max) == (81.0, 27.0**2)


def test_largest_eigenvalues_are_numpys_for_any_that_coincide() -> None:
    """Of rotated matrices with two equal ones, where rounding leaves no angle, and with three."""
    rng = np.random.default_rng(0)
    for values in ((1.0, 2.0, 3.0), (1.0, 1.0, 3.0), (1.0, 3.0, 3.0), (0.0, 0.0, 1e-9)):
        turned = np.linalg.qr(rng.normal(size=(200, 3, 3)))[0]
        a = turned @ np.diag(values) @ turned.swapaxes(-1, -2)
        found = _largest_eigenvalue(*a[:, [0, 1, 2, 0, 1, 0], [0, 1, 2, 1, 2, 2]].T)
        np.testing.assert_allclose(found, values[-1], rtol=1e-7)
    assert _largest_eigenvalue(*np.array([2.0, 2.0, 2.0, 0.0, 0.0, 0.0])) == 2.0


def test_a_platform_that_is_as_large_as_its_base_is_singular_at_its_center() -> None:
    """The circle's radius is zero there, and not the root of a rounding below it."""
    rb, rp = 0.733407192340118, 0.7334071923401179
    assert rb * rb + rp * rp - 2.0 * rb * rp < 0.0
    for base, platform in ((rb, rp), (rp, rb), (0.4, 0.4)):
        g = Geometry(base_radius=base, platform_radius=platform)
        assert base < platform or singular_rotation(g) == pytest.approx(0.0, abs=1e-7)
        found = measure_singularity(g, [[0.0, 0.0, 0.0, -0.5], [0.1, 0.0, 0.0, -0.5]])
        np.testing.assert_allclose(found.position_distance, [0.0, -0.1], atol=1e-15)
        np.testing.assert_allclose(found.rotation_distance[0], 0.0, atol=1e-7)
