"""Causes: named when a robot differs from its model, first among all; none for a right robot."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.stats import t as t_distribution

from paminsa_viz.identification import (
    IdentificationSettings,
    base_parameters,
    base_regressor,
    find_causes,
    identify,
    make_log,
)
from paminsa_viz.identification.base_parameters import (
    BASE_SYMBOLS,
    LEG_PARAMETERS,
    leg_base_regressor,
    mass_columns,
)
from paminsa_viz.identification.causes import (
    LENGTHS,
    NEVER_SEEN,
    SPRING,
    Cause,
    PossibleCause,
    _tried,
    possible_causes,
)
from paminsa_viz.identification.columns import base_scale
from paminsa_viz.identification.identify import filtered
from paminsa_viz.identification.log_poses import log_poses
from paminsa_viz.identification.results import Identity
from paminsa_viz.model import (
    APPENDIX_4,
    Friction,
    inverse_dynamics,
    inverse_jacobian,
    inverse_kinematics,
)
from paminsa_viz.model.lumped import MASS_PATHS
from tests.support.documentation import missing
from tests.support.identification_logs import clean_signals, multi_sine, noisy, simulated
from tests.support.samples import enlarged, random_states

DESIGN = replace(APPENDIX_4, friction=Friction(0.3, 0.4, 20.0, 8.0))
QUICK = IdentificationSettings(robustness=False)
RATE = 250.0


@cache
def signals() -> Any:
    return clean_signals(1, DESIGN, rate=RATE)


@cache
def identified(noise_seed: int | None = 0) -> Any:
    """What a log of the right robot says, with noise or without."""
    log = simulated(1, DESIGN, noise_seed=noise_seed, rate=RATE)
    return identify(APPENDIX_4, log, QUICK)


def tried() -> Any:
    """All causes, by the log without noise."""
    return possible_causes(identified(None))


def causes(position: Any, torque: Any) -> Any:
    t = signals()[0]
    log = make_log(t, *noisy(t, position, torque, np.random.default_rng(0)))
    return find_causes(identify(APPENDIX_4, log, QUICK))


@pytest.mark.slow
@pytest.mark.parametrize("actuator", [0, 1, 2])
def test_an_encoder_zero_is_named_with_its_size(actuator: int) -> None:
    _, position, torque = signals()
    shift = np.radians(0.5) * np.eye(4)[actuator]
    found = causes(position + shift, torque)
    assert found.named[0].label == f"encoder zero of M{actuator + 1}"
    assert found.named[0].text == found.named[0].label  # nothing explains nearly as much
    named = {cause.label: place for place, cause in enumerate(found.named, 1)}
    assert [cause.named for cause in found.named] == list(named.values())
    assert all(cause.named == named.get(cause.label, 0) for cause in found.ranked)
    explained = [cause.explains for cause in found.ranked]
    assert explained == sorted(explained, reverse=True)
    assert np.degrees(found.named[0].value) == pytest.approx(0.5, abs=0.1)


@pytest.mark.slow
@pytest.mark.parametrize("actuator", [0, 1, 2])
def test_a_gain_is_named_with_its_size(actuator: int) -> None:
    _, position, torque = signals()
    found = causes(position, torque * (1 + 0.05 * np.eye(4)[actuator]))
    assert found.named[0].label == f"gain of M{actuator + 1}"
    assert found.named[0].value == pytest.approx(0.05, abs=0.015)


@pytest.mark.slow
def test_a_delay_is_named_with_its_size() -> None:
    t, position, torque = clean_signals(1, DESIGN, rate=200.0)
    log = make_log(t[1:], *noisy(t[1:], position[1:], torque[:-1], np.random.default_rng(0)))
    found = find_causes(identify(APPENDIX_4, log, QUICK))
    assert found.named[0].label == "delay of the torques"
    assert found.named[0].value == pytest.approx(5e-3, abs=1e-3)


@pytest.mark.slow
def test_a_spring_breaks_the_identity_and_is_named() -> None:
    t, position, torque = signals()
    force = 0.3 * base_parameters(DESIGN)[1]
    lifted = torque - force * base_regressor(DESIGN.geometry, *multi_sine(1, DESIGN)(t))[..., 1]
    log = make_log(t, *noisy(t, position, lifted, np.random.default_rng(1)))
    shares = []
    for constrain in (False, True):
        identified = identify(APPENDIX_4, log, replace(QUICK, constrain=constrain))
        first = find_causes(identified).named[0]
        assert first.label == SPRING
        assert first.value == pytest.approx(force, abs=1.5 * first.half_width)
        shares.append(first.explains)
        if not constrain:
            assert identified.identity.z < -4
            assert identified.identity.holds is False
    # What it explains shows in the identity of the masses, or in the torques.
    assert shares[0] == pytest.approx(shares[1], rel=0.2)


@pytest.mark.slow
@pytest.mark.parametrize(("leg", "bar"), [(0, "b3"), (1, "b4"), (2, "b8")])
def test_bar_that_is_heavier_in_mass_alone_is_said_to_be_like_others(leg: int, bar: str) -> None:
    """No cause is exactly that: the leg is right, and the bar is among those that are alike."""
    t, position, torque = signals()
    legs = leg_base_regressor(DESIGN.geometry, *multi_sine(1, DESIGN)(t))
    own = mass_columns(DESIGN)[0][list(LEG_PARAMETERS), MASS_PATHS.index(f"links.{bar}")]
    extra = legs[:, :, leg] @ (0.3 * DESIGN.value(f"links.{bar}") * own)
    first = causes(position, torque + extra).named[0]
    assert first.leg == leg + 1
    assert f"leg {leg + 1}: {bar.upper()} heavier" in (first.label, *first.alike)
    assert first.text.startswith(f"leg {leg + 1}; most like {first.label[7:9]} heavier (")
    assert all(label.removeprefix(f"leg {leg + 1}: ") in first.text for label in first.alike)


@pytest.mark.slow
@pytest.mark.parametrize("name", list(LENGTHS))
def test_columns_of_lengths_are_torques_of_robots_with_longer_ones(name: str) -> None:
    """The same actuator motion, made by a robot of another length with the same base parameters."""
    found = identified(None)
    log = found.log
    columns = {item.label: item.column for item in tried()}
    b = np.array([found.estimate(symbol).value for symbol in BASE_SYMBOLS])
    torques = []
    for size in (-1e-4, 1e-4):
        value = getattr(DESIGN.geometry, name) + size
        geometry = replace(DESIGN.geometry, **{name: value})
        longer = replace(APPENDIX_4, geometry=geometry)
        signals = filtered(log, longer, QUICK, log_poses(geometry, log))
        samples = signals.samples
        rows = base_regressor(geometry, samples.pose, samples.velocity, samples.acceleration)
        torques.append(signals.smooth(rows @ b))
    expected = (torques[1] - torques[0]) / 2e-4
    column = columns[f"{LENGTHS[name][0]} longer"]
    np.testing.assert_allclose(column, expected, atol=2e-3 * np.abs(expected).max())


@pytest.mark.slow
def test_causes_are_about_the_leg_and_in_the_unit_that_their_labels_say() -> None:
    causes = possible_causes(identified(None))
    for cause in causes:
        about = re.search(r"(?:^leg | of M| at M)(\d)", cause.label)
        assert cause.leg == (int(about[1]) % 4 if about else 0)  # M4 is no leg's
        lift = "M4" in cause.label
        units = {
            "heavier": "", "gain": "", "zero": "m" if lift else "rad", "longer": "m",
            "delay": "s", "spring at": "N/m" if lift else "N m/rad", SPRING: "N",
        }  # fmt: skip
        assert cause.unit == next(unit for word, unit in units.items() if word in cause.label)
        assert cause.plausible > 0
    assert len({cause.label for cause in causes}) == len(causes) == 12 + 4 + 1 + 4 + 4 + 4 + 1


def made_up(size: float) -> Any:
    """States of a robot so many times as large, in its gravity's own time, as if identified."""
    design, root = enlarged(APPENDIX_4, size), np.sqrt(size)
    scale = np.array([size, size, 1.0, size])
    drives = np.array([1.0, 1.0, 1.0, size])
    pose, rate, growth = random_states(np.random.default_rng(3), APPENDIX_4, 20)
    pose, rate, growth = pose * scale, rate * scale / root, growth * scale / size
    torque = inverse_dynamics(design, pose, rate, growth).torque
    samples = SimpleNamespace(
        pose=pose, velocity=rate, acceleration=growth,
        position=inverse_kinematics(design.geometry, pose).actuators,
        speed=np.einsum("nij,nj->ni", inverse_jacobian(design.geometry, pose), rate),
        growth=np.random.default_rng(4).normal(size=(20, 4)) * drives / size,
    )  # fmt: skip
    return SimpleNamespace(
        design=design,
        predicted=torque,
        settings=SimpleNamespace(legs=False, delay=True),
        estimates=[
            SimpleNamespace(symbol=symbol, value=value)
            for symbol, value in zip(BASE_SYMBOLS, base_parameters(design), strict=True)
        ],
        signals=SimpleNamespace(
            samples=samples, pose=pose, velocity=rate, acceleration=growth, torque=torque,
            smooth=lambda values: values,
        ),
    )  # fmt: skip


