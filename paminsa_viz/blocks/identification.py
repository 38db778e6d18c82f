"""Identification: what a log of the built robot says of masses, balance and friction."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any, Literal

from paminsa_viz.blocks.data import record, robot
from paminsa_viz.blocks.kinds import Block, Figure, Note, Row, Table, heading, rows
from paminsa_viz.identification.causes import Cause
from paminsa_viz.identification.findings import Findings
from paminsa_viz.identification.results import WRONG_UNIT, Estimate, Identity
from paminsa_viz.identification.validation import PayloadEstimate
from paminsa_viz.model.drive import ACTUATORS, TORQUE_UNITS
from paminsa_viz.model.statics import shown_imbalance
from paminsa_viz.units import counted, display_unit, format_value, interval_text, number, percent

TRIED = 5
"""Causes that are listed with those that are named."""


def identification_blocks(findings: Findings) -> list[Block]:
    """Return the verdict, the torques, parameters, causes, checks and masses of a log."""
    one = findings.identification
    log = one.log
    blocks: list[Block] = [
        Note(
            f"Log “{log.name}”: {counted(len(log.t), 'row')} at {log.rate:.6g} Hz, "
            f"{log.duration:.4g} s. {'; '.join(one.notes)}."
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
    blocks.append(estimates_table(findings))
    if one.unknown:
        reasons = rows(*((item.symbol, item.reason()) for item in one.unknown))
        blocks.append(Table(("", "Why"), reasons, "Unknown parameters.", words=2))
    blocks += [causes_table(findings), unseen_note(findings)]
    if (checks := checks_table(findings)).rows:
        blocks.append(checks)
    return [*blocks, masses_table(findings)]


def estimates_table(findings: Findings) -> Table:
    """Return the numbers of the model that a log tells, beside those of the design."""
    one, found = findings.identification, []
    summed = {"M_p2": shown_imbalance(one.design)}
    for item in one.estimates:
        p = item.parameter
        factor = display_unit(p.unit).factor
        text = "unknown"
        if item.known:
            text = interval_text(factor * item.value, factor * item.half_width)
        held = number(factor * summed.get(item.symbol, p.design), 4, padded=True)
        cells = (heading(item.symbol, p.unit), p.label, text, held)
        found.append(Row(cells, _estimate_kind(item), hint=item.reason()))
    caption = "Numbers that the log tells; marked where the design’s is outside the interval."
    return Table(("", "Parameter", "Log, 95 %", "Design"), tuple(found), caption, words=2)


def _estimate_kind(item: Estimate) -> Literal["plain", "marked", "muted"]:
    if not item.known:
        return "muted"
    return "marked" if abs(item.value - item.parameter.design) > item.half_width else "plain"


def _torques(findings: Findings) -> bytes:
    from paminsa_viz.plots.identification_series import log_series  # late: matplotlib
    from paminsa_viz.plots.series_figure import render_series

    return render_series(log_series(findings), "svg", caption=False)


def _verdict(findings: Findings) -> Note:
    """Return whether masses and friction explain the log."""
    identity = findings.identification.identity
    problem = findings.identification.problem
    faults = [item.text for item in findings.causes.named] + ([problem] if problem else [])
    named = "; ".join(faults)
    checked = identity_note(identity).text
    if named or identity.holds is False:
        what = f"What may be wrong: {named}." if named else "A spring may be."
        return Note(f"{UNEXPLAINED}. {what} {checked}", "bad")
    return Note(f"{EXPLAINED}. {checked}", "ok")


EXPLAINED = "Masses and friction explain the log"
UNEXPLAINED = "Masses and friction do not explain the log"


def identity_note(identity: Identity) -> Note:
    """Return whether the identity of the masses holds."""
    if identity.holds is None:
        return Note("Identity of the masses: not checked.")
    size = interval_text(identity.value, identity.half_width)
    verdict, kind = ("holds", "ok") if identity.holds else ("fails", "bad")
    text = f"Identity of the masses: {verdict}, {size} N, z = {number(identity.z, 2)}."
    return Note(text, kind)


def causes_table(findings: Findings) -> Table:
    """Return what was tried as a cause of what the model leaves; named ones are marked."""
    causes = findings.causes
    others = [item for item in causes.ranked if not item.named and item.explains > 0][:TRIED]
    found = tuple(
        Row(
            (
                item.text, cause_size(item), percent(item.explains, 1),
                "yes" if item.named else "no",
            ),
            "marked" if item.named else "muted",
        )
        for item in (*causes.named, *others)
    )  # fmt: skip
    head = ("Cause, by itself", "Size, 95 %", "Explains", "Significant at 0.1 %")
    return Table(
        head, found, "Causes, tried one by one, and how much of the residual each explains."
    )


def cause_size(item: Cause) -> str:
    """Return the size of a cause, with its interval."""
    factor, unit = display_unit(item.unit or "1:%")
    return f"{interval_text(factor * item.value, factor * item.half_width)} {unit}"


def unseen_note(findings: Findings) -> Note:
    """Return what the log cannot show."""
    return Note(f"Cannot be seen in this log: {'; '.join(findings.causes.unseen)}.", "muted")


MASS_IN_DOUBT = ": check the payload’s mass [kg] and which log it is in"
"""After a gain that no robot has, see `WRONG_UNIT`."""


def checks_table(findings: Findings) -> Table:
    """Return what a second log, and one with a payload, say of the numbers; empty without."""
    cells: list[tuple[str, str]] = []
    check, payload = findings.validation, findings.payload
    if check is not None:
        ratios = ", ".join(
            f"{name} {number(float(ratio), 3)}"
            for name, ratio in zip(ACTUATORS, check.ratio, strict=True)
        )
        cells.append((f"Second log, “{check.log.name}”", f"residual over its own fit’s: {ratios}"))
    if payload is not None:
        free = interval_text(payload.free_mass, payload.free_half_width)
        drift = interval_text(payload.drift, payload.drift_half_width)
        cells += [
            ("Payload", f"{interval_text(payload.mass, payload.half_width)} kg"),
            ("if F_4 drifted between the logs", f"{free} kg, a drift of {drift} N"),
        ]
        if payload.gain is not None:
            doubt = "" if 1 / WRONG_UNIT <= payload.gain[0] <= WRONG_UNIT else MASS_IN_DOUBT
            gain = f"{interval_text(*payload.gain)}{doubt}"
            cells.append(("Common gain of the torques", gain))
    return Table(("", ""), rows(*cells), "Checks by other logs.", words=2)


def masses_table(findings: Findings) -> Table:
    """Return the masses nearest to the design that explain the log."""
    found = []
    for item in findings.nearest.masses:
        p, factor = item.parameter, item.parameter.display.factor
        text, held = (number(factor * value, 4, padded=True) for value in (item.value, item.prior))
        why = "as designed: not in the log"
        if item.told:
            text, why = interval_text(factor * item.value, factor * item.deviation), ""
        cells = (heading(p.symbol, p.unit), p.label, text, held, why)
        found.append(Row(cells, "plain" if item.told else "muted"))
    caption = (
        "Masses nearest to the design that explain the log; ± is one standard deviation, given the "
        "design."
    )
    return Table(("", "Mass or inertia", "Nearest", "Design", ""), tuple(found), caption, words=2)


def identification_data(found: Findings, written: Sequence[Path]) -> dict[str, Any]:
    """Return everything as data for JSON, in SI units."""
    one, check = found.identification, found.validation
    log = one.log
    return {
        **robot(one.design),
        "log": {"rows": len(log.t)} | record(log, "name", "rate_Hz", "duration_s"),
        "notes": one.notes,
        "parameters": [
            record(item, "symbol", "value", "half_width_95", "known") | {"reason": item.reason()}
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
