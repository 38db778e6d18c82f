"""The design's numbers: labels, ranges, hints, resets, the static imbalance, refused values."""

from __future__ import annotations

import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.explorer.core import actions, history
from paminsa_viz.explorer.core.frame import compute
from paminsa_viz.explorer.features.design.tab import (
    LENGTHS,
    LOAD,
    MASSES,
    WHOLE_GROUP,
    balance_hint,
)
from paminsa_viz.explorer.kit import bindings
from paminsa_viz.explorer.kit.design_numbers import (
    GROUPS,
    base_range,
    fitted_range,
    round_up,
    slider,
)
from paminsa_viz.explorer.kit.robot_texts import gauge_html
from paminsa_viz.explorer.state.state import initial_state
from paminsa_viz.model import (
    APPENDIX_4,
    PARAMETER,
    PARAMETERS,
    InvalidInput,
    Parameter,
    static_imbalance,
    static_torques,
)
from paminsa_viz.units import number, symbol_text
from tests.support.desk import Desk
from tests.support.samples import enlarged, prototype_times, random_design

PANEL = (*LENGTHS, *MASSES, *LOAD)
ROWS = {p.path: slider(p) for group in GROUPS for p in group.parameters}
MASSES = [p.path for p in PARAMETERS if p.unit == "kg"]


def test_every_number_of_a_design_has_one_slider_with_a_short_label() -> None:
    offered = [p.path for group in GROUPS for p in group.parameters]
    assert sorted(offered) == sorted(p.path for p in PARAMETERS), "GROUPS has each once"
    for path, row in ROWS.items():
        name, _, unit = str(row.label).partition(" [")
        assert len(name) <= 18  # 97 px hold about that many
        assert unit.rstrip("]") == PARAMETER[path].display.text
        assert str(row.label).startswith(symbol_text(PARAMETER[path].symbol))


@pytest.mark.parametrize("parameter", PARAMETERS, ids=lambda p: p.path)
def test_slider_reaches_appendix_4_and_only_possible_values(parameter: Parameter) -> None:
    row, shown = ROWS[parameter.path], parameter.display
    low, high, step = base_range(parameter)
    default = shown.from_si(parameter.default)
    assert low <= default <= high
    steps = (default - low) / step if low <= 0 else default / step
    assert steps == pytest.approx(round(steps), abs=1e-6)  # it can be dragged back to it
    for end in (low, high):
        state = row.apply(initial_state(), row.parse(initial_state(), end))
        assert shown.from_si(state.document.design.value(parameter.path)) == end


@given(path=st.sampled_from(sorted(ROWS)), fraction=st.floats(0, 1))
def test_range_grows_to_a_typed_value_with_some_margin(path: str, fraction: float) -> None:
    low, high, _ = base_range(PARAMETER[path])
    most = PARAMETER[path].display.from_si(PARAMETER[path].largest)
    value = low + fraction * (most - low)
    grown = fitted_range(path, (low, high), value)
    assert grown[0] <= value <= grown[1] <= most
    assert grown == (low, high) or value > high
    assert fitted_range(path, grown, value) == grown
    if high < value < most / 1.6:
        assert 1.2 < grown[1] / value < 2.3


@given(value=st.floats(1e-9, 1e9))
def test_rounding_up_gives_two_digits(value: float) -> None:
    up = round_up(value)
    assert value * (1 - 1e-9) <= up <= 1.51 * value
    assert len(f"{up:.10g}".split("e")[0].replace(".", "").strip("0")) <= 2


@pytest.mark.parametrize("path", MASSES)
def test_hint_of_a_mass_gives_its_effect_on_the_imbalance(path: str) -> None:
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
        found = re.search(r"(raises|lowers) M_p2 by ([\d.]+) N", hint)
        assert found is not None
        sign = 1 if found[1] == "raises" else -1
        assert sign * float(found[2]) == pytest.approx(effect, rel=1e-3)


def test_gauge_has_zero_at_its_middle_and_negative_values_left() -> None:
    def places(m7: float) -> list[float]:
        state = actions.vary(initial_state(), {"joints.j7": m7})
        return [float(v) for v in re.findall(r"left:([-\d.]+)%", gauge_html(compute(state)))]

    zero, default, current = places(0.28)
    assert zero == 50
    assert default == current > 50
    assert places(0.28 + 9.1 / 3.27)[2] == pytest.approx(zero, abs=0.01)
    assert places(6.0)[2] < 50
    assert all(0 <= place <= 100 for m7 in (0.0, 0.28, 50.0) for place in places(m7))


