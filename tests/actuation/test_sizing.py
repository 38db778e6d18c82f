"""Sizing of drives: against brute force, independent integrals, and the robot's own dynamics."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import simpson

from paminsa_viz.actuation.drive_table import combined, drive_table, pair_table
from paminsa_viz.actuation.duty import ActuatorLoad, Duty, DutyMotion, duty_cycle
from paminsa_viz.actuation.ratios import figure_of_merit, ratio_intervals
from paminsa_viz.actuation.sizing import LIMITS, envelope_share, fitting_time, size_drives
from paminsa_viz.actuation.thermal import thermal_share
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model import APPENDIX_4, Drive
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.load import LoadCase
from paminsa_viz.trajectory import PRESET, analyze
from tests.actuation.loads import random_drives, random_load

RATIOS = np.geomspace(0.5, 3000.0, 140)
SERVO = Drive(
    "servo", 4e-6, rated_torque=0.3, peak_torque=0.9, rated_speed=300.0, top_speed=600.0, mass=0.5
)
GEAR = Drive("gear", gear_inertia=1e-6, gear_ratio=80.0, efficiency=0.8, mass=0.4)


def motor_torque(load: ActuatorLoad, drive: Drive, ratios: Array) -> Array:
    """The definition, sample by sample: (ratios, samples) [N m]."""
    torque, speed, growth = load.torque, load.signals[4], load.signals[3]
    power, eta = torque * speed, drive.total_efficiency
    driven = np.where(power > 0, torque / eta, np.where(power < 0, torque * eta, torque))
    n = ratios[:, None]
    own = n * (drive.inertia * growth + drive.viscous * speed)
    return driven / n + own + drive.coulomb * np.sign(speed)


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
        np.testing.assert_array_equal(alpha >= asked, ratio_intervals(load, plain).feasible)


@pytest.fixture(scope="module")
def motion():  # type: ignore[no-untyped-def]
    return PRESET["paper-like"].build(APPENDIX_4.geometry).sample(2000)


def test_motor_torques_are_those_of_the_robot_with_its_drives(motion) -> None:  # type: ignore[no-untyped-def]
    drive = replace(combined(SERVO, GEAR), efficiency=1.0, viscous=1e-5)
    axis = replace(drive, gear_ratio=2.0, transmission="screw", lead=0.01)
    design = replace(APPENDIX_4.vary({"payload.mass": 3.0}), drives=(drive,) * 3 + (axis,))
    torque = analyze(design, motion).torque
    loads = duty_cycle(design, [Duty(motion)]).loads
    for j, own in enumerate(design.drives):
        tau = motor_torque(loads[j], own, np.array([own.ratio]))[0]
        assert np.abs(tau * own.ratio - torque[:, j]).max() < 1e-9 * np.abs(torque[:, j]).max()
        rms = size_drives(loads[j], drive_table([own])).rms[0]
        square = simpson((torque[:, j] / own.ratio) ** 2, x=motion.t) / motion.duration
        assert rms == pytest.approx(np.sqrt(square), rel=1e-8)


@pytest.mark.parametrize("time", [0.05, 1.0, 300.0])
@pytest.mark.parametrize("even", [True, False], ids=["even", "uneven"])
def test_winding_temperature_is_that_of_its_differential_equation(time: float, even: bool) -> None:
    rng = np.random.default_rng(6)
    passages = []
    for count, dwell in ((1.0, 0.7), (3.0, 0.0), (2.0, 0.4)):
        (passage,) = random_load(rng, 400, bias=1.0).passages
        t = passage.t if even else passage.t[-1] * np.linspace(0, 1, 400) ** 1.2
        # the middle one heats up from each time to the next, the last one cools down
        scale = np.array([[{1.0: 1.0, 3.0: 3.0, 2.0: 0.2}[count]]] * 3 + [[1.0]] * 3)
        passages.append(DutyMotion(t, scale * passage.signals, count, dwell, passage.held))
    load = ActuatorLoad("M1", tuple(passages), 1.0)
    drive = replace(SERVO, gear_ratio=20.0, efficiency=0.8, thermal_time_constant=time)
    table = drive_table([drive, replace(drive, brake=True)])
    for i in range(2):
        times, heats = [0.0], [0.0]
        for p in passages:
            one = replace(load, passages=(p,))
            tau = motor_torque(one, table.drive(i), np.array([20.0]))[0] / drive.rated_torque
            held = 0.0 if i else (p.held / 20 / drive.rated_torque) ** 2
            for _ in range(int(p.repeats)):
                times += list(times[-1] + p.t + 1e-12)
                heats += list(tau**2)
                if p.dwell:
                    times += [times[-1] + 1e-9, times[-1] + p.dwell]
                    heats += [held, held]
        heats[0] = heats[1]
        step = 0.001
        heat = np.interp(np.arange(0.0, times[-1], step), times, heats)
        h, path = 0.0, []
        for _ in range(2 if time < 2 else 1):  # the second cycle is the periodic one
            x = step / time / 2
            path = [h := (h * (1 - x) + q * 2 * x) / (1 + x) for q in heat]
        if time > 2:  # the start that ends where it begins, by the equation's linearity
            fade = np.exp(-np.arange(1, len(heat) + 1) * step / time)
            path = np.array(path) + fade * path[-1] / (1 - fade[-1])
        share = thermal_share(load, table)[i]
        assert share == pytest.approx(np.max(path), rel=5e-3)


def test_repetitions_and_dwells_weigh_the_means(motion) -> None:  # type: ignore[no-untyped-def]
    other = PRESET["circle"].build(APPENDIX_4.geometry).sample(500)
    apart = duty_cycle(APPENDIX_4, [Duty(motion)] * 3 + [Duty(other, 1, 2.0)]).loads
    together = duty_cycle(APPENDIX_4, [Duty(motion, 3), Duty(other, 1, 2.0)]).loads
    table = pair_table([SERVO], [GEAR, replace(GEAR, gear_ratio=20.0)])
    for one, two in zip(apart, together, strict=True):
        assert (
            one.period
            == pytest.approx(two.period)
            == pytest.approx(3 * motion.duration + other.duration + 2.0)
        )
        np.testing.assert_allclose(one.means, two.means, rtol=1e-12, atol=1e-14)
        np.testing.assert_allclose(size_drives(one, table).use, size_drives(two, table).use)


def test_pairs_in_columns_are_the_drives_they_stand_for() -> None:
    gears = [GEAR, replace(GEAR, gear_ratio=10.0, viscous=1e-6, coulomb=1e-3, cost=5.0)]
    screws = [
        Drive("screw", gear_inertia=3e-5, viscous=1e-4, transmission="screw", lead=0.01, mass=2.0),
        Drive("belt", transmission="belt", lead=0.08, lead_efficiency=0.9),
    ]
    motors = [SERVO, replace(SERVO, envelope=((0.0, 0.9), (300.0, 0.9), (600.0, 0.2)), cost=9.0)]
    for parts in ((motors, gears), (motors, gears, screws)):
        table = pair_table(*parts)
        whole = drive_table([table.drive(i) for i in range(len(table))])
        for name in whole.__dataclass_fields__:
            if name not in ("parts", "catalog"):
                np.testing.assert_allclose(getattr(table, name), getattr(whole, name), rtol=1e-14)
    assert pair_table(motors, gears).drive(1).name == "servo, gear"


def test_feasible_drives_are_ordered_and_the_nearest_limit_is_named(motion) -> None:  # type: ignore[no-untyped-def]
    cycle = duty_cycle(APPENDIX_4, [Duty(motion)])
    gears = [replace(GEAR, gear_ratio=n, mass=m) for n, m in ((50.0, 0.6), (80.0, 0.5), (3.0, 0.1))]
    motors = [SERVO, replace(SERVO, mass=0.7, rated_torque=1.0, peak_torque=3.0)]
    sizing = size_drives(cycle.loads[0], pair_table(motors, gears))
    light = sizing.ordered("mass")
    assert set(light) == set(np.flatnonzero(sizing.feasible))
    assert (np.diff(sizing.table.mass[light]) >= 0).all()
    margin = sizing.use[sizing.ordered("margin")]
    assert (np.diff(margin) >= 0).all()
    weak = size_drives(cycle.loads[0], pair_table(motors[:1], [replace(GEAR, gear_ratio=1.0)]))
    assert not weak.feasible.any()
    assert weak.limit(weak.nearest) in LIMITS[:2]
    with pytest.raises(InvalidInput, match="order"):
        sizing.ordered("color")  # type: ignore[arg-type]


def test_the_time_scaling_that_fits_is_the_least(motion) -> None:  # type: ignore[no-untyped-def]
    cycle = duty_cycle(APPENDIX_4, [Duty(motion)])
    table = pair_table([replace(SERVO, top_speed=120.0, rated_speed=None)], [GEAR])
    factor = fitting_time(cycle, 0, table)
    assert factor > 1
    assert size_drives(cycle.stretched(factor).loads[0], table).feasible[0]
    assert not size_drives(cycle.stretched(0.99 * factor).loads[0], table).feasible[0]
    hopeless = pair_table([replace(SERVO, rated_torque=1e-6)], [GEAR])
    assert fitting_time(cycle, 0, hopeless) == np.inf


def test_a_stretched_cycle_is_that_of_the_slower_motion() -> None:
    design = APPENDIX_4.vary({"friction.viscous_rotary": 0.1, "friction.coulomb_linear": 2.0})
    design = replace(design, load=LoadCase(force_x=20.0, force_z=-50.0))
    plan = PRESET["quintic"].build(design.geometry)
    slow = duty_cycle(design, [Duty(plan.lasting(3.0).sample(200))]).loads
    fast = duty_cycle(design, [Duty(plan.lasting(1.5).sample(400))], slower=2.0).loads
    for one, two in zip(slow, fast, strict=True):
        scale = np.abs(one.signals).max(axis=1, keepdims=True) + 1e-9
        ends = slice(2, -2)  # where the speed is zero but for rounding its sign is anything
        assert np.abs(one.signals - two.signals)[:, ends].max() < 1e-8 * scale.max()
        np.testing.assert_allclose(one.means, two.means, rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize(
    ("duties", "argument"),
    [([], "duties"), ([{"repeats": 0.5}], "repeats"), ([{"dwell": -1.0}], "dwell")],
    ids=["none", "repeats", "dwell"],
)
def test_impossible_cycles_are_refused(motion, duties, argument: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(InvalidInput) as caught:
        duty_cycle(APPENDIX_4, [Duty(motion, **values) for values in duties])
    assert caught.value.argument == argument


def test_the_load_on_the_platform_is_driven_and_held() -> None:
    pushed = replace(APPENDIX_4, load=LoadCase(force_x=30.0, force_z=-100.0))
    motion = PRESET["arch"].build(APPENDIX_4.geometry).sample(300)
    bare, loaded = (duty_cycle(one, [Duty(motion, 1, 1.0)]).loads for one in (APPENDIX_4, pushed))
    k = APPENDIX_4.geometry.magnification
    assert loaded[3].held == pytest.approx(bare[3].held + k * 100.0)
    for j, load in enumerate(loaded):
        np.testing.assert_allclose(load.torque, analyze(pushed, motion).torque[:, j], rtol=1e-12)
    assert abs(loaded[0].held - bare[0].held) > 1.0


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
