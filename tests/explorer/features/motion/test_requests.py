"""Actions on motions: choice, playback, poses, limits, refusals."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core import motion as motions
from paminsa_viz.explorer.core.actions import change_document
from paminsa_viz.explorer.core.frame import compute
from paminsa_viz.explorer.core.planning import checked
from paminsa_viz.explorer.features.motion import points, simulation, tab
from paminsa_viz.explorer.features.motion.crossing import crossing_html
from paminsa_viz.explorer.features.motion.tab import MOTION, status_line
from paminsa_viz.explorer.features.pose.tab import status_html
from paminsa_viz.explorer.state.motion import (
    MOST_SAMPLES,
    MOST_WAYPOINTS,
    SPEEDS,
    Kind,
    Playback,
    Timing,
    advanced,
    motion_data,
    motion_from_data,
    started,
)
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.model import APPENDIX_4, Drive, InvalidInput, KneeBranch
from paminsa_viz.trajectory import (
    PRESETS,
    Locus,
    MotionLimits,
    Profile,
    Trajectory,
    analyze,
    from_samples,
)
from tests.explorer.features.motion.engine_motions import analyzed, caption


def shows_crossings(state: State) -> Any:
    """Whether the folder on the singularities passed is seen."""
    folder = next(entry for entry in MOTION if getattr(entry, "key", "") == "motion.crossing")
    return folder.visible is not None and folder.visible(state)


def trajectory(state: State) -> Trajectory:
    found = motions.planned(state).trajectory
    assert found is not None
    return found


@pytest.fixture
def failing() -> State:
    """A line that leaves through the singular circle."""
    state = motions.choose_kind(initial_state(), Kind.LINE)
    return motions.change(state, start=(0.0, 0.0, 0.0, -0.55), goal=(0.6, 0.0, 0.0, -0.55))


@pytest.mark.parametrize("key", [preset.key for preset in PRESETS])
@pytest.mark.parametrize("knee", KneeBranch)
def test_robot_is_at_the_pose_of_the_chosen_instant(key: str, knee: KneeBranch) -> None:
    state = motions.choose_preset(actions.set_knee(initial_state(), knee), key)
    motion = trajectory(state)
    for share in (0.0, 0.31, 0.77, 1.0):
        state = motions.scrub(state, share * motion.duration)
        np.testing.assert_array_equal(
            state.last_reachable.pose, motion.at(state.playback.time).pose
        )
        assert state.document.pose == state.last_reachable.pose


def test_playing_no_motion_says_once_what_is_missing() -> None:
    state = motions.choose_kind(initial_state(), Kind.WAYPOINTS)
    with pytest.raises(InvalidInput) as caught:
        motions.play(state)
    assert str(caught.value) == "waypoints: two or more are needed; move the robot and add them"


def test_choice_of_a_motion_shows_its_path_and_does_not_move_the_robot() -> None:
    start = initial_state()
    chosen = motions.choose_preset(start, "circle")
    assert chosen.layers - start.layers == {"path"}
    assert chosen.last_reachable == start.last_reachable


def test_moving_the_robot_stops_the_motion() -> None:
    state = motions.play(initial_state())
    assert state.playback.following
    moved = actions.move(state, x=0.02)
    assert not moved.playback.following
    assert not moved.playback.playing
    assert moved.last_reachable.pose[0] == 0.02
    later = actions.vary(moved, {"geometry.platform_radius": 0.11})
    assert later.last_reachable.pose[0] == 0.02


def test_robot_follows_the_motion_through_changes() -> None:
    state = motions.scrub(initial_state(), 0.6)
    state = actions.vary(state, {"geometry.base_radius": 0.4})
    np.testing.assert_array_equal(state.last_reachable.pose, trajectory(state).at(0.6).pose)
    assert state.last_reachable.geometry == state.document.design.geometry
    state = motions.change(state, back=True)
    np.testing.assert_array_equal(state.last_reachable.pose, trajectory(state).at(0.6).pose)


def test_failing_instants_do_not_move_the_robot(failing: State) -> None:
    motion = trajectory(failing)
    fine = motions.scrub(failing, 0.2 * motion.duration)
    assert fine.last_reachable.pose[0] > 0.01
    gone = motions.scrub(fine, motion.duration)
    assert gone.playback.time == motion.duration
    assert gone.last_reachable == fine.last_reachable
    assert gone.document == fine.document


def test_time_is_limited_to_a_shortened_motion() -> None:
    state = motions.scrub(motions.choose_preset(initial_state(), "circle"), 2.9)
    short = motions.change(state, timing=Timing.GIVEN, duration=0.8)
    assert short.playback.time == trajectory(short).duration
    np.testing.assert_allclose(short.last_reachable.pose, trajectory(short).pose[-1], atol=1e-15)


def test_time_is_limited_to_the_shorter_motion_that_undo_or_a_code_brings_back() -> None:
    before = initial_state()
    late = motions.scrub(motions.choose_preset(before, "circle"), 2.9)
    assert late.playback.time > (end := trajectory(before).duration)
    back = actions.restore(late, before.document)
    assert back.playback.time == end
    assert back.document == before.document


def test_playback_runs_in_true_time_and_stops_at_the_end() -> None:
    state = motions.advance_time(motions.play(initial_state()), 0.25)
    assert state.playback.time == 0.25
    np.testing.assert_array_equal(state.last_reachable.pose, trajectory(state).at(0.25).pose)
    end = motions.advance_time(state, 100.0)
    assert not end.playback.playing
    np.testing.assert_array_equal(end.last_reachable.pose, trajectory(end).pose[-1])
    again = motions.play(end)
    assert again.playback.time == 0.0
    assert motions.advance_time(motions.pause(again), 1.0) == motions.pause(again)


@given(
    st.floats(0, 10), st.floats(0, 100), st.floats(0.01, 10), st.sampled_from(SPEEDS), st.booleans()
)
def test_time_is_always_within_the_motion(
    time: float, passed: float, duration: float, speed: float, loop: bool
) -> None:
    start = started(Playback(time=time, speed=speed, loop=loop), duration)
    after = advanced(start, passed, duration)
    assert 0 <= after.time <= duration
    assert after.playing == (loop or start.time + passed * speed < duration)


def test_ends_and_center_are_taken_from_the_robot() -> None:
    state = motions.choose_kind(initial_state(), Kind.MOVE)
    state = motions.start_here(actions.move(state, x=-0.07, theta=0.3))
    state = motions.goal_here(actions.move(state, x=0.08, y=0.02))
    ends = trajectory(state).pose[[0, -1]]
    np.testing.assert_allclose(ends[:, :3], [[-0.07, 0.0, 0.3], [0.08, 0.02, 0.3]], atol=1e-9)
    swapped = trajectory(motions.swap_ends(state)).pose[[0, -1]]
    np.testing.assert_allclose(swapped, ends[::-1], atol=1e-9)
    circle = motions.center_here(motions.choose_kind(state, Kind.CIRCLE))
    np.testing.assert_allclose(trajectory(circle).pose[0], [0.18, 0.02, 0.3, -0.552], atol=1e-3)


def test_motion_passes_its_waypoints() -> None:
    state = motions.choose_kind(initial_state(), Kind.WAYPOINTS)
    assert "two" in motions.planned(state).problem
    poses = []
    for x, y in ((0.05, 0.0), (0.0, 0.06), (-0.05, -0.02)):
        state = points.add_waypoint(actions.move(state, x=x, y=y))
        poses.append(state.last_reachable.pose)
    motion = trajectory(state)
    for pose in poses:
        assert np.abs(motion.pose - pose).max(axis=1).min() < 1e-4
    with pytest.raises(InvalidInput, match="is there"):
        points.add_waypoint(state)
    assert len(points.remove_waypoint(state).document.motion.waypoints) == 2
    assert motions.change(state, waypoints=()).document.motion.waypoints == ()


@pytest.mark.slow
@pytest.mark.parametrize("profile", Profile)
def test_shortest_duration_keeps_its_limits(profile: Profile) -> None:
    state = motions.choose_kind(initial_state(), Kind.MOVE)
    state = motions.change(state, profile=profile, timing=Timing.SHORTEST)
    state = motions.limit(motions.limit(state, "torque", 4.0), "jerk", 0.0)
    assert state.document.motion.limits.jerk is None
    assert "reaches" in motions.planned(state).bound
    motion = trajectory(state)
    assert np.linalg.norm(motion.velocity[:, [0, 1, 3]], axis=1).max() <= 1.0 + 1e-9
    assert trajectory(motions.limit(state, "speed", 0.1)).duration > motion.duration


def test_impossible_durations_are_explained(failing: State) -> None:
    hopeless = motions.change(failing, timing=Timing.SHORTEST)
    assert "cannot run" in motions.planned(hopeless).bound
    assert trajectory(hopeless).duration == hopeless.document.motion.duration
    weak = motions.choose_preset(motions.limit(hopeless, "force", 10.0), "circle")
    assert "no duration" in motions.planned(weak).problem
    # A trapezoid's acceleration jumps.
    jerky = motions.choose_kind(motions.limit(weak, "jerk", 5.0), Kind.MOVE)
    jerky = motions.change(jerky, profile=Profile.TRAPEZOID, start=None, goal=None)
    assert "jerk" in motions.planned(jerky).problem


@pytest.mark.parametrize(
    "changes",
    [
        {"duration": 0.0}, {"duration": 1e4}, {"radius": 0.0}, {"height": -0.1}, {"rate": 1.0},
        {"waypoints": ((0.0,) * 4,) * (MOST_WAYPOINTS + 1)},
    ],
    ids=lambda changes: str(changes)[:24],
)  # fmt: skip
def test_impossible_numbers_are_refused(changes: dict[str, Any]) -> None:
    with pytest.raises(InvalidInput, match=r"is possible|at most"):
        motions.change(initial_state(), **changes)


def test_long_motions_are_sampled_less_often() -> None:
    state = motions.change(initial_state(), timing=Timing.GIVEN, duration=600.0)
    assert MOST_SAMPLES - 2 <= trajectory(state).size <= MOST_SAMPLES


def test_table_is_run_at_its_own_poses() -> None:
    t = np.linspace(0.0, 2.0, 201)
    pose = np.stack([0.05 * np.sin(t), 0.03 * t, 0.1 * t, -0.5 - 0.02 * t], axis=1)
    state = motions.use_table(initial_state(), from_samples(t, pose, name="mine"))
    assert trajectory(state).name == "mine"
    np.testing.assert_allclose(trajectory(state).pose[::10], pose, atol=1e-12)


def test_masses_do_not_change_the_trajectory() -> None:
    state = motions.choose_preset(initial_state(), "circle")
    assert trajectory(actions.vary(state, {"links.b4": 2.0})) is trajectory(state)


def test_one_simulation_runs_at_a_time() -> None:
    state = simulation.simulate(initial_state())
    assert state.plots.plot == "errors"
    with pytest.raises(InvalidInput, match="still runs"):
        simulation.simulate(state)
    with pytest.raises(InvalidInput, match="none to simulate"):
        simulation.simulate(motions.choose_kind(initial_state(), Kind.WAYPOINTS))


def test_undo_stops_following_the_motion() -> None:
    before = initial_state()
    played = motions.advance_time(motions.play(before), 0.4)
    back = actions.restore(played, before.document)
    assert not back.playback.playing
    assert replace(back, playback=Playback(), layers=before.layers) == before


@pytest.fixture
def turning() -> State:
    """A turn through the singular rotation."""
    state = motions.choose_kind(initial_state(), Kind.MOVE)
    state = motions.limit(state, "torque", 10.0)
    ends = {"start": (0.03, 0.02, 0.8, -0.5), "goal": (0.03, 0.02, 1.75, -0.5)}
    return motions.change(state, timing=Timing.SHORTEST, **ends)


@pytest.mark.slow
def test_motion_passes_singularities_on_request(turning: State) -> None:
    assert not checked(trajectory(turning), turning.document.design.geometry).possible
    state = motions.change(turning, cross=True)
    assert not motions.planned(state).problem
    assert trajectory(state).duration == pytest.approx(0.372, abs=1e-3)
    assert checked(trajectory(state), state.document.design.geometry).possible
    there = motions.scrub(state, 0.37)
    assert compute(there).barriers == (Locus.ROTATION,)
    assert "singular rotation lies between" in status_html(compute(there))
    assert not compute(motions.scrub(state, 0.0)).barriers
    assert shows_crossings(state)
    other = actions.pin_reference(actions.vary(state, {"links.b4": 0.9}))
    beside = actions.vary(other, {"links.b4": APPENDIX_4.links.b4})
    assert "the reference <b>fails</b> at 0.1794 s: torques" in caption(analyzed(beside), beside)
    text = crossing_html(compute(state))
    assert "<th>singular rotation</th>" in text
    assert re.search(r"<td>At</td>\s*<td>0.1794 s</td>", text)
    assert re.search(r"<td>Quintic law</td>\s*<td>631 N·m</td>", text)
    longer = motions.change(state, timing=Timing.GIVEN, duration=1.0)
    assert trajectory(longer).duration == pytest.approx(1.0, rel=1e-6)
    heavier = actions.vary(state, {"links.b4": 0.9})
    assert trajectory(heavier).duration != trajectory(state).duration
    assert "Friction" not in text
    rubbing = actions.vary(state, {"friction.coulomb_rotary": 3.0})
    assert "it adds up to 3 N·m to M1 to M3" in crossing_html(compute(rubbing))


@pytest.mark.slow
def test_refusal_to_pass_a_singularity_is_the_problem(turning: State) -> None:
    state = motions.limit(motions.change(turning, cross=True), "torque", 5.0)
    assert "times as large" in motions.planned(state).problem
    assert crossing_html(compute(state)) == ""
    assert not shows_crossings(state)
    ok, line = status_line(state, analyze(state.document.design, trajectory(state)))
    assert not ok
    assert "times as large" in line


@pytest.mark.slow
def test_limits_are_offered_where_another_one_could_help(turning: State) -> None:
    def offered(state: State) -> bool:
        text = tab.status_html(compute(state))
        assert "Not possible" in text
        return "Change the limits" in text

    assert not offered(turning)  # its path meets the singular rotation, whatever the limits are
    assert offered(motions.limit(motions.change(turning, cross=True), "torque", 0.5))
    weak = motions.limit(motions.change(turning, goal=(0.1, 0.02, 0.8, -0.5)), "force", 100.0)
    assert offered(weak)
    long = motions.change(turning, cross=True, timing=Timing.GIVEN, duration=30.0)
    assert not offered(long)  # another duration would help
    singular = float(
        np.arccos(APPENDIX_4.geometry.platform_radius / APPENDIX_4.geometry.base_radius)
    )
    end = motions.change(turning, cross=True, goal=(0.03, 0.02, singular, -0.5))
    assert not offered(end)  # no torque holds it there
    free = replace(weak.document.motion, limits=MotionLimits(torque=100.0))
    feeble = replace(APPENDIX_4, drives=(Drive(peak_torque=1e-3), None, None, None))
    driven = change_document(weak, motion=free, design=feeble)
    assert not offered(driven)  # its drive is too weak
    assert "by its drive" in motions.planned(driven).problem


@pytest.mark.slow
def test_the_limit_that_stands_in_the_way_is_named(turning: State) -> None:
    def named(state: State, **limits: float) -> str:
        found = replace(state.document.motion, limits=MotionLimits(**limits))
        planned = motions.planned(change_document(state, motion=found))
        assert planned.problem
        assert planned.to_change in {"", *limits, "torque"}
        return planned.to_change

    through = motions.change(turning, cross=True)
    assert named(through, torque=0.5) == "torque"
    assert named(through, torque=100.0, force=1.0) == "force"
    assert named(through, speed=1.0) == "torque"  # one of the actuators is needed
    assert named(through, torque=1000.0, turn_speed=0.1) == "turn_speed"
    around = motions.change(turning, goal=(0.1, 0.02, 0.8, -0.5))
    assert named(around) == "torque"  # nothing is limited
    jumping = motions.change(around, profile=Profile.TRAPEZOID)
    assert named(jumping, jerk=10.0) == "jerk"
    assert named(jumping, turn_jerk=10.0) == "turn_jerk"


@pytest.mark.slow
def test_a_motion_that_may_pass_singularities_is_saved(turning: State) -> None:
    motion = motions.change(turning, cross=True, deviation=0.01).document.motion
    assert motion_from_data(motion_data(motion)) == motion
    with pytest.raises(InvalidInput):
        motions.change(turning, deviation=1.0)
