"""Springs against gravity: their place, the fit, and what the actuators hold with them."""

from __future__ import annotations

from typing import Any

from paminsa_viz.explorer.background import BackgroundJob
from paminsa_viz.explorer.balancing import springs
from paminsa_viz.explorer.balancing.spring_settings import (
    HEIGHTS,
    LENGTHS,
    SpringJob,
    SpringOutcome,
    SpringsFrom,
)
from paminsa_viz.explorer.entries import Button, Custom, Entry, Html
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.inputs import MILLIMETERS, Dropdown, Number, Pair, Range, attribute
from paminsa_viz.explorer.panels import render
from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.state import State
from paminsa_viz.units import number

GAP = 1e-6
"""Gap of a certificate that is not worth a word [N m]."""


def springs_html(frame: Frame) -> str:
    """Return the springs that were found, and torques without and with them."""
    state = frame.state
    springing = state.springing
    outcome = springing.outcome
    if springing.running is not None:
        return render("status.j2", testid="springs", level="plain", title="Fitting …", lines=[])
    if outcome is None:
        return render("springs.j2", rows=[], facts=[], lines=[])
    if outcome.fit is None:
        return render(
            "status.j2", testid="springs", level="bad", title="No springs",
            lines=[outcome.problem],
        )  # fmt: skip
    fit, (spring,) = outcome.fit, outcome.fit.springs
    low, high = fit.reach[0]
    facts = [
        ("stiffness on each leg", f"{number(spring.stiffness, 4)} N/m"),
        ("free length", f"{number(1e3 * spring.free_length, 4)} mm"),
        ("length in use", f"{1e3 * low:.0f} to {1e3 * high:.0f} mm"),
    ]
    held = springs.relieved(state, frame.torques)
    assert held is not None
    rows = [("largest on the map", fit.before, fit.after, "N·m")]
    rows += [
        (f"M{j + 1} at this pose", frame.torques[j], held[j], "N·m" if j < 3 else "N")
        for j in range(4)
    ]
    better = f" by more than {number(fit.gap, 2)} N·m" if fit.gap > GAP else ""
    lines = [f"Certified: no other stiffness and free length is better{better}."]
    if not springs.is_current(state):
        lines.append("Fitted to another design, θ, z or setting: fit again.")
    return render("springs.j2", rows=rows, facts=facts, lines=lines)


def _setting(name: str) -> dict[str, Any]:
    return attribute(f"springing.settings.{name}", springs.change_settings)


def _length(name: str, label: str, limits: Range, hint: str, **more: Any) -> Number:
    return Number(
        f"springs.{name}", label, range=limits, step=1.0, unit=MILLIMETERS, hint=hint,
        **_setting(name), **more,
    )  # fmt: skip


def _free_lengths(state: State) -> tuple[float, float]:
    return state.springing.settings.least, state.springing.settings.most


class SpringFitter:
    """Runs the fit that is asked for."""

    def __init__(self, session: Session) -> None:
        self._job: BackgroundJob[SpringJob, SpringOutcome] = BackgroundJob(
            session, "springs", lambda job, _: springs.run(job), springs.receive, undo=False,
            failed=lambda job, problem: SpringOutcome(job, None, problem),
        )  # fmt: skip

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Start what is requested."""
        del dragging
        self._job.request(frame.state.springing.running)


SPRINGS: tuple[Entry, ...] = (
    Custom("springs.fitter", make=SpringFitter),
    Html("springs.text", content=springs_html),
    Dropdown(
        "springs.start", "Springs from", options={each.value: each for each in SpringsFrom},
        hint="One on each leg, to the knee 9. A mast on slider 8 travels along the guide; with a "
        "free length of zero its spring balances exactly",
        **_setting("start"),
    ),
    _length("height", "Height [mm]", HEIGHTS, "Of the mast or post, above the guides"),
    _length(
        "radius", "Radius [mm]", LENGTHS, "Of the post, from the leg axis toward the platform",
        visible=lambda state: state.springing.settings.start is SpringsFrom.GUIDE,
    ),
    Pair(
        "springs.free", "Free length [mm]", range=(LENGTHS, LENGTHS), step=1.0,
        units=(MILLIMETERS, MILLIMETERS), read=_free_lengths,
        apply=lambda state, ends: springs.change_settings(state, least=ends[0], most=ends[1]),
        hint="Shortest and longest that is possible; both zero for a spring of free length zero",
    ),
    Button(
        "springs.fit", "Fit springs", effect=springs.start, undo=False,
        disabled=lambda state: state.springing.running is not None,
        hint="Stiffness and free length for the least peak of M1–M3 on the map at this θ and z, "
        "over poses that count; certified",
    ),
    Button(
        "springs.clear", "Remove the springs", effect=springs.clear, color="gray", undo=False,
        visible=lambda state: state.springing.outcome is not None,
    ),
)  # fmt: skip
