"""Filters and differences of logs: exact on polynomials, halved at the cut-off, thinned out."""

from __future__ import annotations

import tracemalloc
from typing import Any

import numpy as np
import pytest
from scipy.signal import butter, sosfiltfilt

from paminsa_viz.errors import InvalidInput
from paminsa_viz.identification import InvalidLog, log_poses, make_log
from paminsa_viz.identification.estimate import half_widths, normal_blocks, solve
from paminsa_viz.identification.filtering import (
    _FIRST,
    _REACH,
    _SECOND,
    LOWEST_RATE,
    OVERSAMPLING,
    POSITION_CUT_OFF,
    SETTLING,
    MotionSamples,
    Signals,
    _difference,
    _rates,
    filter_log,
    position_cut_off,
    smoothed,
    thinning_for,
)
from paminsa_viz.model import APPENDIX_4
from paminsa_viz.model.reach import Limit, reach_status
from paminsa_viz.units import rounded_to_side
from tests.identification.test_estimate import random_columns
from tests.support.identification_logs import HARMONICS, PERIOD, clean_signals, multi_sine


@pytest.mark.parametrize("degree", range(7))
def test_differences_of_sixth_order_are_exact_on_polynomials(degree: int) -> None:
    x = np.arange(-8.0, 9.0)
    curve = np.polynomial.Polynomial(np.random.default_rng(degree).normal(size=degree + 1) / 50)
    for order, weights in ((1, _FIRST), (2, _SECOND)):
        found = _difference(np.stack([curve(x), 2 * curve(x)], axis=1), weights)
        expected = curve.deriv(order)(x[_REACH:-_REACH])
        scale = np.abs(curve(x)).max()
        np.testing.assert_allclose(found, np.stack([expected, 2 * expected], 1), atol=1e-12 * scale)


def test_rates_do_not_reach_over_gaps() -> None:
    segment = np.repeat([0, 1], [20, 15])
    values = np.where(segment == 0, np.arange(35.0), 100.0 - 2.0 * np.arange(35.0))[:, None]
    found = _rates(values, segment)[:, 0]
    expected = np.where(segment == 0, 1.0, -2.0)
    for begin, end in ((0, 20), (20, 35)):
        expected[begin : begin + _REACH] = expected[end - _REACH : end] = 0.0
    np.testing.assert_allclose(found, expected, atol=1e-12)


def test_as_many_samples_are_kept_as_the_band_needs() -> None:
    assert thinning_for(10.0 * OVERSAMPLING, 10.0) == 1
    assert thinning_for(39.9 * OVERSAMPLING, 10.0) == 3
    assert thinning_for(40.0 * OVERSAMPLING, 10.0) == 4
    assert thinning_for(1.0, 10.0) == 1
    assert thinning_for(1000.0, 2.0) == thinning_for(1000.0, POSITION_CUT_OFF) == 10


def test_a_low_cut_off_is_not_that_of_the_positions() -> None:
    """They would lose a part of the motion that the torques keep, which shifts all results."""
    assert position_cut_off(1000.0, 12.0) == 12.0
    assert position_cut_off(1000.0, 1.0) == POSITION_CUT_OFF
    assert position_cut_off(20.0, 1.0) == 20.0 / LOWEST_RATE
    rate, top = 100.0, HARMONICS / PERIOD
    log = make_log(*clean_signals(1, duration=10.0, rate=rate))
    pose, pieces = log_poses(APPENDIX_4.geometry, log)
    found = filter_log(log, APPENDIX_4.geometry, pose, pieces, cut_off=top, transition_speed=0.01)
    for filtered, exact in zip(
        (found.pose, found.velocity, found.acceleration), multi_sine(1)(found.t), strict=True
    ):
        np.testing.assert_allclose(filtered, exact, atol=1e-3 * np.abs(exact).max())


def test_cut_offs_are_possible_from_above_nothing_to_a_share_of_the_rate() -> None:
    log = make_log(*clean_signals(1, duration=20.0, rate=200.0))
    pose, pieces = log_poses(APPENDIX_4.geometry, log)
    most = log.rate / LOWEST_RATE

    def filtered(cut_off: float) -> Any:
        return filter_log(
            log, APPENDIX_4.geometry, pose, pieces, cut_off=cut_off, transition_speed=0.01
        )

    for possible in (0.7, most):
        assert np.isfinite(filtered(possible).torque).all()
    for impossible in (0.0, -1.0, np.nextafter(most, np.inf), np.nan, np.inf):
        with pytest.raises(InvalidInput, match=f"above 0 and at most {most:g} Hz is needed"):
            filtered(impossible)


@pytest.mark.parametrize(("rate", "cut_off"), [(125.0, 10.0), (40.0, 10.0)])
def test_columns_of_long_logs_are_filtered_piece_by_piece_in_little_memory(rate, cut_off) -> None:
    sizes, settle = [1500, 2500, 1000], round(2 * SETTLING / cut_off * rate)
    segment = np.repeat([0, 1, 2], sizes)
    kept = np.concatenate([np.abs(np.arange(n) - n / 2) < n / 2 - settle for n in sizes])
    motion = np.zeros((len(segment), 4))
    samples = MotionSamples(segment, kept, *[motion] * 7)
    values = np.cumsum(np.random.default_rng(1).normal(size=(len(segment), 4, 11)), axis=0)
    values[:, 1, 5] = 0.0
    sections: Any = butter(4, cut_off, fs=rate, output="sos")
    tracemalloc.start()
    found = smoothed(values, samples, sections)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert most < 3.0 * values.nbytes  # what is returned, and some columns at a time
    parts = [segment == number for number in range(3)]
    whole = [
        sosfiltfilt(sections, values[part], axis=0, padlen=size - 1)  # as long as there is any
        for part, size in zip(parts, sizes, strict=True)
    ]
    expected = np.concatenate(whole)[kept]
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-13 * np.abs(values).max())


