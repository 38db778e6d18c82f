"""Color ranges: robust near singularities, scaled by masses, blind to rounding errors."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.model import APPENDIX_4
from paminsa_viz.plots import colors
from paminsa_viz.plots.ranges import NEGLIGIBLE, ScaleChoice, choose_scales, per_panel, robust_range
from paminsa_viz.plots.scale import InvalidScale, Scale
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


def test_scales_are_counted() -> None:
    data, scale = made_up(), Scale(0.0, 1.0)
    assert per_panel(data, scale) == (scale,) * 3
    with pytest.raises(InvalidScale):
        per_panel(data, [scale] * 2)


def test_bounded_quantities_show_all_their_values() -> None:
    """A frequency is zero at a singularity and largest at the center, where people work."""
    data = real(quantities=("frequency_1",))
    assert data.bounded
    (scale,) = choose_scales(data)
    finite = data.values[np.isfinite(data.values)]
    assert scale.low <= finite.min()
    assert finite.max() <= scale.high < 1.3 * finite.max()
    assert not real(quantities=("condition",)).bounded
