"""How wide the pictures of the maps are."""

from __future__ import annotations

import math
from typing import Any

import pytest

from paminsa_viz.explorer.browser.bridge import NARROWEST, WIDEST, Slots
from paminsa_viz.explorer.browser.style import start_width
from paminsa_viz.explorer.state import initial_state


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

    def dispatch(self, source: str, intent: Any) -> None:
        del source
        state = initial_state()
        assert intent(state) == state
        assert intent(state) is not state
        self.asked += 1


class FakeBridge:
    def __init__(self) -> None:
        self.listeners: dict[str, Any] = {}

    def on(self, kind: str, listener: Any) -> None:
        self.listeners[kind] = listener


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
