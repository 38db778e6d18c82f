"""What a log says of a robot: right values, intervals that hold, and "unknown"."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.errors import PaminsaError
from paminsa_viz.files.example_logs import example_log
from paminsa_viz.identification import (
    BASE_SYMBOLS,
    IdentificationSettings,
    base_parameters,
    identify,
    make_log,
)
from paminsa_viz.identification.base_parameters import LEG_PARAMETERS
from paminsa_viz.identification.columns import LARGE_SHARE, FitParameter, base_scale
from paminsa_viz.identification.identify import (
    _identity,
    _moves,
    filtered,
    shifted,
)
from paminsa_viz.identification.log_poses import log_poses
from paminsa_viz.identification.results import Estimate, Identity
from paminsa_viz.model import (
    APPENDIX_4,
    Design,
    Friction,
    InvalidInput,
    KneeBranch,
    LoadCase,
    inverse_dynamics,
    inverse_kinematics,
)
from paminsa_viz.model.design import PARAMETER
from paminsa_viz.model.drive import Drive
from paminsa_viz.model.lumped import MASS_PATHS, mass_vector
from paminsa_viz.model.reach import home_pose
from tests.support.identification_logs import RUBBING, moved_unseen, multi_sine, simulated
from tests.support.samples import random_design

QUICK = IdentificationSettings(robustness=False)


def errors(identification: Any, design: Design) -> Any:
    """Errors of the base parameters over their largest possible half widths."""
    found = np.array([identification.estimate(symbol).value for symbol in BASE_SYMBOLS])
    most = np.array([identification.estimate(symbol).parameter.most for symbol in BASE_SYMBOLS])
    return (found - base_parameters(design)) / most


@pytest.mark.parametrize("knee", list(KneeBranch))
def test_a_log_without_noise_gives_the_design(knee: KneeBranch) -> None:
    design = RUBBING.with_knee(knee)
    found = identify(design.with_knee(knee), simulated(1, design, noise_seed=None), QUICK)
    for item in (item for item in found.estimates if item.symbol not in ("b_9", "b_10")):
        # 0.1 % of the masses' contributions, 0.1 % of the torques
        assert item.value == pytest.approx(item.parameter.design, abs=0.01 * item.parameter.most)
    assert np.abs(found.residual).max() < 3e-3 * np.abs(found.measured).max()
    assert found.identity.value == pytest.approx(0.0, abs=0.01)


@pytest.mark.parametrize("seed", range(1, 5))
@pytest.mark.parametrize("knee", list(KneeBranch))
def test_logs_of_any_robot_without_noise_give_its_numbers(seed: int, knee: KneeBranch) -> None:
    design = random_design(np.random.default_rng(seed)).with_knee(knee)
    design = replace(design, friction=Friction(0.2, 0.1, 10.0, 3.0))
    found = identify(design, simulated(seed, design, noise_seed=None, rate=200.0), QUICK)
    for item in found.estimates:
        if item.symbol not in ("b_8", "b_9", "b_10"):
            assert item.value == pytest.approx(
                item.parameter.design, abs=0.02 * item.parameter.most
            )


def test_what_twenty_seconds_tell_and_what_they_do_not() -> None:
    found = identify(APPENDIX_4, simulated(1, RUBBING))
    assert found.estimate("M_p2").half_width < 0.004 * found.estimate("M_p2").value
    assert found.estimate("b_1").half_width < 0.003 * found.estimate("b_1").value
    unknown = {item.symbol for item in found.unknown}
    assert {"b_9", "b_10"} <= unknown  # spin inertia of the bars
    assert not {"b_1", "M_p2", "b_6", "b_7", "c_1", "c_4"} & unknown
    assert all("would tell it" in item.reason() for item in found.unknown)
    assert found.identity.holds
    assert len(found.notes) == 1  # no warning


def test_a_motion_along_z_leaves_the_legs_masses_unknown() -> None:
    t = np.arange(6000) / 300.0
    pose = np.tile(np.array(home_pose(APPENDIX_4.geometry)), (t.size, 1))
    w = 2 * np.pi * 0.4
    pose[:, 3] += 0.1 * np.sin(w * t) + 0.03 * np.sin(2.7 * w * t)
    velocity, acceleration = (np.zeros_like(pose) for _ in range(2))
    velocity[:, 3] = 0.1 * w * np.cos(w * t) + 0.081 * w * np.cos(2.7 * w * t)
    acceleration[:, 3] = -0.1 * w**2 * np.sin(w * t) - 0.03 * (2.7 * w) ** 2 * np.sin(2.7 * w * t)
    torque = inverse_dynamics(RUBBING, pose, velocity, acceleration).torque
    position = inverse_kinematics(APPENDIX_4.geometry, pose).actuators
    noise = np.random.default_rng(0).standard_normal(torque.shape) * [0.01, 0.01, 0.01, 1.0]
    found = identify(APPENDIX_4, make_log(t, position, torque + noise), QUICK)
    assert {"b_4", "b_6", "b_8", "b_11", "c_1"} <= {item.symbol for item in found.unknown}
    assert found.estimate("b_1").known
    assert "horizontal accelerations would tell it" in found.estimate("b_6").reason()
    assert "b_6 (horizontal accelerations)" in found.advice
    assert not found.problem
    assert "\n" not in found.advice


def test_friction_is_unknown_where_the_noise_hides_it() -> None:
    log = simulated(1, RUBBING, rate=200.0)
    noise = np.random.default_rng(0).standard_normal(log.torque.shape) * log.torque.std(axis=0)
    loud = identify(APPENDIX_4, make_log(log.t, log.position, log.torque + 10 * noise), QUICK)
    friction = {"b_v1", "b_v2", "b_v3", "b_v4", "c_1", "c_2", "c_3", "c_4"}
    assert friction <= {item.symbol for item in loud.unknown}
    assert not friction & {item.symbol for item in identify(APPENDIX_4, log, QUICK).unknown}


@pytest.mark.slow
def test_masses_that_no_motion_tells_apart_change_no_estimate() -> None:
    moved = moved_unseen(RUBBING, 0)
    assert np.abs(mass_vector(moved) - mass_vector(RUBBING)).max() > 0.1
    log, other = simulated(1, RUBBING), simulated(1, moved)
    found = identify(RUBBING, log, QUICK), identify(RUBBING, other, QUICK)
    for first, second in zip(found[0].estimates, found[1].estimates, strict=True):
        assert second.value == pytest.approx(first.value, rel=1e-6, abs=1e-9)
        assert second.half_width == pytest.approx(first.half_width, rel=1e-6)
    # The other way round: the same log, and what it is compared with.
    compared = identify(moved, log, QUICK)
    for first, second in zip(found[0].estimates, compared.estimates, strict=True):
        assert (second.value, second.half_width) == (first.value, first.half_width)
        assert second.parameter.design == pytest.approx(first.parameter.design, rel=1e-9)
        assert second.parameter.most == pytest.approx(first.parameter.most, rel=1e-9)
        assert second.known == first.known


@pytest.mark.slow
def test_what_is_known_of_loads_and_unequal_rotors_is_taken_off() -> None:
    one, two, three = (
        Drive("d", rotor_inertia=inertia, gear_ratio=20.0) for inertia in (1e-4, 3e-4, 8e-4)
    )
    load = LoadCase(20.0, -10.0, -30.0, moment_z=3.0)
    design = replace(RUBBING, drives=(one, two, three, None), load=load)
    log = simulated(1, design, rate=250.0, noise_seed=None)
    assert np.abs(errors(identify(design, log, QUICK), design)).max() < 0.01
    for other in (
        replace(design, load=LoadCase()),
        replace(design, drives=(two, two, two, None)),
        replace(design, drives=(three, two, one, None)),
    ):
        assert np.abs(errors(identify(other, log, QUICK), other)).max() > 0.05


def test_what_is_not_fitted_has_no_estimate_and_takes_nothing_of_the_rest() -> None:
    """A robot without friction, of which less is fitted in turn."""
    log = simulated(1, APPENDIX_4, rate=250.0, noise_seed=None)
    every = {"viscous": "b_v", "coulomb": "c_", "offsets": "offset "}
    for name, left_out in every.items():
        found = identify(APPENDIX_4, log, replace(QUICK, **{name: False}))
        symbols = [item.symbol for item in found.estimates]
        for symbol in every.values():
            count = sum(one.removeprefix(symbol).lstrip("M").isdigit() for one in symbols)
            assert count == (0 if symbol == left_out else 3 + (symbol != "offset "))
        assert np.abs(errors(found, APPENDIX_4)).max() < 0.02
    assert len(symbols) == 11 + 8


def test_a_pause_in_a_log_changes_nothing() -> None:
    """At rest all columns but those of weights are zero, which are not those of no motion."""
    t, rest = np.arange(20000) / 1000.0, np.arange(20000) > 14000
    moving = multi_sine(1, RUBBING)
    home = moving(t[:1])[0]

    def pose(at: Any) -> Any:
        left = np.clip((14.0 - at) / 3.0, 0.0, 1.0)[:, None]
        return home + (moving(at)[0] - home) * left**4 * (
            35 - 84 * left + 70 * left**2 - 20 * left**3
        )

    h = 1e-3
    before, here, after = pose(t - h), pose(t), pose(t + h)
    rates = (after - before) / (2 * h), (after - 2 * here + before) / h**2
    assert not rates[0][rest].any()
    torque = inverse_dynamics(RUBBING, here, *rates).torque
    position = inverse_kinematics(RUBBING.geometry, here).actuators
    found = identify(RUBBING, make_log(t, position, torque), QUICK)
    assert np.abs(errors(found, RUBBING)).max() < 0.05


def test_a_low_cut_off_takes_nothing_from_the_motion_and_lengthens_blocks() -> None:
    """A part of it is above 1 Hz; with that in the torques alone b_4 is off by ten times itself."""
    log = simulated(1, RUBBING, rate=60.0, noise_seed=None)
    found = identify(RUBBING, log, replace(QUICK, cut_off=1.0))
    # Rounding, another one with each SciPy, decides where the search ends: 0.005 to 0.016.
    assert np.abs(errors(found, RUBBING)).max() < 0.05
    # 15.5 s are left; a block lasts 2 periods of the cut-off, or 0.5 s as with higher ones
    assert "half at 1 Hz, positions at 10 Hz)" in found.notes[0]
    assert found.notes[0].endswith("7 blocks of 2 s")
    assert found.solution.blocks == 7
    for cut_off, length in ((3.2, 0.625), (4.0, 0.5), (10.0, 0.5)):
        assert replace(QUICK, cut_off=cut_off).block_length == length
    assert replace(QUICK, cut_off=1.0, block=3.0).block_length == 3.0


@pytest.mark.slow
def test_numbers_that_move_with_the_cut_off_are_named() -> None:
    """Torques that grow with frequency, as those of a compliant gear do."""
    log = simulated(1, RUBBING, rate=250.0, noise_seed=None)
    bent = np.gradient(np.gradient(log.torque, axis=0), axis=0) * log.rate**2
    middle = slice(2, -2)
    grown = (log.torque + 2e-3 * bent)[middle]
    notes = identify(APPENDIX_4, make_log(log.t[middle], log.position[middle], grown)).notes
    assert notes[1].startswith("between 6.67 Hz and 15 Hz results move by more than 2 standard")
    assert "c_1 (" in notes[1]
    assert "b_1 (" not in notes[1]
    settings = IdentificationSettings(cut_off=30.0)
    slow = identify(APPENDIX_4, simulated(1, RUBBING, rate=125.0), settings)
    assert slow.notes[1] == "the log does not allow 45 Hz for comparison"


def test_numbers_move_that_are_known_and_leave_their_interval_either_way(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """By scripted fits at the other cut-offs; a move counts from a twentieth of `most` on."""
    script = {  # moves at the lower and the higher cut-off, standard error, known, named as
        "up": (0.75, 0.25, 0.25, True, "3"), "down": (0.0, -1.0, 0.25, True, "4"),
        "both": (-0.75, 1.0, 0.25, True, "4"), "delay": (1.0, 1.0, 0.25, True, "4"),
        "exact": (0.75, 0.0, 0.0, True, "e+"), "still": (0.0, 0.0, 0.0, True, ""),
        "near": (0.5, -0.5, 0.25, True, ""), "small": (0.125, -0.125, 1e-3, True, ""),
        "unknown": (9.0, 9.0, 0.25, False, ""),
    }  # fmt: skip
    kinds = ["delay" if name == "delay" else "base" for name in script]
    parameters = [FitParameter(name, "", "", kind, 0.0, 2.5, "")
                  for name, kind in zip(script, kinds, strict=True)]  # fmt: skip
    values, size = np.arange(10.0, 19.0), len(script)
    moves, left = np.array([one[:2] for one in script.values()]).T, []

    def fit(*given: Any) -> Any:
        model = SimpleNamespace(report=np.eye(size), parameters=parameters)
        lag = 0.5 * (np.array(kinds) == "delay")
        return model, None, SimpleNamespace(x=values + left.pop(0) - lag), None, 0.5

    monkeypatch.setitem(_moves.__globals__, "filtered", lambda *_: None)
    monkeypatch.setitem(_moves.__globals__, "_fit", fit)
    left[:] = moves
    estimates = tuple(
        Estimate(parameter, value, 1.0, one[3])
        for parameter, value, one in zip(parameters, values, script.values(), strict=True)
    )
    error = np.array([one[2] for one in script.values()])
    nothing: Any = None
    (note,) = _moves(nothing, nothing, nothing, QUICK, estimates, values, error)
    assert note.startswith("between 6.67 Hz and 15 Hz results move by more than 2 standard errors")
    for name, (*_, named) in script.items():
        assert (f" {name} (" in note) == bool(named)
        assert f" {name} ({named}" in note or "e+" in named or not named


def test_the_identity_is_told_by_known_parameters_with_an_interval() -> None:
    """Half of its interval is that of its error."""
    x = base_parameters(APPENDIX_4) + 0.5 * np.eye(11)[1]  # half a newton of M_p2 more

    def told(
        error: float = 0.1, known: bool = True, unknown: int | None = None, constrain: bool = False
    ) -> Identity:
        solution = SimpleNamespace(
            x=x, quantile=2.0, known=lambda rows: np.array([known]),
            deviation=lambda rows: np.array([error]),
        )  # fmt: skip
        estimates = tuple(SimpleNamespace(known=place != unknown) for place in range(11))
        model, settings = SimpleNamespace(report=np.eye(11)), replace(QUICK, constrain=constrain)
        return _identity(APPENDIX_4, model, solution, settings, estimates)  # type: ignore[arg-type]

    for found in (told(), told(unknown=0), told(unknown=5)):  # those that are no part of it
        assert (found.value, found.half_width, found.z) == pytest.approx((0.5, 0.2, 5.0))
    lost = [told(error=0.0), told(known=False), told(constrain=True)]
    for found in [*lost, *(told(unknown=place) for place in (1, 2, 3, 4))]:
        assert np.isnan([found.value, found.z]).all()
        assert found.half_width == np.inf


def test_a_gap_changes_little() -> None:
    log = simulated(1, RUBBING)
    kept = np.r_[0:9000, 9010 : len(log.t)]
    split = make_log(log.t[kept], log.position[kept], log.torque[kept], split=True)
    whole, cut = (identify(APPENDIX_4, item, QUICK) for item in (log, split))
    for first, second in zip(whole.estimates, cut.estimates, strict=True):
        assert abs(second.value - first.value) < first.half_width


@pytest.mark.parametrize("rate", [100.0, 250.0])
def test_slower_logs_give_the_same(rate: float) -> None:
    found = identify(APPENDIX_4, simulated(1, RUBBING, rate=rate, noise_seed=None), QUICK)
    assert np.abs(errors(found, RUBBING)[:8]).max() < 0.02


@pytest.mark.slow
def test_opt_in_numbers_are_found() -> None:
    log = simulated(2, RUBBING, rate=200.0)
    late = make_log(log.t[1:], log.position[1:], log.torque[:-1])
    found = identify(APPENDIX_4, late, replace(QUICK, delay=True))
    assert found.estimate("delay").value == pytest.approx(5e-3, abs=1e-3)
    assert found.estimate("delay").half_width < 1e-3
    assert found.estimate("delay").parameter.design == 0.0
    held = identify(APPENDIX_4, log, replace(QUICK, constrain=True))
    assert np.isnan([held.identity.z, held.identity.value]).all()
    assert held.identity.half_width == np.inf
    assert (
        held.estimate("b_3").half_width
        < identify(APPENDIX_4, log, QUICK).estimate("b_3").half_width
    )
    legs = identify(APPENDIX_4, log, replace(QUICK, legs=True, rotors=True, constrain=True))
    contrasts = [item for item in legs.estimates if item.parameter.kind == "leg"]
    assert len(contrasts) == 24
    assert {item.parameter.design for item in contrasts} == {0.0}
    assert np.isnan(legs.identity.value)  # with the legs' columns, too, the identity is held
    sizes = LARGE_SHARE * base_scale(APPENDIX_4)[list(LEG_PARAMETERS)]
    assert [item.parameter.most for item in contrasts] == pytest.approx([*sizes] * 3)
    rotors = [item.parameter.most for item in legs.estimates if item.parameter.kind == "rotor"]
    assert rotors == pytest.approx([sizes[5]] * 2)  # as the spin inertia of a leg, b_8
    of_legs = np.reshape([item.value for item in contrasts], (3, 8))
    np.testing.assert_allclose(of_legs.sum(axis=0), 0.0, atol=1e-12)
    assert sum(abs(item.value) > 1.5 * item.half_width for item in contrasts) == 0
    assert legs.model.columns.shape[-1] == 27 + 4 + 4 + 3 + 2 - 1


def test_torques_of_a_time_later_are_exact_for_parabolas_in_each_segment() -> None:
    log = simulated(1, RUBBING, rate=200.0)
    signals = filtered(log, APPENDIX_4, QUICK, log_poses(APPENDIX_4.geometry, log))
    segment = (np.arange(len(signals.t)) >= 500).astype(np.int64)
    t = signals.t - 100.0 * segment  # nothing goes from one segment to the next
    curve = [np.polynomial.Polynomial([1.0, -2.0, a]) for a in (0.5, -3.0, 0.0, 40.0)]
    torque, rate, later, grown = (
        np.stack([one.deriv(order)(t + lag) for one in curve], axis=1)
        for lag, order in ((0.0, 0), (0.0, 1), (7e-3, 0), (7e-3, 1))
    )
    moved = shifted(replace(signals, segment=segment, torque=torque, torque_rate=rate), 7e-3)
    np.testing.assert_allclose(moved.torque, later, rtol=1e-12)
    np.testing.assert_allclose(moved.torque_rate, grown, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize(
    ("words", "call"),
    [
        (
            "at most 50 Hz is needed with 200 rows a second, not 50.1",
            lambda log: identify(APPENDIX_4, log, IdentificationSettings(cut_off=50.1)),
        ),
        ("block", lambda log: IdentificationSettings(block=-1.0)),
        ("start", lambda log: identify(APPENDIX_4, log, start=(0.0, 0.0, 0.0))),
        ("gravity", lambda log: identify(replace(APPENDIX_4, gravity=0.0), log)),
        ("symbol", lambda log: identify(APPENDIX_4, log, QUICK).estimate("M_p3")),
        (
            "block of 10 s is left",
            lambda log: identify(APPENDIX_4, log, IdentificationSettings(block=10)),
        ),
    ],
    ids=["cut-off", "block", "start", "gravity", "symbol", "long blocks"],
)
def test_impossible_settings_are_refused(words: str, call: Any) -> None:
    with pytest.raises(PaminsaError, match=words):
        call(simulated(1, RUBBING, rate=200.0))


@pytest.mark.slow
def test_log_says_what_it_does_where_the_design_has_none_of_a_number() -> None:
    """Inertias are often left at 0, or all masses of the legs: their numbers are fitted as well."""
    log, whole = example_log(), identify(APPENDIX_4, example_log(), QUICK)
    legs = ("inertias.", "links.", "joints.")
    for left_out in (legs[:1], legs):
        paths = [path for path in PARAMETER if path.startswith(left_out)]
        found = identify(APPENDIX_4.vary(dict.fromkeys(paths, 0.0)), log, QUICK)
        assert found.problem == ""
        for symbol in ("b_1", "M_p2", "b_6", "b_7", "b_9", "b_10"):
            same = whole.estimate(symbol)
            assert found.estimate(symbol).value == pytest.approx(same.value, abs=same.half_width)


def test_design_without_masses_is_refused_by_its_name() -> None:
    least = dict.fromkeys(MASS_PATHS, 0.0) | {"platform.mass": 1e-30}
    with pytest.raises(InvalidInput, match="design: its masses are next to nothing"):
        identify(APPENDIX_4.vary(least), example_log(), QUICK)