@pytest.mark.parametrize("size", [0.01, 10.0])
def test_causes_of_a_larger_robot_are_larger_by_the_laws_of_their_units(size: float) -> None:
    """Lengths grow with the size, weights with its cube, torques with its fourth power."""
    units = {"": 0, "rad": 0, "m": 1, "N": 3, "N/m": 2, "N m/rad": 4}
    torques = size ** np.array([4.0, 4.0, 4.0, 3.0])
    for own, other in zip(
        possible_causes(made_up(size)), possible_causes(made_up(1.0)), strict=True
    ):
        times = size ** units[own.unit]
        assert own.label == other.label
        assert own.plausible == pytest.approx(times * other.plausible), own.label
        expected = other.column * torques / times
        most = 1e-6 * np.abs(expected).max(axis=0)
        assert (np.abs(own.column - expected) <= most).all(), own.label


@pytest.mark.slow
def test_plausible_sizes_are_those_of_the_documentation() -> None:
    """A length of 5 mm reads 5e-3, an angle of one degree pi / 180."""
    sizes: dict[str, list[float]] = {}
    for cause in tried():
        what = re.sub(r"leg \d: B\d|M[123]", "", cause.label).strip()
        sizes.setdefault(what, []).append(cause.plausible)
    assert all(min(each) == max(each) for each in sizes.values())
    size = {what: each[0] for what, each in sizes.items()}
    upward = size[SPRING] / base_scale(APPENDIX_4)[1]
    assert size["R_b longer"] == size["R_pl longer"]
    assert size["l_B4 longer"] == size["l_B8 longer"]
    assert size["gain of"] == size["gain of M4"]
    sentence = (
        f"{100 * size['heavier']:.4g} % of a bar, {100 * size['gain of']:.4g} % of a gain, zeros "
        f"off by {np.degrees(size['encoder zero of']):.4g}° and "
        f"{1e3 * size['encoder zero of M4']:.4g} mm, {1e3 * size['delay of the torques']:.4g} ms, "
        f"{1e3 * size['R_b longer']:.4g} mm of R_b and R_pl and "
        f"{1e3 * size['l_B4 longer']:.4g} mm of l_B4 and l_B8, springs of "
        f"{size['spring at']:.4g} N·m/rad and {size['spring at M4']:.4g} N/m, and "
        f"{100 * upward:.4g} % of the size of M_p2 upward at joint 9."
    )
    assert missing("identification", [sentence]) == []


