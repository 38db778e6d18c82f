"""Actions on the poses that a motion is built from: chosen, typed, dragged, drawn on a map."""

from __future__ import annotations

from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core.maps import go_to, on_map
from paminsa_viz.explorer.core.motion import change, choose_kind, current_pose, is_drawing
from paminsa_viz.explorer.core.planning import THETA, Point, points, with_point
from paminsa_viz.explorer.state.motion import Kind
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model import InvalidInput
from paminsa_viz.model.arrays import Pose


def listed(state: State) -> tuple[Point, ...]:
    """Return the poses that the motion is built from."""
    document = state.document
    return points(document.motion, document.design.geometry)


def selected(state: State) -> int:
    """Return the place of the pose that is edited; 0 where there is none."""
    return max(min(state.point_editing.selected, len(listed(state)) - 1), 0)


def selected_pose(state: State) -> Pose | None:
    """Return the pose that is edited, or None where there is none."""
    found = listed(state)
    return found[selected(state)].pose if found else None


def _required_pose(state: State) -> Pose:
    """Return the pose that is edited.

    Raises:
        InvalidInput: If there is none.
    """
    pose = selected_pose(state)
    if pose is None:
        raise InvalidInput("waypoint", "there is none yet; add one first")
    return pose


def theta_is_held(state: State) -> bool:
    """Whether the pose that is edited has the start's theta, as the end of a line has."""
    return state.document.motion.kind is Kind.LINE and selected(state) == 1


def select(state: State, index: int) -> State:
    """Edit another pose.

    Raises:
        InvalidInput: If there is no such pose.
    """
    if not 0 <= index < len(listed(state)):
        raise InvalidInput("waypoint", f"1 to {len(listed(state))} is possible, not {index + 1}")
    return state.updated("point_editing", selected=index)


def put(state: State, pose: Pose) -> State:
    """Put the pose that is edited elsewhere.

    Raises:
        InvalidInput: If there is none, or the new one is too far away.
    """
    before = _required_pose(state)
    if theta_is_held(state):
        pose = (*pose[:THETA], before[THETA], pose[3])
    document = state.document
    changes = with_point(document.motion, document.design.geometry, selected(state), pose)
    return change(state, **changes)


def put_coordinate(state: State, index: int, value: float) -> State:
    """Set one coordinate of the pose that is edited [m, or rad]."""
    pose = list(selected_pose(state) or current_pose(state))
    pose[index] = value
    return put(state, (pose[0], pose[1], pose[2], pose[3]))


def put_here(state: State) -> State:
    """Put the pose that is edited where the robot is.

    Raises:
        InvalidInput: If there is none.
    """
    return put(state, current_pose(state))


def go_there(state: State) -> State:
    """Move the robot to the pose that is edited.

    Raises:
        InvalidInput: If there is none.
    """
    return actions.move_to(state, _required_pose(state))


def add_waypoint(state: State) -> State:
    """Add the pose of the robot after the waypoint that is edited.

    Raises:
        InvalidInput: If it is that one again, or there are too many.
    """
    return insert(state, current_pose(state))


def insert(state: State, pose: Pose) -> State:
    """Add a pose after the waypoint that is edited, and edit the new one.

    Raises:
        InvalidInput: If it is that one again, or there are too many.
    """
    way, after = state.document.motion.waypoints, selected(state)
    if way and way[after] == pose:
        raise InvalidInput("waypoints", f"waypoint {after + 1} is there; choose another pose")
    place = after + 1 if way else 0
    added = change(state, waypoints=(*way[:place], pose, *way[place:]))
    return select(added, place)


def remove_waypoint(state: State) -> State:
    """Remove the waypoint that is edited."""
    way, index = state.document.motion.waypoints, selected(state)
    removed = change(state, waypoints=(*way[:index], *way[index + 1 :]))
    return removed.updated("point_editing", selected=index)


def clear_waypoints(state: State) -> State:
    """Remove all waypoints."""
    return change(state, waypoints=()).updated("point_editing", selected=0)


def shift_waypoint(state: State, step: int) -> State:
    """Let the waypoint that is edited be passed earlier (-1) or later (1); not beyond the ends."""
    way, index = list(state.document.motion.waypoints), selected(state)
    to = min(max(index + step, 0), len(way) - 1)
    if to == index or not way:
        return state
    way.insert(to, way.pop(index))
    return select(change(state, waypoints=tuple(way)), to)


def set_drawing(state: State, drawing: bool) -> State:
    """Let clicks on the maps add waypoints, or move the robot again.

    The robot leaves its motion, so that theta and z of the maps stay.
    """
    if drawing:
        state = actions.stop_following(state)
        if state.document.motion.kind is not Kind.WAYPOINTS:
            state = choose_kind(state, Kind.WAYPOINTS)
        state = state.updated("point_editing", selected=len(state.document.motion.waypoints) - 1)
    return state.updated("point_editing", drawing=drawing)


def click_map(state: State, x: float, y: float) -> State:
    """Add a waypoint at a place of a map [m], at the map's theta and z; or move the robot there.

    Raises:
        InvalidInput: If there are too many waypoints, or it is the last one again.
    """
    if not is_drawing(state):
        return go_to(state, x, y)
    _, _, theta, z = state.document.pose
    x, y = on_map(state, x, y)
    return insert(state, (x, y, theta, z))
