"""Intervals and significance over many noisy logs: what is stated is what happens."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any, NamedTuple

import numpy as np
import pytest

from paminsa_viz.identification import (
    Identification,
    IdentificationSettings,
    find_causes,
    identify,
)
from paminsa_viz.model import APPENDIX_4, Friction
from tests.support.identification_logs import simulated

DESIGN = replace(APPENDIX_4, friction=Friction(0.3, 0.4, 20.0, 8.0))
QUICK = IdentificationSettings(robustness=False)
MOTIONS, NOISES = 10, 15
RATE = 100.0
"""Samples a second. The noise is correlated over 20 ms, two samples, and the filter passes 10 Hz:
more samples cost time and say nothing else about intervals."""

SEARCHED = 3
"""Logs of each motion that are searched for causes: 30 in all."""


def errors_over_half_widths(found: Identification) -> list[float]:
    return [(item.value - item.parameter.design) / item.half_width for item in found.estimates]


class Study(NamedTuple):
    """Estimates of all logs: errors over half widths (150, p), z of the identity, logs accused."""

    errors: Any
    z: Any
    accused: int


@cache
def study() -> Study:
    errors, z, accused = [], [], 0
    for motion in range(1, MOTIONS + 1):
        for noise in range(NOISES):
            log = simulated(motion, DESIGN, noise_seed=100 * motion + noise, rate=RATE)
            found = identify(DESIGN, log, QUICK)
            errors.append(errors_over_half_widths(found))
            z.append(found.identity.z)
            if noise < SEARCHED:
                accused += bool(find_causes(found).named)
    return Study(np.array(errors), np.array(z), accused)


@pytest.mark.slow
def test_intervals_cover_the_truth_as_often_as_they_say() -> None:
    coverage = (np.abs(study().errors) <= 1).mean(axis=0)
    assert 0.93 <= coverage.mean() <= 0.97
    assert coverage.min() >= 0.88


@pytest.mark.slow
def test_intervals_of_a_low_cut_off_cover_the_truth_as_often() -> None:
    """A part of the motion is above 1 Hz, and residuals are correlated over a second."""
    settings = replace(QUICK, cut_off=1.0)
    errors = [
        errors_over_half_widths(
            identify(DESIGN, simulated(motion, DESIGN, noise_seed=noise, rate=RATE), settings)
        )
        for motion in range(1, MOTIONS + 1)
        for noise in range(8)
    ]
    coverage = (np.abs(errors) <= 1).mean(axis=0)
    assert 0.92 <= coverage.mean() <= 0.97
    assert coverage.min() >= 0.85


@pytest.mark.slow
def test_a_right_robot_is_hardly_ever_accused() -> None:
    assert study().accused == 0
    judged = study().z[np.isfinite(study().z)]
    assert len(judged) > 0.98 * len(study().z)
    assert (np.abs(judged) < 3).mean() > 0.98
    assert 0.8 < np.std(judged) < 1.2


@pytest.mark.slow
def test_results_do_not_depend_on_the_cut_off() -> None:
    log = simulated(1, DESIGN)
    middle, low, high = (
        identify(DESIGN, log, replace(QUICK, cut_off=cut_off)) for cut_off in (10.0, 8.0, 12.0)
    )
    error = middle.solution.deviation(middle.model.report)
    for other in (low, high):
        move = [b.value - a.value for a, b in zip(middle.estimates, other.estimates, strict=True)]
        assert (np.abs(move) < error).all()
