"""Widths and folds of the docks: what a person did with them, and what the page chose itself."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from paminsa_viz.explorer.browser.style import CONTROLS_WIDTH, dock_width
from paminsa_viz.explorer.core import docks, tab_store
from paminsa_viz.explorer.state.state import initial_state
from paminsa_viz.explorer.state.view import Dock, Docks

STATE = initial_state()
WINDOW = (1400.0, 900.0)
OWN = {"left": dock_width(*WINDOW) + docks.EDGE, "right": CONTROLS_WIDTH + docks.EDGE}


def test_what_the_page_chose_is_not_kept() -> None:
    assert docks.as_reported(STATE, OWN, WINDOW) is STATE
    narrow = (900.0, 700.0)
    assert docks.as_reported(STATE, {"left": 40, "right": OWN["right"]}, narrow) is STATE


def test_dragged_and_folded_docks_come_back_as_they_were() -> None:
    dragged = docks.as_reported(STATE, OWN | {"left": 504, "right": 464}, WINDOW)
    assert dragged.docks == Docks(Dock(500), Dock(460))
    folded = docks.as_reported(dragged, {"left": 40, "right": 40}, WINDOW)
    assert folded.docks == Docks(Dock(500, True), Dock(460, True))
    found = tab_store.restore(STATE, tab_store.dump(folded))
    assert docks.left_dock(found, WINDOW) == (500, True)
    assert docks.right_dock(found, WINDOW) == (460, True)
    opened = docks.as_reported(folded, OWN, WINDOW)
    assert docks.left_dock(opened, WINDOW) == (dock_width(*WINDOW), False)


def test_dock_opened_in_a_narrow_window_stays_open() -> None:
    narrow = (900.0, 700.0)
    opened = docks.as_reported(STATE, {"left": 464, "right": OWN["right"]}, narrow)
    assert docks.left_dock(STATE, narrow)[1]
    assert not docks.left_dock(opened, narrow)[1]


def test_width_that_leaves_no_room_for_the_view_is_not_taken() -> None:
    wide = replace(STATE, docks=Docks(Dock(1100), Dock(1300)))
    assert docks.left_dock(wide, WINDOW)[0] == dock_width(*WINDOW)
    assert docks.right_dock(wide, WINDOW)[0] == CONTROLS_WIDTH


@pytest.mark.parametrize(
    "data",
    [None, 3, {}, {"left": None}, {"left": float("nan"), "right": -5}, {"left": 1e9}],
    ids=str,
)
def test_page_that_sends_nonsense_changes_nothing(data: Any) -> None:
    assert docks.as_reported(STATE, data, WINDOW) is STATE


def test_widths_in_a_window_of_another_size_say_nothing() -> None:
    dragged = OWN | {"left": 504}
    assert docks.as_reported(STATE, dragged | {"window": 900}, WINDOW) is STATE
    assert docks.as_reported(STATE, dragged | {"window": 1400}, WINDOW).docks.left == Dock(500)
