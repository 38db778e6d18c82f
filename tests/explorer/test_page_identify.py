"""Identification in a browser: a log is opened, curves and numbers appear and are used."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import paminsa_viz.files
from paminsa_viz.explorer import identify_actions as actions
from paminsa_viz.files.example_logs import ExampleLog, example_log
from paminsa_viz.model import APPENDIX_4
from tests.support.chromium import Tab, until

pytestmark = pytest.mark.browser

LOG = Path(paminsa_viz.files.__file__).parent / ExampleLog.BEST.value
LOGGED = example_log()


def give(tab: Tab, name: str, content: bytes) -> None:
    """Give a file to the first upload button of the tab."""
    field: Any = tab.page.locator('input[type="file"][accept^=".csv"]').first
    field.set_input_files([{"name": name, "mimeType": "text/plain", "buffer": content}])


def test_log_is_identified_drawn_and_used_and_a_wrong_one_changes_nothing(tab: Tab) -> None:
    tab.open_tab("Identify")
    give(tab, "log.csv", LOG.read_bytes())
    until(lambda: tab.state.identifying.result is not None, "the log is identified", 60.0)
    numbers = tab.page.get_by_test_id("identify-numbers")
    numbers.wait_for()
    unknown = tab.state.identifying.result.identification.unknown
    assert numbers.locator("tr.pv-unknown").count() == len(unknown) > 0
    assert tab.page.locator(".uplot canvas").count() >= 2
    tab.click("Use as design")
    until(lambda: tab.state.document.design != APPENDIX_4, "its numbers are the design's")
    findings = tab.state.identifying.result
    give(tab, "wrong.csv", LOG.read_bytes().replace(b"torque1_Nm", b"torque9_Nm"))
    tab.page.get_by_text("there is no such column").first.wait_for()
    assert tab.state.identifying.result is findings
    assert tab.errors == []


def test_settings_outlive_a_reload_and_logs_do_not(tab: Tab) -> None:
    tab.dispatch(
        lambda s: actions.use_log(s.updated("identifying.settings", cut_off=9.0), "log", LOGGED)
    )
    until(lambda: tab.state.identifying.settings.cut_off == 9.0, "the cut-off changes")
    tab.wait_saved()
    tab.reload()
    until(lambda: tab.state.identifying.settings.cut_off == 9.0, "the cut-off is restored")
    assert tab.state.identifying.log is None
