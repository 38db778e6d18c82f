"""The formulas of Appendix 1 as they stand in the text, against the solved configuration."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from hypothesis import given

from paminsa_viz.model import APPENDIX_4, Geometry, KneeBranch, closure, inverse_kinematics
from paminsa_viz.model.kinematics import HEADINGS, LEG_AXES
from tests.model import paper
from tests.support.cases import BOTH, BY_HAND, OTHER, Case, assert_within, cases
from tests.support.samples import with_knee


def typed_knees(geometry: Geometry, pose: Any, actuators: Any) -> Any:
    """P_9k of Appendix 1, letter by letter, (..., 3 legs, 3)."""
    x, y, theta, z = np.moveaxis(pose, -1, 0)
    k, lb3, lb4 = geometry.magnification, geometry.crank_length, geometry.coupler_length
    rpl, rb = geometry.platform_radius, geometry.base_radius
    x5 = [x - rpl * np.cos(theta + np.pi / 6), x + rpl * np.cos(-theta + np.pi / 6)]
    y5 = [y - rpl * np.sin(theta + np.pi / 6), y - rpl * np.sin(-theta + np.pi / 6)]
    x5.append(x - rpl * np.sin(theta))
    y5.append(y + rpl * np.cos(theta))
    e1 = [-np.sqrt(3) / 2 * rb, np.sqrt(3) / 2 * rb, 0.0]
    e2 = [-rb / 2, -rb / 2, rb]
    beta = [
        actuators[..., 0] + np.pi / 6,
        actuators[..., 1] + 5 * np.pi / 6,
        actuators[..., 2] + 3 * np.pi / 2,
    ]
    knees = []
    for i in range(3):
        Z1 = z + geometry.platform_joint_height
        X1 = np.sqrt((x5[i] - e1[i]) ** 2 + (y5[i] - e2[i]) ** 2)
        X4 = -X1 / (k - 1)
        A = (lb4**2 - lb3**2 - X1**2 + X4**2 - Z1**2) / (2 * k * X4)
        B = Z1 / (k * X4)
        C = lb3**2 - X4**2 + 2 * A * X4 - A**2
        D = 2 * B * (X4 - A)
        E = -(B**2 + 1)
        K = np.sqrt(D**2 - 4 * E * C)
        F = -(D - K) / (2 * E) if geometry.knee is KneeBranch.LOWER else -(D + K) / (2 * E)
        H = A + B * F
        knees.append([e1[i] + H * np.cos(beta[i]), e2[i] + H * np.sin(beta[i]), F])
    return np.moveaxis(np.array(knees), (0, 1), (-2, -1))


@given(case=cases())
def test_the_published_formulas_give_joint_9(case: Case) -> None:
    pose = case.poses(32)
    configuration = inverse_kinematics(case.geometry, pose)
    knees = typed_knees(case.geometry, pose, configuration.actuators)
    assert_within(configuration.points[9], knees, 1e-12 * case.geometry.coupler_length)


@BOTH
def test_the_printed_root_is_the_lower_knee(knee: KneeBranch) -> None:
    """Of the two roots of F in one configuration; both close the pantograph."""
    geometry = with_knee(APPENDIX_4.geometry, knee)
    actuators = inverse_kinematics(geometry, BY_HAND).actuators
    knees = typed_knees(geometry, BY_HAND, actuators)
    others = typed_knees(with_knee(geometry, OTHER[knee]), BY_HAND, actuators)
    assert np.all((knees[..., 2] < others[..., 2]) == (knee is KneeBranch.LOWER))
    solved = inverse_kinematics(geometry, BY_HAND).points
    assert_within(solved[9], knees, 1e-14)


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


def test_leg_planes_face_the_center_at_zero() -> None:
    """beta_k = theta_k + 30, 150, 270 degrees: the platform's side of axes at 210, -30, 90."""
    configuration = inverse_kinematics(APPENDIX_4.geometry, [0.0, 0.0, 0.0, -0.5])
    assert_within(configuration.actuators[:3], np.zeros(3), 1e-15)
    assert_within(np.cos(configuration.beta - HEADINGS), np.ones(3), 1e-15)
    towards = np.stack([np.cos(HEADINGS), np.sin(HEADINGS)], axis=-1)
    assert_within(towards, -LEG_AXES, 1e-15)


def test_no_length_of_appendix_4_is_written_into_the_formulas() -> None:
    """A robot of twice the size has configurations of twice the size."""
    g = APPENDIX_4.geometry
    twice = replace(
        g,
        base_radius=2 * g.base_radius,
        platform_radius=2 * g.platform_radius,
        shaft_length=2 * g.shaft_length,
        crank_length=2 * g.crank_length,
        coupler_length=2 * g.coupler_length,
        platform_joint_height=2 * g.platform_joint_height,
        guide_link_length=2 * g.guide_link_length,
    )
    small = inverse_kinematics(g, BY_HAND)
    large = inverse_kinematics(twice, BY_HAND * [2.0, 2.0, 1.0, 2.0])
    for number, points in small.points.items():
        assert_within(large.points[number], 2 * points, 1e-14)
    assert_within(large.actuators[:, :3], small.actuators[:, :3], 1e-14)
    assert_within(large.reach.margins, 2 * small.reach.margins, 1e-14)
