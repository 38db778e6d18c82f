"""What the page says of the pose, and the 3D view: its frames, clicks and drags in it."""

from __future__ import annotations

import re

import numpy as np
import pytest

from paminsa_viz.dimensions.layout import layout
from paminsa_viz.explorer.core import actions
from paminsa_viz.model import inverse_kinematics
from tests.support.chromium import Tab, until

pytestmark = pytest.mark.browser

SOME_TABS = ["Pose", "Masses", "Balance", "Path", "Logs"]
OPACITY = "element => +getComputedStyle(element.closest('.pv-stale') ?? element).opacity"


def gray(tab: Tab, test_id: str) -> bool:
    """Whether a readout is grayed."""
    return tab.page.get_by_test_id(test_id).evaluate(OPACITY) < 1


def test_numbers_of_the_last_reachable_pose_are_gray_and_say_which_it_is(tab: Tab) -> None:
    assert not gray(tab, "actuators")
    tab.dispatch(lambda s: actions.move(actions.move(s, x=0.05, theta=0.2), x=0.4, z=-2.0))
    until(lambda: "Unreachable" in tab.text("status"), "the status")
    place = tab.text("at-pose")
    assert place.startswith("Last reachable pose")
    assert [float(n.replace("−", "-")) for n in re.findall(r"−?[\d.]+", place)] == [
        50.0, 0.0, pytest.approx(np.degrees(0.2), abs=0.05), -552.0,
    ]  # fmt: skip
    for test_id in ("actuators", "summary", "quality"):
        assert gray(tab, test_id)
    tab.dispatch(actions.go_home)
    until(lambda: not gray(tab, "actuators"), "numbers of this pose")
    assert tab.text("at-pose").startswith("Pose (")


def test_a_pose_line_that_is_too_long_is_cut_and_does_not_widen_the_panel(tab: Tab) -> None:
    tab.dispatch(lambda s: actions.vary(
        actions.move(s, x=-0.1, y=-0.1, theta=-0.5), {"geometry.guide_stroke": 0.01},
    ))  # fmt: skip
    until(lambda: "pose and lengths (−100.0" in tab.text("at-pose"), "the pose before")
    line = tab.page.get_by_test_id("at-pose")
    assert line.evaluate("line => line.scrollWidth > line.clientWidth")
    panel = "line => line.closest('.mantine-ScrollArea-viewport')"
    assert line.evaluate(f"line => ({panel})(line).scrollWidth <= ({panel})(line).clientWidth")
    assert line.get_attribute("title") == tab.text("at-pose")  # all of it


def test_design_that_reaches_nothing_is_said_on_every_tab_and_keeps_the_sliders(tab: Tab) -> None:
    before = [tab.slider(f"{name}  [mm]").get_attribute("aria-valuemax") for name in "xyz"]
    tab.dispatch(lambda s: actions.vary(s, {"geometry.guide_stroke": 0.01}))
    for name in SOME_TABS:
        tab.open_tab(name)
        until(lambda: tab.page.get_by_text("Unreachable").first.is_visible(), f"a warning: {name}")
        assert gray(tab, "actuators")
    assert "pose and lengths" in tab.text("at-pose")
    tab.open_tab("Pose")
    after = [tab.slider(f"{name}  [mm]").get_attribute("aria-valuemax") for name in "xyz"]
    assert after[:2] == before[:2]
    assert float(after[2]) > float(tab.slider("z  [mm]").get_attribute("aria-valuemin"))


def test_pose_next_to_a_singularity_is_warned_of_and_the_limit_can_be_set(tab: Tab) -> None:
    tab.dispatch(lambda s: actions.move(s, x=0.215, y=0.175, theta=np.pi / 3))
    until(lambda: "Near a singularity" in tab.text("status"), "the status")
    assert "κ = 67.5 > 10" in tab.text("status")
    assert "35 mm from the singular circle" in tab.text("status")
    field = tab.element("Largest condition number")
    field.click()
    field.press_sequentially("70")
    field.press("Enter")
    until(lambda: "Reachable" in tab.text("status"), "the limit is set")
    assert tab.state.condition_limit == 70


