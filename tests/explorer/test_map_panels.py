"""The maps' panel: clicks, inputs, captions, and what is drawn when."""

from __future__ import annotations

import json
import math
from typing import Any

import pytest

from paminsa_viz.explorer import actions, maps
from paminsa_viz.explorer.browser.bridge import Bridge
from paminsa_viz.explorer.maps import COARSE, FULL, MapStore
from paminsa_viz.explorer.motion.results import MotionStore
from paminsa_viz.explorer.panels.map_controls import choose_quantity, show_figure_3
from paminsa_viz.explorer.panels.map_picture import caption
from paminsa_viz.explorer.panels.maps_panel import MapsPanel, clicked_place
from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.state import RangeMode, initial_state
from paminsa_viz.quantities import QUANTITIES
from tests.support.desk import Desk

STORE = MapStore()


class TestClicks:
    def test_millimeters_become_meters(self) -> None:
        assert clicked_place({"title": "torques", "x": 120, "y": -35.5}) == (0.12, -0.0355)
        assert clicked_place({"title": "single", "x": 0, "y": 0.0}) == (0.0, 0.0)

    @pytest.mark.parametrize(
        "data",
        [
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
        ],
    )  # fmt: skip
    def test_what_is_no_click_is_none(self, data: Any) -> None:
        assert clicked_place(data) is None

    def test_a_number_beyond_all_floats_is_none(self) -> None:
        assert clicked_place({"title": "torques", "x": 10**400, "y": 0}) is None


class TestIntents:
    def test_a_manual_range_does_not_outlive_its_unit(self) -> None:
        state = initial_state().updated("map_view", range_mode=RangeMode.MANUAL)
        assert choose_quantity(state, "tau_2").map_view.range_mode is RangeMode.MANUAL
        assert choose_quantity(state, "f_4").map_view.range_mode is RangeMode.AUTO

    def test_the_preset_of_fig_3(self) -> None:
        state = actions.move(initial_state(), x=0.03).updated("map_view", shared=False)
        shown = show_figure_3(state)
        assert shown.document.pose[2] == pytest.approx(math.radians(60))
        assert shown.document.pose[0] == 0.03
        assert shown.map_view.shared
        assert not shown.map_view.difference

    def test_the_preset_goes_to_the_middle_if_it_has_to(self) -> None:
        state = actions.move(initial_state(), x=0.0, y=0.4)
        assert state.standing.pose == state.document.pose
        shown = show_figure_3(state)
        assert shown.standing.pose == shown.document.pose
        assert shown.document.pose[:2] == (0.0, 0.0)

    def test_every_quantity_can_be_chosen(self) -> None:
        labels = {quantity.label for quantity in QUANTITIES.values()}
        assert len(labels) == len(QUANTITIES)


def test_a_caption_says_what_is_compared_and_keeps_names_harmless() -> None:
    state = actions.pin_reference(initial_state())
    design = state.document.design
    evil = maps.replace(design, name="<script>")
    state = maps.replace(state, document=maps.replace(state.document, reference=evil))
    state = state.updated("map_view", difference=True)
    text = caption(state, STORE.data(state, COARSE))
    assert "difference from “&lt;script&gt;”" in text
    assert "<script>" not in text


def PANEL(session: Session) -> MapsPanel:
    return MapsPanel(session, Bridge(session.client), MotionStore())


def named(desk: Desk, label: str) -> Any:
    handles = desk.session.client.gui._gui_input_handle_from_uuid.values()
    return next(h for h in handles if getattr(h, "label", None) == label)


