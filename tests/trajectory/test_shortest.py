"""The time-optimal law: never slower than the stretched one, within all limits, at one of them."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import BSpline

from paminsa_viz.model import APPENDIX_4, InvalidInput, inverse_dynamics
from paminsa_viz.trajectory import (
    PRESET,
    ImpossibleTrajectory,
    MotionLimits,
    arch,
    chain,
    circle,
    point_to_point,
    shortest_motion,
    shortest_stretch,
    via_points,
)
from paminsa_viz.trajectory.durations import needed_durations
from paminsa_viz.trajectory.law_program import LawProgram
from paminsa_viz.trajectory.limits import LIMITED, UNITS
from paminsa_viz.trajectory.paths import TimedPath, TracedPath
from paminsa_viz.trajectory.shortest import law_knots
from tests.trajectory.plans import FRICTION, LAWS, A, B, all_plans, dense, place
from tests.trajectory.test_timing import BENT, HEAVY, SERVO, driven, shares, used

LIMITS = MotionLimits(
    speed=1.0, turn_speed=6.0, acceleration=8.0, turn_acceleration=50.0, torque=7.0, force=450.0
)
HELD = 5e-3
"""Share by which a limit may be exceeded between the instants that are looked at."""


@pytest.mark.slow
def test_straight_move_within_an_acceleration_is_the_textbook_one() -> None:
    """Full acceleration to the middle, full deceleration: T = 2 sqrt(d / a); with a top speed v:
    T = d/v + v/a."""
    goal = A + np.array([0.1, 0.0, 0.0, 0.0])
    plan = point_to_point(A, goal)
    assert shortest_motion(plan, MotionLimits(acceleration=2.0)).plan.duration == pytest.approx(
        2.0 * np.sqrt(0.1 / 2.0), rel=5e-4
    )
    both = shortest_motion(plan, MotionLimits(acceleration=2.0, speed=0.25)).plan.duration
    assert both == pytest.approx(0.1 / 0.25 + 0.25 / 2.0, rel=5e-4)


@pytest.mark.slow
def test_circle_within_an_acceleration_is_the_solution_of_its_equation() -> None:
    """|(z'/2, z/r)| = a on a circle of radius r: z = a r sin(2 s/r) until z = a r, then held."""
    r, a = 0.08, 3.0
    plan = circle(np.array([0.0, 0.0, 0.0, -0.5]), r)
    top = np.pi * r / 4.0  # length run until the whole acceleration is centripetal
    s = top * np.sin(np.linspace(0.0, np.pi / 2, 200_001)) ** 2
    rate = np.sqrt(a * r * np.sin(2.0 * s / r))
    up = float(np.sum(2.0 * np.diff(s) / (rate[1:] + rate[:-1])))
    expected = 2.0 * up + (2.0 * np.pi * r - 2.0 * top) / np.sqrt(a * r)
    found = shortest_motion(plan, MotionLimits(acceleration=a))
    assert found.plan.duration == pytest.approx(expected, rel=2e-4)


poses = st.tuples(
    st.floats(-0.1, 0.1), st.floats(-0.1, 0.1), st.floats(-0.5, 0.5), st.floats(-0.58, -0.44)
)


@pytest.mark.slow
@settings(max_examples=8)
@given(
    st.lists(poses, min_size=2, max_size=4),
    st.sampled_from(LAWS),
    st.sampled_from(["move", "arch", "waypoints"]),
    st.sampled_from([APPENDIX_4, APPENDIX_4.vary(FRICTION), driven(SERVO)]),
    st.booleans(),
)
def test_optimum_is_never_slower_and_keeps_all_limits(way, law, kind, design, with_rates) -> None:
    """Random paths, laws, robots with and without friction and drives."""
    if np.abs(np.diff(way, axis=0)).max(axis=1).min() < 0.01:
        return
    if kind == "waypoints":
        plan = via_points(way)
    elif kind == "arch":
        plan = arch(way[0], way[1], 0.05, law=law)
    else:
        plan = point_to_point(way[0], way[1], law=law)
    limits = LIMITS if with_rates else MotionLimits(torque=8.0, force=450.0)
    try:
        found = shortest_motion(plan, limits, design)
    except ImpossibleTrajectory:
        return
    assert found.plan.duration <= found.stretched
    # between the points of the program, by the durations that the limits need there
    u = np.linspace(1e-6, 1.0 - 1e-6, 1501)
    needed = needed_durations(found.plan.curve, limits, design, True)(u).max(axis=1)
    assert needed.max() <= found.plan.duration * (1.0 + HELD)
    # every instant is at one of its limits, but for the pieces in which they change
    assert np.mean(needed >= 0.97 * found.plan.duration) > 0.75
    # the poses are those of the motion's own path
    own = plan.curve(np.linspace(0.0, 1.0, 20_001))
    for pose in found.plan.curve(u[::300]):
        assert np.abs(own - pose).max(axis=1).min() < 2e-4


@pytest.mark.slow
@pytest.mark.parametrize("number", [0, 3, 5, 15], ids=["move", "arch", "trapezoid", "waypoints"])
def test_torques_and_rates_of_the_samples_keep_their_limits(number: int) -> None:
    """By inverse dynamics of the sampled motion, not by what the program is made of."""
    plan = all_plans()[number]
    found = shortest_motion(plan, LIMITS, APPENDIX_4).plan
    share = used(found, dense(found), replace(LIMITS))
    share[:, [4, 5]] = 0.0  # the jerk
    assert share.max() <= 1.0 + HELD
    assert np.mean(share.max(axis=1) > 0.97) > 0.8


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "transition"),
    [("paper-like", 1e-3), ("waypoints", 1e-3), ("arch", 0.2)],
)
def test_friction_that_brakes_exceeds_no_limit_where_it_fades(name: str, transition: float) -> None:
    """By inverse dynamics, close to the ends and in between, where actuators turn around."""
    rough = APPENDIX_4.vary(
        {
            "friction.coulomb_rotary": 3.0,
            "friction.viscous_rotary": 1.0,
            "friction.coulomb_linear": 20.0,
            "friction.transition_speed": transition,
        }
    )
    plan = PRESET[name].build(rough.geometry)
    found = shortest_motion(plan, MotionLimits(torque=14.0, force=450.0), rough).plan
    beside = 1e-3 * np.linspace(0.0, 1.0, 501)
    between = np.linspace(0.0, 1.0, 10_001)
    states = found.at(found.duration * np.concatenate([beside, 1.0 - beside, between]))
    torque = inverse_dynamics(rough, *states).torque
    assert np.abs(torque[:, :3]).max() <= 14.0 * (1.0 + HELD)
    assert np.abs(torque[:, 3]).max() <= 450.0 * (1.0 + HELD)


