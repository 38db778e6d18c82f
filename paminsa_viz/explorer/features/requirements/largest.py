"""The largest workspace that is proven to meet the requirements, a folder of its tab."""

from __future__ import annotations

from viser import Icon

from paminsa_viz.blocks.kinds import Table
from paminsa_viz.blocks.proofs import largest_blocks
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.features.requirements import actions
from paminsa_viz.explorer.kit.entries import Answer, Button, Html, Then
from paminsa_viz.explorer.kit.setting_inputs import SettingInputs
from paminsa_viz.explorer.kit.text import blocks_html, note
from paminsa_viz.explorer.state.requirements import LargestSettings
from paminsa_viz.explorer.state.state import State
from paminsa_viz.synthesis.proof.regions import Growth


def result_html(frame: Frame) -> str:
    """Return what is proven, how far it is from what cannot be, and why it ends there."""
    search = frame.state.requirements.largest
    outcome, found = search.outcome, search.result
    if outcome is None or search.running is not None:
        return ""
    if found is None:
        return note("largest-problem", outcome.problem)
    job = outcome.job
    blocks = [
        item.columns(0, 2, 3) if isinstance(item, Table) else item
        for item in largest_blocks(job.requirements, found)
    ]
    return blocks_html(
        "largest-result", *blocks, look="pv-requirements",
        stale=actions.LARGEST.stale_text(frame.state),
    )  # fmt: skip


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
                hint="Makes its size, center and shape those that the requirements are for",
            ),
        ),
    ),
    actions.LARGEST.worker,
)  # fmt: skip
