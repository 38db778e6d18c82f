"""Numbers that the documentation states, and arguments that are just possible and just not."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.model import APPENDIX_4, InvalidInput
from paminsa_viz.trajectory import (
    SINGULAR_CLEARANCE,
    Controller,
    ControlMode,
    MotionLimits,
    Plan,
    Profile,
    TimeLaw,
    TrajectoryAnalysis,
    analyze,
    arch,
    check,
    check_path,
    circle,
    from_samples,
    line,
    payload_drift,
    plan_deformed,
    point_to_point,
    shortest_motion,
    shortest_stretch,
    simulate,
    simulation,
    unplanned_torque,
    via_points,
)
from paminsa_viz.trajectory import crossing_program as program
from paminsa_viz.trajectory.analysis import EXCESS
from paminsa_viz.trajectory.crossing_measures import CrossingLoad
from paminsa_viz.trajectory.law_program import LOOKED_AT
from paminsa_viz.trajectory.plan import OFF_CROSSING
from paminsa_viz.trajectory.sampled import (
    LARGEST,
    MOST_SAMPLES,
    RATE,
    STEPS,
    Locus,
    Trajectory,
    sample_times,
)
from paminsa_viz.trajectory.shortest import EXCEEDED, FINE, LEAST, PIECES, ROUNDS, SETTLED
from paminsa_viz.trajectory.solved import solve_trajectory
from paminsa_viz.trajectory.time_optimal import TIGHTENED, WIDEST
from tests.support.documentation import defaults_of, missing
from tests.trajectory.plans import A, B

HOME = (0.0, 0.0, 0.0, -0.5)


def test_numbers_of_the_documentation_are_those_of_the_program() -> None:
    control = Controller()
    motions = [
        f"nearer than the clearance ({1e3 * SINGULAR_CLEARANCE:g} mm at Appendix 4's lengths, in "
        "proportion to R_b at others, unless another is given)",
        f"a quadratic spline of some {PIECES} pieces, {LEAST} at least between",
        f"in between ({LOOKED_AT} places of each piece are looked at) by more than "
        f"{100 * EXCEEDED:g} % of the duration, points are added",
        f"up to {ROUNDS} of them, until another one would save less than {100 * SETTLED:g} %",
        f"the motion is checked at {FINE} places of each piece",
        f"in {check._BETWEEN} parts (all of them for up to {check._FEW} samples",
        f"({1e3 * simulation.PANTOGRAPH_CLEARANCE:g} mm before a pantograph is stretched",
        f"steps of at most {1e3 * simulation._LONGEST_STEP:g} ms with an error of "
        f"{simulation._TOLERANCE:g}".replace("e-0", "e-"),
        f"no more than {simulation._MOST_EVALUATIONS:,} evaluations and "
        f"{simulation._MOST_A_SECOND:,} for each second",
        f"up to {MOST_SAMPLES:,} samples, {STEPS[0]:g} s to {STEPS[1]:g} s apart, with poses and "
        f"rates of up to {LARGEST:g}".replace("e+", "e"),
    ]
    crossing = [
        f"z is a cubic spline of {program.INTERVALS} pieces",
        "Limits are kept at four points of each piece",
        f"looked at on a grid {program.FINE} times finer",
        f"exceed them by more than {100 * program.TOLERANCE:g} %, points are added",
        "The pieces next to a crossing are halved three times",
        f"a cosine between path and t_s below {program.STEEP:g}",
        "there are twice as many pieces, halved six times",
        f"halved {program.REFINEMENTS[1]} and then {program.REFINEMENTS[2]} times; where a ≈ 0, "
        f"{program.STEEP_REFINEMENTS[1]} and then {program.STEEP_REFINEMENTS[2]} times",
        f"Points are added {TIGHTENED} times at most",
        f"up to {WIDEST:g} of the path to both sides",
        f"is moved by {1e6 * OFF_CROSSING:g} µs",
        f"counts from {100 * EXCESS:g} % of the largest torque on",
        f"within a clearance of the locus ({1e3 * SINGULAR_CLEARANCE:g} mm at Appendix 4's "
        "R_b unless given)",
    ]
    commands = [
        f"Samples a second; {RATE:g} for planned motions",
        f"| `--bandwidth HZ` | `{control.bandwidth}` |",
    ]
    for name, sentences in (
        ("motions", motions), ("crossing", crossing), ("command-line", commands),
    ):  # fmt: skip
        assert missing(name, sentences) == []
    assert (program.POINTS, program.REFINEMENTS[0], program.STEEP_REFINEMENTS[0]) == (4, 3, 6)
    assert program.STEEP_INTERVALS == 2 * program.INTERVALS
    assert (control.control, control.damping) == (ControlMode.PD, 1.0)


@pytest.mark.parametrize(
    ("make", "possible", "impossible"),
    [
        (lambda v: Controller(bandwidth=v), [0.0, 1e3], [-1e-9, np.inf]),
        (lambda v: Controller(damping=v), [0.0, 1e3], [-1e-9, np.nan]),
        (lambda v: Controller(proportional=(v,) * 4, derivative=(v,) * 4), [0.0], [-1e-9, np.inf]),
        (lambda v: TimeLaw(ramp=v), [1e-9, 0.5], [0.0, np.nextafter(0.5, 1.0)]),
        (lambda v: TimeLaw(blend=v), [1e-9, 0.5], [0.0, np.nextafter(0.5, 1.0)]),
        (lambda v: arch(A, B, v), [0.0, 0.1], [-1e-9, np.inf]),
        (lambda v: arch(A, B, 0.1, lift_share=v), [1e-3, 0.5], [0.0, np.nextafter(0.5, 1.0)]),
        (lambda v: arch(A, B, 0.1, overlap=v), [0.0, 1.0], [-1e-9, np.nextafter(1.0, 2.0)]),
        # with corners the crossing has what the lifts leave
        (lambda v: arch(A, B, 0.1, lift_share=v, overlap=0.0), [0.499], [0.5]),
        # a crossing takes a millionth of the time at least
        (lambda v: arch(A, B, 0.1, lift_share=0.5, overlap=v), [1.05e-6], [0.95e-6]),
        (lambda v: circle(HOME, v), [1e-6], [0.0, np.inf]),
        (lambda v: circle(HOME, 0.1, angle=v), [-1.0, 0.0], [np.inf, np.nan]),
        (lambda v: circle(HOME, 0.1, begin=v), [-1.0, 0.0], [np.inf, np.nan]),
        (lambda v: via_points([A, B], times=[0.0, v]), [1e-3], [0.0, -1.0, np.inf]),
        (lambda v: point_to_point(A, B, v), STEPS, [0.99 * STEPS[0], 1.01 * STEPS[1]]),
        (lambda v: sample_times(0.0, 1.0, v), [1e-3, MOST_SAMPLES], [0.0, MOST_SAMPLES + 1]),
        (
            lambda v: check_path(APPENDIX_4.geometry, point_to_point(A, B).sample(9), v),
            [0.0, 1e-3], [-1e-9, np.inf],
        ),
        (
            lambda v: Trajectory([0.0, v], [A, A], 0 * A + [A, A], 0 * A + [A, A]),
            STEPS, [0.0, 0.9 * STEPS[0], 1.01 * STEPS[1]],
        ),
        # a step of four units in the last place of the time is the least that is exact enough
        (
            lambda v: Trajectory([2.0**20, 2.0**20 + v], [A, A], [A, A], [A, A]),
            [4 * 2.0**-32], [3 * 2.0**-32],
        ),
        (
            lambda v: Trajectory([0.0, 1.0], [A, A], [A, A], [A, [0.0, 0.0, 0.0, v]]),
            [LARGEST, -LARGEST], [1.01 * LARGEST, np.inf],
        ),
    ],
    ids=range(20),
)  # fmt: skip
def test_what_is_just_possible_is_done_and_what_is_just_not_is_refused(
    make: Callable[[float], Any], possible: Any, impossible: Any
) -> None:
    for value in possible:
        make(value)
    for value in impossible:
        with pytest.raises(InvalidInput):
            make(value)


@pytest.mark.parametrize(
    ("function", "defaults"),
    [
        (simulate, {"clearance": None, "offset": (0.0,) * 4, "model": None}),
        (analyze, {"clearance": None, "keep": None}),
        (shortest_stretch, {"reshape": True, "drives": True, "clearance": None}),
        (shortest_motion, {"drives": True, "clearance": None}),
        (point_to_point, {"duration": 1.0}),
        (arch, {"duration": 1.0, "lift_share": 0.4, "overlap": 0.5}),
        (line, {"duration": 1.0}),
        (via_points, {"duration": None, "times": None}),
        (TimeLaw, {"profile": Profile.QUINTIC, "ramp": 0.3, "blend": 0.4}),
        (from_samples, {"rest": False, "load": None}),
        (unplanned_torque, {"rate": RATE}),
        (payload_drift, {"clearance": None}),
        (circle, {"duration": 1.0, "plane": "xy", "begin": 0.0, "angle": 2 * np.pi}),
        (plan_deformed, {"duration": None, "most": 0.02}),
        (solve_trajectory, {"gravity": APPENDIX_4.gravity, "clearance": None}),
        (Plan.sample, {"rate": RATE}),
        (Trajectory.resampled, {"rate": RATE}),
    ],
)  # fmt: skip
def test_defaults_are_those_of_the_descriptions(function: Any, defaults: dict[str, Any]) -> None:
    assert defaults_of(function, defaults) == defaults


@pytest.mark.slow
@pytest.mark.parametrize("plan", [point_to_point(A, B), arch(A, B, 0.08)], ids=["move", "arch"])
def test_a_motion_does_not_depend_on_the_unit_of_time(
    plan: Plan, capfd: pytest.CaptureFixture[str]
) -> None:
    """Limits of a clock that runs twice as fast: the same law in half the time."""
    slow = MotionLimits(speed=0.5, turn_speed=3.0, acceleration=3.0, turn_acceleration=20.0)
    fast = MotionLimits(speed=1.0, turn_speed=6.0, acceleration=12.0, turn_acceleration=80.0)
    for shortest in (shortest_stretch, shortest_motion):
        one, two = (shortest(plan, limits) for limits in (slow, fast))
        assert two.plan.duration == pytest.approx(0.5 * one.plan.duration, rel=1e-7)
        assert (two.quantity, two.t) == (one.quantity, pytest.approx(0.5 * one.t, rel=1e-3))
        u = np.linspace(0.0, 1.0, 50)
        np.testing.assert_allclose(two.plan.curve(u), one.plan.curve(u), atol=1e-7)
    assert capfd.readouterr() == ("", "")  # a solver may say much


def test_a_crossing_is_unbounded_from_a_share_of_the_largest_torque_on(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    slow = point_to_point(HOME, (1e-3, 0.0, 0.0, -0.5), 9.0)
    analysis = analyze(APPENDIX_4, slow.sample(50))
    largest = np.abs(analysis.torque[:, :3]).max()
    assert 0.0 < largest < 0.5 < np.abs(analysis.torque[:, 3]).max()  # M4 does not count
    load = CrossingLoad(0.5, Locus.CIRCLE, 1.0, 0.0, (0.0,) * 4)
    both = tuple(replace(load, excess=share * EXCESS * largest) for share in (1.0, 1.001))
    monkeypatch.setattr(TrajectoryAnalysis, "crossings", property(lambda _: both))
    for sign in (1.0, -1.0):
        assert replace(analysis, torque=sign * analysis.torque).unbounded == both[1:]
