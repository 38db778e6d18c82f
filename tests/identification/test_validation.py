"""A second log validates, a third weighs a payload."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.errors import InvalidInput
from paminsa_viz.files.example_logs import ExampleLog, example_log
from paminsa_viz.identification import (
    IdentificationSettings,
    identify,
    make_log,
    validate,
    weigh_payload,
)
from paminsa_viz.model import APPENDIX_4, Friction, Payload
from tests.support.identification_logs import simulated

DESIGN = replace(APPENDIX_4, friction=Friction(0.3, 0.4, 20.0, 8.0))
LOADED = replace(DESIGN, payload=Payload(2.0, 0.01))
QUICK = IdentificationSettings(robustness=False)


@pytest.fixture(scope="module")
def identified() -> Any:
    return identify(APPENDIX_4, simulated(1, DESIGN), QUICK)


@pytest.mark.parametrize("motion", [2, 3])
def test_another_motion_is_predicted_almost_as_well_as_its_own_fit(
    identified: Any, motion: int
) -> None:
    found = validate(identified, simulated(motion, DESIGN, noise_seed=7))
    assert found.ratio.max() <= 1.1
    assert found.holds
    np.testing.assert_allclose(
        found.residual, np.sqrt(((found.measured - found.predicted) ** 2).mean(axis=0))
    )


def test_another_robot_is_not_validated(identified: Any) -> None:
    heavier = DESIGN.vary({"links.b4": 0.8})
    assert not validate(identified, simulated(2, heavier)).holds


def test_a_delay_holds_for_the_second_log_too() -> None:
    def late(log: Any) -> Any:
        return make_log(log.t[8:], log.position[8:], log.torque[:-8])

    found = identify(APPENDIX_4, late(simulated(1, DESIGN)), replace(QUICK, delay=True))
    assert validate(found, late(simulated(2, DESIGN, noise_seed=5))).holds
    assert not validate(found, simulated(2, DESIGN, noise_seed=5)).holds


@pytest.mark.parametrize("seed", range(3))
def test_a_payload_is_weighed(identified: Any, seed: int) -> None:
    found = weigh_payload(identified, simulated(2, LOADED, noise_seed=seed))
    assert found.mass == pytest.approx(2.0, abs=0.06)
    assert found.half_width < 0.06
    assert found.inertia == pytest.approx(0.01, abs=2 * found.inertia_half_width)
    # If F_4's offset may drift, the mass follows from inertia alone.
    assert found.free_half_width > 1.2 * found.half_width
    assert found.free_mass == pytest.approx(2.0, abs=1.5 * found.free_half_width)
    assert abs(found.drift) < 1.5 * found.drift_half_width
    assert found.gain is None


def test_a_drift_is_found_with_the_payload(identified: Any) -> None:
    log = simulated(2, LOADED)
    drifted = make_log(log.t, log.position, log.torque + np.array([0, 0, 0, 15.0]))
    found = weigh_payload(identified, drifted)
    assert found.mass - 2.0 > 1.5 * found.half_width  # partly taken for weight
    assert found.free_mass == pytest.approx(2.0, abs=1.5 * found.free_half_width)
    assert found.drift == pytest.approx(15.0, abs=1.5 * found.drift_half_width)


def test_a_known_payload_shows_a_common_gain() -> None:
    first, third = (simulated(i, item) for i, item in ((1, DESIGN), (2, LOADED)))
    first, third = (make_log(log.t, log.position, 1.1 * log.torque) for log in (first, third))
    found = weigh_payload(identify(APPENDIX_4, first, QUICK), third, known=2.0)
    assert found.gain is not None
    gain, half_width = found.gain
    assert gain == pytest.approx(1.1, abs=0.03)
    assert 0 < half_width < 0.03


def test_a_known_payload_may_be_light(identified: Any) -> None:
    """The gain is in proportion to the mass that the log shows for each kilogram put on."""
    log = simulated(2, LOADED)
    gains = [weigh_payload(identified, log, known=known).gain for known in (2.0, 0.5)]
    assert gains[0] is not None
    assert gains[1] is not None
    assert gains[1][0] == pytest.approx(4.0 * gains[0][0], rel=1e-9)


def test_an_impossible_payload_is_refused(identified: Any) -> None:
    with pytest.raises(InvalidInput, match=r"payload: .*above 0 kg"):
        weigh_payload(identified, identified.log, known=0.0)


def test_shipped_logs_validate_and_weigh_two_kilograms() -> None:
    logs = {kind: example_log(kind) for kind in ExampleLog}
    best = identify(APPENDIX_4, logs[ExampleLog.BEST], QUICK)
    assert validate(best, logs[ExampleLog.OTHER]).ratio.max() <= 1.1
    assert not validate(best, logs[ExampleLog.PAYLOAD]).holds
    found = weigh_payload(best, logs[ExampleLog.PAYLOAD])
    assert found.mass == pytest.approx(2.0, abs=0.06)
    assert abs(found.mass - 2.0) < 1.5 * found.half_width
    assert found.free_half_width > found.half_width
    assert abs(found.free_mass - 2.0) < 1.5 * found.free_half_width
