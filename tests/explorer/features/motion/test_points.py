"""The poses that a motion is built from: typed, reordered, dragged, drawn on a map."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import viser
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core import motion as motions
from paminsa_viz.explorer.core.frame import compute
from paminsa_viz.explorer.features.motion import points
from paminsa_viz.explorer.features.motion.handles import MotionPoints
from paminsa_viz.explorer.features.motion.point_entries import POINTS, points_html
from paminsa_viz.explorer.scene.context import SceneContext
from paminsa_viz.explorer.state.motion import Kind
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.explorer.state.view import Appearance
from paminsa_viz.model import InvalidInput
from paminsa_viz.model.arrays import Pose
from paminsa_viz.palette import DARK, INK, REFERENCE, rgb
from tests.support.desk import Desk
from tests.support.raw_page import RawPage, eventually

PANEL = POINTS
PLACES = [(0.05, 0.0, 0.1, -0.5), (0.0, 0.06, 0.2, -0.55), (-0.05, -0.02, -0.1, -0.6)]


def waypoints(state: State) -> list[Pose]:
    return list(state.document.motion.waypoints)


@pytest.fixture
def three() -> State:
    """Three waypoints, the last one marked."""
    state = motions.choose_kind(initial_state(), Kind.WAYPOINTS)
    for pose in PLACES:
        state = points.insert(state, pose)
    return state


@pytest.mark.parametrize("kind", [Kind.MOVE, Kind.LINE, Kind.ARCH, Kind.CIRCLE, Kind.WAYPOINTS])
def test_motion_passes_a_point_that_was_put_elsewhere(kind: Kind, three: State) -> None:
    state = motions.choose_kind(three, kind)
    for index in range(len(points.listed(state))):
        state = points.put(points.select(state, index), PLACES[index])
    plan = motions.planned(state).trajectory
    assert plan is not None
    for point in points.listed(state):
        if kind is Kind.CIRCLE:
            away = np.linalg.norm(plan.pose[:, :2] - point.pose[:2], axis=1)
            np.testing.assert_allclose(away, state.document.motion.radius, atol=1e-12)
        else:
            assert np.abs(plan.pose - point.pose).max(axis=1).min() < 1e-4


def test_theta_of_a_line_is_that_of_its_start() -> None:
    state = points.select(motions.choose_kind(initial_state(), Kind.LINE), 1)
    state = points.put(state, PLACES[0])
    assert points.theta_is_held(state)
    assert points.listed(state)[1].pose == (0.05, 0.0, 0.0, -0.5)
    turned = points.put_coordinate(points.select(state, 0), 2, 0.3)
    assert points.listed(turned)[1].pose == (0.05, 0.0, 0.3, -0.5)


@given(st.lists(st.sampled_from(["up", "down", "remove", "add", "mark"]), max_size=12))
def test_list_of_waypoints_is_edited_like_a_list(steps: list[str]) -> None:
    state = motions.choose_kind(initial_state(), Kind.WAYPOINTS)
    for pose in PLACES:
        state = points.insert(state, pose)
    model, at = list(PLACES), 2
    for number, step in enumerate(steps):
        if step == "add":
            new = (0.001 * number, 0.0, 0.0, -0.5)
            state = points.insert(state, new)
            at = min(at + 1, len(model))
            model.insert(at, new)
        elif step == "remove":
            state = points.remove_waypoint(state)
            del model[at : at + 1]
        elif step == "mark" and model:
            state, at = points.select(state, 0), 0
        elif step in ("up", "down") and model:
            to = at + (1 if step == "down" else -1)
            state = points.shift_waypoint(state, to - at)
            if 0 <= to < len(model):
                model[at], model[to] = model[to], model[at]
                at = to
        at = max(min(at, len(model) - 1), 0)
        assert waypoints(state) == model
        assert points.selected(state) == at


def test_a_click_on_a_map_adds_a_waypoint_at_its_theta_and_height(three: State) -> None:
    state = actions.move(three, theta=0.4, z=-0.52)
    moved = points.click_map(state, 0.0301, 0.02)
    assert moved.document.pose == (0.0301, 0.02, 0.4, -0.52)
    assert waypoints(moved) == PLACES
    state = points.set_drawing(points.select(state, 0), True)
    drawn = points.click_map(points.click_map(state, 0.03012, 0.02), -0.01, 9.0)
    assert drawn.document.pose == state.document.pose
    assert waypoints(drawn)[3] == (0.0301, 0.02, 0.4, -0.52)
    assert -1.0 < waypoints(drawn)[4][1] < 1.0  # no farther out than the map shows
    stopped = points.click_map(points.set_drawing(drawn, False), 0.0, 0.0)
    assert len(waypoints(stopped)) == 5


def test_drawing_starts_from_any_motion_and_takes_the_robot_off_it() -> None:
    state = motions.scrub(motions.choose_preset(initial_state(), "circle"), 1.0)
    drawing = points.set_drawing(state, True)
    assert drawing.document.motion.kind is Kind.WAYPOINTS
    assert not drawing.playback.following
    assert drawing.document.pose == state.document.pose
    other = motions.choose_preset(drawing, "circle")
    assert not motions.is_drawing(other)


def test_robot_goes_to_a_point_and_a_point_to_the_robot(three: State) -> None:
    state = points.go_there(points.select(three, 1))
    assert state.last_reachable.pose == PLACES[1]
    state = points.put_here(actions.move(state, x=0.015))
    assert waypoints(state)[1] == (0.015, *PLACES[1][1:])
    with pytest.raises(InvalidInput, match="is there"):
        points.add_waypoint(state)


def test_a_point_that_is_too_far_away_is_refused_with_its_coordinate(three: State) -> None:
    with pytest.raises(InvalidInput, match=r"^y: up to 1000 m or rad .* not -2000"):
        points.put(three, (0.0, -2000.0, 0.0, -0.5))


def test_list_marks_the_edited_point_and_what_is_out_of_reach(three: State) -> None:
    text = points_html(compute(points.put(three, (0.9, 0.0, 0.0, -0.5))))
    rows = text.split("<tr ")[1:]
    assert [('class="pv-chosen"' in row, "out of reach" in row) for row in rows] == [
        (False, False), (False, False), (True, True),
    ]  # fmt: skip
    assert "900" in rows[2]


def test_a_list_without_waypoints_has_no_buttons_that_do_nothing(desk: Desk, three: State) -> None:
    desk.dispatch(lambda _: points.clear_waypoints(three))
    desk.until(lambda: not desk.handle("motion.waypoints").visible)
    for name in ("Put here", "Go there"):
        desk.notices.clear()
        desk.set("motion.waypoint", name)
        desk.noticed("there is none yet; add one first")
    desk.set("motion.waypoint", "Add")
    desk.until(lambda: desk.handle("motion.waypoints").visible)


def test_typed_coordinates_are_of_the_marked_point(desk: Desk, three: State) -> None:
    desk.dispatch(lambda _: points.select(three, 1))
    desk.until(lambda: desk.handle("motion.point.y").value == 60.0)
    for name, value in {"x": 33.5, "y": -7.25, "z": -500.5, "theta": 12.5}.items():
        desk.set(f"motion.point.{name}", value)
    wanted = (0.0335, -0.00725, math.radians(12.5), -0.5005)
    desk.until(lambda: np.allclose(waypoints(desk.state)[1], wanted, atol=1e-12))
    assert waypoints(desk.state)[::2] == PLACES[::2]
    desk.set("motion.waypoints", "Up")
    desk.until(lambda: waypoints(desk.state)[1] == PLACES[0])
    desk.dispatch(lambda s: motions.choose_kind(s, Kind.LINE))
    desk.dispatch(lambda s: points.select(s, 1))
    desk.until(lambda: desk.handle("motion.point.theta").disabled)


def test_handle_in_the_scene_drags_the_marked_point(
    server: viser.ViserServer, three: State
) -> None:
    page = RawPage(server)
    dispatched: list[Any] = []
    scene = page.client.scene
    view = MotionPoints(SceneContext(scene, lambda _, action, **options: dispatched.append(action)))
    view.draw(compute(three), False)
    nodes = scene._handle_from_node_name
    assert [nodes[f"/points/{i}"].visible for i in range(3)] == [True] * 3
    colors = [nodes[f"/points/{i}"].color for i in range(3)]
    assert colors == [rgb(INK), rgb(INK), rgb(REFERENCE)]
    view.draw(compute(replace(three, appearance=Appearance.DARK)), False)
    colors = [nodes[f"/points/{i}"].color for i in range(3)]
    assert colors == [rgb(DARK.ink), rgb(DARK.ink), rgb(DARK.reference)]
    np.testing.assert_allclose(nodes["/point_handle"].position, (-0.05, -0.02, -0.6))
    pose: dict[str, Any] = {
        "wxyz": (math.cos(0.2), 0.0, 0.0, math.sin(0.2)),
        "position": (0.02, 0.01, -0.5),
    }
    pose["owner"] = str(page.client.client_id)
    page.send({"type": "TransformControlsUpdateMessage", "name": "/point_handle", **pose})
    eventually(lambda: dispatched)
    state = dispatched[-1](three)
    np.testing.assert_allclose(waypoints(state)[2], (0.02, 0.01, 0.4, -0.5), atol=1e-6)
    assert waypoints(state)[:2] == PLACES[:2]
    view.draw(compute(motions.play(state)), True)
    assert not nodes["/point_handle"].visible
    turn = motions.change(
        motions.choose_kind(state, Kind.MOVE), start=PLACES[0], goal=(0.05, 0.0, 1.0, -0.5)
    )
    view.draw(compute(turn), False)
    names = [nodes[key].text for key in nodes if key.startswith("/point_names/")]
    assert names == [", ".join(point.name for point in points.listed(turn))]
    view.draw(compute(motions.choose_preset(state, "circle")), False)
    assert not any(f"/points/{i}" in nodes for i in range(3))
    page.socket.close()
