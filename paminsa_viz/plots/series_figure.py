"""Figures over time by matplotlib, for print, report, notebook and command line.

matplotlib arranges the panels; heading, legend and caption, as wide as the figure, are above and
below them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.legend import Legend
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from paminsa_viz.checks import kinds_checked
from paminsa_viz.errors import InvalidInput
from paminsa_viz.palette import BAD, INK, MUTED
from paminsa_viz.plots import series_text
from paminsa_viz.plots.formats import (
    INCH,
    POINT,
    Credits,
    arrange,
    check_size,
    drawing,
    figure_file,
)
from paminsa_viz.plots.series import (
    EngineTorques,
    FigureKind,
    SeriesData,
    SeriesPanel,
    SeriesSources,
    Trace,
    largest_size,
    thinned,
)
from paminsa_viz.plots.series_builders import build_series
from paminsa_viz.plots.text import printable, wrapped
from paminsa_viz.trajectory.analysis import TrajectoryAnalysis
from paminsa_viz.trajectory.simulation import Simulation
from paminsa_viz.units import DisplayUnit, readable_unit, symbols_math

# ---------------------------------------------------------------------------------- one set of axes

_LARGEST = 1e5
"""Displayed values from this on are multiples of a power of ten."""
_ROUNDING = 1e-9
"""Share of a value's size below which its changes are rounding errors."""
_PADDING = 0.07
"""Space above and below the curves, as a share of their range."""
_POINTS = 6000
"""Most points of a curve: more than a page can show."""

FAILED = "#f6dcd9"
"""Shading of times at which the motion fails."""
_GRID: dict[str, Any] = {"color": "#e4e8ec", "lw": 0.5}
DASHES: dict[str, Any] = {
    "solid": "-",
    "dashed": (0, (4.0, 2.0)),
    "dotted": (0, (1.2, 1.4)),
    "dashdot": (0, (5.0, 1.5, 1.2, 1.5)),
}
RING: dict[str, Any] = {"marker": "o", "ms": 4.0, "mfc": "white", "mew": 0.9, "ls": "none"}
CROSS: dict[str, Any] = {"marker": "x", "ms": 3.0, "mew": 0.7, "ls": "none"}


def line_height(size: float) -> float:
    """Return the distance of two lines of text [mm] of a size [points]."""
    return 1.25 * size * POINT


def value_range(panel: SeriesPanel) -> tuple[DisplayUnit, float, float]:
    """Return the unit of a panel's value axis, and the axis' lower and upper end in that unit.

    It shows all of a panel's curves. Where nothing changes but by rounding errors, it
    is wide enough not to show those.
    """
    known = np.concatenate([t.values[np.isfinite(t.values)] for t in panel.traces] or [[]])
    if not known.size:
        return readable_unit(panel.unit, 0.0), 0.0, 1.0
    unit = readable_unit(panel.unit, largest_size(panel.traces), bound=_LARGEST)
    low, high = float(known.min()) * unit.factor, float(known.max()) * unit.factor
    largest = max(abs(low), abs(high))
    if high - low <= _ROUNDING * largest or largest == 0:
        half = 0.1 * largest if largest else 1.0
        low, high = low - half, high + half
    padding = _PADDING * (high - low)
    return unit, low - padding, high + padding


