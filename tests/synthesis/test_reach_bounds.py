"""Extremes over a range of headings against the same poses one by one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.model import APPENDIX_4
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.reach import check_reach
from paminsa_viz.synthesis.volume.causes import FIRST_REACH, reach_distances
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
