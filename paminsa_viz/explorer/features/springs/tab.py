"""Springs against gravity: their place, the fit, and what the actuators hold with them."""

from __future__ import annotations

from paminsa_viz.blocks.kinds import Note
from paminsa_viz.blocks.springs import springs_blocks
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.features.springs import actions as springs
from paminsa_viz.explorer.kit.entries import Answer, Button, Entry, Html
from paminsa_viz.explorer.kit.inputs import Pair
from paminsa_viz.explorer.kit.robot_texts import table_decimals
from paminsa_viz.explorer.kit.setting_inputs import SettingInputs
from paminsa_viz.explorer.kit.text import blocks_html
from paminsa_viz.explorer.state.settings import MILLIMETERS
from paminsa_viz.explorer.state.springs import LENGTHS, SpringSettings, SpringsFrom
from paminsa_viz.explorer.state.state import State

BESIDE = Note(
    "Springs are not part of the design: maps, motions and all other numbers are of the robot "
    "without them.",
    "muted",
)


def springs_html(frame: Frame) -> str:
    """Return the springs that were found, and torques without and with them."""
    state = frame.state
    fit, held = springs.FIT.result(state), springs.relieved(state, frame.torques)
    if fit is None or held is None or springs.FIT.runs(state):
        without = blocks_html("springs", BESIDE)
        return springs.FIT.text(state, "springs", "Fitting …", "No springs") or without
    return blocks_html(
        "springs",
        *springs_blocks(fit, frame.torques, held, table_decimals(frame.shown_design)),
        BESIDE,
        stale=springs.FIT.stale_text(state),
    )  # fmt: skip


def _free_lengths(state: State) -> tuple[float, float]:
    return state.springs.settings.least, state.springs.settings.most


_setting = SettingInputs("springs", "springs.settings", SpringSettings)

SPRINGS: tuple[Entry, ...] = (
    springs.FIT.worker,
    Html(
        "springs.about", content=springs_html, visible=lambda state: state.springs.outcome is None
    ),
    _setting("start"),
    _setting("height"),
    _setting(
        "radius", visible=lambda state: state.springs.settings.start is SpringsFrom.GUIDE
    ),
    Pair(
        "springs.free", "Free length [mm]", range=(LENGTHS, LENGTHS), step=1.0,
        units=(MILLIMETERS, MILLIMETERS), read=_free_lengths,
        apply=lambda state, ends: state.updated(
            "springs.settings", least=ends[0], most=ends[1]
        ),
        hint="Shortest and longest that is possible; both zero for a spring of free length zero",
    ),
    Button(
        "springs.fit", "Fit springs", effect=springs.FIT.start, undo=False,
        disabled=springs.FIT.runs,
        hint="Stiffness and free length for the least peak of M1–M3 at this θ and z, over those of "
        f"{springs.CELLS} × {springs.CELLS} positions of the map that count; certified",
    ),
    Answer(
        "springs.answer", "Springs", found=springs.FIT.outcome,
        entries=(
            Html("springs.text", content=springs_html),
            Button(
                "springs.clear", "Remove the springs", effect=springs.FIT.forget, color="gray",
                undo=False, hint="Forgets the springs that were fitted; the design has none",
            ),
        ),
    ),
)  # fmt: skip
