"""The motion: what it is, the required actuator torques, and figures over time."""

from __future__ import annotations

from paminsa_viz.plots.series import FigureKind, SeriesSources
from paminsa_viz.plots.series_builders import build_series
from paminsa_viz.report.blocks import (
    Block,
    Note,
    Section,
    Table,
    actuator_rows,
    rows,
    series_figure,
)
from paminsa_viz.trajectory import TrajectoryAnalysis, escape_inertia
from paminsa_viz.units import format_value

FIGURES: tuple[FigureKind, ...] = ("pose", "torques", "breakdown", "power")


def trajectory_section(analysis: TrajectoryAnalysis) -> Section:
    """Return the section."""
    t, check = analysis.trajectory, analysis.check
    kind = f" ({t.kind})" if t.kind else ""
    text = f"“{t.name}”{kind}: {t.duration:.4g} s, {t.size} samples. {' '.join(t.notes)}"
    blocks: list[Block] = [Note(text.strip())]
    if check.first is not None:
        blocks.append(Note(f"The robot cannot run all of it: {check.first.explanation}.", "bad"))
    else:
        near = check.closest
        leg = f", leg {near.leg + 1}" if near.leg >= 0 else ""
        blocks.append(
            Note(
                f"The robot can run it. It comes nearest to a limit ({near.limit.noun}{leg}) at "
                f"{near.t:.4g} s, with {format_value(near.margin, 'm', 3)} to spare.",
                "ok",
            )
        )
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
    if analysis.summary:
        blocks.append(_table(analysis))
        for figure in FIGURES:
            data = build_series(figure, SeriesSources(analysis))
            alt = f"{data.title} over time, four panels."
            blocks.append(series_figure(data, alt, caption=figure == "torques"))
    return Section("trajectory", "Trajectory", tuple(blocks))


def _crossings(analysis: TrajectoryAnalysis) -> Table:
    found = []
    for item in analysis.crossings:
        pose = analysis.trajectory.at(item.t).pose
        limits = ["no bound"] * 4
        if item not in analysis.unbounded:
            limits = [
                format_value(torque, "N" if j == 3 else "N m")
                for j, torque in enumerate(item.torque)
            ]
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
    head = ("", "At", "t_sᵀ F", "M1", "M2", "M3", "M4", "t_sᵀ M t_s")
    text = (
        "Crossings of singularities and the torques in the limit. There the actuators have no "
        "authority along the escape twist t_s: what the model does not know of moves the platform "
        "along it, against the inertia t_sᵀ M t_s only."
    )
    return Table(head, rows(*found), text)


def _table(analysis: TrajectoryAnalysis) -> Table:
    found = []
    for j, summary in enumerate(analysis.summary):
        unit, speed = ("N m", "rad/s") if j < 3 else ("N", "m/s")
        found.append(
            (
                f"M{j + 1}",
                format_value(summary.peak, unit),
                format_value(summary.peak_t, "s", 3),
                format_value(summary.rms, unit),
                format_value(summary.top_speed, speed),
                format_value(summary.top_power, "W"),
                format_value(summary.driven, "J"),
                format_value(summary.braked, "J"),
            )
        )
    head = (
        "", "Peak torque, force", "At", "RMS", "Top speed", "Peak power", "Energy driving",
        "Braking",
    )  # fmt: skip
    return Table(head, actuator_rows(*found), "Required actuator torques on the motion.")
