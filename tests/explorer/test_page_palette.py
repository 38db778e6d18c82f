"""The command palette: what it finds, and keys that come before it is there."""

from __future__ import annotations

import pytest

from tests.support.chromium import Tab, until

pytestmark = pytest.mark.browser

TYPED_AT_ONCE = """keys => {
  const press = (key, more) => document.activeElement.dispatchEvent(
    new KeyboardEvent("keydown", { key, bubbles: true, cancelable: true, ...more }));
  document.activeElement.blur();
  press("k", { code: "KeyK", ctrlKey: true });
  for (const key of keys) press(key, { code: `Key${key.toUpperCase()}` });
}"""
"""Opens the palette and presses keys before the browser has got to its box."""

REOPENED = """() => {
  const press = (key, more) => document.activeElement.dispatchEvent(
    new KeyboardEvent("keydown", { key, bubbles: true, cancelable: true, ...more }));
  press("Escape", { code: "Escape" });
  press("k", { code: "KeyK", ctrlKey: true });
  for (const key of "st") press(key, { code: `Key${key.toUpperCase()}` });
}"""
"""Closes the palette and opens it again before the browser has closed it, and types on."""


def test_palette_finds_sections_and_quantities_by_other_words(tab: Tab) -> None:
    tab.number_box("x  [mm]").fill("33.5")
    tab.page.keyboard.press("Control+k")  # from the box, whose number is taken
    box = tab.page.get_by_placeholder("Search commands", exact=False)
    until(lambda: tab.state.document.pose[0] == 0.0335, "the number is taken")
    for words, found in (("encoder", "Open: Errors"), ("lightest", "Open: Synthesis")):
        box.fill(words)
        tab.page.get_by_text(found).first.wait_for()
    box.fill("map condition number")
    tab.page.get_by_text("Map: condition", exact=False).first.click()
    single = tab.page.get_by_role("tab", name="Single map", exact=True)
    until(lambda: single.get_attribute("aria-selected") == "true", "the map is open")
    for text in ("map stiffness z", "m7 3.063 kg"):
        box.wait_for(state="detached")
        tab.page.keyboard.press("Control+k")
        box.fill(text)
        if text == "m7 3.063 kg":  # the other time Enter comes before the answer
            first = tab.page.locator(".mantine-Spotlight-action[data-selected]")
            until(lambda f=first: f.count() and "Set m₇ to 3.063 kg" in f.inner_text(), "selected")
        box.press("Enter")
    until(lambda: tab.state.document.design.joints.j7 == 3.063, "m7 is set")
    assert tab.state.map_view.quantity == "stiffness_z"
    tab.session.undo()
    until(lambda: tab.state.document.design.joints.j7 != 3.063, "it is one step")
    assert tab.state.map_view.quantity == "stiffness_z"


def test_name_of_a_section_leads_to_it_and_is_forgotten(tab: Tab) -> None:
    box = tab.page.get_by_placeholder("Search commands", exact=False)
    lines = tab.page.locator(".mantine-Spotlight-action")
    for text, section in (("stiff", "Stiffness"), ("drives", "Drives"), ("single", "Single map")):
        tab.page.keyboard.press("Control+k")
        box.fill(text)
        line = lines.first
        until(lambda n=section, at=line: f"Open: {n}" in at.inner_text(), "the first line")
        box.press("Enter")
        opened = tab.page.get_by_role("tab", name=section, exact=True)
        until(lambda at=opened: at.get_attribute("aria-selected") == "true", f"{section} is open")
        box.wait_for(state="detached")
    tab.page.keyboard.press("Control+k")
    box.fill("vibration")
    until(lambda: "compliance, vibration" in lines.first.inner_text(), "it has its own words again")
    box.press("Escape")
    box.wait_for(state="detached")


def test_keys_typed_before_the_palette_has_its_box_go_into_it(tab: Tab) -> None:
    """Elsewhere they are keys of commands: h is the home pose."""
    tab.type_number("x  [mm]", 33.5)
    until(lambda: tab.state.document.pose[0] == 0.0335, "the number is taken")
    box = tab.page.get_by_placeholder("Search commands", exact=False)
    tab.page.evaluate(TYPED_AT_ONCE, [*"homx", "Backspace", "e"])
    until(lambda: box.count() and box.input_value() == "home", "the keys are in the box")
    assert box.evaluate("box => box === document.activeElement")
    tab.page.keyboard.type(" pose")
    until(lambda: box.input_value() == "home pose", "what follows is behind them")
    assert tab.state.document.pose[0] == 0.0335
    box.press("Escape")
    box.wait_for(state="detached")
    tab.page.evaluate(TYPED_AT_ONCE, [*"m7 3.063 kg", "Enter"])
    until(lambda: tab.state.document.design.joints.j7 == 3.063, "m7 is set")


def test_palette_opens_again_while_it_closes(tab: Tab) -> None:
    tab.page.keyboard.press("Control+k")
    box = tab.page.get_by_placeholder("Search commands", exact=False)
    focused = "box => box === document.activeElement"
    until(lambda: box.count() and box.evaluate(focused), "the palette is open")
    tab.page.evaluate(REOPENED)
    until(lambda: box.count() and box.input_value() == "st", "it is open again, with what is typed")
    assert box.evaluate(focused)
    box.press("Escape")
    box.wait_for(state="detached")
