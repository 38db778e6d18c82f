"""One set of axes of a figure over time by matplotlib: curves, levels, failures and notes."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from paminsa_viz.palette import BAD, INK
from paminsa_viz.plots import series_text
from paminsa_viz.plots.formats import POINT
from paminsa_viz.plots.series import (
    SeriesData,
    SeriesPanel,
    Trace,
    largest_size,
    thinned,
)
from paminsa_viz.plots.text import printable
from paminsa_viz.units import DisplayUnit, readable_unit

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
        area.text(0.5, 0.5, "no value: the motion fails from its start", ha="center", va="center",
                  transform=area.transAxes, size=small, color=INK)  # fmt: skip
    area.yaxis.set_major_locator(MaxNLocator(6, steps=[1, 2, 2.5, 5, 10]))
    area.set_ylim(low, high)
    if empty:
        area.set_yticks([])
    area.ticklabel_format(style="plain", useOffset=False)
    area.tick_params(labelsize=body, labelcolor=INK, color=INK, length=2.0, width=0.5, pad=1.5)
    area.set_ylabel(f"{panel.symbol} [{unit.text}]", size=body, color=INK, labelpad=2)
    for spine in area.spines.values():
        spine.set(color=INK, linewidth=0.5)
    line = line_height(small) / POINT
    first = 3.0 + (len(panel.notes) - 1) * line
    area.set_title(panel.name, loc="left", size=body + 0.5, weight="bold",
                   color=panel.color, pad=max(first, 3.0))  # fmt: skip
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
