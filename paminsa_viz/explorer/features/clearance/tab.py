"""Clearance in the panel View: the nearest bodies, which pairs are checked, and what is enough."""

from __future__ import annotations

from paminsa_viz.blocks.clearance import size_blocks, verdict
from paminsa_viz.clearance import PairGroup
from paminsa_viz.explorer.core import clearance
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.features.clearance.actions import ALONG_MOTION, OF_POSE, set_pairs
from paminsa_viz.explorer.kit.entries import Entry, Folder, Html
from paminsa_viz.explorer.kit.inputs import Checkbox
from paminsa_viz.explorer.kit.setting_inputs import SettingInputs
from paminsa_viz.explorer.kit.task import NOT_OF_PREVIEW
from paminsa_viz.explorer.kit.text import note, status
from paminsa_viz.explorer.state.clearance import ClearanceSettings
from paminsa_viz.explorer.state.state import State
from paminsa_viz.units import capitalized


def clearance_html(frame: Frame) -> str:
    """Return the nearest bodies of the pose."""
    state = frame.state
    found = clearance.nearest(state)
    if frame.is_preview:
        return note("clearance", NOT_OF_PREVIEW, muted=True)
    if found is None:
        known = state.clearance.pose is not None and state.clearance.pose.result is None
        text = "No pair of bodies is checked." if known else "Computing …"
        return note("clearance", text, muted=True)
    told = verdict(found.distance, found.names, state.clearance.settings.required)
    far_off = (block.text for block in size_blocks(state.last_reachable.geometry))
    return status("clearance", told.kind, " ".join([told.text, *far_off]))


def _switch(group: PairGroup) -> Checkbox:
    def read(state: State) -> bool:
        return group in state.clearance.settings.pairs

    def apply(state: State, checked: bool) -> State:
        return set_pairs(state, group, checked)

    return Checkbox(
        f"clearance.{group.name.lower()}", capitalized(group.value), read=read, apply=apply,
        hint=f"Check the pairs of bodies of this group: {group.value}",
    )  # fmt: skip


CLEARANCE: tuple[Entry, ...] = (
    OF_POSE.worker,
    ALONG_MOTION.worker,
    Folder(
        "clearance", "Clearance between bodies", open=False,
        entries=(
            Html("clearance.text", content=clearance_html),
            SettingInputs("clearance", "clearance.settings", ClearanceSettings)("required"),
            *map(_switch, PairGroup),
        ),
    ),
)  # fmt: skip
