"""Tolerances of the balance: what masses and lengths within them do to the static torques."""

from __future__ import annotations

from paminsa_viz.blocks.tolerances import length_tolerance_blocks, mass_tolerance_blocks
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.features.tolerances.actions import CELLS, DRAW, ROBOTS, of_masses
from paminsa_viz.explorer.kit.entries import Answer, Button, Entry, Html
from paminsa_viz.explorer.kit.robot_texts import table_decimals
from paminsa_viz.explorer.kit.setting_inputs import SettingInputs
from paminsa_viz.explorer.kit.text import blocks_html
from paminsa_viz.explorer.state.tolerances import ToleranceSettings
from paminsa_viz.units import counted


def masses_html(frame: Frame) -> str:
    """Return the spread of M_p2 and of the torques at this pose from the tolerance of masses."""
    state = frame.state
    mass = state.tolerances.settings.mass
    found = of_masses(frame.shown_design, state.last_reachable.pose, mass)
    places = table_decimals(frame.shown_design)
    return blocks_html("tolerance-masses", *mass_tolerance_blocks(found, places))


def lengths_html(frame: Frame) -> str:
    """Return the spread of the peak torque from the tolerance of lengths."""
    state, found = frame.state, DRAW.result(frame.state)
    if found is None or DRAW.runs(state):
        return DRAW.text(state, "tolerance", "Computing …", "No sample")
    blocks = length_tolerance_blocks(found, table_decimals(frame.shown_design))
    return blocks_html("tolerance", *blocks, bold=[1], stale=DRAW.stale_text(state))


_setting = SettingInputs("tolerance", "tolerances.settings", ToleranceSettings)

TOLERANCES: tuple[Entry, ...] = (
    DRAW.worker,
    _setting("mass"),
    _setting("length"),
    Button(
        "tolerance.draw", "Draw robots", effect=DRAW.start, undo=False,
        disabled=DRAW.runs,
        hint=f"{counted(ROBOTS, 'robot')} within the tolerance of lengths, at this θ and z, at "
        f"those of {CELLS} × {CELLS} positions of the map that count",
    ),
    Answer(
        "tolerance.answer", "Balance within tolerances", found=DRAW.outcome, always=True,
        entries=(
            Html("tolerance.masses", content=masses_html, idle=True),
            Html("tolerance.lengths", content=lengths_html, idle=True),
        ),
    ),
)  # fmt: skip
