"""What a motion does where it crosses singularities, as text."""

from __future__ import annotations

from markupsafe import Markup

from paminsa_viz.blocks.kinds import Note, Table
from paminsa_viz.blocks.trajectory import crossings_table, passages_blocks
from paminsa_viz.explorer.core import motion as motions
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.kit.text import blocks_html, render, status
from paminsa_viz.kept import kept
from paminsa_viz.model import Design
from paminsa_viz.trajectory import TimeOptimalPlan
from paminsa_viz.units import counted, format_value


def chart_html(frame: Frame) -> str:
    """Return the chart of the motion over its path; empty if it crosses nothing."""
    found = motions.planned(frame.state).crossing
    if found is None or not found.crossings:
        return ""
    return _chart(frame.state.document.design, found)


@kept(4)
def _chart(design: Design, found: TimeOptimalPlan) -> str:
    from paminsa_viz.plots.crossing_figure import crossing_svg  # matplotlib is slow to load

    svg = crossing_svg(design, found).decode()
    return render("motion/crossing_chart.j2", svg=Markup(svg[svg.index("<svg") :]))


def crossing_html(frame: Frame) -> str:
    """Return the crossings of the motion; empty if none is planned."""
    planned = motions.planned(frame.state)
    plan = planned.crossing
    if plan is None or frame.analysis is None:
        return ""
    count = len(plan.crossings)
    far = format_value(planned.deviation, "m", 3)
    title = status(
        "motion-crossing", "warn" if count else "plain",
        f"Passes {counted(count, 'singularity', 'singularities')}",
        f"path changed by up to {far} along the escape twist" if planned.deviation else "",
    )  # fmt: skip
    blocks = list(passages(frame.state.document.design, plan))
    loads = crossings_table(frame.analysis)
    if loads.rows:
        blocks += [loads, Note(loads.caption)]
    blocks += map(Note, plan.plan.notes[count:])  # those before are of the crossings
    narrow = [_turned(one) if isinstance(one, Table) else one for one in blocks]
    return title + blocks_html("motion-passages", *narrow)


@kept(4)
def passages(design: Design, plan: TimeOptimalPlan) -> tuple[Table | Note, ...]:
    """Return what the passages of a plan need, and what is not certain there."""
    return tuple(passages_blocks(design, plan))


def _turned(table: Table) -> Table:
    """Return a table with a column for each crossing, which the dock is wide enough for."""
    return table.turned(*range(1, len(table.head)))
