"""Drives: those of a design, what a motion demands of them, and those that a catalog has for it."""

from __future__ import annotations

import math
from typing import Any

from paminsa_viz.actuation.catalog import Catalog
from paminsa_viz.actuation.duty import ActuatorLoad, Duty, DutyCycle, duty_cycle
from paminsa_viz.actuation.ratios import GearRatios
from paminsa_viz.actuation.selection import DriveFigures, Selection, size_design
from paminsa_viz.blocks.data import record
from paminsa_viz.blocks.kinds import Block, Note, Row, Table, rows
from paminsa_viz.model.design import Design
from paminsa_viz.model.drive import ACTUATORS
from paminsa_viz.palette import ACTUATOR_COLORS
from paminsa_viz.trajectory import TrajectoryAnalysis
from paminsa_viz.units import NONE, format_value, number

RPM = 30 / math.pi
"""Revolutions per minute in a radian per second."""


def drives_blocks(analysis: TrajectoryAnalysis) -> list[Block]:
    """Return a design's drives and what a motion demands of them; nothing without drives."""
    design = analysis.design
    if not any(design.drives):
        return []
    held = [
        (name, drive, color)
        for name, drive, color in zip(ACTUATORS, design.drives, ACTUATOR_COLORS, strict=True)
        if drive is not None
    ]
    values = tuple(
        Row(
            (
                name, drive.summary, f"{number(drive.ratio, 4)}{' rad/m' if name == 'M4' else ''}",
                format_value(drive.reflected_inertia, "kg" if name == "M4" else "kg m^2", 3),
                NONE if drive.rated_torque is None else format_value(drive.rated_torque, "N m", 3),
                NONE if drive.peak_torque is None else format_value(drive.peak_torque, "N m", 3),
            ),
            color=color,
        )
        for name, drive, color in held
    )  # fmt: skip
    head = ("", "Drive", "Motor turn per unit", "Inertia at the actuator", "Rated", "Peak")
    blocks: list[Block] = [
        Note(
            "The drives' inertia and friction are part of all torques on the trajectory. The table "
            "below measures each drive on the load without its own inertia; its efficiency acts by "
            "the direction of the power."
        ),
        Table(head, values, "Drives of the design.", words=2, literal=True),
    ]
    if analysis.check.first is not None:
        text = "The robot cannot run the trajectory, so they are not measured."
        return [*blocks, Note(text, "bad")]
    found = size_design(duty_cycle(design, [Duty(analysis.trajectory)]), design)
    measured = [
        (name, one, color)
        for name, one, color in zip(ACTUATORS, found, ACTUATOR_COLORS, strict=True)
        if one is not None
    ]
    short = [name for name, one, _ in measured if not one.feasible]
    if short:
        blocks.append(Note(f"Too weak for this motion, repeated: {', '.join(short)}.", "bad"))
    else:
        blocks.append(Note("Every drive keeps its limits on this motion, repeated.", "ok"))
    head = (
        "", "Share of its limits", "by", "RMS torque", "Peak", "Top speed", "Peak power",
        "Inertia ratio", "Winding",
    )  # fmt: skip
    shares = tuple(
        Row(_cells(name, one), "plain" if one.feasible else "marked", color)
        for name, one, color in measured
    )
    return [
        *blocks,
        Table(head, shares, "Drives on the trajectory, at the motor's shaft.", words=1),
    ]


def _cells(name: str, one: DriveFigures) -> tuple[str, ...]:
    return (
        name,
        f"{100 * one.use:.0f} %",
        one.limit,
        format_value(one.rms, "N m", 3),
        format_value(one.peak, "N m", 3),
        f"{one.top_speed * RPM:.0f} rpm",
        format_value(one.top_power, "W", 3),
        number(one.inertia_ratio, 3),
        winding_text(one),
    )


LOAD_HEAD = ("Load", "Peak", "RMS", "Top speed", "Peak power", "Inertia")

FIGURES_HEAD = (
    "", "Drive", "Ratio", "Margin", "by", "RMS [N·m]", "Peak [N·m]", "rpm", "W", "Inertia ratio",
    "Winding", "kg", "Cost",
)  # fmt: skip


def cycle_text(cycle: DutyCycle) -> str:
    """Return the motions of a duty cycle, how often each is made, and the waiting after it."""
    return ", ".join(
        f"{duty.trajectory.name} ({number(duty.trajectory.duration, 3)} s, "
        f"{number(duty.repeats, 6)} times, dwell {number(duty.dwell, 3)} s)"
        for duty in cycle.duties
    )


