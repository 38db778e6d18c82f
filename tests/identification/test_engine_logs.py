"""Logs of MuJoCo's robot: no formula of the model is in them."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.engines.simulated_log import (
    NO_DEFECTS,
    NO_NOISE,
    Defects,
    HeavierBar,
    LogNoise,
    simulate_log,
)
from paminsa_viz.identification import (
    BASE_SYMBOLS,
    IdentificationSettings,
    base_parameters,
    find_causes,
    identify,
    make_log,
)
from paminsa_viz.identification.causes import SPRING
from paminsa_viz.model import APPENDIX_4, Design, Friction, KneeBranch
from paminsa_viz.trajectory import Trajectory
from tests.support.identification_logs import multi_sine

pytest.importorskip("mujoco")

DESIGN = replace(APPENDIX_4, friction=Friction(0.3, 0.4, 20.0, 8.0))
QUICK = IdentificationSettings(robustness=False)


def engine_log(design: Design, *, rate: float = 50.0, **options: Any) -> Any:
    """A log of 20 s at 50 Hz, five times what the filter passes; telling bars apart takes more."""
    t = np.arange(round(20.0 * rate) + 1) / rate
    motion = Trajectory(t, *multi_sine(1, design)(t))
    return make_log(*simulate_log(design, motion, rate=rate, **options))


@pytest.mark.slow
@pytest.mark.parametrize("knee", list(KneeBranch))
def test_a_clean_log_of_an_engine_gives_the_design_to_a_thousandth(knee: KneeBranch) -> None:
    design = DESIGN.with_knee(knee)
    found = identify(design, engine_log(design, noise=NO_NOISE), QUICK)
    values = base_parameters(design)
    for place, symbol in enumerate(BASE_SYMBOLS):
        if symbol not in ("b_9", "b_10"):  # the log hardly tells these
            assert found.estimate(symbol).value == pytest.approx(values[place], rel=1e-3)
    for kind in ("viscous", "coulomb"):
        for item in (item for item in found.estimates if item.parameter.kind == kind):
            assert item.value == pytest.approx(item.parameter.design, rel=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("leg", [0, 1])
def test_a_heavier_bar_is_named_first(leg: int) -> None:
    defects = Defects(bars=(HeavierBar(leg, "B4", 1.2),))
    log = engine_log(DESIGN, rate=100.0, noise=LogNoise(), defects=defects)
    found = find_causes(identify(APPENDIX_4, log, QUICK))
    assert found.named[0].leg == leg + 1
    assert found.named[0].label == f"leg {leg + 1}: B4 heavier"
    assert found.named[0].value == pytest.approx(0.2, abs=0.03)
    # With masses of its own for each leg the same shows as contrasts, and nothing is left over.
    legs = identify(APPENDIX_4, log, replace(QUICK, legs=True))
    imbalance = 0.2 * DESIGN.links.b4 * DESIGN.gravity / 2
    for other in range(3):
        contrast = legs.estimate(f"ΔM_p2, leg {other + 1}")
        expected = imbalance * (2 / 3 if other == leg else -1 / 3)
        assert contrast.value == pytest.approx(expected, abs=1.5 * contrast.half_width)
        assert contrast.half_width < 0.1
    assert find_causes(legs).named == ()


@pytest.mark.slow
def test_a_spring_breaks_the_identity() -> None:
    force = 0.3 * base_parameters(DESIGN)[1]
    right, wrong = (
        identify(APPENDIX_4, engine_log(DESIGN, noise=LogNoise(), defects=defects), QUICK)
        for defects in (NO_DEFECTS, Defects(spring=force))
    )
    assert abs(right.identity.z) < 3
    assert right.identity.holds
    assert abs(wrong.identity.z) > 4
    assert wrong.identity.value == pytest.approx(-force, abs=1.5 * wrong.identity.half_width)
    assert find_causes(wrong).named[0].label == SPRING


@pytest.mark.slow
@pytest.mark.parametrize(
    ("label", "size", "most", "defects"),
    [
        ("encoder zero of M2", np.radians(0.5), np.radians(0.1),
         Defects(encoder_zero=(0.0, np.radians(0.5), 0.0, 0.0))),
        ("gain of M3", 0.05, 0.015, Defects(gain=(1.0, 1.0, 1.05, 1.0))),
        ("delay of the torques", 5e-3, 1e-3, Defects(delay=5e-3)),
    ],
    ids=["zero", "gain", "delay"],
)  # fmt: skip
def test_faults_of_sensors_are_named_with_their_size(
    label: str, size: float, most: float, defects: Defects
) -> None:
    log = engine_log(DESIGN, noise=LogNoise(), defects=defects)
    first = find_causes(identify(APPENDIX_4, log, QUICK)).named[0]
    assert first.label == label
    assert first.value == pytest.approx(size, abs=most)
