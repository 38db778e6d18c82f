"""What fonts can change: sizes of texts, and what of them is cut off or off the page."""

from __future__ import annotations

from typing import Any

import pytest

from paminsa_viz.explorer.kit.design_numbers import GROUPS
from paminsa_viz.explorer.kit.design_numbers import label as label_of
from paminsa_viz.explorer.tabs import WORKSPACES
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
