"""The page for everyone: both themes, keys alone, tooltips, docks."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from paminsa_viz.explorer.browser.style import CONTROLS_WIDTH, SHEET_SHARE, dock_width
from paminsa_viz.explorer.core.docks import EDGE
from paminsa_viz.explorer.scene.cameras import in_window
from paminsa_viz.explorer.state.view import Appearance
from paminsa_viz.model import APPENDIX_4
from tests.support.chromium import Tab, until, wait_theme

pytestmark = pytest.mark.browser

CANVAS = """() => {
  const box = window.__viserMutable.canvas.getBoundingClientRect();
  return [box.left, box.right];
}"""

CONTROLS = """() => {
  // What can be used: the tab of a group that is not selected is reached by its own key.
  const wanted = 'button, input:not([type=hidden]):not([type=file]), textarea, a[href], '
    + '[role=slider], [role=tab], [aria-expanded]';
  window.__controls = [...document.querySelectorAll(wanted)].filter(e =>
    e.getClientRects().length && !e.disabled && e.getAttribute('aria-hidden') !== 'true'
    && e.getAttribute('aria-disabled') !== 'true' && !e.closest('[data-disabled]')
    && getComputedStyle(e).visibility !== 'hidden');
  return window.__controls.length;
}"""

FOCUSED = """() => {
  const e = document.activeElement;
  if (!e || e === document.body) return null;
  const style = getComputedStyle(e);
  const ringed = style.outlineStyle !== 'none' && parseFloat(style.outlineWidth) > 0;
  const seen = ringed || style.boxShadow !== 'none';
  return [window.__controls.indexOf(e), seen, e.outerHTML.slice(0, 200)];
}"""


SCHEMES = """
  window.__schemes = [];
  const look = () => {
    const now = document.documentElement.getAttribute('data-mantine-color-scheme');
    if (now !== window.__schemes.at(-1)) window.__schemes.push(now);
    requestAnimationFrame(look);
  };
  requestAnimationFrame(look);
