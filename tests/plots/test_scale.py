"""Scales against matplotlib's own, round levels and ticks, and impossible scales."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.errors import PaminsaError
from paminsa_viz.model.reach import Limit
from paminsa_viz.palette import INK, rgb
from paminsa_viz.plots import colors, ticks
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
def test_positions_and_pixels_are_those_of_matplotlib(scale: Scale, seed: int) -> None:
    span = scale.high - scale.low
    values = np.random.default_rng(seed).uniform(scale.low - span, scale.high + span, (12, 17))
    values.flat[:2] = scale.low, scale.high
    norm, table = scale.matplotlib_colors()
    where = scale.position(values)
    assert where.flat[0] == 0.0
    assert np.allclose(where, np.ma.getdata(norm(values)), rtol=0, atol=1e-9)
    assert (np.diff(where.ravel()[np.argsort(values, axis=None)]) >= 0).all()
    assert np.array_equal(scale.stretch(-values), -scale.stretch(values))
    # Where a value falls on the edge of two colors, rounding may decide either way.
    sure = np.abs(256 * where - np.round(256 * where)) > 1e-6
    gap = map_pixels(values, None, scale)[sure] / 255 - table(norm(values))[sure]
    assert np.abs(gap).max() <= 0.5 / 255 + 1e-6


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


@given(st.floats(0.1, 1e3), st.floats(0.05, 1.0))
def test_zero_stays_neutral_where_ends_are_not_opposite(high: float, share: float) -> None:
    for scale in (Scale(-share * high, high), Scale(-high, share * high)):
        index = int(float(scale.position(0.0)) * 256)
        nearest = scale.table[min(index, 255)]
        assert np.ptp(nearest) < 0.1
        assert colors.oklab(nearest)[0] > 0.93


def test_a_positive_range_takes_one_arm_of_a_diverging_table() -> None:
    table = Scale(5.0, 20.0).table
    assert (table[:, 0] > table[:, 2]).all()


@pytest.mark.parametrize(
    ("scale", "levels"),
    [
        (Scale(-1.0, 1.0, contours=0), ()),
        (Scale(-1.0, 1.0, contours=4), (-0.5, 0.0, 0.5)),
        (Scale(-1e3, 1e3, "symlog", 1.0), (-100.0, -10.0, -1.0, 0.0, 1.0, 10.0, 100.0)),
        (Scale(0.0, 0.5, contours=4, factor=30.0), (5.0 / 30.0, 10.0 / 30.0)),
    ],
    ids=["none", "linear", "symlog", "displayed"],
)
def test_contour_levels(scale: Scale, levels: tuple[float, ...]) -> None:
    assert scale.levels == levels


def test_contours_are_white_on_the_dark_end_of_a_magnitude_only() -> None:
    magnitude = Scale(0.0, 10.0, colors="viridis")
    assert (magnitude.ink(1.0), magnitude.ink(9.0)) == ("#ffffff", INK)
    assert {Scale(-10.0, 10.0).ink(level) for level in (-9.0, 0.0, 9.0)} == {INK}


@pytest.mark.parametrize(
    ("field", "arguments"),
    [
        ("high", (1.0, 1.0)), ("high", (2.0, 1.0)), ("low", (NAN, 1.0)), ("high", (0.0, NAN)),
        ("low", (-INF, 1.0)), ("high", (0.0, INF)), ("high", (0.0, "1")), ("low", (False, True)),
        ("high", (1.0, 1.0 + 1e-15)), ("high", (0.0, 1e-300)), ("high", (-1e308, 1e308)),
        ("kind", (0.0, 1.0, "log")), ("threshold", (0.0, 1.0, "symlog", 0.0)),
        ("threshold", (0.0, 1.0, "symlog", NAN)), ("colors", (0.0, 1.0, "linear", 1.0, "jet")),
        ("factor", (0.0, 1.0, "linear", 1.0, "viridis", 12, 0.0)),
    ],
)  # fmt: skip
def test_an_impossible_scale_names_its_field(field: str, arguments: tuple[Any, ...]) -> None:
    with pytest.raises(InvalidScale) as caught:
        Scale(*arguments)
    assert isinstance(caught.value, PaminsaError)
    assert caught.value.argument == field
    assert caught.value.problem in str(caught.value)


@pytest.mark.parametrize(
    ("field", "choice"),
    [
        ("high", {"low": 1.0}), ("low", {"high": 1.0}), ("high", {"low": 1.0, "high": 0.0}),
        ("low", {"low": NAN, "high": 1.0}), ("kind", {"kind": "cubic"}),
    ],
)  # fmt: skip
def test_an_impossible_choice_names_its_field(field: str, choice: dict[str, Any]) -> None:
    with pytest.raises(InvalidScale) as caught:
        ScaleChoice(**choice)
    assert caught.value.argument == field


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


spans = st.floats(1e-12, 1e12)


def significant(value: float) -> str:
    """Return the digits of a number without its power of ten."""
    return f"{value:.10e}".split("e")[0].rstrip("0").rstrip(".")


@given(spans, st.integers(1, 30))
def test_a_step_is_round_and_makes_no_more_parts_than_asked(span: float, count: int) -> None:
    step = ticks.nice_step(span, count)
    assert significant(step) in {"1", "2", "2.5", "5"}
    assert span / step <= count * (1 + 1e-6)
    assert span / step >= count / 2.6


@given(spans)
def test_a_limit_is_round_and_holds_the_value_or_is_the_nearest(value: float) -> None:
    limit = ticks.nice_limit(value)
    assert value * (1 - 1e-6) <= limit <= 1.51 * value
    assert len(significant(limit)) <= 3
    assert value / 1.3 < ticks.nice_limit(value, nearest=True) < 1.3 * value


@given(st.floats(-1e3, 1e3), st.floats(1e-3, 1e3))
def test_multiples_are_all_inside_and_none_is_missing(low: float, step: float) -> None:
    high = low + 7.3 * step
    found = ticks.multiples(low, high, step)
    assert len(found) in (7, 8)
    assert low - 1e-6 * step <= found[0] < low + step
    assert high - step < found[-1] <= high + 1e-6 * step


@pytest.mark.parametrize(
    ("low", "high", "count", "step"),
    [(-20, 20, 8, 5), (-30, 30, 6, 10), (0, 25, 8, 5), (0, 0.225, 4, None), (-25, 25, 2, 25)],
)
def test_dividing_steps(low: float, high: float, count: int, step: float | None) -> None:
    assert ticks.dividing_step(low, high, count) == step
