"""Charts as uPlot takes them: few samples, gaps where there is no value, failures shaded.

uPlot draws straight on over a NaN and cannot find the range of an axis that has one. So a curve
is handed over in pieces, one for each run of values, and two series of our own say how far the
axis goes and where the motion fails.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.explorer.motion.traces import Chart, Trace, Values
from paminsa_viz.palette import BAD, MUTED

MOST_POINTS = 480
"""About how many samples of a curve are handed to the page."""

MOST_PIECES = 6
"""Runs of values of a curve that are drawn; there are more only in a motion that fails often."""

_OWN = 2
"""Series before the curves: the range of the axis, and failures."""

_SHADE = f"{BAD}26"

_MARK = {"show": True, "size": 5, "width": 1, "fill": "#ffffff"}


class Layout(NamedTuple):
    """What a chart on the page is made for; data of another layout need another chart.

    Attributes:
        title: Heading.
        strokes: Color, dash and width of each curve, and whether it is one of marks.
        pieces: Pieces of each curve.
    """

    title: str
    strokes: tuple[tuple[str, tuple[int, ...], bool, bool], ...]
    pieces: int


def layout(chart: Chart, pieces: int = 1) -> Layout:
    """Return the layout of a chart with at least so many pieces a curve."""
    lines = [trace for trace in chart.traces if not trace.marks]
    needed = max((len(runs(trace.values)) for trace in lines), default=1)
    strokes = tuple((t.color, t.dash, t.wide, t.marks) for t in chart.traces)
    return Layout(chart.title, strokes, min(max(needed, pieces), MOST_PIECES))


def runs(values: Values) -> list[slice]:
    """Return where values (n,) are without a NaN, as slices."""
    known = np.concatenate([[False], ~np.isnan(values), [False]])
    edges = np.flatnonzero(np.diff(known))
    return [slice(int(a), int(b)) for a, b in edges.reshape(-1, 2)]


def thinned(chart: Chart) -> NDArray[np.intp]:
    """Return which samples are shown: evenly spread, all peaks and ends of runs, all marks."""
    n = chart.t.size
    if n <= MOST_POINTS:
        return np.arange(n)
    chosen = [np.linspace(0, n - 1, MOST_POINTS).round().astype(np.intp)]
    for trace in chart.traces:
        if trace.marks:
            chosen.append(np.flatnonzero(~np.isnan(trace.values)))
            continue
        pieces = runs(trace.values)[:MOST_PIECES]
        for piece in pieces:
            part = trace.values[piece]
            ends = (0, part.size - 1, int(part.argmin()), int(part.argmax()))
            chosen.append(piece.start + np.array(ends, dtype=np.intp))
    return np.unique(np.concatenate(chosen))


def data(chart: Chart, pieces: int) -> tuple[Values, ...]:
    """Return the series: time, range of the axis, failures, then every piece of every curve."""
    index = thinned(chart)
    low, high = bounds(chart.traces)
    span = np.full(index.size, low)
    span[-1] = high
    found = [chart.t[index], span, chart.failing[index].astype(np.float64)]
    for trace in chart.traces:
        found += _pieces(trace, index, pieces)
    return tuple(found)


def _pieces(trace: Trace, index: NDArray[np.intp], pieces: int) -> list[Values]:
    shown = trace.values[index]
    if trace.marks:
        return [shown] + [np.full(index.size, np.nan)] * (pieces - 1)
    found = runs(trace.values)
    if len(found) <= 1 and pieces == 1:
        return [shown]
    parts = []
    for number in range(pieces):
        part = np.full(index.size, np.nan)
        if number < len(found):
            inside = (index >= found[number].start) & (index < found[number].stop)
            part[inside] = shown[inside]
        parts.append(part)
    return parts


def bounds(traces: tuple[Trace, ...]) -> tuple[float, float]:
    """Return the lowest and the highest value of all curves, apart by at least a little."""
    known = [trace.values[np.isfinite(trace.values)] for trace in traces]
    filled = [values for values in known if values.size]
    if not filled:
        return 0.0, 1.0
    low = float(min(values.min() for values in filled))
    high = float(max(values.max() for values in filled))
    # Rounding alone is no curve, and uPlot writes three decimals.
    least = max(1e-6 * max(abs(low), abs(high)), 2e-3)
    return (low, high) if high - low > least else (low - least, high + least)


def options(shape: Layout) -> dict[str, Any]:
    """Return the arguments of ``gui.add_uplot`` beside data and size."""
    hidden = {"stroke": "transparent", "width": 0, "points": {"show": False}}
    series: list[dict[str, Any]] = [
        {},
        hidden | {"auto": True},
        hidden | {"scale": "failing", "fill": _SHADE},
    ]
    for color, dash, wide, marks in shape.strokes:
        line = {
            "stroke": color, "width": 1.8 if wide else 1.2, "dash": dash, "auto": False,
            "points": {"show": False},
        }  # fmt: skip
        if marks:
            line |= {"stroke": "transparent", "width": 0, "points": _MARK | {"stroke": color}}
        series += [line] * shape.pieces
    axis = {"stroke": MUTED, "ticks": {"show": False}, "font": "11px sans-serif", "gap": 3}
    return {
        "series": tuple(series),
        "title": shape.title,
        "scales": {"x": {"time": False}, "failing": {"range": (0.0, 1.0)}},
        "axes": (
            axis
            | {
                "size": 20,
                "label": "t [s]",
                "labelSize": 13,
                "labelGap": -2,
                "labelFont": "11px sans-serif",
            },
            axis | {"size": 44, "space": 26},
        ),
        "legend": {"show": False},
        "cursor": {"y": False, "points": {"show": False}, "sync": {"key": "paminsa"}},
        "padding": (8, 10, 0, 0),
    }


def curve(series: tuple[Values, ...], shape: Layout, number: int) -> Values:
    """Return one curve (n,) out of series that `data` made, its pieces put together."""
    first = 1 + _OWN + number * shape.pieces
    parts = np.array(series[first : first + shape.pieces])
    known = ~np.isnan(parts)
    return np.where(known.any(axis=0), np.where(known, parts, 0.0).sum(axis=0), np.nan)