class TestPanel:
    def test_the_ends_show_the_range_and_set_it(self, desk: Desk) -> None:
        ends = named(desk, "from–to")
        desk.until(lambda: desk.panel._torques.scales)
        scale = desk.panel._torques.scales[0]
        desk.until(lambda: ends.value == (scale.low, scale.high))
        desk.set(ends, [-2.5, 4.0])
        desk.until(lambda: desk.state.map_view.range_mode is RangeMode.MANUAL)
        assert (desk.state.map_view.low, desk.state.map_view.high) == (-2.5, 4.0)
        desk.until(lambda: desk.panel._torques.scales[0].low == -2.5)
        desk.until(lambda: named(desk, "colors").value == "manual")

    def test_lengths_are_set_in_millimeters(self, desk: Desk) -> None:
        desk.dispatch(lambda s: choose_quantity(s, "reach_margin"))
        desk.set(named(desk, "ends"), [10.0, 120.0])
        desk.until(lambda: desk.state.map_view.range_mode is RangeMode.MANUAL)
        view = desk.state.map_view
        assert (view.low, view.high) == pytest.approx((0.01, 0.12))
        assert view.quantity == "reach_margin"

    def test_torques_in_other_units_make_the_range_one_of_torques(self, desk: Desk) -> None:
        desk.dispatch(lambda s: choose_quantity(s, "f_4"))
        desk.set(named(desk, "from–to"), [-1.0, 1.0])
        desk.until(lambda: desk.state.map_view.range_mode is RangeMode.MANUAL)
        assert desk.state.map_view.quantity == "max_torque"

    def test_an_absurd_range_is_refused_and_taken_back(self, desk: Desk) -> None:
        ends = named(desk, "from–to")
        desk.until(lambda: ends.value == (-8.0, 8.0))
        desk.set(ends, [-8.0, 5e10])
        desk.until(lambda: any("color range" in body for _, body in desk.told))
        desk.until(lambda: ends.value == (-8.0, 8.0))
        assert desk.state.map_view.range_mode is RangeMode.AUTO

    def test_a_difference_needs_a_reference(self, desk: Desk) -> None:
        switch = named(desk, "Δ ref.")
        assert switch.disabled
        desk.set(switch, True)
        desk.until(lambda: any("reference" in body for _, body in desk.told))
        desk.until(lambda: switch.value is False)
        desk.dispatch(actions.pin_reference)
        desk.until(lambda: not switch.disabled)
        desk.set(switch, True)
        desk.until(lambda: desk.state.map_view.difference)
        desk.until(lambda: desk.panel._torques.data.names[0] == "Δτ₁")
        desk.dispatch(actions.unpin_reference)
        desk.until(lambda: switch.disabled and not switch.value)

    def test_quantity_and_switches(self, desk: Desk) -> None:
        desk.set(named(desk, "show"), QUANTITIES["determinant"].label)
        desk.until(lambda: desk.state.map_view.quantity == "determinant")
        desk.set(named(desk, "shared"), False)
        desk.until(lambda: not desk.state.map_view.shared)
        desk.set(named(desk, "log"), True)
        desk.until(lambda: desk.state.map_view.logarithmic)
        desk.until(lambda: named(desk, "log scale").value is True)

    def test_a_click_in_the_page_moves_the_robot(self, desk: Desk) -> None:
        inbox = named(desk, "bridge")
        click = [7, "click", {"title": "torques", "x": 40.04, "y": -60.0}]
        desk.set(inbox, json.dumps([click]))
        desk.until(lambda: desk.state.standing.pose[:2] == (0.04, -0.06))

    def test_at_rest_the_picture_is_fine_and_what_nobody_sees_is_not_drawn(
        self, desk: Desk
    ) -> None:
        torques, single = desk.panel._torques, desk.panel._single
        desk.until(lambda: torques.data is not None and torques.data.x.size == FULL)
        assert single.data is None
        inbox = named(desk, "bridge")
        report = [8, "slots", {"torques": 0, "single": 420, "ratio": 1}]
        desk.set(inbox, json.dumps([report]))
        desk.until(lambda: single.data is not None and single.data.x.size == FULL)
        before = torques.data
        desk.dispatch(lambda s: actions.move(s, theta=0.2))
        desk.until(lambda: single.data.theta == 0.2)
        assert torques.data is before