"""


def test_theme_is_the_browsers_until_one_is_chosen_and_that_of_the_first_picture(
    browser: Any, app: Any
) -> None:
    context = browser.new_context(viewport={"width": 1280, "height": 720}, color_scheme="dark")
    page = context.new_page()
    page.add_init_script(SCHEMES)
    tab = Tab(page, app)

    def has(appearance: Appearance, *, all_the_time: bool = False) -> None:
        wait_theme(tab, appearance.value)
        dark = appearance is Appearance.DARK
        until(lambda: tab.state.theme.dark == dark, "the state has the theme")
        tab.wait_frames(300)
        wait_theme(tab, appearance.value)  # and stays so
        if all_the_time:
            shown = [each for each in page.evaluate("window.__schemes") if each]
            assert shown == [appearance.value]

    has(Appearance.DARK, all_the_time=True)
    page.emulate_media(color_scheme="light")
    has(Appearance.LIGHT)
    page.emulate_media(color_scheme="dark")
    has(Appearance.DARK)
    color = page.evaluate("getComputedStyle(document.querySelector('.pv-strip')).color")
    assert min(int(part) for part in color[4:-1].split(",")) > 150  # light letters
    tab.dispatch(lambda s: s.updated("", appearance=Appearance.LIGHT))
    has(Appearance.LIGHT)
    tab.wait_saved()
    tab.reload()
    until(lambda: tab.state.appearance is Appearance.LIGHT, "the choice is kept")
    has(Appearance.LIGHT, all_the_time=True)
    tab.dispatch(lambda s: s.updated("", appearance=Appearance.DARK))
    has(Appearance.DARK)
    context.close()
    assert tab.errors == []


@pytest.mark.parametrize("name", ["Pose", "View", "Balance"])
def test_keys_alone_reach_every_control_and_show_where_they_are(tab: Tab, name: str) -> None:
    tab.open_tab(name)
    tab.wait_frames(500)
    tab.page.evaluate("document.activeElement.blur()")
    count = tab.page.evaluate(CONTROLS)
    assert count >= 20
    reached: set[int] = set()
    for _ in range(count + 20):
        tab.page.keyboard.press("Tab")
        focused = tab.page.evaluate(FOCUSED)
        if focused is None:
            continue
        index, visible, html = focused
        assert visible, html
        reached.add(index)
    missed = set(range(count)) - reached
    described = tab.page.evaluate(
        "places => places.map(i => window.__controls[i].outerHTML.slice(0, 160))", sorted(missed)
    )
    assert described == []


def test_keys_open_a_tab_and_move_a_slider(tab: Tab) -> None:
    tab.page.get_by_role("tab", name="View", exact=True).focus()
    tab.page.keyboard.press("Enter")
    tab.page.get_by_text("Map opacity").wait_for()
    tab.page.get_by_role("tab", name="Pose", exact=True).focus()
    tab.page.keyboard.press("Enter")
    named = tab.page.get_by_role("slider", name="x [mm]")
    until(lambda: named.count() == 1, "the slider has its label's name")
    named.focus()
    tab.page.keyboard.press("ArrowRight")
    until(lambda: tab.state.document.pose[0] > 0, "the slider moves the robot")
    tab.open_tab("Masses")
    folder = tab.page.get_by_role("button", name="Gravity", exact=True)
    folder.focus()
    for key, opened in (("Enter", "true"), ("Space", "false")):  # viser leaves it to the mouse
        tab.page.keyboard.press(key)
        until(lambda o=opened: folder.get_attribute("aria-expanded") == o, f"{key} at a folder")


IN_HIGH_CONTRAST = """() => {
  const seen = (selector, pseudo) => getComputedStyle(
    [...document.querySelectorAll(selector)].find(e => e.checkVisibility()), pseudo);
  return {
    check: seen('[type=checkbox]:checked + svg').color,
    track: seen('.mantine-Slider-track', '::before').backgroundColor,
    filled: seen('.mantine-Slider-bar').backgroundColor,
    chosen: seen('[role=option][data-combobox-selected]').outlineStyle,
    other: seen('[role=option]:not([data-combobox-selected])').outlineStyle,
    open: seen('[role=tab][aria-selected=true]').borderBottomStyle,
    ground: seen('body').backgroundColor,
  };
}"""


def test_what_is_checked_chosen_or_open_is_seen_in_high_contrast(tab: Tab) -> None:
    tab.page.emulate_media(forced_colors="active")
    tab.element("Color range").focus()
    tab.page.keyboard.press("ArrowDown")
    tab.page.get_by_role("option").first.wait_for()
    tab.page.keyboard.press("ArrowDown")
    tab.page.locator("[data-combobox-selected]").wait_for()
    seen = tab.page.evaluate(IN_HIGH_CONTRAST)
    tab.page.keyboard.press("Escape")
    assert len({seen["ground"], seen["track"], seen["filled"]}) == 3
    assert seen["check"] != seen["ground"]
    assert (seen["chosen"], seen["other"], seen["open"]) == ("solid", "none", "solid")


SEEN = """element => {
  const row = element.closest('[data-paminsa-mark~="row"]');
  const label = row.querySelector('label');
  const text = (of, pseudo) => JSON.parse(
    (getComputedStyle(of, pseudo).content.match(/^"[^"]*"/) || ['""'])[0]);
  const hidden = getComputedStyle(label).color === 'rgba(0, 0, 0, 0)';
  return [text(label, '::before') || (hidden ? '' : label.textContent),
    text(row.lastElementChild, '::after'), label.parentElement.clientHeight];
}"""


def test_unit_is_seen_behind_the_field_and_stays_in_the_name(tab: Tab) -> None:
    def seen(label: str) -> list[Any]:
        return tab.element(label).evaluate(SEEN)

    until(lambda: seen("x  [mm]")[:2] == ["x", "mm"], "the unit is behind the field")
    line = seen("x  [mm]")[2]
    assert 12 < line < 25
    handle = tab.handle("Largest condition number")
    whole = handle.label
    for label, name, unit in (
        ("limit [N·m/rad]", "limit", "N·m/rad"),
        ("as it was", "as it was", ""),
        ("ends [no unit]", "ends [no unit]", ""),
        ("again  [°]", "again", "°"),
    ):
        handle.label = label
        until(lambda: seen(label)[:2] == [name, unit], label)  # noqa: B023
        assert seen(label)[2] == line
        assert tab.page.get_by_label(label.replace("  ", " "), exact=True).count() == 1
    handle.label = whole  # the tab is shared: other tests look for it
    until(lambda: seen(whole)[:2] == [whole, ""], whole)
    tab.page.emulate_media(color_scheme="dark")
    wait_theme(tab, "dark")
    page, rest, hover = tab.page.evaluate(BRIGHTNESS)
    assert page < rest < hover, "a button is seen under the pointer as well"
    assert seen("x  [mm]")[:2] == ["x", "mm"]
    assert tab.page.get_by_role("slider", name="x [mm]").count() == 1


def test_marks_come_and_go_with_what_they_stand_for(tab: Tab) -> None:
    tab.page.evaluate("document.body.insertAdjacentHTML('beforeend', '<p id=box></p>')")
    found = []
    change = "html => document.getElementById('box').innerHTML = html"
    pull = "() => document.querySelector('#box img:last-child').remove()"
    both = "<div><img></div><i class=pv-heading></i>"
    for script, inside in (
        (change, "<div><img></div>"), (change, "<b></b>"), (change, both),
        (change, "<div><img><img></div>"), (pull, ""), (pull, ""),
    ):  # fmt: skip
        tab.page.evaluate(script, inside)
        found.append(
            tab.page.evaluate("() => new Promise(done => setTimeout(() => done("
            "document.getElementById('box').dataset.paminsaMark), 50))")
        )  # fmt: skip
    assert [set((each or "").split()) for each in found] == [
        {"picture"}, set(), {"picture", "heading"}, {"picture"}, {"picture"}, set()
    ]  # fmt: skip


BRIGHTNESS = """() => {
  const draw = document.createElement("canvas").getContext("2d");
  const style = getComputedStyle(document.documentElement);
  return ["body", "gray-filled", "gray-filled-hover"].map((name) => {
    draw.fillStyle = style.getPropertyValue(`--mantine-color-${name}`);
    draw.fillRect(0, 0, 1, 1);
    return draw.getImageData(0, 0, 1, 1).data.reduce((sum, part) => sum + part);
  });
}"""
"""Of the page, of viser's gray buttons, and of those under the pointer."""


def tooltip(tab: Tab, target: Any) -> dict[str, float]:
    """Return where the tooltip of something is, once it is there."""
    tab.page.mouse.move(640, 5)
    until(lambda: tab.page.get_by_role("tooltip").count() == 0, "no tooltip")
    target.hover()
    found = tab.page.get_by_role("tooltip")
    found.wait_for()
    return tab.steady_box(found)


def view_edges(tab: Tab) -> list[float]:
    """Return where the view begins and ends [px], once both docks are there and rest."""

    def resting() -> list[float] | None:
        before = tab.page.evaluate(CANVAS)
        tab.wait_frames(300)
        return before if before[0] > 0 and before == tab.page.evaluate(CANVAS) else None

    return until(resting, "the docks rest")


def test_tooltips_open_in_the_view_and_not_over_the_panel(tab: Tab) -> None:
    left, right = view_edges(tab)
    for target in (tab.slider("x  [mm]"), tab.element("Knee branch")):
        box = tooltip(tab, target)
        at = target.bounding_box()
        assert left < box["x"]
        assert box["x"] + box["width"] <= right
        assert box["y"] - 1 <= at["y"] + at["height"] / 2 <= box["y"] + box["height"] + 1
    assert tooltip(tab, tab.element("Shared"))["x"] >= left
    home = tab.page.get_by_role("button", name="Home", exact=True)
    assert "(key: H)" in str(home.get_attribute("title"))  # viser shows none


REPLACED = """async () => {
  const place = document.createElement("div");
  const row = (name) => {
    const made = document.createElement("div");
    made.innerHTML = `<button id="${name}">${name}</button>`;
    return made;
  };
  const rows = Object.fromEntries(["before", "start", "stop", "after"].map((n) => [n, row(n)]));
  const seen = [];
  const look = async () => {
    for (let i = 0; i < 2; i++) await new Promise((done) => requestAnimationFrame(done));
    seen.push(document.activeElement.id || document.activeElement.tagName);
  };
  const { before, start, stop, after } = rows;
  document.body.append(place);
  place.append(before, start, after);
  start.firstChild.focus();
  start.remove();
  await look();
  before.after(stop);
  await look();
  after.after(row("answer"));
  stop.replaceWith(start);
  await look();
  start.firstChild.disabled = true;
  await look();
  start.firstChild.disabled = false;
  await look();
  start.replaceWith(stop);
  after.firstChild.focus();
  await look();
  place.remove();
  return seen;
}"""
"""What has the focus while buttons come and go as they do where a task starts and ends."""


def test_button_that_comes_where_one_was_pressed_has_its_focus(tab: Tab) -> None:
    seen = tab.page.evaluate(REPLACED)
    assert seen == ["BODY", "stop", "start", "BODY", "start", "after"]


LEFT = """async () => {
  const place = document.createElement("div");
  place.innerHTML = `<div><button id="above">above</button></div>
    <div><div data-paminsa-mark="row"><div><div>
      <button>one</button><button>two</button><button>three</button>
    </div></div></div></div>
    <div><button id="below" disabled>below</button></div>`;
  document.body.append(place);
  const row = place.children[1];
  const [, two] = row.querySelectorAll("button");
  const seen = [];
  const look = async () => {
    for (let i = 0; i < 2; i++) await new Promise((done) => requestAnimationFrame(done));
    seen.push(document.activeElement.textContent);
  };
  two.focus();
  two.remove();
  await look();
  row.remove();
  await look();
  place.remove();
  return seen;
}"""
"""What has the focus as a button of a row goes, and then the row."""


def test_focus_of_a_button_of_a_row_goes_to_its_neighbor(tab: Tab) -> None:
    """As of *Lost by reload*, which has a button for each task, and goes with the last one."""
    assert tab.page.evaluate(LEFT) == ["three", "above"]


def test_reload_keeps_the_docks(open_tab: Callable[..., Tab]) -> None:
    tab = open_tab(1400, 900)
    left, right = view_edges(tab)
    page = tab.page
    for start, change in ((left - 2, -70), (right + 2, -50)):
        page.mouse.move(start, 450)
        page.mouse.down()
        page.mouse.move(start + change, 450, steps=6)
        page.mouse.up()
    dragged = view_edges(tab)
    np.testing.assert_allclose(dragged, [left - 70, right - 50], atol=4)
    until(lambda: tab.state.docks.right.width is not None, "the docks are known")
    until(lambda: tab.state.docks.left.width is not None, "both are")
    page.get_by_role("button", name="Collapse panel area").first.click()
    until(lambda: tab.state.docks.left.folded, "the fold is known")
    tab.wait_saved()
    tab.reload()
    folded = [40, dragged[1]]  # viser moves a panel for half a second until it is folded
    until(lambda: np.allclose(page.evaluate(CANVAS), folded, atol=3), "the maps stay folded")
    page.get_by_role("button", name="Expand column").first.click()
    until(lambda: np.allclose(page.evaluate(CANVAS), dragged, atol=3), "both docks as wide")


def camera_of(width: float, height: float) -> tuple[float, float, float]:
    """Return where the first camera preset looks from in a view of this size [px]."""
    return in_window("3D", APPENDIX_4.geometry, None, width, height).position


def test_layout_is_the_same_however_many_pixels_the_view_has(
    tab: Tab, open_tab: Callable[..., Tab]
) -> None:
    """Screens have several for one of the page's; where pictures take long, viser takes fewer."""
    edges = [dock_width(1280, 720) + EDGE, 1280 - CONTROLS_WIDTH - EDGE]

    def wait_layout(each: Tab) -> None:
        until(lambda: np.allclose(each.page.evaluate(CANVAS), edges, atol=2), "the docks' widths")
        until(lambda: np.allclose(each.session.camera[1], fitted, atol=3e-3), "the camera fits")

    fitted = camera_of(edges[1] - edges[0], 720)
    wait_layout(tab)
    coarse = open_tab(1280, 720, pixel_ratio=0.5)
    wait_layout(coarse)
    for height in (720, 700):
        coarse.page.set_viewport_size({"width": 1280, "height": height})
        until(lambda h=height: coarse.session.client.camera.image_height == h / 2, "its pixels")
        until(lambda: coarse.session.pixel_ratio == 0.5, "half of one for one of the page's")
    fitted = camera_of(edges[1] - edges[0], 700)
    until(lambda: np.allclose(coarse.session.camera[1], fitted, atol=3e-3), "it fits again")
    until(lambda: coarse.session.window == (1280, 700), "the window's newest size")


REACHED = """([what, beyond]) => [...document.querySelectorAll(what)]
  .filter((each) => each.checkVisibility()).map((each) => {
    const { left, right, bottom } = each.getBoundingClientRect();
    return each.contains(document.elementFromPoint(left + (right - left) / 4, bottom + beyond));
  })"""
"""Whether what is some pixels below each of these belongs to it."""

TAB_LOOK = """tab => {
  const row = tab.parentElement;
  const others = [...row.children].filter(one => one !== tab);
  const look = one => getComputedStyle(one);
  return {
    weight: look(tab.querySelector("*")).fontWeight, position: look(row).position,
    open: others.every(one => look(one).color !== look(tab).color),
    row: Math.abs(row.lastElementChild.getBoundingClientRect().right - innerWidth) < 20,
  };
}"""
"""How an open tab looks: heavier, in another color, in a row that is as wide as the window."""


def test_phone_shows_the_robot_above_controls_that_are_as_wide_as_the_window(
    open_tab: Callable[..., Tab],
) -> None:
    tab = open_tab(390, 844)
    fitted = in_window("3D", APPENDIX_4.geometry, None, 390, 844, sheet=True).position
    until(lambda: np.allclose(tab.session.camera[1], fitted, atol=3e-3), "the robot in the view")
    box = tab.page.get_by_test_id("status").locator(
        "xpath=ancestor::div[contains(@style, 'width: 20em')]"
    )
    assert [each.bounding_box()["width"] for each in box.all()] == [390, 390]
    rows = {name: tab.page.get_by_role("tab", name=name, exact=True) for name in ("Robot", "Pose")}
    looks = {name: row.evaluate(TAB_LOOK) for name, row in rows.items()}
    weights = {name: look.pop("weight") for name, look in looks.items()}
    assert weights == {"Robot": "600", "Pose": "400"}, "workspaces do not stand out"
    assert looks["Robot"] == looks["Pose"] == {"open": True, "position": "static", "row": True}
    assert box.first.bounding_box()["height"] <= SHEET_SHARE * 844 + 1
    touch = tab.page.context.new_cdp_session(tab.page)
    touch.send("Emulation.setTouchEmulationEnabled", {"enabled": True})
    tab.steady_box(tab.slider("x  [mm]"))
    chips, tracks = ".pv-reference button[aria-pressed=false]", ".mantine-Slider-trackContainer"
    assert tab.page.evaluate(REACHED, [chips, 3]) == [True, True]  # 18 pixels high
    assert tab.page.evaluate(REACHED, [tracks, 7])[:2] == [True, True]  # 3 pixels high
    assert tab.number_box("x  [mm]").bounding_box()["height"] >= 30
    assert tab.page.get_by_role("button", name="Home").bounding_box()["height"] >= 30
    tab.session.open_tab("Balance")  # as the command palette, the tour and links do
    until(lambda: tab.is_open("Balance"), "the section is open")
    tab.page.get_by_role("button", name="Balance", exact=True).first.click()
    until(lambda: tab.is_open("Answer"), "the answer is open in the dock below")
    assert tab.errors == []
