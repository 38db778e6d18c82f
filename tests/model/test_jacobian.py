"""Closure equations, their derivatives A_ij, the Jacobian and its change along a motion."""

from __future__ import annotations

from typing import Any

import numpy as np
from hypothesis import given

from paminsa_viz.model import (
    APPENDIX_4,
    actuator_velocity,
    closure,
    closure_matrix,
    inverse_jacobian,
    inverse_jacobian_rate,
    inverse_kinematics,
    jacobian,
    joint_rates,
)
from tests import oracle
from tests.model import paper
from tests.support.cases import Case, assert_within, cases


def eight(pose: Any, actuators: Any) -> list[Any]:
    """The paper's eight coordinates as a list of arrays."""
    return list(np.moveaxis(np.concatenate([pose, actuators], -1), -1, 0))


@given(case=cases())
def test_a_ij_are_the_derivatives_of_the_printed_closure(case: Case) -> None:
    """Complex steps through Eqs. 16 and 17, also at actuators that do not fit the pose."""
    pose = case.poses()
    fitting = inverse_kinematics(case.geometry, pose).actuators
    rng = np.random.default_rng(case.seed)
    for actuators in (fitting, fitting + rng.normal(size=fitting.shape)):
        exact = paper.slopes(
            lambda q: paper.closure(case.geometry, q), eight(pose, actuators)
        )  # (n, 4, 8)
        assert_within(closure_matrix(case.geometry, pose, actuators), exact, 1e-14)


@given(case=cases())
def test_a_ij_are_the_derivatives_of_the_closure_function(case: Case) -> None:
    pose, h = case.poses(), 1e-5
    rng = np.random.default_rng(case.seed)
    actuators = inverse_kinematics(case.geometry, pose).actuators + rng.normal(size=pose.shape)
    matrix = closure_matrix(case.geometry, pose, actuators)
    for j in range(8):
        step = np.zeros(8)
        step[j] = h
        ahead = closure(case.geometry, pose + step[:4], actuators + step[4:])
        behind = closure(case.geometry, pose - step[:4], actuators - step[4:])
        assert_within(matrix[..., j], (ahead - behind) / (2 * h), 1e-10)


@given(case=cases())
def test_the_closure_stays_closed_along_a_motion(case: Case) -> None:
    """A (v, q') = 0: the actuators follow the platform."""
    pose, v, _ = case.states()
    actuators = inverse_kinematics(case.geometry, pose).actuators
    rates = np.concatenate([v, actuator_velocity(case.design, pose, v)], -1)
    gap = np.einsum("nij,nj->ni", closure_matrix(case.geometry, pose, actuators), rates)
    assert_within(gap, np.zeros_like(gap), 1e-13)


@given(case=cases())
def test_the_inverse_jacobian_is_that_of_first_principles(case: Case) -> None:
    pose = case.poses()
    exact = oracle.actuator_jacobian(case.design, pose)
    got = inverse_jacobian(case.geometry, pose)
    assert_within(got, exact, 1e-12 * np.abs(exact).max())
    # decoupled as the paper says: z moves the lift alone, and the lift follows z alone
    np.testing.assert_array_equal(got[:, :3, 3], 0.0)
    np.testing.assert_array_equal(got[:, 3, :3], 0.0)
    assert_within(got[:, 3, 3] * case.geometry.magnification, np.ones(len(pose)), 1e-15)


@given(case=cases())
def test_jacobian_and_inverse_jacobian_undo_each_other(case: Case) -> None:
    pose = case.poses(32)
    j, g = jacobian(case.geometry, pose), inverse_jacobian(case.geometry, pose)
    one = np.broadcast_to(np.eye(4), g.shape)
    assert_within(j @ g, one, 1e-12)
    assert_within(g @ j, one, 1e-11)
    assert_within(j, np.linalg.inv(g), 1e-11 * np.abs(j).max())


@given(case=cases())
def test_the_rate_is_the_change_of_the_inverse_jacobian(case: Case) -> None:
    pose, v, a = case.states()
    rate = inverse_jacobian_rate(case.geometry, pose, v)
    h = 1e-5
    ahead, behind = (inverse_jacobian(case.geometry, pose + s * h * v) for s in (1.0, -1.0))
    assert_within(rate, (ahead - behind) / (2 * h), 1e-6 * np.abs(rate).max())
    # and to rounding: the actuators' accelerations are G a + G' v
    exact = joint_rates(case.geometry, pose, v, a).actuators_acceleration
    got = np.einsum("nij,nj->ni", inverse_jacobian(case.geometry, pose), a)
    got += np.einsum("nij,nj->ni", rate, v)
    assert_within(got, exact, 1e-12 * np.abs(exact).max())


@given(case=cases())
def test_actuator_velocity_is_that_of_the_motion(case: Case) -> None:
    pose, v, a = case.states()
    exact = joint_rates(case.geometry, pose, v, a).actuators_velocity
    assert_within(actuator_velocity(case.design, pose, v), exact, 1e-12 * np.abs(exact).max())


def test_joint_5_on_its_axis_has_no_inverse_jacobian() -> None:
    geometry = APPENDIX_4.geometry
    on_axis = np.array([0.0, geometry.base_radius - geometry.platform_radius, 0.0, -0.3])
    g = inverse_jacobian(geometry, on_axis)
    assert not np.isfinite(g[2, :3]).any()
    assert np.isfinite(g[[0, 1, 3]]).all()
