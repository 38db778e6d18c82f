"""The page as a whole: what lies over a map, saving, undo, reloads, docks, a lost server."""

from __future__ import annotations

import json
import math
import re
import socket
import time
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.explorer.browser.bridge import STORE_KEY
from paminsa_viz.explorer.core import actions, motion
from paminsa_viz.explorer.features.synthesis.actions import SEARCH
from paminsa_viz.explorer.state.state import State
from paminsa_viz.explorer.state.view import Docks
from paminsa_viz.explorer.tabs import add_tabs
from paminsa_viz.model import APPENDIX_4, static_torques
from paminsa_viz.units import number
from tests.support.chromium import Tab, until

pytestmark = pytest.mark.browser

OVER_THE_MAP = """() => {
  const place = document.querySelector('[data-paminsa-slot="torques"]').parentElement.parentElement;
  const map = place.querySelector("[data-paminsa-picture]").getBoundingClientRect();
  const cover = document.createElement("button");
  cover.id = "cover";
  Object.assign(cover.style, {position: "fixed", zIndex: 900, left: `${map.left}px`,
    top: `${map.top}px`, width: `${map.width}px`, height: `${map.height}px`, opacity: 0.2});
  document.body.append(cover);
  return [map.left + 0.25 * map.width, map.top + 0.25 * map.height];
}"""


def test_click_on_what_lies_over_a_map_moves_nothing_and_one_on_the_map_does(tab: Tab) -> None:
    tab.page.locator("[data-paminsa-picture][src]").first.wait_for()
    tab.wait_frames(500)
    before = tab.state.document.pose
    place = tab.page.evaluate(OVER_THE_MAP)
    tab.page.mouse.click(*place)
    tab.wait_frames(500)
    assert tab.state.document.pose == before
    tab.page.evaluate("document.getElementById('cover').remove()")
    tab.page.mouse.click(*place)
    until(lambda: tab.state.document.pose != before, "the robot goes where the map is clicked")


def test_value_of_a_map_is_written_at_the_pointer_and_follows_the_angle(tab: Tab) -> None:
    picture = tab.page.locator("[data-paminsa-picture][src]").first
    picture.wait_for()
    box = tab.steady_box(picture)
    readout = tab.page.get_by_test_id("map-readout")
    at = box["x"] + 0.32 * box["width"], box["y"] + 0.25 * box["height"]
    tab.page.mouse.move(*at)
    design = tab.state.document.design
    for theta in (0.0, 0.3):  # the pointer rests where it is
        tab.dispatch(lambda state, theta=theta: actions.move(state, theta=theta))
        readout.get_by_text(f"θ = {number(np.degrees(theta))}°").wait_for()
        text = readout.inner_text().replace("−", "-")
        torque, x, y, angle, z = map(float, re.findall(r" = (-?[\d.]+)", text))
        assert math.radians(angle) == pytest.approx(theta, abs=1e-3)
        # The shown place is rounded to 0.1 mm, which a torque feels.
        nearby = [(x + i, y + j) for i in (-0.05, 0.05) for j in (-0.05, 0.05)]
        poses = [(1e-3 * u, 1e-3 * v, theta, 1e-3 * z) for u, v in nearby]
        found = static_torques(design, poses)[:, 0]
        rounding = 5e-4 * abs(torque)
        assert found.min() - rounding <= torque <= found.max() + rounding
    tab.page.mouse.move(at[0] + 4, at[1])
    assert readout.bounding_box()["x"] > at[0] + 4
    tab.page.mouse.move(box["x"] + box["width"] + 200, at[1])
    readout.wait_for(state="detached")


def test_tab_that_is_opened_by_hand_stays_open(tab: Tab) -> None:
    maps = tab.page.get_by_role("tab", name="Torque maps", exact=True)
    for _ in range(3):
        tab.page.evaluate("window.paminsa.openTab('Answer')")
        maps.click()  # before the page has seen that the other one has opened
        tab.wait_frames(500)
        assert maps.get_attribute("aria-selected") == "true"


NEW_FRAME = """() => {
  const all = [...document.querySelectorAll("[data-paminsa-frame]")];
  const marks = all.find((one) => one.offsetParent);
  const frame = JSON.parse(marks.dataset.paminsaFrame);
  frame.edges = frame.edges.map((edge) => edge / 2);
  marks.dataset.paminsaFrame = JSON.stringify(frame);
  const box = marks.getBoundingClientRect(), [left, top, width, height] = frame.panels[0];
  const x = box.left + (left + 0.75 * width) * box.width;
  return [[x, box.top + (top + 0.5 * height) * box.height], frame.edges];
}"""


