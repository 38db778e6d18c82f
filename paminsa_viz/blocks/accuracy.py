"""Accuracy: errors of the pose by the drives and by manufacture."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.blocks.data import record
from paminsa_viz.blocks.kinds import Block, Note, Row, Table
from paminsa_viz.model.accuracy import NO_DEVIATIONS, DriveAccuracy
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.drive import ACTUATORS
from paminsa_viz.precision.drive_errors import Bound, DriveErrors
from paminsa_viz.precision.error_rows import (
    STATISTICS_OF,
    RegionErrors,
    error_rows,
    region_errors,
    statistics,
)
from paminsa_viz.precision.leg_lengths import LENGTHS
from paminsa_viz.precision.manufacture import (
    MonteCarlo,
    ToleranceErrors,
    manufactured_pose,
    tolerance_errors,
)
from paminsa_viz.precision.unequal_legs import SIX_COORDINATES
from paminsa_viz.studies.region import Region, RegionResults
from paminsa_viz.units import format_value

ERROR_UNITS = (
    ("x", "m:um"), ("y", "m:um"), ("θ", "rad:arcsec"), ("z", "m:um"),
    ("tilt about x", "rad:arcsec"), ("tilt about y", "rad:arcsec"),
)  # fmt: skip
"""Names and units of `unequal_legs.SIX_COORDINATES`."""

MOST_LENGTHS = 4
"""Lengths that are named for a coordinate."""


def drive_blocks(here: DriveErrors, over: RegionResults) -> list[Block]:
    """Return the errors that the drives of a design leave at a pose and over a region."""
    region = over.region
    errors = region_errors(over.field, over.design.accuracy, over.reached)
    at, wide = [], []
    for row, rows in zip(error_rows(here), errors.rows, strict=True):
        name = "position" if row.name == "xy" else row.name
        known = (row.worst[0], row.linear[0], row.rms[0])
        spread = (*statistics(rows.worst), statistics(rows.linear)[0], statistics(rows.rms)[0])
        for values, found in ((known, at), (spread, wide)):
            texts = (format_value(float(value), row.unit, 3) for value in values)
            found.append(Row((name, *texts)))
    where = (
        f"{errors.poses} poses within {format_value(region.radius, 'm')} of the axis at θ "
        f"{', '.join(format_value(angle, 'rad') for angle in region.theta)} and z "
        f"{', '.join(format_value(z, 'm') for z in region.z)}"
    )
    blocks: list[Block] = [
        Note(_parts(over.design.accuracy)),
        Table(
            ("Error of", "Worst", "Linear", "RMS"), tuple(at),
            "Errors from the drives at the pose: the largest by exact kinematics, the linear "
            "estimate and the RMS.",
        ),
        Table(
            ("Error of", "Median", "95 %", "Largest", "Linear: median", "RMS: median"), tuple(wide),
            f"Of the exact errors, the estimates and the RMS over {where}.",
        ),
    ]  # fmt: skip
    return blocks + [
        Note(text, "warn") for text in _unbounded(here, errors.unbounded, errors.poses)
    ]


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
        texts.append(f"No bound at the pose: {here.reason()}. The linear estimate is no bound.")
    for bound, count in counts.items():
        texts.append(f"No bound at {count} of the {poses} poses: {bound.reason()}.")
    return texts


def manufacture_blocks(
    design: Design, pose: ArrayLike, robots: MonteCarlo | None = None
) -> list[Block]:
    """Return the errors by manufacture at a pose (4,), with those of robots drawn at random."""
    found = tolerance_errors(design, pose)
    own = [] if design.deviations == NO_DEVIATIONS else [Note(_own_legs(design, pose))]
    if not np.isfinite(found.worst).all():
        text = "it is singular, or the loops of the legs do not close"
        return [Note(f"Errors by manufacture have no value at this pose: {text}.", "warn"), *own]
    columns = {"Worst": found.worst, "Clearances": found.clearance, "RMS": found.rms}
    drawn = ""
    if robots is not None:
        columns |= {"RMS of robots": robots.rms, "95 % below": robots.quantile(0.95)}
        lost = int((~robots.ok).sum())
        drawn = f" {lost} of {len(robots.ok)} robots cannot be assembled." if lost else ""
    rows = []
    for index, (name, unit) in enumerate(ERROR_UNITS):
        cells = (format_value(float(values[index]), unit) for values in columns.values())
        rows.append(Row((name, *cells, _dominating(found, index))))
    caption = (
        "Errors by the tolerances of the lengths and the clearances at the pose, to first "
        "order: the largest, the part of the clearances in it, the RMS, and which lengths the "
        "variance comes from."
    )
    largest = (
        f"At most {format_value(float(found.horizontal), 'm:um')} in the plane, and a tilt of "
        f"{format_value(float(found.tilt), 'rad:arcsec')}.{drawn}"
    )
    return [Table(("Error of", *columns, "Lengths"), tuple(rows), caption), Note(largest), *own]


def _dominating(found: ToleranceErrors, index: int) -> str:
    """Return the lengths with the largest shares in the variance of a coordinate."""
    share = found.shares[index]
    order = [i for i in np.argsort(-share)[:MOST_LENGTHS] if share[i] >= 0.01]
    return ", ".join(f"{LENGTHS[i].symbol} {100 * share[i]:.0f} %" for i in order)


def _own_legs(design: Design, pose: ArrayLike) -> str:
    """Return where the design's own legs put the platform."""
    found = manufactured_pose(design, pose)
    if not found.ok:
        return f"The design's own legs have no position: {found.reason()}."
    off = [*(found.pose - np.asarray(pose)), *found.tilt]
    texts = (
        f"{name} {format_value(float(value), unit, 3)}"
        for (name, unit), value in zip(ERROR_UNITS, off, strict=True)
    )
    return (
        "With drives set for equal legs, the design's own put the platform off by "
        f"{', '.join(texts)}."
    )


