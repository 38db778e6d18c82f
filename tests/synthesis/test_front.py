"""Fronts of designs: on the curve that closed forms give, none dominated, reproducible."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from paminsa_viz.errors import InvalidInput
from paminsa_viz.synthesis import ObjectiveLimit, SearchRange, SynthesisCase
from paminsa_viz.synthesis.search.front import DesignFront, design_front, nondominated
from tests.synthesis.test_prices import RADIUS, one_length


def two_numbers() -> SynthesisCase:
    """Return a case of the crank and the height of the workspace."""
    ranges = (
        SearchRange("geometry.crank_length", 0.2, 0.8),
        SearchRange("workspace.height", 0.1, 0.4),
    )
    return one_length(ranges=ranges)


@pytest.fixture(scope="module")
def front() -> DesignFront:
    """Return a front between mass and volume."""
    return design_front(two_numbers(), ("moving_mass", "volume"), points=4)


@pytest.mark.slow
def test_points_are_on_the_curve_of_the_closed_form(front):
    assert front.searches == 5
    assert not front.failed
    assert len(front.points) == 4
    masses, volumes = np.array([point.values for point in front.points]).T
    assert (np.diff(masses) > 0).all()
    assert (np.diff(volumes) > 0).all()
    # the ends, and the others in equal steps between them
    heights = volumes / (np.pi * RADIUS**2)
    np.testing.assert_allclose(heights, np.linspace(0.1, 0.4, 4), atol=4e-3)
    for point in front.points:
        design, workspace = point.result.design, point.result.workspace
        g = design.geometry
        wide = g.magnification / (g.magnification - 1)
        far = g.base_radius - g.platform_radius + RADIUS
        low = 0.7 + 0.5 * workspace.size[2] - g.platform_joint_height
        crank = 0.001 + np.hypot(wide * far, low) - g.coupler_length
        assert g.crank_length == pytest.approx(crank, abs=5e-4)


@pytest.mark.slow
def test_same_seed_same_front(front):
    again = design_front(two_numbers(), ("moving_mass", "volume"), points=4)
    assert [p.values for p in again.points] == [p.values for p in front.points]


@pytest.mark.slow
def test_a_front_that_is_canceled_has_the_points_found_so_far():
    found = design_front(
        two_numbers(), ("moving_mass", "volume"), points=5,
        progress=lambda done, searches, state: searches == 3 and 3 / 6 < done <= 4 / 6,
    )  # fmt: skip
    assert found.canceled
    assert len(found.points) == 2


@pytest.mark.slow
def test_limits_of_the_case_hold_for_all_points(front):
    most = 0.5 * (front.points[0].values[0] + front.points[-1].values[0])
    limited = replace(two_numbers(), limits=(ObjectiveLimit("moving_mass", most),))
    found = design_front(limited, ("volume", "moving_mass"), points=3)
    assert found.points
    assert max(point.values[1] for point in found.points) <= most * (1 + 1e-9)


@given(arrays(np.int64, st.tuples(st.integers(1, 12), st.just(3)), elements=st.integers(0, 3)))
def test_what_is_kept_dominates_the_rest_and_not_itself(values):
    kept = nondominated(values)

    def dominates(a: np.ndarray, b: np.ndarray) -> bool:
        return bool((a <= b).all() and (a < b).any())

    for index, row in enumerate(values):
        better = any(dominates(values[i], row) for i in kept)
        same = any((values[i] == row).all() for i in kept)
        assert (index in kept) <= (not better)
        assert better or same


def test_wrong_fronts_are_refused():
    for names, points in (
        (("volume",), 4), (("volume", "volume"), 4), (("volume", "footprint"), 1),
        (("volume", "beauty"), 4), (("volume", "footprint", "moving_mass"), 50),
    ):  # fmt: skip
        with pytest.raises(InvalidInput):
            design_front(two_numbers(), names, points=points)
