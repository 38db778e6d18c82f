"""The poses that a motion is built from: a list, the numbers of one of them, buttons."""

from __future__ import annotations

import math
import re
from functools import partial
from typing import Any

from paminsa_viz.explorer.core import motion as motions
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.core.planning import checked_poses
from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.features.motion import points
from paminsa_viz.explorer.kit.entries import Button, ButtonGroup, Entry, Folder, Html, Run
from paminsa_viz.explorer.kit.inputs import Number
from paminsa_viz.explorer.kit.robot_texts import millimeter_decimals
from paminsa_viz.explorer.kit.setting_inputs import layer_switch
from paminsa_viz.explorer.kit.text import render
from paminsa_viz.explorer.state.motion import FARTHEST, Kind, Motion
from paminsa_viz.explorer.state.state import State
from paminsa_viz.units import display_unit, number

SELECT, DRAW = "select-point", "draw-motion"
"""Messages of the page: a row of the list, or the switch below a map, was pressed."""


def _motion(state: State) -> Motion:
    return state.document.motion


def _waypoints(state: State) -> bool:
    return _motion(state).kind is Kind.WAYPOINTS


def _title(state: State) -> str:
    return {Kind.WAYPOINTS: "Waypoints", Kind.CIRCLE: "Center"}.get(_motion(state).kind, "Ends")


def points_html(frame: Frame) -> str:
    """Return the list of poses; the one that is edited is marked, others can be pressed."""
    state = frame.state
    found = points.listed(state)
    reached = checked_poses(state.document.design.geometry, tuple(point.pose for point in found))
    places = millimeter_decimals(state.document.design.geometry)
    rows = []
    for point, reachable in zip(found, reached, strict=True):
        x, y, theta, z = point.pose
        lengths = [number(round(1e3 * value, places), 6) for value in (x, y, z)]
        angle = number(round(math.degrees(theta), 1))
        rows.append({"name": point.name, "values": [*lengths, angle], "reachable": reachable})
    return render("motion/points.j2", rows=rows, selected=points.selected(state), message=SELECT)


def _coordinate(index: int, name: str, label: str, unit: str) -> Number:
    """Return the box of one coordinate of the pose that is edited."""

    def read(state: State) -> float:
        pose = points.selected_pose(state)
        return 0.0 if pose is None else pose[index]

    return Number(
        f"motion.point.{name}", label, unit=display_unit(unit), range=(-FARTHEST, FARTHEST),
        step=1.0, read=read, apply=partial(_put, index),
        hint="Of the pose that is marked in the list",
        visible=lambda state: points.selected_pose(state) is not None,
        disabled=points.theta_is_held if name == "theta" else None,
    )  # fmt: skip


def _put(index: int, state: State, value: float) -> State:
    return points.put_coordinate(state, index, value)


POINTS: tuple[Entry, ...] = (
    Folder(
        "motion.points", _title,
        visible=lambda state: _motion(state).kind in (Kind.WAYPOINTS, Kind.CIRCLE)
        or _motion(state).kind.has_ends,
        entries=(
            Html("motion.points.list", content=points_html),
            _coordinate(0, "x", "x [mm]", "m"),
            _coordinate(1, "y", "y [mm]", "m"),
            _coordinate(3, "z", "z [mm]", "m"),
            _coordinate(2, "theta", "θ [°]", "rad"),
            ButtonGroup(
                "motion.ends", "Robot",
                choices={
                    "From here": motions.start_here,
                    "To here": motions.goal_here,
                    "Swap": motions.swap_ends,
                    "Go there": points.go_there,
                },
                visible=lambda state: _motion(state).kind.has_ends,
                hint="Let the motion start or end at the current pose of the robot, exchange the "
                "ends, or move the robot to the marked one",
            ),
            ButtonGroup(
                "motion.center", "Robot",
                choices={"Center here": motions.center_here, "Go there": points.go_there},
                visible=lambda state: _motion(state).kind is Kind.CIRCLE,
                hint="Put the center at the current pose of the robot, or move the robot there",
            ),
            ButtonGroup(
                "motion.waypoint", "Robot",
                choices={
                    "Add": points.add_waypoint,
                    "Put here": points.put_here,
                    "Go there": points.go_there,
                },
                visible=_waypoints,
                hint="Add the current pose of the robot after the marked waypoint, put the marked "
                "one there, or move the robot to it",
            ),
            ButtonGroup(
                "motion.waypoints", "List",
                choices={
                    "Up": partial(points.shift_waypoint, step=-1),
                    "Down": partial(points.shift_waypoint, step=1),
                    "Remove": points.remove_waypoint,
                    "Clear": points.clear_waypoints,
                },
                visible=lambda state: _waypoints(state) and bool(_motion(state).waypoints),
                hint="Pass the marked waypoint earlier or later, or remove it",
            ),
            layer_switch(
                "motion.points.handle", "points", "Points in scene",
                "The poses in the scene: click one, then drag it by its arrows",
            ),
        ),
    ),
    Button(
        "motion.draw",
        lambda state: "Stop drawing on the maps" if motions.is_drawing(state)
        else "Draw on a map…",
        hint="Each click on a map adds a waypoint, at the map’s θ and z", color="gray",
        effect=Run(
            lambda session: switch_drawing(session, not motions.is_drawing(session.state)),
            at_once=True,
        ),
        undo=False,
    ),
)  # fmt: skip


def receive_row(session: Session, data: Any) -> None:
    """Edit the pose whose row was pressed; ``data`` comes from the page."""
    if isinstance(data, str) and re.fullmatch(r"[0-9]{1,3}", data):
        session.dispatch("motion.point", partial(points.select, index=int(data)), step=False)


MAPS = ("Torque maps", "Single map")
"""Tabs with maps that can be drawn on."""


def switch_drawing(session: Session, on: bool) -> None:
    """Draw a motion on the maps, one of which is opened, or no longer."""

    def show() -> None:
        if on and not (session.open_tabs or frozenset()).intersection(MAPS):
            session.open_tab(MAPS[0])

    session.dispatch(
        "motion.draw", lambda state: points.set_drawing(state, on), step=False, then=show
    )


def receive_switch(session: Session, data: Any) -> None:
    """Draw a motion on the maps, or no longer; ``data`` comes from the page."""
    switch_drawing(session, data == "on")
