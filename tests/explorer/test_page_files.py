"""Files in a browser: every export is downloaded, design files open, clicks on maps arrive."""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from paminsa_viz.explorer import actions
from paminsa_viz.explorer.examples import EXAMPLES
from paminsa_viz.explorer.motion import actions as motions
from paminsa_viz.explorer.motion.description import Timing
from paminsa_viz.files.design_file import read_design
from paminsa_viz.model import APPENDIX_4
from tests.support.chromium import Tab, until

pytestmark = pytest.mark.browser


def download(tab: Tab, click: Callable[[], Any]) -> tuple[str, bytes]:
    """Click something and return the name and the content of the file that comes down."""
    with tab.page.expect_download() as waiting:
        click()
    return waiting.value.suggested_filename, Path(waiting.value.path()).read_bytes()


def has_content(png: bytes) -> bool:
    """Whether a picture is not of one color."""
    return np.asarray(Image.open(io.BytesIO(png)).convert("RGB")).std() > 5


@pytest.mark.parametrize(
    ("button", "suffix", "correct"),
    [
        ("PNG", "png", has_content),
        ("SVG", "svg", lambda content: b"<svg" in content and "τ₁".encode() in content),
        ("PDF", "pdf", lambda content: content.startswith(b"%PDF") and b"%%EOF" in content[-64:]),
        ("CSV", "csv", lambda content: b"tau1_Nm" in content),
        ("NPZ", "npz", lambda content: len(np.load(io.BytesIO(content)).files) > 3),
        ("Robot as GLB", "glb", lambda content: content.startswith(b"glTF")),
        ("View as PNG", "png", has_content),
        ("MJCF", "xml", lambda content: b"<mujoco" in content),
        ("MJCF with meshes", "zip", lambda content: content.startswith(b"PK")),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_every_export_is_downloaded(
    tab: Tab, button: str, suffix: str, correct: Callable[[bytes], bool]
) -> None:
    tab.dispatch(lambda s: actions.move(s, x=0.05, y=-0.03, theta=0.4))
    tab.wait_pose(0, 0.05)
    tab.open_tab("Export")
    place = tab.page.get_by_role("button", name=button, exact=True).first
    name, content = download(tab, place.click)
    assert name.endswith(f".{suffix}")
    assert correct(content)


def test_design_file_restores_a_design_and_a_broken_one_changes_nothing(tab: Tab) -> None:
    tab.dispatch(lambda s: actions.vary(s, {"links.b3": 0.777, "payload.mass": 3.0}))
    until(lambda: tab.state.document.design.links.b3 == 0.777, "the design changes")
    saved = tab.state.document.design
    tab.open_tab("File")
    button = tab.page.get_by_role("button", name="Download as TOML")
    _, content = download(tab, button.click)
    assert read_design(content, "download") == saved
    tab.page.get_by_test_id("gallery").get_by_text("Appendix 4", exact=True).click()
    until(lambda: tab.state.document.design == APPENDIX_4, "Appendix 4 is back")
    tab.upload(".toml", "broken.toml", content.replace(b"b3_kg = 0.777", b"b3_kg = -1"))
    tab.page.get_by_text("b3_kg").first.wait_for()
    assert tab.state.document.design == APPENDIX_4
    tab.upload(".toml", "mine.toml", content)
    until(lambda: tab.state.document.design == saved, "the upload restores the design")


def test_click_on_a_map_moves_the_robot_there(tab: Tab) -> None:
    tab.open_tab("Torque maps")
    plot = tab.page.locator(".js-plotly-plot:visible .nsewdrag").first
    plot.wait_for(state="attached")
    tab.click_in(plot, 0.56, 0.45)
    until(lambda: tab.state.last_reachable.pose[0] > 0.02, "the robot moves to the right")
    assert tab.state.last_reachable.pose[1] > 0.01


def test_an_example_is_one_click_and_one_key_press(tab: Tab) -> None:
    tab.open_tab("File")
    gallery = tab.page.get_by_test_id("gallery")
    cards = gallery.get_by_role("button")
    assert cards.count() == len(EXAMPLES)
    gallery.get_by_text("Heavy payload").click()
    until(lambda: tab.state.document.design.payload.mass == 10.0, "the payload is there")
    cards.nth(2).press("Enter")
    until(lambda: tab.state.springing.outcome, "the springs are fitted")
    tab.open_tab("Balance")
    tab.page.get_by_text("Springs", exact=True).click()
    tab.page.get_by_text("91 N/m").wait_for()


def test_motion_is_recorded_as_the_page_draws_it(tab: Tab) -> None:
    tab.dispatch(lambda s: motions.change(s, timing=Timing.GIVEN, duration=0.5))
    tab.open_tab("Export")
    button = tab.page.get_by_role("button", name="GIF", exact=True)
    name, content = download(tab, button.click)
    assert name.endswith(".gif")
    image: Any = Image.open(io.BytesIO(content))
    assert image.n_frames == 9
    first = np.asarray(image.convert("RGB"), dtype=int)
    image.seek(image.n_frames - 1)
    last = np.asarray(image.convert("RGB"), dtype=int)
    moved = np.abs(last - first).max(axis=2) > 40
    assert 0.003 < moved.mean() < 0.5  # the robot, and not all of the picture
    until(lambda: not tab.state.recording.running, "the recording has ended")
