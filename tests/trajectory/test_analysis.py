"""Required torques on a trajectory: both routes to them, their parts, energy, failures."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.model import (
    APPENDIX_4,
    PARAMETERS,
    InvalidInput,
    KneeBranch,
    Limit,
    Misprint,
    actuator_power,
    inverse_dynamics,
    inverse_kinematics,
    torque_breakdown,
)
from paminsa_viz.model.drive import Drive
from paminsa_viz.trajectory import (
    PRESET,
    analyze,
    chain,
    circle,
    compare,
    point_to_point,
    round_trip,
    solved,
    via_points,
)
from paminsa_viz.trajectory.analysis import TrajectoryAnalysis
from paminsa_viz.trajectory.crossing_measures import CrossingLoad
from paminsa_viz.trajectory.integrals import rms, running_integral, time_weights
from paminsa_viz.trajectory.sampled import Locus
from paminsa_viz.trajectory.solved import _with_unsolved, solve_trajectory
from tests.support.cases import Case, assert_close, cases
from tests.support.samples import with_knee
from tests.trajectory.plans import ALL_PRESETS, FRICTION, A, B, C, preset_plan

HOME = np.array([0.0, 0.0, 0.0, -0.5])
ROUGH = APPENDIX_4.vary(FRICTION)
PARTS = ("gravity", "inertial", "velocity", "friction")
RATE = 100.0


@ALL_PRESETS
@pytest.mark.parametrize("knee", KneeBranch)
@pytest.mark.parametrize("misprints", [Misprint.NONE, Misprint.ALL, *Misprint])
def test_both_routes_give_the_same_torques(preset, knee, misprints) -> None:
    """The regressor's product, and inverse dynamics by multipliers."""
    samples = preset_plan(preset, knee).sample(RATE)
    design, motion = ROUGH.with_knee(knee), (samples.pose, samples.velocity, samples.acceleration)
    found = analyze(design, samples, misprints=misprints)
    assert found.check.possible
    assert_close(found.torque, inverse_dynamics(design, *motion, misprints).torque, 1e-12)
    size = np.abs(found.torque).max(axis=0)
    assert (np.abs(found.breakdown.total - found.torque) <= 1e-12 * size).all()
    if misprints is Misprint.NONE:
        assert_parts_agree(found.breakdown, torque_breakdown(design, *motion), 1e-12 * size)
        power = actuator_power(design, samples.pose, samples.velocity, found.torque)
        np.testing.assert_allclose(found.power, power, atol=1e-12 * size.max())


def assert_parts_agree(found, exact, most) -> None:
    for part in PARTS:
        assert (np.abs(getattr(found, part) - getattr(exact, part)) <= most).all()


@given(cases())
def test_random_robots(case: Case) -> None:
    start = np.array(case.poses(1)[0])
    size = case.geometry.base_radius
    step = np.array([0.02, -0.01, 0.04, 0.02]) * [size, size, 1, size]
    samples = point_to_point(start, start + step, 0.3).sample(200)
    found = analyze(case.design, samples, clearance=0.0)
    exact = inverse_dynamics(case.design, samples.pose, samples.velocity, samples.acceleration)
    assert_close(found.torque, exact.torque, 1e-9)
    residual = np.abs(found.energy_residual).max()
    assert residual <= 1e-4 * np.abs(found.power).sum(axis=1).max() * samples.duration


CHANGES = {
    "a mass": {"links.b3": 0.7},
    "the payload": {"payload.mass": 3.0, "payload.inertia": 0.02},
    "gravity": {"gravity": 1.62},
    "friction": {"friction.viscous_rotary": 2.0},
    "all of them": {"joints.j9": 0.1, "gravity": 3.7, "payload.mass": 1.0, **FRICTION},
}


@pytest.mark.parametrize("change", CHANGES)
@pytest.mark.parametrize("misprints", [Misprint.NONE, Misprint.ALL])
def test_kept_solution_serves_other_masses(change: str, misprints: Misprint) -> None:
    samples = round_trip(point_to_point(A, B, 0.5)).sample(RATE)
    before = analyze(APPENDIX_4, samples, misprints=misprints)
    design = APPENDIX_4.vary(CHANGES[change])
    kept = analyze(design, samples, misprints=misprints, keep=before.solved)
    fresh = analyze(design, samples, misprints=misprints)
    assert kept.solved is before.solved
    with pytest.raises(ValueError, match="read-only"):  # it is kept for the next design
        kept.solved.friction(design)[0, 0] = 1.0
    assert_close(kept.torque, fresh.torque, 1e-13)
    assert not np.allclose(kept.torque, before.torque, rtol=1e-3)
    most = 1e-13 * np.abs(fresh.torque).max(axis=0)
    assert_parts_agree(kept.breakdown, fresh.breakdown, most)


