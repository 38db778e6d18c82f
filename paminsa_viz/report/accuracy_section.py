"""Accuracy: errors of the pose by the drives and by manufacture."""

from __future__ import annotations

import numpy as np

from paminsa_viz.model.accuracy import DriveAccuracy
from paminsa_viz.model.leg_deviations import NO_DEVIATIONS
from paminsa_viz.precision.drive_errors import Bound, DriveErrors, drive_errors
from paminsa_viz.precision.leg_lengths import LENGTHS
from paminsa_viz.precision.manufacture import ToleranceErrors, manufactured_pose, tolerance_errors
from paminsa_viz.precision.unequal_legs import Closure
from paminsa_viz.report.blocks import Block, Note, Row, Section, Table
from paminsa_viz.report.request import ReportRequest
from paminsa_viz.studies.drive_accuracy import error_rows, region_errors, statistics
from paminsa_viz.studies.metrics import RegionResults, default_region
from paminsa_viz.units import format_value

COORDINATES = (
    ("x", "m:um"), ("y", "m:um"), ("θ", "rad:arcsec"), ("z", "m:um"),
    ("tilt about x", "rad:arcsec"), ("tilt about y", "rad:arcsec"),
)  # fmt: skip
"""Names and units of `unequal_legs.COORDINATES`."""

MOST_LENGTHS = 4
"""Lengths that are named for a coordinate."""


def accuracy_section(request: ReportRequest) -> Section:
    """Return the section."""
    return Section("accuracy", "Accuracy", (*_drives(request), *_manufacture(request)))


def _drives(request: ReportRequest) -> list[Block]:
    design = request.design
    here = drive_errors(design.geometry, design.accuracy, request.pose)
    region = default_region(design)
    over = region_errors(RegionResults(design, region))
    rows = []
    for row, wide in zip(error_rows(here), over.rows, strict=True):
        values = (row.worst[0], row.linear[0], row.rms[0], *statistics(wide.worst))
        cells = (format_value(float(value), row.unit, 3) for value in values)
        rows.append(Row(("in the plane" if row.name == "xy" else row.name, *cells)))
    caption = (
        "Errors from the drives: at the report's pose the largest by exact kinematics, the linear "
        "estimate and the RMS; and median, 95 % and largest of the exact one over the poses "
        f"within {format_value(region.radius, 'm')} of the axis at θ "
        f"{', '.join(format_value(angle, 'rad') for angle in region.theta)}."
    )
    head = ("Error of", "Worst", "Linear", "RMS", "Median", "95 %", "Largest")
    blocks: list[Block] = [Note(_parts(design.accuracy)), Table(head, tuple(rows), caption)]
    blocks += [Note(text, "warn") for text in _unbounded(here, over.unbounded, over.poses)]
    return blocks


def _parts(accuracy: DriveAccuracy) -> str:
    """Return what the drives' errors are made of."""
    texts = []
    for name, kind, unit in (("M1 to M3", "rotary", "rad"), ("M4", "linear", "m:um")):
        half = accuracy.half_widths[0 if kind == "rotary" else 3]
        count, backlash, control = (
            format_value(getattr(accuracy, f"{part}_{kind}"), unit, 3)
            for part in ("resolution", "backlash", "control")
        )
        texts.append(
            f"{name} within ±{format_value(half, unit, 3)}: half a count of {count}, half a "
            f"backlash of {backlash}, controller ±{control}"
        )
    return "; ".join(texts) + "."


def _unbounded(here: DriveErrors, counts: dict[Bound, int], poses: int) -> list[str]:
    """Return where the errors have no bound, and why."""
    texts = []
    if not here.ok:
        reason = Bound(int(here.bound)).reason(int(here.leg))
        texts.append(f"No bound at the report's pose: {reason}. The linear estimate is none.")
    for bound, count in counts.items():
        texts.append(f"No bound at {count} of the {poses} poses: {bound.reason()}.")
    return texts


def _manufacture(request: ReportRequest) -> list[Block]:
    found = tolerance_errors(request.design, request.pose)
    own = [] if request.design.deviations == NO_DEVIATIONS else [Note(_own_legs(request))]
    if not np.isfinite(found.worst).all():
        text = "it is singular, or the loops of the legs do not close"
        return [Note(f"Errors by manufacture have no value at this pose: {text}.", "warn"), *own]
    rows = []
    for index, (name, unit) in enumerate(COORDINATES):
        parts = (found.worst[index], found.clearance[index], found.rms[index])
        cells = (format_value(float(value), unit, 3) for value in parts)
        rows.append(Row((name, *cells, _dominating(found, index))))
    caption = (
        "Errors by the tolerances of the lengths and the clearances at the report's pose, to first "
        "order: the largest, the part of the clearances in it, the RMS, and which lengths the "
        "variance comes from."
    )
    head = ("Error of", "Worst", "Clearances", "RMS", "Lengths")
    return [Table(head, tuple(rows), caption), *own]


def _dominating(found: ToleranceErrors, index: int) -> str:
    """Return the lengths with the largest shares in the variance of a coordinate."""
    share = found.shares[index]
    order = [i for i in np.argsort(-share)[:MOST_LENGTHS] if share[i] >= 0.01]
    return ", ".join(f"{LENGTHS[i].symbol} {100 * share[i]:.0f} %" for i in order)


def _own_legs(request: ReportRequest) -> str:
    """Return where the design's own legs put the platform."""
    found = manufactured_pose(request.design, request.pose)
    if not found.ok:
        return f"The design's own legs have no position: {Closure(int(found.closure)).reason}."
    off = [*(found.pose - np.array(request.pose)), *found.tilt]
    texts = (
        f"{name} {format_value(float(value), unit, 3)}"
        for (name, unit), value in zip(COORDINATES, off, strict=True)
    )
    return (
        "With drives set for equal legs, the design's own put the platform off by "
        f"{', '.join(texts)}."
    )
