"""Drives: those of a design, what a motion asks of them, and those that a catalog has for it."""

from __future__ import annotations

import math

from paminsa_viz.actuation.duty import Duty, duty_cycle
from paminsa_viz.actuation.selection import DriveFigures, size_design
from paminsa_viz.blocks.kinds import Block, Note, Row, Table
from paminsa_viz.model.drive import ACTUATORS
from paminsa_viz.palette import ACTUATOR_COLORS
from paminsa_viz.trajectory import TrajectoryAnalysis
from paminsa_viz.units import NONE, format_value, number

RPM = 30 / math.pi


def drives_blocks(analysis: TrajectoryAnalysis) -> list[Block]:
    """Return a design's drives and what a motion asks of them; nothing without drives."""
    design = analysis.design
    if not any(design.drives):
        return []
    held = [
        (name, drive, color)
        for name, drive, color in zip(ACTUATORS, design.drives, ACTUATOR_COLORS, strict=True)
        if drive is not None
    ]
    rows = tuple(
        Row(
            (
                name, drive.summary, number(drive.ratio, 4),
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
        Table(head, rows, "Drives of the design.", words=2, literal=True),
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
    rows = tuple(
        Row(_cells(name, one), "plain" if one.feasible else "marked", color)
        for name, one, color in measured
    )
    return [*blocks, Table(head, rows, "Drives on the trajectory, at the motor's shaft.", words=1)]


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
        f"{100 * one.thermal:.0f} %" if math.isfinite(one.thermal) else NONE,
    )
