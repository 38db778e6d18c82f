"""Files and the clipboard in a browser: exports, design files, clicks on maps, copied tables."""

from __future__ import annotations

import io
import json
import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from paminsa_viz.explorer.core import actions, persistence
from paminsa_viz.explorer.core import motion as motions
from paminsa_viz.explorer.core.docks import left_dock
from paminsa_viz.explorer.features.export import exports
from paminsa_viz.explorer.features.files.examples import EXAMPLES
from paminsa_viz.explorer.features.pins.tab import pin
from paminsa_viz.explorer.server.limits import Limits
from paminsa_viz.explorer.state.motion import Timing
from paminsa_viz.files.design_file import read_design
from paminsa_viz.files.tables import table_text
from paminsa_viz.model import APPENDIX_4
from tests.support.chromium import COMPUTING, PIXEL, Tab, until

pytestmark = pytest.mark.browser


def download(tab: Tab, click: Callable[[], Any]) -> tuple[str, bytes]:
    """Click something and return the name and the content of the file that comes down."""
    with tab.page.expect_download() as waiting:
        click()
    return waiting.value.suggested_filename, Path(waiting.value.path()).read_bytes()


def test_page_in_one_file_comes_down_with_the_document(tab: Tab) -> None:
    tab.dispatch(lambda state: actions.move(state, x=0.03, y=0.02, theta=0.1, z=-0.5))
    tab.open_tab("File")
    name, content = download(tab, lambda: tab.click("Save as a page"))
    assert name.endswith(".html")
    text = content.decode()
    data, _ = json.JSONDecoder().raw_decode(text, text.index("const PAGE = ") + 13)
    assert data["document"] == persistence.dump(tab.state.document)
    assert data["meshes"]["bodies"].keys() >= {"ground", "platform", "b3"}


LOW = {"width": 1280, "height": 420}
"""A window with a small view, of which a picture without a graphics card takes less time."""


def has_content(png: bytes) -> bool:
    """Whether a picture is not of one color."""
    return np.asarray(Image.open(io.BytesIO(png)).convert("RGB")).std() > 5


def open_exports(tab: Tab) -> None:
    """Unfold the exports in the folder File."""
    tab.open_tab("File")
    heading = tab.page.get_by_text("in its current pose")
    if not heading.is_visible():
        panel = tab.page.locator('[data-paminsa-mark~="below-strip"]')
        label = panel.get_by_text("Export", exact=True).last
        label.scroll_into_view_if_needed()
        tab.click_in(label)
        heading.wait_for()


LEFTMOST = """() => {
  window.__leftmost = Infinity;
  const look = () => {
    for (const notice of document.querySelectorAll(".mantine-Notifications-notification")) {
      window.__leftmost = Math.min(window.__leftmost, notice.getBoundingClientRect().left);
    }
    if (window.__looks) requestAnimationFrame(look);
  };
  window.__looks = true;
  look();
}"""
"""Notes how far to the left a notice is in any picture of the browser [px]."""


def test_a_notice_never_moves_over_the_left_dock(tab: Tab) -> None:
    tab.page.evaluate(LEFTMOST)
    tab.session.notify("A notice", "that comes and stays")
    tab.page.get_by_text("that comes and stays").wait_for()
    tab.wait_frames(500)
    leftmost = tab.page.evaluate("(window.__looks = false, window.__leftmost)")
    width, folded = left_dock(tab.state, tab.session.window)
    assert not folded
    assert leftmost >= width


EXPORTS: dict[str, tuple[str, Callable[[bytes], bool]]] = {
    "SVG": ("svg", lambda content: b"<svg" in content and "τ₁".encode() in content),
    "Robot as GLB": ("glb", lambda content: content.startswith(b"glTF")),
    "View as PNG": ("png", has_content),
}
"""Buttons, with the ending of the file that comes down and what tells that it is right: a text,
bytes, and a picture that the page makes itself."""


