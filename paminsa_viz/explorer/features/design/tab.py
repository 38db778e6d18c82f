"""The design's numbers: masses, geometry, inertias, friction, load; and their static imbalance."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial

from paminsa_viz.blocks.external_load import load_notes
from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.kit.design_numbers import GROUPS, SliderGroup, is_changed, slider
from paminsa_viz.explorer.kit.entries import ButtonGroup, Effect, Entry, Folder, Html
from paminsa_viz.explorer.kit.inputs import Dropdown, Slider
from paminsa_viz.explorer.kit.robot_texts import gauge_html, of_pose
from paminsa_viz.explorer.kit.text import blocks_html
from paminsa_viz.explorer.state.state import State
from paminsa_viz.kept import kept
from paminsa_viz.model import (
    Geometry,
    LoadFrame,
    Parameter,
    lumped_matrix,
)
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.lumped import MASS_PATHS
from paminsa_viz.units import number, symbol_text

WHOLE_GROUP = "all"
"""What the button says that resets a whole group."""


@kept(8)
def _shares(geometry: Geometry, gravity: float) -> Array:
    """Return the change of M_p2 with each mass [N/kg], in the order of `MASS_PATHS`."""
    return lumped_matrix(geometry, gravity)[1]


def balance_hint(path: str, geometry: Geometry, gravity: float) -> str:
    """Return what a mass does to M_p2, the scale of the torques of M1 to M3; empty for others."""
    if path not in MASS_PATHS:
        return ""
    share = float(_shares(geometry, gravity)[MASS_PATHS.index(path)])
    if abs(share) < 1e-12:
        return "No part in M_p2: the static torques of M1–M3 do not depend on it."
    word = "raises" if share > 0 else "lowers"
    return f"Each kg {word} M_p2 by {number(abs(share), 4)} N."


def _hinted(parameter: Parameter) -> Slider:
    """Return a parameter's slider; what a mass does to M_p2 follows the geometry."""
    entry, path = slider(parameter), parameter.path
    if path not in MASS_PATHS:
        return entry

    def hint(state: State) -> str:
        design = state.document.design
        return f"{entry.hint} {balance_hint(path, design.geometry, design.gravity)}"

    return replace(entry, hint=hint)


def resets(group: SliderGroup, state: State) -> Mapping[str, Effect]:
    """Return a button for each number of a group that is not Appendix 4's, and one for all."""
    design = state.document.design
    found: dict[str, Effect] = {
        symbol_text(p.symbol): partial(actions.reset_values, paths=(p.path,))
        for p in group.parameters
        if is_changed(design, p.path)
    }
    if len(found) > 1:
        every = tuple(p.path for p in group.parameters)
        found[WHOLE_GROUP] = partial(actions.reset_values, paths=every)
    return found


def _folder(group: SliderGroup) -> Folder:
    reset = ButtonGroup(
        f"reset.{group.prefixes[0]}", "Reset to App. 4", choices=partial(resets, group),
        hint="Set one value, or all of this group, back to Appendix 4’s",
    )  # fmt: skip
    entries = (*(_hinted(parameter) for parameter in group.parameters), reset)
    return Folder(f"design.{group.title}", group.title, open=group.open, entries=entries)


def load_html(frame: Frame) -> str:
    """Return the load at the platform's center: what the actuators carry, and what bearings do."""
    notes = load_notes(frame.shown_design, frame.configuration.pose)
    return of_pose(frame, blocks_html("load", *notes))


def _set_frame(state: State, frame: LoadFrame) -> State:
    design = state.document.design
    changed = replace(design, load=replace(design.load, frame=frame))
    return actions.change_document(state, design=changed)


ABOVE_LOAD = (
    Html("design.load", content=load_html),
    Dropdown(
        "design.load.frame", "Direction fixed in",
        options={"the world": LoadFrame.WORLD, "the platform": LoadFrame.PLATFORM},
        hint="Whether force and moment keep their direction or turn with the platform; the point "
        "always moves with it",
        read=lambda state: state.document.design.load.frame, apply=_set_frame,
    ),
)  # fmt: skip
"""What is above the sliders of the load."""


def _folders(section: str) -> tuple[Entry, ...]:
    """Return the folders of a section, a group of numbers each."""
    return tuple(_folder(group) for group in GROUPS if group.tab == section)


LENGTHS: tuple[Entry, ...] = _folders("Lengths")

MASSES: tuple[Entry, ...] = (Html("design.gauge", content=gauge_html), *_folders("Masses"))

LOAD: tuple[Entry, ...] = (*ABOVE_LOAD, *_folders("Load"))