@pytest.mark.parametrize("thinning", [1, 2])
def test_torques_are_halved_at_the_cut_off_and_keep_their_rate_below_it(thinning: int) -> None:
    """Forward and backward: no delay; four times the cut-off is as good as gone."""
    t, position, torque = clean_signals(1, duration=10.0, rate=400.0)
    waves = {frequency: np.sin(2 * np.pi * frequency * t) for frequency in (1.0, 8.0, 32.0)}
    for place, wave in enumerate(waves.values()):
        torque = np.column_stack([torque[:, :place], wave, torque[:, place + 1 :]])
    log = make_log(t, position, torque)
    pose, pieces = log_poses(APPENDIX_4.geometry, log)
    found = filter_log(
        log, APPENDIX_4.geometry, pose, pieces,
        cut_off=8.0, transition_speed=0.01, thinning=thinning,
    )  # fmt: skip
    assert found.step == pytest.approx(thinning / 400.0)
    for place, (frequency, gain) in enumerate(((1.0, 1.0), (8.0, 0.5), (32.0, 0.0))):
        phase = 2 * np.pi * frequency * found.t
        np.testing.assert_allclose(found.torque[:, place], gain * np.sin(phase), atol=0.02)
        rate = gain * 2 * np.pi * frequency * np.cos(phase)
        np.testing.assert_allclose(found.torque_rate[:, place], rate, atol=0.04 * 2 * np.pi * 8.0)


def test_correlated_noise_widens_intervals_as_much_as_it_counts_less() -> None:
    """Each sample four times over, noise and all, is a quarter of the samples that it seems."""
    columns, x, numbers = random_columns(4, samples=600)
    torque = columns @ x + np.random.default_rng(1).standard_normal((600, 4))
    once = solve(normal_blocks(columns, torque, numbers))
    often = [np.repeat(part, 4, axis=0) for part in (columns, torque, numbers)]
    four = solve(normal_blocks(*often))
    assert once.widening == pytest.approx(1.0, abs=0.4)
    assert four.widening == pytest.approx(2.0 * once.widening, rel=1e-6)
    np.testing.assert_allclose(four.deviation(np.eye(5)), once.deviation(np.eye(5)), rtol=1e-6)
    # Student's t at 97.5 % of two and of many degrees of freedom
    assert half_widths(3) == pytest.approx(4.30265, rel=1e-5)
    assert half_widths(100_000) == pytest.approx(1.95996, rel=1e-4)


@pytest.mark.parametrize("thinning", [1, 3])
def test_a_piece_settles_at_both_ends_and_is_long_enough_or_refused(thinning: int) -> None:
    """Two passes take `SETTLING` periods of their cut-offs, differences their reach twice."""
    rate, cut_off = 400.0, 8.0
    settle = round((SETTLING / POSITION_CUT_OFF + SETTLING / cut_off) * rate / thinning)
    least = (2 * settle + 4 * _REACH) * thinning
    signals = clean_signals(1, duration=(least + 30) / rate, rate=rate)

    def filtered(count: int) -> Signals:
        log = make_log(*(part[:count] for part in signals))
        pose, pieces = log_poses(APPENDIX_4.geometry, log)
        return filter_log(
            log, APPENDIX_4.geometry, pose, pieces,
            cut_off=cut_off, transition_speed=0.01, thinning=thinning,
        )  # fmt: skip

    found = filtered(least + 30)
    ends = (_REACH + (settle + _REACH) * thinning) / rate
    assert found.t[0] == pytest.approx(ends, abs=1e-9)
    assert found.t[-1] == pytest.approx((least + 29) / rate - ends, abs=1.5 * thinning / rate)
    assert len(filtered(least + thinning).t) >= 1
    needed = rounded_to_side(least / rate, 3, up=True)
    with pytest.raises(InvalidLog, match=f"of at least {needed:.3g} s is needed"):
        filtered(least)


def test_a_filtered_motion_that_leaves_the_workspace_is_named_with_its_time(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    t, position, torque = clean_signals(1, duration=4.0, rate=200.0)
    log = make_log(t, position, torque)
    pose, pieces = log_poses(APPENDIX_4.geometry, log)
    lost = []

    def status(geometry, poses):
        found, leg = reach_status(geometry, poses)
        lost.append(len(found) // 2)
        found[lost[0] : lost[0] + 5] = Limit.GUIDE
        return found, leg

    monkeypatch.setattr("paminsa_viz.identification.filtering.reach_status", status)
    with pytest.raises(InvalidLog, match="the filtered motion is out of reach") as caught:
        filter_log(
            log, APPENDIX_4.geometry, pose, pieces, cut_off=8.0, transition_speed=0.01, thinning=1
        )
    assert float(caught.value.problem.split()[1]) == pytest.approx(
        t[2 * _REACH + lost[0]], abs=1e-9
    )