def test_exports_are_downloaded(drawn: Tab) -> None:
    drawn.page.set_viewport_size(LOW)
    drawn.dispatch(lambda s: actions.move(s, x=0.05, y=-0.03, theta=0.4))
    drawn.wait_pose(0, 0.05)
    open_exports(drawn)
    for button, (suffix, correct) in EXPORTS.items():
        place = drawn.page.get_by_role("button", name=button, exact=True).first
        name, content = download(drawn, place.click)
        assert name.endswith(f".{suffix}"), button
        assert correct(content), button


DROP = """name => {
  const files = new DataTransfer();
  files.items.add(new File(["schema_version = 1"], name));
  const options = { dataTransfer: files, bubbles: true, cancelable: true };
  const isOurs = (kind) => !document.body.dispatchEvent(new DragEvent(kind, options));
  return ["dragover", "drop"].every(isOurs);
}"""
"""Drops a file on the page; returns whether the browser leaves it to the page."""


def test_design_file_restores_a_design_and_a_broken_one_changes_nothing(
    tab: Tab, tmp_path: Path
) -> None:
    tab.dispatch(lambda s: actions.vary(s, {"links.b3": 0.777, "payload.mass": 3.0}))
    until(lambda: tab.state.document.design.links.b3 == 0.777, "the design changes")
    saved = tab.state.document.design
    tab.open_tab("File")
    button = tab.page.get_by_role("button", name="Download as TOML")
    _, content = download(tab, button.click)
    assert read_design(content, "download") == saved
    tab.page.get_by_test_id("gallery").get_by_text("Appendix 4", exact=True).click()
    until(lambda: tab.state.document.design == APPENDIX_4, "Appendix 4 is back")
    tab.upload("Open a file…", "broken.toml", content.replace(b"b3_kg = 0.777", b"b3_kg = -1"))
    tab.page.get_by_text("b3_kg").first.wait_for()
    large = tmp_path / "mine.toml"
    large.touch()
    os.truncate(large, Limits.upload_bytes + 1)
    tab.choose_file("Open a file…", large)
    tab.page.get_by_text("mine.toml: is larger than 10 MB").wait_for()
    assert tab.page.evaluate(DROP, "mine.toml")
    tab.page.get_by_text("mine.toml: drop no files on the page").wait_for()
    assert tab.state.document.design == APPENDIX_4
    tab.upload("Open a file…", "mine.toml", content)
    until(lambda: tab.state.document.design == saved, "the upload restores the design")


def test_click_on_a_map_moves_the_robot_there(tab: Tab) -> None:
    tab.open_tab("Torque maps")
    tab.page.locator("[data-paminsa-picture][src]:visible").first.wait_for()
    tab.click_map(0.12, 0.08)
    until(
        lambda: tab.state.last_reachable.pose[:2] == pytest.approx((0.12, 0.08), abs=PIXEL),
        lambda: f"it is at {tab.state.last_reachable.pose}; the page says {tab.last_messages()}",
    )


def test_an_example_is_one_click_and_one_key_press(tab: Tab) -> None:
    tab.open_tab("File")
    gallery = tab.page.get_by_test_id("gallery")
    cards = gallery.get_by_role("button")
    assert cards.count() == len(EXAMPLES)
    gallery.get_by_text("Heavy payload").click()
    until(lambda: tab.state.document.design.payload.mass == 10.0, "the payload is there")
    cards.nth(2).press("Enter")
    until(lambda: tab.state.springs.outcome, "the springs are fitted", COMPUTING)
    tab.open_tab("Answer")
    number = tab.page.get_by_text("91 N/m").first

    def seen() -> bool:
        # The drives of the payload may be chosen later than the springs, and open themselves.
        tab.dispatch(lambda state: replace(state, answer="springs.answer"))
        tab.wait_frames(300)
        return number.is_visible()

    until(seen, "the stiffness of the springs")


def test_motion_is_recorded_as_the_page_draws_it(drawn: Tab) -> None:
    tab = drawn
    tab.page.set_viewport_size(LOW)
    tab.dispatch(lambda s: motions.change(s, timing=Timing.GIVEN, duration=0.25))
    open_exports(tab)
    button = tab.page.get_by_role("button", name="GIF", exact=True)
    name, content = download(tab, button.click)
    assert name.endswith(".gif")
    image: Any = Image.open(io.BytesIO(content))
    assert image.n_frames == 5
    first = np.asarray(image.convert("RGB"), dtype=int)
    image.seek(image.n_frames - 1)
    last = np.asarray(image.convert("RGB"), dtype=int)
    moved = np.abs(last - first).max(axis=2) > 40
    assert 0.003 < moved.mean() < 0.5  # the robot, and not all of the picture
    until(lambda: not tab.state.recording.running, "the recording has ended")


