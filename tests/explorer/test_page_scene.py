"""The 3D view in a browser: rendering on demand, the handle, clicks on the floor."""

from __future__ import annotations

import numpy as np
import pytest

from paminsa_viz.dimensions.layout import layout
from paminsa_viz.explorer import actions
from tests.support.chromium import Tab, until

pytestmark = pytest.mark.browser

ON_SCREEN = """([name, place]) => {
  const viewer = window.__viserMutable;
  const node = viewer.nodeRefFromName[name];
  if (!node) return null;
  node.updateWorldMatrix(true, false);
  viewer.camera.updateMatrixWorld();
  const point = node.localToWorld(node.position.clone().set(...place)).project(viewer.camera);
  const box = viewer.canvas.getBoundingClientRect();
  return [box.left + (1 + point.x) / 2 * box.width, box.top + (1 - point.y) / 2 * box.height];
}"""

FRAMES = "() => window.__viserMutable.scene.__r3f.root.getState().gl.info.render.frame"


def on_screen(tab: Tab, node: str, place: tuple[float, float, float]) -> np.ndarray:
    """Return where a point of a scene node's own frame is on the page [px]."""
    return np.array(until(lambda: tab.page.evaluate(ON_SCREEN, [node, list(place)]), node))


def test_page_without_a_graphics_card_renders_few_frames(tab: Tab) -> None:
    tab.page.wait_for_selector("html.paminsa-render-on-demand", state="attached")

    def idle() -> bool:
        start = tab.page.evaluate(FRAMES)
        tab.wait_frames(1000)
        return tab.page.evaluate(FRAMES) - start <= 1

    until(idle, "the page, still being built, stops drawing")
    before = tab.page.evaluate(FRAMES)
    tab.dispatch(lambda s: actions.move(s, x=0.07))
    until(lambda: tab.platform()[0] == pytest.approx(0.07), "the robot moves")
    tab.wait_frames(1000)
    # The robot, the mark on the floor, a late one, one a second; viser alone draws twelve.
    assert 1 <= tab.page.evaluate(FRAMES) - before <= 9


def test_handle_drags_the_platform(tab: Tab) -> None:
    tab.dispatch(lambda s: actions.set_layers(s, gizmo=True))
    until(lambda: tab.place("/gizmo"), "the handle is there")
    tab.wait_frames(600)
    start = np.array(tab.state.last_reachable.pose)
    # Along the arrow of x, by its own length on the screen.
    tip, goal = (on_screen(tab, "/gizmo", (x, 0.0, 0.0)) for x in (0.13, 0.19))
    tab.page.mouse.move(*tip)
    tab.wait_frames(200)
    tab.page.mouse.down()
    for part in np.linspace(0.2, 1.0, 5):
        tab.page.mouse.move(*(tip + part * (goal - tip)))
        tab.wait_frames(80)
    tab.page.mouse.up()
    until(
        lambda: tab.state.last_reachable.pose[0] > start[0] + 0.04,
        "the platform follows the handle",
    )
    tab.wait_frames(400)
    pose = np.array(tab.state.last_reachable.pose)
    assert pose[0] == pytest.approx(start[0] + 0.06, abs=0.015)
    np.testing.assert_allclose(pose[1:], start[1:], atol=1e-4)
    x = tab.handle("x  [mm]")
    until(lambda: abs(x.value - 1e3 * tab.state.document.pose[0]) < 1e-3, "the slider follows")
    tab.wait_platform()


def test_click_on_the_floor_map_moves_the_robot_there(tab: Tab) -> None:
    goal = (0.12, -0.16)
    ground = layout(tab.state.document.design.geometry).ground
    tab.wait_frames(600)
    tab.page.mouse.click(*on_screen(tab, "/robot/base", (*goal, ground)))
    until(
        lambda: np.allclose(tab.state.last_reachable.pose[:2], goal, atol=0.01),
        f"the robot moves to {goal}; it is at {tab.state.last_reachable.pose}",
        timeout=15,
    )


def test_folded_panels_leave_the_view_its_colors_and_its_legend(tab: Tab) -> None:
    looks = """() => [
      getComputedStyle(document.querySelector("canvas[data-engine]")).backgroundColor,
      getComputedStyle(document.querySelector(".pv-legend")).position,
    ]"""
    before = tab.page.evaluate(looks)
    assert before[0] != "rgba(0, 0, 0, 0)"
    for _ in range(2):
        tab.page.get_by_role("button", name="Collapse panel area").first.click()
    status = tab.page.get_by_test_id("status")
    until(lambda: status.count() == 0, "both panels are folded")
    assert tab.page.evaluate(looks) == before
    for _ in range(2):
        tab.page.get_by_role("button", name="Expand column").first.click()
    until(lambda: status.count() == 1, "they are back")
