"""Feasible ratios of motors: against every sample by definition, and where they are looked for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import simpson

from paminsa_viz.actuation import ratios
from paminsa_viz.actuation.catalog import CatalogError
from paminsa_viz.actuation.drive_table import DriveTable, drive_table
from paminsa_viz.actuation.duty import ActuatorLoad, DutyCycle, DutyMotion, load_signals
from paminsa_viz.actuation.ratios import (
    _interval,
    catalog_ratios,
    figure_of_merit,
    ratio_intervals,
)
from paminsa_viz.actuation.sizing import rms_torque, size_drives
from paminsa_viz.files.drive_catalog import generic_catalog
from paminsa_viz.model import APPENDIX_4, Drive
from paminsa_viz.model.arrays import Array
from paminsa_viz.trajectory.integrals import running_integral
from tests.actuation.loads import cases, random_drives, random_load
from tests.actuation.motor_loads import SERVO, motor_torque

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


def test_closed_form_ratios_are_those_of_brute_force() -> None:
    feasible = total = 0
    for load, table, most in cases(np.random.default_rng(1), 3, 20):
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


def uneven_load(rng: np.random.Generator, samples: int = 200) -> ActuatorLoad:
    """Draw a load whose samples are so uneven that any of them may ask most of a drive."""
    load = random_load(rng, samples, dwell=0.5, bias=1.0)
    (passage,) = load.passages
    torque, growth, speed = load.torque.copy(), *passage.signals[[3, 4]].copy()
    for values in (torque, growth, speed):
        values *= rng.uniform(0.2, 2.0, samples)
    return replace(
        load, passages=(passage._replace(signals=load_signals(torque, growth, speed)),)
    )  # fmt: skip


def keeps_all(load: ActuatorLoad, drive: Drive, ratios: Array, inertia_ratio: float) -> Array:
    """As `kept`, with the load's own quadrature, and also of drives without rated values."""
    (passage,) = load.passages
    tau, speed = motor_torque(load, drive, ratios), np.abs(load.signals[4])
    held = 0.0 if drive.holds else np.abs(passage.held) / ratios
    square = running_integral(passage.t, tau.T**2)[-1] + passage.dwell * np.square(held)
    speeds, torques = np.array(drive.corners).T
    limit = np.interp(ratios[:, None] * speed, speeds, torques, right=-1.0)
    rated = np.inf if drive.rated_torque is None else drive.rated_torque
    good = (np.abs(tau) <= limit).all(axis=1) & (square / load.period <= rated**2)
    mean = ratios * running_integral(passage.t, speed)[-1] / load.period
    good &= (mean <= (drive.rated_speed or np.inf)) & (held <= torques[0])
    return good & (load.inertia / (ratios**2 * drive.inertia) <= inertia_ratio)


def drives_of_all_kinds(rng: np.random.Generator, each: int) -> DriveTable:
    """Draw drives with and without a rated torque, with friction, and with bent envelopes."""
    kinds = ({}, {"coulomb": 0.1}, {"bent": True}, {"coulomb": 0.1, "bent": True})
    drives = []
    for kind in kinds:
        table = random_drives(rng, each, **kind)  # type: ignore[arg-type]
        drives += [table.drive(i) for i in range(each)]
    free = [replace(drive, rated_torque=None, rated_speed=None) for drive in drives[::2]]
    return drive_table([*drives, *free])


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2))
def test_ends_are_where_a_sample_or_a_mean_begins_to_exceed_its_limit(seed: int) -> None:
    """Of drives of every kind in one table; only friction and bent envelopes need a scan."""
    rng = np.random.default_rng(seed)
    load, table, most = uneven_load(rng), drives_of_all_kinds(rng, 4), 30.0
    found = ratio_intervals(load, table, inertia_ratio=most)
    bent = [len(table.drive(i).envelope) == 4 for i in range(len(table))]
    np.testing.assert_array_equal(found.scanned, (table.coulomb > 0) | bent)
    assert not found.gaps[~found.scanned].any()
    assert 0.1 < found.feasible.mean() < 0.9
    grid = np.geomspace(1e-3, 1e5, 600)
    for i in range(len(table)):
        low, high, drive = found.low[i], found.high[i], table.drive(i)
        if not found.feasible[i]:
            assert not keeps_all(load, drive, grid, most).any()
            continue
        around = np.array(
            [low * (1 - 1e-7), low * (1 + 1e-7), high * (1 - 1e-7), high * (1 + 1e-7)]
        )
        assert keeps_all(load, drive, around, most).tolist() == [False, True, True, False]
        if not found.gaps[i]:
            inside = np.geomspace(low * (1 + 1e-7), high * (1 - 1e-7), 30)
            assert keeps_all(load, drive, inside, most).all()


