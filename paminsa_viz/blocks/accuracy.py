"""Accuracy: errors of the pose by the drives and by manufacture."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any, SupportsFloat

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.blocks.data import POSE_KEYS, POSITION_KEYS, record, robot
from paminsa_viz.blocks.kinds import Block, Cell, Note, Row, Table, heading, shown
from paminsa_viz.model.accuracy import NO_DEVIATIONS, DriveAccuracy
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.precision.drive_errors import DriveErrors
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
from paminsa_viz.precision.unequal_legs import ERRORS, ORDER
from paminsa_viz.studies.region import Region, RegionResults
from paminsa_viz.units import counted, format_value, percent

LEAST_SHARE = 0.005
"""Smallest share in a variance that is shown."""

MOST_LENGTHS = 4
"""Lengths that are named for a coordinate."""


def drive_blocks(here: DriveErrors, over: RegionResults) -> list[Block]:
    """Return the errors that the drives of a design leave at a pose and over a region."""
    errors = region_errors(over.field, over.design.accuracy, over.reached)
    wide = []
    for row in errors.rows:
        values = (*statistics(row.worst), statistics(row.linear)[0], statistics(row.rms)[0])
        wide.append(_row(row.name, row.unit, values))
    where = f"{counted(errors.poses, 'pose')} {over.region.words}"
    head = ("Errors from the drives", "Median", "95 %", "Largest", "Linear: median", "RMS: median")
    caption = f"Of the exact errors, the estimates and the RMS over {where}."
    blocks: list[Block] = [
        Note(_parts(over.design.accuracy)), *no_bound(here), drive_errors_table(here),
        Table(head, tuple(wide), caption),
    ]  # fmt: skip
    for bound, count in errors.unbounded.items():
        text = f"No bound at {count:,} of the {counted(errors.poses, 'pose')}: {bound.reason()}."
        blocks.append(Note(text, "warn"))
    return blocks


def drive_errors_table(here: DriveErrors) -> Table:
    """Return the errors that the drives leave at a pose."""
    rows = []
    for row in error_rows(here):
        values = (float(part[0]) for part in (row.worst, row.linear, row.rms))
        rows.append(_row(row.name, row.unit, values, _KINDS, _KEYS[row.name]))
    caption = (
        "Errors from the drives at the pose: the largest by exact kinematics, the linear estimate "
        "and the RMS."
    )
    return Table(("Errors from the drives", "Worst", "Linear", "RMS"), tuple(rows), caption)


_KINDS = ("error", "linear_error", "rms_error")
_KEYS = {"x": "x", "y": "y", "xy": "horizontal", "z": "z", "θ": "theta"}
"""How the keys of quantities begin that are errors from the drives, and how they end."""


def _row(
    name: str, unit: str, values: Iterable[SupportsFloat], kinds: Sequence[str] = (), key: str = ""
) -> Row:
    """Return a row of errors.

    Args:
        name: Of the coordinate.
        unit: SI unit, with the one that it is shown in.
        values: The errors.
        kinds: How the keys of their quantities begin; empty for what is none.
        key: How the keys end; empty for what is none.
    """
    begun = (*kinds, *[""] * 9)
    texts = (
        Cell(shown(value, unit), quantity=f"{kind}_{key}" if kind and key else "")
        for value, kind in zip(values, begun, strict=False)
    )
    return Row((heading("position" if name == "xy" else name, unit), *texts))


def no_bound(here: DriveErrors) -> list[Note]:
    """Return why the errors at a pose have no bound; nothing where they have one."""
    text = f"No bound at the pose: {here.reason()}. The linear estimate is no bound."
    return [] if here.ok else [Note(text, "bad")]


def drives_note(accuracy: DriveAccuracy) -> Note:
    """Return how far the drives may be off."""
    return Note(f"{'; '.join(_within(accuracy).values())}.")


def _within(accuracy: DriveAccuracy) -> dict[str, str]:
    """Return how far the rotary drives and the linear one may be off."""
    ends = (("rotary", "M1 to M3", 0, "rad"), ("linear", "M4", 3, "m:um"))
    return {
        kind: f"{name} within ±{format_value(accuracy.half_widths[i], unit, 3)}"
        for kind, name, i, unit in ends
    }


def _parts(accuracy: DriveAccuracy) -> str:
    """Return what the drives' errors are made of."""
    texts = []
    for kind, within in _within(accuracy).items():
        unit = "rad" if kind == "rotary" else "m:um"
        count, backlash, control = (
            format_value(getattr(accuracy, f"{part}_{kind}"), unit, 3)
            for part in ("resolution", "backlash", "control")
        )
        texts.append(
            f"{within}: half a count of {count}, half a backlash of {backlash}, controller "
            f"±{control}"
        )
    return "; ".join(texts) + "."


def manufacture_blocks(
    design: Design, pose: ArrayLike, robots: MonteCarlo | None = None
) -> list[Block]:
    """Return the errors by manufacture at a pose (4,), with those of robots drawn at random."""
    found = tolerance_errors(design, pose)
    own: list[Block] = [] if design.deviations == NO_DEVIATIONS else [own_legs(design, pose)]
    drawn = [] if robots is None else robots_blocks(robots)
    return [*tolerance_blocks(found), *drawn, *own]