def test_a_solution_serves_another_gravity_and_drives() -> None:
    """Also where the legs' lifts are moved by it; with parts that add up."""
    samples = preset_plan(PRESET["paper-like"], KneeBranch.LOWER).sample(RATE)
    motion = samples.pose, samples.velocity, samples.acceleration
    servo = Drive("servo", rotor_inertia=2e-4, gear_ratio=50.0, viscous=1e-3, coulomb=0.02)
    axis = Drive("axis", rotor_inertia=1e-4, transmission="screw", lead=0.01)
    driven = replace(ROUGH, drives=(servo, servo, replace(servo, gear_ratio=20.0), axis))
    solved = solve_trajectory(APPENDIX_4.geometry, samples, gravity=9.81)
    alone = replace(ROUGH.vary({"payload.mass": 2.0}), drives=(None, servo, None, None))
    for design in (
        driven, alone, replace(driven, gravity=3.7), replace(APPENDIX_4, gravity=25.0),
    ):  # fmt: skip
        exact = inverse_dynamics(design, *motion).torque
        size = np.abs(exact).max(axis=0)
        assert_close(solved.torques(design), exact, 1e-11)
        without = inverse_dynamics(design.without_friction(), *motion).torque
        assert_close(solved.torques(design, friction=False), without, 1e-11)
        parts, expected = solved.breakdown(design), torque_breakdown(design, *motion)
        assert (np.abs(parts.total - exact) <= 1e-11 * size).all()
        assert_parts_agree(parts, expected, 1e-11 * size.max())


def test_a_sample_within_rounding_of_a_limit_is_the_first_failure_there() -> None:
    samples = preset_plan(PRESET["paper-like"], KneeBranch.LOWER).sample(RATE)
    solved = solve_trajectory(APPENDIX_4.geometry, samples)
    assert solved.check.first is None
    unsolved = np.zeros(samples.size, bool)
    unsolved[[30, 50]] = True
    found = _with_unsolved(solved.check, samples, unsolved)
    assert found.first is not None
    assert (found.first.t, found.first.limit, found.first.leg) == (
        samples.t[30],
        Limit.SINGULAR,
        -1,
    )
    assert found.first.pose == tuple(samples.pose[30])
    assert found.first.margin == 0.0
    assert found.until == 30
    np.testing.assert_array_equal(found.status == Limit.SINGULAR, unsolved)
    later = np.zeros(samples.size, bool)
    later[60] = True
    again = _with_unsolved(found, samples, later)
    assert (again.first, again.until) == (found.first, 30)
    earlier = np.zeros(samples.size, bool)
    earlier[5] = True
    assert _with_unsolved(found, samples, earlier).until == 5


