"""Calibration: errors before and after, fitted combinations of lengths, and the deviations."""

from __future__ import annotations

from typing import Any

import numpy as np

from paminsa_viz.blocks.data import record
from paminsa_viz.blocks.kinds import Block, Note, Row, Table, rows
from paminsa_viz.model.accuracy import LEG_NAMES
from paminsa_viz.precision.calibration import KNOWN, Calibration, describe
from paminsa_viz.precision.calibration_problem import COUNT
from paminsa_viz.precision.leg_lengths import LENGTHS, deviation_array
from paminsa_viz.precision.measurements import PredictionErrors
from paminsa_viz.precision.unequal_legs import SIX_COORDINATES
from paminsa_viz.units import MM, format_value, interval_text, number

MOST_COMBINATIONS = 10
"""Combinations that are listed: the best and the worst known ones."""

ERROR_UNITS = tuple("m:um" if name in "xyz" else "rad:arcsec" for name in SIX_COORDINATES)
"""Units of the errors of `SIX_COORDINATES`."""


def calibration_blocks(found: Calibration, most: int | None = MOST_COMBINATIONS) -> list[Block]:
    """Return errors, rank, combinations and deviations.

    Args:
        found: What came of the measured poses.
        most: How many combinations are listed; None for all.
    """
    held = found.after_held.poses
    back = f", {held} held back" if held else ""
    opening = f"{found.after.poses} poses of {len(found.after.rms)} coordinates fitted{back}."
    return [
        Note(opening), _verdict(found), _errors(found), Note(_rank(found)),
        _combinations(found, most), _deviations(found),
    ]  # fmt: skip


def _verdict(found: Calibration) -> Note:
    if not found.improved:
        return Note("Not better than before: there is nothing to use.", "bad")
    if found.after_held.poses:
        return Note("Held-back poses are predicted better than before.", "ok")
    return Note("No pose was held back: how well others are predicted is not checked.", "warn")


def _errors(found: Calibration) -> Table:
    """Return the errors of each coordinate, before and after, of fitted and held-back poses."""
    sets = [("fitted", found.before, found.after)]
    if found.after_held.poses:
        sets.append(("held back", found.before_held, found.after_held))
    head = [f"{name}: {kind}" for name, *_ in sets for kind in ("RMS before", "RMS", "largest")]
    cells = (
        (
            SIX_COORDINATES[place],
            *(
                format_value(float(values[place]), ERROR_UNITS[place])
                for _, before, after in sets
                for values in (before.rms, after.rms, after.largest)
            ),
        )
        for place in range(len(found.after.rms))
    )
    return Table(("Error of", *head), rows(*cells), "Measured poses less those that are predicted.")


def _rank(found: Calibration) -> str:
    values, rank, count = found.singular_values, found.rank, len(found.combinations)
    text = (
        f"{rank} of {COUNT} combinations show with equal legs: singular values "
        f"{number(values[0], 2)} to {number(values[rank - 1], 2)}"
    )
    if rank < len(values):
        text += f", then {number(values[rank], 2)}"
    return (
        f"{text}. {count} are known to {format_value(KNOWN, 'm')} and fitted, {COUNT - count} keep "
        f"their value; noise {format_value(found.noise, 'm:um', 3)}."
    )


def _combinations(found: Calibration, most: int | None) -> Table:
    chosen = list(enumerate(found.combinations, 1))
    if most is not None and len(chosen) > most:
        chosen = chosen[: most // 2] + chosen[-(most // 2) :]
    cells = (
        (str(place), describe(item), interval_text(MM * item.value, MM * item.half_width))
        for place, item in chosen
    )
    caption = "Combinations of lengths, best known first, with their 95 % intervals."
    return Table(("", "Combination", "Value [mm]"), rows(*cells), caption, words=2, literal=True)


def _deviations(found: Calibration) -> Table:
    values = deviation_array(found.design)
    cells = tuple(
        Row(
            (
                length.symbol, length.label,
                *(format_value(float(values[leg, place]), length.unit) for leg in range(3)),
            )
        )
        for place, length in enumerate(LENGTHS)
    )  # fmt: skip
    caption = "Deviations of the legs" + (
        "." if found.determined.all() else ", of which only sums are known."
    )
    return Table(("", "Length", "Leg 1", "Leg 2", "Leg 3"), cells, caption, words=2)


def calibration_data(found: Calibration, source: str) -> dict[str, Any]:
    """Return everything as data for JSON, in SI units."""
    names = [f"{leg}.{length.name}_{length.unit}" for leg in LEG_NAMES for length in LENGTHS]
    keys = [f"{name}_{'m' if name in 'xyz' else 'rad'}" for name in SIX_COORDINATES]

    def errors(values: PredictionErrors) -> dict[str, Any]:
        sizes = {kind: getattr(values, kind) for kind in ("rms", "largest")}
        return {"poses": values.poses} | {
            kind: dict(zip(keys, each, strict=False)) for kind, each in sizes.items()
        }

    return {
        "design": found.start.name,
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
