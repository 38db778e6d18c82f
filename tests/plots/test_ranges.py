"""Color ranges: robust near singularities, scaled by masses, blind to rounding errors."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.model import APPENDIX_4
from paminsa_viz.plots import colors, ticks
from paminsa_viz.plots.caption import contours_text
from paminsa_viz.plots.ranges import (
    LARGEST_END,
    NEGLIGIBLE,
    ScaleChoice,
    choose_scales,
    full_range,
    per_panel,
    robust_range,
    usable_range,
)
from paminsa_viz.plots.scale import InvalidScale, Kind, Scale
from tests.plots.samples import made_up, real

seeds = st.integers(0, 2**32 - 1)


@given(seeds, st.floats(1e-3, 1e6))
def test_ordinary_values_are_all_shown(seed: int, size: float) -> None:
    values = np.random.default_rng(seed).uniform(-size, size, 5000)
    for field, signed, most in ((values, True, 1.6), (np.abs(values), False, 1.3)):
        low, high = robust_range(field, signed)
        assert low == (-high if signed else 0)
        assert size * 0.99 <= high <= most * size
    low, high = robust_range(-np.abs(values), signed=False)
    assert high == 0
    assert size * 0.99 <= -low <= 1.3 * size


@given(seeds, st.floats(0.01, 0.3), st.floats(1e2, 1e8))
def test_exploding_values_run_over_the_scale(seed: int, share: float, factor: float) -> None:
    rng = np.random.default_rng(seed)
    values = rng.uniform(-5, 5, 5000)
    values[rng.random(5000) < share] *= factor
    assert robust_range(values, signed=True)[1] < 30
    assert robust_range(np.abs(values), signed=False)[1] < 30


@given(seeds, st.floats(1e-2, 1e3), st.floats(-50.0, 50.0))
def test_a_range_with_a_tail_is_four_times_its_ordinary_part(seed, size, start) -> None:
    drawn = np.random.default_rng(seed)
    ordinary = size * np.linspace(1.0, 2.0, 701)
    values = np.concatenate([ordinary, size * np.geomspace(20.0, 1e5, 300)])
    lower = np.sort(values)[400]  # 40 % of 1000 steps
    limit = ticks.nice_limit(4 * lower, nearest=True)
    signs = drawn.choice([-1.0, 1.0], values.size)
    shuffled = drawn.permutation(values * signs)
    assert robust_range(shuffled, signed=True) == (-limit, limit)
    assert robust_range([*shuffled, np.nan, np.inf, -np.inf], signed=True) == (-limit, limit)
    # A magnitude, and its mirror image: as far from the end as the ordinary part is, four times.
    moved = values + start * size
    low, high = robust_range(moved, signed=False)
    first = moved.min()
    step = ticks.nice_step(high - low, 10)
    wanted = first + 4 * (lower + start * size - first)
    assert low <= first + 1e-9 * size
    assert wanted - 1e-6 * step <= high <= wanted + step
    np.testing.assert_allclose(robust_range(-moved, signed=False), (-high, -low), atol=1e-9 * size)


def test_a_few_values_that_stick_out_are_left_to_run_over() -> None:
    ramp = np.linspace(0.0, 10.0, 1000)
    assert robust_range(ramp, signed=False) == (0.0, 10.0)
    # Held, if it is not farther from the middle than a quarter more than the last 2 % begin.
    middle, most = np.percentile(ramp, [50.0, 98.0])
    farthest = middle + 1.25 * (most - middle)
    assert robust_range([*ramp, farthest - 0.1], signed=False)[1] > farthest - 0.1
    assert robust_range([*ramp, farthest + 0.1], signed=False) == (0.0, 10.0)
    assert robust_range([-farthest - 0.1, *-ramp], signed=False) == (-10.0, 0.0)
    assert robust_range(np.linspace(39.0, 41.0, 300), signed=False) == (39.0, 41.0)
    assert robust_range(np.linspace(9.0, 41.0, 3000), signed=False)[0] == 0.0
    assert robust_range(np.linspace(-41.0, -9.0, 3000), signed=False)[1] == 0.0
    assert robust_range([8.0] * 5, signed=False) == (7.2, 8.8)
    assert robust_range([-8.0] * 5, signed=False) == (-8.8, -7.2)


@given(seeds, st.floats(1e-6, 1e6), st.floats(-3.0, 3.0))
def test_a_full_range_holds_all_values_between_round_ends(seed, size, middle) -> None:
    values = size * (middle + np.random.default_rng(seed).uniform(-1.0, 1.0, 200))
    low, high = full_range([*values, np.nan], signed=False) or (0.0, 0.0)
    step = ticks.nice_step(np.ptp(values), 20)
    slack = 1e-9 * step
    assert values.min() - step - slack <= low <= values.min() + slack
    assert values.max() - slack <= high <= values.max() + step + slack
    ends = np.divide([low, high], step)
    np.testing.assert_allclose(ends, np.round(ends), atol=1e-6)
    low, high = full_range(values, signed=True) or (0.0, 0.0)
    assert low == -high == -ticks.nice_limit(np.abs(values).max())


def test_a_range_that_no_scale_takes_is_none() -> None:
    assert full_range([], signed=True) is None
    assert full_range([np.nan, np.inf], signed=False) is None
    assert full_range([3.0, 3.0], signed=False) is None
    assert usable_range(2.0, -1.0) == (-1.0, 2.0)
    assert usable_range(0.0, LARGEST_END) == (0.0, LARGEST_END)
    assert usable_range(-LARGEST_END, 0.0) == (-LARGEST_END, 0.0)
    assert usable_range(0.0, np.nextafter(LARGEST_END, np.inf)) is None
    assert usable_range(1000.0, 1000.0 + 0.9e-6) is None
    assert usable_range(1000.0, 1000.0 + 1.1e-6) is not None
    flat = made_up(values=np.full((3, 27, 31), 3.0))  # then the robust one
    assert choose_scales(flat, ScaleChoice(full=True)) == choose_scales(flat)


@given(seeds, st.floats(1e-2, 1e3))
def test_the_range_grows_with_the_values(seed: int, factor: float) -> None:
    values = np.random.default_rng(seed).standard_cauchy(3000)
    before, after = robust_range(values, True)[1], robust_range(factor * values, True)[1]
    assert factor / 1.6 < after / before < factor * 1.6


@given(seeds)
def test_rounding_errors_of_a_balanced_robot_count_as_zero(seed: int) -> None:
    noise = 0.1 * NEGLIGIBLE * np.random.default_rng(seed).standard_normal(100)
    assert robust_range(noise, signed=True) == (-1.0, 1.0)
    assert robust_range(np.abs(noise), signed=False) == (0.0, 1.0)


@pytest.mark.parametrize("signed", [True, False])
@pytest.mark.parametrize("values", [[], [np.nan], [np.inf, -np.inf], [0.0], [7.0] * 9, [-3.0] * 4])
def test_constant_infinite_and_missing_data_give_a_scale(values: list[float], signed: bool) -> None:
    low, high = robust_range(values, signed)
    Scale(low, high)
    finite = np.array(values)[np.isfinite(values)]
    assert (finite >= low).all()
    assert (finite <= high).all()


def test_magnitudes_far_from_zero_keep_their_own_range() -> None:
    assert robust_range(np.linspace(182.0, 249.0, 500), signed=False) == (180.0, 250.0)


def test_range_shows_torques_near_the_center() -> None:
    data = real()
    scale = choose_scales(data)[0]
    x, y = np.meshgrid(data.x, data.y)
    inner = np.hypot(x, y) < 0.15
    largest = np.nanmax(np.abs(data.values[:, inner]))
    assert largest < scale.high < 6 * largest
    assert np.nanmax(np.abs(data.values)) > 10 * scale.high  # the explosion is there


def test_range_grows_with_the_robots_masses() -> None:
    light = choose_scales(real())[0]
    heavy = real(design=APPENDIX_4.vary({"links.b8": 4.0}))
    factor = np.nanmedian(np.abs(heavy.values)) / np.nanmedian(np.abs(real().values))
    assert factor > 2
    assert choose_scales(heavy)[0].high == pytest.approx(factor * light.high, rel=0.35)


def test_one_range_for_all_or_one_for_each() -> None:
    data = made_up(values=made_up().values * np.array([1.0, 10.0, 100.0])[:, None, None])
    assert len(set(choose_scales(data))) == 1
    own = choose_scales(data, ScaleChoice(shared=False))
    assert own[0].high < own[1].high < own[2].high
    for shared in (True, False):  # a manual range is kept as it is
        scales = choose_scales(data, ScaleChoice(-1.234, 5.678, shared=shared))
        assert {(scale.low, scale.high) for scale in scales} == {(-1.234, 5.678)}


def test_a_coarser_sample_gives_the_ordinary_range_and_all_values_the_full_one() -> None:
    data, sample = made_up(), made_up(values=100.0 * made_up().values)
    assert choose_scales(data, sample=sample) == choose_scales(sample)
    everything = ScaleChoice(full=True)
    assert choose_scales(data, everything, sample) == choose_scales(data, everything)
    magnitude = made_up(values=np.abs(data.values), signed=False, bounded=True)
    assert choose_scales(magnitude, sample=sample) == choose_scales(magnitude, everything)
    signed = made_up(bounded=True)
    assert choose_scales(signed) == choose_scales(data) != choose_scales(data, everything)


def test_a_range_by_hand_has_no_colors_for_values_that_cannot_be() -> None:
    magnitude = made_up(values=np.abs(made_up().values), signed=False)
    both = ScaleChoice(-2.0, 5.0)
    assert choose_scales(magnitude, both)[0].low == 0.0
    for data in (made_up(), made_up(signed=False)):  # there are negative values
        assert choose_scales(data, both)[0].low == -2.0
    for low, high in ((0.0, 5.0), (1.0, 5.0), (-5.0, 0.0), (-5.0, -1.0)):
        (scale, *_) = choose_scales(magnitude, ScaleChoice(low, high))
        assert (scale.low, scale.high) == (low, high)


@pytest.mark.parametrize("size", [0.04, 1.0, 3.0, 99.0, 1234.0])
def test_symlog_is_linear_up_to_a_hundredth_of_the_ends_power_of_ten(size: float) -> None:
    (scale, *_) = choose_scales(made_up(), ScaleChoice(-size / 2, size, kind="symlog"))
    assert scale.threshold <= size / 100 < 10 * scale.threshold
    np.testing.assert_allclose(np.log10(scale.threshold) % 1.0 % 1.0, 0.0, atol=1e-9)


def test_symlog_range_is_the_power_of_ten_that_holds_95_percent() -> None:
    log = ScaleChoice(kind="symlog")
    tail = np.concatenate([np.linspace(1.0, 2.0, 500), np.geomspace(2.0, 5e4, 337)])
    for factor in (1.0, -1.0):
        values = np.resize(factor * tail, (3, 27, 31))
        good = values[:, made_up().status == 0]
        (scale, *_) = choose_scales(made_up(values=values), log)
        limit = 10.0 ** np.ceil(np.log10(np.percentile(np.abs(good), 95.0)))
        assert (scale.low, scale.high) == (-limit, limit)
        (scale, *_) = choose_scales(made_up(values=values, signed=False), log)
        assert (scale.high == limit and scale.low >= 0) if factor > 0 else (
            scale.low == -limit and scale.high <= 0
        )  # fmt: skip
    calm = made_up(values=np.resize(np.linspace(-1.0, 1.0, 837), (3, 27, 31)))
    assert choose_scales(calm, log)[0].high == choose_scales(calm)[0].high
    nothing = made_up(values=np.full((3, 27, 31), np.nan))
    assert (choose_scales(nothing, log)[0].low, choose_scales(nothing, log)[0].high) == (-1.0, 1.0)


def test_symlog_range_is_wider() -> None:
    data = real()
    linear, log = (choose_scales(data, ScaleChoice(kind=kind))[0] for kind in ("linear", "symlog"))
    assert log.high > 5 * linear.high
    assert log.low == -log.high


@pytest.mark.parametrize(
    ("quantity", "table"), [("tau_1", colors.DIVERGING), ("max_torque", colors.SEQUENTIAL)]
)
def test_signed_quantities_diverge_and_magnitudes_do_not(quantity: str, table: str) -> None:
    assert choose_scales(real(quantities=(quantity,)))[0].colors == table


@pytest.mark.parametrize("kind", ["linear", "symlog"])
@pytest.mark.parametrize("quantity", ["pressure_1", "error_theta"])
def test_numbers_of_angles_are_round_as_displayed(quantity: str, kind: Kind) -> None:
    data = real(quantities=(quantity,))
    (scale,) = choose_scales(data, ScaleChoice(kind=kind))
    for value in (scale.low, scale.high, *scale.ticks(6), *scale.levels):
        shown = data.display.factor * value
        assert shown == pytest.approx(float(f"{shown:.2g}"), rel=1e-9)
    if kind == "linear":
        assert contours_text(data, (scale,)) in ("Contours every 10°.", "Contours every 20″.")


def test_scales_are_counted() -> None:
    data, scale = made_up(), Scale(0.0, 1.0)
    assert per_panel(data, scale) == (scale,) * 3
    with pytest.raises(InvalidScale):
        per_panel(data, [scale] * 2)


@pytest.mark.parametrize(
    ("quantity", "one"), [("deviation_x", 1e-6), ("deviation_horizontal", 1e-6), ("tau_1", 1.0)]
)
def test_zeros_have_the_colors_of_one_displayed_unit(quantity: str, one: float) -> None:
    still = APPENDIX_4.vary({"gravity": 0.0})
    (scale,) = choose_scales(real(21, quantities=(quantity,), design=still))
    assert (scale.low, scale.high) in ((0.0, one), (-one, one))


def test_what_grows_at_no_singularity_lies_within_its_colors() -> None:
    """It is largest about the center, where people work, and may be zero over half a map."""
    for theta, keys in (
        (-0.6, ("conditioning", "selective_theta", "horizontal_force", "moment")),
        (-0.6, ("acceleration", "turn_acceleration")),
        (-1.3, ("transmission_1",)),
    ):
        for key in keys:
            data = real(31, theta, -0.55, quantities=(key,))
            (scale,) = choose_scales(data)
            most = np.nanmax(data.values)
            assert scale.low <= np.nanmin(data.values), key
            assert most <= scale.high < 1.3 * most, key


@pytest.mark.slow
def test_bounded_quantities_show_all_their_values() -> None:
    """A frequency is zero at a singularity and largest at the center, where people work."""
    data = real(quantities=("frequency_1",))
    assert data.bounded
    (scale,) = choose_scales(data)
    finite = data.values[np.isfinite(data.values)]
    assert scale.low <= finite.min()
    assert finite.max() <= scale.high < 1.3 * finite.max()
    assert not real(quantities=("condition",)).bounded
