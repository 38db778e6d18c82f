"""The maps' panel: clicks, sizes that the page reports, color ranges, captions, what is drawn."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from functools import partial
from types import SimpleNamespace
from typing import Any

import pytest

from paminsa_viz.explorer.browser.bridge import NARROWEST, WIDEST, Slots
from paminsa_viz.explorer.browser.style import NARROWEST as NARROWEST_DOCK
from paminsa_viz.explorer.browser.style import WIDEST as WIDEST_DOCK
from paminsa_viz.explorer.browser.style import dock_width, view_width
from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core.maps import COARSE, FULL, MapStore, choose_quantity
from paminsa_viz.explorer.dock import MapsPanel, clicked_place
from paminsa_viz.explorer.features.balance.actions import balance_now
from paminsa_viz.explorer.features.maps.pictures import COLUMNS, caption, click_frame
from paminsa_viz.explorer.features.maps.tab import show_figure_3, single_entries, torque_entries
from paminsa_viz.explorer.kit.setting_inputs import quantity_inputs
from paminsa_viz.explorer.state.maps import RangeMode
from paminsa_viz.explorer.state.state import initial_state
from paminsa_viz.plots.map_layout import PAGE_EM, map_layout
from paminsa_viz.plots.ranges import choose_scales
from paminsa_viz.quantities import QUANTITIES, TORQUES, families
from tests.support.desk import Desk
from tests.support.raw_page import update

PANEL = partial(MapsPanel, answers=())


@pytest.mark.parametrize(
    ("click", "place"),
    [
        ({"title": "torques", "x": 120, "y": -35.5}, (0.12, -0.0355)),
        ({"title": "single", "x": 0, "y": 0.0}, (0.0, 0.0)),
        *(
            (click, None)
            for click in (
                None, 7, "torques", [], ["torques", 1, 2], {},
                {"title": "torques"},
                {"title": "other", "x": 1, "y": 2},
                {"title": ["torques"], "x": 1, "y": 2},
                {"title": "torques", "x": math.nan, "y": 2},
                {"title": "torques", "x": 1, "y": math.inf},
                {"title": "torques", "x": "1", "y": 2},
                {"title": "torques", "x": True, "y": 2},
                {"title": "torques", "x": None, "y": 2},
                {"title": "torques", "x": [1], "y": {}},
                {"title": "torques", "x": 10**400, "y": 0},
            )
        ),
    ],
    ids=str,
)  # fmt: skip
def test_clicks_are_places_in_meters_or_ignored(click: Any, place: Any) -> None:
    assert clicked_place(click) == place


@pytest.mark.parametrize("quantities", [TORQUES, TORQUES[:1]], ids=len)
def test_frame_of_a_click_leads_back_to_the_place_that_is_marked(quantities: Any) -> None:
    data = MapStore().data(initial_state(), COARSE, quantities)
    layout = map_layout(data, choose_scales(data), 580, PAGE_EM, columns=COLUMNS)
    frame = click_frame(layout, data)
    left, right, bottom, top = frame["edges"]
    places = layout.places(data, 0.07, -0.11)
    assert len(places) == len(frame["panels"]) == len(quantities)
    for (x, y), (start, head, width, height) in zip(places, frame["panels"], strict=True):
        assert left + (x - start) / width * (right - left) == pytest.approx(70)
        assert top - (y - head) / height * (top - bottom) == pytest.approx(-110)


@pytest.mark.parametrize(
    ("window", "side"), [((1280, 720), 145), ((1400, 900), 145), ((1920, 1080), 260)], ids=str
)
def test_maps_of_the_dock_are_large_and_fit_beside_robot(
    window: tuple[int, int], side: int
) -> None:
    width = dock_width(*window)
    data = MapStore().data(initial_state(), COARSE, TORQUES)
    layout = map_layout(data, choose_scales(data), width, PAGE_EM, columns=COLUMNS)
    assert layout.panels[0].width >= side
    assert layout.height < window[1] - 110  # tabs and caption
    assert view_width(*window) >= 400


@pytest.mark.parametrize("window", [(0, 0), (-5, 10), (2**40, 2**40), (math.nan, 500)], ids=str)
def test_any_window_has_a_usable_dock(window: tuple[float, float]) -> None:
    assert NARROWEST_DOCK <= dock_width(*window) <= WIDEST_DOCK
    assert view_width(*window) >= 1 or math.isnan(window[0])


@pytest.fixture
def slots() -> Any:
    """Sizes of two pictures, what takes the page's reports, and how often it was redrawn."""
    dispatched: list[Any] = []
    listeners: dict[str, Any] = {}
    bridge: Any = SimpleNamespace(on=listeners.__setitem__)
    made = Slots(bridge, lambda source, action: dispatched.append(action), {"a": 500, "b": 0})
    return SimpleNamespace(slots=made, report=listeners["slots"], dispatched=dispatched)


