"""Closed forms of reach over headings, and margins of requirements over headings."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.model import APPENDIX_4
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.grids import Grid, solve_field
from paminsa_viz.model.load import LoadCase
from paminsa_viz.model.parameters import Counterweight
from paminsa_viz.model.reach import check_reach
from paminsa_viz.quantities import QUANTITIES
from paminsa_viz.quantities.requirements import Requirement, Requirements
from paminsa_viz.synthesis.volume.causes import FIRST_REACH, reach_distances
from paminsa_viz.synthesis.volume.margins import (
    Columns,
    heading_margins,
    headings,
    solve_columns,
    time_per_position,
)
from paminsa_viz.synthesis.volume.reach import ReachBounds, contains, cosine_range, reach_bounds
from tests.support.cases import Case, cases

ANGLES = st.floats(-8.0, 8.0)


@given(ANGLES, st.floats(0.0, 8.0))
def test_cosine_range_encloses_samples_and_is_taken(low: float, width: float) -> None:
    samples = np.cos(np.linspace(low, low + width, 4001))
    least, largest = cosine_range(low, low + width)
    assert least <= samples.min() + 1e-15
    assert largest >= samples.max() - 1e-15
    assert samples.min() - least < 1e-5
    assert largest - samples.max() < 1e-5


def test_contains_counts_whole_turns() -> None:
    assert contains(6.2, 6.4, 0.0)
    assert not contains(0.1, 6.2, 0.0)
    assert contains(-10.0, -9.0, np.pi)


def test_distance_is_known_where_joints_8_and_5_coincide() -> None:
    geometry = APPENDIX_4.geometry
    zero, leg = np.zeros(1), np.zeros(1, np.int8)
    bounds = ReachBounds(geometry, zero, zero, leg, leg, np.ones(1), 1.0)
    distance, _ = reach_distances(bounds, np.array([-geometry.platform_joint_height]))
    apart = abs(geometry.coupler_length - geometry.crank_length)
    assert distance == pytest.approx(-max(apart, geometry.axis_clearance))


@given(cases(), st.floats(-2.0, 2.0), st.floats(0.0, 2.0))
def test_margin_is_the_least_of_all_headings(case: Case, low: float, width: float) -> None:
    rng = np.random.default_rng(case.seed)
    size = case.geometry.base_radius
    x, y = rng.uniform(-size, size, (2, 30))
    z = rng.uniform(-2.0 * size, 2.0 * size, 30)
    theta = np.linspace(low, low + width, 1001)
    bounds = reach_bounds(case.geometry, x, y, (low, low + width))
    margin, which = bounds.margin(z)
    poses = np.stack(np.broadcast_arrays(x[:, None], y[:, None], theta, z[:, None]), axis=-1)
    flat = check_reach(case.geometry, poses).margins.reshape(30, -1, 12)
    sampled = flat.min(axis=(1, 2))
    assert (margin <= sampled + 1e-12).all()
    np.testing.assert_allclose(margin, sampled, atol=2e-6 * size * (1 + case.geometry.span_ratio))
    chosen = flat.min(axis=1)[np.arange(30), which]
    np.testing.assert_allclose(chosen, margin, atol=2e-6 * size * (1 + case.geometry.span_ratio))


@pytest.mark.parametrize(("theta", "regular"), [((-1.2, 1.2), True), ((-1.2, 1.3), False)])
def test_headings_beyond_the_singular_rotation_are_not_regular(
    theta: tuple[float, float], regular: bool
) -> None:
    # arccos(R_pl / R_b) = arccos(0.1 / 0.35) = 1.281
    bounds = reach_bounds(APPENDIX_4.geometry, 0.0, 0.0, theta)
    assert bool(bounds.regular) is regular


def test_positions_beyond_the_smallest_singular_circle_are_not_regular() -> None:
    bounds = reach_bounds(APPENDIX_4.geometry, [0.24, 0.26], 0.0, (-0.5, 0.5))
    assert bounds.regular.tolist() == [True, False]
    turned = reach_bounds(APPENDIX_4.geometry, 0.26, 0.0, (0.4, 0.5))
    assert turned.regular


@given(cases(), st.floats(-1.0, 1.0), st.floats(0.0, 1.0))
def test_distance_is_the_margin_over_its_slope(case: Case, low: float, width: float) -> None:
    rng = np.random.default_rng(case.seed)
    size, step = case.geometry.base_radius, 1e-6
    at = rng.uniform(-0.6 * size, 0.6 * size, (20, 3))

    def margin(points: Array) -> Array:
        bounds = reach_bounds(case.geometry, points[:, 0], points[:, 1], (low, low + width))
        return bounds.margin(points[:, 2])[0]

    ahead, behind = (
        np.stack([margin(at + sign * step * axis) for axis in np.eye(3)]) for sign in (1.0, -1.0)
    )
    slope = np.linalg.norm(ahead - behind, axis=0) / (2 * step)
    smooth = np.abs(ahead + behind - 2 * margin(at)).max(axis=0) < 1e-3 * step  # no other limit
    bounds = reach_bounds(case.geometry, at[:, 0], at[:, 1], (low, low + width))
    expected = margin(at) / slope
    found, code = reach_distances(replace_circle(bounds), at[:, 2])
    # the limit with the least margin need not be the nearest one
    assert (found <= expected + 1e-4 * size)[smooth & (expected > 0.0)].all()
    same = smooth & (code == FIRST_REACH + bounds.margin(at[:, 2])[1])
    np.testing.assert_allclose(found[same], expected[same], rtol=1e-4, atol=1e-4 * size)


def replace_circle(bounds: ReachBounds) -> ReachBounds:
    """Return the same without singular positions."""
    return replace(bounds, position=np.full_like(bounds.position, 1e9), turn=1.0)


DESIGN = replace(
    APPENDIX_4,
    load=LoadCase(force_x=5.0, force_z=-8.0, moment_z=0.4),
    payload=replace(APPENDIX_4.payload, mass=2.0),
    counterweights=(Counterweight("b3", 7, 0.2, 1.0),),
)
X, Y, Z = np.array([-0.03, 0.08]), np.array([0.05]), np.array([-0.7, -0.45])
THETA = (-0.3, 0.4)


@pytest.mark.parametrize("key", QUANTITIES)
def test_least_margin_is_that_of_all_headings(key: str) -> None:
    theta = headings(THETA, 3)
    grid = Grid.over((0.0, Y[0], 0.0, 0.0), x=X, theta=theta, z=Z)
    field = solve_field(DESIGN.geometry, grid)
    values = QUANTITIES[key].over(field, DESIGN)
    assert np.isfinite(values).any()
    bound = Requirement(key, None, 0.0)
    least, coarse = heading_margins(
        DESIGN, Requirements((bound,), THETA), np.column_stack([X, Y.repeat(2)]), Z, 3
    )
    expected = np.where(np.isnan(values), -np.inf, -values).min(axis=1)
    np.testing.assert_allclose(least[0], expected, rtol=1e-9, atol=1e-12)
    ends = np.where(np.isnan(values), -np.inf, -values)[:, ::2].min(axis=1)
    np.testing.assert_allclose(coarse[0], ends, rtol=1e-9, atol=1e-12)


def test_columns_have_positions_of_their_own() -> None:
    positions = np.array([[0.0, 0.0], [0.1, -0.05], [0.02, 0.03]])
    columns = Columns.at(positions, np.array([-0.2, 0.1]), Z)
    assert columns.shape == (3, 2, 2)
    poses = columns.poses()
    np.testing.assert_array_equal(poses[1, 1, 0], [0.1, -0.05, 0.1, -0.7])
    field = solve_columns(DESIGN.geometry, columns)
    for pose, gamma in zip(poses.reshape(-1, 4), field.gamma.reshape(4, -1).T, strict=True):
        alone = solve_field(DESIGN.geometry, Grid.over(pose, x=pose[:1]))
        np.testing.assert_allclose(gamma, alone.gamma[:, 0], rtol=1e-12)


def test_robots_whose_reach_no_bars_exceed_are_solved_at_every_height() -> None:
    long = replace(
        APPENDIX_4.geometry, base_radius=9.0, crank_length=9.0, coupler_length=9.0, guide_stroke=9.0
    )
    design = replace(APPENDIX_4, geometry=long)
    requirements = Requirements((Requirement("condition", None, 0.0),), (0.0, 0.0))
    least, _ = heading_margins(design, requirements, np.zeros((1, 2)), np.array([-3.0, -50.0]), 3)
    assert np.isfinite(least[0, 0, 0])
    assert least[0, 0, 1] == -np.inf
    assert time_per_position(design, requirements, 3, 10) > time_per_position(
        APPENDIX_4, requirements, 3, 10
    )
