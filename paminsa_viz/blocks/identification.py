"""Identification: what a log of the built robot says of masses, balance and friction."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

from paminsa_viz.blocks.data import record
from paminsa_viz.blocks.kinds import Block, Figure, Note, Row, Table, rows
from paminsa_viz.identification.causes import Cause
from paminsa_viz.identification.findings import Findings
from paminsa_viz.identification.validation import PayloadEstimate
from paminsa_viz.model.drive import ACTUATORS, TORQUE_UNITS
from paminsa_viz.units import NONE, format_value, interval_text, number, unit_text

TRIED = 5
"""Causes that are listed with those that are named."""


def identification_blocks(findings: Findings) -> list[Block]:
    """Return the verdict, the torques, parameters, causes, checks and masses of a log."""
    one = findings.identification
    log = one.log
    blocks: list[Block] = [
        Note(
            f"Log “{log.name}”: {len(log.t)} rows at {log.rate:.6g} Hz, {log.duration:.4g} s. "
            f"{'; '.join(one.notes)}."
        ),
        _verdict(findings),
    ]
    alt = "Measured and predicted torques over time, with their differences."
    blocks.append(Figure(partial(_torques, findings), alt))
    rest = ", ".join(
        f"{name} {format_value(float(rms), unit, 3)}"
        for name, rms, unit in zip(ACTUATORS, one.noise, TORQUE_UNITS, strict=True)
    )
    blocks.append(Note(f"RMS of what is left: {rest}."))
    head = ("", "Parameter", "Log, 95 %", "Unit", "Design")
    numbers = tuple(
        Row(
            (
                item.symbol, item.parameter.label,
                interval_text(item.value, item.half_width) if item.known else "unknown",
                unit_text(item.parameter.unit), number(item.parameter.design, 4),
            ),
            "marked" if _differs(item.value, item.half_width, item.parameter.design, item.known)
            else "plain",
        )
        for item in one.estimates
    )  # fmt: skip
    caption = "Numbers that the log tells; marked where the design's is outside the interval."
    blocks.append(Table(head, numbers, caption, words=2))
    if one.unknown:
        reasons = rows(*((item.symbol, item.reason) for item in one.unknown))
        blocks.append(Table(("", "Why"), reasons, "Unknown parameters.", words=2))
    blocks.append(_causes(findings))
    unseen = rows(*((text,) for text in findings.causes.unseen))
    blocks.append(Table(("",), unseen, "What cannot be seen in this log."))
    blocks += _checks(findings)
    return [*blocks, _masses(findings)]


def _torques(findings: Findings) -> bytes:
    from paminsa_viz.plots.identification_series import log_series  # late: matplotlib
    from paminsa_viz.plots.series_figure import render_series

    return render_series(log_series(findings), "svg", caption=False)


def _differs(value: float, half_width: float, design: float, known: bool) -> bool:
    return known and abs(value - design) > half_width


def _verdict(findings: Findings) -> Note:
    """Return whether masses and friction explain the log."""
    identity = findings.identification.identity
    named = "; ".join(item.text for item in findings.causes.named)
    check = NONE
    if identity.holds is not None:
        size = interval_text(identity.value, identity.half_width)
        verdict = "holds" if identity.holds else "fails"
        check = f"{verdict}, {size} N, z = {number(identity.z, 2)}"
    if named or identity.holds is False:
        what = f"What may be wrong: {named}." if named else "A spring may be."
        text = f"Masses and friction do not explain the log. {what} Identity of the masses: {check}"
        return Note(f"{text}.", "bad")
    return Note(f"Masses and friction explain the log. Identity of the masses: {check}.", "ok")


def _causes(findings: Findings) -> Table:
    causes = findings.causes
    others = [item for item in causes.ranked if not item.named and item.explains > 0][:TRIED]
    rows = tuple(
        Row(
            (
                item.text,
                _size(item),
                f"{100 * item.explains:.1f} %",
                "yes" if item.named else "no",
            ),
            "marked" if item.named else "plain",
        )
        for item in (*causes.named, *others)
    )
    head = ("Cause", "Size, 95 %", "Explains of the residual", "Significant at 0.1 %")
    return Table(head, rows, "Causes of what the model leaves, tried one by one.", words=1)


def _size(item: Cause) -> str:
    factor, unit = (1.0, unit_text(item.unit)) if item.unit else (100.0, "%")
    return f"{interval_text(factor * item.value, factor * item.half_width)} {unit}"


def _checks(findings: Findings) -> list[Block]:
    found: list[Block] = []
    check, payload = findings.validation, findings.payload
    if check is not None:
        ratios = ", ".join(
            f"{name} {number(float(ratio), 4)}"
            for name, ratio in zip(ACTUATORS, check.ratio, strict=True)
        )
        found.append(
            Note(
                f"The numbers predict “{check.log.name}” with a residual, over that of its own "
                f"fit, of {ratios}."
            )
        )
    if payload is not None:
        trusted = interval_text(payload.mass, payload.half_width)
        free = interval_text(payload.free_mass, payload.free_half_width)
        text = f"Payload {trusted} kg; {free} kg if F_4 may have drifted between the logs."
        text += f" The drift is then {interval_text(payload.drift, payload.drift_half_width)} N."
        if payload.gain is not None:
            text += f" Common gain of the torques {interval_text(*payload.gain)}."
        found.append(Note(text))
    return found


def _masses(findings: Findings) -> Table:
    rows = tuple(
        Row(
            (
                item.parameter.symbol, item.parameter.label,
                interval_text(item.value, item.deviation) if item.told else number(item.value, 4),
                number(item.prior, 4), unit_text(item.parameter.unit),
                "" if item.told else "as designed: not in the log",
            )
        )
        for item in findings.nearest.masses
    )  # fmt: skip
    head = ("", "Mass or inertia", "Nearest", "Design", "Unit", "")
    caption = (
        "Masses nearest to the design that explain the log; ± one deviation, given the design."
    )
    return Table(head, rows, caption, words=2)


def identification_data(found: Findings, written: Sequence[Path]) -> dict[str, Any]:
    """Return everything as data for JSON, in SI units."""
    one, check = found.identification, found.validation
    log = one.log
    return {
        "design": one.design.name,
        "log": {"rows": len(log.t)} | record(log, "name", "rate_Hz", "duration_s"),
        "notes": one.notes,
        "parameters": [
            record(item, "symbol", "value", "half_width_95", "known", "reason")
            | record(item.parameter, "label", "unit", "design")
            for item in one.estimates
        ],
        "identity": record(one.identity, "value_N", "half_width_N", "z", "holds"),
        "residual_rms": one.noise,
        "masses": [
            record(item.parameter, "path", "unit") | {
                "design": item.prior, "nearest": item.value,
                "deviation_given_the_design": item.deviation, "known": item.told,
            }
            for item in found.nearest.masses
        ],
        "misfit": found.nearest.misfit,
        "causes": [_cause_data(item) for item in found.causes.ranked],
        "named": [_cause_data(item) for item in found.causes.named],
        "unseen": found.causes.unseen,
        "validation": check and {
            "log": check.log.name, "residual_rms": check.residual, "own_rms": check.own,
            "ratio": check.ratio,
        },
        "payload": found.payload and _payload_data(found.payload),
        "files": written,
    }  # fmt: skip


def _cause_data(item: Cause) -> dict[str, Any]:
    keys = ("unit", "value", "half_width_95", "p_value", "explains", "detectable")
    return {"cause": item.label, "nearly_as_much": item.alike} | record(item, *keys)


def _payload_data(item: PayloadEstimate) -> dict[str, Any]:
    gain = item.gain
    return {
        **record(item, "mass_kg", "half_width_kg", "known_kg"),
        "with_drift_of_F4": {
            "mass_kg": item.free_mass, "half_width_kg": item.free_half_width,
            **record(item, "drift_N", "drift_half_width_N"),
        },
        "gain": None if gain is None else {"value": gain[0], "half_width": gain[1]},
    }  # fmt: skip
