"""What a person can ask for, each as a pure function from state to state."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from paminsa_viz.explorer.state import Document, State, home_pose, settle
from paminsa_viz.model import APPENDIX_4, Assembly, Design
from paminsa_viz.model.grids import COORDINATES


def move(state: State, **coordinates: float) -> State:
    """Ask for another pose; named coordinates change [m, m, rad, m]."""
    pose = dict(zip(COORDINATES, state.document.pose, strict=True)) | coordinates
    moved = (pose["x"], pose["y"], pose["theta"], pose["z"])
    return settle(state, replace(state.document, pose=moved))


def go_home(state: State) -> State:
    """Ask for the home pose."""
    home = home_pose(state.document.design.geometry, state.document.assembly)
    return settle(state, replace(state.document, pose=home))


def vary(state: State, changes: Mapping[str, float | None]) -> State:
    """Change numbers of the design.

    Raises:
        InvalidDesign: If no machine can have them.
    """
    return settle(
        state, replace(state.document, design=state.document.design.vary(changes))
    )


def reset_values(state: State, paths: tuple[str, ...]) -> State:
    """Set numbers of the design back to Appendix 4's."""
    values: dict[str, float | None] = {path: APPENDIX_4.value(path) for path in paths}
    if "geometry.guide_stroke" in values:
        values["geometry.guide_stroke"] = APPENDIX_4.geometry.guide_stroke
    return vary(state, values)


def load_design(state: State, design: Design) -> State:
    """Work on another design, at the present pose if it can be taken, else at home."""
    changed = settle(state, replace(state.document, design=design))
    if changed.standing.geometry is not design.geometry:
        changed = go_home(changed)
    return changed


def assemble(state: State, assembly: Assembly) -> State:
    """Choose the root of the knee; the platform goes to the mirrored height (z_5 to -z_5)."""
    if assembly is state.document.assembly:
        return state
    x, y, theta, z = state.document.pose
    mirrored = -z - 2 * state.document.design.geometry.platform_joint_height
    return settle(
        state, replace(state.document, assembly=assembly, pose=(x, y, theta, mirrored))
    )


def pin_reference(state: State) -> State:
    """Keep the present design to compare with."""
    return settle(state, replace(state.document, reference=state.document.design))


def unpin_reference(state: State) -> State:
    """Forget the reference design; maps show values again."""
    cleared = settle(state, replace(state.document, reference=None))
    return replace(cleared, map_view=replace(cleared.map_view, difference=False))


def restore(state: State, document: Document) -> State:
    """Take over a whole document, as undo, redo and a reload do."""
    changed = settle(state, document)
    if document.reference is None and changed.map_view.difference:
        changed = replace(changed, map_view=replace(changed.map_view, difference=False))
    return changed


def set_map_view(state: State, **changes: Any) -> State:
    """Change how maps are drawn."""
    return replace(state, map_view=replace(state.map_view, **changes))


def set_layers(state: State, **changes: Any) -> State:
    """Change what is visible in the scene."""
    return replace(state, layers=replace(state.layers, **changes))
