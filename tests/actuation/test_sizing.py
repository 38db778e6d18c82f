"""Sizing of drives: against brute force, independent integrals, and the robot's own dynamics."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import simpson

from paminsa_viz.actuation import ratios
from paminsa_viz.actuation.drive_table import combined, drive_table, pair_table
from paminsa_viz.actuation.duty import ActuatorLoad, DutyMotion, load_signals
from paminsa_viz.actuation.ratios import _interval, figure_of_merit, ratio_intervals
from paminsa_viz.actuation.sizing import LIMITS, envelope_share, size_drives
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model import Drive
from paminsa_viz.model.arrays import Array
from tests.actuation.loads import random_drives, random_load
from tests.actuation.motor_loads import GEAR, SERVO, motor_torque

RATIOS = np.geomspace(0.5, 3000.0, 140)


def kept(load: ActuatorLoad, drive: Drive, ratios: Array, inertia_ratio: float) -> Array:
    """Whether a drive keeps its limits with ratios, by evaluating every sample."""
    (passage,) = load.passages
    tau = motor_torque(load, drive, ratios)
    speed = np.abs(load.signals[4])
    period = passage.t[-1] + passage.dwell
    held = 0.0 if drive.holds else passage.held / ratios
    square = simpson(tau**2, x=passage.t) + passage.dwell * np.square(held)
    speeds, torques = np.array(drive.corners).T
    limit = np.interp(ratios[:, None] * speed, speeds, torques, right=-1.0)
    good = (np.abs(tau) <= limit).all(axis=1) & (square / period <= drive.rated_torque**2)
    good &= ratios * simpson(speed, x=passage.t) / period <= drive.rated_speed
    if passage.dwell:
        good &= np.abs(held) <= torques[0]
    return good & (load.inertia / (ratios**2 * drive.inertia) <= inertia_ratio)


def cases(rng: np.random.Generator, count: int, drives: int, **kind):  # type: ignore[no-untyped-def]
    for _ in range(count):
        load = random_load(
            rng, 801, dwell=rng.choice([0.0, 1.0]), bias=rng.normal() * rng.choice([0.0, 2.0])
        )
        yield load, random_drives(rng, drives, **kind), rng.choice([np.inf, 30.0])


@pytest.mark.parametrize(
    ("loads", "drives"), [(3, 20), pytest.param(12, 60, marks=pytest.mark.slow)], ids=["", "many"]
)
def test_closed_form_ratios_are_those_of_brute_force(loads: int, drives: int) -> None:
    feasible = total = 0
    for load, table, most in cases(np.random.default_rng(1), loads, drives):
        found = ratio_intervals(load, table, inertia_ratio=most)
        assert not found.scanned.any()
        for i in range(len(table)):
            expected = kept(load, table.drive(i), RATIOS, most)
            inside = (found.low[i] <= RATIOS) & (found.high[i] >= RATIOS)
            # the interval's own RMS is another integral than Simpson's
            near = np.isclose(RATIOS, found.low[i], 1e-4) | np.isclose(RATIOS, found.high[i], 1e-4)
            np.testing.assert_array_equal(inside[~near], expected[~near])
            feasible, total = feasible + expected.sum(), total + len(RATIOS)
    assert 0.05 < feasible / total < 0.6


@pytest.mark.slow
@pytest.mark.parametrize("kind", [{"coulomb": 0.5}, {"bent": True}], ids=["Coulomb", "bent"])
def test_scanned_ratios_are_those_of_brute_force_and_say_so(kind: dict[str, float]) -> None:
    feasible = 0
    for load, table, most in cases(np.random.default_rng(2), 3, 15, **kind):
        found = ratio_intervals(load, table, inertia_ratio=most)
        assert found.scanned.all()
        for i in np.flatnonzero(~found.gaps):
            expected = kept(load, table.drive(i), RATIOS, most)
            inside = (found.low[i] <= RATIOS) & (found.high[i] >= RATIOS)
            near = np.isclose(RATIOS, found.low[i], 1e-2) | np.isclose(RATIOS, found.high[i], 1e-2)
            np.testing.assert_array_equal(inside[~near], expected[~near])
            feasible += expected.sum()
    assert feasible > 100


def test_the_ends_of_an_interval_reach_a_limit_and_do_not_exceed_it() -> None:
    rng = np.random.default_rng(3)
    for load, table, _ in cases(rng, 4, 40):
        found = ratio_intervals(load, table)
        rows = np.flatnonzero(found.feasible & (found.low > 0))
        for ends in (found.low[rows], found.high[rows]):
            use = size_drives(load, replace(table[rows], ratio=ends)).use
            np.testing.assert_allclose(use, 1.0, rtol=1e-9)


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


def test_figure_of_merit_decides_which_motors_have_a_ratio_for_their_rms() -> None:
    rng = np.random.default_rng(5)
    free = {"top_speed": np.inf, "rated_speed": np.inf}
    for load, table, _ in cases(rng, 4, 60):
        plain = replace(
            table,
            corner_torque=np.full_like(table.corner_torque, np.inf),
            corner_speed=np.tile([0.0, *[np.inf] * (table.corner_speed.shape[1] - 1)], (60, 1)),
            **{name: np.full(60, value) for name, value in free.items()},
        )
        alpha, asked = figure_of_merit(load, plain)
        np.testing.assert_allclose(alpha, plain.rated_torque**2 / plain.inertia, rtol=1e-12)
        np.testing.assert_array_equal(alpha >= asked, ratio_intervals(load, plain).feasible)


def test_an_interval_is_where_its_quadratic_is_not_positive() -> None:
    """Of every sign and none, where friction is within the limit; and of means, where it is not."""
    rng = np.random.default_rng(1)
    square, limit, constant = rng.choice([-1.0, 0.0, 1.0], (3, 400)) * rng.uniform(
        0.5, 2.0, (3, 400)
    )
    means = (square > 0) & (constant >= 0)
    limit = np.where(means, limit, np.abs(limit))
    with np.errstate(all="ignore"):
        low, high = _interval(square, limit, constant)
    x = np.geomspace(1e-6, 1e6, 4001)[:, None]
    good = square * x**2 - limit * x + constant <= 0
    inside = (x >= low) & (x <= high)
    near = (np.abs(x - low) < 1e-9 * x) | (np.abs(x - high) < 1e-9 * x)
    assert (good == inside)[~near].all()


GRID = np.geomspace(2.0, 500.0, ratios.SCANNED)
"""Ratios that a scan from 2 to 500 tries."""


@pytest.mark.parametrize(
    ("sets", "gap"),
    [
        ([], False),
        ([(1.0, 1e3)], False),
        ([(2.0, 30.0)], False),
        ([(30.0, 500.0)], False),
        ([(20.0, 30.0)], False),
        ([(GRID[400] * 0.9999, GRID[400] * 1.0001)], False),
        ([(2.0, 30.0), (60.0, 500.0)], True),
        ([(GRID[0], GRID[0] * 1.0001), (60.0, 70.0)], True),
        ([(20.0, 30.0), (GRID[-1] * 0.9999, GRID[-1])], True),
    ],
    ids=range(9),
)
def test_a_scan_finds_the_ends_of_what_is_kept_and_whether_it_has_gaps(
    sets: list[tuple[float, float]], gap: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    def keeps(_: object, __: object, n: Array) -> Array:
        inside = [(a <= n) & (n <= b) for a, b in sets]
        return np.any(inside, axis=0) if sets else np.zeros(len(n), bool)

    monkeypatch.setattr(ratios, "_keeps", keeps)
    load, table = random_load(np.random.default_rng(0)), random_drives(np.random.default_rng(0), 3)
    low, high = np.full(3, 2.0), np.full(3, 500.0)
    found = ratios._scan(load, table, np.array([0, 2]), low, high)
    assert (found.tolist(), low[1], high[1]) == ([gap, False, gap], 2.0, 500.0)
    for row in (0, 2):
        ends = max(2.0, sets[0][0]) if sets else np.nan, min(500.0, sets[-1][1]) if sets else np.nan
        np.testing.assert_allclose((low[row], high[row]), ends, rtol=1e-9)
    if sets == [(1.0, 1e3)]:
        high[0] = np.inf
        ratios._scan(load, table, np.array([0]), low, high)
        assert (low[0], high[0]) == pytest.approx((2.0, 1e3), rel=1e-9)


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
    gears = [GEAR, replace(GEAR, gear_ratio=10.0, viscous=1e-6, coulomb=1e-3, cost=5.0)]
    screws = [
        Drive(
            "screw", gear_inertia=3e-5, viscous=1e-4, coulomb=2e-3, transmission="screw", lead=0.01,
            mass=2.0,
        ),
        Drive("belt", transmission="belt", lead=0.08, lead_efficiency=0.9),
    ]  # fmt: skip
    motors = [SERVO, replace(SERVO, envelope=((0.0, 0.9), (300.0, 0.9), (600.0, 0.2)), cost=9.0)]
    for parts in ((motors, gears), (motors, gears, screws)):
        table = pair_table(*parts)
        whole = drive_table([table.drive(i) for i in range(len(table))])
        for name in whole.__dataclass_fields__:
            if name not in ("parts", "catalog"):
                np.testing.assert_allclose(getattr(table, name), getattr(whole, name), rtol=1e-14)
    assert pair_table(motors, gears).drive(1).name == "servo, gear"


def test_a_drive_without_inertia_has_ratios_too() -> None:
    load = random_load(np.random.default_rng(7))
    table = drive_table([replace(SERVO, rotor_inertia=0.0, rated_torque=5.0, peak_torque=9.0)])
    found = ratio_intervals(load, table)
    assert found.feasible[0]
    use = size_drives(load, replace(table, ratio=found.low)).use
    np.testing.assert_allclose(use, 1.0, rtol=1e-9)


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
    for ratio, limit in ((2.0, 2.0), (6.0, 1.9), (12.0, 0.5), (12.01, 0.0)):
        share, _ = envelope_share(load, replace(table, ratio=np.array([ratio])))
        expected = 1.2 / ratio / limit if limit else np.inf
        assert share[0] == pytest.approx(expected, rel=1e-12)


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
    with pytest.raises(InvalidInput, match="above 0"):
        size_drives(load, table, inertia_ratio=0.0)


@pytest.mark.parametrize("braked", [(False, False), (True, False), (False, True), (True, True)])
def test_a_drive_has_a_brake_if_one_of_its_parts_has_one(braked: tuple[bool, bool]) -> None:
    motor, gear = (replace(part, brake=b) for part, b in zip((SERVO, GEAR), braked, strict=True))
    assert combined(motor, gear).brake == any(braked)