def test_reported_sizes_are_used_and_drawn_once(slots: Any) -> None:
    for _ in range(3):
        slots.report({"a": 0, "b": 640, "ratio": 1.5})
    found = slots.slots
    assert (found.width("a"), found.width("b"), found.ratio) == (0, 640, 1.5)
    (action,) = slots.dispatched
    assert action(initial_state()) == initial_state()


def test_a_dock_that_was_left_narrow_has_room_for_two_maps() -> None:
    bridge: Any = SimpleNamespace(on=lambda *_: None)
    width = Slots(bridge, lambda *_: None, {"a": 120, "b": 0}).width("a")
    data = MapStore().current(initial_state(), COARSE, TORQUES)
    scales = choose_scales(data)
    assert map_layout(data, scales, width, PAGE_EM, columns=COLUMNS).width == width


@pytest.mark.parametrize(
    ("data", "width"),
    [
        ({"a": 1e9}, WIDEST), ({"a": 1}, NARROWEST), ({"a": -4}, 0), ({"a": math.inf}, 0),
        ({"a": math.nan, "ratio": math.nan}, 0), ({"a": "600"}, 0),
        ({"a": 10**400, "ratio": 10**400}, 0), ({"a": True, "ratio": True}, 0),
        ({"a": [600], "ratio": -3}, 0), ({"other": 5, "ratio": 1e300}, 0),
        (None, 500), (3, 500), ("x", 500), ([1, 2], 500),
    ],
    ids=str,
)  # fmt: skip
def test_hostile_reports_give_usable_sizes(slots: Any, data: Any, width: int) -> None:
    slots.report(data)
    assert slots.slots.width("a") == width
    assert 1.0 <= slots.slots.ratio <= 2.0
    assert slots.slots.width("never named") == 0
    assert bool(slots.dispatched) == isinstance(data, dict)


def test_manual_range_does_not_outlive_its_unit() -> None:
    state = initial_state().updated("map_view", range_mode=RangeMode.MANUAL)
    assert choose_quantity(state, "tau_2").map_view.range_mode is RangeMode.MANUAL
    assert choose_quantity(state, "f_4").map_view.range_mode is RangeMode.AUTO


@pytest.mark.parametrize(("start", "x"), [({"x": 0.03}, 0.03), ({"x": 0.0, "y": 0.4}, 0.0)])
def test_figure_3_is_shown_at_a_pose_within_reach(start: dict[str, float], x: float) -> None:
    state = actions.move(initial_state(), **start).updated("map_view", shared=False)
    assert state.last_reachable.pose == state.document.pose
    shown = show_figure_3(state)
    assert shown.last_reachable.pose == shown.document.pose
    assert shown.document.pose[:3] == pytest.approx((x, 0.0, math.radians(60)))
    assert shown.map_view.shared
    assert not shown.map_view.difference


def test_caption_names_the_reference_escaped() -> None:
    state = actions.pin_reference(initial_state())
    evil = replace(state.document.design, name="<script>")
    state = state.updated("document", reference=evil).updated("map_view", difference=True)
    text = caption(state, MapStore().data(state, COARSE))
    assert "difference from “&lt;script&gt;”" in text
    assert "<script>" not in text


def test_caption_says_of_a_balanced_robot_that_torques_are_zero_everywhere() -> None:
    state = initial_state()
    assert "0 everywhere" not in caption(state, MapStore().current(state, COARSE, TORQUES))
    state = balance_now(state)
    assert "0 everywhere" in caption(state, MapStore().current(state, COARSE, TORQUES))


