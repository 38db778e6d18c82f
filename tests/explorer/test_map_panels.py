"""The maps' panel: what lies under the pointer, clicks, inputs, and what is drawn when."""

from __future__ import annotations

import json
import math
from base64 import b64decode
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
import viser

from paminsa_viz.explorer import actions, maps
from paminsa_viz.explorer.bridge import Bridge
from paminsa_viz.explorer.maps import COARSE, FULL, MapStore
from paminsa_viz.explorer.motion.store import MotionStore
from paminsa_viz.explorer.panels.hover import REASON_CELLS, HoverFigure
from paminsa_viz.explorer.panels.map_controls import (
    QUANTITY_LABELS,
    choose_quantity,
    show_figure_3,
)
from paminsa_viz.explorer.panels.map_picture import caption
from paminsa_viz.explorer.panels.maps_panel import MapsPanel, clicked_place
from paminsa_viz.explorer.panels.slots import NARROWEST, WIDEST, Slots
from paminsa_viz.explorer.placing import start_width
from paminsa_viz.explorer.server import open_server
from paminsa_viz.explorer.state import RangeMode, initial_state
from paminsa_viz.figures.from_model import LEGENDS
from paminsa_viz.figures.live import screen_layout
from paminsa_viz.model import Limit, Quantity

from .panel_desk import Desk, desk_with

STORE = MapStore()


def unpacked(packed: dict[str, str]) -> np.ndarray:
    numbers = np.frombuffer(b64decode(packed["bdata"]), dtype="<f4")
    if "shape" in packed:
        numbers = numbers.reshape([int(size) for size in packed["shape"].split(",")])
    return numbers


@pytest.fixture(scope="module")
def figure() -> tuple[Any, Any, dict[str, Any]]:
    """Maps, their layout, and the hover figure as the page gets it."""
    state = actions.move(initial_state(), theta=0.6)
    data = STORE.data(state, FULL)
    layout = screen_layout(data, STORE.scales(state, data), 800)
    return data, layout, json.loads(HoverFigure(data, layout, "here").to_json())