@pytest.mark.slow
def test_a_spring_explains_what_holding_the_identity_costs() -> None:
    """Of the weighted squared residuals, by the fits with and without the identity."""
    free = identified()
    held = identify(APPENDIX_4, free.log, replace(QUICK, constrain=True))
    noise = free.solution.noise[:, None]
    right = (free.model.torque / noise.T).ravel()
    left = [
        np.linalg.lstsq((one.model.columns / noise).reshape(len(right), -1), right)[1][0]
        for one in (free, held)
    ]
    ranked = {cause.label: cause for cause in find_causes(free).ranked}
    spring = ranked[SPRING]
    assert spring.explains == pytest.approx((left[1] - left[0]) / left[0], rel=1e-6)
    # and is what is left of the identity, downward there, with its interval
    assert (-spring.value, spring.half_width) == pytest.approx(
        (free.identity.value, free.identity.half_width), rel=1e-3
    )
    untold = replace(free, identity=Identity(np.nan, np.inf, np.nan))
    lost = {cause.label: cause for cause in find_causes(untold).ranked}[SPRING]
    assert (lost.value, lost.half_width, lost.p_value) == (0.0, np.inf, 1.0)


@pytest.mark.slow
def test_two_causes_are_named_one_after_the_other() -> None:
    _, position, torque = signals()
    shifted = position + np.radians(0.5) * np.eye(4)[0]
    found = causes(shifted, torque * (1 + 0.05 * np.eye(4)[1]))
    assert {cause.label for cause in found.named} == {"encoder zero of M1", "gain of M2"}
    assert [cause.named for cause in found.named] == [1, 2]


