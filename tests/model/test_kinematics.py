"""Postures: the mechanism's shape, its symmetries, and what comes out where there is none."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.model import APPENDIX_4, KneeBranch, Limit, closure, inverse_kinematics
from paminsa_viz.model.kinematics import AXIS_ANGLES, HEADINGS, LEG_AXES, wrap
from tests import oracle
from tests.model import paper
from tests.support.cases import BOTH, BY_HAND, OTHER, Case, assert_within, cases
from tests.support.samples import with_knee

JOINTS = (2, 3, 4, 5, 7, 8, 9)


def length(a: Any, b: Any) -> Any:
    return np.linalg.norm(a - b, axis=-1)


@pytest.mark.slow
@given(case=cases())
def test_every_leg_is_the_pantograph_of_figure_2(case: Case) -> None:
    g, k = case.geometry, case.geometry.magnification
    pose = case.poses(32)
    configuration = inverse_kinematics(g, pose)
    assert sorted(configuration.points) == list(JOINTS)
    p = configuration.points
    rounding = 1e-13 * (g.crank_length + g.coupler_length)
    for a, b, wanted in (
        (2, 3, g.shaft_length),
        (4, 7, g.crank_length),  # B3
        (8, 9, g.crank_length),  # B8
        (9, 5, g.coupler_length),  # B4
        (7, 8, g.coupler_length / k),  # B7
        (9, 4, g.coupler_length / k),
        (4, 5, g.coupler_length * (k - 1) / k),
    ):
        assert_within(length(p[a], p[b]), np.full((32, 3), wanted), rounding)
    # 8-9-4-7 is a parallelogram, 8-3-5 one straight line cut at 1/k, and 3 a point of B3
    assert_within(p[4] - p[9], p[7] - p[8], rounding)
    assert_within(p[5] - p[8], k * (p[3] - p[8]), rounding)
    assert_within(length(p[8], p[5]), k * length(p[8], p[3]), rounding)
    assert_within(p[3], p[4] + (p[7] - p[4]) * (k - 1) / k, rounding)
    # 9, 4, 5 in one line
    assert_within(np.cross(p[4] - p[9], p[5] - p[9]), np.zeros((32, 3, 3)), rounding)
    # 8 is on its guide at z = 0, 3 and 2 on the leg axis, 2 at the height of the lift
    axis = g.base_radius * np.stack([np.cos(oracle.AXIS_ANGLES), np.sin(oracle.AXIS_ANGLES)], -1)
    assert_within(p[8][..., 2], np.zeros((32, 3)), 0.0)
    for number in (2, 3):
        assert_within(p[number][..., :2], np.broadcast_to(axis, (32, 3, 2)), rounding)
    assert_within(p[2][..., 2], np.broadcast_to(configuration.actuators[:, 3:], (32, 3)), 1e-15)
    # every joint lies in the leg's plane, whose heading is beta
    aside = np.stack([-np.sin(configuration.beta), np.cos(configuration.beta)], axis=-1)
    for points in p.values():
        assert_within(np.sum((points[..., :2] - axis) * aside, -1), np.zeros((32, 3)), rounding)
    ahead = np.stack([np.cos(configuration.beta), np.sin(configuration.beta)], axis=-1)
    assert np.all(np.sum((p[5][..., :2] - axis) * ahead, -1) > 0)
    assert np.all(np.sum((p[8][..., :2] - axis) * ahead, -1) < 0)


@pytest.mark.slow
@given(case=cases())
def test_points_and_actuators_are_those_of_first_principles(case: Case) -> None:
    pose = case.poses()
    configuration = inverse_kinematics(case.geometry, pose)
    size = case.geometry.crank_length + case.geometry.coupler_length
    for index in range(3):
        leg = oracle.leg(case.design, oracle.split(pose), index)
        for number, point in leg.points.items():
            expected = np.stack(np.broadcast_arrays(*point, pose[:, 0])[:3], -1)
            assert_within(configuration.points[number][:, index], expected, 1e-13 * size)
    turn = configuration.actuators - oracle.actuators(case.design, pose)
    assert_within(wrap(turn[:, :3]), np.zeros((len(pose), 3)), 1e-13)
    assert_within(turn[:, 3], np.zeros(len(pose)), 1e-15)


@given(case=cases())
def test_angles_are_the_elevations_of_the_bars(case: Case) -> None:
    configuration = inverse_kinematics(case.geometry, case.poses())
    p = configuration.points
    for angle, start, end in ((configuration.psi, 9, 5), (configuration.phi, 8, 9)):
        bar = p[end] - p[start]
        along = bar[..., 0] * np.cos(configuration.beta) + bar[..., 1] * np.sin(configuration.beta)
        assert_within(wrap(angle - np.arctan2(bar[..., 2], along)), np.zeros((8, 3)), 1e-12)
    # B7 is parallel to B4, B3 to B8
    for ours, theirs in (((8, 7), (9, 5)), ((7, 4), (8, 9))):
        one, other = (p[b] - p[a] for a, b in (ours, theirs))
        assert_within(np.cross(one, other), np.zeros((8, 3, 3)), 1e-13)
        assert np.all(np.sum(one * other, -1) > 0)


@given(case=cases())
def test_the_branch_decides_the_side_of_the_knee(case: Case) -> None:
    pose = case.poses()
    for knee in KneeBranch:
        p = inverse_kinematics(with_knee(case.geometry, knee), pose).points
        line = p[5] - p[8]
        bar = p[9] - p[8]
        # vertical distance of the knee from the line 8-5, above it positive
        ahead = np.hypot(bar[..., 0], bar[..., 1]) * np.sign(
            np.sum(bar[..., :2] * line[..., :2], -1)
        )
        above = bar[..., 2] - line[..., 2] * ahead / np.hypot(line[..., 0], line[..., 1])
        assert np.all(above * knee.sign < 0)


@given(case=cases())
def test_the_mirror_image_has_the_other_knee(case: Case) -> None:
    """z_5 -> -z_5 with the other root mirrors every joint in the plane of the guides."""
    pose = case.poses()
    mirrored = pose.copy()
    mirrored[:, 3] = -pose[:, 3] - 2 * case.geometry.platform_joint_height
    one = inverse_kinematics(case.geometry, pose)
    two = inverse_kinematics(with_knee(case.geometry, OTHER[case.knee]), mirrored)
    for number in (3, 4, 5, 7, 8, 9):
        assert_within(two.points[number], one.points[number] * [1, 1, -1], 1e-13)
    assert_within(two.actuators[:, :3], one.actuators[:, :3], 1e-14)
    for name in ("psi", "phi"):
        assert_within(wrap(getattr(two, name) + getattr(one, name)), np.zeros((8, 3)), 1e-13)
    np.testing.assert_array_equal(one.reach.status, two.reach.status)


@given(case=cases(), turns=st.integers(1, 2))
def test_a_third_of_a_turn_renames_the_legs(case: Case, turns: int) -> None:
    pose = case.poses()
    angle = 2 * np.pi / 3 * turns
    c, s = np.cos(angle), np.sin(angle)
    around = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    turned = pose.copy()
    turned[:, :2] = pose[:, :2] @ around[:2, :2].T
    one = inverse_kinematics(case.geometry, pose)
    two = inverse_kinematics(case.geometry, turned)
    # Leg 1 at 210 degrees goes to leg 2 at 330, that to leg 3 at 90.
    legs = (np.arange(3) + turns) % 3
    for number in JOINTS:
        assert_within(two.points[number][:, legs], one.points[number] @ around.T, 1e-13)
    assert_within(wrap(two.actuators[:, legs] - one.actuators[:, :3]), np.zeros((8, 3)), 1e-13)
    for name in ("psi", "phi"):
        assert_within(getattr(two, name)[:, legs], getattr(one, name), 1e-13)
    assert_within(two.reach.margins[:, legs], one.reach.margins, 1e-14)
    ok = two.reach.leg < 0
    np.testing.assert_array_equal(ok, one.reach.leg < 0)


@given(case=cases(), turns=st.integers(-3, 3))
def test_whole_turns_of_the_platform_change_nothing(case: Case, turns: int) -> None:
    pose = case.poses()
    turned = pose + np.array([0.0, 0.0, 2 * np.pi * turns, 0.0])
    one, two = (inverse_kinematics(case.geometry, p) for p in (pose, turned))
    assert_within(two.actuators, one.actuators, 1e-12)


@given(angle=st.floats(-1e6, 1e6))
def test_wrap_is_half_open_and_keeps_the_direction(angle: float) -> None:
    wrapped = float(wrap(angle))
    assert -np.pi < wrapped <= np.pi
    assert np.cos(wrapped - angle) == pytest.approx(1.0, abs=1e-9)
    turns = (angle - wrapped) / (2 * np.pi)
    assert turns == pytest.approx(round(turns), abs=1e-9)


def test_wrap_at_its_ends() -> None:
    np.testing.assert_array_equal(wrap([np.pi, -np.pi, 0.0]), [np.pi, np.pi, 0.0])
    assert np.isnan(wrap([np.nan, np.inf, -np.inf])).all()


def test_actuators_stay_within_half_a_turn_of_home() -> None:
    """Near a leg axis its actuator can point anywhere; it never leaves (-pi, pi]."""
    geometry = APPENDIX_4.vary({"geometry.guide_link_length": 2.0}).geometry
    around = np.linspace(-np.pi, np.pi, 721)
    e = geometry.base_radius * np.array([np.cos(oracle.AXIS_ANGLES), np.sin(oracle.AXIS_ANGLES)]).T
    for leg in range(3):
        x, y = e[leg, :, None] * 1.0
        angle = oracle.AXIS_ANGLES[leg]
        x = x - geometry.platform_radius * np.cos(angle) + 0.01 * np.cos(around)
        y = y - geometry.platform_radius * np.sin(angle) + 0.01 * np.sin(around)
        pose = np.stack([x, y, 0 * x, 0 * x - 0.4], -1)
        turn = inverse_kinematics(geometry, pose).actuators[:, leg]
        assert turn.min() > -np.pi
        assert turn.max() <= np.pi
        assert np.ptp(turn) > 2 * np.pi - 0.02
        assert_within(wrap(turn + oracle.AXIS_ANGLES[leg] + np.pi - around), 0 * around, 1e-11)


@BOTH
def test_configuration_out_of_reach_is_nan_with_a_reason(knee: KneeBranch) -> None:
    configuration = inverse_kinematics(
        with_knee(APPENDIX_4.geometry, knee), [[0.0, 0.0, 0.0, -1.2], *BY_HAND]
    )
    assert configuration.reach.status.tolist() == [Limit.STRETCHED, 0, 0, 0]
    for number in (4, 7, 9):
        assert np.isnan(configuration.points[number][0]).all()
    assert np.isnan(configuration.psi[0]).all()
    assert np.isnan(configuration.phi[0]).all()
    # what does not hang on the knee is known all the same
    for number in (2, 3, 5, 8):
        assert np.isfinite(configuration.points[number][0]).all()
    assert np.isfinite(configuration.actuators).all()
    assert all(np.isfinite(points[1:]).all() for points in configuration.points.values())


@given(case=cases())
def test_the_second_typing_agrees(case: Case) -> None:
    """`tests.model.paper`, which the Lagrange tests stand on, and its closure equations."""
    pose = case.poses()
    configuration = inverse_kinematics(case.geometry, pose)
    q = np.moveaxis(np.concatenate([pose, configuration.actuators], axis=-1), -1, 0)
    legs = paper.appendix_1(case.geometry, q)
    for index, leg in enumerate(legs):
        for number, point in ((5, (leg.x5, leg.y5, leg.z5)), (9, (leg.x9, leg.y9, leg.z9))):
            solved = configuration.points[number][:, index]
            assert_within(solved, np.stack(point, -1), 1e-12 * case.geometry.coupler_length)
    typed = np.stack(paper.closure(case.geometry, q), -1)
    assert_within(typed, np.zeros_like(typed), 1e-14)
    off = np.random.default_rng(case.seed).normal(size=configuration.actuators.shape)
    q[4:] += off.T
    typed = np.stack(paper.closure(case.geometry, q), -1)
    assert_within(closure(case.geometry, pose, configuration.actuators + off), typed, 1e-14)
    assert np.abs(typed).max() > 1e-3


def test_base_points_with_their_indices_put_right() -> None:
    """e_11 = -e_12 = -sqrt(3)/2 R_b and e_21 = e_22 = -R_b/2 are (coordinate, leg).

    "e_31 = 0, e_32 = R_b" is (leg, coordinate): read as the others it would give legs 1 and 2 a
    third coordinate and leg 3 none. Read all of them as (leg, coordinate), legs 1 and 2 would
    stand at sqrt(3/2) R_b and R_b / sqrt(2), and the robot would not be symmetric.
    """
    rb = APPENDIX_4.geometry.base_radius
    right = np.array(paper.base_points(APPENDIX_4.geometry))
    assert_within(right, rb * LEG_AXES, 1e-15)
    assert_within(np.hypot(*right.T), np.full(3, rb), 1e-15)
    printed = {(1, 1): -np.sqrt(3) / 2 * rb, (1, 2): np.sqrt(3) / 2 * rb}
    printed |= {(2, 1): -rb / 2, (2, 2): -rb / 2, (3, 1): 0.0, (3, 2): rb}
    by_leg = np.array([[printed[leg, coordinate] for coordinate in (1, 2)] for leg in (1, 2, 3)])
    assert_within(np.hypot(*by_leg.T) / rb, np.sqrt([1.5, 0.5, 1.0]), 1e-15)
    by_coordinate = {
        leg: [printed[i, leg] for i in (1, 2, 3) if (i, leg) in printed] for leg in (1, 2, 3)
    }
    assert [len(by_coordinate[leg]) for leg in (1, 2, 3)] == [3, 3, 0]


def test_constants_of_the_robot_cannot_be_written() -> None:
    for values in (LEG_AXES, AXIS_ANGLES, HEADINGS):
        with pytest.raises(ValueError, match="read-only"):
            values[0] = 0.0


def test_leg_planes_face_the_center_at_zero() -> None:
    """beta_k = theta_k + 30, 150, 270 degrees: the platform's side of axes at 210, -30, 90."""
    configuration = inverse_kinematics(APPENDIX_4.geometry, [0.0, 0.0, 0.0, -0.5])
    assert_within(configuration.actuators[:3], np.zeros(3), 1e-15)
    assert_within(np.cos(configuration.beta - HEADINGS), np.ones(3), 1e-15)
    towards = np.stack([np.cos(HEADINGS), np.sin(HEADINGS)], axis=-1)
    assert_within(towards, -LEG_AXES, 1e-15)