@pytest.mark.parametrize("size", [2.0**-12, 2.0**12])
def test_ratios_are_in_proportion_to_a_load_that_turns_the_less_the_larger_it_is(
    size: float,
) -> None:
    """The motor's own torque and speed are the same: ratios may be far below and above one."""
    rng = np.random.default_rng(5)
    load, table = uneven_load(rng), drives_of_all_kinds(rng, 2)
    (passage,) = load.passages
    signals = passage.signals * np.array([[size]] * 3 + [[1 / size]] * 2 + [[1.0]])
    larger = replace(
        load, passages=(passage._replace(signals=signals, held=size * passage.held),),
        inertia=size**2 * load.inertia,
    )  # fmt: skip
    strong = replace(table, gear_rated=size * table.gear_rated, gear_peak=size * table.gear_peak)
    one = ratio_intervals(load, table, inertia_ratio=30.0)
    two = ratio_intervals(larger, strong, inertia_ratio=30.0)
    np.testing.assert_array_equal(one.feasible, two.feasible)
    np.testing.assert_array_equal(one.gaps, two.gaps)
    kept = one.feasible
    np.testing.assert_allclose(two.low[kept], size * one.low[kept], rtol=1e-9)
    np.testing.assert_allclose(two.high[kept], size * one.high[kept], rtol=1e-9)


def test_a_few_samples_cut_an_interval(monkeypatch: pytest.MonkeyPatch) -> None:
    """All samples are looked at a few times, and no more once both ends keep their limits."""
    looks: list[int] = []
    right = ratios.envelope_share
    monkeypatch.setattr(
        ratios, "envelope_share", lambda *given: looks.append(len(given[1])) or right(*given)
    )
    rng = np.random.default_rng(1)
    ratio_intervals(uneven_load(rng, 2000), random_drives(rng, 40))
    assert 2 <= len(looks) < 20


@pytest.mark.parametrize("third", [False, True])
def test_a_sample_may_end_an_interval_that_another_one_has_cut_before(third: bool) -> None:
    """By torque T, growth and speed: (T + u N^2)/N + k w N <= 2, and a tenth of it all."""
    torque, growth, speed = np.zeros((3, 200))
    even = np.linspace(0, 199, ratios.FIRST_SAMPLES).astype(int)
    hidden = np.flatnonzero(~np.isin(np.arange(200), even))[[20, 60, 30]]
    torque[[150, 151]], growth[[150, 151]], speed[151] = (12.0, 11.0), -50.0, 1.0  # N >= 5.3
    growth[10], speed[80] = 100.0, 12.0  # the largest growth and speed: N <= 20, N <= 16.7
    growth[hidden[:2]], speed[hidden[:2]] = (90.0, 80.0), (11.0, 7.0)
    speed[3] = 0.1  # the first that turns
    torque[hidden[1]] = 6.0  # less at 16.7 than the other one, which ends at 10, and more there
    ends = [(np.sqrt(6.4) - 2.0) / 0.1, (2.0 + np.sqrt(0.4)) / 0.3]
    if third:
        torque[hidden[2]], speed[hidden[2]] = 10.5, 2.0
        ends[0] = (2.0 - np.sqrt(3.16)) / 0.04
    signals = load_signals(0.1 * torque, 10.0 * growth, 10.0 * speed)
    load = ActuatorLoad("M1", (DutyMotion(np.arange(200.0), signals, 1.0, 0.0, 0.0),), 0.0)
    drive = Drive(rotor_inertia=1e-3, envelope=((0.0, 2.0), (200.0, 0.0)))
    found = ratio_intervals(load, drive_table([drive]))
    assert (found.low[0], found.high[0]) == pytest.approx(0.1 * np.array(ends), rel=1e-9)


def test_only_intervals_that_are_left_are_cut_or_scanned(monkeypatch: pytest.MonkeyPatch) -> None:
    """Also one of a single ratio: at 2 the motor has its top speed, and holds the load."""
    t, still = np.array([0.0, 1.0]), np.zeros(2)
    signals = load_signals(still, still, np.full(2, 50.0))
    load = ActuatorLoad("M1", (DutyMotion(t, signals, 1.0, 2.0, 4.0),), 0.0)
    straight, bent = (
        ((0.0, 2.0), (600.0, 2.0)),
        ((0.0, 2.0), (50.0, 1.0), (99.0, 0.9), (100.0, 0.1)),
    )
    rubs = {"coulomb": 1e-3}
    drives, wanted = [], []
    for envelope, more in ((straight, {}), (straight, rubs), (bent, {}), (bent, rubs)):
        kind = (envelope == straight, bool(more) or envelope == bent)
        for top, is_left in ((150.0, True), (100.0, True), (99.0, False)):
            drives.append(Drive(rotor_inertia=1e-5, envelope=envelope, top_speed=top, **more))
            wanted.append((is_left and kind[0], is_left and kind[1]))
    table = replace(drive_table(drives), top_speed=np.array([150.0, 100.0, 99.0] * 4))
    rows: dict[str, NDArray[np.intp]] = {}
    for name in ("_cut", "_scan"):
        monkeypatch.setattr(
            ratios, name, lambda _, __, found, *ends, name=name: rows.update({name: found})
        )
    ratio_intervals(load, table)
    for place, name in enumerate(("_cut", "_scan")):
        assert rows[name].tolist() == [i for i, both in enumerate(wanted) if both[place]]