@pytest.mark.parametrize(
    ("path", "value", "name", "allowed"),
    [
        ("platform.mass", 0.0, "m_pl = 0 kg", "above 0"),
        ("links.b7", -1.0, "m_B7 = −1 kg", "at least 0"),
        ("geometry.magnification", 1.1, "k = 1.1", "close the pantograph"),
        ("geometry.base_radius", 99.999, "R_b = 99999 mm", "close the pantograph"),
        ("joints.j2", 2e4, "m₂ = 20000 kg", "10000"),
    ],
)
def test_refusal_names_the_number_that_was_set(
    path: str, value: float, name: str, allowed: str
) -> None:
    with pytest.raises(InvalidInput) as error:
        ROWS[path].apply(initial_state(), value)
    assert error.value.argument == name
    assert allowed in error.value.problem


@pytest.mark.slow
def test_last_of_150_values_of_a_drag_wins_and_is_one_step(
    desk: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(history, "PAUSE", 60.0)  # a busy machine is no pause of the person
    desk.until(lambda: "9.1" in desk.handle("design.gauge").content)
    for i in range(1, 151):  # the server takes more of them slowly
        desk.set("design.links.b4", i / 75)
    desk.until(lambda: desk.design.links.b4 == 2.0)
    text = f"{static_imbalance(desk.design):.3f}<"
    desk.until(lambda: text in desk.handle("design.gauge").content)
    desk.session.undo()
    desk.until(lambda: desk.design == APPENDIX_4)
    desk.until(lambda: desk.handle("design.links.b4").value == 0.672)


def test_slider_grows_to_a_typed_number_and_shrinks_after_a_reset(desk: Desk) -> None:
    handle = desk.handle("design.links.b3")
    ends = handle.min, handle.max
    desk.set("design.links.b3", 12.5)
    desk.until(lambda: desk.design.links.b3 == 12.5)
    desk.until(lambda: handle.max > 12.5)
    desk.set("design.links.b3", 0.5)  # still dragged: the range stays as it is
    desk.until(lambda: desk.design.links.b3 == 0.5)
    assert handle.max > 12.5
    desk.dispatch(lambda s: actions.reset_values(s, ("links.b3",)))
    desk.until(lambda: (handle.value, handle.min, handle.max) == (0.406, *ends))
    desk.set("design.geometry.magnification", 1.32)
    desk.until(lambda: desk.handle("design.geometry.magnification").min == 1.32)


def test_sliders_of_a_small_robot_have_ends_and_steps_of_its_size(desk: Desk) -> None:
    desk.dispatch(lambda state: actions.with_design(state, prototype_times(0.1)))
    for path, times in {
        "geometry.crank_length": 0.1, "links.b3": 1e-3, "inertias.b7_axial": 1e-5,
        "friction.coulomb_linear": 1e-3,
    }.items():  # fmt: skip
        handle = desk.handle(f"design.{path}")
        ends = [pytest.approx(times * number) for number in base_range(PARAMETER[path])]
        desk.until(lambda h=handle, e=ends: [h.min, h.max, h.step] == e)
        labels = [mark.label for mark in handle._marks or ()]
        # Appendix 4's values are beyond; the page writes the ends itself, with six decimals.
        shown = {"friction.coulomb_linear": ["0"], "inertias.b7_axial": ["0", "2.5·10⁻⁸"]}
        assert labels == shown.get(path, [])
    handle = desk.handle("design.inertias.b7_axial")
    for value in (8.5e-9, 8e-9):
        desk.dispatch(lambda state, v=value: actions.vary(state, {"inertias.b7_axial": v}))
        desk.until(lambda v=value: handle.value == v)
    desk.set("design.inertias.b7_axial", 7e-9)
    desk.until(lambda: desk.design.inertias.b7_axial == 7e-9)
    desk.dispatch(lambda state: actions.with_design(state, APPENDIX_4))
    desk.until(lambda: [mark.label for mark in handle._marks] == ["0.0008"])


def test_values_of_small_robots_are_not_at_the_low_end_of_their_sliders() -> None:
    """Masses of a robot of 1/25 were in the first fiftieth of the slider, inertias a hundredth."""
    for times in (0.3, 0.1, 0.04, 0.01):
        design = enlarged(APPENDIX_4, times)
        for path in ("geometry.crank_length", "links.b1", "inertias.b3_transverse"):
            _, high, step = base_range(PARAMETER[path], design.geometry)
            value = PARAMETER[path].display.from_si(design.value(path))
            assert 0.09 < value / high < 1.6, path
            assert step < 0.02 * value, path


def test_typing_through_an_impossible_number_is_not_interrupted(desk: Desk) -> None:
    handle = desk.handle("design.platform.mass")
    desk.set("design.platform.mass", 0.0)  # "0", then "0.", then "0.5"
    desk.until(lambda: handle.value == 0.0)
    desk.dispatch(lambda s: actions.move(s, x=0.01))  # a frame is drawn meanwhile
    desk.until(lambda: desk.state.last_reachable.pose[0] == 0.01)
    assert handle.value == 0.0
    desk.set("design.platform.mass", 0.5)
    desk.until(lambda: desk.design.platform.mass == 0.5)
    assert handle.value == 0.5
    assert not desk.notices


@pytest.mark.parametrize("parameter", PARAMETERS, ids=lambda p: p.path)
def test_refusal_has_number_and_range_in_the_unit_shown(parameter: Parameter) -> None:
    shown, row = parameter.display, ROWS[parameter.path]
    with pytest.raises(InvalidInput) as refused:
        row.apply(initial_state(), 2 * parameter.largest)
    assert f"{shown.from_si(parameter.largest):g}" in refused.value.problem
    assert refused.value.problem.partition(" [")[2].rstrip("]") == shown.text


def test_only_the_latest_impossible_number_is_notified_and_set_back(
    desk: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bindings, "TYPING_TIMEOUT", 0.2)
    handle = desk.handle("design.geometry.magnification")
    for value in (1.25, 1.2, 1.15):
        desk.set("design.geometry.magnification", value)
        desk.until(lambda value=value: handle.value == value)
    desk.until(lambda: desk.notices)
    desk.until(lambda: handle.value == 3.0)
    assert [text.partition(":")[0] for _, text in desk.notices] == ["k = 1.15"]
    assert desk.design == APPENDIX_4
    assert not desk.session._history.past


def test_reset_offers_each_changed_number_of_a_group_and_all_of_them(desk: Desk) -> None:
    reset = desk.handle("reset.links.")
    desk.until(lambda: not reset.visible)
    desk.dispatch(lambda s: actions.vary(s, {"links.b3": 1.0, "links.b7": 1.0, "joints.j4": 1.0}))
    desk.until(lambda: tuple(reset.options) == ("m_B3", "m_B7", WHOLE_GROUP))
    desk.until(lambda: reset.visible)
    desk.set("reset.links.", "m_B3")
    desk.until(lambda: desk.design.links.b3 == 0.406)
    desk.until(lambda: tuple(reset.options) == ("m_B7",))
    assert desk.design.links.b7 == 1.0
    desk.dispatch(lambda s: actions.vary(s, {"links.b3": 1.0}))
    desk.until(lambda: WHOLE_GROUP in reset.options)
    desk.set("reset.links.", WHOLE_GROUP)
    desk.until(lambda: desk.design.links == APPENDIX_4.links)
    desk.until(lambda: not reset.visible)
    assert desk.design.joints.j4 == 1.0


def test_guide_stroke_follows_its_guide_until_it_is_set(desk: Desk) -> None:
    stroke = desk.handle("design.geometry.guide_stroke")
    desk.set("design.geometry.guide_link_length", 400.0)
    desk.until(lambda: stroke.value == 400.0)
    desk.until(lambda: tuple(desk.handle("reset.geometry.arm").options) == ("l_B10",))
    desk.set("design.geometry.guide_stroke", 300.0)
    desk.until(lambda: desk.design.geometry.guide_stroke == 0.3)
    desk.set("design.geometry.guide_link_length", 410.0)
    desk.until(lambda: desk.design.geometry.guide_link_length == 0.41)
    assert stroke.value == 300.0
    desk.set("reset.geometry.arm", "|X₄| max")
    desk.until(lambda: desk.design.geometry.guide_stroke is None)
    desk.until(lambda: stroke.value == 410.0)


def test_hints_follow_the_geometry(desk: Desk) -> None:
    handle = desk.handle("design.joints.j7")
    desk.until(lambda: "lowers M_p2 by 3.27 N" in (handle.hint or ""))
    assert "Appendix 4: 0.28 kg" in handle.hint
    desk.set("design.geometry.magnification", 4.0)
    desk.until(lambda: f"lowers M_p2 by {number(9.81 / 4, 4)} N" in (handle.hint or ""))
