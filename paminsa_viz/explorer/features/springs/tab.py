"""Springs against gravity: their place, the fit, and what the actuators hold with them."""

from __future__ import annotations

from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.features.springs import actions as springs
from paminsa_viz.explorer.kit.entries import Answer, Button, Entry, Html
from paminsa_viz.explorer.kit.inputs import Pair
from paminsa_viz.explorer.kit.setting_inputs import SettingInputs
from paminsa_viz.explorer.kit.text import render
from paminsa_viz.explorer.state.settings import MILLIMETERS
from paminsa_viz.explorer.state.springs import LENGTHS, SpringSettings, SpringsFrom
from paminsa_viz.explorer.state.state import State
from paminsa_viz.units import format_value, number

GAP = 1e-6
"""Gap of a certificate that is not worth a word [N m]."""


def springs_html(frame: Frame) -> str:
    """Return the springs that were found, and torques without and with them."""
    state = frame.state
    fit, held = springs.FIT.result(state), springs.relieved(state, frame.torques)
    if fit is None or held is None or springs.FIT.runs(state):
        empty = render("springs/result.j2", rows=[], facts=[], lines=[])
        return springs.FIT.text(state, "springs", "Fitting …", "No springs") or empty
    (spring,) = fit.springs
    low, high = fit.reach[0]
    facts = [
        ("stiffness on each leg", format_value(spring.stiffness, "N/m")),
        ("free length", format_value(spring.free_length, "m")),
        ("length in use", f"{format_value(low, 'm', 3)} to {format_value(high, 'm', 3)}"),
    ]
    rows = [("largest on the map", fit.before, fit.after, "N·m")]
    rows += [
        (f"M{j + 1} at this pose", frame.torques[j], held[j], "N·m" if j < 3 else "N")
        for j in range(4)
    ]
    better = f" by more than {number(fit.gap, 2)} N·m" if fit.gap > GAP else ""
    lines = [f"Certified: no other stiffness and free length is better{better}."]
    lines += filter(None, [springs.FIT.stale_text(state)])
    return render("springs/result.j2", rows=rows, facts=facts, lines=lines)


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
        hint="Stiffness and free length for the least peak of M1–M3 on the map at this θ and z, "
        "over poses that count; certified",
    ),
    Answer(
        "springs.answer", "Springs", found=springs.FIT.outcome,
        entries=(
            Html("springs.text", content=springs_html),
            Button(
                "springs.clear", "Remove the springs", effect=springs.FIT.forget, color="gray",
                undo=False,
            ),
        ),
    ),
)  # fmt: skip
