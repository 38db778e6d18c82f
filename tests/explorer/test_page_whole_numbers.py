"""When a number box gives its number to the server: once, whole, whatever happens meanwhile."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import viser

from paminsa_viz.explorer.tabs import sections
from tests.support.chromium import Tab, until

pytestmark = pytest.mark.browser

X, Y, Z, MASS, LIMIT = "x  [mm]", "y  [mm]", "z  [mm]", "m₇ B3, B7 [kg]", "Largest condition number"
NUMERIC = (viser.GuiNumberHandle, viser.GuiSliderHandle, viser.GuiVector2Handle)
HINT = ".pv-field-hint"


class Received:
    """What arrives of number inputs, in its order, instead of what it would change.

    Attributes:
        values: Label and value, one entry an arrival.
    """

    def __init__(self, tab: Tab) -> None:
        self.values: list[tuple[str, Any]] = []
        self._session = tab.session
        real = tab.session.dispatch

        def dispatch(source: str, *rest: Any, **options: Any) -> None:
            """Nothing is computed, nothing is written, but workspaces open."""
            if source == "workspace":
                real(source, *rest, **options)

        self._session.dispatch = dispatch
        for handle in self.handles.values():
            handle.on_update(self._note)

    @property
    def handles(self) -> dict[str, Any]:
        """Inputs of the session that hold numbers, by their uuid."""
        found = self._session.client.gui._gui_input_handle_from_uuid
        return {uuid: handle for uuid, handle in found.items() if isinstance(handle, NUMERIC)}

    async def _note(self, event: Any) -> None:
        if event.client is not None:
            self.values.append((event.target.label, event.target.value))


def leave_by_click(tab: Tab, field: Any) -> None:
    """Click on a text of the page."""
    tab.page.get_by_test_id("status").click()


ENDS: dict[str, Callable[[Tab, Any], Any]] = {
    "Enter": lambda _, field: field.press("Enter"),
    "Tab": lambda _, field: field.press("Tab"),
    "blur": lambda _, field: field.blur(),
    "a click elsewhere": leave_by_click,
}


def test_long_pauses_take_no_part_of_a_number(tab: Tab) -> None:
    tab.open_tab("Masses")
    before, steps = tab.state, len(tab.session._history.past)
    for label, text, pauses, place, end in (
        (MASS, "3.063", (3000, 1100), lambda: tab.state.document.design.joints.j7, "Tab"),
        (X, "33.5", (30, 30, 1100), lambda: 1e3 * tab.state.document.pose[0], "Enter"),
    ):
        if label == X:
            tab.open_tab("Pose")
        field = tab.number_box(label)
        start = place()
        field.click()
        for key, pause in zip(text, (*pauses, *[30] * len(text)), strict=False):
            field.press(key)
            tab.page.wait_for_timeout(pause)
            assert place() == start
        assert field.input_value() == text
        ENDS[end](tab, field)
        until(lambda p=place, t=text: abs(p() - float(t)) < 1e-9, f"{label} is {text}")
        until(lambda f=field, t=text: f.input_value() == t, "the box shows it")
    assert len(tab.session._history.past) == steps + 2
    assert before != tab.state


UNFOLD = """() => {
  for (const icon of document.querySelectorAll("svg.tabler-icon-chevron-down"))
    if (icon.getClientRects().length) icon.parentElement.click();
}"""


TYPE_ALL = """async (pause) => {
  const BOX = "input.mantine-NumberInput-input";
  const rest = () => new Promise((done) => setTimeout(done, pause));
  const press = (box, key) =>
    box.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
  const ends = [(box) => press(box, "Enter"), (box) => box.blur()];
  const boxes = [...document.querySelectorAll(BOX)]
    .filter((box) => box.getClientRects().length && !box.disabled && !box.tried);
  const typed = [];
  for (const box of boxes) {
    const slider = box.parentElement.closest(".mantine-Flex-root")?.querySelector("[id]");
    const all = [...box.closest(".mantine-NumberInput-root").parentElement.querySelectorAll(BOX)];
    const text = (1.03 + 0.07 * typed.length).toFixed(2); // no value that is there already
    box.tried = true;
    box.focus(); // which leaves the one before, if it is not left yet
    for (const part of [text[0], text.slice(1)]) {
      press(box, part[0]);
      document.execCommand("insertText", false, part);
      await rest();
    }
    ends[typed.length % 3]?.(box);
    typed.push([slider?.id ?? all[0].id, all.indexOf(box), Number(text)]);
  }
  document.activeElement.blur();
  return typed;
}"""
PLACES = (
    *(one.name for one in sections().values()),
    *("View", "Torque maps", "Single map", "Motion plots", "Answer", "File"),
)


def test_every_box_gives_its_number_once_and_whole(tab: Tab) -> None:
    tab.page.set_viewport_size({"width": 1600, "height": 1000})
    received = Received(tab)
    tried: set[str] = set()
    for name in PLACES:
        tab.open_tab(name)
        tab.page.evaluate(UNFOLD)
        tab.wait_frames(300)
        values = {uuid: handle.value for uuid, handle in received.handles.items()}
        wanted = []
        for uuid, index, number in tab.page.evaluate(TYPE_ALL, 20 if name == "Pose" else 2):
            if isinstance(values[uuid], tuple):
                held = list(values[uuid])
                held[index] = number
                values[uuid] = tuple(held)
            else:
                values[uuid] = number
            wanted.append((received.handles[uuid].label, values[uuid]))
        until(lambda w=wanted: len(received.values) >= len(w), f"all numbers of {name}")
        assert received.values == wanted
        tried.update(label for label, _ in wanted)
        received.values.clear()
    assert len(tried) > 100
    assert {X, LIMIT, MASS, "from–to"} <= tried
    tab.reload()  # a session that computes again


def test_numbers_of_two_boxes_within_a_moment_both_arrive(tab: Tab) -> None:
    tab.page.evaluate(
        """ids => ids.forEach((id, i) => {
          const row = document.getElementById(id).parentElement;
          const box = row.querySelector("input.mantine-NumberInput-input");
          box.focus();
          document.execCommand("insertText", false, `${10 + i}`);
          box.dispatchEvent(new KeyboardEvent("keydown", { key: "Enter", bubbles: true }));
        })""",
        [tab.handle(label)._impl.uuid for label in (X, Y, Z)],
    )
    wanted = (0.010, 0.011, 0.012)
    until(lambda: np.allclose(np.array(tab.state.document.pose)[[0, 1, 3]], wanted), "all three")


Replace = Callable[[Tab, str], None]


def hidden_for_a_moment(tab: Tab, label: str) -> None:
    """Take an input off the page and put it back."""
    handle = tab.handle(label)
    handle.visible = False
    until(lambda: tab.element(label).count() == 0, "it is off the page")
    handle.visible = True


def made_again(tab: Tab, label: str) -> None:
    """Replace an input by another one of the same name."""
    old = tab.handle(label)
    with tab.session.client.atomic():
        old.remove()
        tab.session.client.gui.add_number(label, 0.0)


def connected_again(tab: Tab, label: str) -> None:
    """Cut the connection; the page connects again, and all of it is made again."""
    tab.cut_connection()


@pytest.mark.parametrize(
    ("replace", "label", "after"),
    [(hidden_for_a_moment, X, 1), (made_again, "spare", 3), (connected_again, X, 1)],
    ids=["hidden after a key", "made again after a few", "connected again after a key"],
)
def test_number_goes_on_in_the_box_that_replaces_its_own(
    tab: Tab, replace: Replace, label: str, after: int
) -> None:
    if label != X:
        tab.session.client.gui.add_number(label, 0.0)
        until(lambda: tab.element(label).count(), "the box")
    start = tab.handle(label).value
    (tab.number_box(label) if label == X else tab.element(label)).click()
    text = "-33.25"
    tab.page.keyboard.type(text[:after], delay=20)
    replace(tab, label)
    tab.page.keyboard.type(text[after:], delay=20)
    tab.wait_frames(100)
    if not tab.session.closed:
        assert tab.handle(label).value == start
    tab.page.keyboard.press("Enter")
    until(lambda: tab.handle(label).value == float(text), "the number arrives")
    if label == X:
        tab.wait_pose(0, -0.03325)
    else:
        tab.handle(label).remove()


def test_page_says_that_a_number_has_no_box_any_more(tab: Tab) -> None:
    spare = tab.session.client.gui.add_number("spare", 0.0)
    until(lambda: tab.element("spare").count(), "the box")
    tab.element("spare").click()
    tab.page.keyboard.type("33.5")
    spare.remove()
    until(lambda: tab.page.get_by_text("spare", exact=True).count() == 0, "it is gone")
    tab.page.keyboard.press("Enter")
    hint = tab.page.locator(HINT)
    until(lambda: any("33.5 was not taken" in text for text in hint.all_inner_texts()), "a hint")