def test_a_right_robot_names_nothing_and_says_what_it_could_not_see() -> None:
    found = find_causes(identified())
    assert found.named == ()
    unseen = " ".join(found.unseen)
    assert "common gain" in unseen
    assert "offset of F_4" in unseen
    assert "gain of M4" in unseen
    assert "l_B8 longer" in unseen
    assert "gain of M1" not in unseen


@pytest.mark.slow
def test_columns_are_what_the_causes_do() -> None:
    found = identified(None)
    log = found.log
    columns = {item.label: item.column for item in tried()}
    seen = []
    for size in (-1e-3, 1e-3):
        moved = make_log(log.t, log.position + size * np.eye(4)[1], log.torque)
        seen.append(identify(APPENDIX_4, moved, QUICK).model.columns @ found.solution.x)
    expected = -2e-3 * columns["encoder zero of M2"]  # measured torques stay what they are
    np.testing.assert_allclose(seen[1] - seen[0], expected, atol=2e-3 * np.abs(expected).max())


@pytest.mark.slow
def test_columns_of_bars_springs_and_gains_by_their_definitions() -> None:
    """A bar of one leg is its share of what the same bar of all three changes."""
    found = identified(None)
    columns, signals = {item.label: item.column for item in tried()}, found.signals
    motion = signals.pose, signals.velocity, signals.acceleration
    legs = leg_base_regressor(DESIGN.geometry, *motion)
    for bar in ("b3", "b4", "b7", "b8"):
        paths = (f"links.{bar}", f"inertias.{bar}_axial", f"inertias.{bar}_transverse")
        heavier = APPENDIX_4.vary({path: 1.01 * APPENDIX_4.value(path) for path in paths})
        change = (base_parameters(heavier) - base_parameters(APPENDIX_4)) / 0.01
        for leg in range(3):
            expected = legs[:, :, leg] @ change[list(LEG_PARAMETERS)]
            column = columns[f"leg {leg + 1}: {bar.upper()} heavier"]
            size = np.abs(expected).max()
            np.testing.assert_allclose(column[50:-50], expected[50:-50], atol=0.02 * size)
    none = replace(found, design=APPENDIX_4.vary({"links.b7": 0.0, "inertias.b7_axial": 0.0}))
    assert not any("B7" in cause.label for cause in possible_causes(none))
    travel = signals.samples.position[signals.samples.kept]
    travel = travel - signals.samples.position.mean(axis=0)
    pull = -base_regressor(DESIGN.geometry, *motion)[..., 1]
    np.testing.assert_allclose(
        columns[SPRING][50:-50], pull[50:-50], atol=0.02 * np.abs(pull).max()
    )
    for place in range(4):
        own = np.eye(4)[place]
        np.testing.assert_array_equal(columns[f"gain of M{place + 1}"], found.predicted * own)
        np.testing.assert_allclose(
            columns[f"spring at M{place + 1}"], travel * own, atol=0.02 * np.abs(travel).max()
        )


@pytest.mark.slow
def test_a_delay_is_minus_the_rate_of_the_torques_in_each_segment() -> None:
    found = identified(None)
    segment = (np.arange(len(found.predicted)) >= 700).astype(np.int64)
    t = found.signals.t - 9.0 * segment  # nothing goes from one segment to the next
    curves = [np.polynomial.Polynomial([1.0, -2.0, a]) for a in (0.5, -3.0, 0.0, 40.0)]
    torque, rate = (
        np.stack([curve.deriv(order)(t) for curve in curves], axis=1) for order in (0, 1)
    )
    cut = replace(found, signals=replace(found.signals, segment=segment), predicted=torque)
    columns = {item.label: item for item in possible_causes(cut)}
    delay = columns["delay of the torques"].column
    ends = [0, 699, 700, len(t) - 1]
    np.testing.assert_allclose(
        np.delete(delay + rate, ends, axis=0), 0.0, atol=1e-12 * np.abs(rate).max()
    )
    # there a difference to one side, which is off by half a step
    np.testing.assert_allclose(delay[ends], -rate[ends], atol=1.01 * 40.0 * found.signals.step)
    fitted = replace(found, settings=replace(QUICK, delay=True))
    assert "delay of the torques" not in {item.label for item in possible_causes(fitted)}


