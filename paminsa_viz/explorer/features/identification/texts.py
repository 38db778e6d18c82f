"""The texts of the identification: logs, numbers with intervals, causes, masses, the motion."""

from __future__ import annotations

from paminsa_viz.blocks.excitation import information_text, limits_table
from paminsa_viz.blocks.identification import (
    EXPLAINED,
    UNEXPLAINED,
    cause_size,
    causes_table,
    checks_table,
    estimates_table,
    identity_note,
    masses_table,
    unseen_note,
)
from paminsa_viz.blocks.kinds import Note
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.features.identification.actions import IDENTIFY, SEARCH
from paminsa_viz.explorer.kit.text import blocks_html, note, render, status
from paminsa_viz.units import number


def logs_html(frame: Frame) -> str:
    """Return which logs are open."""
    own = frame.state.identification
    logs = [("Log", own.log), ("second log", own.other), ("with payload", own.loaded)]
    return render(
        "identification/logs.j2", logs=[(name, log) for name, log in logs if log is not None]
    )


def status_html(frame: Frame) -> str:
    """Return how the identification went, in a box."""
    state, found = frame.state, IDENTIFY.result(frame.state)
    if found is None or IDENTIFY.runs(state):
        return IDENTIFY.text(state, "identify-status", "Identifying …", "Not identified")
    lines = [f"{cause.text}: {cause_size(cause)}" for cause in found.causes.named]
    if found.identification.identity.holds is False:
        lines.append("the masses’ identity fails: a spring, or another law")
    if problem := found.identification.problem:
        lines.append(problem)
    good = not lines
    title = EXPLAINED if good else UNEXPLAINED
    lines.append(IDENTIFY.stale_text(state))
    return status("identify-status", "ok" if good else "warn", title, *lines)


def numbers_html(frame: Frame) -> str:
    """Return the estimates with their intervals; what is unknown is gray."""
    found = frame.state.identification.result
    if found is None:
        return ""
    one = found.identification
    return blocks_html(
        "identify-numbers", estimates_table(found).columns(0, 2, 3, hint=1),
        Note(
            "b₁ to b₁₁ are the combinations of masses and lengths that torques depend on, and all "
            "that a log can tell; the tooltip of each says which."
        ),
        identity_note(one.identity),
        Note(
            "Gray: the log does not tell it; the tooltip says what motion would. Bold: the design "
            "is outside the interval."
        ),
        *(Note(text, "muted") for text in one.notes), look="pv-identify",
    )  # fmt: skip


def causes_html(frame: Frame) -> str:
    """Return what was tried as a cause, and what the log cannot show."""
    found = frame.state.identification.result
    if found is None:
        return ""
    text = (
        "Nothing in the log contradicts masses and friction (at 0.1 %). Largest of what was tried:"
    )
    contradicted = found.causes.named or found.identification.problem
    opening = [] if contradicted else [Note(text)]
    table = causes_table(found).columns(0, 1, 2)
    return blocks_html(
        "identify-causes", *opening, table, unseen_note(found), look="pv-identify pv-wrapped"
    )


def checks_html(frame: Frame) -> str:
    """Return what the second and the third log say."""
    found = frame.state.identification.result
    table = None if found is None else checks_table(found)
    if table is None or not table.rows:
        return ""
    return blocks_html("identify-checks", table, look="pv-identify")


def masses_html(frame: Frame) -> str:
    """Return the nearest masses; those of which the log says nothing are gray."""
    found = frame.state.identification.result
    if found is None:
        return ""
    table = masses_table(found)
    text = Note(f"{table.caption} Gray: the log adds nothing.")
    narrow = table.columns(0, 2, 3, hint=1)
    return blocks_html("identify-masses", text, narrow, look="pv-identify")


def excitation_html(frame: Frame) -> str:
    """Return what the motion is worth, and the limits that it keeps."""
    outcome = frame.state.identification.excitation.outcome
    if outcome is None:
        return ""
    found = outcome.result
    if found is None:
        return note("excitation", outcome.problem)
    return blocks_html(
        "excitation", Note(f"{number(found.plan.duration)} s; {information_text(found)}"),
        limits_table(found).columns(0, 1, 2, 4), look="pv-identify",
        stale=SEARCH.stale_text(frame.state),
    )  # fmt: skip