def test_a_catalog_without_screws_has_no_ratios_for_the_lift() -> None:
    catalog = replace(generic_catalog(), transmissions=())
    cycle = DutyCycle(APPENDIX_4, (), 1.0, (random_load(np.random.default_rng(0)),) * 4)
    with pytest.raises(CatalogError, match="no screw or belt"):
        catalog_ratios(cycle, catalog)


@pytest.mark.parametrize(("coulomb", "drives"), [(0.0, 40), (0.5, 4)], ids=["smooth", "rubbing"])
def test_the_ends_of_an_interval_reach_a_limit_and_do_not_exceed_it(
    coulomb: float, drives: int
) -> None:
    """Also of drives without rated torques, and without any limit but the lines of envelopes."""
    rng = np.random.default_rng(3)
    for load, table, _ in cases(rng, 4, drives, coulomb=coulomb):
        endless = np.full(drives, np.inf)
        cool = replace(table, rated_torque=endless)
        bare = replace(cool, top_speed=endless, rated_speed=endless)
        for one in (table, cool, bare):
            found = ratio_intervals(load, one)
            rows = np.flatnonzero(found.feasible)
            assert (found.low[rows] > 0).all()
            for ends in (found.low[rows], found.high[rows]):
                use = size_drives(load, replace(one[rows], ratio=ends)).use
                np.testing.assert_allclose(use, 1.0, rtol=1e-9)


def test_an_interval_of_a_single_ratio_is_looked_at_too() -> None:
    """Held with 2 at least, turned with 2 at most; a sample that asks too much is found."""
    t = np.linspace(0.0, 1.0, 200)
    torque, growth, speed = np.full(200, 0.1), np.zeros(200), np.full(200, 50.0)
    torque[0], growth[0] = 5.0, -1000.0  # more than any other, and the motor helps itself
    limits = {"envelope": ((0.0, 2.0), (100.0, 2.0)), "top_speed": 100.0}
    table = drive_table([Drive(rotor_inertia=1e-3, **limits)])
    even = np.linspace(0, 199, ratios.FIRST_SAMPLES).astype(int)
    place = int(np.flatnonzero(~np.isin(np.arange(200), even))[40])
    for most, feasible in ((0.1, True), (3.9, True), (4.1, False)):
        torque[place] = most
        signals = load_signals(torque, growth, speed)
        load = ActuatorLoad("M1", (DutyMotion(t, signals, 1.0, 2.0, 4.0),), 0.0)
        found = ratio_intervals(load, table)
        assert found.feasible.tolist() == [feasible]
        assert not feasible or (found.low[0], found.high[0]) == (2.0, 2.0)


@pytest.mark.parametrize("turn", [1.0, -1.0])
def test_a_load_that_is_there_for_one_sample_only_limits_both_ends(turn: float) -> None:
    """A torque 6 N m, and a growth of 400 rad/s^2, to either side: 6/2 and 2/(400 J)."""
    torque, growth = np.zeros((2, 200))
    for place in (101, 102, 103):  # at most one of them is looked at anyway
        torque[:], growth[:] = 0.0, 0.0
        torque[place], growth[place - 50] = 6.0 * turn, 400.0 * turn
        signals = load_signals(torque, growth, np.zeros(200))
        load = ActuatorLoad("M1", (DutyMotion(np.arange(200.0), signals, 1.0, 0.0, 0.0),), 0.0)
        found = ratio_intervals(load, drive_table([Drive(rotor_inertia=1e-4, peak_torque=2.0)]))
        assert (found.low[0], found.high[0]) == pytest.approx((3.0, 50.0), rel=1e-12)


