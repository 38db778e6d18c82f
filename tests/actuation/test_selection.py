"""Drives chosen from a catalog: in order, the same for three, and what is missing if none fits."""

from __future__ import annotations

import re
from dataclasses import replace
from decimal import Decimal, getcontext
from functools import cache

import numpy as np
import pytest

from paminsa_viz.actuation.drive_table import combined, drive_table
from paminsa_viz.actuation.duty import (
    ActuatorLoad,
    Duty,
    DutyCycle,
    DutyMotion,
    duty_cycle,
    load_signals,
)
from paminsa_viz.actuation.ratios import catalog_ratios, ratio_intervals
from paminsa_viz.actuation.selection import Selection, cloud, figures, select_drives, size_design
from paminsa_viz.actuation.sizing import LIMITS, _weights, fitting_time, size_drives, thermal_share
from paminsa_viz.errors import InvalidInput
from paminsa_viz.files.drive_catalog import generic_catalog
from paminsa_viz.model import APPENDIX_4
from paminsa_viz.model.drive import Drive
from paminsa_viz.trajectory import PRESET
from paminsa_viz.units import number
from tests.actuation.motor_loads import GEAR, SERVO, motor_torque
from tests.support.documentation import missing


@cache
def cycle(slower: float = 1.0, payload: float = 0.0) -> DutyCycle:
    """An arch so many times as long, with so heavy a payload."""
    plan = PRESET["arch"].build(APPENDIX_4.geometry)
    motion = plan.lasting(slower * plan.duration).sample(200 / slower)
    return duty_cycle(APPENDIX_4.vary({"payload.mass": payload}), [Duty(motion)])


@cache
def selection(same: bool = False) -> Selection:
    return select_drives(cycle(), generic_catalog(), same=same)


def test_figures_are_those_of_the_motors_own_torque_and_speed() -> None:
    found = selection()
    for actuator in (0, 3):
        load, sizing = found.cycle.loads[actuator], found.sizings[actuator]
        for index in (int(found.rows[actuator][0]), int(np.flatnonzero(~sizing.feasible)[0])):
            given = figures(sizing, index)
            drive = sizing.table.drive(index)
            (torque,) = motor_torque(load, drive, np.array([drive.ratio]))
            speed = drive.ratio * load.signals[4]
            np.testing.assert_allclose(cloud(load, drive), [speed, torque], rtol=1e-9, atol=1e-12)
            assert given.drive == drive
            assert given.feasible == (given.use <= 1.0)
            assert given.peak == pytest.approx(np.abs(torque).max())
            assert given.top_speed == pytest.approx(np.abs(speed).max())
            assert given.top_power == pytest.approx(np.abs(torque * speed).max())
            assert given.limit == sizing.limit(index)
            assert (given.rms, given.envelope) == (sizing.rms[index], sizing.envelope[index])
            assert given.inertia_ratio == pytest.approx(
                load.inertia / (drive.inertia * drive.ratio**2)
            )
            lead = drive.ratio / drive.gear_ratio
            interval = ratio_intervals(load, sizing.table[index : index + 1])
            if interval.feasible[0]:
                ends = interval.low[0] / lead, interval.high[0] / lead
                assert given.ratios == pytest.approx(ends)
            else:
                assert np.isnan(given.ratios).all()


def test_what_a_screw_itself_takes_of_a_gear_is_as_documented() -> None:
    load, screw = cycle().loads[3], generic_catalog().transmissions[0]
    assert (screw.transmission, screw.lead) == ("screw", 0.005)
    own = np.abs(screw.inertia * screw.ratio * load.signals[3]).max()
    gear = Drive(gear_ratio=3.0, gear_peak_torque=1.0)
    table = drive_table([combined(replace(SERVO, rotor_inertia=0.0), gear, screw)])
    used = float(size_drives(load, table).shares[0, LIMITS.index("peak torque of the gear")])
    assert used == pytest.approx(load.peak / (screw.ratio * screw.lead_efficiency))
    assert PRESET["arch"].build(APPENDIX_4.geometry).duration == 1.2
    sentences = [
        f"On the preset's arch of 1.2 s it is up to {own:.3f} N·m",
        f"the load takes {used:.2f} N·m through the catalog's ball screw of 5 mm",
    ]
    assert missing("drives", sentences) == []


def test_a_drive_without_limits_names_none() -> None:
    load = cycle().loads[0]
    free = figures(size_drives(load, drive_table([Drive(rotor_inertia=1e-5, gear_ratio=20.0)])), 0)
    assert (free.feasible, free.use, free.limit) == (True, 0.0, "")
    peak = Drive(rotor_inertia=1e-5, gear_ratio=20.0, peak_torque=9.0)
    assert figures(size_drives(load, drive_table([peak])), 0).limit == "torque-speed envelope"


