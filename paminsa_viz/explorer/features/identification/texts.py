"""The texts of the identification: logs, numbers with intervals, causes, masses, the motion."""

from __future__ import annotations

import math

from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.features.identification.actions import IDENTIFY, SEARCH
from paminsa_viz.explorer.kit.text import note, render, status
from paminsa_viz.identification.causes import Cause
from paminsa_viz.identification.results import Estimate
from paminsa_viz.model.drive import ACTUATORS
from paminsa_viz.units import display_unit, format_value, interval_text, number

TRIED = 4
"""Causes that are listed with those that are named."""


def logs_html(frame: Frame) -> str:
    """Return which logs are open."""
    own = frame.state.identification
    logs = [("log", own.log), ("second log", own.other), ("with payload", own.loaded)]
    return render(
        "identification/logs.j2", logs=[(name, log) for name, log in logs if log is not None]
    )


def status_html(frame: Frame) -> str:
    """Return how the identification went, in a box."""
    state, found = frame.state, IDENTIFY.result(frame.state)
    if found is None or IDENTIFY.runs(state):
        return IDENTIFY.text(state, "identify-status", "Identifying …", "Not identified") or ""
    lines = [f"{cause.text}: {_size(cause)}" for cause in found.causes.named]
    if found.identification.identity.holds is False:
        lines.append("the masses' identity fails: a spring, or another law")
    good = not lines
    title = "Masses and friction explain the log" if good else "The model lacks something"
    lines.append(IDENTIFY.stale_text(state))
    return status("identify-status", "ok" if good else "warn", title, *lines)


def _size(cause: Cause) -> str:
    factor, unit = display_unit(cause.unit) if cause.unit else (100.0, "%")
    return f"{interval_text(factor * cause.value, factor * cause.half_width)} {unit}"


def numbers_html(frame: Frame) -> str:
    """Return the estimates with their intervals; what is unknown is gray."""
    found = frame.state.identification.result
    if found is None:
        return ""
    one = found.identification
    identity = one.identity
    checked = "not checked"
    if identity.holds is not None:
        checked = f"{'holds' if identity.holds else 'fails'}, z = {number(identity.z, 2)}"
    return render(
        "identification/numbers.j2", rows=[_row(item) for item in one.estimates], identity=checked,
        holds=identity.holds, notes=one.notes,
    )  # fmt: skip


def _row(item: Estimate) -> dict[str, object]:
    p = item.parameter
    text = interval_text(item.value, item.half_width) if item.known else "unknown"
    outside = item.known and abs(item.value - p.design) > item.half_width
    return {
        "symbol": item.symbol, "label": p.label, "known": item.known, "value": text,
        "unit": p.unit, "design": number(p.design, 4), "outside": outside, "reason": item.reason,
    }  # fmt: skip


def causes_html(frame: Frame) -> str:
    """Return what was tried as a cause, and what the log cannot show."""
    found = frame.state.identification.result
    if found is None:
        return ""
    causes = found.causes
    tried = [item for item in causes.ranked if not item.named and item.explains > 0][:TRIED]
    rows = [(item, _size(item), 100 * item.explains) for item in (*causes.named, *tried)]
    return render("identification/causes.j2", rows=rows, named=causes.named, unseen=causes.unseen)


def checks_html(frame: Frame) -> str:
    """Return what the second and the third log say."""
    found = frame.state.identification.result
    if found is None:
        return ""
    check, payload = found.validation, found.payload
    lines: list[tuple[str, str]] = []
    if check is not None:
        ratios = ", ".join(
            f"{name} {number(float(ratio), 3)}"
            for name, ratio in zip(ACTUATORS, check.ratio, strict=True)
        )
        lines.append(("Second log", f"residual over its own fit’s: {ratios}"))
    if payload is not None:
        lines.append(("Payload", f"{interval_text(payload.mass, payload.half_width)} kg"))
        free = interval_text(payload.free_mass, payload.free_half_width)
        lines.append(("if F₄ drifted", f"{free} kg"))
        if payload.gain is not None:
            lines.append(("Common gain", interval_text(*payload.gain)))
    return render("identification/checks.j2", lines=lines) if lines else ""


def masses_html(frame: Frame) -> str:
    """Return the nearest masses; those of which the log says nothing are gray."""
    found = frame.state.identification.result
    if found is None:
        return ""
    rows = [
        (
            item.parameter, number(item.parameter.display.from_si(item.prior), 4),
            interval_text(
                item.parameter.display.from_si(item.value),
                item.parameter.display.factor * item.deviation,
            ) if item.told else number(item.parameter.display.from_si(item.value), 4),
            item.told,
        )
        for item in found.nearest.masses
    ]  # fmt: skip
    return render("identification/masses.j2", rows=rows, misfit=found.nearest.misfit)


def excitation_html(frame: Frame) -> str:
    """Return what the motion is worth, and the limits that it keeps."""
    outcome = frame.state.identification.excitation.outcome
    if outcome is None:
        return ""
    found = outcome.result
    if found is None:
        return note("excitation", outcome.problem)
    rows = [
        (
            row.name,
            format_value(row.value, row.unit, 3),
            format_value(row.limit, row.unit, 4),
            100 * (row.limit / row.value if row.least else row.value / row.limit)
            if row.value and row.limit and math.isfinite(row.limit)
            else 0.0,
            row.kept,
        )
        for row in found.limits
    ]  # fmt: skip
    return render(
        "identification/excitation.j2", found=found, rows=rows, stale=SEARCH.stale_text(frame.state)
    )