def accuracy_data(
    design: Design, here: DriveErrors, region: Region, over: RegionErrors
) -> dict[str, Any]:
    """Return the errors by the drives, at a pose and over a region, for JSON, in SI units."""
    names = ("median", "p95", "largest")
    return {
        "design": design.name,
        "half_widths": dict(zip(ACTUATORS, design.accuracy.half_widths, strict=True)),
        "deviations": dict(zip(ACTUATORS, design.accuracy.deviations, strict=True)),
        "pose": here.pose,
        "bounded": here.ok,
        "reason": here.reason(),
        "errors": {
            _key(row.name): {kind: getattr(row, kind)[0] for kind in STATISTICS_OF}
            for row in error_rows(here)
        },
        "region": {
            **record(region, "radius_m", "theta_rad", "z_m"),
            "poses": over.poses,
            "unbounded": {bound.word: count for bound, count in over.unbounded.items()},
            "errors": {
                _key(row.name): {
                    kind: dict(zip(names, statistics(getattr(row, kind)), strict=True))
                    for kind in STATISTICS_OF
                }
                for row in over.rows
            },
        },
    }  # fmt: skip


def _key(name: str) -> str:
    """Return the name of a row for JSON, with its SI unit."""
    return {"xy": "horizontal_m", "θ": "theta_rad"}.get(name, f"{name}_m")


def manufacture_data(
    design: Design, pose: tuple[float, ...], robots: MonteCarlo | None
) -> dict[str, Any]:
    """Return the errors by manufacture at a pose, and those of robots drawn at random."""
    errors, actual = tolerance_errors(design, pose), manufactured_pose(design, pose)
    keys = [f"{name}_{'m' if name in 'xyz' else 'rad'}" for name in SIX_COORDINATES]

    def named(values: Array) -> dict[str, float]:
        return dict(zip(keys, values, strict=True))

    data: dict[str, Any] = {
        "worst": named(errors.worst),
        "clearance": named(errors.clearance),
        "rms": named(errors.rms),
        "worst_horizontal_m": errors.horizontal,
        "worst_tilt_rad": errors.tilt,
        "shares": {
            key: {length.name: share for length, share in zip(LENGTHS, row, strict=True)}
            for key, row in zip(keys, errors.shares, strict=True)
        },
        "actual": named(actual.coordinates),
        "actual_reason": actual.reason(),
    }
    if robots:
        data["robots"] = {
            "count": len(robots.errors), "seed": robots.seed, "solved": robots.solved,
            "rms": named(robots.rms), "p95": named(robots.quantile(0.95)),
        }  # fmt: skip
    return data
