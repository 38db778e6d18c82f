"""The motion: what it is, the required actuator torques, and figures over time."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from paminsa_viz.blocks.kinds import (
    Block,
    Figure,
    Note,
    Row,
    Table,
    actuator_rows,
    rows,
    series_figure,
)
from paminsa_viz.model.drive import ACTUATORS, SPEED_UNITS, TORQUE_UNITS
from paminsa_viz.trajectory import TrajectoryAnalysis, escape_inertia
from paminsa_viz.units import format_value

if TYPE_CHECKING:
    from paminsa_viz.plots.series import FigureKind

LOADS = (
    ("peak", "peak", "Peak", TORQUE_UNITS),
    ("peak_t", "peak_t_s", "At", ("s",) * 4),
    ("rms", "rms", "RMS", TORQUE_UNITS),
    ("top_speed", "top_speed", "Top speed", SPEED_UNITS),
    ("top_power", "top_power_W", "Peak power", ("W",) * 4),
    ("top_power_t", "top_power_t_s", "At", ("s",) * 4),
    ("driven", "driven_J", "Energy driving", ("J",) * 4),
    ("braked", "braked_J", "Braking", ("J",) * 4),
)
"""Loads of an actuator: field of `ActuatorSummary`, JSON key, heading, units of the actuators."""

FIGURES: dict[FigureKind, str] = {
    "pose": "Motion of the platform",
    "torques": "Actuator torques and force",
    "breakdown": "Actuator torques by cause",
    "power": "Power of the actuators",
}
"""Figures and what they show."""


def motion_figures(analysis: TrajectoryAnalysis) -> list[Figure]:
    """Return the figures over time of a motion that the robot can begin."""
    figures = []
    for kind, what in FIGURES.items() if analysis.summary else ():
        alt = f"{what} over time, four panels."
        figures.append(series_figure(kind, analysis, alt, caption=kind == "torques"))
    return figures


def trajectory_blocks(
    analysis: TrajectoryAnalysis, others: Mapping[str, TrajectoryAnalysis | None] | None = None
) -> list[Block]:
    """Return a motion, whether it can be run, and its torques next to those of other analyses."""
    t, check = analysis.trajectory, analysis.check
    kind = f" ({t.kind})" if t.kind else ""
    text = f"“{t.name}”{kind}: {t.duration:.4g} s, {t.size} samples. {' '.join(t.notes)}"
    blocks: list[Block] = [Note(text.strip())]
    if check.first is not None:
        text = f"The robot cannot run all of it: it fails {check.first.explanation}."
        if analysis.summary:
            text += " The numbers are of the time before."
        blocks.append(Note(text, "bad"))
    else:
        near = check.closest
        leg = f", leg {near.leg + 1}" if near.leg >= 0 else ""
        text = (
            f"The robot can run it. It comes nearest to a limit ({near.limit.noun}{leg}) at "
            f"{near.t:.4g} s, with {format_value(near.margin, 'm', 3)} to spare."
        )
        blocks.append(Note(text, "ok"))
    blocks += [
        Note(
            f"At {item.t:.4g} s this robot's torques have no bound: the motion crosses the "
            f"{item.locus.label} with t_sᵀ F = {format_value(item.residual, 'N m', 3)} instead of "
            "zero. Sampled values next to it depend on the rate.",
            "bad",
        )
        for item in analysis.unbounded
    ]
    if analysis.crossings:
        blocks.append(_crossings(analysis))
    known = {name: other for name, other in (others or {}).items() if other and other.summary}
    if analysis.summary:
        found = [row for each in ({"": analysis} | known).items() for row in _loads(*each)]
        head = ("", *(heading for _, _, heading, _ in LOADS))
        blocks.append(Table(head, tuple(found), "Required actuator torques on the motion."))
    return blocks


def _loads(name: str, analysis: TrajectoryAnalysis) -> tuple[Row, ...]:
    """Return the rows of M1 to M4 of one analysis."""
    cells = (
        (
            f"M{j + 1}{f', {name}' if name else ''}",
            *(format_value(getattr(summary, load), units[j]) for load, _, _, units in LOADS),
        )
        for j, summary in enumerate(analysis.summary)
    )
    return actuator_rows(*cells)


def _crossings(analysis: TrajectoryAnalysis) -> Table:
    found = []
    for item in analysis.crossings:
        pose = analysis.trajectory.at(item.t).pose
        limits = ["no bound"] * 4
        if item not in analysis.unbounded:
            limits = list(map(format_value, item.torque, TORQUE_UNITS))
        inertia = float(escape_inertia(analysis.design, pose))
        found.append(
            (
                item.locus.label,
                format_value(item.t, "s", 4),
                format_value(item.residual, "N m", 3),
                *limits,
                format_value(inertia, "kg m^2", 3),
            )
        )
    head = ("", "At", "t_sᵀ F", *ACTUATORS, "t_sᵀ M t_s")
    text = (
        "Crossings of singularities and the torques in the limit. There the actuators have no "
        "authority along the escape twist t_s: what the model does not know of moves the platform "
        "along it, against the inertia t_sᵀ M t_s only."
    )
    return Table(head, rows(*found), text)