def test_click_on_a_map_is_read_in_the_frame_of_its_picture(tab: Tab) -> None:
    tab.page.locator("[data-paminsa-picture][src]").first.wait_for()
    tab.dispatch(actions.go_home)
    tab.wait_frames(500)
    place, edges = tab.page.evaluate(NEW_FRAME)  # the picture of another frame; the figure lags
    tab.page.mouse.click(*place)
    expected = (edges[0] + 0.75 * (edges[1] - edges[0])) / 1e3
    until(lambda: abs(tab.state.document.pose[0] - expected) < 2e-3, "the place in the new frame")


LINES = """() => {
  const line = document.querySelector('[data-testid="actuators"]');
  line.style.fontFamily = "'DejaVu Sans'"; // wide, and what Firefox takes on Debian
  for (const [index, text] of ["−23.67", "−17.68", "−15.84", "−1239.5"].entries())
    line.querySelectorAll("b")[index].textContent = text;
  return [...new Set([...line.children].map((torque) => torque.offsetTop))];
}"""
"""Where the lines of the strip's torques begin [px], with long numbers in a wide font."""


def test_strip_has_four_lines_shows_the_rest_under_the_pointer_and_undoes(tab: Tab) -> None:
    strip = tab.page.locator(".pv-strip")
    assert strip.bounding_box()["height"] <= 102
    assert len(tab.page.evaluate(LINES)) == 1, "the page below would jump in a drag"
    more = tab.page.get_by_test_id("summary")
    assert not more.is_visible()
    tab.page.get_by_test_id("actuators").hover()
    more.wait_for()
    tab.page.mouse.move(5, 5)
    before = tab.state.document.pose
    tab.dispatch(lambda s: actions.move(s, x=0.031))
    undo = tab.page.get_by_role("button", name="Undo the last change")
    until(undo.is_enabled, "there is something to undo")
    undo.click()
    until(lambda: tab.state.document.pose == before, "it is undone")


def kept(tab: Tab) -> Any:
    """Return what the tab has saved."""
    return json.loads(tab.page.evaluate(f"sessionStorage.getItem('{STORE_KEY}')") or "{}")


def test_pose_typed_while_a_motion_plays_is_saved(tab: Tab) -> None:
    tab.dispatch(lambda s: motion.play(motion.choose_preset(s, "paper-like")))
    tab.dispatch(lambda s: s.updated("playback", loop=True))
    until(lambda: tab.state.playback.playing, "it plays")
    tab.dispatch(lambda s: actions.vary(s, {"payload.mass": 1.5}))
    until(lambda: kept(tab)["design"].get("payload.mass") == 1.5, "the mass is saved")
    assert tab.state.playback.playing


def searching(state: State) -> State:
    """Return a state in which a search runs, as the store sees it; nothing searches."""
    return replace(state, ended=(SEARCH.place.path,))


def test_reload_opens_tabs_by_their_place_offers_what_it_ended_and_leaves_nothing_to_undo(
    tab: Tab,
) -> None:
    opened = f"sessionStorage.getItem('{STORE_KEY}_tabs') ?? ''"
    tab.open_tab("Synthesis")
    until(lambda: "/Synthesis" in tab.page.evaluate(opened), "the section is kept")
    tab.open_tab("Errors")
    tab.page.get_by_role("tab", name="Manufacture", exact=True).click()
    until(lambda: "/Manufacture" in tab.page.evaluate(opened), "the inner tab is kept")
    tab.dispatch(searching)
    tab.wait_saved()
    tab.reload()
    inner = tab.page.get_by_role("tab", name="Manufacture", exact=True)
    until(lambda: inner.get_attribute("aria-selected") == "true", "the inner tab is open")
    drives = tab.page.get_by_role("tab", name="Drives", exact=True)
    assert drives.get_attribute("aria-selected") == "false"
    tab.open_tab("Pose")
    undo = tab.page.get_by_role("button", name="Undo", exact=True)
    redo = tab.page.get_by_role("button", name="Redo", exact=True)
    assert undo.is_disabled()
    assert redo.is_disabled()
    # A key in a box whose number was taken undoes it.
    start = tab.state.document.pose[0]
    box = tab.number_box("x  [mm]")
    box.fill("31")
    box.press("Enter")
    tab.wait_pose(0, 0.031)
    until(undo.is_enabled, "there is a step to undo")
    box.press("Control+z")
    tab.wait_pose(0, start)
    until(lambda: box.input_value() == f"{1e3 * start:g}", "the box shows it")
    until(redo.is_enabled, "there is a step to redo")
    box.press("Control+Shift+z")
    tab.wait_pose(0, 0.031)
    # The search that it has ended is offered again.
    tab.page.get_by_text("Lost by reload").wait_for()
    again = tab.page.get_by_role("button", name="Search for a robot", exact=True)
    again.wait_for()
    tab.click("Leave it")
    until(lambda: tab.state.ended == (), "it is left")
    until(lambda: not again.is_visible(), "nothing is offered any more")
    # What is asked for goes before Synthesis, with which its workspace was left: the row of that
    # is not there until it is opened.
    tab.session.submit(lambda: tab.session.open_tab("Requirements"))
    until(lambda: tab.is_open("Requirements"), "it is open")
    tab.wait_frames(1000)
    assert tab.is_open("Requirements")


