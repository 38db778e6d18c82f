"""Calibration: errors before and after, fitted combinations of lengths, and the deviations."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from paminsa_viz.blocks.data import POSE_KEYS, record, robot
from paminsa_viz.blocks.kinds import Block, Cell, Note, Row, Table, heading, rows, shown
from paminsa_viz.model.accuracy import LEG_NAMES
from paminsa_viz.precision.calibration import Calibration, describe, known_within
from paminsa_viz.precision.calibration_plan import CalibrationPlan
from paminsa_viz.precision.calibration_problem import COUNT
from paminsa_viz.precision.leg_lengths import LENGTHS, deviation_array
from paminsa_viz.precision.measurements import PredictionErrors
from paminsa_viz.precision.unequal_legs import ERRORS, ORDER
from paminsa_viz.units import MM, counted, display_unit, fixed, format_value, interval_text, number

MOST_COMBINATIONS = 10
"""Combinations that are listed: the best and the worst known ones."""


def calibration_blocks(found: Calibration, most: int | None = MOST_COMBINATIONS) -> list[Block]:
    """Return errors, rank, combinations and deviations.

    Args:
        found: What came of the measured poses.
        most: How many combinations are listed; None for all.
    """
    held = found.after_held.poses
    back = f", {held} held back" if held else ""
    poses = counted(found.after.poses, "pose")
    opening = f"{poses} of {len(found.after.rms)} coordinates fitted{back}."
    return [
        Note(opening), verdict(found), errors_table(found), Note(_rank(found)),
        combinations_table(found, most), *deviation_blocks(found),
    ]  # fmt: skip


def verdict(found: Calibration) -> Note:
    """Return whether the calibration is of use."""
    if not found.improved:
        return Note("Not better than before: there is nothing to use.", "bad")
    if found.after_held.poses:
        return Note("Held-back poses are predicted better than before.", "ok")
    return Note("No pose was held back: how well others are predicted is not checked.", "warn")


def errors_table(found: Calibration) -> Table:
    """Return the errors of each coordinate, before and after, of fitted and held-back poses."""
    sets = [("fitted", found.before, found.after)]
    if found.after_held.poses:
        sets.append(("held back", found.before_held, found.after_held))
    head = [f"{name}: {kind}" for name, *_ in sets for kind in ("before", "after", "largest")]
    found_rows = []
    for place in (place for place in ORDER if place < len(found.after.rms)):
        name, unit, _ = ERRORS[place]
        cells = (
            shown(values[place], unit)
            for _, before, after in sets
            for values in (before.rms, after.rms, after.largest)
        )
        found_rows.append(Row((heading(name, unit), *cells)))
    caption = "RMS of measured poses less those that are predicted, and the largest difference."
    return Table(("RMS", *head), tuple(found_rows), caption)


def _rank(found: Calibration) -> str:
    values, rank = found.singular_values, found.rank
    seen = counted(rank, f"of {COUNT} combinations shows", f"of {COUNT} combinations show")
    best, worst = number(values[0], 2), number(values[rank - 1], 2)
    text = f"{seen} with equal legs: singular values {best} to {worst}"
    if rank < len(values):
        text += f", then {number(values[rank], 2)}"
    return f"{text}. {fitted_text(found)}"


def fitted_text(found: Calibration) -> str:
    """Return how many combinations of lengths were fitted, and the noise that is left."""
    count = len(found.combinations)
    known = counted(
        count, f"of {COUNT} combinations of lengths is", f"of {COUNT} combinations of lengths are"
    )
    most = format_value(known_within(found.start.geometry), "m")
    left = counted(COUNT - count, "keeps its value", "keep their value")
    return (
        f"{known} known to {most} and fitted, {left}; noise {format_value(found.noise, 'm:um', 3)}."
    )


def combinations_table(found: Calibration, most: int | None = None) -> Table:
    """Return the combinations that were fitted: all, or the best and the worst known ones."""
    chosen = list(enumerate(found.combinations, 1))
    if most is not None and len(chosen) > most:
        chosen = chosen[: most // 2] + chosen[-(most // 2) :]
    cells = (
        (
            str(place), describe(item).replace("-", "−"),
            interval_text(MM * item.value, MM * item.half_width),
        )
        for place, item in chosen
    )  # fmt: skip
    caption = "Combinations of lengths, best known first, with their 95 % intervals."
    head = ("", "Combination, its leading lengths (leg)", "Value [mm]")
    return Table(head, rows(*cells), caption, words=2)


def deviation_blocks(found: Calibration) -> list[Table | Note]:
    """Return the deviations of the legs, actual minus nominal."""
    values, sizes = deviation_array(found.design), found.standard_deviations

    def cell(leg: int, place: int) -> Cell:
        factor = display_unit(LENGTHS[place].unit).factor
        value, size = (factor * float(one[leg, place]) for one in (values, sizes))
        if math.isfinite(size):
            return Cell(interval_text(value, size))
        return Cell(number(value, 2, padded=True), kind="muted")

    text = "Actual minus nominal; ± is one standard deviation."
    if not found.determined.all():
        text += (
            " Without ±: known in sums with others alone, one of many sets that predict the same "
            "poses."
        )
    return [_of_lengths("Deviation", cell, "Deviations of the legs."), Note(text, "muted")]


def _of_lengths(what: str, cell: Callable[[int, int], Cell], caption: str) -> Table:
    """Return a table of all lengths of the legs; ``cell`` is called with leg and place."""
    found = tuple(
        Row((heading(one.symbol, one.unit), one.label, *(cell(leg, place) for leg in range(3))))
        for place, one in enumerate(LENGTHS)
    )
    return Table((what, "Length", "Leg 1", "Leg 2", "Leg 3"), found, caption, words=2)


def plan_blocks(plan: CalibrationPlan) -> list[Table | Note]:
    """Return how well each length would be known by proposed poses."""

    def cell(leg: int, place: int) -> Cell:
        size = float(plan.standard_deviations[leg, place])
        if not math.isfinite(size):
            return Cell("in sums", kind="muted")
        return Cell(f"± {number(display_unit(LENGTHS[place].unit).factor * size, 2, padded=True)}")

    text = (
        "± is one standard deviation. Of lengths in sums, the poses show combinations with others: "
        "enough to predict poses. Legs that differ show more."
    )
    table = _of_lengths("Length, by itself", cell, "How well the poses tell each length.")
    return [table, Note(text, "muted")]


def poses_table(plan: CalibrationPlan) -> Table:
    """Return proposed poses with the readings of their actuators."""
    units = {"x": "m", "y": "m", "θ": "rad", "z": "m", "θ₁": "rad", "θ₂": "rad", "θ₃": "rad",
             "Z": "m"}  # fmt: skip
    asked = plan.measurements
    cells = (
        (
            str(place),
            *(
                fixed(value * display_unit(unit).factor, 1 if unit == "m" else 2)
                for value, unit in zip((*pose[:4], *readings), units.values(), strict=True)
            ),
        )
        for place, (pose, readings) in enumerate(zip(asked.poses, asked.actuators, strict=True), 1)
    )
    return Table(("", *units), rows(*cells), "Poses to measure, in mm and degrees.", literal=True)


def calibration_data(found: Calibration, source: str) -> dict[str, Any]:
    """Return everything as data for JSON, in SI units."""
    names = [f"{leg}.{length.name}_{length.unit}" for leg in LEG_NAMES for length in LENGTHS]

    def errors(values: PredictionErrors) -> dict[str, Any]:
        sizes = {kind: getattr(values, kind) for kind in ("rms", "largest")}
        return {"poses": values.poses} | {
            kind: dict(zip(POSE_KEYS, each, strict=False)) for kind, each in sizes.items()
        }

    return {
        **robot(found.start),
        "log": source,
        **record(found, "improved", "rank", "singular_values", "noise_m"),
        "fitted": {"before": errors(found.before), "after": errors(found.after)},
        "held_back": {"before": errors(found.before_held), "after": errors(found.after_held)},
        "combinations": [
            {"leading": describe(item)}
            | record(item, "singular_value", "value_m", "half_width_m")
            | {
                "weights": {
                    name: weight
                    for name, weight in zip(names, item.weights.ravel(), strict=True)
                    if np.abs(weight) > 1e-6
                }
            }
            for item in found.combinations
        ],
        "deviations": dict(zip(names, deviation_array(found.design).ravel(), strict=True)),
    }
