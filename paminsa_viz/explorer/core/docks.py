"""The page's docks: how wide a person has left them, and whether folded, for the next reload."""

from __future__ import annotations

from typing import Any, Final

from paminsa_viz.explorer.browser.bridge import FOLDED_DOCK, finite
from paminsa_viz.explorer.browser.style import CONTROLS_WIDTH, dock_width, is_folded
from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.state.state import State
from paminsa_viz.explorer.state.view import LARGEST_DOCK, Dock, Docks

ANSWER_TAB: Final = "Answer"
"""Name of the tab of the left dock that holds answers."""

BESIDE: Final = {
    "Torque maps": "M1 to M3 over the workspace, as the paper’s Fig. 3",
    "Single map": "any quantity over the workspace, color range",
    "Motion plots": "curves over time: torques, power, energy, joint forces",
    ANSWER_TAB: "results and tables of what was asked",
}
"""Tabs of the left dock, and words to find them by."""

EDGE: Final = 4
"""Width of the edge that a dock is dragged by; it counts to what the dock covers [px]."""

ROUNDING: Final = 2

LEAST_VIEW: Final = 210
"""Width that docks as wide as a person has left them leave to the 3D view [px]."""


def left_dock(state: State, window: tuple[float, float]) -> tuple[int, bool]:
    """Return width [px] and fold of the maps' dock for a window: as left, or as fits."""
    dock, width = state.docks.left, dock_width(*window)
    if dock.width is not None and dock.width + CONTROLS_WIDTH + LEAST_VIEW <= window[0]:
        width = dock.width
    return width, is_folded(window[0]) if dock.folded is None else dock.folded


def right_dock(state: State, window: tuple[float, float]) -> tuple[int, bool]:
    """Return width [px] and fold of the tabs' dock for a window: as left, or the page's own."""
    dock, width = state.docks.right, CONTROLS_WIDTH
    if dock.width is not None and dock.width + LEAST_VIEW <= window[0]:
        width = dock.width
    return width, bool(dock.folded)


def covered(dock: Dock, pixels: Any, own_width: float, own_fold: bool) -> Dock:
    """Return a dock that covers so many pixels of the window, as the page says.

    What the page itself has chosen is no choice of a person and stays None.
    """
    width = finite(pixels)
    if width is None or not 1 < width <= LARGEST_DOCK:  # there is none yet
        return dock
    folded = width < FOLDED_DOCK
    if folded:
        return Dock(dock.width, None if own_fold else True)
    chosen = round(width - EDGE)
    kept = None if abs(chosen - own_width) <= ROUNDING else chosen
    return Dock(kept, False if own_fold else None)


def as_reported(state: State, data: Any, window: tuple[float, float]) -> State:
    """Return the state with what the page says of its docks."""
    if not isinstance(data, dict) or data.get("window", window[0]) != window[0]:
        return state  # of a window that has another size by now
    left = covered(
        state.docks.left, data.get("left"), dock_width(*window), is_folded(window[0])
    )  # fmt: skip
    right = covered(state.docks.right, data.get("right"), CONTROLS_WIDTH, False)
    docks = Docks(left, right)
    return state if docks == state.docks else state.updated("", docks=docks)


def keep_docks(session: Session) -> None:
    """Keep in the state what a person does with the docks, once all of the page is there."""

    def listen(data: Any) -> None:
        if session.built.is_set():
            session.dispatch(
                "docks", lambda state: as_reported(state, data, session.window), step=False,
                overtakes=True,
            )  # fmt: skip

    session.bridge.on("docks", listen)


def fit_right(session: Session) -> None:
    """Give the tabs' dock the width it had, as far as the window has room for it, and its fold."""
    width, folded = right_dock(session.state, session.window)
    panel = session.client.gui.main_panel
    panel.set_width(width)
    if folded:
        panel.minimize()