def draw_panel(area: Axes, data: SeriesData, panel: SeriesPanel, body: float, small: float) -> None:
    """Draw a panel with its heading and notes; sizes of letters in points."""
    unit, low, high = value_range(panel)
    area.set_axisbelow(True)
    area.grid(**_GRID)
    if low < 0 < high:
        area.axhline(0, color="#aab4be", lw=0.5, zorder=1)
    for failure in series_text.failures(data):
        if failure.end > failure.start:
            area.axvspan(failure.start, failure.end, fc=FAILED, lw=0, zorder=0.5)
        area.axvline(failure.start, color=BAD, lw=0.7, zorder=1.5)
    for order, trace in enumerate(panel.traces):
        _draw_trace(area, data, trace, unit.factor, 3 + 0.01 * order)
    empty = not any(np.isfinite(trace.values).any() for trace in panel.traces)
    if empty:
        # The caption says what else has no values, such as a reference that fails.
        why = "" if data.until else ": the motion fails from its start"
        area.text(0.5, 0.5, f"no value{why}", ha="center", va="center",
                  transform=area.transAxes, size=small, color=INK)  # fmt: skip
    area.yaxis.set_major_locator(MaxNLocator(6, steps=[1, 2, 2.5, 5, 10]))
    area.set_ylim(low, high)
    if empty:
        area.set_yticks([])
    area.ticklabel_format(style="plain", useOffset=False)
    area.tick_params(labelsize=body, labelcolor=INK, color=INK, length=2.0, width=0.5, pad=1.5)
    area.set_ylabel(
        f"{symbols_math(panel.symbol)} [{unit.text}]", parse_math=True, size=body, color=INK,
        labelpad=2,
    )  # fmt: skip
    for spine in area.spines.values():
        spine.set(color=INK, linewidth=0.5)
    line = line_height(small) / POINT
    first = 3.0 + (len(panel.notes) - 1) * line
    # With a y of its own the heading need not be placed above what might be there, which
    # takes a seventh of the time of a figure.
    area.set_title(panel.name, loc="left", size=body + 0.5, weight="bold",
                   color=panel.color, y=1.0, pad=max(first, 3.0))  # fmt: skip
    for row, (text, color) in enumerate(panel.notes):
        note = area.annotate(
            printable(text), (1, 1), (0, first - row * line), xycoords="axes fraction",
            textcoords="offset points", ha="right", va="baseline", size=small, color=color,
        )  # fmt: skip
        note.set_in_layout(False)


def _draw_trace(area: Axes, data: SeriesData, trace: Trace, factor: float, zorder: float) -> None:
    if trace.marks:
        area.plot(data.time, trace.values * factor, color=trace.color, zorder=4.5, **CROSS)
        return
    kept = thinned([trace.values], _POINTS)
    area.plot(data.time[kept], trace.values[kept] * factor, color=trace.color, lw=trace.width,
              ls=DASHES[trace.dash], zorder=zorder, solid_capstyle="round",
              solid_joinstyle="round")  # fmt: skip
    if trace.band is not None:
        half = trace.band * factor
        area.axhspan(-half, half, fc=trace.color, ec="none", alpha=0.1, zorder=1)
    if trace.peak is not None:
        t, value = trace.peak
        area.plot(t, value * factor, mec=trace.color, zorder=2 + zorder, clip_on=False, **RING)


# ----------------------------------------------------------------------------------- a whole figure

TWO_COLUMNS = 130.0  # mm; narrower figures have their panels below each other
LEAST_WIDTH = 60.0  # mm; below it headings would be cut

_SHAPE = 0.42  # height over width of a panel
_HEIGHTS = (20.0, 60.0)  # mm
_TALLEST = 235.0  # mm; all panels together, so that a figure fits on a page
_AXIS = 8.6  # mm; below the lowest panels: numbers and axis label
_SCALE = 15.0  # mm; about the width of the numbers and the label of a value axis

_CAPTION = "#3b4754"


@kinds_checked
def figure_bytes(
    kind: FigureKind,
    analysis: TrajectoryAnalysis,
    *,
    reference: TrajectoryAnalysis | None = None,
    published: TrajectoryAnalysis | None = None,
    simulation: Simulation | None = None,
    engine: EngineTorques | None = None,
    format: str = "png",
    width_mm: float = 170.0,
    dpi: float = 300.0,
    title: str | None = None,
    caption: bool = True,
    notes: Sequence[str] = (),
) -> bytes:
    """Draw a figure over time of an analyzed trajectory.

    Args:
        kind: One of `series.FIGURES`. ``"tracking"`` needs a simulation, ``"comparison"`` a second
            source of torques: an engine, else published formulas, else a reference.
        analysis: The design on the trajectory.
        reference: Another design on the same trajectory, drawn dashed in gray.
        published: The design by the formulas as published, drawn dotted.
        simulation: The robot driven along the trajectory.
        engine: Torques from a physics engine at the trajectory's samples.
        format: Key of `formats.FIGURE_FORMATS`: ``"png"``, ``"svg"`` or ``"pdf"``.
        width_mm: Width on paper [mm]; 85 is a column, 170 a page.
        dpi: Pixels per inch of a PNG.
        title: Heading; None for the kind's own, empty for none.
        caption: Whether a caption is added.
        notes: Further sentences for the caption.

    Raises:
        InvalidInput: If the kind is unknown, what it needs is missing, the sources are not of the
            same trajectory, or format, width or resolution is not possible.
    """
    sources = SeriesSources(analysis, reference, published, simulation, engine)
    return render_series(
        build_series(kind, sources), format,
        width_mm=width_mm, dpi=dpi, title=title, caption=caption, notes=notes,
    )  # fmt: skip


