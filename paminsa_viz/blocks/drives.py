"""Drives: those of a design, what a motion demands of them, and those that a catalog has for it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from paminsa_viz.actuation.catalog import Catalog
from paminsa_viz.actuation.duty import ActuatorLoad, Duty, DutyCycle, duty_cycle
from paminsa_viz.actuation.ratios import GearRatios
from paminsa_viz.actuation.selection import DriveFigures, Selection, size_design
from paminsa_viz.blocks.data import record, robot
from paminsa_viz.blocks.kinds import Block, Cell, CellKind, Note, Row, Table, rows
from paminsa_viz.model.design import Design
from paminsa_viz.model.drive import ACTUATORS, SPEED_UNITS, TORQUE_UNITS
from paminsa_viz.palette import ACTUATOR_COLORS
from paminsa_viz.trajectory import TrajectoryAnalysis
from paminsa_viz.units import NONE, counted, format_value, number, percent

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
            "The drives’ inertia and friction are part of all torques on the trajectory. The table "
            "below measures each drive on the load without its own inertia; its efficiency acts by "
            "the direction of the power."
        ),
        Table(head, values, "Drives of the design.", words=2, literal=True),
    ]
    if analysis.failure is not None:
        text = "The robot cannot run the trajectory, so they are not measured."
        return [*blocks, Note(text, "bad")]
    found = size_design(duty_cycle(design, [Duty(analysis.trajectory)]), design)
    short = [name for name, one in zip(ACTUATORS, found, strict=True) if one and not one.feasible]
    if short:
        blocks.append(Note(f"Too weak for this motion, repeated: {', '.join(short)}.", "bad"))
    else:
        blocks.append(Note("Every drive keeps its limits on this motion, repeated.", "ok"))
    return [*blocks, own_table(design, found)]


LOAD_HEAD = ("Load", "Peak", "RMS", "Top speed", "Peak power", "Inertia")

FIGURES_HEAD = (
    "", "Drive", "Ratio", "Margin", "Limited by", "RMS [N·m]", "Peak [N·m]", "Speed [rpm]",
    "Power [W]", "Inertia ratio", "Winding", "Mass [kg]", "Cost",
)  # fmt: skip


def cycle_text(cycle: DutyCycle) -> str:
    """Return the motions of a duty cycle, how often each is made, and the waiting after it."""
    return ", ".join(
        f"{duty.trajectory.name} ({number(duty.trajectory.duration, 3)} s, "
        f"{_often(duty.repeats)}, dwell {number(duty.dwell, 3)} s)"
        for duty in cycle.duties
    )


def _often(repeats: float) -> str:
    return "once" if repeats == 1.0 else f"{number(repeats, 6)} times"


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
    if any(design.drives):
        blocks.append(own_table(design, size_design(found.cycle, design)))
    for j, sizing in enumerate(found.sizings):
        if found.same and j in (1, 2):
            continue
        name = "M1 to M3" if found.same and j == 0 else ACTUATORS[j]
        of = f"of {counted(len(sizing.table), 'drive')}"
        text = f"{name}: {counted(len(found.rows[j]), f'{of} is', f'{of} are')} feasible"
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


def own_table(design: Design, figures: Sequence[DriveFigures | None]) -> Table:
    """Return the drives of a design with their figures on a load, or without."""
    lines = []
    for name, drive, one, color in zip(
        ACTUATORS, design.drives, figures, ACTUATOR_COLORS, strict=True
    ):
        text = "none" if drive is None else drive.name or drive.summary
        cells = (text, "", NONE) if one is None else figure_cells(one, good="ok")
        kind = "plain" if one is None or one.feasible else "marked"
        lines.append(Row((name, *cells), kind, color))
    caption = "The design’s own drives, at the motor’s shaft."
    return Table(FIGURES_HEAD, tuple(lines), caption, words=2, literal=True)


def facts_table(one: DriveFigures) -> Table:
    """Return what a drive gives, beside its limits."""
    drive = one.drive

    def row(label: str, value: float, limit: float | None, unit: str) -> tuple[str, str, str]:
        if limit is None or not math.isfinite(limit):
            return label, f"{number(value, 3)} {unit}", ""
        share = f"{percent(value / limit)} of {number(limit, 4)}"
        return label, f"{number(value, 4 if unit == 'rpm' else 3)} {unit}", share

    count = NONE
    if drive.resolution is not None:
        unit = "µrad" if drive.lead is None else "µm"
        count = f"{number(1e6 * drive.resolution, 2)} {unit}"
    low, high = one.ratios
    fit = "no ratio fits" if math.isnan(low) else f"{number(low, 3)} to {number(high, 3)} fit"
    cells = [
        row("RMS torque", one.rms, drive.rated_torque, "N·m"),
        row("Peak torque", one.peak, drive.corners[0][1], "N·m"),
        ("Envelope", percent(one.envelope), "largest share of it used"),
        row("Top speed", one.top_speed * RPM, drive.corners[-1][0] * RPM, "rpm"),
        ("Peak power", f"{number(one.top_power, 3)} W", ""),
        ("Inertia ratio", number(one.inertia_ratio, 3), "robot over motor"),
        ("Winding", winding_text(one), "temperature rise"),
        ("Gear ratio", f"{drive.gear_ratio:g}", fit),
        ("One count", count, "of the encoder"),
    ]
    return Table(("",) * 3, rows(*cells), literal=True)


def figure_cells(one: DriveFigures, *, good: CellKind = "plain") -> tuple[str, ...]:
    """Return the cells of `FIGURES_HEAD` after the first; ``good`` is a margin that there is."""
    drive = one.drive
    return (
        drive.name or drive.summary, f"{drive.gear_ratio:g}", margin_text(one, good),
        one.limit or NONE,
        number(one.rms, 3), number(one.peak, 3), f"{one.top_speed * RPM:.0f}",
        number(one.top_power, 3), number(one.inertia_ratio, 3), winding_text(one),
        *(NONE if value is None else f"{value:g}" for value in (drive.mass, drive.cost)),
    )  # fmt: skip


def margin_text(one: DriveFigures, good: CellKind) -> str:
    """Return what is left of the limit that is used most, as a percentage of it.

    Rounded down, so that a drive that is a little too weak has no margin of 0 %.
    """
    if not one.limit:
        return NONE
    room = round(100 * (1 - one.use), 6)  # 1 - 0.9 is a little less than 0.1
    whole = math.floor(room) if math.isfinite(room) else room
    return Cell(percent(whole / 100), kind=good if one.feasible else "bad")


def winding_text(one: DriveFigures) -> str:
    """Return the winding's temperature rise over that at the rated torque, as a percentage."""
    return percent(one.thermal) if math.isfinite(one.thermal) else NONE


def _units(load: ActuatorLoad) -> tuple[str, str, str]:
    """Return the units of torque or force, speed and inertia of an actuator."""
    place = ACTUATORS.index(load.name)
    return TORQUE_UNITS[place], SPEED_UNITS[place], "kg" if load.name == "M4" else "kg m^2"


def _load(load: ActuatorLoad) -> tuple[str, ...]:
    force, speed, inertia = _units(load)
    return (
        load.name, format_value(load.peak, force, 3), format_value(load.rms, force, 3),
        format_value(load.top_speed, speed, 3), format_value(load.top_power, "W", 3),
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
        **robot(design),
        "catalog": catalog.name,
        "motions": [
            record(duty.trajectory, "name", "duration_s") | record(duty, "repeats", "dwell_s")
            for duty in found.cycle.duties
        ],
        "feasible": found.feasible,
        "actuators": [
            record(load, "name", "peak", "rms", "top_speed", "top_power_W", "inertia")
            | dict(zip(("unit", "speed_unit", "inertia_unit"), _units(load), strict=True))
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
