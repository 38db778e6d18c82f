"""What a person can ask of a motion, each as a pure function from state to state."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from paminsa_viz.explorer.core import planning
from paminsa_viz.explorer.core.actions import change_document, with_document
from paminsa_viz.explorer.core.planning import Planned
from paminsa_viz.explorer.state.motion import (
    Kind,
    Pose,
    Timing,
    advanced,
    require_possible,
    started,
)
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model import InvalidInput
from paminsa_viz.trajectory import PRESET, Trajectory


def planned(state: State) -> Planned:
    """Return the trajectory of a state."""
    document = state.document
    return planning.planned(document.motion, document.design)


def no_motion(state: State) -> InvalidInput:
    """Return the error that there is no motion, under the name of what is wrong with it."""
    found = planned(state)
    return InvalidInput(found.argument, found.problem.removeprefix(f"{found.argument}: "))


def duration(state: State) -> float:
    """Return how long the motion lasts [s], 0 if there is none."""
    trajectory = planned(state).trajectory
    return 0.0 if trajectory is None else trajectory.duration


def change(state: State, **changes: Any) -> State:
    """Change the description of the motion; the path is shown from then on.

    Raises:
        InvalidInput: If a number is out of its range.
    """
    motion = replace(state.document.motion, **changes)
    require_possible(motion)
    changed = change_document(state, motion=motion)
    return changed if motion == state.document.motion else _with_path(changed)


def choose_preset(state: State, key: str) -> State:
    """Choose a preset, in its own duration unless a shortest one is chosen.

    Raises:
        InvalidInput: If there is no preset with this key.
    """
    if key not in PRESET:
        raise InvalidInput("motion", f"one of {', '.join(PRESET)} is needed")
    motion = state.document.motion
    timing = motion.timing if motion.timing.keeps_limits else Timing.OWN
    return from_start(change(state, kind=Kind.PRESET, preset=key, timing=timing, back=False))


def is_drawing(state: State) -> bool:
    """Whether a click on a map adds a waypoint."""
    return state.point_editing.drawing and state.document.motion.kind is Kind.WAYPOINTS


def choose_kind(state: State, kind: Kind) -> State:
    """Choose to build a motion; the poses it is built from are shown."""
    timing = state.document.motion.timing
    timing = Timing.GIVEN if timing is Timing.OWN else timing
    state = replace(state, layers=state.layers | {"points"})
    return from_start(change(state, kind=kind, timing=timing))


def from_start(state: State) -> State:
    """Show the start of the motion, if the robot is on it."""
    return show_time(state, 0.0)


def limit(state: State, name: str, value: float) -> State:
    """Set a limit of the shortest duration, 0 for none."""
    limits = replace(state.document.motion.limits, **{name: value or None})
    return change(state, limits=limits)


def current_pose(state: State) -> Pose:
    """Return the pose of the robot, to the micrometer; theta as it is."""
    x, y, theta, z = state.last_reachable.pose
    return (round(x, 6) + 0.0, round(y, 6) + 0.0, theta, round(z, 6) + 0.0)


def start_here(state: State) -> State:
    """Let the motion from pose to pose begin at the robot's pose."""
    _, goal = _ends(state)
    return change(state, start=current_pose(state), goal=goal)


def goal_here(state: State) -> State:
    """Let the motion from pose to pose end at the robot's pose."""
    start, _ = _ends(state)
    return change(state, start=start, goal=current_pose(state))


def _ends(state: State) -> tuple[Pose, Pose]:
    document = state.document
    return planning.ends(document.motion, document.design.geometry)


def swap_ends(state: State) -> State:
    """Let the motion from pose to pose run in the other direction."""
    start, goal = _ends(state)
    return change(state, start=goal, goal=start)


def center_here(state: State) -> State:
    """Put the circle's center at the robot's pose."""
    return change(state, center=current_pose(state))


def use_table(state: State, table: Trajectory) -> State:
    """Run the samples of a file."""
    return from_start(change(state, kind=Kind.TABLE, table=table))


def show_time(state: State, time: float) -> State:
    """Show another instant; the robot goes there if it follows the motion."""
    moved = state.updated("playback", time=time)
    return with_document(moved, moved.document)


def scrub(state: State, time: float) -> State:
    """Go to an instant of the motion [s], and let the robot go there; playing stops.

    Raises:
        InvalidInput: If the time is not finite.
    """
    if not math.isfinite(time):
        raise InvalidInput("time", "a finite time is needed")
    time = min(max(time, 0.0), duration(state))
    stopped = state.updated("playback", playing=False, following=True)
    return show_time(_with_path(stopped), time)


def show_piece(state: State, piece: tuple[float, float] | None) -> State:
    """Mark a piece of the motion's time (from, to) [s] wherever the motion is seen; None: none."""
    return state if state.playback.piece == piece else state.updated("playback", piece=piece)


def play(state: State) -> State:
    """Play the motion on, from its start if it is at its end.

    Raises:
        InvalidInput: If there is no motion.
    """
    found = planned(state)
    if found.trajectory is None:
        raise no_motion(state)
    playback = started(state.playback, found.trajectory.duration)
    return show_time(_with_path(replace(state, playback=playback)), playback.time)


def _with_path(state: State) -> State:
    return replace(state, layers=state.layers | {"path"})


def pause(state: State) -> State:
    """Stop playing where the motion is."""
    return state.updated("playback", playing=False)


def play_or_pause(state: State) -> State:
    """Play, or stop playing."""
    return pause(state) if state.playback.playing else play(state)


def advance_time(state: State, passed: float) -> State:
    """Let true time pass [s]."""
    if not state.playback.playing:
        return state
    playback = advanced(state.playback, passed, duration(state))
    return show_time(replace(state, playback=playback), playback.time)
