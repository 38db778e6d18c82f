"""Which poses count: one definition for single poses and for fields."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from paminsa_viz.model import APPENDIX_4, check_reach, measure_singularity, solve_field, xy_grid
from paminsa_viz.model.reach import MARGINS, Limit, home_pose
from paminsa_viz.model.singular_limit import (
    CONDITION_LIMIT,
    SERIAL_CLEARANCE,
    counting,
    near_by_reach,
    near_singularity,
    serial_clearance,
)
from tests.support.samples import random_design, resized

SIDE = np.linspace(-0.4, 0.4, 15)


@given(seed=st.integers(0, 10**6), theta=st.floats(-1.3, 1.3), limit=st.floats(2.0, 200.0))
def test_fields_and_poses_agree_and_are_clear_of_singularities(
    seed: int, theta: float, limit: float
) -> None:
    geometry = random_design(np.random.default_rng(seed)).geometry
    grid = xy_grid(SIDE, SIDE, theta, home_pose(geometry)[3])
    field = solve_field(geometry, grid)
    counts = counting(field, limit)
    reach, measured = (
        check_reach(geometry, grid.poses()),
        measure_singularity(geometry, grid.poses()),
    )
    near = near_by_reach(geometry, measured.condition, reach, limit)
    np.testing.assert_array_equal(counts, reach.ok & ~near)
    assert (measured.condition[counts] <= limit).all()
    serial = np.delete(reach.margins, MARGINS.index(Limit.GUIDE), axis=-1).min(axis=(-1, -2))
    clearance = serial_clearance(geometry)
    assert (serial[counts] >= clearance).all()
    assert (serial[reach.ok & ~counts & (measured.condition <= limit)] < clearance).all()


def test_guide_at_its_end_does_not_hide_a_pantograph_near_a_singularity() -> None:
    folded = check_reach(APPENDIX_4.geometry, home_pose(APPENDIX_4.geometry))
    margins = np.full_like(folded.margins, 0.2)
    margins[1, MARGINS.index(Limit.GUIDE)] = 0.001
    at_end = replace(folded, margins=margins)
    assert not near_by_reach(APPENDIX_4.geometry, 2.0, at_end)
    both = margins.copy()
    both[2, MARGINS.index(Limit.STRETCHED)] = 0.5 * SERIAL_CLEARANCE
    assert near_by_reach(APPENDIX_4.geometry, 2.0, replace(folded, margins=both))


def test_poses_at_a_limit_still_count() -> None:
    """By default a local conditioning index of 0.1, and 10 mm to a serial singularity."""
    worst, least = 1 / 0.1, 10e-3
    near = partial(near_singularity, APPENDIX_4.geometry)
    assert not near(worst, least)
    assert near(np.nextafter(worst, np.inf), least)
    assert near(worst, np.nextafter(least, 0.0))
    assert near([np.nan, 1.0], [1.0, np.nan]).all()


@pytest.mark.parametrize("size", [0.02, 5.0])
def test_same_poses_count_in_robots_of_any_size(size: float) -> None:
    def counts(times: float) -> NDArray[np.bool_]:
        grid = xy_grid(times * SIDE, times * SIDE, 0.5, -0.35 * times)
        return counting(solve_field(resized(APPENDIX_4, times).geometry, grid))

    assert counts(1.0).any()
    np.testing.assert_array_equal(counts(size), counts(1.0))


def test_higher_limit_lets_more_poses_count() -> None:
    field = solve_field(APPENDIX_4.geometry, xy_grid(SIDE, SIDE, np.pi / 3, -0.552))
    few, more, all_of_them = (counting(field, limit) for limit in (3.0, CONDITION_LIMIT, np.inf))
    assert few.sum() < more.sum() < all_of_them.sum()
    assert (more | ~few).all()
    # What does not count is what made the largest torque of Fig. 3 any number.
    torque = np.abs(field.torques(APPENDIX_4)[:3])
    assert torque[:, more].max() < 10 < 50 < np.nanmax(torque)


@pytest.mark.parametrize(
    ("pose", "near"),
    [
        ((0.0, 0.0, 0.0, -0.552), False),
        ((0.215, 0.175, np.pi / 3, -0.552), True),  # 35 mm from the circle, 101.7 N m
        ((0.0, 0.0, 1.27, -0.552), True),
        ((9.0, 0.0, 0.0, -0.552), True),
    ],
    ids=["home", "Fig. 3", "rotation", "unreachable"],
)
def test_known_poses(pose: tuple[float, ...], near: bool) -> None:
    reach = check_reach(APPENDIX_4.geometry, pose)
    measured = measure_singularity(APPENDIX_4.geometry, pose)
    assert near_by_reach(APPENDIX_4.geometry, measured.condition, reach) == near
