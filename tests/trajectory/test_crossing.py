"""Motions through type-2 singularities."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.model import (
    APPENDIX_4,
    Design,
    Drive,
    InvalidInput,
    KneeBranch,
    escape_twist,
    inverse_dynamics,
    inverse_jacobian,
    mass_matrix,
    platform_wrench,
    singular_radius,
    singular_rotation,
)
from paminsa_viz.model.reach import Limit
from paminsa_viz.trajectory import (
    MotionLimits,
    analyze,
    check_path,
    round_trip,
)
from paminsa_viz.trajectory import crossing_program as program
from paminsa_viz.trajectory.crossing import (
    CrossingKind,
    Locus,
    crossing_condition,
    crossings,
)
from paminsa_viz.trajectory.crossing_program import CrossingProgram
from paminsa_viz.trajectory.paths import Path, spline_path, straight_path
from paminsa_viz.trajectory.sampled import Passage
from paminsa_viz.trajectory.time_optimal import CrossingRefused, TimeOptimalPlan, time_optimal
from tests.support.samples import random_design, random_states
from tests.trajectory.crossings import (
    BALANCED,
    FINER,
    LINE,
    PLAIN,
    TEN,
    TURN,
    any_path,
    duration,
    influences,
    lines_across,
    random_crossing,
    shortest,
)


def _singular_poses(design: Design, rng: np.random.Generator, n: int = 20) -> np.ndarray:
    geometry = design.geometry
    theta, angle = rng.uniform(-1.5, 1.5, n), rng.uniform(0.0, 2 * np.pi, n)
    radius = singular_radius(geometry, theta)
    poses = np.stack([radius * np.cos(angle), radius * np.sin(angle), theta, 0 * angle], axis=1)
    if geometry.platform_radius < geometry.base_radius:
        poses[::2, :2] *= rng.uniform(0.1, 0.9, (n // 2, 1))
        poses[::2, 2] = singular_rotation(geometry) * rng.choice([-1, 1], n // 2)
    return poses


@pytest.mark.parametrize("knee", list(KneeBranch))
def test_no_actuator_feels_the_escape_twist(knee: KneeBranch) -> None:
    rng = np.random.default_rng(1)
    for _ in range(50):
        design = random_design(rng).with_knee(knee)
        poses = _singular_poses(design, rng)
        g, twist = inverse_jacobian(design.geometry, poses), escape_twist(design.geometry, poses)
        felt = np.einsum("nij,nj->ni", g, twist)
        assert np.abs(felt).max() < 1e-12 * np.abs(g).max()


def test_the_escape_twist_is_tangent_to_the_circle_and_ends_away_from_it() -> None:
    rng = np.random.default_rng(2)
    poses = _singular_poses(APPENDIX_4, rng)[1::2]  # on the circle
    twist = escape_twist(APPENDIX_4.geometry, poses)
    assert np.allclose(np.hypot(*twist[:, :2].T), APPENDIX_4.geometry.platform_radius, rtol=1e-12)
    step = 1e-6
    radius = singular_radius(APPENDIX_4.geometry, (poses + step * twist)[:, 2])
    moved = np.hypot(*(poses + step * twist)[:, :2].T)
    assert np.abs(moved - radius).max() < 10 * step**2
    poses[:, 0] += 1e-4
    assert np.isnan(escape_twist(APPENDIX_4.geometry, poses)).all()


@pytest.mark.parametrize("knee", list(KneeBranch))
def test_the_wrench_of_the_platform_is_that_of_the_torques(knee: KneeBranch) -> None:
    rng = np.random.default_rng(3)
    for _ in range(5):
        design = random_design(rng).with_knee(knee).without_friction()
        pose, velocity, acceleration = random_states(rng, design, 20)
        torque = inverse_dynamics(design, pose, velocity, acceleration).torque
        wrench = platform_wrench(design, pose, velocity, acceleration)
        expected = np.einsum("nji,nj->ni", inverse_jacobian(design.geometry, pose), torque)
        assert np.abs(wrench - expected).max() < 1e-9 * np.abs(expected).max()


def test_the_wrench_is_finite_and_continuous_across_the_locus() -> None:
    s = np.array([-1e-7, 0.0, 1e-7]) + crossings(APPENDIX_4.geometry, LINE)[0].s
    pose, still = LINE(s), np.zeros((3, 4))
    wrench = platform_wrench(APPENDIX_4, pose, still, still + 1.0)
    assert np.isfinite(wrench).all()
    assert np.ptp(wrench, axis=0).max() < 1e-3


def test_the_condition_of_the_turn_is_the_published_one() -> None:
    """Numbers from a derivation that did not use this program."""
    (crossing,) = crossings(APPENDIX_4.geometry, TURN)
    assert crossing.locus is Locus.ROTATION
    assert crossing.kind is CrossingKind.SIMPLE
    assert crossing.s == pytest.approx(0.506363, abs=5e-7)
    found = crossing_condition(APPENDIX_4, TURN, crossing.s)
    assert found.a == pytest.approx(0.078338, abs=5e-7)
    assert found.b == pytest.approx(-0.0034651, abs=5e-8)
    assert found.c == pytest.approx(-1.1754, abs=5e-5)
    assert shortest(APPENDIX_4, TURN, TEN).plan.duration == pytest.approx(0.372, abs=5e-4)


@pytest.mark.parametrize("path", [TURN, LINE], ids=["turn", "line"])
def test_weights_do_no_work_on_the_twist_of_a_balanced_robot(path: object) -> None:
    (crossing,) = crossings(BALANCED.geometry, path)
    assert abs(crossing_condition(BALANCED, path, crossing.s).c) < 1e-12


def _torque(design: Design, found: TimeOptimalPlan, t: np.ndarray) -> np.ndarray:
    return inverse_dynamics(design, *found.plan.at(t)).torque


def assert_torques_keep(design: Design, found: TimeOptimalPlan, limit: float, near: float) -> None:
    """Next to its crossings they are those in the limit, and the limit is kept everywhere else."""
    t = np.linspace(0.0, found.plan.duration, 20 * program.INTERVALS * program.POINTS)
    for crossing in found.crossings:
        beside = _torque(design, found, crossing.t + np.array([-1e-7, 1e-7]))
        assert np.abs(beside - crossing.torque).max() < near
        t = t[np.abs(t - crossing.t) > 1e-6]
    assert np.abs(_torque(design, found, t)[:, :3]).max() < limit


@pytest.fixture(
    scope="module",
    params=[(APPENDIX_4, TURN), (BALANCED, TURN), (BALANCED, LINE)],
    ids=["turn", "balanced turn", "balanced line"],
)
def planned(request: pytest.FixtureRequest) -> tuple[Design, TimeOptimalPlan]:
    design, path = request.param
    return design, shortest(design, path, TEN)


@pytest.mark.slow
def test_torques_go_to_their_limit_and_keep_theirs(planned: tuple[Design, TimeOptimalPlan]) -> None:
    design, found = planned
    (crossing,) = found.crossings
    assert abs(crossing.residual) < 1e-9
    assert_torques_keep(design, found, 10.1, 1e-2)
    z, slope = (float(found.curve.z(crossing.crossing.s, order)) for order in (0, 1))
    assert crossing.residual == crossing.condition.residual(crossing.speed, 0.5 * slope)
    assert crossing.speed == pytest.approx(np.sqrt(z))


@pytest.mark.slow
def test_a_plan_passes_its_loci_when_it_crosses_them_and_says_how_it_was_made() -> None:
    found = shortest(BALANCED, LINE, TEN)
    (crossing,), plan = found.crossings, found.plan
    assert plan.passages == (Passage(crossing.t / plan.duration, crossing.crossing.locus),)
    x, y, theta, _ = plan.at(crossing.t).pose
    radius = float(singular_radius(BALANCED.geometry, theta))
    assert np.hypot(x, y) == pytest.approx(radius, abs=1e-8)
    assert (plan.name, plan.kind) == ("crossing", "through singularities")
    assert plan.notes == (crossing.explanation,)
    short = straight_path(LINE.start, LINE(np.array([0.3]))[0])
    free = time_optimal(BALANCED, short, TEN, name="beside")
    assert (free.plan.passages, free.plan.kind, free.plan.notes) == ((), "minimum time", ())
    assert free.plan.name == "beside"


def test_a_plan_says_by_how_much_friction_exceeds_the_limits_that_leave_it_out() -> None:
    drives = (None, None, Drive("weak", gear_ratio=10.0, peak_torque=0.1), None)
    rough = BALANCED.vary({"friction.coulomb_rotary": 3.0, "friction.viscous_rotary": 2.0})
    rough = replace(rough, drives=drives)
    plan = time_optimal(rough, TURN, TEN).plan
    states = plan.at(np.linspace(0.0, plan.duration, 1001))
    rubbed, smooth = (inverse_dynamics(design, *states).torque for design in (rough, BALANCED))
    most = np.abs(rubbed - smooth).max(axis=0)
    assert most[:3].max() > 3.0
    assert np.abs(rubbed[:, :3]).max() > 1.1 * TEN.torque
    assert plan.notes[1:] == (
        "Friction at the actuators is not counted in the limits: it adds up to "
        f"{most[:3].max():.4g} N·m to M1 to M3 and 0 N to M4.",
        "Limits of the design’s drives are not kept: check them on the motion.",
    )


def test_a_motion_that_ignores_the_condition_needs_torques_without_bound() -> None:
    (crossing,) = crossings(APPENDIX_4.geometry, TURN)
    peaks = []
    for distance in (1e-3, 1e-5):  # s'' = 0, s' = 2
        s = crossing.s + np.array([-distance, distance])
        torque = inverse_dynamics(APPENDIX_4, TURN(s), 2.0 * TURN(s, 1), 4.0 * TURN(s, 2)).torque
        peaks.append(np.abs(torque[:, :3]).max())
    assert peaks[1] > 50 * peaks[0]
    condition = crossing_condition(APPENDIX_4, TURN, crossing.s)
    expected = condition.residual(2.0, 0.0) * np.array(condition.growth) / 1e-5
    assert torque[1] == pytest.approx(expected, rel=1e-2, abs=300)


@pytest.mark.slow
def test_a_finer_spline_hardly_changes_the_shortest_time() -> None:
    found = shortest(APPENDIX_4, TURN, TEN).plan.duration
    finer = duration(APPENDIX_4, TURN, TEN, 160, 4)
    assert finer < found < 1.003 * finer


def test_a_balanced_motion_may_be_stretched() -> None:
    found = shortest(BALANCED, TURN, TEN)
    slow = replace(found, plan=found.plan.lasting(2.0 * found.plan.duration))
    t = np.linspace(0.0, found.plan.duration, 301)[1:-1]
    quick, slower = _torque(BALANCED, found, t), _torque(BALANCED, slow, 2.0 * t)
    assert np.abs(slower[:, :3] - quick[:, :3] / 4.0).max() < 1e-9 * np.abs(quick).max()


@pytest.mark.slow
@pytest.mark.parametrize("design", [APPENDIX_4, BALANCED], ids=["Appendix 4", "balanced"])
def test_a_given_duration_is_kept(design: Design) -> None:
    low, high = shortest(design, TURN, TEN).durations
    if design is BALANCED:  # which might stand still: z is a thousandth of the largest one
        assert high == pytest.approx(np.sqrt(1000.0) * low, rel=1e-6)
    wanted = min(2.0 * low, 0.5 * (low + high))
    found = time_optimal(design, TURN, TEN, wanted)
    assert found.plan.duration == pytest.approx(wanted, rel=1e-6)
    assert abs(found.crossings[0].residual) < 1e-9  # which both of what it is between satisfy
    assert np.abs(_torque(design, found, np.array([found.crossings[0].t + 1e-6]))).max() < 400
    assert time_optimal(design, TURN, TEN, high).plan.duration == pytest.approx(high, rel=1e-6)
    for wrong in (0.999 * low, 1.001 * high):
        with pytest.raises(InvalidInput, match="duration") as refusal:
            time_optimal(design, TURN, TEN, wrong)
        least, most = map(float, re.findall(r"(\S+) s (?:to|are)", str(refusal.value)))
        assert low <= least < 1.001 * low
        assert 0.999 * high < most <= high


def test_the_time_law_is_the_derivative_of_itself() -> None:
    curve = shortest(APPENDIX_4, TURN, TEN).plan.curve
    u, step = np.linspace(0.05, 0.95, 60), 1e-6
    for order in range(3):
        rate = (curve(u + step, order) - curve(u - step, order)) / (2 * step)
        size = np.abs(curve(u, order + 1)).max()
        assert np.abs(rate - curve(u, order + 1)).max() < 1e-5 * size
    assert np.allclose(curve(np.array([0.0, 1.0])), TURN(np.array([0.0, 1.0])), atol=1e-12)
    assert np.abs(curve(np.array([0.0, 1.0]), 1)).max() < 1e-6


@pytest.mark.slow
def test_speeds_are_kept() -> None:
    limits = MotionLimits(torque=10.0, turn_speed=3.0)
    plan = time_optimal(APPENDIX_4, TURN, limits).plan
    turn = plan.at(np.linspace(0.0, plan.duration, 2000)).velocity[:, 2]
    assert 2.97 < turn.max() < 3.01


@pytest.mark.parametrize("crossed", [TURN, LINE], ids=["turn", "line"])
def test_the_other_side_of_a_crossing_is_reached(crossed: object) -> None:
    """Passage and bounce have the same actuator positions at a fold; poses tell them apart."""
    plan = shortest(BALANCED, crossed, TEN).plan
    s = plan.curve.place_at(np.linspace(0.0, plan.duration, 50))
    assert (np.diff(s) > 0).all()


def test_limits_are_added_where_a_law_exceeds_them_most() -> None:
    """Those points, and torques there, by the inverse dynamics; then they keep the limits."""
    poses = [[0.1631, -0.0825, -1.8922, -0.554], [-0.1871, 0.1465, -0.8063, -0.4259],
             [-0.0196, -0.0849, 1.7641, -0.458]]  # fmt: skip
    path = spline_path(poses)
    made = CrossingProgram(BALANCED, path, crossings(BALANCED.geometry, path), TEN, *PLAIN)
    law = made.fastest()
    z, count = made.spline(law), program.FINE * program.POINTS
    pieces = np.unique(z.t)
    inner = pieces[:-1, None] + np.diff(pieces)[:, None] * (np.arange(count) + 0.5) / count
    s = np.concatenate([[0.0], inner.ravel(), [1.0]])
    for item in crossings(BALANCED.geometry, path):
        s = s[np.abs(s - item.s) > 1e-4]
    pose, along, bend = (path(s, order) for order in range(3))
    square, growth = z(s)[:, None], 0.5 * z(s, 1)[:, None]
    rate = along * np.sqrt(square)
    torque = inverse_dynamics(BALANCED, pose, rate, along * growth + bend * square).torque
    excess = np.abs(torque[:, :3]).max(axis=1) / 10.0 - 1.0
    sides = np.concatenate([[0.0], excess, [0.0]])
    highest = np.maximum(sides[:-2], sides[2:])
    peaks = excess[(excess >= highest) & (excess > program.TOLERANCE)]
    assert len(peaks) > 3
    before = len(made._rows.limit)
    assert made.tighten(law)
    factors, constant, limit = (part[before:] for part in made._rows[:3])
    assert len(limit) == 6 * len(peaks)
    share = (factors @ law + constant) / limit - 1.0
    found = np.reshape(share, (2, len(peaks), 3)).max(axis=(0, 2))
    np.testing.assert_allclose(found, peaks, rtol=1e-6, atol=1e-9)
    again = made.fastest()
    assert (factors @ again + constant <= limit + 1e-6).all()


@pytest.mark.slow
def test_several_crossings_in_one_motion() -> None:
    path = spline_path(
        [[0.03, 0.02, 0.9, -0.5], [0.03, 0.02, 1.5, -0.5], [0.05, 0.0, 1.5, -0.45],
         [0.05, 0.0, 0.9, -0.45]]
    )  # fmt: skip
    found = time_optimal(BALANCED, path, MotionLimits(torque=20.0))
    assert len(found.crossings) == 2
    assert_torques_keep(BALANCED, found, 20.1, 2e-2)


def test_a_is_the_mass_between_twist_and_path() -> None:
    (crossing,) = crossings(APPENDIX_4.geometry, TURN)
    twist = escape_twist(APPENDIX_4.geometry, np.array(crossing.pose))
    condition = crossing_condition(APPENDIX_4, TURN, crossing.s)
    along = TURN(np.array([crossing.s]), 1)[0]
    expected = twist @ mass_matrix(APPENDIX_4, np.array(crossing.pose)) @ along
    assert condition.a == pytest.approx(expected, rel=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize(
    "poses",
    [
        [[0.0487, -0.3169, 1.1063, -0.4585], [0.171, -0.0979, 0.7206, -0.4999],
         [-0.0254, 0.0019, -1.0912, -0.5588]],
        [[0.1631, -0.0825, -1.8922, -0.554], [-0.1871, 0.1465, -0.8063, -0.4259],
         [-0.0196, -0.0849, 1.7641, -0.458]],
    ],
    ids=["crossing next to the start", "little influence"],
)  # fmt: skip
def test_the_spline_is_refined_where_it_would_have_to_stop(poses: list[list[float]]) -> None:
    found = time_optimal(BALANCED, spline_path(poses), TEN)
    assert_torques_keep(BALANCED, found, 10.0 * (1.0 + 1.2 * program.TOLERANCE), 2e-2)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_limits_are_kept_on_paths_at_random(seed: int) -> None:
    """Many of these are steep near an end or a crossing; about half of them cross a singularity."""
    rng = np.random.default_rng(100 + seed)
    tried = 0
    while tried < 3:
        design, limit = ((BALANCED, 10.0), (APPENDIX_4, 100.0))[int(rng.integers(2))]
        poses = rng.uniform([-0.2, -0.2, -1.9, -0.58], [0.2, 0.2, 1.9, -0.42], (2, 4))
        try:
            found = time_optimal(design, spline_path(poses), MotionLimits(torque=limit))
        except CrossingRefused:
            continue
        tried += 1
        assert_torques_keep(design, found, 1.005 * limit, 2e-3 * limit)


@pytest.mark.slow
@pytest.mark.parametrize("path", [LINE, TURN], ids=["line", "turn"])
def test_limits_are_kept_between_the_points_of_the_program(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With one point in each piece a program exceeds them by 6 and 16 %, until rows are added."""
    monkeypatch.setattr(program, "POINTS", 1)
    assert_torques_keep(BALANCED, time_optimal(BALANCED, path, TEN), 10.03, 0.02)


