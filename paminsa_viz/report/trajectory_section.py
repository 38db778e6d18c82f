"""The motion: what it is, the required actuator torques, and figures over time."""

from __future__ import annotations

from paminsa_viz.plots.series import FigureKind, SeriesSources
from paminsa_viz.plots.series_builders import build_series
from paminsa_viz.plots.series_figure import render_series
from paminsa_viz.report.blocks import Block, Figure, Note, Section, Table, actuator_rows
from paminsa_viz.trajectory import TrajectoryAnalysis
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
    if analysis.summary:
        blocks.append(_table(analysis))
        for figure in FIGURES:
            data = build_series(figure, SeriesSources(analysis))
            svg = render_series(data, "svg", title=data.title, caption=figure == "torques")
            blocks.append(Figure(svg, f"{data.title} over time, four panels."))
    return Section("trajectory", "Trajectory", tuple(blocks))


def _table(analysis: TrajectoryAnalysis) -> Table:
    rows = []
    for j, summary in enumerate(analysis.summary):
        unit, speed = ("N m", "rad/s") if j < 3 else ("N", "m/s")
        rows.append(
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
    return Table(head, actuator_rows(*rows), "Required actuator torques on the motion.")
