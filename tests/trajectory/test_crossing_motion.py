"""Motions through a singularity: the check, samples at the crossing, simulation, other robots."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from paminsa_viz.model import (
    APPENDIX_4,
    Design,
    InvalidInput,
    actuator_velocity,
    check_reach,
    escape_twist,
    friction_torque,
    inverse_dynamics,
    inverse_jacobian,
    mass_matrix,
    platform_wrench,
    singular_radius,
    singular_rotation,
)
from paminsa_viz.model.reach import Limit
from paminsa_viz.trajectory import (
    SINGULAR_CLEARANCE,
    Controller,
    ControlMode,
    ImpossibleTrajectory,
    MotionLimits,
    TrajectoryAnalysis,
    analyze,
    payload_drift,
    point_to_point,
    simulate,
    unplanned_torque,
)
from paminsa_viz.trajectory.check import check_path
from paminsa_viz.trajectory.crossing import crossing_condition, locus_distances
from paminsa_viz.trajectory.crossing_measures import crossing_loads
from paminsa_viz.trajectory.paths import Path, straight_path
from paminsa_viz.trajectory.sampled import Locus, Passage, Trajectory
from tests.trajectory.crossings import BALANCED, LINE, TEN, TURN, shortest
from tests.trajectory.plans import FRICTION


@pytest.mark.slow
def test_a_sample_at_the_crossing_moves_off_it() -> None:
    plan = shortest(BALANCED, TURN, TEN).plan
    (passage,) = plan.passages
    at = passage.t * plan.duration
    middle = replace(plan, passages=(Passage(0.5, passage.locus),))
    count = 2 * round(50.0 * plan.duration)  # even, so that one would be in the middle
    off = middle.sample(count / plan.duration).t - 0.5 * plan.duration
    assert off[np.abs(off).argmin()] == pytest.approx(1e-6, rel=1e-3)  # after it
    quick = replace(middle, duration=1e-4).sample(5e5)  # in steps of 2 µs, a fourth of one
    assert quick.t[25] - 0.5e-4 == pytest.approx(0.5e-6, rel=1e-6)
    assert (np.diff(quick.t) > 1e-6).all()
    counts = np.arange(2_000, 20_000)
    shares = counts * passage.t
    fine = plan.sample(counts[np.abs(shares - np.rint(shares)).argmin()] / plan.duration)
    assert np.abs(fine.t - at).min() == pytest.approx(1e-6, rel=1e-3)
    near = fine.take(np.flatnonzero(np.abs(fine.t - at) < 1e-2))
    assert np.isfinite(analyze(BALANCED, near).torque).all()


@pytest.mark.slow
def test_the_simulated_robot_follows_through_the_crossing() -> None:
    samples = shortest(BALANCED, TURN, TEN).plan.sample(5000.0)
    controller = Controller(ControlMode.FEED_FORWARD)
    result = simulate(BALANCED, samples, controller=controller)
    assert result.stopped is None
    assert np.abs(result.pose - result.wanted.pose).max() < 1e-5


@pytest.mark.slow
@pytest.mark.parametrize("design", [APPENDIX_4, BALANCED], ids=["Appendix 4", "balanced"])
def test_mujoco_follows_the_feed_forward_through_the_crossing(design: Design) -> None:
    pytest.importorskip("mujoco")
    from paminsa_viz.engines.mujoco_model import play

    samples = shortest(design, TURN, TEN).plan.sample(10_010.0)
    torque = analyze(design, samples).torque
    played = play(design, samples.t, samples.pose, samples.velocity, torque, step=1e-4)
    assert played.until == samples.size
    # MuJoCo's integrator takes the speed at the end of a step: the pose is half a step ahead.
    ahead = 0.5 * np.diff(samples.t).mean() * samples.velocity
    assert np.abs(played.drift - ahead).max() < 5e-6


@pytest.mark.slow
def test_the_drift_is_that_of_a_robot_with_another_payload() -> None:
    """Left alone, the heavier robot accelerates along the escape twist as the drift says."""
    found = shortest(BALANCED, LINE, TEN)
    (crossing,), (drift,) = found.crossings, payload_drift(BALANCED, found, 0.3)
    heavier = BALANCED.vary({"payload.mass": 0.3})
    twist, state = np.array(crossing.condition.twist), found.plan.at(crossing.t)
    wanted = platform_wrench(BALANCED, *state)
    rest = platform_wrench(heavier, *state) - mass_matrix(heavier, state.pose) @ state.acceleration
    off = twist @ (wanted - rest) / drift.inertia  # no actuator acts along the twist
    planned = twist @ mass_matrix(heavier, state.pose) @ state.acceleration / drift.inertia
    assert drift.shift[2] == pytest.approx(0.5 * (off - planned) * drift.time**2, rel=1e-9)
    assert payload_drift(BALANCED, found, 0.0)[0].shift == pytest.approx((0, 0, 0, 0), abs=1e-12)


@pytest.mark.slow
def test_an_unknown_payload_drifts_for_the_time_that_the_motion_is_near_the_locus() -> None:
    """Also where it comes to rest there, much longer than at the speed of the crossing."""
    ending = straight_path(LINE.start, LINE(np.array(0.63)))
    for path in (LINE, ending):
        found = shortest(BALANCED, path, TEN)
        t = np.linspace(0.0, found.plan.duration, 20_001)
        distance = np.abs(locus_distances(BALANCED.geometry, found.plan.at(t).pose)[:, 0])
        near = np.mean(distance < SINGULAR_CLEARANCE) * found.plan.duration
        (drift,) = payload_drift(BALANCED, found, 0.3)
        assert drift.time == pytest.approx(near, rel=2e-3)
    assert distance[-1] < SINGULAR_CLEARANCE
    none = payload_drift(BALANCED, found, 0.3, clearance=0.0)[0].time
    assert none == pytest.approx(0.0, abs=1e-12)


def test_the_torque_without_the_condition_grows_with_the_rate() -> None:
    found = shortest(APPENDIX_4, TURN, TEN)
    (crossing,), duration = found.crossings, found.plan.duration
    assert unplanned_torque(crossing, duration, 1e6) > 100 * unplanned_torque(crossing, duration)
    naive = point_to_point(TURN.start, TURN.goal, duration)
    s = naive.at(np.linspace(0.0, duration, 100_001)).pose[:, 2]
    at = np.interp(crossing.crossing.pose[2], s, np.linspace(0.0, duration, 100_001))
    torque = inverse_dynamics(APPENDIX_4, *naive.at(at - 5e-6)).torque
    expected = unplanned_torque(crossing, duration, 1e5)
    assert np.abs(torque[:3]).max() == pytest.approx(expected, rel=1e-2)


def test_the_peak_at_a_crossing_is_the_limit_torque(monkeypatch: pytest.MonkeyPatch) -> None:
    found = shortest(BALANCED, LINE, TEN)
    (crossing,) = found.crossings
    samples = found.plan.sample(1000.0)
    analysis = analyze(BALANCED, samples)
    (load,) = analysis.crossings
    assert load.torque == pytest.approx(crossing.torque, abs=1e-3)
    assert abs(load.residual) < 1e-6
    assert not analysis.unbounded
    assert all(abs(one.peak) < 50.0 for one in analysis.summary[:3])
    beyond = (replace(load, torque=(50.0, -60.0, 1.0, 2.0)),)
    monkeypatch.setattr(TrajectoryAnalysis, "crossings", property(lambda _: beyond))
    peaks = [(one.peak, one.peak_t) for one in analyze(BALANCED, samples).summary[:2]]
    assert peaks == [(50.0, load.t), (-60.0, load.t)]


@pytest.mark.slow
def test_what_a_plan_needs_at_a_crossing_does_not_depend_on_the_rate() -> None:
    """Its law changes more than once between samples beside the crossing."""
    quick = shortest(BALANCED, TURN, MotionLimits(torque=20.0))
    (crossing,) = quick.crossings
    for rate in (300.0, 1000.0, 1100.0, 7000.0):
        analysis = analyze(BALANCED, quick.plan.sample(rate))
        assert not analysis.unbounded
        assert analysis.failure is None
        (load,) = analysis.crossings
        assert abs(load.residual) < 1e-8
        assert load.torque == pytest.approx(crossing.torque, abs=1e-4)


def test_a_motion_that_is_moved_has_its_crossings_moved() -> None:
    samples = shortest(BALANCED, TURN, TEN).plan.sample(20_000.0)
    shift = np.array([0.0, 0.0, 0.0, 0.02])  # a singular rotation has no height
    moved = samples.moved(shift)
    np.testing.assert_array_equal(moved.pose, samples.pose + shift)
    (passage,), (before,) = moved.passages, samples.passages
    assert passage.states is not None
    assert before.states is not None
    np.testing.assert_array_equal(passage.states.pose, before.states.pose + shift)
    np.testing.assert_array_equal(passage.states.acceleration, before.states.acceleration)
    again = replace(moved, passages=(Passage(passage.t, passage.locus),))  # from the samples
    (found,), (expected,) = (crossing_loads(APPENDIX_4, one) for one in (moved, again))
    assert found.residual == pytest.approx(expected.residual, rel=1e-4)
    assert found.torque == pytest.approx(expected.torque, rel=1e-2)
    assert found.residual != crossing_loads(APPENDIX_4, samples)[0].residual
    without = replace(samples, passages=()).moved(shift)
    assert without.passages == ()


def test_another_robot_on_a_planned_crossing_needs_torques_without_bound() -> None:
    samples = shortest(BALANCED, LINE, TEN).plan.sample(1000.0)
    for design in (APPENDIX_4, BALANCED.vary({"payload.mass": 0.1})):
        analysis = analyze(design, samples)
        (load,) = analysis.unbounded
        assert load.excess > 5.0
        assert analysis.check.possible  # the path alone
        assert analysis.failure is not None
        assert (analysis.failure.t, analysis.failure.limit) == (load.t, Limit.SINGULAR)
        assert f"crosses the {load.locus.label}" in analysis.failure.explanation
        with pytest.raises(ImpossibleTrajectory, match="no bound"):
            analysis.require()
        step = samples.t[1] - samples.t[0]
        beside = samples.at(load.t + 0.01 * np.array([-0.5, 0.5]) * step)
        torque = inverse_dynamics(design, *beside).torque
        # in proportion to 1/t, beside the torque in the limit
        jump = 0.01 * np.diff(torque[:, :3], axis=0) / 2
        assert load.excess == pytest.approx(np.abs(jump).max(), rel=1e-3)
        np.testing.assert_allclose(
            torque.mean(axis=0), load.torque, atol=1e-3 * np.abs(torque).max()
        )


def test_planned_crossings_that_the_robot_does_not_make_have_no_load() -> None:
    """A locus that is missed, a pose without an escape twist, and poses out of reach beside it."""
    geometry = APPENDIX_4.geometry
    radius = float(singular_radius(geometry, 0.0))

    def motion(x: float, z: float) -> Trajectory:
        poses = np.array([[x - 0.01, 0.0, 0.0, -0.5], [x + 0.01, 0.0, 0.0, -0.5 + z]])
        still = np.zeros_like(poses)
        return Trajectory([0.0, 1.0], poses, still, still, passages=(Passage(0.5, Locus.CIRCLE),))

    assert len(crossing_loads(APPENDIX_4, motion(radius, 0.0))) == 1
    assert crossing_loads(APPENDIX_4, motion(radius + 0.002, 0.0)) == ()
    assert crossing_loads(APPENDIX_4, motion(radius, 0.6)) == ()
    equal = replace(geometry, platform_radius=geometry.base_radius)
    point = replace(APPENDIX_4, geometry=equal)  # at theta = 0 the circle is a point
    assert crossing_loads(point, motion(0.0, 0.0)) == ()
    path = straight_path([-0.1, 0.0, 0.0, -0.5], [0.1, 0.0, 0.0, -0.5])
    with pytest.raises(InvalidInput, match=r"not at a type-2 singularity at s = 0\.5"):
        crossing_condition(point, path, 0.5)


@pytest.mark.parametrize(("path", "planned"), [(TURN, 1), (LINE, 0)], ids=["turn", "line"])
def test_the_closest_limit_is_none_that_is_crossed_as_planned(path: Path, planned: int) -> None:
    samples = shortest(BALANCED, path, TEN).plan.sample(500.0)
    geometry = BALANCED.geometry
    closest = check_path(geometry, samples).closest
    x, y, theta, _ = samples.pose.T
    circle = np.abs(singular_radius(geometry, theta) - np.hypot(x, y))
    turn = geometry.platform_radius * np.abs(singular_rotation(geometry) - np.abs(theta))
    other = (turn, circle)[planned] - SINGULAR_CLEARANCE
    reach = check_reach(geometry, samples.pose).margins.reshape(samples.size, -1).min(axis=1)
    row = np.argmin(np.minimum(other, reach))
    assert closest.margin == pytest.approx(min(other[row], reach[row]), rel=1e-9)
    assert closest.t == samples.t[row]


def test_friction_adds_to_the_torques_at_a_crossing_as_anywhere() -> None:
    samples = shortest(BALANCED, LINE, TEN).plan.sample(1000.0)
    rough = BALANCED.vary(FRICTION)
    (plain,), (sticky,) = (analyze(one, samples).crossings for one in (BALANCED, rough))
    velocity = samples.at(plain.t)
    speed = actuator_velocity(BALANCED, velocity.pose, velocity.velocity)
    expected = friction_torque(rough.friction, speed)
    np.testing.assert_allclose(np.subtract(sticky.torque, plain.torque), expected, rtol=1e-3)
    assert sticky.residual == plain.residual


@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize("push", [40.0, -40.0])
def test_what_a_residual_needs_is_that_of_half_a_step_of_the_samples_around_it(
    way: float, push: float
) -> None:
    """In either direction, with a residual of either sign; in the first step, and in the last."""
    design = APPENDIX_4.vary({"load.force_y": push})
    radius = float(singular_radius(design.geometry, 0.3))
    t = np.array([0.0, 0.1, 0.4, 1.0])
    rate = np.array([0.02 * way, 0.0, 0.0, 0.0])
    sizes = []
    for at, step in ((0.0, 0.1), (0.05, 0.1), (0.25, 0.3), (0.7, 0.6), (np.nextafter(1, 2), 0.6)):
        poses = np.array([radius, 0.0, 0.3, -0.5]) + (t - min(at, 1.0))[:, None] * rate
        speeds = np.tile(rate, (4, 1))
        motion = Trajectory(t, poses, speeds, 0 * speeds, passages=(Passage(at, Locus.CIRCLE),))
        (load,) = crossing_loads(design, motion)
        # t_s^T dG^T n / dt by differences of the determinant's own matrix
        pose, h = poses[0] + (min(at, 1.0) - t[0]) * rate, 1e-6
        g, ahead, behind = (
            inverse_jacobian(design.geometry, pose + k * h * rate) for k in (0, 1, -1)
        )
        null = np.linalg.svd(g.T)[2][-1]
        twist = escape_twist(design.geometry, pose)
        growth = np.abs(null).max() / abs(twist @ (ahead - behind).T @ null / (2.0 * h))
        force = platform_wrench(design, pose, rate, 0 * rate)
        assert load.residual == pytest.approx(float(twist @ force), rel=1e-9)
        assert load.excess == pytest.approx(abs(load.residual) * growth / (0.5 * step), rel=1e-6)
        sizes.append(load.residual)
    assert np.ptp(sizes) < 1e-9
    assert abs(sizes[0]) > 0.1


def test_torques_without_the_condition_are_sizes() -> None:
    found = shortest(APPENDIX_4, TURN, TEN)
    (item,), duration = found.crossings, found.plan.duration
    c = item.condition
    size = unplanned_torque(item, duration)
    for sign, other in ((1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)):
        turned = replace(
            c, a=sign * c.a, b=sign * c.b, c=sign * c.c, growth=tuple(other * g for g in c.growth)
        )
        assert unplanned_torque(replace(item, condition=turned), duration) == pytest.approx(size)
