"""The control panel in a browser: its row of tabs, and the numbers of the design."""

from __future__ import annotations

from typing import Any

import pytest

from paminsa_viz.explorer.panels.design_layout import GROUPS
from paminsa_viz.explorer.panels.design_layout import label as label_of
from tests.support.chromium import Tab, until


def box(tab: Tab, label: str) -> Any:
    """Return the number box of a slider."""
    track = tab.page.locator(f'[id="{tab.handle(label)._impl.uuid}"]')
    return track.locator("xpath=..").locator("input:not([type=hidden])")


@pytest.mark.browser
def test_the_tabs_share_one_row(tab: Tab) -> None:
    names = ["Pose", "Design", "Balance", "Motion", "Drives", "Compare", "View", "File"]
    for name in names:  # the name of the present one is bold and so takes more room
        tab.open_tab(name)
        strip = tab.page.locator('[role="tablist"]:has(> [title="Pose"]) > [role="tab"]')
        seen = strip.evaluate_all(
            """tabs => tabs.map(tab => {
                const text = tab.querySelector("span");
                return {name: tab.title, top: tab.offsetTop,
                        cut: text.scrollWidth > text.clientWidth};
            })"""
        )
        assert [one["name"] for one in seen] == names
        assert len({one["top"] for one in seen}) == 1
        assert not any(one["cut"] for one in seen)


@pytest.mark.browser
def test_numbers_can_be_typed_digit_by_digit(tab: Tab) -> None:
    tab.open_tab("Design")
    for label, text, path in (
        ("m_B3 bar 4–3–7", "12.5", "links.b3"),  # beyond the slider
        ("m_pl platform", "0.75", "platform.mass"),  # through an impossible 0
        ("m₅ B4, platform", "0.0625", "joints.j5"),  # finer than the slider
    ):
        field = box(tab, label)
        field.click()
        field.press("Control+a")
        field.press_sequentially(text, delay=120)
        until(
            lambda path=path, text=text: tab.state.document.design.value(path) == float(text), path
        )
        # Leaving the box limits its number to the slider's range; by then the slider has to have
        # grown on the page, which takes a moment.
        thumb = tab.slider(label)
        until(
            lambda thumb=thumb, text=text: (
                float(thumb.get_attribute("aria-valuemax")) >= float(text)
            ),
            "the slider grows",
        )
        field.press("Tab")
        tab.page.wait_for_timeout(200)
        assert field.input_value() == text
        assert tab.state.document.design.value(path) == float(text)


MEASURE = """uuids => uuids.map(uuid => {
  const label = document.querySelector(`label[for="${uuid}"]`);
  const row = document.getElementById(uuid).parentElement;
  const field = row.querySelector("input:not([type=hidden])");
  const [text, box] = [label.getBoundingClientRect(), field.getBoundingClientRect()];
  return {height: text.height, right: text.right, left: box.left, end: box.right,
          room: field.clientWidth - field.scrollWidth};
})"""


@pytest.mark.browser
def test_nothing_is_cut_off(open_tab: Any) -> None:
    width = 1280
    tab = open_tab(width, 720)
    tab.open_tab("Design")
    for name in dict.fromkeys(group.tab for group in GROUPS):
        tab.open_tab(name)
        groups = [group for group in GROUPS if group.tab == name]
        for group in groups:
            if not group.open:
                tab.page.get_by_text(group.title, exact=True).last.click()
        labels = [label_of(p) for group in groups for p in group.parameters]
        uuids = [tab.handle(label)._impl.uuid for label in labels]

        def unfolded(uuids: list[str] = uuids) -> list[dict[str, float]] | None:
            found = tab.page.evaluate(MEASURE, uuids)
            return found if all(seen["height"] > 12 for seen in found) else None

        for text, seen in zip(labels, until(unfolded, name), strict=True):
            assert seen["height"] < 24, f"{text} takes two lines"
            assert seen["right"] < seen["left"], f"{text} runs into its number"
            assert seen["room"] >= 0, f"the number of {text} is cut off"
            assert seen["end"] <= width, f"the number of {text} is off the page"
