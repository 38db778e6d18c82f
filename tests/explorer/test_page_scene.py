"""What is done with the mouse in the 3D view, in a real browser."""

from __future__ import annotations

import numpy as np
import pytest

from paminsa_viz.explorer import actions
from paminsa_viz.meshes.layout import layout
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


def on_screen(tab: Tab, node: str, place: tuple[float, float, float]) -> list[float]:
    """Return where a point of a scene node's own frame is on the page [px]."""
    return until(lambda: tab.page.evaluate(ON_SCREEN, [node, list(place)]), f"{node} is there")


FRAMES = "() => window.__viserMutable.scene.__r3f.root.getState().gl.info.render.frame"


def test_without_a_graphics_card_a_change_takes_few_pictures(tab: Tab) -> None:
    tab.page.wait_for_selector("html.paminsa-render-on-demand", state="attached")

    def at_rest() -> bool:
        start = tab.page.evaluate(FRAMES)
        tab.wait_frames(1000)
        return tab.page.evaluate(FRAMES) - start <= 1

    until(at_rest, "the page, still being built, stops drawing")
    before = tab.page.evaluate(FRAMES)
    tab.session.dispatch("test", lambda s: actions.move(s, x=0.07))
    until(lambda: tab.place("/robot/platform")[0] == pytest.approx(0.07), "the robot moves")
    tab.wait_frames(1000)
    # The robot, the mark on the floor, a late one, one a second; viser alone draws twelve.
    assert 1 <= tab.page.evaluate(FRAMES) - before <= 9


def test_the_handle_drags_the_platform(tab: Tab) -> None:
    tab.session.dispatch("test", lambda s: actions.set_layers(s, gizmo=True))
    until(lambda: tab.place("/gizmo"), "the handle is there")
    tab.wait_frames(600)
    start = np.array(tab.state.standing.pose)
    # Along the arrow of x, by its own length on the screen.
    (x0, y0), (x1, y1) = (on_screen(tab, "/gizmo", (way, 0.0, 0.0)) for way in (0.13, 0.19))
    tab.page.mouse.move(x0, y0)
    tab.wait_frames(200)
    tab.page.mouse.down()
    for part in np.linspace(0.2, 1.0, 5):
        tab.page.mouse.move(x0 + part * (x1 - x0), y0 + part * (y1 - y0))
        tab.wait_frames(80)
    tab.page.mouse.up()
    until(lambda: tab.state.standing.pose[0] > start[0] + 0.04, "the platform follows the handle")
    tab.wait_frames(400)
    pose = np.array(tab.state.standing.pose)
    assert pose[0] == pytest.approx(start[0] + 0.06, abs=0.015)
    np.testing.assert_allclose(pose[1:], start[1:], atol=1e-4)
    until(
        lambda: abs(tab.handle("x  [mm]").value - 1e3 * tab.state.document.pose[0]) < 1e-3,
        "the slider is in step",
    )
    until(
        lambda: np.allclose(tab.place("/robot/platform")[:2], pose[:2], atol=1e-6),
        "the platform stands where the handle was left",
    )


def test_a_click_on_the_floor_map_goes_there(tab: Tab) -> None:
    geometry = tab.state.document.design.geometry
    ground = layout(geometry).ground
    goal = (0.12, -0.16)
    tab.wait_frames(600)
    x, y = on_screen(tab, "/robot/base", (*goal, ground))
    tab.page.mouse.click(x, y)
    until(
        lambda: np.allclose(tab.state.standing.pose[:2], goal, atol=0.01),
        f"the robot goes to {goal}; it is at {tab.state.standing.pose}",
        timeout=15,
    )