SECURE = """value =>
  Object.defineProperty(window, "isSecureContext", {value, configurable: true})"""

READ = "() => navigator.clipboard.readText()"


@pytest.fixture
def copying(tab: Tab) -> Tab:
    """The tab, whose clipboard can be read, at a pose that gravity loads."""
    tab.page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    tab.dispatch(lambda s: actions.move(s, x=0.08, y=0.05, theta=np.pi / 3))
    until(lambda: "4.570" in tab.text("actuators"), "the torques of the pose")
    return tab


def test_motion_is_copied_from_the_export_tab(copying: Tab) -> None:
    tab = copying
    open_exports(tab)
    tab.page.get_by_role("button", name="Copy", exact=True).last.click()
    tab.page.get_by_text("Motion: paste it into a spreadsheet").wait_for()
    wanted = table_text(exports.motion_series(tab.state)[1])
    assert tab.page.evaluate(READ).replace("\r\n", "\n") == wanted


def test_any_table_is_copied_by_the_button_beside_it(copying: Tab) -> None:
    tab = copying
    table = tab.page.get_by_test_id("positions").locator("table").first
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
    assert rows[0] == ["Actuator", "Position", "Static torque"]
    assert rows[1][0] == "M1"
    assert rows[1][2] == "4.570 N·m"
    assert "-11.93" in rows[1][1]  # a hyphen: spreadsheets do not read a minus sign
    tab.dispatch(lambda s: pin(s, "condition"))
    pinned = tab.page.get_by_test_id("pins")
    pinned.locator("b").hover()
    until(lambda: button.inner_text() == "Copy", "the button is for the other table")
    button.click()
    until(lambda: button.inner_text() == "Copied", "the table is copied")
    # what takes a number off the strip is no part of it
    value = pinned.locator("b").inner_text()
    assert tab.page.evaluate(READ).strip().split("\t") == ["condition number κ", value]


def test_older_way_where_the_context_is_not_secure(copying: Tab) -> None:
    tab = copying
    tab.page.evaluate(SECURE, False)
    tab.page.evaluate("() => window.paminsa.copy('Words', 'one\\ttwo')")
    tab.page.get_by_text("Words: paste it into a spreadsheet").wait_for()
    assert tab.page.evaluate(READ) == "one\ttwo"
    tab.page.evaluate(SECURE, True)


def test_a_text_that_the_browser_takes_only_at_a_press_is_offered(copying: Tab) -> None:
    tab = copying
    # As Safari does: a text that comes from the server comes after the press that asked for it.
    tab.page.evaluate(SECURE, False)
    tab.page.evaluate("() => { document.execCommand = () => false; }")
    tab.page.evaluate("() => window.paminsa.copy('Words', 'three')")
    tab.page.get_by_text("Words: press “Copy” below the text").wait_for()
    tab.page.evaluate("() => { delete document.execCommand; }")
    offered = tab.page.get_by_role("dialog", name="Text to copy; Escape closes it")
    # Safari does not give a pressed button the focus, which must not close it before the click.
    tab.page.evaluate("() => document.activeElement.blur()")
    offered.get_by_role("button", name="Copy").click()
    tab.page.get_by_text("Words: paste it into a spreadsheet").last.wait_for()
    assert tab.page.evaluate(READ) == "three"
    assert offered.count() == 0
    tab.page.evaluate("() => { document.execCommand = () => false; }")
    tab.page.evaluate("() => window.paminsa.copy('Words', 'four')")
    offered.wait_for()
    tab.page.keyboard.press("Escape")
    assert offered.count() == 0
    tab.page.evaluate("() => { delete document.execCommand; }")
    tab.page.evaluate(SECURE, True)
