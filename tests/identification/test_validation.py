"""A second log validates, a third weighs a payload."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.errors import InvalidInput
from paminsa_viz.files.example_logs import ExampleLog, example_log
from paminsa_viz.identification import (
    IdentificationSettings,
    InvalidLog,
    identify,
    make_log,
    validate,
    validation,
    weigh_payload,
)
from paminsa_viz.identification.estimate import normal_blocks, solve
from paminsa_viz.identification.log_poses import log_poses
from paminsa_viz.identification.validation import Validation, _step
from paminsa_viz.model import APPENDIX_4, Drive, Friction, LoadCase, Payload
from tests.identification.test_estimate import random_columns
from tests.support.identification_logs import simulated

DESIGN = replace(APPENDIX_4, friction=Friction(0.3, 0.4, 20.0, 8.0))
LOADED = replace(DESIGN, payload=Payload(2.0, 0.01))
QUICK = IdentificationSettings(robustness=False)


@pytest.fixture(scope="module")
def identified() -> Any:
    return identify(APPENDIX_4, simulated(1, DESIGN), QUICK)


@pytest.mark.slow
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


@pytest.mark.slow
def test_logs_without_noise_validate_however_much_better_the_own_fit_is() -> None:
    found = validate(
        identify(APPENDIX_4, simulated(1, DESIGN, noise_seed=None), QUICK),
        simulated(4, DESIGN, noise_seed=None),
    )
    assert found.ratio.max() > 1.1
    assert found.holds
    assert not replace(found, residual=100 * found.residual).holds


@pytest.mark.slow
def test_another_robot_is_not_validated(identified: Any) -> None:
    heavier = DESIGN.vary({"links.b4": 0.8})
    assert not validate(identified, simulated(2, heavier)).holds


def test_a_log_that_shows_nothing_validates_nothing(identified: Any) -> None:
    log = simulated(2, DESIGN)
    with pytest.raises(InvalidLog, match="torque of M1 never changes"):
        validate(identified, make_log(log.t, log.position, 0.0 * log.torque))


@pytest.mark.slow
def test_a_delay_holds_for_the_second_log_too() -> None:
    def late(log: Any) -> Any:
        return make_log(log.t[8:], log.position[8:], log.torque[:-8])

    found = identify(APPENDIX_4, late(simulated(1, DESIGN)), replace(QUICK, delay=True))
    assert validate(found, late(simulated(2, DESIGN, noise_seed=5))).holds
    assert not validate(found, simulated(2, DESIGN, noise_seed=5)).holds


@pytest.mark.parametrize("seed", range(2))
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
    assert gains[1] == pytest.approx([4.0 * part for part in gains[0]], rel=1e-9)


def test_exact_logs_weigh_a_payload_and_its_inertia_exactly() -> None:
    first, loaded = (
        simulated(i, item, rate=250.0, noise_seed=None)
        for i, item in ((1, DESIGN), (2, replace(DESIGN, payload=Payload(5.0, 0.1))))
    )
    drifted = make_log(loaded.t, loaded.position, loaded.torque + np.array([0, 0, 0, 15.0]))
    found = weigh_payload(identify(APPENDIX_4, first, QUICK), drifted)
    assert found.free_mass == pytest.approx(5.0, rel=1e-5)
    assert found.drift == pytest.approx(15.0, rel=1e-5)
    assert found.inertia == pytest.approx(0.1, rel=1e-5)


@pytest.mark.slow
def test_other_logs_start_where_the_first_did_unless_said(
    identified: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    first, own, seen = (0.01, 0.0, 0.1, -0.5), (0.0, 0.02, -0.1, -0.4), []

    def solved(geometry: Any, log: Any, start: Any) -> Any:
        seen.append(start)
        return log_poses(geometry, log, start)

    monkeypatch.setattr(validation, "log_poses", solved)
    of = replace(identified, start=first)
    validate(of, identified.log)
    validate(of, identified.log, start=own)
    weigh_payload(of, identified.log, start=own)
    assert seen == [first, own, own]


def test_an_impossible_payload_is_refused(identified: Any) -> None:
    for known in (0.0, -1.0, np.inf, np.nan):
        with pytest.raises(InvalidInput, match=r"payload: .*above 0 kg"):
            weigh_payload(identified, identified.log, known=known)


def test_a_log_that_is_too_short_for_intervals_is_named(identified: Any) -> None:
    settings = replace(QUICK, block=1e3)
    log = replace(identified.log, name="loaded")
    long = replace(identified, settings=settings)
    for refused in (
        lambda: identify(APPENDIX_4, log, settings),
        lambda: validate(long, log),
        lambda: weigh_payload(long, log),
    ):
        with pytest.raises(InvalidLog, match=r"^log loaded: 1 block of 1000 s is left"):
            refused()


def test_a_log_is_predicted_as_by_its_own_identification() -> None:
    """With a load that is known, and rotors that differ."""
    drives = (Drive("a", rotor_inertia=1e-4, gear_ratio=20.0), None, None, None)
    design = replace(DESIGN, load=LoadCase(20.0, 0.0, -30.0), drives=drives)
    found = identify(design, simulated(1, design, rate=200.0), QUICK)
    again = validate(found, found.log)
    np.testing.assert_allclose(again.predicted, found.predicted, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(again.ratio, 1.0, rtol=1e-6)


def test_a_validation_holds_if_each_actuator_is_predicted_within_a_tenth() -> None:
    for residual, torque, holds in (
        ((1.1, 2.2, 0.5, 1.0), 9.0, True), ((1.0, 2.21, 1.0, 1.0), 9.0, False),
        ((2.0, 3.0, 2.0, 2.0), 9.0, False), ((2.0, 2.21, 2.0, 2.0), 2.2e4, False),
        ((2.0, 2.21, 2.0, 2.0), 2.22e4, True),
    ):  # fmt: skip
        signals: Any = SimpleNamespace(torque=np.full((5, 4), torque))
        own = np.array([1.0, 2.0, 1.0, 1.0])
        found = Validation(None, signals, None, np.array(residual), own)  # type: ignore[arg-type]
        assert found.holds == holds


@pytest.mark.parametrize("first_is_short", [False, True])
def test_a_payload_is_what_explains_best_what_a_first_log_leaves(first_is_short: bool) -> None:
    """Least squares; with variances by leaving out blocks of either log, and Student's t.

    One of the logs has 12 blocks and the other 6, which decide how wide intervals are.
    """
    rng = np.random.default_rng(20 + first_is_short)
    columns, x, numbers = random_columns(0)
    other, _, others = random_columns(1)
    if first_is_short:
        others = others // 2
    else:
        numbers = numbers // 2
    scale = np.array([0.1, 2.0, 0.5, 10.0])
    first = solve(normal_blocks(other, other @ x + scale * rng.standard_normal((240, 4)), others))
    extra = rng.standard_normal((240, 4, 2))
    torque = columns @ x + extra @ [2.0, -3.0] + scale * rng.standard_normal((240, 4))
    model = SimpleNamespace(columns=columns, torque=torque)
    value, half = _step(extra, model, first, numbers)  # type: ignore[arg-type]
    noise = solve(normal_blocks(extra, torque - columns @ first.x, numbers)).noise

    def fit(part: Any, of_first: Any) -> Any:
        rows = (extra[part] / noise[:, None]).reshape(-1, 2)
        left = (torque[part] - columns[part] @ of_first) / noise
        return np.linalg.lstsq(rows, left.ravel())[0]

    every = np.arange(240)
    np.testing.assert_allclose(value, fit(every, first.x), rtol=1e-9)
    here = [fit(np.flatnonzero(numbers != number), first.x) for number in np.unique(numbers)]
    there = [fit(every, without) for without in first.without]
    assert sorted([len(here), len(there)]) == [6, 12]
    squares = [
        (len(part) - 1) * np.mean((part - np.mean(part, axis=0)) ** 2, axis=0)
        for part in (here, there)
    ]
    # 95 % to both sides, of Student's t with 5 degrees of freedom
    np.testing.assert_allclose(half, 2.570582 * np.sqrt(np.sum(squares, axis=0)), rtol=1e-6)


@pytest.mark.slow
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