def test_buttons_open_what_they_act_on(tab: Tab) -> None:
    tab.open_tab("Errors")
    tab.page.get_by_role("tab", name="Drives", exact=True).click()
    tab.open_tab("Torque maps")
    tab.click("θ")
    single = tab.page.get_by_role("tab", name="Single map", exact=True)
    until(lambda: single.get_attribute("aria-selected") == "true", "the map is open")
    assert tab.state.map_view.quantity == "error_theta"


VIEW = """() => {
  const box = window.__viserMutable.canvas.getBoundingClientRect();
  return box.width / window.innerWidth;
}"""


FOLDED = """() => [...document.querySelectorAll('[aria-orientation="vertical"] > [role="tab"]')]
  .map((tab) => tab.lastElementChild.scrollHeight > tab.lastElementChild.clientHeight)"""


def test_docks_follow_the_window(tab: Tab) -> None:
    tab.page.set_viewport_size({"width": 1400, "height": 900})
    until(lambda: tab.page.evaluate(VIEW) >= 0.45, "the view has its share")
    for width, height in ((900, 700), (1400, 900), (1120, 720)):  # the last as with 125 % zoom
        tab.page.set_viewport_size({"width": width, "height": height})
        until(lambda: tab.page.evaluate(VIEW) >= 0.45, f"the view has its share at {width} px")
        if width < 1200:  # names of the tabs of the folded dock are whole
            until(lambda: tab.page.evaluate(FOLDED) == [False] * 4, "the dock is folded", 15)
    tab.page.set_viewport_size({"width": 1400, "height": 900})
    tab.wait_frames(1500)
    assert tab.state.docks == Docks()
    edges = tab.page.evaluate(VIEW)
    tab.cut_connection()  # all of the page is made again, with the same docks
    until(lambda: tab.session.built.is_set(), "all of it is there")
    until(lambda: np.isclose(tab.page.evaluate(VIEW), edges), "the view has the same share")
    assert tab.state.docks == Docks()