def test_figures_of_a_load_turned_around_are_the_same() -> None:
    """The largest torque, speed and power may be negative."""
    drive = combined(SERVO, replace(GEAR, coulomb=1e-3))
    for load in cycle().loads:
        passages = tuple(
            p._replace(signals=-p.signals, held=-p.held) for p in load.passages
        )  # fmt: skip
        turned = replace(load, passages=passages)
        here, there = (figures(size_drives(one, drive_table([drive])), 0) for one in (load, turned))
        assert replace(here, thermal=0.0) == replace(there, thermal=0.0)


def test_power_is_largest_in_size_also_where_the_motor_only_brakes() -> None:
    still, speed = np.zeros(3), np.array([1.0, 2.0, 3.0])
    signals = load_signals(np.array([-4.0, -9.0, -5.0]), still, speed)
    load = ActuatorLoad("M1", (DutyMotion(np.arange(3.0), signals, 1.0, 0.0, 0.0),), 0.0)
    drive = replace(SERVO, gear_ratio=10.0)
    found = figures(size_drives(load, drive_table([drive])), 0)
    assert (found.top_power, found.peak) == pytest.approx((18.0, 0.9))


def test_a_winding_has_a_temperature_if_its_time_and_its_torque_are_known() -> None:
    load = cycle().loads[0]
    for time, rated in ((9.0, 0.3), (None, 0.3), (9.0, None)):
        drive = replace(combined(SERVO, GEAR), thermal_time_constant=time, rated_torque=rated)
        table = drive_table([drive])
        found = figures(size_drives(load, table), 0).thermal
        if time is None or rated is None:
            assert np.isnan(found)
        else:
            assert found == thermal_share(load, table)[0] > 0


def test_the_first_feasible_drives_are_a_designs() -> None:
    found = selection()
    assert found.feasible
    assert not any(found.advice(actuator) for actuator in range(4))
    for actuator, drive in enumerate(found.drives):
        first, second = found.figures(actuator, 2)
        assert drive == first.drive
        assert first.feasible
        assert second.feasible
        rows = found.rows[actuator]
        assert (np.diff(found.sizings[actuator].table.mass[rows]) >= 0).all()
        np.testing.assert_array_equal(
            np.sort(rows), np.flatnonzero(found.sizings[actuator].feasible)
        )
    design = found.design(APPENDIX_4)
    assert design.drives == found.drives
    sized = size_design(found.cycle, design)
    for actuator, own in enumerate(sized):
        assert own is not None
        assert own.use == pytest.approx(found.figures(actuator, 1)[0].use)
    assert size_design(found.cycle, APPENDIX_4) == (None,) * 4


def test_the_same_drive_for_three_is_feasible_on_all_of_them() -> None:
    found = selection(same=True)
    rows = found.rows[0]
    common = np.all([sizing.feasible for sizing in found.sizings[:3]], axis=0)
    np.testing.assert_array_equal(np.sort(rows), np.flatnonzero(common))
    for other in found.rows[1:3]:
        np.testing.assert_array_equal(other, rows)
    np.testing.assert_array_equal(found.rows[3], selection().rows[3])
    assert len(set(found.drives[:3])) == 1
    by_use = select_drives(found.cycle, generic_catalog(), order="margin", same=True)
    worst = np.max([sizing.use for sizing in by_use.sizings[:3]], axis=0)
    assert (np.diff(worst[by_use.rows[0]]) >= 0).all()


@pytest.mark.slow
@pytest.mark.parametrize(("slower", "payload"), [(0.05, 0.0), (1.0, 10_000.0)])
def test_advice_where_no_drive_fits_is_how_much_slower_one_does(
    slower: float, payload: float
) -> None:
    """A motion that is too fast, and one with a payload that no motor lifts however slowly."""
    found = select_drives(cycle(slower, payload), generic_catalog())
    lacking = [actuator for actuator in range(4) if not len(found.rows[actuator])]
    assert lacking
    assert not found.feasible
    for actuator in lacking:
        sizing = found.sizings[actuator]
        assert found.drives[actuator] is None
        assert found.figures(actuator, 3) == []
        text = found.advice(actuator)
        nearest = figures(sizing, int(np.argmin(sizing.use)))
        before, _, after = text.partition(f"the nearest is {nearest.drive.name}, whose ")
        assert before == "no drive fits; "
        share = 100 * float(sizing.use.min())  # of a heavy payload it has a power of ten
        assert after.startswith(f"{nearest.limit} is {number(share)} % of its limit")
        factor = fitting_time(found.cycle, actuator, sizing.table)
        assert np.isfinite(factor) == (payload == 0.0 or actuator < 3)
        if np.isfinite(factor):
            said = re.search(r"; motions ([\d.]+) times as long make one fit$", text)
            assert said is not None
            assert 0 <= float(said[1]) - factor < 1e-3  # no less than it takes
            for share, fits in ((1.001, True), (0.99, False)):
                slow = cycle(share * factor * slower, payload).loads[actuator]
                assert size_drives(slow, sizing.table).feasible.any() == fits
        else:
            assert text.endswith("no slower motion makes one fit")
    own = generic_catalog().pairs(0).drive(0)
    kept = replace(APPENDIX_4, drives=(own, own, own, None))
    assert found.design(kept).drives[lacking[0]] == kept.drives[lacking[0]]