def test_causes_are_named_one_after_the_other_by_what_they_explain(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """At most three; each that is significant, with those alike; then the next ones with it."""
    explains = {"d": 0.2, "a": 0.5, "z": 0.8, "b": 0.3, "e": 0.1, "c": 0.29}
    p_values = {"z": 0.5, "e": 0.5}  # the others are significant
    detectable = {"a": 2.0, "z": 2.0, "d": 2.0, "e": np.inf}  # of a plausible 1
    candidates = [PossibleCause(label, "m", 0, 1.0, np.zeros((6, 4))) for label in explains]
    given: list[Any] = []

    def fits(_: Any, blocks: Any, base: Any, places: Any, left: Any) -> list[Cause]:
        given.append((list(base), dict(places), [item.label for item in left]))
        return [
            Cause(item.label, "m", 0, 1.0, 0.1, p_values.get(item.label, 0.0),
                  explains[item.label], detectable.get(item.label, 1.0), 1.0)
            for item in left
        ]  # fmt: skip

    monkeypatch.setitem(_tried.__globals__, "_tried", fits)
    monkeypatch.setitem(_tried.__globals__, "possible_causes", lambda _: candidates)
    model = SimpleNamespace(columns=np.ones((6, 4, 2)), torque=np.ones((6, 4)))
    one = SimpleNamespace(model=model, numbers=np.zeros(6, int), problem="")
    found = find_causes.__wrapped__(one)  # type: ignore[attr-defined]
    assert [(cause.label, cause.named) for cause in found.named] == [("a", 1), ("b", 2), ("c", 3)]
    # at least 0.6 of what is named: 0.3 of 0.5 is enough, 0.29 is not
    assert [cause.alike for cause in found.named] == [("z", "b"), ("z", "c", "d"), ("z", "d")]
    assert [cause.label for cause in found.ranked] == ["z", "a", "b", "c", "d", "e"]
    assert [cause.named for cause in found.ranked] == [0, 1, 2, 3, 0, 0]
    labels, places = list(explains), dict(zip(explains, range(2, 8), strict=True))
    base = [0, 1]
    for taken, (own, own_places, left) in zip(("", "a", "b", "c"), given, strict=True):
        if taken:
            base = [*base, places.pop(taken)]
            labels.remove(taken)
        assert (own, own_places, left) == (base, places, labels)
    said = ["d: below 2000 mm", "e: below any size", "z: below 2000 mm"]  # but those that are named
    assert list(found.unseen) == [*NEVER_SEEN, *said]


@pytest.mark.slow
def test_sizes_are_the_least_squares_fit_with_rows_over_their_noise() -> None:
    found = identified()
    noise, model = found.solution.noise[:, None], found.model
    assert noise.max() > 2 * noise.min()
    ranked = {cause.label: cause for cause in find_causes(found).ranked}
    torque = (model.torque[..., None] / noise).ravel()
    for item in possible_causes(found):
        if item.label in ("gain of M1", "gain of M2", "encoder zero of M3"):
            rows = np.concatenate([model.columns, item.column[..., None]], axis=-1) / noise
            fit = np.linalg.lstsq(rows.reshape(len(torque), -1), torque)[0]
            assert ranked[item.label].value == pytest.approx(fit[-1], rel=1e-6)


@pytest.mark.slow
def test_p_values_are_two_sided_and_for_all_causes_at_once() -> None:
    t, position, torque = signals()
    shifted = position + np.radians(0.1) * np.eye(4)[0]
    log = make_log(t, *noisy(t, shifted, torque, np.random.default_rng(0)))
    found = identify(APPENDIX_4, log, QUICK)
    ranked = find_causes(found).ranked
    compared = 0
    for cause in ranked:
        error = cause.half_width / found.solution.quantile
        spread = t_distribution(found.solution.blocks - 1, scale=error) if error > 0 else None
        if spread is not None and np.isfinite(error):
            inside = spread.cdf(abs(cause.value)) - spread.cdf(-abs(cause.value))
            assert cause.p_value == pytest.approx(
                min(1.0, len(ranked) * (1 - inside)), rel=1e-6, abs=1e-12
            )
            compared += cause.p_value < 1.0
    assert compared > 2