@pytest.mark.slow
@pytest.mark.parametrize("drive", [SERVO, HEAVY, BENT], ids=["servo", "heavy", "bent"])
def test_envelopes_of_drives_are_kept(drive) -> None:
    """By the duty cycle of the sampled motion, which `actuation` works out in its own way."""
    design = driven(drive)
    plan = PRESET["arch"].build(design.geometry)
    found = shortest_motion(plan, MotionLimits(speed=50.0), design)
    assert found.plan.duration < found.stretched
    most = shares(design, found.plan.sample(4000)).max()
    assert 0.97 < most <= 1.0 + 1e-3
    free = shortest_motion(plan, MotionLimits(speed=1.0), design, drives=False)
    assert free.quantity == "speed"


@pytest.mark.slow
def test_motion_stops_where_it_did() -> None:
    """A chain of moves keeps its stops, whatever its law."""
    plan = all_plans()[-1]
    found = shortest_motion(plan, LIMITS, APPENDIX_4).plan
    t = found.duration * np.linspace(0, 1, 20_001)
    states = found.at(t)
    for stop in (B, np.array([0.02, 0.08, 0.1, -0.5])):
        near = np.abs(states.pose - stop).max(axis=1).argmin()
        assert np.abs(states.pose[near] - stop).max() < 1e-5
        assert place(states.velocity[near : near + 1])[0] < 0.02


@pytest.mark.slow
@pytest.mark.parametrize("share", [0.98, 0.995, 1.005, 1.02])
def test_points_are_added_where_a_law_is_too_fast_and_nowhere_else(share: float) -> None:
    """A law that needs a share of its own duration, by the limits."""
    plan = point_to_point(A, B)
    own = shortest_stretch(plan, LIMITS, APPENDIX_4).plan
    path = TracedPath(own.curve)
    knots, bends = law_knots(path)
    program = LawProgram(path, knots, bends, LIMITS, APPENDIX_4, own.duration)
    z = program.solve(path.law)
    rate = own.duration / share
    curve = TimedPath(path, BSpline(z.t, z.c / rate**2, z.k), tuple(path.place(path.rests)))
    u, needed, _ = program.needed(curve)
    most = np.argmax(needed, axis=1)
    ends = curve.breaks
    assert (u > ends[:-1, None]).all()  # at the knots themselves the law may bend
    assert (u < ends[1:, None]).all()
    np.testing.assert_allclose(u + u[:, ::-1], np.tile(ends[:-1] + ends[1:], (u.shape[1], 1)).T)
    before = len(program.points)
    assert program.tighten(curve, 0.01) == (needed.max() > 1.01) == (share > 1.01)
    at = u[np.arange(len(u)), most][needed.max(axis=1) > 1.01]  # in each piece where it is most
    np.testing.assert_allclose(
        program.points[before:], curve.place_at(at * curve.duration), atol=1e-12
    )


