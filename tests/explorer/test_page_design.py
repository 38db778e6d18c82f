"""The control panel in a browser: its row of tabs, and the numbers of the design."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from typing import Any

import pytest

from paminsa_viz.explorer.page import LATER_TABS
from paminsa_viz.explorer.panels.design_layout import GROUPS
from paminsa_viz.explorer.panels.design_layout import label as label_of
from tests.support.chromium import Tab, until

pytestmark = pytest.mark.browser

TABS = ["Pose", *LATER_TABS]
STRIP = """tabs => tabs.map(tab => {
  const text = tab.querySelector("span");
  return {name: tab.title, top: tab.offsetTop, cut: text.scrollWidth > text.clientWidth};
})"""


def test_tabs_take_two_rows_and_none_is_cut(tab: Tab) -> None:
    strip = tab.page.locator('[role="tablist"]:has(> [title="Pose"]) > [role="tab"]')
    for name in TABS:  # the name of the current one is bold and so is wider
        tab.open_tab(name)
        found = strip.evaluate_all(STRIP)
        assert [one["name"] for one in found] == TABS
        rows = Counter(one["top"] for one in found).values()
        assert len(rows) <= 2
        assert min(rows) >= 0.4 * max(rows)
        assert not any(one["cut"] for one in found)


def test_numbers_can_be_typed_digit_by_digit(tab: Tab) -> None:
    tab.open_tab("Design")
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
  const row = document.getElementById(uuid).parentElement;
  const field = row.querySelector("input:not([type=hidden])");
  const [text, box] = [label.getBoundingClientRect(), field.getBoundingClientRect()];
  return {height: text.height, right: text.right, left: box.left, end: box.right,
          room: field.clientWidth - field.scrollWidth};
})"""


def test_nothing_is_cut_off(open_tab: Callable[..., Tab]) -> None:
    width = 1280
    tab = open_tab(width, 720)
    tab.open_tab("Design")
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
