"""When a number box gives its number to the server: once, whole, whatever happens meanwhile."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from tests.support.chromium import Tab, until

pytestmark = pytest.mark.browser

X, Y, Z, MASS = "x  [mm]", "y  [mm]", "z  [mm]", "m₇ B3, B7 [kg]"
HINT = ".pv-field-hint"


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


RETRIES = """() => {
  const real = window.setTimeout;
  window.retries = 0;
  window.setTimeout = (run, pause, ...rest) =>
    real(run, pause === 50 ? (window.retries++, 0) : pause, ...rest);
  window.rest = () => { window.setTimeout = real; };
}"""
"""Lets the page look for a box without a pause, and counts how often it does so."""


def test_page_says_that_a_number_has_no_box_any_more(tab: Tab) -> None:
    spare = tab.session.client.gui.add_number("spare", 0.0)
    until(lambda: tab.element("spare").count(), "the box")
    tab.element("spare").click()
    tab.page.keyboard.type("33.5")
    spare.remove()
    until(lambda: tab.page.get_by_text("spare", exact=True).count() == 0, "it is gone")
    tab.page.evaluate(RETRIES)
    tab.page.keyboard.press("Enter")
    hint = tab.page.locator(HINT)
    until(lambda: any("33.5 was not taken" in text for text in hint.all_inner_texts()), "a hint")
    retries = tab.page.evaluate("(window.rest(), window.retries)")
    assert retries >= 200, "the box may come back within ten seconds"