def test_pose_beyond_the_circle_says_that_a_singularity_lies_between(tab: Tab) -> None:
    tab.dispatch(
        lambda s: actions.move(s, x=0.3, theta=np.radians(-20)).updated("", condition_limit=1e6)
    )
    until(lambda: "Beyond a singularity" in tab.text("status"), "the status")
    assert "the singular circle lies between this pose and home" in tab.text("status")
    level = tab.page.get_by_test_id("status").get_attribute("class") or ""
    assert "pv-warn" in level


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


def test_camera_fits_a_robot_that_became_much_larger(tab: Tab) -> None:
    tab.wait_frames(600)
    before = tab.session.camera[1]
    tab.dispatch(lambda s: actions.vary(s, {"geometry.base_radius": 0.7}))
    until(lambda: np.linalg.norm(tab.session.camera[1]) > 1.2 * np.linalg.norm(before), "it fits")
    tab.session.undo()
    until(lambda: np.allclose(tab.session.camera[1], before, atol=3e-3), "it fits as before")


def test_click_on_the_floor_map_moves_the_robot_there(tab: Tab) -> None:
    goal = (0.12, -0.16)
    ground = layout(tab.state.document.design.geometry).ground
    tab.wait_frames(600)
    tab.page.mouse.click(*on_screen(tab, "/robot/base", (*goal, ground)))
    until(
        lambda: np.allclose(tab.state.last_reachable.pose[:2], goal, atol=0.01),
        lambda: f"the robot moves to {goal}; it is at {tab.state.last_reachable.pose}",
    )


def test_click_on_a_bar_opens_the_inspector_and_esc_closes_it(tab: Tab) -> None:
    panel = tab.page.get_by_test_id("inspector-part")
    tab.wait_frames(600)
    last = tab.state.last_reachable
    points = inverse_kinematics(last.geometry, last.pose).points
    middle = (points[9][1] + points[5][1]) / 2
    tab.page.mouse.click(*on_screen(tab, "/robot", middle))
    tab.page.get_by_test_id("inspector-title").get_by_text("B4 leg 2").wait_for()
    panel.locator("[data-paminsa-value='links.b4']").click()
    focused = "() => document.activeElement.getAttribute('aria-label') ?? ''"
    until(lambda: "bar 9" in tab.page.evaluate(focused), "the number of the mass has the focus")
    tab.page.keyboard.type("0.7")
    tab.page.keyboard.press("Enter")
    until(lambda: tab.state.document.design.links.b4 == 0.7, "the mass")
    panel.get_by_text("0.7 kg").wait_for()
    panel.locator("[data-paminsa-value='elastic.b4_outer']").click()  # its folder is shut
    until(
        lambda: "B4 outer" in tab.page.evaluate(focused), "the number in the folder has the focus"
    )
    assert tab.page.evaluate("() => document.activeElement.checkVisibility()")
    panel.get_by_role("button", name="map this").click()
    until(lambda: tab.state.map_view.quantity == "utilization", "the map")
    tab.page.locator("body").click(position={"x": 640, "y": 715})
    tab.page.keyboard.press("Escape")
    until(lambda: tab.state.inspected is None, "Esc closes it")
    panel.wait_for(state="hidden")


def test_folded_panels_leave_the_view_its_colors_and_its_legend(tab: Tab) -> None:
    looks = """() => [
      getComputedStyle(document.querySelector("canvas[data-engine]")).backgroundImage,
      getComputedStyle(document.querySelector(".pv-legend")).position,
    ]"""
    before = tab.page.evaluate(looks)
    assert "gradient" in before[0]
    for _ in range(2):
        tab.page.get_by_role("button", name="Collapse panel area").first.click()
    status = tab.page.get_by_test_id("status")
    until(lambda: status.count() == 0, "both panels are folded")
    assert tab.page.evaluate(looks) == before
    for _ in range(2):
        tab.page.get_by_role("button", name="Expand column").first.click()
    until(lambda: status.count() == 1, "they are back")
