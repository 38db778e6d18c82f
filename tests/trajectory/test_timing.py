"""Shortest durations: at a limit, and not beyond, at every instant; drives' envelopes too."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.actuation.drive_table import drive_table
from paminsa_viz.actuation.duty import Duty, duty_cycle
from paminsa_viz.actuation.sizing import size_drives
from paminsa_viz.model import APPENDIX_4, Design, Drive, InvalidInput, KneeBranch, inverse_dynamics
from paminsa_viz.trajectory import (
    PRESET,
    ImpossibleTrajectory,
    InfeasibleMotion,
    MotionLimits,
    Plan,
    Profile,
    ShortestStretch,
    TimeLaw,
    check_path,
    point_to_point,
    shortest_motion,
    shortest_stretch,
)
from paminsa_viz.trajectory.durations import _longest, drive_lines, limit_of, needed_durations
from paminsa_viz.trajectory.limits import LIMITED, UNITS
from tests.support.cases import Case, cases
from tests.support.samples import with_knee
from tests.trajectory.plans import FRICTION, LAWS, PLANS, A, B, C, all_plans, dense, place

VISCOUS = {name: value for name, value in FRICTION.items() if "viscous" in name}
DESIGNS = {
    "frictionless": APPENDIX_4,
    "viscous": APPENDIX_4.vary(VISCOUS),
}
ROUNDING = 1e-9


def used(plan: Plan, t, limits: MotionLimits, design=APPENDIX_4):
    """Share of each limit that is used at times (n,), (n, 10) in the order of LIMITED."""
    state, jerk = plan.at(t), plan.jerk(t)
    rates = [f(x) for x in (state.velocity, state.acceleration, jerk) for f in (place, turn)]
    torque = np.abs(inverse_dynamics(design, *state).torque)
    shares = [rate / limit for rate, limit in zip(rates, limits.rates.ravel(), strict=True)]
    return np.column_stack([*shares, torque / limits.actuators])


def turn(rows):
    return np.abs(rows[:, 2])


def assert_at_its_limit(found: ShortestStretch, limits: MotionLimits, *robot) -> None:
    plan = found.plan
    all_over = used(plan, dense(plan), limits, *robot)
    assert all_over.max() <= 1 + ROUNDING
    column = LIMITED.index(found.quantity)
    around = np.clip(found.t + plan.duration * np.array([-2e-12, 0, 2e-12]), 0, plan.duration)
    assert used(plan, around, limits, *robot)[:, column].max() == pytest.approx(1, abs=ROUNDING)


KINEMATIC = [
    MotionLimits(speed=0.3),
    MotionLimits(turn_speed=1.0),
    MotionLimits(acceleration=1.0, turn_acceleration=6.0),
    MotionLimits(speed=0.2, turn_speed=1.0, acceleration=1.5, turn_acceleration=4.0),
]


@PLANS
@pytest.mark.parametrize("limits", KINEMATIC, ids=range(4))
def test_limits_of_the_platform(plan: Plan, limits: MotionLimits) -> None:
    if not used(plan, dense(plan), limits).max() > 0:
        with pytest.raises(InvalidInput, match="nothing that moves"):
            shortest_stretch(plan, limits)
        return
    assert_at_its_limit(shortest_stretch(plan, limits), limits)


@PLANS
def test_limits_of_jerk(plan: Plan) -> None:
    limits = MotionLimits(speed=1.0, acceleration=3.0, jerk=20.0, turn_jerk=90.0)
    if plan.curve.bounded_jerk:
        assert_at_its_limit(shortest_stretch(plan, limits), limits)
    else:
        with pytest.raises(InvalidInput, match="jumps"):
            shortest_stretch(plan, limits)


@PLANS
@pytest.mark.parametrize(
    ("robot", "knee"),
    [("frictionless", KneeBranch.LOWER), ("viscous", KneeBranch.UPPER)],
)
def test_limits_of_torque(plan: Plan, robot: str, knee: KneeBranch) -> None:
    design = DESIGNS[robot]
    still = inverse_dynamics(
        with_knee(design, knee), plan.curve(np.linspace(0, 1, 200)), [0] * 4, [0] * 4
    )
    top = np.abs(still.torque).max(axis=0)
    limits = MotionLimits(torque=1.5 * top[:3].max(), force=1.1 * top[3])
    found = shortest_stretch(plan, limits, with_knee(design, knee))
    assert found.quantity.split()[0] in ("torque", "force")
    assert_at_its_limit(found, limits, with_knee(design, knee))
    for factor in (1.001, 1.3, 4.0, 50.0):  # every longer duration keeps them too
        slower = found.plan.lasting(factor * found.plan.duration)
        assert (
            used(slower, dense(slower, 500), limits, with_knee(design, knee)).max() <= 1 + ROUNDING
        )


@pytest.mark.parametrize("plan", [all_plans()[0], all_plans()[3]], ids=["move", "arch"])
def test_coulomb_friction_is_never_underestimated(plan: Plan) -> None:
    design = APPENDIX_4.vary(FRICTION)
    limits = MotionLimits(torque=8.0, force=400.0)
    found = shortest_stretch(plan, limits, design)
    top = used(found.plan, dense(found.plan), limits, design).max()
    assert 0.995 < top <= 1 + ROUNDING


@pytest.mark.parametrize("law", LAWS, ids=["quintic", "trapezoid", "s-curve"])
def test_friction_that_brakes_is_counted_as_far_as_there_is_any(law: TimeLaw) -> None:
    """M4 lowers the platform and stops it by 300 N, 20 N of friction less, but none at the end."""
    plan = point_to_point([0.0, 0.0, 0.2, -0.45], [0.0, 0.0, 0.2, -0.6], law=law)
    limits = MotionLimits(force=300.0)
    bare, full = (
        shortest_stretch(plan, limits, APPENDIX_4.vary({"friction.coulomb_linear": size}))
        for size in (0.0, 20.0)
    )
    # the same instant may decide all three: they differ by rounding then
    shortest, longest = full.plan.duration * (1 - 1e-12), bare.plan.duration * (1 + 1e-12)
    for transition in (1e-3, 0.05, 0.3):
        rough = APPENDIX_4.vary(
            {"friction.coulomb_linear": 20.0, "friction.transition_speed": transition}
        )
        found = shortest_stretch(plan, limits, rough).plan
        most = used(found, dense(found), limits, rough).max()
        assert most == pytest.approx(1.0, abs=1e-4), transition
        assert shortest <= found.duration <= longest, transition


@pytest.mark.slow
@given(cases(), st.sampled_from(LAWS), st.floats(1.05, 5.0))
def test_random_robots(case: Case, law: TimeLaw, spare: float) -> None:
    """Near a pose that can be taken, a small move with some torque to spare."""
    design = case.design
    start = np.array(case.poses(1, natural=True)[0])
    size = design.geometry.base_radius
    plan = point_to_point(
        start, start + np.array([0.01, -0.02, 0.03, 0.015]) * [size, size, 1, size], 1, law
    )
    still = inverse_dynamics(design, plan.curve(np.linspace(0, 1, 50)), [0] * 4, [0] * 4)
    top = spare * np.abs(still.torque).max(axis=0)
    limits = MotionLimits(torque=top[:3].max(), force=top[3])
    found = shortest_stretch(plan, limits, design, clearance=0.0)
    assert_at_its_limit(found, limits, design)


@pytest.mark.parametrize("profile", [Profile.TRAPEZOID, Profile.S_CURVE])
def test_a_straight_move_uses_all_its_limits(profile: Profile) -> None:
    limits = MotionLimits(speed=0.1, acceleration=0.5, jerk=4.0)
    if profile is Profile.TRAPEZOID:
        limits = MotionLimits(speed=0.1, acceleration=0.5)
    plan = point_to_point(A, B, law=TimeLaw(profile))
    found = shortest_stretch(plan, limits)
    top = used(found.plan, dense(found.plan), limits).max(axis=0)
    reached = [0, 2] if profile is Profile.TRAPEZOID else [0, 2, 4]
    np.testing.assert_allclose(top[reached], 1.0, rtol=1e-9)
    kept = shortest_stretch(plan, limits, reshape=False)
    assert kept.plan.curve is plan.curve
    assert kept.plan.duration > found.plan.duration


def test_actuator_too_weak_for_gravity_is_reported() -> None:
    with pytest.raises(InfeasibleMotion) as caught:
        shortest_stretch(point_to_point(A, B), MotionLimits(force=200.0), APPENDIX_4)
    error = caught.value
    assert error.actuator == 3
    assert error.limit == 200.0
    held = inverse_dynamics(APPENDIX_4, error.pose, [0] * 4, [0] * 4).torque[3]
    assert error.needed == pytest.approx(held, rel=1e-12)
    for ends in ((A, B), (B, A), (C, A)):
        with pytest.raises(InfeasibleMotion) as caught:
            shortest_stretch(point_to_point(*ends), MotionLimits(torque=0.2), APPENDIX_4)
        torque = inverse_dynamics(APPENDIX_4, caught.value.pose, [0] * 4, [0] * 4).torque[:3]
        assert caught.value.actuator == np.abs(torque).argmax()
        assert caught.value.needed == pytest.approx(torque[caught.value.actuator], rel=1e-12)
    assert "gravity" in str(error)
    assert "force of M4" in str(error)
    with pytest.raises(InfeasibleMotion) as caught:
        shortest_stretch(point_to_point(A, B), MotionLimits(torque=0.5), APPENDIX_4)
    assert caught.value.actuator in (0, 1, 2)
    assert f"torque of M{caught.value.actuator + 1} is limited" in str(caught.value)
    # held at rest, but not against Coulomb friction as well
    sticky = APPENDIX_4.vary({"friction.coulomb_linear": 50.0})
    shortest_stretch(point_to_point(A, B), MotionLimits(force=260.0), APPENDIX_4)
    with pytest.raises(InfeasibleMotion, match="gravity and Coulomb friction take") as caught:
        shortest_stretch(point_to_point(A, B), MotionLimits(force=260.0), sticky)
    assert caught.value.friction


def test_friction_is_named_only_where_it_adds_to_gravity() -> None:
    sticky = APPENDIX_4.vary({"friction.coulomb_linear": 50.0})
    low, high = (0.0, 0.0, 0.0, -0.75), (0.0, 0.0, 0.0, -0.5)
    for start, end, force, adds in ((low, high, 260.0, True), (high, low, 200.0, False)):
        with pytest.raises(InfeasibleMotion) as caught:
            shortest_stretch(point_to_point(start, end), MotionLimits(force=force), sticky)
        error = caught.value
        held = inverse_dynamics(APPENDIX_4, error.pose, [0] * 4, [0] * 4).torque[3]
        assert error.friction == adds
        assert ("Coulomb" in str(error)) == adds
        assert error.needed == pytest.approx(held + 50.0 * adds, rel=1e-12)


def test_what_gravity_takes_is_in_the_unit_of_the_actuator() -> None:
    for actuator in range(4):
        told = str(InfeasibleMotion(actuator, 0.25, (0.0, 0.0, 0.0, -0.5), -3.00004, 2.0))
        unit, word = ("N", "force") if actuator == 3 else ("N·m", "torque")
        assert "at 25 % of the motion" in told
        assert f"takes 3.001 {unit}, and" in told  # not 3, which would not do
        assert f"the {word} of M{actuator + 1} is limited to 2 {unit}" in told


def test_impossible_limits_are_rejected() -> None:
    with pytest.raises(InvalidInput, match="design"):
        shortest_stretch(point_to_point(A, B), MotionLimits(torque=5.0))
    with pytest.raises(InvalidInput, match="nothing that moves"):
        shortest_stretch(point_to_point(A, B), MotionLimits())
    with pytest.raises(InvalidInput, match="nothing that moves"):
        shortest_stretch(point_to_point(A, [*A[:2], 1.0, A[3]]), MotionLimits(speed=1.0))
    plan = point_to_point(A, [0.4, 0, 0, -0.5], 7.0)
    with pytest.raises(ImpossibleTrajectory) as caught:
        shortest_stretch(plan, MotionLimits(speed=1.0), APPENDIX_4)
    event = check_path(APPENDIX_4.geometry, plan.sample()).first
    assert event is not None
    assert caught.value.event.t == pytest.approx(event.t / 7.0)  # as the motion has no duration yet
    for value in (0.0, -1.0, np.nan, np.inf):
        with pytest.raises(InvalidInput, match="speed"):
            MotionLimits(speed=value)


def test_the_explanation_names_limit_and_instant() -> None:
    found = shortest_stretch(point_to_point(A, B), MotionLimits(speed=0.2))
    assert found.t == pytest.approx(found.plan.duration / 2)
    assert (
        found.explanation
        == f"{found.plan.duration:.4g} s: speed reaches 0.2 m/s at {found.t:.4g} s"
    )


SERVO = Drive(
    "servo", 4e-6, 1e-6, 80.0, 0.8, viscous=2e-6, coulomb=2e-3, peak_torque=0.2, top_speed=400.0,
    envelope=((0.0, 0.2), (150.0, 0.2), (500.0, 0.01)),
)  # fmt: skip
AXIS = replace(SERVO, gear_ratio=1.0, transmission="screw", lead=0.01, peak_torque=0.9)
AXIS = replace(AXIS, envelope=((0.0, 0.9), (300.0, 0.9), (600.0, 0.5)), top_speed=600.0)
HEAVY = replace(SERVO, rotor_inertia=2e-5, gear_ratio=50.0, peak_torque=0.3, envelope=())
BENT = replace(SERVO, envelope=((0.0, 0.3), (100.0, 0.15), (350.0, 0.13), (400.0, 0.02)))


def driven(*drives: Drive) -> Design:
    one = drives[0]
    return replace(APPENDIX_4, drives=(one, one, one, drives[1] if len(drives) > 1 else AXIS))


def shares(design: Design, motion) -> np.ndarray:  # type: ignore[no-untyped-def]
    """Largest share of the envelope or the top speed of each drive on a motion."""
    loads = duty_cycle(design, [Duty(motion)]).loads
    return np.array(
        [
            size_drives(load, drive_table([drive])).shares[0, 1:3].max()
            for load, drive in zip(loads, design.drives, strict=True)
        ]
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("key", "drive"),
    [
        ("paper-like", SERVO), ("circle", SERVO), ("arch", replace(SERVO, efficiency=1.0)),
        ("trapezoid", HEAVY), ("paper-like", HEAVY), ("arch", BENT), ("circle", BENT),
    ],
    ids=["move", "circle", "lossless arch", "heavy trapezoid", "heavy", "bent arch", "bent circle"],
)  # fmt: skip
def test_drives_reach_a_limit_and_keep_all(key: str, drive: Drive) -> None:
    design = driven(drive)
    quickest = shortest_stretch(
        PRESET[key].build(design.geometry), MotionLimits(speed=50.0), design
    )
    assert quickest.quantity.startswith(("torque-speed envelope of M", "motor speed of M"))
    used = shares(design, quickest.plan.sample(4000))
    assert used.max() <= 1 + 1e-6
    if drive is not BENT:  # a line below the envelope is a little less than it
        assert used.max() > 0.99
    slower = quickest.plan.lasting(1.3 * quickest.plan.duration).sample(2000)
    assert shares(design, slower).max() < 1


@pytest.mark.slow
def test_drives_are_left_out_where_there_are_none_or_on_request() -> None:
    plan, limits = PRESET["arch"].build(APPENDIX_4.geometry), MotionLimits(speed=1.0, torque=5.0)
    bare = shortest_stretch(plan, limits, APPENDIX_4)
    assert shortest_stretch(plan, limits, driven(Drive(), AXIS), drives=False).plan.duration > 0
    unlimited = replace(APPENDIX_4, drives=(Drive(), None, None, None))
    assert shortest_stretch(plan, limits, unlimited).plan.duration == bare.plan.duration
    fast = replace(APPENDIX_4, drives=(Drive(gear_ratio=50.0, top_speed=40.0), None, None, None))
    found = shortest_stretch(plan, limits, fast)
    assert (found.quantity, found.limit) == ("motor speed of M1", 40.0)
    alone = shortest_stretch(plan, MotionLimits(), driven(SERVO))
    assert "is reached at" in alone.explanation or "rad/s" in alone.explanation


@pytest.mark.slow
def test_one_drive_alone_is_kept_and_a_motion_the_other_way_is_as_long() -> None:
    """Of a robot whose other actuators have none; durations are in columns of their names."""
    plan, none = point_to_point(A, B), MotionLimits()
    for one in (0, 3):
        drives: list[Drive | None] = [None] * 4
        drives[one] = AXIS if one == 3 else SERVO
        design = replace(APPENDIX_4, drives=tuple(drives))  # type: ignore[arg-type]
        found = shortest_stretch(plan, none, design)
        assert found.quantity.endswith(f"M{one + 1}")
        back = shortest_stretch(point_to_point(B, A), none, design)
        assert back.plan.duration > 0.3 * found.plan.duration
        needed = needed_durations(plan.curve, none, design, True)(np.array([0.3, 0.6]))
        assert needed.shape == (2, len(LIMITED))
        assert not np.delete(needed, [10 + one, 14 + one], axis=1).any()
        for robot, kept in ((APPENDIX_4, True), (design, False), (None, True)):
            bare = needed_durations(plan.curve, none, robot, kept)(np.array([0.3, 0.6]))
            assert bare.shape == (2, 6)  # those of rates alone


@pytest.mark.parametrize("law", LAWS)
def test_a_move_and_the_way_back_take_as_long_and_use_limits_of_turning_as_well(
    law: TimeLaw,
) -> None:
    """By turns of either sign; what the limits require is not more than what is given."""
    limits = MotionLimits(speed=9.0, turn_speed=1.0, turn_acceleration=4.0, turn_jerk=90.0)
    if not law.bounded_jerk:
        limits = replace(limits, turn_jerk=None)
    there, back = (
        shortest_stretch(point_to_point(*way, law=law), limits) for way in ((A, B), (B, A))
    )
    assert back.plan.duration == pytest.approx(there.plan.duration, rel=1e-12)
    for found in (there, back):
        top = used(found.plan, dense(found.plan), limits).max(axis=0)
        if law.profile is not Profile.QUINTIC:
            np.testing.assert_allclose(top[[1, 3]], 1.0, rtol=1e-9)
        u = np.array([found.t / found.plan.duration])
        needed = needed_durations(found.plan.curve, limits, None, True)(u)
        assert needed.max() <= found.plan.duration


def test_a_gear_takes_its_share_of_the_load_only_where_it_turns() -> None:
    speed = np.array([-0.3, 0.0, 1.0])
    for limit, fall, shares, counted in drive_lines(replace(SERVO, gear_peak_torque=7.0), speed):
        for share, power in zip(shares, (-1.0, 1.0), strict=False):
            eta = SERVO.total_efficiency**power if counted else 1.0
            np.testing.assert_allclose(share, [eta, 1.0, eta])
        assert len(shares) == (2 if counted else 1)
        assert (limit == 7.0) == (not counted)
        assert counted or fall == 0.0  # a gear's peak is the same at any speed


@pytest.mark.slow
@pytest.mark.parametrize("shortest", [shortest_stretch, shortest_motion])
def test_a_gear_that_limits_is_named_with_its_load(
    shortest: Callable[..., ShortestStretch],
) -> None:
    """And not the envelope of its motor, which a stronger one would not help."""
    plan = PRESET["arch"].build(APPENDIX_4.geometry)
    gear = replace(SERVO, peak_torque=20.0, envelope=(), gear_peak_torque=6.0)
    found = shortest(plan, MotionLimits(), replace(APPENDIX_4, drives=(None, gear, None, None)))
    assert (found.quantity, found.limit, found.unit) == ("load of the gear of M2", 6.0, "N m")
    assert "load of the gear of M2 reaches 6 N·m at" in found.explanation
    # the load is that of the robot without its drives
    load = np.abs(inverse_dynamics(APPENDIX_4, *found.plan.at(dense(found.plan))).torque[:, 1])
    assert load.max() == pytest.approx(6.0, rel=1e-3)
    at = inverse_dynamics(APPENDIX_4, *found.plan.at(np.array([found.t]))).torque[0, 1]
    assert abs(at) == pytest.approx(6.0, rel=1e-6)


def test_a_drive_too_weak_for_gravity_is_named() -> None:
    weak = replace(AXIS, peak_torque=0.1)
    with pytest.raises(InfeasibleMotion) as caught:
        shortest_stretch(
            PRESET["arch"].build(APPENDIX_4.geometry), MotionLimits(), driven(SERVO, weak)
        )
    assert caught.value.actuator == 3
    assert caught.value.limit == pytest.approx(weak.output_limits.peak)
    feeble = replace(SERVO, peak_torque=2e-3, envelope=())
    with pytest.raises(InfeasibleMotion) as caught:
        shortest_stretch(point_to_point(A, B), MotionLimits(force=9e3), driven(feeble))
    assert caught.value.actuator in (0, 1, 2)
    assert caught.value.limit == pytest.approx(feeble.output_limits.peak)
    rising = replace(SERVO, peak_torque=None, envelope=((0.0, 2e-3), (100.0, 0.5), (400.0, 0.5)))
    with pytest.raises(InfeasibleMotion) as caught:
        shortest_stretch(point_to_point(A, B), MotionLimits(), driven(rising))
    assert caught.value.limit == pytest.approx(feeble.output_limits.peak)
    assert abs(caught.value.needed) > caught.value.limit


def test_limits_by_their_places_are_in_the_units_that_are_told() -> None:
    """The envelope's is one; a motor's speed is before its gear; infinite where there is none.

    A gear's peak is behind it, of M4 behind the screw.
    """
    limits = MotionLimits(speed=1.0, turn_acceleration=4.0, jerk=5.0, torque=7.0, force=8.0)
    strong = replace(SERVO, gear_peak_torque=90.0)
    lift = replace(AXIS, gear_ratio=2.0, gear_peak_torque=3.0, lead=0.01, lead_efficiency=0.8)
    design = replace(driven(SERVO), drives=(strong, None, SERVO, lift))
    found = [limit_of(column, limits, design) for column in range(len(LIMITED))]
    infinite = np.inf
    assert found == [
        1.0, infinite, infinite, 4.0, 5.0, infinite, 7.0, 7.0, 7.0, 8.0, 1.0, 1.0, 1.0, 1.0,
        pytest.approx(400.0), infinite, pytest.approx(400.0), pytest.approx(600.0),
        pytest.approx(90.0), infinite, infinite, pytest.approx(3.0 * 2 * math.pi / 0.01 * 0.8),
    ]  # fmt: skip
    assert [limit_of(column, limits, None) for column in range(14, 22)] == [infinite] * 8
    assert len(UNITS) == len(LIMITED) == 22


def test_durations_of_torques_are_those_of_the_smallest_positive_root() -> None:
    """Where the torque does not depend on the speed, falls or rises; without room it is none."""
    rng = np.random.default_rng(6)
    room = rng.uniform(-0.2, 1.0, 400)
    first, second = rng.normal(size=(2, 400)) * 0.5
    first[:40] = second[20:60] = 0.0
    room[50:90] = 0.0
    found = _longest(room, first, second)
    for at, up, over, duration in zip(room, first, second, found, strict=True):
        roots = np.roots([over, up, -at])
        real = roots[(np.abs(roots.imag) < 1e-12) & (roots.real > 0)].real
        expected = 1.0 / real.min() if real.size else 0.0
        assert duration == pytest.approx(expected if at > 0 else np.inf, rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("profile", "jerk"),
    [(Profile.TRAPEZOID, None), (Profile.S_CURVE, None), (Profile.S_CURVE, 2000.0)],
)
def test_ramps_are_gentler_where_a_torque_decides(profile: Profile, jerk: float | None) -> None:
    """Against stretched laws of all ramps: no shape is shorter, and none much better is missed."""
    limits = MotionLimits(speed=0.3, acceleration=100.0, jerk=jerk, torque=6.0)
    found = shortest_stretch(point_to_point(A, B, law=TimeLaw(profile)), limits, APPENDIX_4)
    assert_at_its_limit(found, limits, APPENDIX_4)
    ramps, blends = (10, (0.4,)) if jerk is None else (6, (0.05, 0.2, 0.5))
    assert_best_of_ramps(found, limits, APPENDIX_4, np.geomspace(0.02, 0.5, ramps), blends)


def assert_best_of_ramps(
    found: ShortestStretch, limits: MotionLimits, design: Design, ramps, blends
) -> None:
    profile = found.plan.curve.terms[0].law.profile
    laws = [TimeLaw(profile, ramp, blend) for ramp in ramps for blend in blends]
    others = [
        shortest_stretch(point_to_point(A, B, law=law), limits, design, reshape=False).plan.duration
        for law in laws
    ]
    assert found.plan.duration <= min(others) * (1 + 1e-6)
    assert found.plan.duration >= 0.95 * min(others)


@pytest.mark.slow
def test_a_motor_that_is_too_slow_has_time_at_a_constant_speed() -> None:
    """Where the jerk is limited as well, also beside a torque that is."""
    slow = Drive(gear_ratio=2.0, transmission="screw", lead=0.005, top_speed=300.0)
    design = replace(APPENDIX_4, drives=(None, None, None, slow))
    for limits in (MotionLimits(jerk=50.0), MotionLimits(jerk=200.0, torque=6.0)):
        plan = point_to_point(A, B, law=TimeLaw(Profile.S_CURVE))
        found = shortest_stretch(plan, limits, design)
        ramps, blends = (0.2, 0.3, 0.45), (0.05, 0.2, 0.5)
        assert_best_of_ramps(found, limits, design, ramps, blends)