@pytest.mark.slow
def test_a_planned_crossing_passes_the_check_and_another_one_does_not(
    planned: tuple[Design, TimeOptimalPlan],
) -> None:
    design, found = planned
    samples = found.plan.sample(1000.0)
    assert analyze(design, samples).check.possible
    torque = analyze(design, samples).torque
    assert np.isfinite(torque).all()
    assert np.abs(torque[:, :3]).max() < 10.1
    event = check_path(design.geometry, replace(samples, passages=())).first
    assert event is not None
    assert event.limit is Limit.SINGULAR
    back = round_trip(found.plan).sample()
    assert check_path(design.geometry, back).possible
    assert len(back.passages) == 2


@pytest.mark.slow
def test_steep_crossing_gets_fine_pieces_that_no_finer_ones_beat() -> None:
    """A line across the circle, almost at right angles to the escape twist: 8 % are at stake."""
    start, goal = (0.12 * np.array([np.cos(a), np.sin(a)]) for a in (3.35, 3.55))
    path = straight_path([*start, 0.3, -0.5], [*(3.0 * goal), 0.33, -0.5])
    (cosine,) = influences(BALANCED, path)
    assert 0.02 < cosine < program.STEEP
    found = time_optimal(BALANCED, path, TEN).plan.duration
    assert found <= 1.002 * duration(BALANCED, path, TEN, 80, 8)
    assert found < 0.94 * duration(BALANCED, path, TEN, 80, 0)


@pytest.mark.slow
def test_crossing_near_an_end_gets_fine_pieces() -> None:
    """13 % are at stake: the robot of Appendix 4 ends 0.009 of the path after the crossing."""
    design, path, limits, found = random_crossing(any_path, 6)
    assert found.crossings[-1].crossing.s > 0.99
    assert found.plan.duration < 0.9 * duration(design, path, limits, 80, 0)


@pytest.mark.slow
@pytest.mark.parametrize(("make", "seed"), [(lines_across, 4), (lines_across, 10), (any_path, 1)])
def test_finer_program_is_hardly_faster_on_paths_at_random(make: Any, seed: int) -> None:
    """With cosines of 0.01 on the lines; `benchmarks.time_optimal` looks at more of them."""
    design, path, limits, found = random_crossing(make, seed)
    finer = duration(design, path, limits, *FINER)
    assert 0.998 < found.plan.duration / finer < 1.006
