"""Workspaces: each is left and found again with its map, layers, camera and docks."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from paminsa_viz.explorer.core.maps import choose_quantity
from paminsa_viz.explorer.state.layers import LAYERS
from paminsa_viz.explorer.state.state import State
from paminsa_viz.explorer.state.view import WorkspaceView
from paminsa_viz.quantities import QUANTITIES

COMMON: Final = frozenset({"mesh", "fine", "shadows", "labels"})
"""Keys of the layers that are the same in all workspaces: how the robot itself is drawn."""


def view_of(state: State, name: str) -> WorkspaceView | None:
    """Return how a workspace was left, or None if it was not open yet."""
    return next((view for view in state.workspaces if view.name == name), None)


def switch(state: State, name: str, beside: str, first_layers: frozenset[str]) -> State:
    """Go to another workspace: what it showed comes back, what the last one shows is kept.

    Args:
        state: The state.
        name: Name of the workspace that is open now.
        beside: Name of the tab that is open in the left dock.
        first_layers: Layers that are shown next to the others when it is opened first.
    """
    if name == state.workspace:
        return state
    if not state.workspace:  # the page has just said which one it begins with
        return replace(state, workspace=name)
    left = WorkspaceView(
        state.workspace, state.layers, state.map_view.quantity, beside, state.camera, state.docks
    )  # fmt: skip
    others = tuple(view for view in state.workspaces if view.name != left.name)
    found = view_of(state, name)
    state = replace(state, workspace=name, workspaces=(*others, left))
    if found is None:
        return replace(state, layers=state.layers | (first_layers & LAYERS.keys()))
    layers = (found.layers - COMMON) | (state.layers & COMMON)
    docks = state.docks if found.docks is None else found.docks
    state = replace(state, layers=layers & LAYERS.keys(), camera=found.camera, docks=docks)
    return choose_quantity(state, found.quantity) if found.quantity in QUANTITIES else state