def tolerance_blocks(found: ToleranceErrors) -> list[Table | Note]:
    """Return the errors by tolerances and clearances at a pose, or that there are none."""
    if not np.isfinite(found.worst).all():
        text = "the pose is singular, or the loops of the legs do not close"
        return [Note(f"Errors by manufacture have no value: {text}.", "warn")]
    kinds = ("tolerance", "", "rms_tolerance")
    rows = []
    for index in ORDER:
        values = (found.worst[index], found.clearance[index], found.rms[index])
        name, unit, key = ERRORS[index]
        row = _row(name, unit, values, kinds, key)
        rows.append(replace(row, cells=(*row.cells, _dominating(found, index))))
    plane = (found.horizontal, np.nan, found.rms_horizontal)
    rows.insert(2, _row("position", "m:um", plane, kinds, "horizontal"))
    tilt = (found.tilt, np.nan, found.rms_tilt)
    rows.append(_row("tilt", "rad:arcsec", tilt, kinds, "tilt"))
    caption = (
        "Errors by the tolerances of the lengths and the clearances at the pose: the largest, the "
        "part of the clearances in it, the RMS, and which lengths the variance comes from."
    )
    head = ("Errors from tolerances", "Worst", "Clearances", "RMS", "Lengths")
    text = "To first order; the drives are where the lengths of the design ask them to be."
    return [Table(head, tuple(rows), caption), Note(text, "muted")]


def shares_table(found: ToleranceErrors, index: int) -> Table:
    """Return the shares of the lengths in the variance of one of `ERRORS`, the largest first."""
    share = found.shares[index]
    rows = tuple(
        Row(
            (LENGTHS[i].symbol, Cell(percent(share[i], 1), share=float(share[i]))),
            hint=LENGTHS[i].label,
        )
        for i in np.argsort(-share, kind="stable")
        if share[i] >= LEAST_SHARE
    )
    return Table(
        ("Length", "Share"),
        rows,
        f"Shares in the variance of {ERRORS[index][0]}, all legs together.",
    )


def _dominating(found: ToleranceErrors, index: int) -> str:
    """Return the lengths with the largest shares in the variance of a coordinate."""
    return ", ".join(" ".join(row.cells) for row in shares_table(found, index).rows[:MOST_LENGTHS])


def robots_blocks(robots: MonteCarlo) -> list[Table | Note]:
    """Return the errors of robots that were drawn at random."""
    half, most, nearly_all = (robots.quantile(share) for share in (0.5, 0.95, 0.997))
    rows = []
    for index in ORDER:
        name, unit, _ = ERRORS[index]
        values = (part[index] for part in (half, most, nearly_all, robots.rms))
        rows.append(_row(name, unit, values))
    count, lost = len(robots.errors), int((~robots.ok).sum())
    head = (f"{counted(count, 'robot')}, seed {robots.seed}", "50 %", "95 %", "99.7 %", "RMS")
    caption = "Errors of robots drawn at random within the tolerances."
    blocks: list[Table | Note] = [
        Table(head, tuple(rows), caption),
        Note("Errors that this share of the robots does not exceed.", "muted"),
    ]
    if lost:
        blocks.append(Note(f"{lost:,} of {counted(count, 'robot')} cannot be assembled.", "bad"))
    return blocks


def own_legs(design: Design, pose: ArrayLike) -> Note:
    """Return where the design's own legs put the platform, if they are not alike."""
    if design.deviations == NO_DEVIATIONS:
        return Note("All legs have the lengths of the geometry: the platform does not tilt.")
    found = manufactured_pose(design, pose)
    if not found.ok:
        return Note(f"The design’s own legs have no position: {found.reason()}.", "bad")
    off = [*(found.pose - np.asarray(pose)), *found.tilt]
    texts = (f"{ERRORS[i][0]} {format_value(float(off[i]), ERRORS[i][1], 3)}" for i in ORDER)
    return Note(
        "With drives set for equal legs, the design’s own put the platform off by "
        f"{', '.join(texts)}."
    )


def accuracy_data(
    design: Design, here: DriveErrors, region: Region, over: RegionErrors
) -> dict[str, Any]:
    """Return the errors by the drives, at a pose and over a region, for JSON, in SI units."""
    names = ("median", "p95", "largest")
    return {
        **robot(design),
        "half_widths": dict(zip(POSITION_KEYS, design.accuracy.half_widths, strict=True)),
        "deviations": dict(zip(POSITION_KEYS, design.accuracy.deviations, strict=True)),
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

    def named(values: Array) -> dict[str, float]:
        return dict(zip(POSE_KEYS, values, strict=True))

    data: dict[str, Any] = {
        "worst": named(errors.worst),
        "clearance": named(errors.clearance),
        "rms": named(errors.rms),
        "worst_horizontal_m": errors.horizontal,
        "worst_tilt_rad": errors.tilt,
        "shares": {
            key: {length.name: share for length, share in zip(LENGTHS, row, strict=True)}
            for key, row in zip(POSE_KEYS, errors.shares, strict=True)
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