def render_series(
    data: SeriesData,
    format: str = "png",
    *,
    width_mm: float = 170.0,
    dpi: float = 300.0,
    title: str | None = None,
    caption: bool = True,
    notes: Sequence[str] = (),
) -> bytes:
    """Draw a figure over time; the height follows from the width.

    Args:
        data: What to draw.
        format, width_mm, dpi, title, caption, notes: As of `figure_bytes`.

    Raises:
        InvalidInput: If format, width or resolution is not possible.
    """
    check_size(format, width_mm, dpi)
    if width_mm < LEAST_WIDTH:
        raise InvalidInput("width_mm", f"at least {LEAST_WIDTH:g} mm are needed")
    with drawing():
        heading = data.title if title is None else title
        below = series_text.caption(data, notes) if caption else ""
        figure = draw_series(data, width_mm, dpi, heading, below)
        credits = Credits(heading or data.title, series_text.summary(data))
        return figure_file(figure, format, dpi, credits)


def draw_series(data: SeriesData, width: float, dpi: float, title: str, caption: str) -> Figure:
    """Return the figure, ``width`` mm wide, inside `formats.drawing`."""
    body = 7.0 if width < TWO_COLUMNS else 8.0
    large, small = body + 1.5, body - 1.5
    columns = 2 if width >= TWO_COLUMNS else 1
    rows = math.ceil(len(data.panels) / columns)
    panel_width = width / columns - _SCALE
    tall = min(max(min(panel_width * _SHAPE, _TALLEST / rows - 8.0), _HEIGHTS[0]), _HEIGHTS[1])
    lines = [
        max(1, *(len(panel.notes) for panel in data.panels[row * columns : (row + 1) * columns]))
        for row in range(rows)
    ]
    headings = sum(3.0 + line_height(body) + (count - 1) * line_height(small) for count in lines)

    figure, layout = Figure(dpi=dpi), ConstrainedLayoutEngine()
    FigureCanvasAgg(figure)
    figure.set_figwidth((round(width / INCH * dpi) + 0.01) / dpi)
    legend = _legend(figure, data, width, body)
    legend_height = legend.get_window_extent().height / dpi * INCH + 3.0 if legend else 0.0
    heading = wrapped(title, large * POINT, 0.96 * width - 2.0, "bold")
    below = wrapped(caption, small * POINT, 0.98 * width - 4.0)
    top = 1.0 + len(heading) * line_height(large)
    bottom = legend_height + len(below) * line_height(small) + (3.0 if below else 1.0)
    height = top + headings + rows * tall + _AXIS + bottom
    height = (round(height / INCH * dpi) + 0.01) / dpi * INCH
    figure.set_figheight(height / INCH)

    layout.set(
        rect=(0, bottom / height, 1, 1 - (top + bottom) / height),
        w_pad=1.5 / INCH, h_pad=0.4 / INCH, wspace=0.03, hspace=0.0,
    )  # fmt: skip
    grid = figure.subplots(rows, columns, sharex=True, squeeze=False)
    for panel, area in zip(data.panels, grid.flat, strict=False):
        draw_panel(area, data, panel, body, small)
    for area in grid[-1]:
        area.set_xlabel("t [s]", size=body, color=INK, labelpad=2)
    ticks = max(int(panel_width / 11.0), 2)
    grid[0, 0].xaxis.set_major_locator(MaxNLocator(ticks, steps=[1, 2, 2.5, 5, 10]))
    grid[0, 0].set_xlim(data.time[0], data.time[-1])
    figure.text(0.5, 1 - 1.0 / height, "\n".join(heading), size=large, weight="bold",
                color=INK, ha="center", va="top")  # fmt: skip
    if legend is not None:
        legend.set_bbox_to_anchor((0.5, (bottom - 1.0) / height))
    figure.text(2.0 / width, (bottom - legend_height - 1.0) / height, "\n".join(below),
                size=small, linespacing=1.1, color=_CAPTION, va="top")  # fmt: skip
    arrange(figure, layout)
    figure.align_ylabels()
    _shrink_notes(figure, small)
    return figure