def selection_blocks(
    design: Design, found: Selection, listed: int, advice: tuple[str, ...]
) -> list[Block]:
    """Return the loads, the design's own drives on them, and the first of each actuator's list.

    Args:
        design: The robot, whose own drives are measured too.
        found: The feasible drives.
        listed: How many of each list.
        advice: Of each actuator, what would make a drive feasible; empty where one is.
    """
    loads = tuple(Row(_load(load)) for load in found.cycle.loads)
    blocks: list[Block] = [Table(LOAD_HEAD, loads, "Loads of the actuators, without drives.")]
    own = size_design(found.cycle, design)
    if any(own):
        measured = [(f"M{j + 1}", one) for j, one in enumerate(own) if one is not None]
        blocks.append(figures_table("The design's own drives.", measured))
    for j, sizing in enumerate(found.sizings):
        if found.same and j in (1, 2):
            continue
        name = "M1 to M3" if found.same and j == 0 else ACTUATORS[j]
        text = f"{name}: {len(found.rows[j])} of {len(sizing.table)} drives are feasible"
        if advice[j]:
            blocks += [Note(f"{text}.", "bad"), Note(f"{advice[j]}.")]
            continue
        first = [(str(i), one) for i, one in enumerate(found.figures(j, listed), 1)]
        blocks.append(figures_table(f"{text}.", first))
    return blocks


def figures_table(caption: str, figures: list[tuple[str, DriveFigures]]) -> Table:
    """Return drives with their figures on a load; those that break a limit are marked."""
    lines = tuple(
        Row((name, *figure_cells(one)), "plain" if one.feasible else "marked")
        for name, one in figures
    )
    return Table(FIGURES_HEAD, lines, caption, words=2, literal=True)


def figure_cells(one: DriveFigures) -> tuple[str, ...]:
    """Return the cells of `FIGURES_HEAD` after the first."""
    drive = one.drive
    return (
        drive.name or drive.summary, f"{drive.gear_ratio:g}", margin_text(one), one.limit,
        number(one.rms, 3), number(one.peak, 3), f"{one.top_speed * RPM:.0f}",
        number(one.top_power, 3), number(one.inertia_ratio, 3), winding_text(one),
        *(NONE if value is None else f"{value:g}" for value in (drive.mass, drive.cost)),
    )  # fmt: skip


def margin_text(one: DriveFigures) -> str:
    """Return what is left of the limit that is used most, as a percentage of it."""
    return f"{100 * (1 - one.use):.0f} %".replace("-", "−")


def winding_text(one: DriveFigures) -> str:
    """Return the winding's temperature rise over that at the rated torque, as a percentage."""
    return f"{100 * one.thermal:.0f} %" if math.isfinite(one.thermal) else NONE


def _load(load: ActuatorLoad) -> tuple[str, ...]:
    linear = load.name == "M4"
    force, speed, inertia = ("N", "m/s", "kg") if linear else ("N m", "rad/s", "kg m^2")
    return (
        load.name, format_value(load.peak, force, 3), format_value(load.rms, force, 3),
        f"{number(load.top_speed, 3)} {speed}", format_value(load.top_power, "W", 3),
        format_value(load.inertia, inertia, 3),
    )  # fmt: skip


def ratio_table(found: list[GearRatios]) -> Table:
    """Return the gear ratios that motors can have for each actuator."""
    cells = (
        (
            one.actuator, one.motor,
            "none" if one.low is None or one.high is None
            else f"{number(one.low)} to {number(one.high)}",
            "by scan, with gaps" if one.gaps else "by scan" if one.scanned else "",
        )
        for one in found
    )  # fmt: skip
    return Table(("", "Motor", "Gear ratio", ""), rows(*cells), words=4)


def selection_data(
    design: Design, catalog: Catalog, found: Selection, listed: int, advice: tuple[str, ...]
) -> dict[str, Any]:
    """Return the loads, the drives that the catalog has for them, and the design's own, for JSON.

    Args:
        design: The robot.
        catalog: The catalog.
        found: The feasible drives.
        listed: How many of each list.
        advice: Of each actuator, what would make a drive feasible; empty where one is.
    """
    return {
        "design": design.name,
        "catalog": catalog.name,
        "motions": [
            record(duty.trajectory, "name", "duration_s") | record(duty, "repeats", "dwell_s")
            for duty in found.cycle.duties
        ],
        "feasible": found.feasible,
        "actuators": [
            record(load, "name", "peak", "rms", "top_speed", "top_power_W", "inertia")
            | {
                "pairs": len(found.sizings[j].table),
                "feasible": len(found.rows[j]),
                "advice": advice[j],
                "drives": [_figures(one) for one in found.figures(j, listed)],
            }
            for j, load in enumerate(found.cycle.loads)
        ],
        "own": [one and _figures(one) for one in size_design(found.cycle, design)],
    }


def _figures(one: DriveFigures) -> dict[str, Any]:
    drive = one.drive
    return {
        **record(drive, "name", "gear_ratio", "lead_m", "mass_kg", "cost"),
        "margin": 1 - one.use, "feasible_gear_ratios": one.ratios,
        **record(
            one, "feasible", "limit", "rms_Nm", "peak_Nm", "top_speed_rad_s", "top_power_W",
            "envelope", "inertia_ratio", "thermal",
        ),
    }  # fmt: skip
