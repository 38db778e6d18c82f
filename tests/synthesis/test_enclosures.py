"""Bounds over boxes hold for every pose in them, to the last bit, and shrink as the square."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from paminsa_viz.model import (
    APPENDIX_4,
    Design,
    measure_singularity,
    singular_radius,
    static_torques,
)
from paminsa_viz.model.leg import mechanism
from paminsa_viz.synthesis.proof.affine import box_variables, lower, size, upper
from paminsa_viz.synthesis.proof.enclosures import (
    condition_bounds,
    determinant_bounds,
    inverse_jacobian_rows,
    static_bounds,
    static_ranges,
    static_terms,
)
from tests.synthesis.certificate_robots import boxes, poses_of_boxes, robots

SEEDS = st.integers(0, 2**16)


@given(design=robots(), seed=SEEDS)
def test_static_torques_of_every_pose_are_within_their_bounds(design: Design, seed: int) -> None:
    middle, half = boxes(design, seed, 60)
    low, high = static_bounds(design, middle, half)
    for again in range(4):
        torque = static_torques(design, poses_of_boxes(middle, half, seed + again))
        # where a range has no bound it says so, and nothing is claimed
        assert not (torque < low[:, :4]).any()
        assert not (torque > high[:, :4]).any()
        assert not ((torque[:, :3] ** 2).mean(axis=1) > high[:, 4] * (1 + 1e-12)).any()
    assert np.isfinite(high[half.max(axis=1) < 1e-4 * design.geometry.base_radius]).mean() > 0.5


@given(design=robots(), seed=SEEDS)
def test_condition_and_determinant_of_every_pose_are_within_their_bounds(
    design: Design, seed: int
) -> None:
    middle, half = boxes(design, seed, 60)
    most = condition_bounds(design, middle, half)
    low, high = determinant_bounds(design, middle, half)
    for again in range(4):
        poses = poses_of_boxes(middle, half, seed + again)
        found = measure_singularity(design.geometry, poses)
        assert not (found.condition > most * (1 + 1e-12)).any()
        assert not (found.determinant < low[:, 0]).any()
        assert not (found.determinant > high[:, 0]).any()


@given(design=robots(), seed=SEEDS)
def test_bounds_of_single_poses_hold_what_rounding_changes(design: Design, seed: int) -> None:
    # A box without width has a range of rounding alone. Extended precision is within it.
    middle, half = boxes(design, seed, 40)
    assume(len(middle) > 9)
    long = middle.astype(np.longdouble)
    x, y, theta, z = long.T
    m = mechanism(design.geometry)
    exact = static_ranges(m, static_terms(design), x, y, np.cos(theta), np.sin(theta), z)
    with np.errstate(all="ignore"):
        ranges = static_ranges(m, static_terms(design), *box_variables(middle, 0 * half))
        for value, held in zip(exact, ranges, strict=True):
            assert not (value < lower(held)).any()
            assert not (value > upper(held)).any()
            assert np.median((upper(held) - lower(held)) / size(held)) < 1e-8


@given(seed=SEEDS)
def test_bounds_shrink_as_the_square_of_a_box(seed: int) -> None:
    middle, half = boxes(APPENDIX_4, seed, 80, widest=0.01)
    wide = np.full_like(half, 0.004)
    m = mechanism(APPENDIX_4.geometry)
    with np.errstate(all="ignore"):

        def errors(width: Any) -> Any:
            found = static_ranges(m, static_terms(APPENDIX_4), *box_variables(middle, width))
            return np.stack([part.e for part in found[:4]])

        ratio = errors(wide) / errors(0.25 * wide)
    assert 14 < np.nanmedian(ratio) < 24


@pytest.mark.parametrize("theta", [0.0, 0.3, -0.9])
def test_the_condition_number_at_the_center_has_a_closed_form(theta: float) -> None:
    # X_1/(sqrt2 |R_b cos theta - R_pl|), where it is above 1
    g = APPENDIX_4.geometry
    expected = singular_radius(g, theta) / (
        np.sqrt(2) * abs(g.base_radius * np.cos(theta) - g.platform_radius)
    )
    expected = max(expected, 1 / expected)
    for width, wide in ((0.0, 1e-9), (1e-4, 5e-3)):
        bound = condition_bounds(
            APPENDIX_4, np.array([[0, 0, theta, -0.6]]), np.full((1, 4), width)
        )
        assert expected * (1 - 1e-12) <= bound[0] <= expected * (1 + wide)


def test_rows_are_those_of_the_inverse_jacobian() -> None:
    from paminsa_viz.model import inverse_jacobian

    pose = np.array([0.05, -0.03, 0.4, -0.6])
    g = inverse_jacobian(APPENDIX_4.geometry, pose)[:3, :3]
    x, y, theta, _ = pose
    rows = inverse_jacobian_rows(mechanism(APPENDIX_4.geometry), x, y, np.cos(theta), np.sin(theta))
    scale = [1, 1, 1 / APPENDIX_4.geometry.platform_radius]
    np.testing.assert_allclose(np.reshape(rows, (3, 3)), g * scale, rtol=1e-12)


def test_without_weight_the_torques_are_those_of_the_load_alone() -> None:
    design = replace(APPENDIX_4, gravity=0.0)
    low, high = static_bounds(design, np.array([[0.02, 0.01, 0.2, -0.6]]), np.full((1, 4), 1e-3))
    np.testing.assert_allclose(low[:, :4], 0.0, atol=1e-9)
    np.testing.assert_allclose(high[:, :4], 0.0, atol=1e-9)