class TestHover:
    def test_values_are_those_of_the_map(self, figure: Any) -> None:
        data, _, tree = figure
        for panel in range(3):
            trace = tree["data"][2 * panel + 1]
            np.testing.assert_allclose(unpacked(trace["z"]), data.values[panel], rtol=1e-6)
            np.testing.assert_allclose(unpacked(trace["x"]), 1e3 * data.x, rtol=1e-6)
            np.testing.assert_allclose(unpacked(trace["y"]), 1e3 * data.y, rtol=1e-6)
            assert "N·m" in trace["hovertemplate"]
            assert "θ" in trace["hovertemplate"]

    def test_every_masked_cell_says_why(self, figure: Any) -> None:
        data, _, tree = figure
        step = -(-FULL // REASON_CELLS)
        picked = slice(step // 2, None, step)
        status, leg = data.status[picked, picked], data.leg[picked, picked]
        words = np.array(tree["data"][0]["text"])
        assert ((words == "") == (status == 0)).all()
        stretched = (status == Limit.STRETCHED) & (leg == 1)
        assert stretched.any()
        assert set(words[stretched]) == {"out of reach: over-stretched (leg 2)"}

    def test_axes_lie_where_the_picture_has_its_panels(self, figure: Any) -> None:
        data, layout, tree = figure
        for index, box in enumerate(layout.panels):
            number = "" if index == 0 else str(index + 1)
            x, y = tree["layout"][f"xaxis{number}"], tree["layout"][f"yaxis{number}"]
            np.testing.assert_allclose(
                np.array(x["domain"]) * layout.width, [box.left, box.right], atol=1e-6
            )
            np.testing.assert_allclose(
                layout.height * (1 - np.array(y["domain"])), [box.bottom, box.top], atol=1e-6
            )
            np.testing.assert_allclose(x["range"] + y["range"], 1e3 * np.array(data.extent))

    def test_it_says_whose_clicks_come_back(self, figure: Any) -> None:
        assert figure[2]["layout"]["meta"] == "here"

    def test_values_that_explode_are_no_gaps(self) -> None:
        state = initial_state()
        data = STORE.data(state, COARSE, (Quantity.MAX_TORQUE,))
        values = np.where(data.status == 0, 1e40, np.nan)[None]
        huge = maps.replace(data, values=values)
        layout = screen_layout(huge, STORE.scales(state, data, (Quantity.MAX_TORQUE,)), 400)
        tree = json.loads(HoverFigure(huge, layout, "n").to_json())
        assert np.isfinite(unpacked(tree["data"][1]["z"])[data.status == 0]).all()


class TestClicks:
    def test_millimetres_become_metres(self) -> None:
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


class TestStart:
    @pytest.mark.parametrize(("window", "width"), [((1400, 900), 749), ((1280, 720), 640)])
    def test_two_windows(self, window: tuple[int, int], width: int) -> None:
        assert start_width(*window) == width

    @pytest.mark.parametrize("window", [(0, 0), (-5, 10), (2**40, 2**40), (math.nan, 500)])
    def test_any_window_gets_a_usable_panel(self, window: tuple[float, float]) -> None:
        assert 600 <= start_width(*window) <= 900


class FakeSession:
    def __init__(self) -> None:
        self.asked = 0

    def ask(self, source: str, intent: Any) -> None:
        del source
        state = initial_state()
        assert intent(state) == state
        assert intent(state) is not state
        self.asked += 1


class FakeBridge:
    def __init__(self) -> None:
        self.listeners: dict[str, Any] = {}
        self.scripts: list[str] = []

    def on(self, kind: str, listener: Any) -> None:
        self.listeners[kind] = listener

    def run(self, script: str) -> None:
        self.scripts.append(script)


class TestSlots:
    @pytest.fixture
    def parts(self) -> tuple[Slots, FakeSession, Any]:
        session, bridge = FakeSession(), FakeBridge()
        slots = Slots(session, bridge, {"a": 500, "b": 0})  # type: ignore[arg-type]
        return slots, session, bridge.listeners["slots"]

    def test_reports_are_taken_over_and_redrawn_once(self, parts: Any) -> None:
        slots, session, hear = parts
        for _ in range(3):
            hear({"a": 0, "b": 640, "ratio": 1.5})
        assert (slots.width("a"), slots.width("b"), slots.ratio) == (0, 640, 1.5)
        assert session.asked == 1

    @pytest.mark.parametrize(
        ("data", "a"),
        [
            ({"a": 1e9}, WIDEST),
            ({"a": 1}, NARROWEST),
            ({"a": -4}, 0),
            ({"a": math.inf}, 0),
            ({"a": math.nan, "ratio": math.nan}, 0),
            ({"a": "600"}, 0),
            ({"a": 10**400, "ratio": 10**400}, 0),
            ({"a": True, "ratio": True}, 0),
            ({"a": [600], "ratio": -3}, 0),
            ({"other": 5, "ratio": 1e300}, 0),
        ],
    )
    def test_hostile_reports(self, parts: Any, data: Any, a: int) -> None:
        slots, _, hear = parts
        hear(data)
        assert slots.width("a") == a
        assert 1.0 <= slots.ratio <= 2.0
        assert slots.width("never named") == 0

    @pytest.mark.parametrize("data", [None, 3, "x", [1, 2]])
    def test_what_is_no_report_changes_nothing(self, parts: Any, data: Any) -> None:
        slots, session, hear = parts
        hear(data)
        assert slots.width("a") == 500
        assert session.asked == 0


class TestIntents:
    def test_a_manual_range_does_not_outlive_its_unit(self) -> None:
        state = actions.set_map_view(initial_state(), range_mode=RangeMode.MANUAL)
        assert choose_quantity(state, Quantity.TAU_2).map_view.range_mode is RangeMode.MANUAL
        assert choose_quantity(state, Quantity.F_4).map_view.range_mode is RangeMode.AUTO

    def test_the_preset_of_fig_3(self) -> None:
        state = actions.set_map_view(actions.move(initial_state(), x=0.03), shared=False)
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
        assert set(QUANTITY_LABELS) == set(Quantity) == set(LEGENDS)
        assert len(set(QUANTITY_LABELS.values())) == len(Quantity)


def test_a_caption_says_what_is_compared_and_keeps_names_harmless() -> None:
    state = actions.pin_reference(initial_state())
    design = state.document.design
    evil = maps.replace(design, name="<script>")
    state = maps.replace(state, document=maps.replace(state.document, reference=evil))
    state = actions.set_map_view(state, difference=True)
    text = caption(state, STORE.data(state, COARSE))
    assert "difference from “&lt;script&gt;”" in text
    assert "<script>" not in text


@pytest.fixture(scope="module")
def server() -> Iterator[viser.ViserServer]:
    running = open_server(port=0)
    yield running
    running.stop()


@pytest.fixture
def desk(server: viser.ViserServer) -> Iterator[Desk]:
    with desk_with(
        server, lambda session: MapsPanel(session, Bridge(session.client), MotionStore())
    ) as made:
        yield made


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
        desk.until(lambda: named(desk, "colours").value == "manual")

    def test_lengths_are_set_in_millimetres(self, desk: Desk) -> None:
        desk.ask(lambda s: choose_quantity(s, Quantity.REACH_MARGIN))
        desk.set(named(desk, "ends"), [10.0, 120.0])
        desk.until(lambda: desk.state.map_view.range_mode is RangeMode.MANUAL)
        view = desk.state.map_view
        assert (view.low, view.high) == pytest.approx((0.01, 0.12))
        assert view.quantity is Quantity.REACH_MARGIN

    def test_torques_in_other_units_make_the_range_one_of_torques(self, desk: Desk) -> None:
        desk.ask(lambda s: choose_quantity(s, Quantity.F_4))
        desk.set(named(desk, "from–to"), [-1.0, 1.0])
        desk.until(lambda: desk.state.map_view.range_mode is RangeMode.MANUAL)
        assert desk.state.map_view.quantity is Quantity.MAX_TORQUE

    def test_an_absurd_range_is_refused_and_taken_back(self, desk: Desk) -> None:
        ends = named(desk, "from–to")
        desk.until(lambda: ends.value == (-8.0, 8.0))
        desk.set(ends, [-8.0, 5e10])
        desk.until(lambda: any("colour range" in body for _, body in desk.told))
        desk.until(lambda: ends.value == (-8.0, 8.0))
        assert desk.state.map_view.range_mode is RangeMode.AUTO

    def test_a_difference_needs_a_reference(self, desk: Desk) -> None:
        switch = named(desk, "Δ ref.")
        assert switch.disabled
        desk.set(switch, True)
        desk.until(lambda: any("reference" in body for _, body in desk.told))
        desk.until(lambda: switch.value is False)
        desk.ask(actions.pin_reference)
        desk.until(lambda: not switch.disabled)
        desk.set(switch, True)
        desk.until(lambda: desk.state.map_view.difference)
        desk.until(lambda: desk.panel._torques.data.names[0] == "Δτ₁")
        desk.ask(actions.unpin_reference)
        desk.until(lambda: switch.disabled and not switch.value)

    def test_quantity_and_switches(self, desk: Desk) -> None:
        desk.set(named(desk, "show"), QUANTITY_LABELS[Quantity.DETERMINANT])
        desk.until(lambda: desk.state.map_view.quantity is Quantity.DETERMINANT)
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
        desk.ask(lambda s: actions.move(s, theta=0.2))
        desk.until(lambda: single.data.theta == 0.2)
        assert torques.data is before
