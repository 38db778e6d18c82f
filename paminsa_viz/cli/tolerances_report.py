"""What ``paminsa-viz accuracy`` says of manufacture: tolerances, clearances, known deviations."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.cli.output import print_table
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.precision.leg_lengths import LENGTHS
from paminsa_viz.precision.manufacture import (
    ToleranceErrors,
    equal_legs,
    manufactured_pose,
    tolerance_errors,
)
from paminsa_viz.precision.monte_carlo import MonteCarlo, monte_carlo
from paminsa_viz.precision.unequal_legs import COORDINATES, Closure, UnequalPose
from paminsa_viz.units import display_unit, format_ascii, si_unit

UNITS = ("m:um", "m:um", "rad:arcsec", "m:um", "rad:arcsec", "rad:arcsec")
"""Units of the platform's six coordinates."""

LEADING = 3
"""Lengths that are named for each coordinate."""


@dataclass(frozen=True, eq=False)
class ManufactureErrors:
    """Errors at one pose.

    Attributes:
        tolerances: By tolerances and clearances, to first order.
        robots: Of robots drawn at random, or None.
        actual: Where the design's own legs put the platform if they are taken as equal.
    """

    tolerances: ToleranceErrors
    robots: MonteCarlo | None
    actual: UnequalPose


def manufacture_errors(
    design: Design, pose: ArrayLike, *, robots: int = 0, seed: int = 0
) -> ManufactureErrors:
    """Work out the errors at a pose (4,), and draw robots if there are to be any."""
    return ManufactureErrors(
        tolerance_errors(design, pose),
        monte_carlo(design, pose, robots=robots, seed=seed) if robots else None,
        manufactured_pose(design, pose),
    )


def leading_lengths(shares: Array) -> list[tuple[str, float]]:
    """Return the lengths with the largest shares (14,) in an error, largest first."""
    order = np.argsort(-shares, kind="stable")[:LEADING]
    return [(LENGTHS[place].symbol, float(shares[place])) for place in order if shares[place] > 0]


def print_manufacture(design: Design, found: ManufactureErrors) -> None:
    """Print the errors as a table, and what the design's own deviations do."""
    errors, robots = found.tolerances, found.robots
    print("\nby tolerances and clearances")
    head = ["", "worst", "clearances", "RMS"]
    head += ["RMS of robots", "95 % below"] if robots else []
    rows = [(*head, "of the variance")]
    for place, name in enumerate(COORDINATES):
        values = [errors.worst[place], errors.clearance[place], errors.rms[place]]
        values += [robots.rms[place], robots.quantile(0.95)[place]] if robots else []
        shares = leading_lengths(errors.shares[place])
        text = ", ".join(f"{symbol} {100 * share:.0f} %" for symbol, share in shares)
        cells = (_cell(float(value), UNITS[place]) for value in values)
        rows.append((f"{name} [{display_unit(UNITS[place]).text}]", *cells, text))
    print_table(rows)
    largest = format_ascii(float(errors.horizontal), "m:um")
    lean = format_ascii(float(errors.tilt), "rad:arcsec")
    print(f"worst in the plane {largest}, worst tilt {lean}")
    if robots and not (robots.closure == Closure.OK).all():
        lost = int((robots.closure != Closure.OK).sum())
        print(f"{lost} of {len(robots.closure)} robots cannot be assembled")
    if equal_legs(design):
        return
    print("\nby the design's own deviations, if the controller takes the legs as equal")
    closure = Closure(int(found.actual.closure))
    if closure is not Closure.OK:
        print(f"no assembly: {closure.reason}")
        return
    change = found.actual.coordinates - np.concatenate([errors.pose, np.zeros(2)])
    print_table(
        [
            (name, format_ascii(float(change[place]), UNITS[place]))
            for place, name in enumerate(COORDINATES)
        ]
    )


def manufacture_data(found: ManufactureErrors) -> dict[str, Any]:
    """Return the same for JSON, in SI units."""
    errors, robots = found.tolerances, found.robots
    keys = [f"{name}_{si_unit(unit)}" for name, unit in zip(COORDINATES, UNITS, strict=True)]

    def named(values: Array) -> dict[str, float]:
        return dict(zip(keys, values.tolist(), strict=True))

    data: dict[str, Any] = {
        "worst": named(errors.worst),
        "clearance": named(errors.clearance),
        "rms": named(errors.rms),
        "worst_horizontal_m": float(errors.horizontal),
        "worst_tilt_rad": float(errors.tilt),
        "shares": {
            key: {length.name: float(share) for length, share in zip(LENGTHS, row, strict=True)}
            for key, row in zip(keys, errors.shares, strict=True)
        },
        "actual": named(found.actual.coordinates),
        "actual_reason": Closure(int(found.actual.closure)).reason,
    }
    if robots:
        data["robots"] = {
            "count": len(robots.errors), "seed": robots.seed, "solved": float(robots.solved),
            "rms": named(robots.rms), "p95": named(robots.quantile(0.95)),
        }  # fmt: skip
    return data


def _cell(value: float, unit: str) -> str:
    return f"{value * display_unit(unit).factor:.4g}"