def test_figure_of_merit_decides_which_motors_have_a_ratio_for_their_rms() -> None:
    """Whose ends have the rated torque; just above what is asked there is one ratio, below none."""
    rng = np.random.default_rng(5)
    for load, table, _ in cases(rng, 4, 60):
        free = replace(
            table,
            corner_torque=np.full_like(table.corner_torque, np.inf),
            corner_speed=np.tile([0.0, *[np.inf] * (table.corner_speed.shape[1] - 1)], (60, 1)),
            top_speed=np.full(60, np.inf), rated_speed=np.full(60, np.inf),
        )  # fmt: skip
        _, asked = figure_of_merit(load, free)
        for share in (1e-3, 1e-9, -1e-9, -1e-3):
            plain = replace(free, rated_torque=np.sqrt((1 + share) * asked * free.inertia))
            alpha, same = figure_of_merit(load, plain)
            np.testing.assert_allclose(alpha, (1 + share) * asked, rtol=1e-12)
            np.testing.assert_array_equal(same, asked)
            found = ratio_intervals(load, plain)
            assert (found.feasible == (share > 0)).all()
            for ends in (found.low, found.high) if share > 0 else ():
                rms = rms_torque(load, plain, ends)
                np.testing.assert_allclose(rms, plain.rated_torque, rtol=1e-9)


def test_an_interval_is_where_its_quadratic_is_not_positive() -> None:
    """Of every sign and none; but with a negative limit one of the others has to be positive."""
    rng = np.random.default_rng(1)
    square, limit, constant = rng.choice([-1.0, 0.0, 1.0], (3, 600)) * rng.uniform(
        0.5, 2.0, (3, 600)
    )
    split = (square <= 0) & (constant <= 0)
    limit = np.where(split, np.abs(limit), limit)
    with np.errstate(all="ignore"):
        low, high = _interval(square, limit, constant)
    x = np.geomspace(1e-6, 1e6, 2001)[:, None]
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
        ([(GRID[0] * 1.003, 30.0)], False),
        ([(30.0, GRID[-1] * 0.997)], False),
        ([(2.0, GRID[400] * 1.001), (GRID[401] * 1.001, 500.0)], True),
        ([(20.0, GRID[700] * 1.001), (GRID[702] * 0.999, GRID[702] * 1.001)], True),
    ],
    ids=range(13),
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


@pytest.mark.parametrize(
    ("start", "kept", "ends"),
    [
        (2.0, (1.0, 1e3), (2.0, 1e3)),
        (0.1, (1.0, 2e5), (1.0, 2e5)),
        (0.1, (1.0, 1.05e6), (1.0, np.inf)),
        (2.0, (1.0, 1.05e6), (2.0, 1.05e6)),
        (0.0, (1e-5, 10.0), (1e-5, 10.0)),
        (0.0, (5e-7, 10.0), (0.0, 10.0)),
    ],
    ids=str,
)
def test_a_scan_that_no_limit_ends_is_so_and_so_wide(
    start: float, kept: tuple[float, float], ends: tuple[float, float],
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    """Up to a million times the lower end, or 1; down to the millionth part of 1."""
    monkeypatch.setattr(ratios, "_keeps", lambda _, __, n: (kept[0] <= n) & (n <= kept[1]))
    load, table = random_load(np.random.default_rng(0)), random_drives(np.random.default_rng(0), 1)
    low, high = np.array([start]), np.array([np.inf])
    assert not ratios._scan(load, table, np.array([0]), low, high)[0]
    np.testing.assert_allclose((low[0], high[0]), ends, rtol=1e-9)


def test_a_drive_without_inertia_has_ratios_too() -> None:
    load = random_load(np.random.default_rng(7))
    table = drive_table([replace(SERVO, rotor_inertia=0.0, rated_torque=5.0, peak_torque=9.0)])
    found = ratio_intervals(load, table)
    assert found.feasible[0]
    use = size_drives(load, replace(table, ratio=found.low)).use
    np.testing.assert_allclose(use, 1.0, rtol=1e-9)


def test_a_load_that_is_only_held_and_a_gear_that_is_too_weak_limit_the_ratios() -> None:
    t, still = np.array([0.0, 1.0]), np.zeros(2)
    passage = DutyMotion(t, load_signals(still, still, still), 1.0, 2.0, -0.6)
    load = ActuatorLoad("M1", (passage,), 0.0)
    envelope = ((0.0, 9.0), (100.0, 2.0), (600.0, 1.0))
    strong = Drive(rotor_inertia=1e-5, envelope=envelope)
    for drives, low in (
        ([strong, replace(strong, brake=True)], [0.6 / 9.0, 0.0]),
        ([replace(strong, gear_peak_torque=torque) for torque in (0.6, 0.59)], [0.6 / 9.0, np.nan]),
        (
            [replace(strong, gear_rated_torque=load.rms * more) for more in (1.0, 1 - 1e-12)],
            [0.6 / 9.0, np.nan],
        ),
    ):
        found = ratio_intervals(load, drive_table(drives))
        np.testing.assert_allclose(found.low, low, rtol=1e-12)
        assert found.feasible.tolist() == [not np.isnan(one) for one in low]