@pytest.mark.slow
def test_ends_show_the_range_drawn_and_set_it(desk: Desk) -> None:
    ends = desk.handle("Ends")
    desk.until(lambda: desk.panel._torques.scales)
    scale = desk.panel._torques.scales[0]
    desk.until(lambda: ends.value == (scale.low, scale.high))
    desk.set("Ends", [-8.0, 5e10])
    desk.noticed("Color range")
    desk.until(lambda: ends.value == (scale.low, scale.high))
    assert desk.state.map_view.range_mode is RangeMode.AUTO
    desk.set("Ends", [-2.5, 4.0])
    desk.until(lambda: desk.panel._torques.scales[0].low == -2.5)
    desk.until(lambda: desk.handle("Color range").value == "held")


def test_what_both_kinds_of_maps_have_is_named_alike() -> None:
    silent: Any = SimpleNamespace(scales=())
    torques, single = (
        {one.key: one.label for one in entries("map", silent)}
        for entries in (torque_entries, single_entries)
    )
    both = torques.keys() & single.keys()
    assert len(both) == 4
    assert {key: torques[key] for key in both} == {key: single[key] for key in both}


@pytest.mark.slow
def test_range_is_set_in_the_unit_shown(desk: Desk) -> None:
    desk.dispatch(lambda s: choose_quantity(s, "reach_margin"))
    single = desk.panel._single_inputs.handles["single map.ends"]
    desk.page.send(update(single._impl.uuid, [10.0, 120.0]))
    desk.until(lambda: desk.state.map_view.range_mode is RangeMode.MANUAL)
    view = desk.state.map_view
    assert (view.low, view.high, view.quantity) == pytest.approx((0.01, 0.12, "reach_margin"))
    desk.set("Ends", [-1.0, 1.0])  # of the torque maps
    desk.until(lambda: desk.state.map_view.quantity == "max_torque")


@pytest.mark.slow
def test_difference_needs_a_reference(desk: Desk) -> None:
    switch = desk.handle("Difference")
    assert switch.disabled
    desk.set("Difference", True)
    desk.noticed("reference")
    desk.until(lambda: switch.value is False)
    desk.dispatch(actions.pin_reference)
    desk.until(lambda: not switch.disabled)
    desk.set("Difference", True)
    desk.until(lambda: desk.panel._torques.data.names[0] == "Δτ₁")
    desk.dispatch(actions.unpin_reference)
    desk.until(lambda: switch.disabled and not switch.value)


@pytest.mark.slow
def test_click_on_a_map_moves_the_robot(desk: Desk) -> None:
    desk.set("bridge", json.dumps([[7, "click", {"title": "torques", "x": 40.04, "y": -60.0}]]))
    desk.until(lambda: desk.state.last_reachable.pose[:2] == (0.04, -0.06))


@pytest.mark.slow
def test_only_the_map_in_sight_is_drawn_and_finely_when_idle(desk: Desk) -> None:
    torques, single = desk.panel._torques, desk.panel._single
    desk.until(lambda: torques.data is not None and torques.data.x.size == FULL)
    assert single.data is None
    desk.set("bridge", json.dumps([[8, "slots", {"torques": 0, "single": 420, "ratio": 1}]]))
    desk.until(lambda: single.data is not None and single.data.x.size == FULL)
    before = torques.data
    desk.dispatch(lambda s: actions.move(s, theta=0.2))
    desk.until(lambda: single.data.theta == 0.2)
    assert torques.data is before


@pytest.mark.slow
def test_a_family_of_quantities_is_chosen_first(desk: Desk) -> None:
    """Only those of the family are offered, and its first is shown; choosing it again keeps."""
    family, _ = quantity_inputs(
        "map", ("", ""), lambda state: state.map_view.quantity, choose_quantity, ""
    )
    kept = family.apply(choose_quantity(desk.state, "rms_torque"), "static torques")
    assert kept.map_view.quantity == "rms_torque"
    desk.set("Family", "kinematics")
    desk.until(lambda: desk.state.map_view.quantity == "condition")
    offered = [quantity.label for quantity in families()["kinematics"]]
    desk.until(lambda: list(desk.handle("Show").options) == offered)
    desk.until(lambda: desk.handle("Show").value == offered[0])
    desk.dispatch(lambda s: choose_quantity(s, "f_4"))
    desk.until(lambda: desk.handle("Family").value == "static torques")
    desk.until(lambda: desk.handle("Show").value == QUANTITIES["f_4"].label)
