"""Scales against matplotlib's own, their levels and ticks, and what they refuse."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.errors import PaminsaError
from paminsa_viz.model.reach import Limit
from paminsa_viz.palette import INK, rgb
from paminsa_viz.plots import colors
from paminsa_viz.plots.ranges import ScaleChoice
from paminsa_viz.plots.scale import (
    OVER,
    SINGULAR,
    UNDER,
    UNREACHED,
    InvalidScale,
    Scale,
    color_codes,
    map_pixels,
)
from tests.plots.samples import scales

NAN, INF = float("nan"), float("inf")


@given(scales(), st.integers(0, 2**32 - 1))
def test_positions_are_those_of_matplotlib_s_norm(scale: Scale, seed: int) -> None:
    span = scale.high - scale.low
    values = np.random.default_rng(seed).uniform(scale.low - span, scale.high + span, 200)
    norm, _ = scale.matplotlib_colors()
    assert np.allclose(scale.position(values), np.ma.getdata(norm(values)), rtol=0, atol=1e-9)


@given(scales())
def test_position_rises_from_zero_to_one(scale: Scale) -> None:
    values = np.linspace(scale.low, scale.high, 101)
    where = scale.position(values)
    assert (where[0], where[-1]) == (0.0, pytest.approx(1.0))
    assert (np.diff(where) > 0).all()


@given(scales())
def test_symmetric_log_is_odd(scale: Scale) -> None:
    values = np.linspace(scale.low, scale.high, 31)
    assert np.array_equal(scale.stretch(-values), -scale.stretch(values))


@given(scales())
def test_levels_and_ticks_are_inside_and_rise(scale: Scale) -> None:
    assert all(scale.low < level < scale.high for level in scale.levels)
    assert list(scale.levels) == sorted(set(scale.levels))
    for count in (1, 3, 8):
        found = scale.ticks(count)
        assert list(found) == sorted(set(found))
        slack = 1e-9 * (scale.high - scale.low)
        assert scale.low - slack <= found[0]
        assert found[-1] <= scale.high + slack


@given(st.floats(0.1, 1e3), st.floats(0.05, 1.0), st.sampled_from(colors.DIVERGING))
def test_zero_stays_neutral_where_ends_are_not_opposite(
    high: float, share: float, table: str
) -> None:
    for scale in (Scale(-share * high, high, colors=table), Scale(-high, share * high)):
        index = int(float(scale.position(0.0)) * 256)
        nearest = scale.table[min(index, 255)]
        assert np.ptp(nearest) < 0.1
        assert colors.oklab(nearest)[0] > 0.93


def test_a_positive_range_takes_one_arm_of_a_diverging_table() -> None:
    table = Scale(5.0, 20.0).table
    assert (table[:, 0] > table[:, 2]).all()


def test_contours_can_be_left_out() -> None:
    assert Scale(-1.0, 1.0, contours=0).levels == ()
    assert Scale(-1.0, 1.0, contours=4).levels == (-0.5, 0.0, 0.5)


def test_decades_of_a_symmetric_log() -> None:
    scale = Scale(-1000.0, 1000.0, "symlog", 1.0)
    assert scale.levels == (-100.0, -10.0, -1.0, 0.0, 1.0, 10.0, 100.0)


def test_contours_are_white_on_the_dark_end_of_a_magnitude_only() -> None:
    magnitude = Scale(0.0, 10.0, colors="viridis")
    assert (magnitude.ink(1.0), magnitude.ink(9.0)) == ("#ffffff", INK)
    assert {Scale(-10.0, 10.0).ink(level) for level in (-9.0, 0.0, 9.0)} == {INK}


@pytest.mark.parametrize(
    "arguments",
    [
        (1.0, 1.0),
        (2.0, 1.0),
        (NAN, 1.0),
        (0.0, NAN),
        (-INF, 1.0),
        (0.0, INF),
        (0.0, "1"),
        (False, True),
        (1.0, 1.0 + 1e-15),
        (0.0, 1e-300),
        (-1e308, 1e308),
        (0.0, 1.0, "log"),
        (0.0, 1.0, "symlog", 0.0),
        (0.0, 1.0, "symlog", NAN),
        (0.0, 1.0, "linear", 1.0, "jet"),
    ],
)
def test_nonsense_is_refused(arguments: tuple[Any, ...]) -> None:
    with pytest.raises(InvalidScale) as caught:
        Scale(*arguments)
    assert isinstance(caught.value, PaminsaError)
    assert caught.value.problem in str(caught.value)


@pytest.mark.parametrize(
    "choice",
    [
        {"low": 1.0},
        {"high": 1.0},
        {"low": 1.0, "high": 0.0},
        {"low": NAN, "high": 1.0},
        {"contours": -1},
        {"contours": 1000},
        {"kind": "cubic"},
        {"threshold": -1.0},
        {"colors": "rainbow"},
    ],
)
def test_nonsense_choices_are_refused(choice: dict[str, Any]) -> None:
    with pytest.raises(InvalidScale):
        ScaleChoice(**choice)


@given(scales(), st.integers(0, 2**32 - 1))
def test_pixels_are_those_of_matplotlib(scale: Scale, seed: int) -> None:
    span = scale.high - scale.low
    values = np.random.default_rng(seed).uniform(scale.low - span, scale.high + span, (12, 17))
    values.flat[:2] = scale.low, scale.high
    norm, table = scale.matplotlib_colors()
    theirs = table(norm(values))
    ours = map_pixels(values, None, scale)
    # Where a value falls on the edge of two colors, rounding may decide either way.
    where = scale.position(values) * 256
    sure = np.abs(where - np.round(where)) > 1e-6
    assert np.abs(ours[sure] / 255 - theirs[sure]).max() <= 0.5 / 255 + 1e-6


@given(scales(), st.integers(0, 2**32 - 1))
def test_masks_stay_masked(scale: Scale, seed: int) -> None:
    rng = np.random.default_rng(seed)
    values = rng.uniform(scale.low, scale.high, (9, 11))
    status = rng.integers(0, 7, (9, 11)).astype(np.uint8)
    values[rng.random((9, 11)) < 0.2] = np.nan
    cells = color_codes(values, status, scale)
    singular = (status == Limit.SINGULAR) | ((status == 0) & np.isnan(values))
    unreached = (status != 0) & (status != Limit.SINGULAR)
    assert (cells[unreached] == UNREACHED).all()
    assert (cells[singular] == SINGULAR).all()
    assert (cells[~unreached & ~singular] <= OVER).all()
    assert ((map_pixels(values, status, scale)[..., 3] == 0) == unreached).all()


def test_values_beyond_the_range_have_their_own_colors() -> None:
    scale = Scale(-2.0, 2.0)
    pixels = map_pixels(np.array([[-2.1, -2.0, 2.0, 2.1]]), None, scale)[0, :, :3]
    under, inside_low, inside_high, over = (tuple(pixel) for pixel in pixels)
    assert (under, over) == tuple(rgb(color) for color in scale.beyond)
    assert not {inside_low, inside_high} & {under, over}


@given(scales())
def test_infinite_values_are_beyond_the_range(scale: Scale) -> None:
    cells = color_codes(np.array([[-np.inf, np.inf]]), None, scale)
    assert cells.tolist() == [[UNDER, OVER]]


def test_row_zero_of_the_pixels_is_the_smallest_y() -> None:
    values = np.broadcast_to(np.linspace(-1, 1, 27)[:, None], (27, 31))
    pixels = map_pixels(values, np.zeros((27, 31), np.uint8), Scale(-2.0, 2.0))
    assert (pixels.shape, pixels.dtype) == ((27, 31, 4), np.uint8)
    assert pixels[0, 0, 2] > pixels[0, 0, 0]  # negative, blue
    assert pixels[-1, 0, 0] > pixels[-1, 0, 2]  # positive, red