def test_advice_where_each_of_three_has_a_drive_but_not_the_same() -> None:
    nothing = np.empty(0, np.intp)
    found = replace(selection(), rows=(nothing,) * 3 + selection().rows[3:])
    assert found.advice(1).endswith("M1, M2 and M3 have feasible drives, but none in common")
    assert not found.feasible


def test_a_table_without_drives_and_orders_that_are_none_are_refused() -> None:
    load, table = cycle().loads[0], selection().sizings[0].table
    with pytest.raises(InvalidInput, match="table: at least one drive is needed"):
        size_drives(load, table[:0])
    for ratio in (0.0, -1.0, np.nan):
        with pytest.raises(InvalidInput, match="inertia_ratio: a number above 0 is needed"):
            size_drives(load, table, inertia_ratio=ratio)
    with pytest.raises(InvalidInput, match="order: mass, cost or margin is needed, not 'use'"):
        select_drives(cycle(), generic_catalog(), order="use")  # type: ignore[arg-type]


def test_the_inertia_ratio_is_a_limit_like_others() -> None:
    load, table = cycle().loads[0], selection().sizings[0].table
    free = size_drives(load, table)
    limit = float(np.median(free.inertia_ratio[free.feasible]))
    limited = size_drives(load, table, inertia_ratio=limit)
    np.testing.assert_array_equal(limited.feasible, free.feasible & (free.inertia_ratio <= limit))
    assert 0 < limited.feasible.sum() < free.feasible.sum()


def test_ratios_of_a_catalog_are_those_at_which_its_motors_begin_and_cease_to_fit() -> None:
    """Behind a gear without inertia; for M4 with the screws, whose inertia and friction count."""
    catalog = generic_catalog()
    some = [
        replace(motor, name=f"{motor.name} {brake}", brake=brake)
        for motor in catalog.motors[::6] for brake in (False, True)
    ]  # fmt: skip
    screws = [
        replace(screw, gear_inertia=20 * screw.gear_inertia, viscous=viscous, coulomb=coulomb)
        for screw, viscous, coulomb in zip(
            catalog.transmissions, (0.0, 2e-4), (0.02, 0.0), strict=False
        )
    ]
    two = replace(catalog, motors=tuple(some), transmissions=tuple(screws))
    motion = PRESET["arch"].build(APPENDIX_4.geometry).sample(200)
    resting = duty_cycle(APPENDIX_4, [Duty(motion, 1, 20.0)])
    found = catalog_ratios(resting, two)
    assert len(found) == len(two.motors) * (3 + 2)
    count = 0
    for item in found:
        actuator = int(item.actuator[1]) - 1
        name, _, last = item.motor.partition(", ")
        motor = next(motor for motor in two.motors if motor.name == name)
        screw = next((screw for screw in two.transmissions if screw.name == last), None)
        assert (screw is not None) == (actuator == 3)
        load = resting.loads[actuator]
        assert item.actuator == load.name

        def fits(
            ratio: float,
            motor: Drive = motor,
            screw: Drive | None = screw,
            load: ActuatorLoad = load,
        ) -> bool:
            drive = combined(motor, Drive(gear_ratio=ratio), screw)
            return bool(size_drives(load, drive_table([drive])).feasible)

        if item.low is None or item.high is None or item.scanned:
            continue
        count += 1
        assert fits(1.001 * item.low)
        assert fits(0.999 * item.high)
        assert not fits(0.99 * item.low)
        assert not fits(1.01 * item.high)
    assert count > 10


@pytest.mark.parametrize("size", [1e-9, 1e-6, 5e-5, 9e-5, 1.05e-4, 1e-2, 1.0, 30.0])
def test_weights_of_a_step_are_those_of_linear_heat(size: float) -> None:
    """1 - e^-s is what both ends weigh together, 1 - (1 - e^-s) / s what the later one does."""
    getcontext().prec = 50
    s = Decimal(size)
    fade, here, there = _weights(np.array([size]))
    later = 1 - (1 - (-s).exp()) / s
    assert fade[0] == pytest.approx(float((-s).exp()), rel=1e-14)
    digits = 1e-10 if size > 1e-4 else 1e-13
    assert there[0] == pytest.approx(float(later), rel=digits, abs=0.0)
    assert here[0] == pytest.approx(float(1 - (-s).exp() - later), rel=1e-6)