def test_a_page_that_connects_again_shows_the_sections_that_it_showed(
    tab: Tab, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A program that has just started is slow: meanwhile rows have their first tabs, or none."""

    def add_late(gui: Any) -> Any:
        time.sleep(1)
        return add_tabs(gui)

    tab.open_tab("Balance")
    tab.wait_saved()
    monkeypatch.setattr("paminsa_viz.explorer.page.add_tabs", add_late)
    tab.cut_connection()
    until(lambda: tab.session.built.is_set(), "all of it is there")
    until(lambda: tab.is_open("Balance"), "the section is open again", 10)
    assert tab.state.workspace == "Optimize"


RIGHT_ENDS = """() => ["[data-floating-window]", "canvas[data-engine]"].map(
  (place) => document.querySelector(place).getBoundingClientRect().right)"""


def test_panel_of_the_view_does_not_lie_over_the_right_dock(tab: Tab) -> None:
    tab.page.set_viewport_size({"width": 900, "height": 600})
    tab.wait_frames(1500)
    tab.click("compare")  # unfolds the left dock
    tab.page.get_by_text("No number differs.").wait_for()

    def between() -> bool:
        panel, view = tab.page.evaluate(RIGHT_ENDS)
        return view < 600 and panel <= view

    until(between, "the panel is as narrow as the view", 10)
    tab.page.get_by_text("View", exact=True).first.click()
    tab.page.get_by_text("Map opacity").wait_for()
    whole = "document.querySelector('[data-floating-window]').offsetWidth > 300"
    until(lambda: tab.page.evaluate(whole), "the open panel has its width", 10)
    until(between, "it ends where the view does", 10)


def test_example_opens_with_what_makes_it_true_and_where_it_is_seen(tab: Tab) -> None:
    tab.open_tab("File")
    example = tab.page.get_by_role("button", name="Compact robot")
    tab.steady_box(example)
    example.click()
    shown = tab.page.get_by_role("tab", name="Requirements", exact=True)
    until(lambda: shown.get_attribute("aria-selected") == "true", "its section is open")
    assert tab.state.document.pose == (0.0, 0.0, 0.0, -0.599)
    until(lambda: "Reachable" in tab.text("status"), "nothing is wrong with it")


LABELS = """() => [...document.querySelectorAll("p > label[for]")]
  .filter(label => label.getClientRects().length && !("paminsaUnseen" in label.dataset))
  .map(label => label.textContent).filter(text => /_/.test(text))"""


SYMBOLS = """() => [...document.querySelectorAll(".pv-symbol")]
  .filter(one => one.checkVisibility()).map(one => one.innerHTML)"""


def test_symbols_have_subscripts_and_no_underscores(tab: Tab) -> None:
    tab.open_tab("Masses")
    symbol = tab.page.locator(".pv-symbol", has_text="mB3").first
    until(symbol.is_visible, "a typeset symbol")
    assert symbol.locator("sub").inner_text() == "B3"
    assert tab.page.evaluate(LABELS) == []
    shown = tab.page.evaluate(SYMBOLS)
    assert "<i>m</i><sub>2</sub> shaft, arm" in shown  # as m_B3: one look for all of them
    tab.open_tab("Lengths")
    shown = until(lambda: tab.page.evaluate(SYMBOLS), "the symbols of lengths")
    assert {"<i>k</i>", "<i>l</i><sub>B4</sub> = <i>k</i>·<i>l</i><sub>B7</sub>"} <= {*shown}


def test_symbols_of_buttons_lists_and_tooltips_are_set_as_those_of_labels(tab: Tab) -> None:
    tab.open_tab("Lengths")
    tab.dispatch(lambda state: actions.vary(state, {"geometry.base_radius": 0.36}))
    reset = tab.page.get_by_role("button", name="R_b", exact=True)
    assert reset.locator(".pv-symbol").inner_html() == "<i>R</i><sub>b</sub>"
    reset.locator("sub").click()
    until(lambda: tab.state.document.design == APPENDIX_4, "the radius is set back")
    box = tab.number_box("|X₄| max [mm]")
    tab.steady_box(box)  # where the row of buttons was
    box.hover()
    tooltip = tab.page.locator("[role=tooltip] > .pv-symbol")
    tooltip.wait_for()
    assert "as long as <i>l</i><sub>B10</sub>" in tooltip.inner_html()
    tab.open_tab("Errors")
    tab.open_tab("Manufacture")
    tab.unfold("Deviations of each leg")
    tab.dispatch(lambda state: state.updated("monte_carlo.settings", length=9))
    chosen = tab.page.locator("input + .pv-symbol", has_text="leg axis from the base center")
    chosen.wait_for()
    assert chosen.locator("sub").inner_text() == "b"
    tab.element("Length").click()
    option = tab.page.get_by_role("option", name="R_pl joint 5 from the center")
    assert option.locator(".pv-symbol").inner_text() == "Rpl joint 5 from the center"


def test_name_with_a_symbol_switches_its_checkbox(tab: Tab) -> None:
    tab.open_tab("Balance")
    tab.unfold("Optimization settings")
    before = tab.state.balance.settings.exact
    tab.page.locator(".pv-symbol", has_text="Only Mp2 = 0").click()
    until(lambda: tab.state.balance.settings.exact != before, "the switch of the name")


HURRY = """() => {
  const now = performance.now.bind(performance);
  performance.now = () => 20 * now();
}"""


FAIL = """([url, count]) => Promise.all(Array.from({ length: count }, () =>
  new Promise((done) => { new WebSocket(url).onclose = done; })))"""


def test_page_connects_again_after_a_long_break_and_says_that_the_server_is_lost(
    browser: Any,
) -> None:
    """Chromium holds every attempt back for seconds once many have failed, as in a long break."""
    from paminsa_viz.app import App, AppOptions
    from paminsa_viz.model import APPENDIX_4

    own = App(AppOptions(port=0, browser=False), APPENDIX_4)
    context = browser.new_context(viewport={"width": 1280, "height": 720})
    try:
        tab = Tab(context.new_page(), own)
        with socket.socket() as taken:
            taken.bind(("127.0.0.1", 0))
            nobody = f"ws://127.0.0.1:{taken.getsockname()[1]}"  # it is bound, and does not listen
            tab.page.evaluate(FAIL, [nobody, 48])
            before = tab.session
            tab.cut_connection()
            assert tab.session is not before
        tab.page.wait_for_function("window.paminsaNumberFields?.connected()")
        own.stop()
        tab.page.evaluate(HURRY)  # it says so after three seconds
        lost = tab.page.get_by_test_id("lost")
        lost.wait_for()
        assert "does not answer" in lost.inner_text()
    finally:
        context.close()


@pytest.mark.parametrize("last", ["Motion", "Strength"])
def test_of_tabs_asked_for_at_once_the_last_one_stays_open(tab: Tab, last: str) -> None:
    first = {"Motion": "Strength", "Strength": "Motion"}[last]
    tab.page.evaluate("names => names.forEach(window.paminsa.openTab)", [first, last])
    until(lambda: tab.state.workspace == last, f"workspace {last}")
    tab.wait_frames(1000)
    assert tab.is_open(last)
    assert tab.state.workspace == last


def test_workspaces_open_by_key_and_are_found_again_as_they_were_left(tab: Tab) -> None:
    tab.page.set_viewport_size({"width": 1400, "height": 900})
    tab.open_workspace("Robot")
    tab.page.locator("canvas[data-engine]").click(position={"x": 300, "y": 560})
    tab.page.keyboard.press("Control+2")
    until(lambda: tab.state.workspace == "Motion", "the second workspace")
    assert "path" in tab.state.layers
    tab.open_tab("Drives")
    tab.dispatch(lambda s: actions.set_layers(s, path=False, skeleton=True))
    tab.open_tab("Single map")
    tab.dispatch(lambda s: s.updated("map_view", quantity="condition"))
    tab.open_tab("Stiffness")
    tab.dispatch(lambda s: actions.set_layers(s, skeleton=False))
    tab.dispatch(lambda s: s.updated("map_view", quantity="f_4"))
    tab.wait_saved()
    tab.wait_frames(600)
    tab.reload()
    chosen = tab.page.get_by_role("tab", name="Stiffness", exact=True)
    until(lambda: chosen.get_attribute("aria-selected") == "true", "the section is open again")
    until(lambda: tab.state.workspace == "Strength", "its workspace")
    tab.open_workspace("Motion")
    assert tab.state.map_view.quantity == "condition"
    assert "skeleton" in tab.state.layers
    assert "path" not in tab.state.layers
    for name in ("Drives", "Single map"):
        found = tab.page.get_by_role("tab", name=name, exact=True)
        until(lambda t=found: t.get_attribute("aria-selected") == "true", f"{name} is open")
    tab.wait_saved()
    tab.wait_frames(600)
    tab.reload()
    until(lambda: tab.is_open("Drives"), "a section of Motion, once the name of a section, is open")
    until(lambda: tab.state.workspace == "Motion", "its workspace")


def test_tabs_that_an_earlier_page_has_kept_open(tab: Tab) -> None:
    kept = f"sessionStorage.setItem('{STORE_KEY}_tabs', JSON.stringify(['Identify', 'Single map']))"
    tab.wait_saved()
    # Nothing is kept over it, whatever the server still sends, and that page knew no workspaces.
    forget = f"window.paminsa = null; sessionStorage.removeItem('{STORE_KEY}')"
    tab.page.evaluate(f"() => {{ window.paminsa.stop(); {kept}; {forget}; }}")
    tab.reload()
    for name in ("Built", "Logs", "Single map"):
        found = tab.page.get_by_role("tab", name=name, exact=True)
        until(lambda t=found: t.get_attribute("aria-selected") == "true", f"{name} is open")


def test_number_that_is_clicked_is_pinned_and_the_cross_takes_it_off(tab: Tab) -> None:
    tab.open_tab("Pose")
    tab.page.get_by_test_id("quality").locator("[data-paminsa-value='condition']").click()
    row = tab.page.get_by_test_id("pins").get_by_role("row")
    row.get_by_text("condition number").wait_for()
    before = row.inner_text()
    tab.number_box("x  [mm]").fill("120")
    tab.number_box("x  [mm]").press("Enter")
    until(lambda: row.inner_text() not in (before, ""), "the number in the strip follows")
    tab.page.get_by_role("button", name="Take Condition number", exact=False).click()
    tab.page.get_by_test_id("pins").wait_for(state="detached")
    assert tab.state.pins.settings.keys == ()