def test_a_sample_without_torques_is_a_failure_there(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where the check finds none: one number that cannot be computed is enough."""

    def lost(*arguments, real=solved.torque_regressor, **options):
        y = real(*arguments, **options)
        y[30, 2, 5] = np.nan
        return y

    monkeypatch.setattr(solved, "torque_regressor", lost)
    samples = preset_plan(PRESET["paper-like"], KneeBranch.LOWER).sample(RATE)
    found = solve_trajectory(APPENDIX_4.geometry, samples)
    assert found.check.until == 30
    assert found.check.first is not None
    assert found.check.first.t == samples.t[30]
    wrong = np.arange(samples.size) == 30
    np.testing.assert_array_equal(~found.check.ok, wrong)
    for rows in (found.y.reshape(len(wrong), -1), found.speed):
        np.testing.assert_array_equal(np.isnan(rows).all(axis=1), wrong)
        np.testing.assert_array_equal(np.isnan(rows).any(axis=1), wrong)


def test_a_kept_solution_serves_nothing_else() -> None:
    samples = point_to_point(A, B).sample(20)
    solved = analyze(APPENDIX_4, samples).solved
    longer = APPENDIX_4.vary({"geometry.base_radius": 0.36})
    others = (
        analyze(longer, samples, keep=solved),
        analyze(with_knee(APPENDIX_4, KneeBranch.UPPER), samples, keep=solved),
        analyze(APPENDIX_4, point_to_point(A, B).sample(20), keep=solved),
        analyze(APPENDIX_4, samples, misprints=Misprint.EQ14_SINE_SIGNS, keep=solved),
        analyze(APPENDIX_4, samples, clearance=0.5, keep=solved),
    )
    for other in others:
        assert other.solved is not solved
    assert solved.check.possible
    assert not others[-1].check.possible
    t = samples
    exact = inverse_dynamics(longer, t.pose, t.velocity, t.acceleration)
    assert_close(others[0].torque, exact.torque, 1e-12)


@pytest.mark.parametrize(
    "plan",
    [circle(C, 0.07, 2.0), via_points([A, B, C, A], 3.0), round_trip(point_to_point(A, B, 0.8))],
    ids=["circle", "waypoints", "there and back"],
)
@pytest.mark.parametrize("knee", KneeBranch)
def test_energy_over_a_closed_path(plan, knee) -> None:
    """Without friction no work is done on balance; with it, all of it is lost to friction."""
    samples = plan.sample(1000)
    free = analyze(with_knee(APPENDIX_4, knee), samples)
    turnover = sum(s.driven - s.braked for s in free.summary)
    assert turnover > 1.0
    assert abs(sum(s.work for s in free.summary)) <= 1e-7 * turnover
    assert np.abs(free.energy_residual).max() <= 1e-7 * turnover
    assert free.energy[-1] == pytest.approx(free.energy[0], abs=1e-9)

    viscous = APPENDIX_4.vary({k: v for k, v in FRICTION.items() if "viscous" in k})
    rough = analyze(with_knee(viscous, knee), samples)
    speed = rough.solved.speed
    factors = [0.7] * 3 + [40.0]
    lost = np.trapezoid((factors * speed**2).sum(axis=1), samples.t)
    assert sum(s.work for s in rough.summary) == pytest.approx(lost, rel=1e-5)
    assert np.abs(rough.energy_residual).max() <= 1e-7 * turnover


def test_summary() -> None:
    """Also of samples that begin and end in the middle of a motion."""
    whole = chain(point_to_point(A, B, 0.6), point_to_point(B, C, 0.5)).sample(500)
    for samples in (whole, whole.take(np.arange(120, 400))):
        found = analyze(ROUGH, samples)
        assert len(found.summary) == 4
        for j, summary in enumerate(found.summary):
            torque, power = found.torque[:, j], found.power[:, j]
            where = np.argmax(np.abs(torque))
            assert (summary.peak, summary.peak_t) == (torque[where], samples.t[where])
            top = np.argmax(np.abs(power))
            assert (summary.top_power, summary.top_power_t) == (power[top], samples.t[top])
            mean = np.sqrt(np.trapezoid(torque**2, samples.t) / samples.duration)
            assert summary.rms == pytest.approx(mean, rel=1e-4)
            assert summary.top_speed == np.abs(found.solved.speed[:, j]).max()
            for own, part in ((summary.driven, power.clip(0)), (summary.braked, power.clip(max=0))):
                assert own == pytest.approx(np.trapezoid(part, samples.t), rel=1e-3, abs=1e-12)
            assert found.work[-1, j] == pytest.approx(summary.work, abs=1e-3 * summary.driven)
        assert found.energy_residual[0] == 0.0
        assert np.abs(found.energy_residual).max() <= 1e-5 * sum(s.driven for s in found.summary)


def test_peaks_count_crossings_with_a_bound_before_the_first_failure(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """And the size of a torque alone, not when it is or its sign."""
    analysis = analyze(APPENDIX_4, point_to_point(A, B, 2.0).sample(50))
    sampled = analysis.summary
    load = CrossingLoad(0.01, Locus.CIRCLE, 0.0, 0.0, (-1e3, 2e3, 1e-6, -4e3))
    after = replace(load, t=2.5, torque=(5e3,) * 4)
    wild = replace(load, t=0.02, torque=(6e3,) * 4)
    monkeypatch.setattr(TrajectoryAnalysis, "crossings", property(lambda _: (load, after, wild)))
    monkeypatch.setattr(TrajectoryAnalysis, "unbounded", property(lambda _: (wild,)))
    found = [(one.peak, one.peak_t) for one in replace(analysis).summary]
    assert found == [(-1e3, 0.01), (2e3, 0.01), (sampled[2].peak, sampled[2].peak_t), (-4e3, 0.01)]
    end = replace(load, t=2.0)  # at the last sample itself it counts
    monkeypatch.setattr(TrajectoryAnalysis, "crossings", property(lambda _: (end, wild)))
    assert replace(analysis).summary[0].peak_t == 2.0


@pytest.mark.parametrize(
    ("goal", "limit"),
    [
        ((0.3, 0, 0, -0.5), Limit.SINGULAR),
        ((0, 0, 1.6, -0.5), Limit.SINGULAR),
        ((0, 0, 0, -1.2), Limit.STRETCHED),
    ],
)
def test_failing_path_is_nan_exactly_where_status_fails(goal, limit) -> None:
    samples = point_to_point(HOME, goal, 1.0).sample(400)
    found = analyze(ROUGH, samples)
    bad = ~found.check.ok
    assert bad.any()
    assert found.check.first is not None
    assert found.check.first.limit is limit
    rows = [found.torque, found.power, found.solved.speed, found.solved.actuators, found.energy]
    rows += [getattr(found.breakdown, part) for part in PARTS]
    for row in rows:
        np.testing.assert_array_equal(np.isnan(row).reshape(len(bad), -1).any(axis=1), bad)
    # no wild torques before it: the clearance bounds them
    assert np.nanmax(np.abs(found.torque[:, :3])) < 1e3
    until = found.check.until
    assert np.isfinite(found.work[:until]).all()
    assert np.isnan(found.work[until:]).all()
    assert all(s.peak_t <= found.check.first.t for s in found.summary)
    assert np.isfinite(found.energy_residual[:until]).all()


@pytest.mark.parametrize("leg", range(3))
def test_actuator_positions_are_unwrapped(leg: int) -> None:
    """Of a platform that passes behind the leg's axis, where its actuator jumps."""
    axis = np.radians([210.0, -30.0, 90.0])[leg]
    ends = [[0.36 * np.cos(axis + d), 0.36 * np.sin(axis + d), 0.1, -0.4] for d in (-0.2, 0.2)]
    samples = point_to_point(*ends, 1.0).sample(60)
    found = analyze(APPENDIX_4, samples)
    exact = inverse_kinematics(APPENDIX_4.geometry, samples.pose).actuators
    assert np.abs(np.diff(exact[:, leg])).max() > 6.0
    turns = (found.solved.actuators - exact)[:, :3] / (2 * np.pi)
    np.testing.assert_allclose(turns, np.round(turns), atol=1e-12)
    assert np.abs(np.diff(found.solved.actuators, axis=0)).max() < 0.2
    np.testing.assert_array_equal(found.solved.actuators[:, 3], exact[:, 3])


def test_comparison_with_a_reference() -> None:
    samples = point_to_point(A, B, 0.5).sample(200)
    reference = analyze(APPENDIX_4, samples)
    doubled = {p.path: 2 * APPENDIX_4.value(p.path) for p in PARAMETERS if "kg" in p.unit}
    for change in compare(analyze(APPENDIX_4.vary(doubled), samples), reference):
        assert list(vars(change).values()) == pytest.approx([2] * 4)
    pulled = replace(reference, torque=-reference.torque)
    for change in compare(pulled, reference):  # of sizes, whatever their signs
        assert (change.peak, change.rms, change.top_power) == pytest.approx((1.0, 1.0, 1.0))
        assert change.driven >= 0.0
    failing = analyze(APPENDIX_4, point_to_point([1, 0, 0, -0.5], HOME).sample(50))
    assert failing.summary == compare(failing, failing) == ()
    assert np.isnan(failing.energy_residual).all()
    short = analyze(APPENDIX_4.vary({"geometry.guide_stroke": 0.01}), samples)
    assert short.summary == compare(short, reference) == compare(reference, short) == ()
    with pytest.raises(InvalidInput, match="same trajectory"):
        compare(reference, analyze(APPENDIX_4, point_to_point(A, B, 0.5).sample(200)))


def test_running_integral() -> None:
    t = np.cumsum(np.random.default_rng(0).uniform(0.02, 0.04, 60))
    parabola = running_integral(t, 3 * t**2 - t)
    np.testing.assert_allclose(parabola, t**3 - t**2 / 2 - (t[0] ** 3 - t[0] ** 2 / 2), atol=1e-14)
    even = np.linspace(0, 1, 101)
    for steps, error in ((even, 3e-8), (even[::2], 16 * 3e-8)):
        values = np.stack([np.sin(5 * steps), np.cos(3 * steps)], axis=1)
        exact = np.stack([(1 - np.cos(5 * steps)) / 5, np.sin(3 * steps) / 3], axis=1)
        np.testing.assert_allclose(running_integral(steps, values), exact, atol=2 * error)
    np.testing.assert_allclose(running_integral(t[:2], t[:2]), [0, (t[1] ** 2 - t[0] ** 2) / 2])
    np.testing.assert_array_equal(running_integral(t[:1], t[:1]), [0])
    assert rms(even, np.sin(2 * np.pi * even)) == pytest.approx(np.sqrt(0.5), rel=1e-6)
    assert rms(t[:1], np.array([-3.0])) == 3.0
    assert rms(np.array([0.0, 0.5]), np.array([-1.0, 3.0])) == pytest.approx(np.sqrt(5.0))


def test_two_instants_close_together_stand_for_a_jump() -> None:
    """Pieces of steps of their own, as segments of a motion that are joined with a small gap."""
    for gap in (1e-3, 1e-6, 1e-9):
        pieces = np.linspace(0, 0.25, 26), np.linspace(0.25 + gap, 1, 26)
        t = np.concatenate(pieces)
        values = np.concatenate([1 + pieces[0] ** 2, -2 + pieces[1]])
        antiderivative = [t + t**3 / 3, -2 * t + t**2 / 2]
        exact = np.where(t <= 0.25, antiderivative[0], antiderivative[1] + 0.25 + 0.25**3 / 3)
        exact += np.where(t <= 0.25, 0.0, 2 * 0.25 - 0.25**2 / 2)
        np.testing.assert_allclose(running_integral(t, values), exact, atol=4 * gap + 1e-12)
        assert rms(t, values) == pytest.approx(1.30909777, abs=1e-3)
    # where instants come in pairs only trapezia are left
    t = np.concatenate([[0.0, 1e-6], [1.0, 1.0 + 1e-6], [3.0, 3.0 + 1e-6]])
    values = np.array([0.0, 1.0, 1.0, 0.0, 0.0, 2.0])
    flat = np.concatenate([[0], np.cumsum(np.diff(t) * (values[1:] + values[:-1]) / 2)])
    np.testing.assert_allclose(running_integral(t, values), flat, atol=1e-5)


@given(seed=st.integers(0, 999), n=st.integers(2, 9), ratio=st.floats(1.0, 300.0))
def test_time_weights_integrate_lines_exactly_and_are_never_negative(
    seed: int, n: int, ratio: float
) -> None:
    """Also with steps so uneven that all parabolas would make one negative."""
    steps = ratio ** np.random.default_rng(seed).uniform(-1.0, 1.0, n - 1)
    t = 0.3 + np.concatenate([[0.0], np.cumsum(steps)])
    weights = time_weights(t)
    assert (weights >= 0).all()
    assert weights.sum() == pytest.approx(t[-1] - t[0])
    assert weights @ t == pytest.approx((t[-1] ** 2 - t[0] ** 2) / 2)


def test_time_weights_are_those_of_the_integral() -> None:
    rng = np.random.default_rng(5)
    times = [np.array([0.0, 1.0, 3.0])]  # the first weight is zero
    times += [1.0 + np.cumsum(rng.uniform(0.5, 1.0, n)) for n in (1, 2, 3, 4, 5, 8, 20)]
    times += [np.cumsum(10.0 ** rng.uniform(-1.0, 1.0, n)) for n in (3, 6, 13)]
    for t in times:
        whole = running_integral(t, np.eye(len(t)))[-1]
        np.testing.assert_allclose(time_weights(t), whole, atol=1e-14)
    assert running_integral(times[0], np.eye(3))[-1, 0] == 0.0


@given(parts=st.lists(st.floats(-6.0, 6.0), min_size=2, max_size=9))
def test_no_value_counts_negatively_in_an_integral(parts: list[float]) -> None:
    """Steps that differ by up to their twelfth power of ten, and by factors close to two."""
    for steps in (10.0 ** np.array(parts), 2.0 ** np.round(parts)):
        t = np.concatenate([[0.0], np.cumsum(steps)])
        weights = running_integral(t, np.eye(len(t)))[-1]
        assert (weights >= -1e-13 * t[-1]).all()


def test_root_mean_square_does_not_depend_on_when_a_motion_begins() -> None:
    t = np.linspace(0.0, 2.0, 41)
    values = np.stack([np.sin(3 * t), t**2], axis=1)
    np.testing.assert_allclose(rms(t + 7.0, values), rms(t, values), rtol=1e-12)
    assert rms(t, values)[1] == pytest.approx(np.sqrt(16.0 / 5.0), rel=1e-4)
