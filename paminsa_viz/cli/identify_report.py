"""What ``paminsa-viz identify`` prints: tables for people, the same as data for programs."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from paminsa_viz import __version__
from paminsa_viz.cli.output import print_table, print_written
from paminsa_viz.identification.causes import Cause
from paminsa_viz.identification.findings import Findings
from paminsa_viz.identification.results import Estimate, Identity
from paminsa_viz.identification.validation import PayloadEstimate, Validation
from paminsa_viz.model.drive import ACTUATORS
from paminsa_viz.units import format_ascii, interval_text

UNITS = ("N m", "N m", "N m", "N")
LISTED = 5
"""Causes that are listed."""


def findings_data(found: Findings, written: Sequence[Path]) -> dict[str, Any]:
    """Return everything as data for JSON, in SI units."""
    one, check = found.identification, found.validation
    return {
        "made_by": f"paminsa_viz {__version__}",
        "design": one.design.name,
        "log": {
            "name": one.log.name, "rows": len(one.log.t), "rate_Hz": one.log.rate,
            "duration_s": one.log.duration,
        },
        "notes": list(one.notes),
        "parameters": [_estimate_data(item) for item in one.estimates],
        "identity": {
            "value_N": one.identity.value, "half_width_N": one.identity.half_width,
            "z": one.identity.z, "holds": one.identity.holds,
        },
        "residual_rms": one.noise.tolist(),
        "masses": [
            {
                "path": item.parameter.path, "unit": item.parameter.unit, "design": item.prior,
                "nearest": item.value, "deviation_given_the_design": item.deviation,
                "known": item.told,
            }
            for item in found.nearest.masses
        ],
        "misfit": found.nearest.misfit,
        "causes": [_cause_data(item) for item in found.causes.ranked],
        "named": [_cause_data(item) for item in found.causes.named],
        "unseen": list(found.causes.unseen),
        "validation": check and {
            "log": check.log.name, "residual_rms": check.residual.tolist(),
            "own_rms": check.own.tolist(), "ratio": check.ratio.tolist(),
        },
        "payload": found.payload and _payload_data(found.payload),
        "files": [os.fspath(path) for path in written],
    }  # fmt: skip


def _estimate_data(item: Estimate) -> dict[str, Any]:
    p = item.parameter
    return {
        "symbol": item.symbol, "label": p.label, "unit": p.unit, "value": item.value,
        "half_width_95": item.half_width, "design": p.design, "known": item.known,
        "reason": item.reason,
    }  # fmt: skip


def _cause_data(item: Cause) -> dict[str, Any]:
    return {
        "cause": item.label, "unit": item.unit, "value": item.value,
        "half_width_95": item.half_width, "p_value": item.p_value, "explains": item.explains,
        "detectable": item.detectable,
    }  # fmt: skip


def _payload_data(item: PayloadEstimate) -> dict[str, Any]:
    gain = item.gain
    return {
        "mass_kg": item.mass, "half_width_kg": item.half_width,
        "with_drift_of_F4": {
            "mass_kg": item.free_mass, "half_width_kg": item.free_half_width,
            "drift_N": item.drift, "drift_half_width_N": item.drift_half_width,
        },
        "known_kg": item.known,
        "gain": None if gain is None else {"value": gain[0], "half_width": gain[1]},
    }  # fmt: skip


def print_findings(found: Findings, written: Sequence[Path]) -> None:
    """Print the same for people."""
    one = found.identification
    print(
        f"{one.log.name}: {len(one.log.t)} rows at {one.log.rate:.6g} Hz, "
        f'{one.log.duration:.4g} s; design "{one.design.name}"'
    )
    for note in one.notes:
        print(note)
    print()
    rows = [("", "", "estimate, 95 %", "unit", "design")]
    rows += [_row(item) for item in one.estimates]
    print_table(rows)
    print()
    for item in one.unknown:
        print(f"{item.symbol} is unknown: {item.reason}")
    print(identity_line(one.identity))
    rest = ", ".join(
        f"{name} {format_ascii(float(rms), unit, 3)}"
        for name, rms, unit in zip(ACTUATORS, one.noise, UNITS, strict=True)
    )
    print(f"residual RMS: {rest}")
    _print_causes(found)
    if found.validation is not None:
        print(validation_line(found.validation))
    if found.payload is not None:
        for line in payload_lines(found.payload):
            print(line)
    _print_masses(found)
    print_written(written)


def _row(item: Estimate) -> tuple[str, ...]:
    p = item.parameter
    text = interval_text(item.value, item.half_width, ascii_only=True) if item.known else "unknown"
    return item.symbol, p.label, text, p.unit, f"{p.design:.4g}"


def identity_line(identity: Identity) -> str:
    """Return what the identity of the masses says."""
    if identity.holds is None:
        return "identity of the masses: not checked"
    size = f"{interval_text(identity.value, identity.half_width, ascii_only=True)} N"
    z = f"{size}, z = {identity.z:.2f}"
    if identity.holds:
        return f"identity of the masses: holds ({z})"
    return f"identity of the masses: fails ({z}); masses alone do not explain the log, a spring may"


def _print_causes(found: Findings) -> None:
    causes = found.causes
    print()
    if not causes.named:
        print("nothing in the log contradicts masses and friction (at 0.1 %)")
    for item in causes.named:
        print(f"named: {cause_text(item)}")
    others = [item for item in causes.ranked if not item.named and item.explains > 0][:LISTED]
    if causes.named and others:
        print("also tried, each by itself:")
        print_table(
            [(cause_text(item), f"explains {100 * item.explains:.1f} %") for item in others],
            indent=2,
        )
    print("cannot be seen in this log:")
    for text in causes.unseen:
        print(f"  {text}")


def cause_text(item: Cause) -> str:
    """Return a cause with its size."""
    factor, unit = (1.0, item.unit) if item.unit else (100.0, "%")
    size = interval_text(factor * item.value, factor * item.half_width, ascii_only=True)
    return f"{item.label}: {size} {unit}"


def validation_line(check: Validation) -> str:
    """Return how well the second log is predicted."""
    ratios = ", ".join(f"{n} {r:.3f}" for n, r in zip(ACTUATORS, check.ratio, strict=True))
    return f"{check.log.name}: residual over that of its own fit: {ratios}"


def payload_lines(item: PayloadEstimate) -> list[str]:
    """Return the payload, with F_4 trusted and with a drift, and the common gain."""
    trusted = interval_text(item.mass, item.half_width, ascii_only=True)
    free = interval_text(item.free_mass, item.free_half_width, ascii_only=True)
    drift = interval_text(item.drift, item.drift_half_width, ascii_only=True)
    lines = [
        f"payload: {trusted} kg; if F_4 may have drifted between the logs {free} kg, "
        f"with a drift of {drift} N"
    ]
    if item.gain is not None:
        gain = interval_text(*item.gain, ascii_only=True)
        lines.append(f"common gain of the torques, from {item.known:g} kg: {gain}")
    return lines


def _print_masses(found: Findings) -> None:
    print()
    print("nearest masses that explain the log, given the design (+-: one standard deviation):")
    rows = [("", "design", "nearest", "")]
    for item in found.nearest.masses:
        unit = item.parameter.unit
        text = interval_text(item.value, item.deviation, ascii_only=True)
        rows.append(
            (item.parameter.path, f"{item.prior:.4g}", f"{text} {unit}" if item.told
             else f"{item.value:.4g} {unit}", "" if item.told else "as designed: not in the log")
        )  # fmt: skip
    print_table(rows, indent=2)
