"""Motions under a load, constant or varying with time: torques, energy, simulation, engines."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from paminsa_viz.errors import InvalidInput
from paminsa_viz.model import APPENDIX_4, LoadCase, LoadFrame, inverse_dynamics
from paminsa_viz.model.load import NO_LOAD
from paminsa_viz.trajectory import (
    PRESET,
    Controller,
    ControlMode,
    MotionLimits,
    Plan,
    analyze,
    from_samples,
    shortest_stretch,
    simulate,
)
from tests.trajectory.plans import FRICTION, preset_plan

PUSH = LoadCase(40.0, -25.0, -60.0, 5.0, -4.0, 3.0, 0.05, -0.08, 0.02)
FRAMES = pytest.mark.parametrize("frame", LoadFrame)
PLAN = preset_plan(PRESET["paper-like"])


def loaded(frame: LoadFrame):
    return replace(APPENDIX_4.vary(FRICTION), load=replace(PUSH, frame=frame))


def motion(rate: float = 300.0, plan: Plan = PLAN):
    """A move of all coordinates with a load that swings."""
    t = plan.sample(rate)
    phase = 2 * np.pi * t.t[:, None] / t.duration + np.arange(6)
    return replace(t, load=np.sin(phase) * [30.0, 30.0, 50.0, 5.0, 5.0, 4.0])


@FRAMES
def test_torques_and_their_parts(frame: LoadFrame) -> None:
    design, path = loaded(frame), motion()
    analysis = analyze(design, path)
    states = path.pose, path.velocity, path.acceleration
    expected = inverse_dynamics(design, *states, load=path.load).torque
    np.testing.assert_allclose(analysis.torque, expected, rtol=1e-10, atol=1e-9)
    np.testing.assert_allclose(analysis.breakdown.total, expected, rtol=1e-10, atol=1e-9)
    plain = analyze(replace(design, load=NO_LOAD), replace(path, load=None))
    parts, bare = analysis.breakdown, plain.breakdown
    for name in ("gravity", "inertial", "velocity", "friction"):
        np.testing.assert_allclose(getattr(parts, name), getattr(bare, name), rtol=0, atol=1e-11)
    assert not bare.load.any()
    for load, own in ((design.load, None), (NO_LOAD, path.load)):  # one of the two alone
        one = replace(design, load=load)
        found = analyze(one, replace(path, load=own)).torque
        expected = inverse_dynamics(one, *states, load=own).torque
        np.testing.assert_allclose(found, expected, rtol=1e-10, atol=1e-9)
    again = analyze(loaded(frame).vary({"load.force_x": 1.0}), path, keep=analysis.solved)
    assert again.solved.jacobian is analysis.solved.jacobian  # a slider solves nothing again


@FRAMES
def test_the_energy_balances(frame: LoadFrame) -> None:
    analysis = analyze(loaded(frame), motion(4000))
    size = np.abs(analysis.work).max()
    assert np.abs(analysis.energy_residual).max() < 1e-4 * size
    wrong = analyze(replace(loaded(frame), load=NO_LOAD), motion(4000))
    assert np.abs(wrong.torque - analysis.torque).max() > 1.0


@pytest.mark.slow
@FRAMES
def test_a_simulated_robot_holds_against_the_load(frame: LoadFrame) -> None:
    design, path = loaded(frame), motion()
    found = simulate(design, path, controller=Controller(ControlMode.COMPUTED_TORQUE))
    assert found.stopped is None
    assert found.distance.max() < 1e-6
    assert np.abs(found.energy_drift).max() < 1e-6 * np.abs(found.work).max()
    assert np.abs(found.push).max() > 0.1


@pytest.mark.slow
def test_feedback_alone_gives_way_to_a_load_that_it_does_not_know() -> None:
    design = loaded(LoadFrame.WORLD)
    naive = simulate(design, motion(), model=replace(design, load=NO_LOAD))
    assert naive.distance.max() > 1e-3


@FRAMES
def test_shortest_duration_counts_the_load(frame: LoadFrame) -> None:
    limits = MotionLimits(torque=30.0, force=800.0)
    for design in (loaded(frame), replace(loaded(frame), load=NO_LOAD)):
        quick = shortest_stretch(PLAN, limits, design)
        torque = np.abs(analyze(design, quick.plan.sample(4000)).torque) / limits.actuators
        assert 0.99 < torque.max() < 1.0 + 1e-6


def test_loads_follow_their_samples() -> None:
    path = motion()
    halved = path.resampled(100.0)
    assert halved.load is not None
    assert path.load is not None
    np.testing.assert_allclose(halved.load[-1], path.load[-1])
    np.testing.assert_allclose(path.load_at(path.t), path.load)
    np.testing.assert_array_equal(path.take(np.array([0, 7])).load, path.load[[0, 7]])
    again = from_samples(path.t, path.pose, path.velocity, path.acceleration, load=path.load)
    np.testing.assert_array_equal(again.load, path.load)
    for wrong in (path.load[1:], path.load[:, :4], path.load * np.nan):
        with pytest.raises(InvalidInput, match="load"):
            replace(path, load=wrong)


@pytest.mark.slow
def test_engines_have_the_motions_load() -> None:
    from paminsa_viz.engines.verification import verify

    design = replace(loaded(LoadFrame.PLATFORM), name="loaded")
    found = verify(design, motion(100, PLAN.lasting(0.5)), poses=20, misprints=())
    assert found.worst < 1e-10
    assert found.played.until == found.wanted.size or found.played.until > 10
