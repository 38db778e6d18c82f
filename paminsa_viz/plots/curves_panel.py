"""One panel of a printed figure over time: shading, grid, curves, marks, frame, heading."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from paminsa_viz.palette import BAD, INK
from paminsa_viz.plots.axes import Mark
from paminsa_viz.plots.curves_axes import Scale
from paminsa_viz.plots.curves_data import CurveData, Panel, extremes
from paminsa_viz.plots.layout import Box
from paminsa_viz.plots.lettering import TextMetrics
from paminsa_viz.plots.page import Page

FAILED = "#f6dcd9"
FAILED_EDGE = BAD
"""Shading of times at which the motion fails, and its edges."""

DASHES: dict[str, Any] = {
    "solid": "-",
    "dashed": (0, (4.0, 2.0)),
    "dotted": (0, (1.2, 1.4)),
    "dashdot": (0, (5.0, 1.5, 1.2, 1.5)),
}

_GRID = "#e4e8ec"
_POINTS = 6000
"""Most points of a printed curve: more than a page can show."""


def draw_panel(
    page: Page,
    data: CurveData,
    panel: Panel,
    scale: Scale,
    box: Box,
    letters: TextMetrics,
    small: TextMetrics,
    marks: tuple[Mark, ...],
    lowest: bool,
) -> None:
    """Draw one panel into its box; the lowest ones carry the numbers of the time axis."""
    area = page.axes(box)
    area.set(xlim=(data.time[0], data.time[-1]), ylim=(scale.low, scale.high))
    area.set_axisbelow(True)
    _failures(area, data)
    for mark in scale.marks:
        strong = mark.value == 0
        area.axhline(mark.value, color="#aab4be" if strong else _GRID, lw=0.5, zorder=1)
    for mark in marks:
        area.axvline(mark.value, color=_GRID, lw=0.5, zorder=1)
    for level in panel.levels:
        area.axhline(level.value * scale.factor, color=level.color, lw=0.6,
                     ls=DASHES["dashdot"], zorder=2)  # fmt: skip
    for order, trace in enumerate(panel.traces):
        kept = extremes(trace.values, _POINTS)
        area.plot(data.time[kept], trace.values[kept] * scale.factor, color=trace.color,
                  lw=trace.width, ls=DASHES[trace.dash], zorder=3 + 0.01 * order,
                  solid_capstyle="round", solid_joinstyle="round")  # fmt: skip
    for peak in reversed(panel.peaks):
        area.plot(peak.t, peak.value * scale.factor, marker="o", ms=4.0, mfc="white",
                  mec=peak.color, mew=0.9, ls="none", zorder=5, clip_on=False)  # fmt: skip
    if not any(np.isfinite(trace.values).any() for trace in panel.traces):
        area.text(0.5, 0.5, "no value: the motion fails from its start", ha="center", va="center",
                  transform=area.transAxes, size=small.size, color=INK)  # fmt: skip
    _frame(page, area, panel, scale, box, letters, marks, lowest)
    _heading(page, panel, box, letters, small)


def _failures(area: Axes, data: CurveData) -> None:
    for failure in data.failures:
        if failure.end > failure.start:
            area.axvspan(failure.start, failure.end, fc=FAILED, lw=0, zorder=0.5)
        area.axvline(failure.start, color=FAILED_EDGE, lw=0.7, zorder=1.5)


def _frame(
    page: Page,
    area: Axes,
    panel: Panel,
    scale: Scale,
    box: Box,
    letters: TextMetrics,
    marks: tuple[Mark, ...],
    lowest: bool,
) -> None:
    area.set_xticks([m.value for m in marks], [m.words if lowest else "" for m in marks])
    area.set_yticks([m.value for m in scale.marks], [m.words for m in scale.marks])
    area.tick_params(
        labelsize=letters.size, labelcolor=INK, color=INK, length=2.0, width=0.5, pad=1.5
    )
    for spine in area.spines.values():
        spine.set(color=INK, linewidth=0.5)
    widest = max((letters.width(m.words) for m in scale.marks), default=0.0)
    style: dict[str, Any] = {"size": letters.size, "color": INK}
    page.text(box.left - widest - 2.0, box.top + box.height / 2, scale.label, ha="right",
              va="center", rotation=90, **style)  # fmt: skip
    if lowest:
        page.text(box.left + box.width / 2, box.bottom + 4.6, "t [s]", ha="center", va="top",
                  **style)  # fmt: skip


def _heading(page: Page, panel: Panel, box: Box, letters: TextMetrics, small: TextMetrics) -> None:
    """Write name and readings above the box, the last reading lowest."""
    count = len(panel.readings)
    name = TextMetrics(letters.size + 0.5, "bold")
    rows = [box.top - 1.2 - small.line * (count - 1 - row) for row in range(count)]
    top = rows[0] if rows else box.top - 1.2
    page.text(box.left, top, panel.name, ha="left", va="baseline", size=name.size,
              color=panel.color, weight="bold")  # fmt: skip
    free = box.width - name.width(panel.name) - 2.0
    for row, reading in zip(rows, panel.readings, strict=True):
        words = small.plain(reading.words)
        wide = small.width(words)
        room = free if row == top else box.width
        shrunk = small.size * min(1.0, room / wide) if wide else small.size
        page.text(box.right, row, words, ha="right", va="baseline", size=shrunk,
                  color=reading.color)  # fmt: skip
