"""Reach and numbers tell the same story: a torque wherever a pose can be taken, and only there."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.model import (
    APPENDIX_4,
    Design,
    Grid,
    KneeBranch,
    Limit,
    check_reach,
    forward_dynamics,
    forward_kinematics,
    inverse_dynamics,
    inverse_kinematics,
    lumped_coefficients,
    measure_singularity,
    rotary_torques,
    solve_field,
    static_breakdown,
    static_torques,
    torque_breakdown,
    torque_regressor,
    unit_torques,
)
from paminsa_viz.model.reach import home_pose
from tests.support.cases import BOTH, Case, cases
from tests.support.samples import possible_designs, with_knee

pytestmark = pytest.mark.slow


def limited(case: Case, stroke: float, clearance: float) -> Design:
    """The case's robot with a guide and a clearance that matter."""
    g = case.geometry
    geometry = replace(g, guide_stroke=stroke * g.stroke, axis_clearance=clearance * g.base_radius)
    return replace(case.design, geometry=geometry)


def wide_poses(design: Design, seed: int, n: int) -> Any:
    """Poses from near home to far outside."""
    rng, g = np.random.default_rng(seed), design.geometry
    size = np.array([g.base_radius, g.base_radius, np.pi, g.coupler_length + g.crank_length])
    return rng.uniform(-1, 1, (n, 4)) * size * rng.choice([0.2, 0.6, 1.0, 1e3], (n, 1))


@given(case=cases(), stroke=st.floats(0.3, 1.2), clearance=st.floats(0.0, 0.3))
def test_numbers_exist_exactly_where_the_status_is_ok(
    case: Case, stroke: float, clearance: float
) -> None:
    design = limited(case, stroke, clearance)
    geometry = design.geometry
    pose = wide_poses(design, case.seed, 300)
    v, a = np.full(4, 0.3), np.full(4, -0.7)
    reach = check_reach(geometry, pose)
    ok = reach.ok
    result = inverse_dynamics(design, pose, v, a)
    np.testing.assert_array_equal(result.status, reach.status)
    np.testing.assert_array_equal(result.leg, reach.leg)
    parts = static_breakdown(design, pose)
    moving = torque_breakdown(design, pose, v, a)
    measured = measure_singularity(geometry, pose)
    for values in (
        unit_torques(geometry, pose),
        static_torques(design, pose),
        parts.total,
        parts.platform,
        parts.payload,
        parts.per_leg,
        result.torque,
        result.multipliers,
        moving.gravity,
        moving.inertial,
        moving.velocity,
        moving.total,
        torque_regressor(geometry, pose, v, a),
        forward_dynamics(design, pose, v, a),
        measured.determinant[:, None],
        measured.condition[:, None],
    ):
        flat = values.reshape(300, -1)
        np.testing.assert_array_equal(np.isfinite(flat).all(axis=-1), ok)
        assert np.isnan(flat[~ok]).all()


@BOTH
def test_end_of_the_guide_is_reachable(knee: KneeBranch) -> None:
    """Lengths that are exact in binary: |X_4| of leg 3 is the stroke to the last bit."""
    design = APPENDIX_4.vary(
        {
            "geometry.base_radius": 0.5,
            "geometry.platform_radius": 0.25,
            "geometry.guide_stroke": 0.1875,
        }
    )
    pose = [0.0, -0.125, 0.0, -0.5]
    reach = check_reach(design.geometry, pose)
    assert reach.margins[2, 2] == 0.0
    assert reach.ok
    measured = measure_singularity(design.geometry, pose)
    field = solve_field(with_knee(design.geometry, knee), Grid.over(pose))
    assert field.status == Limit.OK
    for values in (
        static_torques(with_knee(design, knee), pose),
        field.gamma,
        measured.condition,
        measured.determinant,
        field.condition,
    ):
        assert np.isfinite(values).all()


@given(design=possible_designs(), seed=st.integers(0, 1000))
def test_no_possible_design_overflows(design: Design, seed: int) -> None:
    """Torques of any size, but numbers wherever a pose can be taken; warnings are errors here."""
    pose = np.concatenate([[home_pose(design.geometry)], wide_poses(design, seed, 30)])
    result = inverse_dynamics(design, pose, np.full(4, 0.3), np.full(4, -0.7))
    ok = result.status == Limit.OK
    assert np.isfinite(result.torque[ok]).all()
    assert np.isfinite(static_torques(design, pose)[ok]).all()
    assert np.isfinite(lumped_coefficients(design)).all()
    forward_kinematics(design.geometry, inverse_kinematics(design.geometry, pose).actuators)
    x = pose[:9, 0]
    field = solve_field(design.geometry, Grid.over(pose[0], x=x, y=x))
    assert np.isfinite(field.torques(design)[:, field.status == Limit.OK]).all()
    assert not np.isnan(field.condition[field.status == Limit.OK]).any()


NOT_FINITE = [(i, bad) for i in range(4) for bad in (np.nan, np.inf, -np.inf)]
NOT_FINITE += [(i, 1e200) for i in (0, 1, 3)]  # squares of it are infinite


@pytest.mark.parametrize(("coordinate", "bad"), NOT_FINITE)
@BOTH
def test_poses_that_are_not_finite_have_that_status(
    knee: KneeBranch, coordinate: int, bad: float
) -> None:
    """Warnings are errors in this suite."""
    pose = np.array([0.01, 0.02, 0.1, -0.5])
    pose[coordinate] = bad
    geometry, one = APPENDIX_4.geometry, np.ones(4)
    result = inverse_dynamics(with_knee(APPENDIX_4, knee), pose, one, one)
    assert result.status == Limit.NOT_FINITE
    assert result.leg == -1
    field = solve_field(with_knee(geometry, knee), Grid.over(pose))
    assert field.status == check_reach(geometry, pose).status == Limit.NOT_FINITE
    for values in (
        result.torque,
        field.gamma,
        unit_torques(with_knee(geometry, knee), pose),
        static_breakdown(with_knee(APPENDIX_4, knee), pose).total,
        torque_breakdown(with_knee(APPENDIX_4, knee), pose, one, one).total,
        torque_regressor(with_knee(geometry, knee), pose, one, one),
        forward_dynamics(with_knee(APPENDIX_4, knee), pose, one, one),
        rotary_torques(with_knee(APPENDIX_4, knee), Grid.over(pose)),
    ):
        assert np.isnan(values).all()
