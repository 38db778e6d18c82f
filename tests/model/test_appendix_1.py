"""The formulas of Appendix 1 as they stand in the text, against the solved configuration."""

from __future__ import annotations

import numpy as np
from hypothesis import given

from paminsa_viz.model import APPENDIX_4, closure, inverse_kinematics
from paminsa_viz.model.kinematics import HEADINGS, LEG_AXES
from tests.model import paper
from tests.support.cases import Case, assert_within, cases


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
