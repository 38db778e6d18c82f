"""Sizing of drives: against brute force, independent integrals, and the robot's own dynamics."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import simpson

from paminsa_viz.actuation import sizing
from paminsa_viz.actuation.drive_table import combined, drive_table, pair_table
from paminsa_viz.actuation.duty import ActuatorLoad, DutyMotion, load_signals
from paminsa_viz.actuation.ratios import RatioIntervals, ratio_intervals
from paminsa_viz.actuation.sizing import LIMITS, envelope_share, ordered, size_drives
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model import Drive
from paminsa_viz.progress import Canceled
from tests.actuation.loads import cases, random_drives, random_load
from tests.actuation.motor_loads import GEAR, SERVO, motor_torque


@pytest.mark.parametrize("kind", [{}, {"bent": True}, {"coulomb": 0.3}], ids=str)
def test_envelope_and_rms_of_pairs_are_those_of_their_samples(kind: dict[str, float]) -> None:
    rng = np.random.default_rng(4)
    for load, table, _ in cases(rng, 3, 20, **kind):
        table = replace(table, ratio=10 ** rng.uniform(0, 2, len(table)))
        share, sample = envelope_share(load, table)
        sizing = size_drives(load, table)
        for i in range(len(table)):
            drive = table.drive(i)
            n = table.ratio[i : i + 1]
            tau = np.abs(motor_torque(load, drive, n)[0])
            speeds, torques = np.array(drive.corners).T
            turning = n * np.abs(load.signals[4])
            limit = np.interp(turning, speeds, torques)
            if turning.max() <= speeds[-1]:
                assert (share[i] <= 1) == (tau <= limit).all()
            a, k = (column[i] for column in table.lines)
            if table.concave[i]:
                each = ((tau + k[:, None] * turning) / a[:, None]).max(axis=0)
                assert share[i] == pytest.approx(each.max(), rel=1e-12)
                assert each[sample[i]] == pytest.approx(share[i], rel=1e-12)
            t, dwell = load.passages[0].t, load.passages[0].dwell
            held = 0.0 if drive.holds else load.passages[0].held / n[0]
            square = simpson(tau**2, x=t) + dwell * held**2
            assert sizing.rms[i] == pytest.approx(np.sqrt(square / (t[-1] + dwell)), rel=2e-3)


def test_the_worst_sample_may_be_any_one_also_the_last() -> None:
    table = drive_table([SERVO])
    for size in (2, 63, 64, 65, 200):
        for worst in {0, size // 2, size - 1}:
            torque = np.linspace(0.1, 0.2, size)
            torque[worst] = -1.0
            signals = load_signals(torque, np.zeros(size), np.zeros(size))
            passage = DutyMotion(np.arange(float(size)), signals, 1.0, 1.0, 0.0)
            _, sample = envelope_share(ActuatorLoad("M1", (passage,), 1.0), table)
            assert sample.tolist() == [worst]


def test_pairs_in_columns_are_the_drives_they_stand_for() -> None:
    limited = replace(
        GEAR, gear_ratio=10.0, viscous=1e-6, coulomb=1e-3, cost=5.0, gear_rated_torque=20.0,
        gear_peak_torque=50.0, gear_top_speed=450.0,
    )  # fmt: skip
    screws = [
        Drive(
            "screw", gear_inertia=3e-5, viscous=1e-4, coulomb=2e-3, transmission="screw", lead=0.01,
            lead_efficiency=0.4, mass=2.0,
        ),
        Drive("belt", transmission="belt", lead=0.08, lead_efficiency=0.9),
    ]  # fmt: skip
    motors = [
        SERVO, replace(SERVO, envelope=((0.0, 0.9), (300.0, 0.9), (600.0, 0.2)), cost=9.0),
        replace(SERVO, brake=True, top_speed=400.0, thermal_time_constant=50.0),
    ]  # fmt: skip
    for parts in ((motors, [GEAR, limited]), (motors, [GEAR, limited], screws)):
        table = pair_table(*parts)
        drives = [table.drive(i) for i in range(len(table))]
        whole = drive_table(drives)
        for name in whole.__dataclass_fields__:
            if name not in ("parts", "catalog"):
                np.testing.assert_allclose(getattr(table, name), getattr(whole, name), rtol=1e-14)
        limits = [drive.gear_limits for drive in drives]
        np.testing.assert_allclose(table.gear_rated, [own.rated for own in limits], rtol=1e-14)
        np.testing.assert_allclose(table.gear_peak, [own.peak for own in limits], rtol=1e-14)
        slower = [min(drive.corners[-1][0], own.speed * drive.ratio)
                  for drive, own in zip(drives, limits, strict=True)]  # fmt: skip
        np.testing.assert_allclose(table.top_speed, slower, rtol=1e-14)
        assert {round(speed) for speed in slower} == {400, 450, 600}
        assert table.holds.tolist() == [drive.holds for drive in drives]
    assert pair_table(motors, [GEAR]).drive(0).name == "servo, gear"


@pytest.mark.parametrize(
    ("corners", "concave"),
    [
        (((0, 9), (600, 9)), True),
        (((0, 9), (300, 9), (600, 9)), True),
        (((0, 9), (300, 9), (600, 2)), True),
        (((0, 9), (200, 7), (600, 3)), True),
        (((0, 4), (100, 5), (600, 3)), True),
        (((0, 9), (100, 9), (200, 8), (300, 6), (400, 3)), True),
        (((0, 9), (100, 9), (200, 3), (600, 1)), False),
        (((0, 9), (100, 3), (300, 2), (600, 0.1)), False),
        (((0, 9), (100, 8), (200, 5), (300, 4)), False),
        (((0, 3), (100, 3), (200, 4), (300, 5), (400, 1)), False),
    ],
    ids=range(10),
)
def test_lines_of_an_envelope_are_its_sides_if_it_is_concave(
    corners: tuple[tuple[float, float], ...], concave: bool
) -> None:
    """Beside envelopes with fewer and more corners; the least of its lines is the envelope."""
    long = tuple((100.0 * i, 9.0 - i**2 / 9.0) for i in range(8))
    drives = [Drive(envelope=points) for points in (corners, ((0.0, 1.0), (50.0, 0.5)), long)]
    table = drive_table([*drives, Drive()])
    assert table.concave.tolist() == [concave, True, True, True]
    speeds, torques = np.array(corners, float).T
    sides = len(corners) - 1
    np.testing.assert_allclose(table.slopes[0, :sides], np.diff(torques) / np.diff(speeds))
    assert np.isnan(table.slopes[0, sides:]).all()
    assert table.corner_speed[0, -1] == table.top_speed[0] == speeds[-1]
    a, s = table.lines
    assert np.isinf(a[0, sides:]).all()
    assert not s[0, sides:].any()
    assert not s[3].any()
    if concave:
        w = np.linspace(0.0, speeds[-1], 37)
        least = (a[0, :, None] - s[0, :, None] * w).min(axis=0)
        np.testing.assert_allclose(least, np.interp(w, speeds, torques), rtol=1e-12)


def test_drives_with_and_without_limits_stand_in_one_table() -> None:
    load = random_load(np.random.default_rng(8), dwell=0.5)
    bent = ((0.0, 9.0), (100.0, 2.0), (300.0, 1.9), (600.0, 0.1))
    drives = [
        Drive(), Drive(rated_torque=50.0), replace(SERVO, envelope=((0.0, 9.0), (600.0, 1.0))),
        Drive(envelope=bent), Drive(top_speed=100.0), Drive(peak_torque=1e-3),
    ]  # fmt: skip
    together = size_drives(load, drive_table(drives))
    alone = [size_drives(load, drive_table([drive])) for drive in drives]
    np.testing.assert_allclose(together.use, [one.use[0] for one in alone], rtol=1e-12)
    assert together.feasible[[0, 1]].all()
    assert not together.feasible[5]
    ends = [ratio_intervals(load, drive_table([drive])) for drive in drives]
    found = ratio_intervals(load, drive_table(drives))
    np.testing.assert_allclose(found.low, [one.low[0] for one in ends], rtol=1e-12)
    np.testing.assert_allclose(found.high, [one.high[0] for one in ends], rtol=1e-12)


def test_no_torque_uses_no_share_where_an_envelope_gives_none() -> None:
    """At its top speed this envelope, which is not concave, gives no torque: 0 of 0 is kept."""
    speed = np.full(5, 50.0)
    load = ActuatorLoad(
        "M1", (DutyMotion(np.linspace(0.0, 1.0, 5), load_signals(0 * speed, 0 * speed, speed),
                          1.0, 0.0, 0.0),), 0.0,
    )  # fmt: skip
    bent = ((0.0, 9.0), (100.0, 2.0), (300.0, 1.9), (600.0, 0.0))
    table = drive_table([Drive(envelope=bent)])
    assert not table.concave.any()
    for ratio in (2.0, 6.0, 12.0):
        assert envelope_share(load, replace(table, ratio=np.array([ratio])))[0] == 0.0


def test_an_envelope_that_is_not_concave_holds_up_to_its_top_speed_and_not_beyond() -> None:
    speed = np.full(5, 50.0)
    signals = load_signals(np.full(5, 1.2), 0 * speed, speed)
    load = ActuatorLoad("M1", (DutyMotion(np.linspace(0, 1, 5), signals, 1.0, 0.0, 0.0),), 0.0)
    table = drive_table([Drive(envelope=((0.0, 9.0), (100.0, 2.0), (300.0, 1.9), (600.0, 0.5)))])
    assert not table.concave.any()
    (passage,) = load.passages
    back = replace(load, passages=(passage._replace(signals=-signals),))
    for ratio, limit in ((2.0, 2.0), (6.0, 1.9), (12.0, 0.5), (12.01, 0.0)):
        for one in (load, back):
            share, _ = envelope_share(one, replace(table, ratio=np.array([ratio])))
            expected = 1.2 / ratio / limit if limit else np.inf
            assert share[0] == pytest.approx(expected, rel=1e-12)


def test_an_envelope_that_ends_without_torque_gives_none_at_its_top_speed() -> None:
    """Nor less than none, by rounding, of which any torque would be a small share."""
    speed, torque = np.full(3, 50.0), np.full(3, 0.4)
    signals = load_signals(torque, 0 * speed, speed)
    load = ActuatorLoad("M1", (DutyMotion(np.arange(3.0), signals, 1.0, 0.0, 0.0),), 0.0)
    table = random_drives(np.random.default_rng(2), 60, bent=True)
    share, _ = envelope_share(load, replace(table, ratio=table.corner_speed[:, -1] / 50.0))
    assert (share > 1e6).all()


def test_envelopes_that_rise_with_the_speed_are_used_most_where_it_is_least() -> None:
    """Beside one that falls; the worst sample is found in its block, and of all drives at once."""
    rising = Drive(envelope=((0.0, 1.0), (100.0, 3.0)))
    bowed = Drive(envelope=((0.0, 1.0), (50.0, 2.5), (100.0, 2.0)))
    falling = Drive(envelope=((0.0, 3.0), (100.0, 1.0)))
    rng = np.random.default_rng(5)
    for drives in ([rising], [rising, falling], [bowed, rising, falling]):
        table = drive_table([*drives, Drive()])  # the last one without limits
        for turn in (1.0, -1.0):
            speed = turn * rng.uniform(0.0, 90.0, 300)
            torque = rng.uniform(-0.5, 0.5, 300)
            torque[128:192] = -turn * rng.uniform(0.0, 0.8, 64)  # all of one sign
            speed[128:192] = turn * 80.0
            speed[[32, 170]], torque[[32, 170]] = turn * 0.1, [0.45, -turn * 0.9]
            signals = load_signals(torque, 0 * speed, speed)
            passage = DutyMotion(np.linspace(0.0, 1.0, 300), signals, 1.0, 0.0, 0.0)
            share, sample = envelope_share(ActuatorLoad("M1", (passage,), 0.0), table)
            assert share[len(drives) :].tolist() == [0.0]
            for drive, own, at in zip(drives, share, sample, strict=False):
                w, tau = np.array(drive.corners).T
                lines = [
                    (np.abs(torque) - slope * np.abs(speed)) / (t - slope * s)
                    for s, t, slope in zip(w, tau, np.diff(tau) / np.diff(w), strict=False)
                ]
                used = np.max(lines, axis=0)
                assert own == pytest.approx(used.max(), rel=1e-12)
                assert used[at] == pytest.approx(used.max(), rel=1e-12)


@pytest.mark.parametrize("torque", [0.0, 0.4, -0.4])
@pytest.mark.parametrize("drives", [1, 3])
def test_a_constant_torque_uses_the_same_share_all_along(torque: float, drives: int) -> None:
    still = np.zeros(150)
    signals = load_signals(np.full(150, torque), still, still)
    load = ActuatorLoad("M1", (DutyMotion(np.arange(150.0), signals, 1.0, 0.0, 0.0),), 0.0)
    share, _ = envelope_share(load, drive_table([SERVO] * drives))
    assert share == pytest.approx(np.full(drives, abs(torque) / 0.9))


def test_how_many_are_worked_on_at_a_time_does_not_matter(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(9)
    load, table = random_load(rng), random_drives(rng, 7)
    bent = random_drives(rng, 7, bent=True)
    whole = [envelope_share(load, one) for one in (table, bent)]
    for block in (1, 450):
        monkeypatch.setattr(sizing, "BLOCK", block)
        for one, expected in zip((table, bent), whole, strict=True):
            np.testing.assert_array_equal(envelope_share(load, one), expected)


def test_sizing_tells_how_far_windings_are_too_and_ends_when_it_is_not_wanted() -> None:
    load = random_load(np.random.default_rng(8), dwell=0.5)
    drive = replace(combined(SERVO, GEAR), thermal_time_constant=load.period)
    rms = float(size_drives(load, drive_table([drive])).rms[0])
    table = drive_table([replace(drive, rated_torque=1.02 * rms)] * 200)
    told: list[float] = []
    found = size_drives(load, table, progress=lambda done, /, **_: told.append(done))
    assert found.limit(0) == "winding temperature"
    assert told == [0.5, *(0.5 + 0.5 * done / 200 for done in (64, 128, 192, 200))]
    with pytest.raises(Canceled):
        size_drives(load, table, progress=lambda done, /, **_: done > 0.5)


def test_shares_are_figures_over_their_limits() -> None:
    """Of drives with all limits, with none but the envelope, and with a brake; by definition."""
    rng = np.random.default_rng(10)
    (passage,) = random_load(rng, 200, bias=1.0).passages
    passage = passage._replace(dwell=0.3 * passage.t[-1], held=-70.0)
    load = ActuatorLoad("M1", (passage,), 0.4)
    full = replace(
        combined(SERVO, GEAR), rated_torque=20.0, envelope=((0.0, 0.8), (600.0, 0.7)),
        thermal_time_constant=load.period, gear_rated_torque=30.0, gear_peak_torque=70.0,
    )  # fmt: skip
    bare = Drive(rotor_inertia=1e-4, gear_ratio=50.0, peak_torque=1.0)
    rms = float(size_drives(load, drive_table([full])).rms[0])
    hot = replace(full, rated_torque=rms / 1.3)  # too hot, whatever its temperature is exactly
    drives = [full, replace(full, brake=True), bare, hot]
    drives.append(replace(hot, envelope=((0.0, 2.0), (600.0, 1.9))))  # hot, but strong
    found = size_drives(load, drive_table(drives), inertia_ratio=7.0)
    heat = (found.rms / [20.0, 20.0, np.inf, rms / 1.3, rms / 1.3]) ** 2
    envelopes, expected = envelope_share(load, found.table)[0], []
    for i, drive in enumerate(drives):
        held = 0.0 if drive.holds else 70.0 / drive.ratio / drive.corners[0][1]
        gear = drive.gear_limits
        expected.append([
            found.rms[i] / (drive.rated_torque or np.inf),
            max(envelopes[i], held),
            drive.ratio * load.top_speed / (drive.top_speed or np.inf),
            drive.ratio * load.mean_speed / (drive.rated_speed or np.inf),
            load.inertia / (drive.ratio**2 * drive.inertia) / 7.0,
            heat[i] / (1.0 - np.exp(-1.0)),
            load.rms / gear.rated,
            load.peak / gear.peak,
        ])  # fmt: skip
    np.testing.assert_allclose(found.shares, expected, rtol=1e-12)
    assert expected[0][1] == pytest.approx(70.0 / 80.0 / 0.8)
    assert expected[1][1] < expected[0][1]
    assert expected[4][1] < 1
    assert found.limit(0) != "winding temperature" == found.limit(3) == found.limit(4)


def test_what_uses_exactly_its_limit_is_feasible() -> None:
    use = np.array([1.05, 1.0, 0.5, 1.0 + 1e-12, 0.9])
    table = random_drives(np.random.default_rng(0), 5)
    assert ordered(table, use, "margin").tolist() == [2, 4, 1]
    table = replace(table, mass=np.array([1.0, 1.0, 2.0, 0.5, np.nan]))
    assert ordered(table, use, "mass").tolist() == [1, 2, 4]
    load = random_load(np.random.default_rng(1))
    fast = drive_table([Drive(top_speed=load.top_speed * factor) for factor in (1.0, 1 - 1e-12)])
    assert size_drives(load, fast).feasible.tolist() == [True, False]
    one = RatioIntervals(*np.array([[1.0, 1.0, 2.0, np.nan], [2.0, 1.0, 1.0, 3.0]]), *[use] * 2)
    assert one.feasible.tolist() == [True, True, False, False]


def test_ratio_of_inertias_may_be_below_one_and_counts_only_if_it_is_limited() -> None:
    load = random_load(np.random.default_rng(4), 101)
    table = drive_table([replace(SERVO, gear_ratio=ratio) for ratio in (20.0, 80.0)])
    place = LIMITS.index("inertia ratio")
    own = load.inertia / (np.array([20.0, 80.0]) ** 2 * SERVO.inertia)
    assert not size_drives(load, table).shares[:, place].any()
    for most in (0.5, 30.0):
        np.testing.assert_allclose(
            size_drives(load, table, inertia_ratio=most).shares[:, place], own / most, rtol=1e-12
        )
    for measure in (size_drives, ratio_intervals):
        for impossible in (0.0, -1.0, math.nan):
            with pytest.raises(InvalidInput, match="inertia_ratio: a number above 0"):
                measure(load, table, inertia_ratio=impossible)


@pytest.mark.parametrize("braked", [(False, False), (True, False), (False, True), (True, True)])
def test_a_drive_has_a_brake_if_one_of_its_parts_has_one(braked: tuple[bool, bool]) -> None:
    motor, gear = (replace(part, brake=b) for part, b in zip((SERVO, GEAR), braked, strict=True))
    assert combined(motor, gear).brake == any(braked)