def _shrink_notes(figure: Figure, size: float) -> None:
    """Make notes smaller that are wider than their panel, next to its name."""
    for area in figure.axes:
        wide = area.get_window_extent().width
        name = area._left_title.get_window_extent().width  # type: ignore[attr-defined]
        for row, note in enumerate(area.texts):
            if note.get_in_layout():
                continue
            free = wide - (name + 2.0 / INCH * figure.dpi if row == 0 else 0.0)
            shrink = free / note.get_window_extent().width
            if shrink < 1:
                note.set_fontsize(size * shrink)


def _legend(figure: Figure, data: SeriesData, width: float, body: float) -> Legend | None:
    """Return the legend; None if a single curve in every panel needs none."""
    entries = _entries(data)
    if not entries:
        return None
    em = body * POINT
    labels = ["\n".join(wrapped(text, em, width - 16.0)) for text in entries]
    legend: Legend | None = None
    for columns in range(len(labels), 0, -1):
        if legend is not None:
            legend.remove()
        legend = figure.legend(
            list(entries.values()), labels, loc="upper center", bbox_to_anchor=(0.5, 0.5),
            ncols=columns, frameon=False, fontsize=body,
            labelcolor=INK, handlelength=8.0 / em, handletextpad=1.5 / em, columnspacing=6.0 / em,
            labelspacing=0.3, borderpad=0.0, borderaxespad=0.0,
        )  # fmt: skip
        legend.set_in_layout(False)
        if legend.get_window_extent().width <= (width - 4.0) / INCH * figure.dpi:
            break
    return legend


def _entries(data: SeriesData) -> dict[str, Line2D | Patch]:
    """Return the legend's entries by label, the uppermost trace of each panel first."""
    found: dict[str, Line2D | Patch] = {}
    colors: dict[str, str] = {}
    for panel in data.panels:
        if len(panel.traces) == 1:
            continue
        equal = data.kind == "loads"  # legs are in their order
        for trace in panel.traces if equal else (*panel.traces[-1:], *panel.traces[:-1]):
            if not np.isfinite(trace.values).any():
                continue  # such as a reference that fails at once
            shared = colors.setdefault(trace.label, trace.color)
            color = trace.color if trace.color == shared else INK  # it has the panels' colors
            style = CROSS if trace.marks else {"lw": trace.width, "ls": DASHES[trace.dash]}
            found[trace.label] = Line2D([], [], color=color, **style)
            colors[trace.label] = color
    traces = [trace for panel in data.panels for trace in panel.traces]
    if any(trace.peak for trace in traces):
        marked = "least" if data.kind == "clearance" else "largest in size"
        found[marked] = Line2D([], [], mec=INK, **RING)
    if any(trace.band is not None for trace in traces):
        found["± RMS"] = Patch(fc=MUTED, alpha=0.2, ec="none")
    failures = series_text.failures(data)
    if failures:
        reasons = list(dict.fromkeys(each.reason for each in failures))
        more = f" and {len(reasons) - 2} more" if len(reasons) > 2 else ""
        what = "stopped" if data.kind == "tracking" else "fails"
        found[f"{what}: {', '.join(reasons[:2])}{more}"] = Patch(fc=FAILED, ec=BAD, lw=0.5)
    return found
