"""Tables on the clipboard: those of the Export tab, and any table of the page."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from paminsa_viz.explorer import actions, exports
from paminsa_viz.files.tables import table_text
from tests.support.chromium import Tab, until

pytestmark = pytest.mark.browser

READ = "() => navigator.clipboard.readText()"


@pytest.fixture(scope="module")
def copying(open_tab: Callable[..., Tab], browser: Any) -> Any:
    """A tab whose clipboard can be read, at a pose that gravity loads."""
    context = browser.new_context(
        viewport={"width": 1280, "height": 720},
        permissions=["clipboard-read", "clipboard-write"],
    )
    tab = open_tab(context=context)
    tab.dispatch(lambda s: actions.move(s, x=0.08, y=0.05, theta=np.pi / 3))
    until(lambda: "4.570" in tab.text("actuators"), "the torques of the pose")
    yield tab
    context.close()


def test_motion_is_copied_from_the_export_tab(copying: Tab) -> None:
    tab = copying
    tab.open_tab("Export")
    tab.page.get_by_role("button", name="Copy", exact=True).last.click()
    tab.page.get_by_text("Motion: paste it into a spreadsheet").wait_for()
    wanted = table_text(exports.motion_series(tab.state)[1])
    assert tab.page.evaluate(READ).replace("\r\n", "\n") == wanted


def test_any_table_is_copied_by_the_button_beside_it(copying: Tab) -> None:
    tab = copying
    table = tab.page.get_by_test_id("actuators").locator("table").first
    table.hover()
    button = tab.page.get_by_test_id("copy-table")
    box, at = table.bounding_box(), button.bounding_box()
    assert box is not None
    assert at is not None
    assert at["x"] + at["width"] <= box["x"]  # over no text of it
    assert abs(at["y"] - box["y"]) < 3
    button.click()
    until(lambda: button.inner_text() == "Copied", "the table is copied")
    rows = [row.split("\t") for row in tab.page.evaluate(READ).splitlines()]
    assert rows[0] == ["Actuator", "position", "static torque"]
    assert rows[1][0] == "M1"
    assert rows[1][2] == "4.570 N·m"
    assert "-11.93" in rows[1][1]  # a hyphen: spreadsheets do not read a minus sign


def test_older_way_where_the_context_is_not_secure(copying: Tab) -> None:
    tab = copying
    tab.page.evaluate("() => Object.defineProperty(window, 'isSecureContext', {value: false})")
    tab.page.evaluate("() => window.paminsa.copy('Words', 'one\\ttwo')")
    tab.page.get_by_text("Words: paste it into a spreadsheet").wait_for()
    assert tab.page.evaluate(READ) == "one\ttwo"
    tab.page.evaluate("() => { document.execCommand = () => false; }")
    tab.page.evaluate("() => window.paminsa.copy('Words', 'three')")
    tab.page.get_by_text("press Ctrl+C").wait_for()