@pytest.mark.slow
def test_derivatives_are_those_of_the_poses() -> None:
    found = shortest_motion(arch(A, B, 0.08), LIMITS, APPENDIX_4).plan
    h = 1e-5
    inner = found.curve.breaks
    t = found.duration * (0.5 * (inner[1:] + inner[:-1]))[5:-5]
    before, at, after = (found.at(t + step) for step in (-h, 0.0, h))
    assert np.allclose((after.pose - before.pose) / (2 * h), at.velocity, atol=2e-6)
    assert np.allclose((after.velocity - before.velocity) / (2 * h), at.acceleration, atol=1e-3)
    jerk = (after.acceleration - before.acceleration) / (2 * h)
    assert np.allclose(jerk, found.jerk(t), atol=1e-2 * np.abs(jerk).max())
    assert not found.curve.bounded_jerk  # the acceleration steps where the law begins
    with pytest.raises(InvalidInput, match="jumps"):
        shortest_stretch(found, MotionLimits(jerk=60.0))


def test_places_and_instants_of_a_traced_path_are_inverse() -> None:
    path = TracedPath(via_points([A, B, A + 0.05]).curve)
    s = np.concatenate([np.geomspace(1e-8, 0.1, 30), np.linspace(0.1, 1.0, 200)])
    assert np.allclose(path.place(path.instant(s)), s, atol=1e-13)
    u = np.linspace(0.0, 1.0, 200_001)
    steps = np.diff(path.curve(u), axis=0) * [1.0, 1.0, 0.1, 1.0]
    assert path.length == pytest.approx(np.linalg.norm(steps, axis=1).sum(), rel=1e-8)


def test_law_of_a_motion_is_how_its_own_places_follow_each_other() -> None:
    path = TracedPath(via_points([A, B, A + 0.05]).curve)
    u, h = np.linspace(0.05, 0.95, 40), 1e-5
    before, s, after = path.place(u - h), path.place(u), path.place(u + h)
    z, slope = path.law(s)
    np.testing.assert_allclose(z, ((after - before) / (2 * h)) ** 2, rtol=1e-5, atol=1e-7)
    growth = (after - 2 * s + before) / h**2
    np.testing.assert_allclose(slope, 2 * growth, rtol=1e-2, atol=1e-3)


def test_jerk_falls_back_to_the_stretched_law_and_says_why() -> None:
    plan, limits = point_to_point(A, B), replace(LIMITS, jerk=60.0)
    found = shortest_motion(plan, limits, APPENDIX_4)
    assert found.plan.duration == shortest_stretch(plan, limits, APPENDIX_4).plan.duration
    assert "jerk is not convex" in found.explanation


def test_speeds_alone_stretch_the_law_and_say_why() -> None:
    found = shortest_motion(point_to_point(A, B), MotionLimits(speed=0.2))
    assert found.plan.duration == found.stretched
    assert "leave its acceleration free" in found.explanation


@pytest.mark.slow
def test_a_law_that_is_the_best_one_stays() -> None:
    plan = point_to_point(A, A + np.array([0.1, 0, 0, 0]), law=LAWS[1])
    limits = MotionLimits(acceleration=2.0, speed=0.3)
    found = shortest_motion(plan, limits)
    assert found.plan.duration == pytest.approx(found.stretched, rel=5e-4)
    assert found.plan.duration <= found.stretched


def test_optimum_refuses_as_the_stretched_law_does() -> None:
    with pytest.raises(InvalidInput, match="nothing that moves"):
        shortest_motion(point_to_point(A, B), MotionLimits())
    with pytest.raises(InvalidInput, match="design"):
        shortest_motion(point_to_point(A, B), MotionLimits(torque=1.0))


