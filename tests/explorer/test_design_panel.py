"""The panel of the design's numbers on a session, and what it says of the balance."""

from __future__ import annotations

import re
from typing import Any

import pytest

from paminsa_viz.explorer import actions, bindings
from paminsa_viz.explorer.frame import compute
from paminsa_viz.explorer.panels.design_panel import (
    DESIGN,
    WHOLE_GROUP,
    balance_hint,
    gauge_html,
)
from paminsa_viz.explorer.state import initial_state
from paminsa_viz.model import APPENDIX_4, PARAMETERS, static_imbalance, static_torques
from paminsa_viz.units import number
from tests.explorer.design_rows import ROWS
from tests.support.desk import Desk
from tests.support.samples import random_design

MASSES = [p.path for p in PARAMETERS if p.unit == "kg"]


@pytest.mark.parametrize("path", MASSES)
def test_the_hint_says_what_a_kilogram_does_to_the_balance(path: str) -> None:
    import numpy as np

    design = random_design(np.random.default_rng(7))
    more = design.vary({path: design.value(path) + 1.0})
    effect = static_imbalance(more) - static_imbalance(design)
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
        text = gauge_html(compute(state))
        return [float(v) for v in re.findall(r"left:([-\d.]+)%", text)]

    zero, printed, present = places(0.28)
    assert zero == 50
    assert printed == present > 50
    zero, printed, present = places(0.28 + 9.1 / 3.27)
    assert present == pytest.approx(zero, abs=0.01)
    assert places(6.0)[2] < 50
    for m7 in (0.0, 0.28, 50.0):
        assert all(0 <= place <= 100 for place in places(m7))


PANEL = DESIGN


def slider(desk: Desk, path: str) -> Any:
    """Return the slider of a number."""
    return desk.handle(f"design.{path}")


def test_a_mass_slider_changes_the_mass_and_the_balance(desk: Desk) -> None:
    before = desk.until(lambda: desk.handle("design.gauge").content)
    desk.set(slider(desk, "links.b3"), 0.5)
    desk.until(lambda: desk.design.links.b3 == 0.5)
    expected = f"{static_imbalance(desk.design):.3f} N"
    desk.until(lambda: expected in desk.handle("design.gauge").content)
    assert expected not in before


def test_lengths_are_set_in_millimeters(desk: Desk) -> None:
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
    handle, most = slider(desk, "links.b3"), ROWS["links.b3"].range[1]
    desk.set(handle, 12.5)
    desk.until(lambda: desk.design.links.b3 == 12.5)
    desk.until(lambda: handle.max > 12.5)
    desk.set(handle, 0.5)  # still in hand: the range stays as it is
    desk.until(lambda: desk.design.links.b3 == 0.5)
    assert handle.max > 12.5
    desk.dispatch(lambda s: actions.reset_values(s, ("links.b3",)))
    desk.until(lambda: (handle.value, handle.max) == (0.406, most))


def test_a_number_below_the_slider_holds_if_it_is_possible(desk: Desk) -> None:
    handle = slider(desk, "geometry.magnification")
    desk.set(handle, 1.32)
    desk.until(lambda: desk.design.geometry.magnification == 1.32)
    desk.until(lambda: handle.min == 1.32)


def test_an_impossible_number_changes_nothing_is_told_and_set_back(
    desk: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bindings, "TYPING_TIMEOUT", 0.05)
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
    desk.dispatch(lambda s: actions.move(s, x=0.01))  # a frame is drawn meanwhile
    desk.until(lambda: desk.state.standing.pose[0] == 0.01)
    assert handle.value == 0.0
    desk.set(handle, 0.5)
    desk.until(lambda: desk.design.platform.mass == 0.5)
    assert handle.value == 0.5
    assert not desk.told


def test_the_newest_of_many_impossible_numbers_is_told_once(
    desk: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bindings, "TYPING_TIMEOUT", 0.2)
    handle = slider(desk, "geometry.magnification")
    for value in (1.25, 1.2, 1.15):  # a drag through what is impossible
        desk.set(handle, value)
        desk.until(lambda value=value: handle.value == value)
    desk.until(lambda: desk.told)
    desk.until(lambda: handle.value == 3.0)
    assert [text.partition(":")[0] for _, text in desk.told] == ["k = 1.15"]


def test_one_value_or_a_group_is_set_back_to_appendix_4(desk: Desk) -> None:
    reset = desk.handle("reset.links.")
    desk.until(lambda: desk.handle("design.gauge").content)
    assert not reset.visible
    desk.dispatch(lambda s: actions.vary(s, {"links.b3": 1.0, "links.b7": 1.0, "joints.j4": 1.0}))
    desk.until(lambda: tuple(reset.options) == ("m_B3", "m_B7", WHOLE_GROUP))
    desk.until(lambda: reset.visible)
    desk.set(reset, "m_B3")
    desk.until(lambda: desk.design.links.b3 == 0.406)
    desk.until(lambda: tuple(reset.options) == ("m_B7",))
    assert desk.design.links.b7 == 1.0
    desk.dispatch(lambda s: actions.vary(s, {"links.b3": 1.0}))
    desk.until(lambda: WHOLE_GROUP in reset.options)
    desk.set(reset, WHOLE_GROUP)
    desk.until(lambda: desk.design.links == APPENDIX_4.links)
    desk.until(lambda: not reset.visible)
    assert desk.design.joints.j4 == 1.0


def test_the_guide_stroke_follows_its_guide_until_it_is_set(desk: Desk) -> None:
    guide = slider(desk, "geometry.guide_link_length")
    stroke = slider(desk, "geometry.guide_stroke")
    reset = desk.handle("reset.geometry.arm")
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
