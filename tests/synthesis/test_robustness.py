"""Fractions of robots built within tolerances: coverage of the interval, draws, causes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from paminsa_viz.errors import InvalidInput
from paminsa_viz.model import APPENDIX_4, Counterweight
from paminsa_viz.model.accuracy import NO_TOLERANCES, Tolerances
from paminsa_viz.model.design import Design
from paminsa_viz.studies.executors import processes
from paminsa_viz.synthesis.answer.checks import build_yield, built_robots, fraction


def crank_margin(design: Design) -> dict[str, float]:
    """Margin to a crank of at most 0.4201 m, and of at least 0.41985 m."""
    crank = design.geometry.crank_length
    return {"long": 0.4201 - crank, "short": crank - 0.41985}


@pytest.mark.parametrize("true", [0.02, 0.5, 0.9])
def test_interval_covers_a_known_part_as_often_as_it_says(true):
    n = 60
    rng = np.random.default_rng(1)
    found = [fraction(int(k), n, 0.9) for k in rng.binomial(n, true, 2000)]
    covered = np.mean([f.low <= true <= f.high for f in found])
    assert 0.9 - 0.02 <= covered <= 0.995


def test_interval_is_that_of_the_binomial_tails():
    from scipy.stats import binomtest

    for passed, samples in ((0, 10), (3, 17), (17, 17), (199, 400)):
        found = fraction(passed, samples, 0.95)
        reference = binomtest(passed, samples).proportion_ci(0.95, method="exact")
        assert (found.low, found.high) == pytest.approx((reference.low, reference.high), abs=1e-12)


def test_yield_of_a_known_uniform_part():
    found = build_yield(APPENDIX_4, crank_margin, samples=500, seed=3)
    # +-0.2 mm, of which +0.1 mm and -0.15 mm are allowed: 5/8
    assert found.fraction.low <= 0.625 <= found.fraction.high
    assert list(found.missed) == ["long", "short"]
    assert sum(found.missed.values()) == 500 - found.fraction.passed
    assert found.worst["long"] == pytest.approx(-1e-4, abs=2e-6)


def test_same_seed_same_robots_wherever_they_are_measured():
    first = build_yield(APPENDIX_4, crank_margin, samples=40, seed=7)
    other = build_yield(APPENDIX_4, crank_margin, samples=40, seed=8)
    assert first.worst != other.worst
    with processes(1) as workers:
        assert build_yield(APPENDIX_4, crank_margin, samples=40, seed=7, workers=workers).worst == (
            first.worst
        )


def test_robots_are_within_their_tolerances():
    exact = replace(APPENDIX_4, tolerances=NO_TOLERANCES)
    (same,) = built_robots(exact, 1, mass_tolerance=0.0)
    for path in ("coupler_length", "magnification", "platform_joint_height"):
        name = f"geometry.{path}"
        assert same.value(name) == pytest.approx(APPENDIX_4.value(name), rel=1e-15)
    design = replace(
        APPENDIX_4,
        tolerances=Tolerances(bar=1e-3, guide_height=0.0, joint_height=5e-4),
        counterweights=(Counterweight("b8", 8, 0.1, 2.0),),
    )
    robots = built_robots(design, 300, mass_tolerance=0.1, seed=2)
    for path, nominal, most in (
        ("geometry.crank_length", 0.42, 1e-3), ("geometry.coupler_length", 0.63, 2e-3),
        ("geometry.platform_joint_height", 0.0275, 5e-4), ("geometry.base_radius", 0.35, 2e-4),
        ("counterweights.0.mass", 2.0, 0.2), ("links.b4", design.links.b4, 0.1 * design.links.b4),
    ):  # fmt: skip
        off = np.array([robot.value(path) - nominal for robot in robots])
        assert 0.9 * most < np.abs(off).max() <= most * (1 + 1e-9)
        assert off.min() < 0 < off.max()
    for robot in robots:
        ratio = robot.links.b4 / design.links.b4
        assert robot.inertias.b4_axial == pytest.approx(ratio * design.inertias.b4_axial)
        assert robot.payload == design.payload
        # B7 as drilled: joint 4 is at l_B4/k from 9
        part = robot.geometry.coupler_length / robot.geometry.magnification
        assert abs(part - 0.21) <= 1e-3 * (1 + 1e-9)


def test_it_can_be_canceled_and_says_so():
    found = build_yield(APPENDIX_4, crank_margin, samples=100, progress=lambda done, _: done >= 16)
    assert found.canceled
    assert found.fraction.samples == 16
    nan = build_yield(APPENDIX_4, lambda _: {"torque": float("nan")}, samples=3)
    assert nan.missed == {"torque": 3}
    assert nan.fraction.high < 1


def test_wrong_numbers_are_refused():
    for samples, tolerance, confidence in ((0, 0.1, 0.9), (5, 1.0, 0.9), (5, 0.1, 1.0)):
        with pytest.raises(InvalidInput):
            build_yield(
                APPENDIX_4, crank_margin, samples=samples, mass_tolerance=tolerance,
                confidence=confidence,
            )  # fmt: skip
    with pytest.raises(InvalidInput):
        fraction(3, 2)
