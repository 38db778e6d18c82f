"""What fonts can change: sizes of texts, what the page says, where a click ends up in the view."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

from paminsa_viz.dimensions.layout import layout
from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.kit.design_numbers import GROUPS
from paminsa_viz.explorer.kit.design_numbers import label as label_of
from paminsa_viz.explorer.tabs import WORKSPACES
from paminsa_viz.model import inverse_kinematics
from tests.support.chromium import Tab, until

pytestmark = pytest.mark.browser

STRIP = """tabs => tabs.map(tab => {
  const text = tab.querySelector("span");
  return {name: tab.title, top: tab.offsetTop, cut: text.scrollWidth > text.clientWidth};
})"""


def test_workspaces_and_their_sections_take_a_row_each_and_none_is_cut(tab: Tab) -> None:
    def one_row(first: str, names: list[str]) -> None:
        row = f'[role="tablist"]:has(> [title="{first}"]) > [role="tab"]'
        found = tab.page.locator(row).evaluate_all(STRIP)
        assert [one["name"] for one in found] == names
        assert len({one["top"] for one in found}) == 1
        assert not any(one["cut"] for one in found)

    for workspace in WORKSPACES:
        names = [section.name for section in workspace.sections]
        tab.open_tab(names[0])
        one_row("Robot", [one.name for one in WORKSPACES])
        for name in names:  # the name of the current one may be wider
            tab.open_tab(name)
            one_row(names[0], names)


def test_numbers_can_be_typed_digit_by_digit(tab: Tab) -> None:
    if tab.page.get_by_test_id("gallery").is_visible():  # another test has opened the folder
        tab.page.get_by_text("File", exact=True).first.click()
    limit = tab.element("κ counts up to")

    def is_seen() -> bool:
        place = limit.bounding_box()
        return bool(place) and place["y"] + place["height"] <= 720

    until(is_seen, "the last input of Pose is seen")
    tab.open_tab("Masses")
    for label, text, path in (
        ("m_B3 bar 4–3–7 [kg]", "12.5", "links.b3"),  # beyond the slider
        ("m_pl platform [kg]", "0.75", "platform.mass"),  # through an impossible 0
        ("m₅ B4, platform [kg]", "0.0625", "joints.j5"),  # finer than the slider
    ):
        field, thumb, number = tab.number_box(label), tab.slider(label), float(text)
        field.click()
        field.press("Control+a")
        field.press_sequentially(text, delay=120)
        field.press("Tab")
        until(lambda p=path, n=number: tab.state.document.design.value(p) == n, path)
        until(
            lambda t=thumb, n=number: float(t.get_attribute("aria-valuemax")) >= n,
            "the slider grows",
        )
        tab.page.wait_for_timeout(200)
        assert field.input_value() == text
        assert tab.state.document.design.value(path) == number


MEASURE = """uuids => uuids.map(uuid => {
  const label = document.querySelector(`label[for="${uuid}"]`);
  const seen = label.parentElement.querySelector(".pv-symbol") ?? label;
  const row = document.getElementById(uuid).parentElement;
  const field = row.querySelector("input:not([type=hidden])");
  const [text, box] = [seen.getBoundingClientRect(), field.getBoundingClientRect()];
  return {height: text.height, right: text.right, left: box.left, end: box.right,
          room: field.clientWidth - field.scrollWidth};
})"""


def test_nothing_is_cut_off(tab: Tab) -> None:
    width = tab.page.viewport_size["width"]
    for name in dict.fromkeys(group.tab for group in GROUPS):
        tab.open_tab(name)
        groups = [group for group in GROUPS if group.tab == name]
        for group in groups:
            if not group.open:  # once what unfolds above it has come to rest
                title = tab.page.get_by_text(group.title, exact=True).last
                tab.steady_box(title)
                title.click()
            labels = [label_of(parameter) for parameter in group.parameters]
            uuids = [tab.handle(label)._impl.uuid for label in labels]

            def unfolded(uuids: list[str] = uuids) -> Any:
                found = tab.page.evaluate(MEASURE, uuids)
                return found if all(row["height"] > 12 for row in found) else None

            for text, row in zip(labels, until(unfolded, group.title), strict=True):
                assert row["height"] < 24, f"{text} takes two lines"
                assert row["right"] < row["left"], f"{text} runs into its number"
                assert row["room"] >= 0, f"the number of {text} is cut off"
                assert row["end"] <= width, f"the number of {text} is off the page"


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
    field = tab.element("κ counts up to")
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