def test_time_of_constant_accelerations_with_a_stop_between_is_that_of_their_formula() -> None:
    """z linear: a piece of length h takes 2 h / (s'_0 + s'_1); s grows with the square of time."""
    path = TracedPath(point_to_point(A, B).curve)
    knots = np.array([0.0, 0.3, 0.5, 0.7, 1.0])
    z = BSpline(np.concatenate([[0.0], knots, [1.0]]), np.array([0.0, 4.0, 0.0, 1.0, 0.0]), 1)
    law = TimedPath(path, z, (0.0, 0.5, 1.0))
    assert law.duration == pytest.approx(0.6 / 2 + 0.4 / 2 + 0.4 + 0.6, rel=1e-9)
    assert law.breaks * law.duration == pytest.approx(np.array([0, 0.3, 0.5, 0.9, 1.5]), rel=1e-9)
    assert law.time_at(0.3) == pytest.approx(0.3, rel=1e-9)
    assert law.time_at(1.0) == pytest.approx(law.duration, rel=1e-12)
    for at, time in ((0.0, 0.0), (0.03, 0.009**0.5), (0.5, 0.5), (0.6, 0.5 + 0.08**0.5)):
        assert law.time_at(at) == pytest.approx(time, rel=1e-6)
    assert law.place_at(np.array([0.15]))[0] == pytest.approx(0.075, rel=1e-9)


CHAINED = chain(point_to_point(A, B, 0.5), via_points([B, A, A + 0.03, B], 3.0), arch(B, A, 0.02))


@pytest.mark.parametrize("plan", [CHAINED, via_points([A, B, A + 0.03])], ids=["stops", "none"])
def test_knots_are_close_at_stops_and_those_next_to_breaks_are_the_breaks(plan) -> None:
    path = TracedPath(plan.curve)
    knots, bends = law_knots(path)
    breaks = path.place(path.breaks)
    np.testing.assert_allclose(knots[bends], breaks, atol=1e-15)
    assert (np.diff(knots) > 0).all()
    assert knots[[0, -1]].tolist() == [0.0, 1.0]
    wanted = []
    for begin, end in pairwise(path.place(path.rests)):
        count = max(24, round(100 * (end - begin)))
        angle = np.pi * np.arange(1, count) / count
        wanted.append(begin + (end - begin) * np.sin(0.5 * angle) ** 2)
    every = np.concatenate(wanted)
    near = np.abs(every[:, None] - breaks).min(axis=1) <= 0.05 * np.diff(every, prepend=0.0)
    assert near.any() == (plan is CHAINED)
    np.testing.assert_allclose(knots[~bends], every[~near], atol=1e-14)


@pytest.mark.slow
def test_the_duration_is_what_the_law_needs_where_it_needs_most(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """At 62 places of each piece and beside its ends; and a few programs are enough."""
    solved = []

    def solve(self: LawProgram, before, real=LawProgram.solve) -> BSpline:  # type: ignore[no-untyped-def]
        solved.append(1)
        s, h = np.linspace(0.013, 0.987, 40), 1e-7
        slope = (before(s + h)[0] - before(s - h)[0]) / (2.0 * h)
        np.testing.assert_allclose(before(s)[1], slope, atol=1e-4 * np.abs(slope).max())
        return real(self, before)

    monkeypatch.setattr(LawProgram, "solve", solve)
    plan = point_to_point(A, B)
    found = shortest_motion(plan, LIMITS, APPENDIX_4)
    assert 2 <= len(solved) <= 6
    breaks = found.plan.curve.breaks
    share = np.concatenate([[1e-6], (np.arange(62) + 0.5) / 62, [1.0 - 1e-6]])
    u = (breaks[:-1, None] + np.diff(breaks)[:, None] * share).ravel()
    needed = needed_durations(found.plan.curve, LIMITS, APPENDIX_4, True)(u)
    assert needed.max() == pytest.approx(found.plan.duration, rel=1e-12)
    row, column = np.unravel_index(int(needed.argmax()), needed.shape)
    assert (found.quantity, found.unit) == (LIMITED[column], UNITS[column])
    assert found.t == pytest.approx(u[row] * found.plan.duration)
    assert found.limit == [*LIMITS.rates.ravel(), *LIMITS.actuators][column]
    assert found.stretched == shortest_stretch(plan, LIMITS, APPENDIX_4).plan.duration
    assert (found.plan.name, found.plan.kind) == (plan.name, f"{plan.kind}, time-optimal")


@pytest.mark.parametrize(("share", "kept"), [(0.048, False), (-0.048, False), (0.052, True)])
def test_a_knot_within_a_twentieth_of_its_piece_of_a_break_is_the_break(
    share: float, kept: bool
) -> None:
    """Also the first one, whose piece begins at the start."""
    first = np.sin(0.005 * np.pi) ** 2  # of a hundred pieces

    class Path:
        breaks = np.array([0.0, (1.0 + share) * first, 1.0])
        rests = np.array([0.0, 1.0])

        def place(self, u: np.ndarray) -> np.ndarray:
            return u.copy()

    knots, bends = law_knots(Path())  # type: ignore[arg-type]
    assert len(knots) == 101 + kept
    np.testing.assert_array_equal(knots[bends], Path.breaks)
    assert (np.abs(knots - first).min() < 1e-12) == kept
