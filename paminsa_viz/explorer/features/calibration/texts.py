"""The texts of the calibration: what poses will tell, what measured ones told, the lengths."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.features.calibration.actions import CALIBRATE, PROPOSE
from paminsa_viz.explorer.kit.robot_texts import UNITS, error_row
from paminsa_viz.explorer.kit.text import render, status
from paminsa_viz.explorer.state.monte_carlo import NAMES, SHOWN
from paminsa_viz.model.arrays import Array
from paminsa_viz.precision import LENGTHS, Calibration
from paminsa_viz.precision.calibration import KNOWN, describe
from paminsa_viz.precision.calibration_problem import COUNT
from paminsa_viz.precision.leg_lengths import deviation_array
from paminsa_viz.units import MM, DisplayUnit, display_unit, interval_text, number


def measured_html(frame: Frame) -> str:
    """Return which measured poses are open."""
    return render("calibration/measured.j2", measured=frame.state.calibration.measured)


def _length(value: float) -> str:
    """Return a length with two digits: in micrometers below a millimeter."""
    return display_unit("m:um" if value < KNOWN else "m").format(value, 2)


def proposal_status_html(frame: Frame) -> str:
    """Return what the proposed poses will tell, in a box."""
    state, plan = frame.state, PROPOSE.result(frame.state)
    if plan is None or PROPOSE.runs(state):
        return PROPOSE.text(state, "calibrate-proposed", "Choosing poses …", "No poses") or ""
    known = int((plan.half_widths < KNOWN).sum())
    shown, alone = len(plan.half_widths), int(plan.determined.sum())
    best, worst = _length(float(plan.half_widths[0])), _length(float(plan.half_widths[-1]))
    title = f"{known} of {COUNT} combinations of lengths would be known to {number(KNOWN * MM)} mm"
    return status(
        "calibrate-proposed", "ok" if known == shown else "warn", title,
        f"95 % intervals from ± {best} to ± {worst}; {alone} lengths by themselves, the others in "
        "sums",
        "" if known == shown else f"{shown - known} more show, but not so well: measure more "
        "poses, or with less uncertainty",
        PROPOSE.stale_text(state),
    )  # fmt: skip


def _length_rows(cell: Any) -> list[tuple[Any, str, list[tuple[str, bool]]]]:
    """Return a row for each length: itself, its unit, and of each leg a text and if it is known."""
    rows = []
    for place, length in enumerate(LENGTHS):
        unit = display_unit(length.unit)
        rows.append((length, unit.text, [cell(leg, place, unit) for leg in range(3)]))
    return rows


def plan_html(frame: Frame) -> str:
    """Return how well each length would be known."""
    plan = PROPOSE.result(frame.state)
    if plan is None:
        return ""

    def cell(leg: int, place: int, unit: DisplayUnit) -> tuple[str, bool]:
        size = float(plan.standard_deviations[leg, place])
        known = math.isfinite(size)
        return f"± {number(unit.factor * size, 2)}" if known else "in sums", known

    return render("calibration/plan.j2", rows=_length_rows(cell))


def poses_html(frame: Frame) -> str:
    """Return the proposed poses with their readings."""
    plan = PROPOSE.result(frame.state)
    if plan is None:
        return ""
    asked = plan.measurements
    factors = np.array([MM, MM, 180 / np.pi, MM, *[180 / np.pi] * 3, MM])
    return render(
        "calibration/poses.j2", rows=np.hstack([asked.poses[:, :4], asked.actuators]) * factors
    )


def _position(rms: Array) -> float:
    return float(np.linalg.norm(rms[[0, 1, 3]]))


def status_html(frame: Frame) -> str:
    """Return how the calibration went, in a box."""
    state, found = frame.state, CALIBRATE.result(frame.state)
    if found is None or CALIBRATE.runs(state):
        return CALIBRATE.text(state, "calibrate-status", "Calibrating …", "Not calibrated") or ""
    held = bool(found.after_held.poses)
    old, new = (found.before_held, found.after_held) if held else (found.before, found.after)
    kind = "held-back" if held else "fitted"
    change = f"{_length(_position(old.rms))} → {_length(_position(new.rms))}"
    lines = [f"Position of {new.poses} {kind} poses, RMS: {change}"]
    if held:
        change = f"{_length(_position(found.before.rms))} → {_length(_position(found.after.rms))}"
        lines.append(f"of the {found.after.poses} fitted ones: {change}")
    else:
        lines.append("No pose was held back: how well others are predicted is not checked")
    count = len(found.combinations)
    lines.append(
        f"{count} of {COUNT} combinations of lengths fitted, {COUNT - count} keep their value; "
        f"noise {_length(found.noise)}"
    )
    if not found.improved:
        title, level = "Not better than before, so there is nothing to use", "bad"
    elif held:
        title, level = "Calibrated, and checked on held-back poses", "ok"
    else:
        title, level = "Calibrated, but not checked", "warn"
    return status("calibrate-status", level, title, *lines, CALIBRATE.stale_text(state))


def errors_html(frame: Frame) -> str:
    """Return the errors of each coordinate, before and after."""
    found = CALIBRATE.result(frame.state)
    if found is None:
        return ""
    parts = [found.before.rms, found.after.rms]
    if found.after_held.poses:
        parts += [found.before_held.rms, found.after_held.rms]
    width = len(found.after.rms)
    rows = [error_row(NAMES[i], UNITS[i], *(one[i] for one in parts)) for i in SHOWN if i < width]
    return render("calibration/errors.j2", rows=rows, held=len(parts) > 2)


def lengths_html(frame: Frame) -> str:
    """Return the identified lengths with their standard deviations; what shows in sums is gray."""
    found = CALIBRATE.result(frame.state)
    if found is None:
        return ""
    values, sizes = deviation_array(found.design), found.standard_deviations

    def cell(leg: int, place: int, unit: DisplayUnit) -> tuple[str, bool]:
        value, size = (unit.factor * float(one[leg, place]) for one in (values, sizes))
        known = math.isfinite(size)
        return interval_text(value, size) if known else number(value, 2), known

    return render(
        "calibration/lengths.j2", rows=_length_rows(cell), sums=not found.determined.all()
    )


def combinations_html(frame: Frame) -> str:
    """Return the combinations of lengths that were fitted, best known first."""
    found = CALIBRATE.result(frame.state)
    if found is None:
        return ""
    return render("calibration/combinations.j2", rows=_combination_rows(found))


def _combination_rows(found: Calibration) -> list[tuple[str, str]]:
    return [
        (describe(one), interval_text(MM * one.value, MM * one.half_width))
        for one in found.combinations
    ]
