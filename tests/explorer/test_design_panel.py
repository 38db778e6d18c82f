"""The panel of the design's numbers."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import pytest
import viser
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.explorer import actions
from paminsa_viz.explorer.bounds import largest
from paminsa_viz.explorer.panels import patient
from paminsa_viz.explorer.panels.design_layout import GROUPS
from paminsa_viz.explorer.panels.design_panel import (
    WHOLE_GROUP,
    DesignPanel,
    balance_hint,
    balance_html,
)
from paminsa_viz.explorer.panels.number_row import Row, fitted_range, round_up
from paminsa_viz.explorer.server import open_server
from paminsa_viz.explorer.state import initial_state
from paminsa_viz.explorer.symbols import change_text, edge, html, number, plain, unit_text
from paminsa_viz.model import APPENDIX_4, PARAMETERS, balance_distance, static_torques
from tests.samples import random_design

from .chromium import Tab, until
from .panel_desk import Desk, desk_with

ROWS = {row.path: row for group in GROUPS for row in group.rows}
MASSES = [p.path for p in PARAMETERS if p.unit == "kg"]


# What stands where


def test_every_number_of_a_design_is_offered_once() -> None:
    offered = [row.path for group in GROUPS for row in group.rows]
    assert sorted(offered) == sorted(p.path for p in PARAMETERS)


def test_labels_tell_the_numbers_apart_and_are_short_enough_for_their_column() -> None:
    labels = [row.label for row in ROWS.values()]
    assert len(set(labels)) == len(labels)
    assert max(map(len, labels)) <= 18  # 97 px hold about that many
    for parameter in PARAMETERS:
        assert ROWS[parameter.path].label.startswith(plain(parameter.symbol))


@pytest.mark.parametrize("row", ROWS.values(), ids=lambda row: row.path)
def test_a_slider_reaches_appendix_4_and_only_what_is_possible(row: Row) -> None:
    shown = edge(row.path)
    default = shown.shown(APPENDIX_4.value(row.path))
    assert row.low <= default <= row.high
    steps = (default - row.low) / row.step if row.low == 0 else default / row.step
    assert steps == pytest.approx(round(steps), abs=1e-6)  # it can be dragged back to it
    for end in (row.low, row.high):
        value = shown.inside(end)
        design = actions.vary(initial_state(), {row.path: value}).document.design
        assert design.value(row.path) == value


@given(path=st.sampled_from(sorted(ROWS)), fraction=st.floats(0, 1))
def test_a_range_grows_to_what_is_typed_and_leaves_room(path: str, fraction: float) -> None:
    row, most = ROWS[path], edge(path).shown(largest(path))
    value = row.low + fraction * (most - row.low)
    low, high = fitted_range(row, row.low, row.high, value)
    assert low <= value <= high <= most
    assert (low, high) == (row.low, row.high) or value > row.high
    assert fitted_range(row, low, high, value) == (low, high)
    if row.high < value < most / 1.6:
        assert 1.2 < high / value < 2.1


@given(value=st.floats(1e-9, 1e9))
def test_rounding_up_gives_a_number_that_reads_well(value: float) -> None:
    up = round_up(value)
    assert value * (1 - 1e-9) <= up <= 1.51 * value
    assert len(f"{up:.10g}".split("e")[0].replace(".", "").strip("0")) <= 2


# Symbols, units and numbers as text


@pytest.mark.parametrize(
    ("symbol", "label", "markup"),
    [
        ("m_5", "m₅", "<i>m</i><sub>5</sub>"),
        ("m_B10", "m_B10", "<i>m</i><sub>B10</sub>"),
        ("I_XX^(B3)", "I_XX(B3)", "<i>I</i><sub>XX</sub><sup>(B3)</sup>"),
        (
            "l_B4 = k l_B7",
            "l_B4 = k·l_B7",
            "<i>l</i><sub>B4</sub> = <i>k</i>·<i>l</i><sub>B7</sub>",
        ),
        ("|X_4| max", "|X₄| max", "|<i>X</i><sub>4</sub>| max"),
        ("g", "g", "<i>g</i>"),
    ],
)
def test_symbols_read_like_the_paper(symbol: str, label: str, markup: str) -> None:
    assert plain(symbol) == label
    assert html(symbol) == markup


def test_units_read_like_units() -> None:
    assert unit_text("kg m^2") == "kg·m²"
    assert unit_text("N m s/rad") == "N·m·s/rad"
    assert unit_text("m/s^2") == "m/s²"
    assert unit_text("rad/s, m/s") == "rad/s, m/s"


@given(path=st.sampled_from(sorted(ROWS)), value=st.floats(1e-6, 100))
def test_a_value_is_the_same_after_a_visit_to_the_page(path: str, value: float) -> None:
    shown = edge(path)
    assert shown.inside(shown.shown(value)) == pytest.approx(value, abs=1e-9)
    assert shown.inside(round(shown.shown(value), 3)) == pytest.approx(value, abs=1e-3)


def test_appendix_4_is_the_same_to_the_last_digit_after_a_visit_to_the_page() -> None:
    for path in ROWS:
        value = APPENDIX_4.value(path)
        assert edge(path).inside(edge(path).shown(value)) == value


def test_lengths_are_in_millimetres() -> None:
    assert edge("geometry.guide_link_length").text(0.3635) == "363.5 mm"
    assert edge("links.b3").text(0.406) == "0.406 kg"
    assert edge("geometry.magnification").text(3.0) == "3"


@given(value=st.floats(-1e12, 1e12))
def test_a_number_can_be_read_back(value: float) -> None:
    text = number(value)
    plain_text = text.translate(str.maketrans("−⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "-0123456789-")).replace("·10", "e")
    assert float(plain_text) == pytest.approx(value, rel=1e-5, abs=1e-300)
    assert "-" not in text
    assert text != "−0"


def test_changes_are_percentages_of_where_they_started() -> None:
    assert change_text(2.0, 3.0) == "+50.0 %"
    assert change_text(2.0, 1.0) == "−50.0 %"
    assert change_text(-2.0, -1.0) == "−50.0 %"
    assert change_text(1.0, 5.0) == "+400 %"
    assert change_text(1.0, 50.0) == "×50"
    assert change_text(1.0, 1.0 + 1e-9) == "≈ 0 %"
    assert change_text(0.0, 5.0) == "new"


# What the masses come to


@pytest.mark.parametrize("path", MASSES)
def test_the_hint_says_what_a_kilogram_does_to_the_balance(path: str) -> None:
    import numpy as np

    design = random_design(np.random.default_rng(7))
    more = design.vary({path: design.value(path) + 1.0})
    effect = balance_distance(more) - balance_distance(design)
    hint = balance_hint(path, design.geometry, design.gravity)
    if abs(effect) < 1e-9:
        assert "do not depend" in hint
        pose = (0.0, 0.02, 0.1, -0.6 * design.geometry.coupler_length)
        here, there = (static_torques(d, pose)[:3] for d in (design, more))
        assert here == pytest.approx(there, abs=1e-9)
    else:
        word, size = re.search(r"(raises|lowers) M_p2 by ([\d.]+) N", hint).groups()  # type: ignore[union-attr]
        assert float(size) * (1 if word == "raises" else -1) == pytest.approx(effect, rel=1e-3)


def test_the_balance_shows_zero_at_the_middle_and_minus_to_its_left() -> None:
    def places(m7: float) -> list[float]:
        state = actions.vary(initial_state(), {"joints.j7": m7})
        text = balance_html(state, balance_distance(state.document.design))
        return [float(v) for v in re.findall(r"left:([-\d.]+)%", text)]

    zero, printed, present = places(0.28)
    assert zero == 50
    assert printed == present > 50
    zero, printed, present = places(0.28 + 9.1 / 3.27)
    assert present == pytest.approx(zero, abs=0.01)
    assert places(6.0)[2] < 50
    for m7 in (0.0, 0.28, 50.0):
        assert all(0 <= place <= 100 for place in places(m7))


# On a session


@pytest.fixture(scope="module")
def server() -> Iterator[viser.ViserServer]:
    running = open_server(port=0)
    yield running
    running.stop()


@pytest.fixture
def desk(server: viser.ViserServer) -> Iterator[Desk]:
    with desk_with(server, DesignPanel) as desk:
        yield desk


def slider(desk: Desk, path: str) -> Any:
    """Return the slider of a number."""
    return next(r.slider for f in desk.panel.folders for r in f.rows if r.row.path == path)


def folder(desk: Desk, path: str) -> Any:
    """Return the folder that a number stands in."""
    return next(f for f in desk.panel.folders if any(r.row.path == path for r in f.rows))


def test_a_mass_slider_changes_the_mass_and_the_balance(desk: Desk) -> None:
    before = desk.until(lambda: desk.panel.balance.content)
    desk.set(slider(desk, "links.b3"), 0.5)
    desk.until(lambda: desk.design.links.b3 == 0.5)
    expected = f"{balance_distance(desk.design):.3f} N"
    desk.until(lambda: expected in desk.panel.balance.content)
    assert expected not in before


def test_lengths_are_set_in_millimetres(desk: Desk) -> None:
    desk.set(slider(desk, "geometry.base_radius"), 333.3)
    desk.until(lambda: desk.design.geometry.base_radius == 0.3333)


def test_five_hundred_values_of_a_drag_end_at_the_last_one(desk: Desk) -> None:
    handle = slider(desk, "links.b4")
    for i in range(1, 501):
        desk.set(handle, i / 250)
    desk.until(lambda: desk.design.links.b4 == 2.0)
    desk.session.undo()
    desk.until(lambda: desk.design == APPENDIX_4)
    desk.until(lambda: handle.value == 0.672)


def test_a_typed_number_beyond_the_slider_holds_and_the_slider_grows(desk: Desk) -> None:
    handle, most = slider(desk, "links.b3"), ROWS["links.b3"].high
    desk.set(handle, 12.5)
    desk.until(lambda: desk.design.links.b3 == 12.5)
    desk.until(lambda: handle.max > 12.5)
    desk.set(handle, 0.5)  # still in hand: the range stays as it is
    desk.until(lambda: desk.design.links.b3 == 0.5)
    assert handle.max > 12.5
    desk.ask(lambda s: actions.reset_values(s, ("links.b3",)))
    desk.until(lambda: (handle.value, handle.max) == (0.406, most))


def test_a_number_below_the_slider_holds_if_it_is_possible(desk: Desk) -> None:
    handle = slider(desk, "geometry.magnification")
    desk.set(handle, 1.32)
    desk.until(lambda: desk.design.geometry.magnification == 1.32)
    desk.until(lambda: handle.min == 1.32)


def test_an_impossible_number_changes_nothing_is_told_and_set_back(
    desk: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(patient, "PATIENCE", 0.05)
    cases = {
        "platform.mass": (0.0, "m_pl = 0 kg", "above 0"),
        "links.b7": (-1.0, "m_B7 = −1 kg", "at least 0"),
        "geometry.magnification": (1.1, "k = 1.1", "close the pantograph"),
        "geometry.base_radius": (99_999.0, "R_b = 99999 mm", "close the pantograph"),
        "joints.j2": (2e4, "m₂ = 20000 kg", "10000"),
    }
    for path, (value, title, reason) in cases.items():
        handle, before = slider(desk, path), slider(desk, path).value
        desk.told.clear()
        desk.set(handle, value)
        desk.until(lambda: desk.told)
        (told,) = desk.told
        assert title in told[1]
        assert reason in told[1]
        desk.until(lambda handle=handle, before=before: handle.value == before)
        assert desk.design == APPENDIX_4
    assert not desk.session.can_undo


def test_typing_through_an_impossible_number_is_not_interrupted(desk: Desk) -> None:
    handle = slider(desk, "platform.mass")
    desk.set(handle, 0.0)  # "0", then "0.", then "0.5"
    desk.until(lambda: handle.value == 0.0)
    desk.ask(lambda s: actions.move(s, x=0.01))  # a frame is drawn meanwhile
    desk.until(lambda: desk.state.standing.pose[0] == 0.01)
    assert handle.value == 0.0
    desk.set(handle, 0.5)
    desk.until(lambda: desk.design.platform.mass == 0.5)
    assert handle.value == 0.5
    assert not desk.told


def test_the_newest_of_many_impossible_numbers_is_told_once(
    desk: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(patient, "PATIENCE", 0.2)
    handle = slider(desk, "geometry.magnification")
    for value in (1.25, 1.2, 1.15):  # a drag through what is impossible
        desk.set(handle, value)
        desk.until(lambda value=value: handle.value == value)
    desk.until(lambda: desk.told)
    desk.until(lambda: handle.value == 3.0)
    assert [text.partition(":")[0] for _, text in desk.told] == ["k = 1.15"]


def test_one_value_or_a_group_is_set_back_to_appendix_4(desk: Desk) -> None:
    reset = folder(desk, "links.b3").reset
    desk.until(lambda: desk.panel.balance.content)
    assert not reset.visible
    desk.ask(lambda s: actions.vary(s, {"links.b3": 1.0, "links.b7": 1.0, "joints.j4": 1.0}))
    desk.until(lambda: tuple(reset.options) == ("m_B3", "m_B7", WHOLE_GROUP))
    desk.until(lambda: reset.visible)
    desk.set(reset, "m_B3")
    desk.until(lambda: desk.design.links.b3 == 0.406)
    desk.until(lambda: tuple(reset.options) == ("m_B7",))
    assert desk.design.links.b7 == 1.0
    desk.ask(lambda s: actions.vary(s, {"links.b3": 1.0}))
    desk.until(lambda: WHOLE_GROUP in reset.options)
    desk.set(reset, WHOLE_GROUP)
    desk.until(lambda: desk.design.links == APPENDIX_4.links)
    desk.until(lambda: not reset.visible)
    assert desk.design.joints.j4 == 1.0


def test_the_guide_stroke_follows_its_guide_until_it_is_set(desk: Desk) -> None:
    guide = slider(desk, "geometry.guide_link_length")
    stroke = slider(desk, "geometry.guide_stroke")
    reset = folder(desk, "geometry.guide_stroke").reset
    desk.set(guide, 400.0)
    desk.until(lambda: stroke.value == 400.0)
    desk.until(lambda: tuple(reset.options) == ("l_B10",))  # the stroke itself is not set
    desk.set(stroke, 300.0)
    desk.until(lambda: desk.design.geometry.guide_stroke == 0.3)
    desk.set(guide, 410.0)
    desk.until(lambda: desk.design.geometry.guide_link_length == 0.41)
    assert stroke.value == 300.0
    desk.set(reset, "|X₄| max")
    desk.until(lambda: desk.design.geometry.guide_stroke is None)
    desk.until(lambda: stroke.value == 410.0)


def test_hints_follow_the_geometry(desk: Desk) -> None:
    handle = slider(desk, "joints.j7")
    desk.until(lambda: "lowers M_p2 by 3.27 N" in (handle.hint or ""))
    assert "Appendix 4: 0.28 kg" in handle.hint
    desk.set(slider(desk, "geometry.magnification"), 4.0)
    desk.until(lambda: f"lowers M_p2 by {number(9.81 / 4, 4)} N" in (handle.hint or ""))


# In a browser


def box(tab: Tab, label: str) -> Any:
    """Return the number box of a slider."""
    track = tab.page.locator(f'[id="{tab.handle(label)._impl.uuid}"]')
    return track.locator("xpath=..").locator("input:not([type=hidden])")


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
        labels = [row.label for group in groups for row in group.rows]
        uuids = [tab.handle(label)._impl.uuid for label in labels]

        def unfolded(uuids: list[str] = uuids) -> list[dict[str, float]] | None:
            found = tab.page.evaluate(MEASURE, uuids)
            return found if all(seen["height"] > 12 for seen in found) else None

        for label, seen in zip(labels, until(unfolded, name), strict=True):
            assert seen["height"] < 24, f"{label} takes two lines"
            assert seen["right"] < seen["left"], f"{label} runs into its number"
            assert seen["room"] >= 0, f"the number of {label} is cut off"
            assert seen["end"] <= width, f"the number of {label} is off the page"
