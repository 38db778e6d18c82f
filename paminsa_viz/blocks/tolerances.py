"""A balance within tolerances: what errors of masses and lengths do to the static torques."""

from __future__ import annotations

from paminsa_viz.balancing.tolerance import LengthTolerance, MassTolerance
from paminsa_viz.blocks.balance import bound_name
from paminsa_viz.blocks.kinds import Note, Row, Table, heading, rows
from paminsa_viz.model.drive import ACTUATORS
from paminsa_viz.palette import ACTUATOR_COLORS
from paminsa_viz.units import counted, fixed, percent

LEADING = 3
"""Masses that are named, by their share in the variance."""


def mass_tolerance_blocks(
    found: MassTolerance, decimals: tuple[int, int] = (3, 3)
) -> list[Table | Note]:
    """Return the spread of M_p2 and of the torques at a pose, and which masses lead.

    Args:
        found: The spread.
        decimals: Of torques and of forces.
    """

    def row(name: str, unit: str, color: str, *values: float) -> Row:
        places = decimals[unit == "N"]
        return Row((heading(name, unit), *(fixed(value, places) for value in values)), color=color)

    worst = abs(found.nominal) + found.worst
    spread = zip(
        ACTUATORS, ACTUATOR_COLORS, found.torque, found.torque_deviation, found.torque_worst,
        strict=False,
    )  # fmt: skip
    table = Table(
        ("At this pose", "Nominal", "± σ", "Worst"),
        (
            row("M_p2", "N", "", found.nominal, found.deviation, worst),
            *(row(name, "N m", color, *map(float, values)) for name, color, *values in spread),
        ),
    )
    leading = [
        f"{bound_name(path)} {percent(share)}"
        for path, share in list(found.shares.items())[:LEADING]
    ]
    return [table, *([Note(f"Of the variance: {', '.join(leading)}.")] if leading else [])]


def length_tolerance_blocks(
    found: LengthTolerance, decimals: tuple[int, int] = (3, 3)
) -> list[Table | Note]:
    """Return the spread of the largest torque, and how many robots cannot take all poses.

    Args:
        found: The spread.
        decimals: Of torques and of forces.
    """
    sizes = (
        ("Nominal lengths", found.nominal),
        (f"Half of {counted(found.peaks.size, 'robot')} below", found.quantile(0.5)),
        ("95 % below", found.quantile(0.95)),
        ("Largest of all", float(found.peaks.max())),
    )
    table = Table(
        (heading("Largest torque on a coarse map", "N m"), ""),
        rows(*((name, fixed(value, decimals[0])) for name, value in sizes)),
    )
    lost = int((found.lost > 0).sum())
    return [table, *([Note(f"{lost} of the robots cannot take all of the poses.")] if lost else [])]
