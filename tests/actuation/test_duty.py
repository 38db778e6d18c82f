"""Duty cycles: torques and heat of the motors, repetitions, time scaling, drives that fit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import simpson

from paminsa_viz.actuation.drive_table import combined, drive_table, pair_table
from paminsa_viz.actuation.duty import (
    BLOCK_WIDTH,
    ActuatorLoad,
    Duty,
    DutyMotion,
    Signal,
    duty_cycle,
    load_signals,
)
from paminsa_viz.actuation.sizing import LIMITS, fitting_time, size_drives, thermal_share
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model import APPENDIX_4, Drive, inverse_dynamics, static_torques
from paminsa_viz.model.load import LoadCase
from paminsa_viz.model.singularity import singular_rotation
from paminsa_viz.trajectory import (
    PRESET,
    ImpossibleTrajectory,
    actuator_inertia,
    analyze,
    point_to_point,
)
from paminsa_viz.trajectory.check import SINGULAR_CLEARANCE
from paminsa_viz.trajectory.time_optimal import time_optimal
from tests.actuation.loads import random_load
from tests.actuation.motor_loads import GEAR, SERVO, motor_torque
from tests.trajectory.crossings import BALANCED, TEN, TURN


@pytest.fixture(scope="module")
def motion():  # type: ignore[no-untyped-def]
    return PRESET["paper-like"].build(APPENDIX_4.geometry).sample(500)


@pytest.mark.slow
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


def test_inertia_of_a_load_is_the_largest_along_the_motion(motion) -> None:  # type: ignore[no-untyped-def]
    along = actuator_inertia(APPENDIX_4, motion.pose)
    found = [load.inertia for load in duty_cycle(APPENDIX_4, [Duty(motion)]).loads]
    np.testing.assert_allclose(found, along.max(axis=0), rtol=1e-3)
    assert (along[0, :3] < 0.99 * along[:, :3].max(axis=0)).any()  # it is not that of the start


@pytest.mark.parametrize("size", [2, 50, 199, 401])
def test_inertia_is_looked_at_two_hundred_times_a_motion_at_least(size: int) -> None:
    motion = PRESET["arch"].build(APPENDIX_4.geometry).sample(size)
    along = actuator_inertia(APPENDIX_4, motion.pose[:: max(1, size // 200)])
    found = [load.inertia for load in duty_cycle(APPENDIX_4, [Duty(motion)]).loads]
    np.testing.assert_allclose(found, along.max(axis=0), rtol=1e-12)


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


def test_winding_has_at_most_a_mean_heat_and_a_slow_one_has_that() -> None:
    """Where it is not the limit that is used most its share is a bound, tight for a slow one."""
    load = random_load(np.random.default_rng(6), 400, bias=1.0)
    times = load.period * np.array([0.3, 1.0, 30.0, 1e7])
    drive = replace(SERVO, gear_ratio=20.0, rated_torque=3.0, peak_torque=9.0)
    table = drive_table([replace(drive, thermal_time_constant=time) for time in times])
    sizing = size_drives(load, table)
    share = sizing.shares[:, LIMITS.index("winding temperature")]
    mean = (sizing.rms / 3.0) ** 2
    assert (sizing.rms < 3.0).all()
    assert (share < sizing.use).all()
    assert (share >= thermal_share(load, table)).all()
    assert (np.diff(share) < 0).all()
    np.testing.assert_allclose(share[-1], mean[-1], rtol=1e-6)


@pytest.mark.parametrize("scale", [1.0, 1e-6])
@pytest.mark.parametrize("repeats", [1.0, 4.0])
def test_winding_temperature_of_constant_torques_in_turn_has_a_closed_form(
    repeats: float, scale: float
) -> None:
    """Three samples a motion, so that each of them counts: q_1 for 3 s, rest, q_2 for 2 s, rest.

    And all times a millionth of that.
    """
    rng = np.random.default_rng(2)
    time, t = 4.0, np.array([0.0, 0.5, 3.0])
    first, second = (np.tile(random_load(rng, 9).passages[0].signals[:, [3]], 3) for _ in range(2))
    drive = replace(SERVO, gear_ratio=20.0, thermal_time_constant=scale * time, brake=True)
    table = drive_table([drive])
    q_1, q_2 = (
        float((table.factors()[0] @ part[:, 0] / drive.rated_torque) ** 2)
        for part in (first, second)
    )
    passages = (
        DutyMotion(t, first, repeats, 1.0, 0.0),
        DutyMotion(t[:2] * 4, second, 1.0, 0.3, 0.0),
    )
    passages = (passages[0], passages[1]._replace(signals=second[:, :2]))
    one = [(q_1, 3.0), (0.0, 1.0)] * int(repeats) + [(q_2, 2.0), (0.0, 0.3)]
    temperature, peak = 0.0, 0.0
    for _ in range(60):  # cycles until it is periodic
        peak = 0.0
        for heat, span in one:
            fade = np.exp(-span / time)
            temperature = heat + (temperature - heat) * fade
            peak = max(peak, temperature)
    passages = tuple(p._replace(t=scale * p.t, dwell=scale * p.dwell) for p in passages)
    share = thermal_share(ActuatorLoad("M1", passages, 1.0), table)[0]
    assert share == pytest.approx(peak, rel=1e-9)


@pytest.mark.parametrize("time", [0.5, 4.0])
def test_a_winding_that_holds_a_load_is_hottest_at_the_end_of_the_dwell(time: float) -> None:
    """At rest without torque for 1 s, then q for 3 s: h = q (1 - e^(-3/t)) / (1 - e^(-4/t))."""
    still = np.zeros(3)
    passage = DutyMotion(
        np.array([0.0, 0.4, 1.0]), load_signals(still, still, still), 1.0, 3.0, 4.0
    )
    drive = replace(SERVO, gear_ratio=20.0, thermal_time_constant=time)
    share = thermal_share(ActuatorLoad("M1", (passage,), 1.0), drive_table([drive]))[0]
    heat = (4.0 / 20.0 / 0.3) ** 2
    expected = heat * np.expm1(-3.0 / time) / np.expm1(-4.0 / time)
    assert share == pytest.approx(expected, rel=1e-12)


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


@pytest.mark.slow
def test_the_time_scaling_that_fits_is_the_least(motion) -> None:  # type: ignore[no-untyped-def]
    """To a thousandth: speeds fall as the time grows, so that a top speed decides it."""
    cycle = duty_cycle(APPENDIX_4, [Duty(motion)])
    speed = GEAR.gear_ratio * cycle.loads[0].top_speed
    for least in (1.05, 1.859376, 3.0, 600.0, 999.0):
        drive = replace(SERVO, rated_torque=9.0, peak_torque=9.0, rated_speed=None)
        table = pair_table([replace(drive, top_speed=speed / least)], [GEAR])
        for start in (1.0, 1.02):
            factor = fitting_time(cycle.stretched(start), 0, table) * start
            assert least <= factor <= 1.001 * least
        if least == 600.0:  # ten halvings of 512 to 1000 are a thousandth of it, and no more
            halved = (fitting_time(cycle, 0, table) - 512.0) / 488.0 * 2**10
            assert halved == pytest.approx(round(halved), abs=1e-6)
        assert size_drives(cycle.stretched(factor).loads[0], table).feasible[0]
        assert not size_drives(cycle.stretched(0.999 * least).loads[0], table).feasible[0]
    slow = pair_table([replace(drive, top_speed=speed / 1001.0)], [GEAR])
    assert fitting_time(cycle, 0, slow) == np.inf
    assert fitting_time(cycle, 0, pair_table([replace(drive, top_speed=speed)], [GEAR])) == 1.0
    hopeless = pair_table([replace(SERVO, rated_torque=1e-6)], [GEAR])
    assert fitting_time(cycle, 0, hopeless) == np.inf


def test_a_brake_that_holds_in_dwells_makes_a_range_of_time_scalings_fit() -> None:
    """Slower motions fill more of the cycle: the RMS torque grows while the peak torque falls."""
    motion = PRESET["paper-like"].build(APPENDIX_4.geometry).lasting(0.35).sample(500.0)
    cycle = duty_cycle(APPENDIX_4, [Duty(motion, dwell=0.9)])

    def torques(slower: float) -> tuple[float, float]:
        t, pose = slower * motion.t, motion.pose
        rates = motion.velocity / slower, motion.acceleration / slower**2
        force = inverse_dynamics(APPENDIX_4, pose, *rates).torque[:, 3]
        mean = np.trapezoid(force**2, t) / (t[-1] + 0.9)
        return float(np.abs(force).max()), float(np.sqrt(mean))

    ratio = 2 * np.pi / 0.005
    peak, rated = torques(1.15)[0] / ratio, torques(1.5)[1] / ratio
    brake = Drive(
        rated_torque=rated, peak_torque=peak, transmission="screw", lead=0.005, brake=True
    )
    found = fitting_time(cycle, 3, drive_table([brake]))
    assert found == pytest.approx(1.15, rel=2e-3)
    for slower, fits in ((1.16, True), (1.49, True), (1.14, False), (1.51, False), (2.0, False)):
        load = cycle.stretched(slower).loads[3]
        assert size_drives(load, drive_table([brake])).feasible[0] == fits, slower


def test_a_stretched_cycle_is_that_of_the_slower_motion() -> None:
    design = APPENDIX_4.vary({"friction.viscous_rotary": 0.1, "friction.coulomb_linear": 2.0})
    design = replace(design, load=LoadCase(force_x=20.0, force_z=-50.0))
    plan = PRESET["quintic"].build(design.geometry)
    motion = plan.lasting(3.0).sample(200)
    slow = duty_cycle(design, [Duty(motion)]).loads
    np.testing.assert_allclose(
        np.transpose([load.torque for load in slow]), analyze(design, motion).torque, atol=1e-9
    )
    fast = duty_cycle(design, [Duty(plan.lasting(1.2).sample(500))], slower=2.5).loads
    for one, two in zip(slow, fast, strict=True):
        scale = np.abs(one.signals).max(axis=1, keepdims=True) + 1e-9
        ends = slice(2, -2)  # where the speed is zero but for rounding its sign is anything
        assert np.abs(one.signals - two.signals)[:, ends].max() < 1e-8 * scale.max()
        np.testing.assert_allclose(one.means, two.means, rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize(
    ("duties", "argument"),
    [
        ([], "duties"),
        ([{"repeats": 0.5}], "repeats"),
        ([{}, {"repeats": np.inf}], "repeats"),
        ([{"dwell": -1.0}], "dwell"),
        ([{"dwell": np.inf}], "dwell"),
    ],
    ids=["none", "repeats", "endless", "dwell", "forever"],
)
def test_impossible_cycles_are_refused(motion, duties, argument: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(InvalidInput) as caught:
        duty_cycle(APPENDIX_4, [Duty(motion, **values) for values in duties])
    assert caught.value.argument == argument


@pytest.mark.parametrize("slower", [0.0, -1.0, np.nan, np.inf])
def test_a_pace_that_is_none_is_refused(motion, slower: float) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(InvalidInput) as caught:
        duty_cycle(APPENDIX_4, [Duty(motion)], slower=slower)
    assert caught.value.argument == "slower"


def test_what_the_robot_cannot_run_is_no_duty() -> None:
    far = point_to_point([0.0, 0.0, 0.0, -0.5], [0.0, 0.0, 0.0, -5.0]).sample(20)
    with pytest.raises(ImpossibleTrajectory, match="too far"):
        duty_cycle(APPENDIX_4, [Duty(far)])


def test_the_load_on_the_platform_is_driven_and_held() -> None:
    pushed = replace(APPENDIX_4, load=LoadCase(force_x=30.0, force_z=-100.0))
    motion = PRESET["arch"].build(APPENDIX_4.geometry).sample(300)
    bare, loaded = (duty_cycle(one, [Duty(motion, 1, 1.0)]).loads for one in (APPENDIX_4, pushed))
    k = APPENDIX_4.geometry.magnification
    assert loaded[3].held == pytest.approx(bare[3].held + k * 100.0)
    for j, load in enumerate(loaded):
        np.testing.assert_allclose(load.torque, analyze(pushed, motion).torque[:, j], rtol=1e-12)
    assert abs(loaded[0].held - bare[0].held) > 1.0
    held = static_torques(pushed, motion.pose[-1])
    assert [load.held for load in loaded] == pytest.approx(np.abs(held), rel=1e-13)


def test_inertia_of_a_cycle_is_that_of_the_motion_with_most() -> None:
    """M1 to M3 turn more of the robot in one motion, M4 moves as much in both."""
    motions = [PRESET[key].build(APPENDIX_4.geometry).sample(100) for key in ("arch", "circle")]
    apart = [[one.inertia for one in duty_cycle(APPENDIX_4, [Duty(m)]).loads] for m in motions]
    both = [one.inertia for one in duty_cycle(APPENDIX_4, [Duty(m) for m in motions]).loads]
    assert both == np.max(apart, axis=0).tolist()
    assert both[0] > 1.001 * np.min(apart, axis=0)[0]


def test_signals_are_a_torque_by_the_direction_of_its_power() -> None:
    """Driving, braking or at rest, however small; their sum is the torque."""
    sizes = np.array([-2.0, -1e-3, -1e-200, 0.0, 1e-200, 1e-3, 2.0])
    torque, speed = (part.ravel() for part in np.meshgrid(sizes, sizes))
    growth = np.arange(float(len(torque)))
    found = load_signals(torque, growth, speed)
    same, opposite = (np.sign(torque) == sign * np.sign(speed) for sign in (1, -1))
    for signal, where in (
        (Signal.DRIVING, same & (speed != 0)),
        (Signal.BRAKING, opposite & (speed != 0) & (torque != 0)),
        (Signal.REST, speed == 0),
    ):
        big = np.abs(torque * speed) > 0  # else the power is zero in floating point
        np.testing.assert_array_equal(found[signal][big], np.where(where, torque, 0.0)[big])
    np.testing.assert_array_equal(found[:3].sum(axis=0), torque)
    assert (np.count_nonzero(found[:3], axis=0) <= 1).all()
    others = (found[Signal.ACCELERATION], found[Signal.SPEED], found[Signal.SIGN])
    np.testing.assert_array_equal(others, (growth, speed, np.sign(speed)))
    assert len(Signal) == len(found)


@pytest.mark.parametrize("size", [2, BLOCK_WIDTH, BLOCK_WIDTH + 1, 3 * BLOCK_WIDTH - 1])
def test_blocks_bound_their_samples_tightly(size: int) -> None:
    load = random_load(np.random.default_rng(size), size, bias=1.0)
    blocks, speed = load.blocks, np.abs(load.signals[Signal.SPEED])
    assert len(blocks.speed) == np.ceil(size / BLOCK_WIDTH)
    np.testing.assert_array_equal(blocks.signals.reshape(6, -1)[:, :size], load.signals)
    for place in range(len(blocks.speed)):
        part = slice(place * BLOCK_WIDTH, (place + 1) * BLOCK_WIDTH)
        inside = load.signals[:, part]
        middle, half = blocks.middle[:, place], blocks.half_range[:, place]
        np.testing.assert_allclose(middle + half, inside.max(axis=1), atol=1e-12)
        np.testing.assert_allclose(middle - half, inside.min(axis=1), atol=1e-12)
        assert blocks.speed_least[place] == speed[part].min()
        assert blocks.speed_top[place] == speed[part].max()
        center = min(part.start + BLOCK_WIDTH // 2, size - 1)
        np.testing.assert_array_equal(blocks.sample[:, place], load.signals[:, center])
        assert blocks.speed_sample[place] == speed[center]


@pytest.mark.parametrize("scale", [0.01, 1.0, -1.0])
def test_figures_of_a_load_are_those_of_its_samples(scale: float) -> None:
    """Also of torques below 1, and where the largest are negative: turned around, it is the same.

    The trapezoidal rule is another integral than the load's own.
    """
    (passage,) = random_load(np.random.default_rng(8), 4001, bias=1.0).passages
    given = scale * passage.signals[:3].sum(axis=0)
    w = np.sign(scale) * passage.signals[Signal.SPEED]
    signals = load_signals(given, np.sign(scale) * passage.signals[Signal.ACCELERATION], w)
    held = 2.0 * float(given[0])
    load = ActuatorLoad("M1", (DutyMotion(passage.t, signals, 3.0, 0.5, held),), 1.0)
    total = passage.t[-1] + 0.5
    np.testing.assert_allclose(load.torque, given, rtol=1e-15)
    assert load.peak == max(np.abs(given).max(), abs(held))
    assert load.top_speed == np.abs(w).max()
    assert load.top_power == pytest.approx(np.abs(given * w).max(), rel=1e-15)
    square = np.trapezoid(given**2, passage.t) + 0.5 * held**2
    assert load.rms == pytest.approx(np.sqrt(square / total), rel=1e-5)
    assert load.mean_speed == pytest.approx(np.trapezoid(np.abs(w), passage.t) / total, rel=1e-5)
    assert (
        replace(load, passages=(load.passages[0]._replace(dwell=0.0),)).peak == np.abs(given).max()
    )


def test_what_is_held_is_the_largest_in_size_of_the_dwells() -> None:
    """Of passages that dwell; also where it pulls and where it is more than all that moves."""
    t, still = np.array([0.0, 1.0]), np.zeros(2)
    signals = load_signals(np.ones(2), still, still)
    dwells = ((0.0, 8.0), (2.0, -5.0), (1.0, 3.0))  # [s], and what is held [N m]
    passages = [DutyMotion(t, signals, 1.0, dwell, held) for dwell, held in dwells]
    load = ActuatorLoad("M1", tuple(passages), 1.0)
    assert (load.held, load.peak) == (5.0, 5.0)
    assert load.held_square == pytest.approx((2.0 * 25.0 + 1.0 * 9.0) / (3.0 + 3.0))
    moved = replace(load, passages=tuple(passages[:1]))
    assert (moved.held, moved.peak, moved.held_square) == (0.0, 1.0, 0.0)


def test_a_motion_may_start_at_any_time() -> None:
    """Its time in a cycle, its dwell and its mean square do not depend on what its clock shows."""
    motion = PRESET["arch"].build(APPENDIX_4.geometry).sample(300)
    later = replace(motion, t=motion.t + 7.0)
    first, second = (
        duty_cycle(APPENDIX_4, [Duty(each, 2.0, 0.5)]).loads[0] for each in (motion, later)
    )
    assert second.period == pytest.approx(first.period, rel=1e-12)
    assert first.period == pytest.approx(2.0 * (motion.t[-1] - motion.t[0] + 0.5), rel=1e-12)
    for a, b in zip(first.passages, second.passages, strict=True):
        assert b.t[0] == 0.0
        np.testing.assert_allclose(b.t, a.t, atol=1e-12)


@pytest.mark.slow
def test_inertia_at_the_actuators_is_that_away_from_a_planned_crossing() -> None:
    """On the singularity it has no bound: more samples would make it larger without end."""
    motion = time_optimal(BALANCED, TURN, TEN).plan.sample(5000.0)
    g, theta = BALANCED.geometry, motion.pose[:, 2]
    far = g.platform_radius * np.abs(singular_rotation(g) - theta) >= SINGULAR_CLEARANCE
    inertia = [load.inertia for load in duty_cycle(BALANCED, [Duty(motion)]).loads]
    expected = actuator_inertia(BALANCED, motion.pose[far]).max(axis=0)
    np.testing.assert_allclose(inertia, expected, rtol=0.15)  # of some of the samples
    assert actuator_inertia(BALANCED, motion.pose).max() > 100 * expected[:3].max()
    with pytest.raises(ImpossibleTrajectory, match="no bound"):
        duty_cycle(APPENDIX_4, [Duty(motion)])  # another robot
