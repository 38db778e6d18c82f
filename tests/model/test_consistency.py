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
    inverse_dynamics,
    inverse_kinematics,
    measure_singularity,
    rotary_torques,
    solve_field,
    static_breakdown,
    static_torques,
    torque_breakdown,
    torque_regressor,
    unit_torques,
)
from tests.support.cases import BOTH, Case, cases
from tests.support.samples import with_knee

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


@given(case=cases(), stroke=st.floats(0.3, 1.2), clearance=st.floats(0.0, 0.3))
def test_maps_agree_with_reach(case: Case, stroke: float, clearance: float) -> None:
    design = limited(case, stroke, clearance)
    rng = np.random.default_rng(case.seed)
    g = design.geometry
    grid = Grid.over(
        [0.0, 0.0, rng.uniform(-1, 1), -0.5 * g.coupler_length],
        y=rng.uniform(-2, 2, 12) * g.base_radius,
        x=rng.uniform(-2, 2, 11) * g.base_radius,
    )
    field = solve_field(g, grid)
    reach = check_reach(g, grid.poses())
    np.testing.assert_array_equal(field.status, reach.status)
    np.testing.assert_array_equal(field.leg, reach.leg)
    np.testing.assert_array_equal(field.margin < 0, ~reach.ok)
    for values in (*field.gamma, field.determinant, field.condition):
        np.testing.assert_array_equal(np.isnan(values), ~reach.ok)
    for values in rotary_torques(design, grid):
        np.testing.assert_array_equal(np.isnan(values), ~reach.ok)


@given(case=cases(), side=st.sampled_from([-1, 1]))
def test_a_guide_is_used_to_its_end_and_no_further(case: Case, side: int) -> None:
    """A billionth of the stroke decides between a torque and none."""
    pose = case.poses(1)[0]
    p = inverse_kinematics(case.geometry, pose).points
    travel = np.linalg.norm((p[8] - p[3])[:, :2], axis=-1)
    stroke = float(travel.max()) * (1 + side * 1e-9)
    design = replace(case.design, geometry=replace(case.geometry, guide_stroke=stroke))
    allowed = side > 0
    assert bool(check_reach(design.geometry, pose).ok) == allowed
    measured = measure_singularity(design.geometry, pose)
    for values in (
        static_torques(design, pose),
        inverse_dynamics(design, pose, np.ones(4), np.ones(4)).torque,
        measured.condition,
        measured.determinant,
    ):
        assert np.isfinite(values).all() == allowed


@BOTH
def test_exactly_at_the_end_of_a_guide_everything_is_known(knee: KneeBranch) -> None:
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


@given(case=cases(), longer=st.floats(1.0, 3.0))
def test_a_longer_guide_only_adds_poses(case: Case, longer: float) -> None:
    pose = wide_poses(case.design, case.seed, 300)
    g = case.geometry
    before = check_reach(g, pose)
    after = check_reach(replace(g, guide_stroke=longer * g.stroke), pose)
    assert not (before.ok & ~after.ok).any()
    lost = ~before.ok & after.ok
    assert (before.status[lost] == Limit.GUIDE).all()
    np.testing.assert_array_equal(after.margins[..., [0, 1, 3]], before.margins[..., [0, 1, 3]])


@given(case=cases(), clearance=st.floats(0.0, 0.5))
def test_a_clearance_only_takes_poses_away(case: Case, clearance: float) -> None:
    pose = wide_poses(case.design, case.seed, 300)
    g = case.geometry
    before = check_reach(g, pose)
    after = check_reach(replace(g, axis_clearance=clearance * g.base_radius), pose)
    assert not (after.ok & ~before.ok).any()
    assert (after.status[before.ok & ~after.ok] == Limit.AXIS).all()


NOT_FINITE = [(i, bad) for i in range(4) for bad in (np.nan, np.inf, -np.inf)]
NOT_FINITE += [(i, 1e200) for i in (0, 1, 3)]  # squares of it are infinite


@pytest.mark.parametrize(("coordinate", "bad"), NOT_FINITE)
@BOTH
def test_poses_that_are_not_finite_are_quiet_and_named(
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


@BOTH
def test_on_a_singularity_there_is_a_reason_instead_of_a_torque(knee: KneeBranch) -> None:
    """Lengths that are exact in binary, so that the determinant is exactly zero."""
    design = APPENDIX_4.vary({"geometry.base_radius": 0.5, "geometry.platform_radius": 0.25})
    pose = [[0.25, 0.0, 0.0, -0.5], [0.1, 0.0, 0.0, -0.5]]
    result = inverse_dynamics(with_knee(design, knee), pose, np.zeros(4), np.zeros(4))
    assert result.status.tolist() == [Limit.SINGULAR, Limit.OK]
    assert result.leg.tolist() == [-1, -1]
    assert np.isnan(result.torque[0]).all()
    assert not np.isfinite(unit_torques(with_knee(design.geometry, knee), pose)[0, :3]).any()
    field = solve_field(with_knee(design.geometry, knee), Grid.over(pose[0], x=[0.25, 0.1]))
    assert field.status.tolist() == [Limit.SINGULAR, Limit.OK]
    assert np.isnan(field.gamma[:, 0]).all()
    assert np.isfinite(field.gamma[:, 1]).all()
