"""The texts of the calibration: what poses will tell, what measured ones told, the lengths."""

from __future__ import annotations

import numpy as np

from paminsa_viz.blocks.calibration import (
    combinations_table,
    deviation_blocks,
    errors_table,
    fitted_text,
    plan_blocks,
    poses_table,
    verdict,
)
from paminsa_viz.blocks.kinds import Note, Table
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.features.calibration.actions import CALIBRATE, PROPOSE
from paminsa_viz.explorer.kit.text import blocks_html, render, status
from paminsa_viz.model.arrays import Array
from paminsa_viz.precision.calibration import known_within
from paminsa_viz.precision.calibration_problem import COUNT
from paminsa_viz.units import MM, counted, display_unit, format_value


def measured_html(frame: Frame) -> str:
    """Return which measured poses are open."""
    return render("calibration/measured.j2", measured=frame.state.calibration.measured)


def _length(value: float) -> str:
    """Return a length with two digits: in micrometers below a millimeter."""
    return display_unit("m:um" if value < 1 / MM else "m").format(value, 2)


def proposal_status_html(frame: Frame) -> str:
    """Return what the proposed poses will tell, in a box."""
    state, plan = frame.state, PROPOSE.result(frame.state)
    if plan is None or PROPOSE.runs(state):
        return PROPOSE.text(state, "calibrate-proposed", "Choosing poses …", "No poses")
    job, _ = PROPOSE.required(state, "", "")
    most = known_within(job.design.geometry)
    known = int((plan.half_widths < most).sum())
    shown, alone = len(plan.half_widths), int(plan.determined.sum())
    best, worst = _length(float(plan.half_widths[0])), _length(float(plan.half_widths[-1]))
    title = (
        f"{known} of {COUNT} combinations of lengths would be known to {format_value(most, 'm')}"
    )
    return status(
        "calibrate-proposed", "ok" if known == shown else "warn", title,
        f"95 % intervals from ± {best} to ± {worst}; "
        f"{counted(alone, 'length by itself', 'lengths by themselves')}, the others in sums",
        "" if known == shown else f"{shown - known} more show, but not so well: measure more "
        "poses, or with less uncertainty",
        PROPOSE.stale_text(state),
    )  # fmt: skip


def plan_html(frame: Frame) -> str:
    """Return how well each length would be known."""
    plan = PROPOSE.result(frame.state)
    return "" if plan is None else _lengths_html("calibrate-plan", plan_blocks(plan))


def _lengths_html(testid: str, blocks: list[Table | Note], *more: Note) -> str:
    """Return a table of lengths, whose names are tooltips, and what is said of it."""
    narrow = (one.columns(0, 2, 3, 4, hint=1) if isinstance(one, Table) else one for one in blocks)
    return blocks_html(testid, *narrow, *more, look="pv-identify")


def poses_html(frame: Frame) -> str:
    """Return the proposed poses with their readings."""
    plan = PROPOSE.result(frame.state)
    if plan is None:
        return ""
    text = (
        "mm and degrees. Drive to the readings θ₁ to Z, and put what is measured in the place of "
        "x, y, θ, z and of the tilt if it is measured; the file has all digits."
    )
    return blocks_html(
        "calibrate-poses", poses_table(plan), Note(text, "muted"), look="pv-identify"
    )


def _position(rms: Array) -> float:
    return float(np.linalg.norm(rms[[0, 1, 3]]))


def status_html(frame: Frame) -> str:
    """Return how the calibration went, in a box."""
    state, found = frame.state, CALIBRATE.result(frame.state)
    if found is None or CALIBRATE.runs(state):
        return CALIBRATE.text(state, "calibrate-status", "Calibrating …", "Not calibrated")
    held = bool(found.after_held.poses)
    old, new = (found.before_held, found.after_held) if held else (found.before, found.after)
    kind = "held-back" if held else "fitted"
    change = f"{_length(_position(old.rms))} → {_length(_position(new.rms))}"
    lines = [f"Position of {counted(new.poses, f'{kind} pose')}, RMS: {change}"]
    if held:
        change = f"{_length(_position(found.before.rms))} → {_length(_position(found.after.rms))}"
        lines.append(f"of the {found.after.poses} fitted ones: {change}")
    lines.append(fitted_text(found).removesuffix("."))
    title = verdict(found)
    return status(
        "calibrate-status",
        title.kind,
        title.text.removesuffix("."),
        *lines,
        CALIBRATE.stale_text(state),
    )


def errors_html(frame: Frame) -> str:
    """Return the errors of each coordinate, before and after."""
    found = CALIBRATE.result(frame.state)
    if found is None:
        return ""
    table = errors_table(found)
    narrow = table.columns(*(place for place in range(len(table.head)) if place % 3 or not place))
    return blocks_html("calibrate-errors", narrow, look="pv-wrapped")


def lengths_html(frame: Frame) -> str:
    """Return the identified lengths with their standard deviations; what shows in sums is gray."""
    found = CALIBRATE.result(frame.state)
    if found is None:
        return ""
    text = (
        "“Use as design” takes them into the design, a table of its file for each leg. Errors by "
        "manufacture and the maps “deviation” then follow them; torques, reach and the scene stay "
        "those of equal legs."
    )
    return _lengths_html("calibrate-lengths", deviation_blocks(found), Note(text))


def combinations_html(frame: Frame) -> str:
    """Return the combinations of lengths that were fitted, best known first."""
    found = CALIBRATE.result(frame.state)
    if found is None:
        return ""
    table = combinations_table(found).columns(1, 2)
    text = "Angles count as lengths, with R_b or R_pl."
    return blocks_html("calibrate-combinations", table, Note(text, "muted"), look="pv-identify")
