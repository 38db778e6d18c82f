"""All sections of the page at once: names and roles, contrast, numbers that arrive whole."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
import viser

from paminsa_viz.explorer.state.view import Appearance
from paminsa_viz.explorer.tabs import sections
from tests.support.chromium import Tab, until, wait_theme

pytestmark = pytest.mark.browser

NUMERIC = (viser.GuiNumberHandle, viser.GuiSliderHandle, viser.GuiVector2Handle)
PLACES = (
    *(one.name for one in sections().values()),
    *("View", "Torque maps", "Single map", "Motion plots", "Answer", "File"),
)

ALL_TABS = """
  [role=tablist] + div { overflow: auto !important; }
  [role=tablist] + div > div {
    display: block !important; flex: none !important; overflow: visible !important;
  }
"""
"""Shows the contents of all tabs, one below the other."""


@pytest.fixture
def whole(tab: Tab) -> Iterator[Tab]:
    """The tab with all that it holds. To open a section takes half a second: tests share it."""
    found = tab.page.get_by_role("tab")
    until(lambda: {"Answer", "View"} <= set(found.all_inner_texts()), "all tabs")
    if not tab.page.evaluate("window.__opened === true"):
        for name in PLACES:
            tab.open_tab(name)  # what it holds is made when it is first opened
        tab.page.evaluate("window.__opened = true")
    tab.page.add_style_tag(content=ALL_TABS).evaluate("style => { style.id = 'all-tabs'; }")
    yield tab
    tab.page.evaluate("document.getElementById('all-tabs')?.remove()")  # unless it is loaded again


RULES = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa"]
CHECK = """rules => axe.run(document, {runOnly: rules, resultTypes: ['violations']})"""

CHECK_LOOKS = """() => {
  const looks = new Map();
  const behind = (one) => {
    if (!one) return "";
    if (!looks.has(one)) {
      const { backgroundColor, backgroundImage, opacity } = getComputedStyle(one);
      const own = [backgroundColor, backgroundImage, opacity].join();
      looks.set(one, own + behind(one.parentElement));
    }
    return looks.get(one);
  };
  const found = new Map();
  for (const one of document.body.querySelectorAll("*")) {
    const texts = [...one.childNodes].some((child) => child.nodeType === 3 && child.data.trim());
    if (!one.getClientRects().length || !(texts || one.matches("input"))) continue;
    const { color, fontSize, fontWeight } = getComputedStyle(one);
    found.set([color, fontSize, fontWeight, behind(one)].join(), one);
  }
  const context = { include: [...found.values()] };
  return axe.run(context, { runOnly: ["color-contrast"], resultTypes: ["violations"] });
}"""
"""The contrast of one text of each look: its color and size, and what is behind it."""


def test_contrast_names_and_roles(whole: Tab) -> None:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright").Axe()
    page = whole.page
    page.set_viewport_size({"width": 1280, "height": 8000})  # only what is on the page is checked
    page.evaluate(axe.axe_script)

    def violations(check: str) -> list[tuple[str, ...]]:
        return [
            (violation["id"], node["html"][:160], node["failureSummary"][:200])
            for violation in page.evaluate(check, RULES)["violations"]
            for node in violation["nodes"]
        ]

    # Names, roles and what lies over what are those of both themes; colors are not.
    for theme, check in ((Appearance.LIGHT, CHECK), (Appearance.DARK, CHECK_LOOKS)):
        whole.dispatch(lambda s, theme=theme: s.updated("", appearance=theme))
        wait_theme(whole, theme.value)
        whole.wait_frames(1000)
        found = violations(check)
        for _ in range(3):  # names come a moment later
            if found:
                whole.wait_frames(500)
                found = violations(check)
        assert found == [], theme
    last = page.get_by_role("button", name="Take the guided tour").bounding_box()
    assert last["y"] + last["height"] < 8000


UNFOLD = """() => {
  for (const icon of document.querySelectorAll("svg.tabler-icon-chevron-down"))
    if (icon.getClientRects().length) icon.parentElement.click();
}"""


TYPE_ALL = """async () => {
  const BOX = "input.mantine-NumberInput-input";
  const rest = (pause) => new Promise((done) => setTimeout(done, pause));
  const picture = () => new Promise(requestAnimationFrame);
  const press = (box, key) =>
    box.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
  const ends = [(box) => press(box, "Enter"), (box) => box.blur()];
  const boxes = [...document.querySelectorAll(BOX)]
    .filter((box) => box.getClientRects().length && !box.disabled);
  const typed = [];
  for (const box of boxes) {
    const slider = box.parentElement.closest(".mantine-Flex-root")?.querySelector("[id]");
    const all = [...box.closest(".mantine-NumberInput-root").parentElement.querySelectorAll(BOX)];
    const text = (1.03 + 0.07 * typed.length).toFixed(2); // no value that is there already
    const uuid = slider?.id ?? all[0].id;
    box.focus(); // which leaves the one before, if it is not left yet
    if (typed.at(-1)?.[0] === uuid) await picture(); // in one, an input sends its newest value only
    press(box, text[0]);
    document.execCommand("insertText", false, text[0]);
    await rest(typed.length < 10 ? 20 : 2); // in which what is there so far may not be given
    press(box, text[1]);
    document.execCommand("insertText", false, text.slice(1));
    ends[typed.length % 3]?.(box);
    typed.push([uuid, all.indexOf(box), Number(text)]);
  }
  document.activeElement.blur();
  return typed;
}"""


@pytest.fixture
def inputs(whole: Tab) -> Iterator[dict[str, Any]]:
    """Inputs that hold numbers, by their uuid; what they are set to changes nothing."""
    session = whole.session
    session.dispatch = lambda *_, **__: None
    found = session.client.gui._gui_input_handle_from_uuid
    yield {uuid: handle for uuid, handle in found.items() if isinstance(handle, NUMERIC)}
    del session.dispatch
    whole.reload()  # inputs as the state has them


def test_every_box_gives_its_number_once_and_whole(whole: Tab, inputs: dict[str, Any]) -> None:
    received: list[tuple[str, Any]] = []

    async def note(event: Any) -> None:
        if event.client is not None:
            received.append((event.target.label, event.target.value))

    for handle in inputs.values():
        handle.on_update(note)
    whole.page.evaluate(UNFOLD)
    whole.wait_frames(300)
    values = {uuid: handle.value for uuid, handle in inputs.items()}
    wanted = []
    for uuid, index, number in whole.page.evaluate(TYPE_ALL):
        if isinstance(values[uuid], tuple):
            held = list(values[uuid])
            held[index] = number
            values[uuid] = tuple(held)
        else:
            values[uuid] = number
        wanted.append((inputs[uuid].label, values[uuid]))

    def lacking() -> str:
        return f"all numbers; {[one for one in wanted if one not in received]} are lacking"

    until(lambda: len(received) >= len(wanted), lacking)
    assert received == wanted
    assert len(wanted) > 140
    labels = {"x  [mm]", "Largest condition number", "m₇ B3, B7 [kg]", "Ends"}
    assert labels <= {label for label, _ in wanted}
