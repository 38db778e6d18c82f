"""Further logs: what one log says predicts another; a payload with and without a drift of F_4."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from paminsa_viz.errors import InvalidInput
from paminsa_viz.files.example_logs import ExampleLog, example_log
from paminsa_viz.identification import identify, make_log
from paminsa_viz.identification.second_log import payload_between, validate
from paminsa_viz.model import APPENDIX_4


@pytest.fixture(scope="module")
def logs():
    return {kind: example_log(kind) for kind in ExampleLog}


@pytest.fixture(scope="module")
def found(logs):
    return {kind: identify(log, APPENDIX_4) for kind, log in logs.items()}


def test_identified_on_one_motion_predicts_another(logs, found) -> None:
    best, other = found[ExampleLog.BEST], logs[ExampleLog.OTHER]
    check = validate(best, other)
    assert np.all(check.ratio >= 1.0 - 1e-9)
    assert np.all(check.ratio <= 1.1)
    wrong = validate(best, logs[ExampleLog.PAYLOAD])
    assert wrong.ratio[3] > 3.0


def test_payload_of_two_kilograms(found) -> None:
    best, loaded = found[ExampleLog.BEST], found[ExampleLog.PAYLOAD]
    payload = payload_between(best, loaded)
    assert payload.mass == pytest.approx(2.0, abs=0.06)
    assert abs(payload.mass - 2.0) < 1.5 * payload.half_width
    assert payload.free_half_width > payload.half_width
    assert abs(payload.free_mass - 2.0) < 1.5 * payload.free_half_width
    assert abs(payload.drift) < 1.5 * payload.drift_half_width
    assert payload.gain is None


def test_drift_of_the_force_goes_into_the_trusted_payload_alone(logs, found) -> None:
    log = logs[ExampleLog.PAYLOAD]
    drifted = make_log(log.t, log.position, log.torque + np.array([0.0, 0.0, 0.0, 20.0]))
    loaded = identify(drifted, APPENDIX_4)
    before = payload_between(found[ExampleLog.BEST], found[ExampleLog.PAYLOAD])
    after = payload_between(found[ExampleLog.BEST], loaded)
    lever = 3 * APPENDIX_4.geometry.magnification
    assert after.mass - before.mass == pytest.approx(60.0 / lever / APPENDIX_4.gravity, rel=1e-3)
    assert after.free_mass == pytest.approx(before.free_mass, abs=1e-3)
    assert after.drift - before.drift == pytest.approx(20.0, rel=1e-2)


def test_known_payload_gives_the_common_gain(logs, found) -> None:
    gain = 1.05

    def scaled(kind):
        log = logs[kind]
        return identify(make_log(log.t, log.position, gain * log.torque), APPENDIX_4)

    payload = payload_between(scaled(ExampleLog.BEST), scaled(ExampleLog.PAYLOAD), 2.0)
    assert payload.gain is not None
    value, half = payload.gain
    plain = payload_between(found[ExampleLog.BEST], found[ExampleLog.PAYLOAD]).mass / 2.0
    assert value == pytest.approx(gain * plain, rel=1e-6)
    assert abs(value - gain) < max(1.5 * half, 0.015)


@pytest.mark.parametrize("mass", [0.0, -1.0, float("nan")])
def test_impossible_payloads_are_refused(found, mass) -> None:
    best = found[ExampleLog.BEST]
    with pytest.raises(InvalidInput, match="payload"):
        payload_between(best, best, mass)


def test_logs_that_do_not_tell_the_weight_are_refused(found) -> None:
    best = found[ExampleLog.BEST]
    lost = replace(
        best,
        estimates=tuple(replace(item, half_width=np.inf) for item in best.estimates),
    )
    with pytest.raises(InvalidInput, match="M4 has to move"):
        payload_between(best, lost)
