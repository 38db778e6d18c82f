"""Tolerances of the balance: what masses and lengths within them do to the static torques."""

from __future__ import annotations

from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.features.tolerances.actions import DRAW, of_masses
from paminsa_viz.explorer.kit.entries import Answer, Button, Entry, Html
from paminsa_viz.explorer.kit.setting_inputs import SettingInputs
from paminsa_viz.explorer.kit.text import render
from paminsa_viz.explorer.state.tolerances import ToleranceSettings
from paminsa_viz.model import PARAMETER

LEADING = 3
"""Masses that are named, by their share in the variance."""


def masses_html(frame: Frame) -> str:
    """Return the spread of M_p2 and of the torques at this pose from the tolerance of masses."""
    state = frame.state
    mass = state.tolerances.settings.mass
    found = of_masses(frame.shown_design, state.last_reachable.pose, mass)
    rows = [("M_p2", found.nominal, found.deviation, abs(found.nominal) + found.worst, "N")]
    rows += [
        (f"M{j + 1}", float(found.torque[j]), float(found.torque_deviation[j]),
         float(found.torque_worst[j]), "N·m")
        for j in range(3)
    ]  # fmt: skip
    shares = [(_symbol(path), share) for path, share in list(found.shares.items())[:LEADING]]
    return render("tolerances/masses.j2", rows=rows, shares=shares)


def _symbol(path: str) -> str:
    if path in PARAMETER:
        return PARAMETER[path].symbol
    return f"counterweight {int(path.split('.')[1]) + 1}"


def lengths_html(frame: Frame) -> str:
    """Return the spread of the peak torque from the tolerance of lengths."""
    state, found = frame.state, DRAW.result(frame.state)
    if found is None or DRAW.runs(state):
        return DRAW.text(state, "tolerance", "Computing …", "No sample") or ""
    return render(
        "tolerances/lengths.j2", found=found, robots=found.peaks.size,
        lost=int((found.lost > 0).sum()), stale=DRAW.stale_text(state),
    )  # fmt: skip


_setting = SettingInputs("tolerance", "tolerances.settings", ToleranceSettings)

TOLERANCES: tuple[Entry, ...] = (
    DRAW.worker,
    _setting("mass"),
    _setting("length"),
    Button(
        "tolerance.draw", "Draw robots", effect=DRAW.start, undo=False,
        disabled=DRAW.runs,
        hint="200 robots within the tolerance of lengths, on the map at this θ and z",
    ),
    Answer(
        "tolerance.answer", "Balance within tolerances", found=DRAW.outcome, always=True,
        entries=(
            Html("tolerance.masses", content=masses_html, idle=True),
            Html("tolerance.lengths", content=lengths_html, idle=True),
        ),
    ),
)  # fmt: skip
