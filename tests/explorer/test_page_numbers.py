"""Numbers that are typed or pasted into the page's boxes."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core import motion as motions
from paminsa_viz.explorer.kit.design_numbers import label
from paminsa_viz.explorer.state.motion import Kind, Timing
from paminsa_viz.model import APPENDIX_4
from paminsa_viz.model.design import PARAMETER
from tests.support.chromium import Tab, until

pytestmark = pytest.mark.browser

X, THETA = "x  [mm]", "θ  [°]"

TEXTS = {
    "33.5": 33.5,
    "-7.25": -7.25,
    "−7,25": -7.25,
    "12,5": 12.5,
    "-500.5": -500.5,
    "1e1": 10.0,
    "2.5E-3": 0.0025,
    "+.5": 0.5,
    " 0,125 ": 0.125,
    "33.123456": 33.123456,
    "1e": None,
    "abc": None,
    "1,234": None,
    "1.234,5": None,
    "1 234": None,
    "1.2.3": None,
    "33.5 mm": None,
    "0x10": None,
    "1e400": None,
    "NaN": None,
    "": None,
    "1/2": 0.5,
    "2*35": 70.0,
    "1e-3*2": 0.002,
    "-(1+2)*3-1": -10.0,
    "0,5*2": 1.0,
    "1,234*2": None,
    "1/0": None,
    "2*": None,
    "(2": None,
}
WITH_UNITS = {
    ("50 mm", "mm"): 50.0,
    ("2*35mm", "mm"): 70.0,
    ("5 cm", "mm"): 50.0,
    ("0,05 m", "mm"): 50.0,
    ("1e3 mm", "mm"): 1000.0,
    ("500 g", "kg"): 0.5,
    ("90 deg", "°"): 90.0,
    ("3 N m", "N·m"): 3.0,
    ("9.81 m/s^2", "m/s²"): 9.81,
    ("50 kg", "mm"): None,
    ("1 m", "°"): None,
}


def test_text_is_one_number_or_none(tab: Tab) -> None:
    cases = {(text, ""): value for text, value in TEXTS.items()} | WITH_UNITS
    found = tab.page.evaluate(
        "cases => cases.map(([text, unit]) =>"
        " window.paminsaNumberFields.parse(text, unit).number ?? null)",
        list(cases),
    )
    assert dict(zip(cases, found, strict=True)) == cases
    for text in ("1e", "2.5E-"):  # a power of ten that is cut short, and no unit
        problem = tab.page.evaluate("t => window.paminsaNumberFields.parse(t, 'mm').problem", text)
        assert "is not a number" in problem
    typed(tab, tab.number_box(X), "2*1.5 cm")
    tab.wait_pose(0, 0.03)
    field = tab.number_box(X)
    field.click()
    field.press_sequentially("1 kg")
    field.press("Enter")
    assert "the field is in mm" in tab.page.locator(".pv-field-hint").inner_text()
    assert tab.state.document.pose[0] == pytest.approx(0.03)


def typed(tab: Tab, field: Any, text: str, key: str = "Enter") -> None:
    """Type a text into a box, key by key."""
    field.click()
    field.press_sequentially(text)
    if not text:
        field.press("Delete")
    field.press(key)
    tab.page.wait_for_timeout(60)


@pytest.mark.parametrize(
    ("index", "label", "factor"),
    [(0, X, 1e-3), (2, THETA, math.pi / 180)],
    ids=["length", "angle"],
)
def test_pose_takes_the_number_that_is_typed_and_shows_it(
    tab: Tab, index: int, label: str, factor: float
) -> None:
    field = tab.number_box(label)
    for text, shown in (("33.5", "33.5"), ("-7.25", "-7.25"), ("-400,5", "-400.5"), ("1e1", "10")):
        typed(tab, field, text)
        wanted = float(text.replace(",", ".")) * factor
        until(lambda w=wanted: abs(tab.state.document.pose[index] - w) < 1e-12, text)
        until(
            lambda s=shown: field.input_value() == s,
            lambda t=text, s=shown: f"{t} is shown as {s}, not {field.input_value()}",
        )
    for text in ("abc", "", "1,234", "1.2.3"):
        typed(tab, field, text)
        assert field.input_value() == "10"
        assert (tab.page.locator(".pv-field-hint").filter(has_text=text).count() > 0) == bool(text)
    tab.wait_frames(300)
    assert tab.state.document.pose[index] == pytest.approx(10 * factor, abs=1e-12)


BOXES = """() => [...document.querySelectorAll(
  '[data-paminsa-mark~="number-row"][data-paminsa-mark~="slider-row"]')]
  .filter(row => row.querySelector("label") && row.getClientRects().length)
  .map(row => Math.round(row.querySelector("input").getBoundingClientRect().left))"""


def test_boxes_of_sliders_stand_below_each_other_with_and_without_a_unit(tab: Tab) -> None:
    """k has no unit. No value is over a handle: over the first one it was cut off."""
    tab.open_tab("Lengths")
    until(lambda: len(tab.page.evaluate(BOXES)) > 8, "the boxes", 10)
    until(lambda: len(set(tab.page.evaluate(BOXES))) == 1, lambda: str(tab.page.evaluate(BOXES)), 5)
    tab.open_tab("Pose")
    (slider, *_) = [one for one in tab.page.get_by_role("slider").all() if one.is_visible()]
    slider.hover()
    tab.page.mouse.down()
    seen = "() => [...document.querySelectorAll('.mantine-Slider-label')].map(e => e.offsetHeight)"
    heights = tab.page.evaluate(seen)
    tab.page.mouse.up()
    assert heights
    assert not any(heights)


def test_the_next_box_takes_a_click_through_a_hint_and_ends_it(tab: Tab) -> None:
    typed(tab, tab.number_box(X), "1.2.3")
    hint, y = tab.page.locator(".pv-field-hint"), tab.number_box("y  [mm]")
    shown, box = hint.bounding_box(), y.bounding_box()
    assert shown is not None
    assert box is not None
    assert shown["y"] < box["y"] + box["height"] / 2 < shown["y"] + shown["height"]
    y.click(timeout=3000)  # before it goes by itself
    assert hint.count() == 0
    assert y.evaluate("box => box === document.activeElement")


def test_every_kind_of_box_takes_decimals_and_pasted_text(tab: Tab) -> None:
    tab.open_tab("Masses")
    mass = tab.number_box("m₇ B3, B7 [kg]")
    tab.page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    tab.page.evaluate("navigator.clipboard.writeText('1,5')")
    mass.click()
    mass.press("Control+v")
    mass.press("Tab")
    until(lambda: tab.state.document.design.joints.j7 == 1.5, "the mass")
    tab.open_tab("Path")
    tab.dispatch(lambda s: motions.choose_kind(s, Kind.ARCH))
    tab.open_tab("Torque maps")
    typed(tab, tab.element("Ends"), "-12,75")
    until(lambda: tab.state.map_view.low == -12.75, "the low end of the colors")


def test_box_steps_with_arrow_keys(tab: Tab) -> None:
    field = tab.number_box(THETA)
    typed(tab, field, "7.25", "ArrowUp")
    tab.wait_pose(2, np.radians(7.75))
    field.press("ArrowDown")
    tab.wait_pose(2, np.radians(7.25))
    until(lambda: field.input_value() == "7.25", "the box follows")


def test_motion_that_plays_does_not_overwrite_a_box_that_is_edited(tab: Tab) -> None:
    slow = {"timing": Timing.GIVEN, "duration": 20.0, "kind": Kind.MOVE}
    tab.dispatch(lambda s: motions.play(motions.change(s, **slow)))
    until(lambda: tab.state.playback.time > 0.1, "it plays")
    field = tab.number_box(X)
    field.click()
    first = field.input_value()
    until(lambda: field.input_value() != first, "a box that is not edited yet follows")
    time = tab.state.playback.time
    field.press_sequentially("-3")
    until(lambda: tab.state.playback.time > time + 0.5, "it plays on")
    assert field.input_value() == "-3"
    field.press_sequentially("0.5")
    field.press("Enter")
    tab.wait_pose(0, -0.0305)
    assert not tab.state.playback.following


def test_range_widened_by_a_typed_number_returns_with_the_value(tab: Tab) -> None:
    def top() -> float:
        return float(tab.slider(X).get_attribute("aria-valuemax") or "nan")

    before = top()
    typed(tab, tab.number_box(X), "5000")
    until(lambda: top() >= 5000, "the range grows")
    typed(tab, tab.number_box(X), "20")
    until(lambda: top() == before, "the range returns")


def test_stroke_typed_as_it_is_and_no_singular_rotation(tab: Tab) -> None:
    tab.open_tab("Masses")
    tab.open_tab("Lengths")
    field = tab.number_box("|X₄| max [mm]")
    typed(tab, field, field.input_value())
    tab.wait_frames(200)
    assert tab.state.document.design == APPENDIX_4
    assert tab.state.document.design.name == APPENDIX_4.name
    wide = {"geometry.base_radius": 0.09, "geometry.platform_radius": 0.1}
    tab.dispatch(lambda s: actions.vary(s, wide))
    tab.open_tab("Pose")
    until(lambda: "none" in tab.text("quality"), "no rotation is singular")
    assert "inf" not in tab.text("quality") + tab.text("status")


def test_a_number_longer_than_its_box_is_shown_shorter_and_edited_as_it_is(tab: Tab) -> None:
    """Cut off, 3.8e-8 was read as 0.00000003 and 1e14 as 10000000."""
    first = {"inertias.b3_axial": 3.8e-8, "elastic.drive_linear": 1e17, "links.b1": 0.0012}
    tab.dispatch(lambda s: actions.vary(s, first))
    tab.open_tab("Masses")
    tab.unfold("Inertias of the links")

    def box(path: str) -> Any:
        return tab.number_box(label(PARAMETER[path]))

    def seen(path: str) -> str | None:
        over = "box => getComputedStyle(box.parentElement, '::after').content"
        content = box(path).evaluate(over).partition('"')[2]
        return content.partition('"')[0] or box(path).input_value()

    def shows(path: str, text: str) -> None:
        until(lambda: seen(path) == text, lambda: f"{path} is shown as {seen(path)}, not {text}", 5)

    shows("inertias.b3_axial", "3.8e-8")  # whose folder was shut
    shows("links.b1", "0.0012")
    tab.dispatch(lambda s: actions.vary(s, {"links.b1": 1234.56789}))
    until(lambda: box("links.b1").input_value() == "1234.56789", "the number", 5)
    # as many digits as the browser's font leaves room for
    until(lambda: len(seen("links.b1") or "") < 10, "the number is shortened", 5)
    assert float(seen("links.b1") or "nan") == pytest.approx(1234.56789, abs=6e-3)
    field = box("links.b1")
    field.click()
    shows("links.b1", "1234.56789")
    assert field.evaluate("box => box.scrollWidth <= box.clientWidth")
    field.press("End")
    field.press_sequentially("5")
    field.press("Tab")
    until(lambda: tab.state.document.design.links.b1 == 1234.567895, "all digits are kept", 5)
    tab.open_tab("Stiffness")
    shows("elastic.drive_linear", "1e14")
