"""The largest workspace that is proven to meet the requirements, a folder of its tab."""

from __future__ import annotations

from viser import Icon

from paminsa_viz.blocks.requirements import evidence_table
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.features.requirements import actions
from paminsa_viz.explorer.kit.entries import Answer, Button, Html, Then
from paminsa_viz.explorer.kit.setting_inputs import SettingInputs
from paminsa_viz.explorer.kit.text import note, render
from paminsa_viz.explorer.state.requirements import LargestSettings
from paminsa_viz.explorer.state.state import State
from paminsa_viz.quantities.requirement_text import requirement_label, shape_text
from paminsa_viz.synthesis.proof.largest import LargestWorkspace
from paminsa_viz.synthesis.proof.regions import Growth
from paminsa_viz.units import format_value, number


def result_html(frame: Frame) -> str:
    """Return what is proven, how far it is from what cannot be, and why it ends there."""
    search = frame.state.requirements.largest
    outcome, found = search.outcome, search.result
    if outcome is None or search.running is not None:
        return ""
    if found is None:
        return note("largest-problem", outcome.problem)
    workspace = found.workspace
    place = ""
    if workspace is not None:
        x, y, z = (format_value(float(at or 0.0), "m") for at in workspace.center)
        place = f"x {x}, y {y}, z {z}"
    return render(
        "requirements/largest.j2", text="" if workspace is None else shape_text(workspace),
        place=place, gap=format_value(found.gap, "m", 2), seconds=number(found.seconds, 2),
        cause=cause_text(found), stale=actions.LARGEST.stale_text(frame.state),
        table=evidence_table(found.proof).columns(0, 2, 3),
    )  # fmt: skip


def cause_text(found: LargestWorkspace) -> str:
    """Return why the workspace is not larger."""
    if found.requirement is not None:
        return requirement_label(found.requirement)
    texts = {"home": "no path from home", "volume": "no position meets all requirements"}
    return texts.get(found.cause, found.cause)


def _is_proven(state: State) -> bool:
    search = state.requirements.largest
    return search.proven is not None and search.running is None


_setting = SettingInputs("largest", "requirements.largest.settings", LargestSettings)

LARGEST_WORKSPACE = (
    _setting("shape"),
    _setting("growth", options={growth.value: growth.name for growth in Growth}),
    _setting("free"),
    _setting("seconds"),
    *actions.LARGEST.buttons(
        Button(
            "largest.start", "Find the largest", icon=Icon.CERTIFICATE, undo=False,
            effect=actions.LARGEST.start,
            hint="Reach and singularities in closed form, condition number, torques and F₄ by "
            "interval bisection",
        ),
    ),
    Answer(
        "largest.answer", "Largest workspace", found=actions.LARGEST.outcome,
        entries=(
            Html("largest.result", content=result_html),
            Button(
                "largest.use", "Use as required workspace", visible=_is_proven,
                effect=Then(
                    actions.use_largest, "The workspace that was proven is the required one now."
                ),
            ),
        ),
    ),
    actions.LARGEST.worker,
)  # fmt: skip
