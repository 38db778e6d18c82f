"""Series for the page: panels that share a chart, and charts as uPlot takes them.

uPlot draws straight on over a NaN and cannot find the range of an axis that has one. So a curve
is handed over in pieces, one for each run of values, and two more series give the range of the
axis and the times at which the motion fails.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.model import APPENDIX_4, Design, lift_constant
from paminsa_viz.model.resizing import length_ratio
from paminsa_viz.palette import BAD, LIGHT, Theme
from paminsa_viz.plots.series import (
    Dash,
    SeriesData,
    SeriesKind,
    SeriesPanel,
    Trace,
    Values,
    largest_size,
    runs,
    thinned,
)
from paminsa_viz.units import display_unit, readable_unit

MOST_POINTS = 480
"""About how many samples of a curve are handed to the page."""

MOST_PIECES = 6
"""Runs of values of a curve that are drawn; there are more only in a motion that fails often."""

_SHADE = f"{BAD}26"
_MARK = {"show": True, "size": 5, "width": 1}
_DASHES: dict[Dash, tuple[int, ...]] = {
    "solid": (), "dashed": (6, 4), "dotted": (2, 3), "dashdot": (8, 3, 2, 3)
}  # fmt: skip

_TURNING, _LIFTING = (0, 1, 2), (3,)
_PLACE, _ANGLE = (0, 1, 3), (2,)
_CHARTS: dict[SeriesKind, tuple[tuple[str, tuple[int, ...]], ...]] = {
    "torques": (("Torques", _TURNING), ("Force F₄", _LIFTING)),
    "commands": (("Commanded torques", _TURNING), ("Commanded force F₄", _LIFTING)),
    "differences": (("Torques, formulas − {}", _TURNING), ("Force F₄, formulas − {}", _LIFTING)),
    "power": (("Power of M1–M3", _TURNING), ("Power of M4", _LIFTING)),
    "energy": (("Work of M1–M3", _TURNING), ("Work of M4, and the robot’s energy", (3, 4, 5))),
    "loads": (("Force at joint 2", (0,)), ("Largest bending moment", (4,))),
    "clearance": (("Least clearance", (0,)), ("Clearance by pairs of bodies", (1,))),
    "pose": (("Position", _PLACE), ("Angle θ", _ANGLE)),
    "speed": (("Speed", _PLACE), ("Angular speed", _ANGLE)),
    "acceleration": (("Acceleration", _PLACE), ("Angular acceleration", _ANGLE)),
    "errors": (("Error of x, y, z", _PLACE), ("Error of θ", _ANGLE)),
}
"""Heading and panels of the charts of each kind; those of a breakdown depend on the actuator."""

_SMALL: dict[SeriesKind, int] = {"differences": -30, "errors": -3}
"""What is shown in a fraction of its unit however small it is, and its lowest power of ten."""

_LEAST = 1e-6
"""What else is shown in a fraction of its unit has a largest value of this, as the torques of a
robot of a tenth of the lengths have; those of a balanced robot are rounding below it. It is less
in a robot that is lighter and smaller still."""


@dataclass(frozen=True, eq=False)
class Chart:
    """Curves over one axis of time.

    Attributes:
        title: Title, with the unit.
        unit: The unit.
        t: (n,) [s].
        traces: The curves, in that unit.
        failing: (n,) where the motion fails.
    """

    title: str
    unit: str
    t: Values
    traces: tuple[Trace, ...]
    failing: NDArray[np.bool_]

    def value_at(self, trace: Trace, time: float) -> float:
        """Return a curve at a time [s], linear between samples; NaN where there is none."""
        return float(np.interp(time, self.t, trace.values, left=np.nan, right=np.nan))


def charts(data: SeriesData, actuator: int = 0) -> tuple[Chart, ...]:
    """Return the charts of some series.

    Args:
        data: The series.
        actuator: Index of the actuator whose breakdown is drawn.
    """
    if data.kind == "breakdown":
        what = "Torque" if actuator < 3 else "Force"
        found = ((f"{what} of M{actuator + 1} by cause", (actuator,)),)
    else:
        found = _CHARTS[data.kind]
    return tuple(
        _chart(data, title, tuple(data.panels[index] for index in indices))
        for title, indices in found
    )


def _chart(data: SeriesData, title: str, panels: tuple[SeriesPanel, ...]) -> Chart:
    traces = [(panel, trace) for panel in panels for trace in panel.traces]
    traces.sort(key=lambda item: trace_order(item[1]))
    unit = display_unit(panels[0].unit)
    largest = largest_size([trace for _, trace in traces])
    if data.kind in _SMALL or unit.factor * largest >= _least(data.sources.analysis.design):
        unit = readable_unit(panels[0].unit, largest, lowest=_SMALL.get(data.kind, -30))
    if data.sources.engine is not None:
        title = title.format(data.sources.engine.name)
    drawn = tuple(
        replace(
            trace, label=_label(panel, trace), color=_color(panel, trace),
            values=unit.factor * trace.values,
        )
        for panel, trace in traces
    )  # fmt: skip
    return Chart(f"{title} [{unit.text}]", unit.text, data.time, drawn, data.failing)


def _least(design: Design) -> float:
    """Return `_LEAST` for a robot: its torques are in proportion to its weight and its lengths."""
    weight = lift_constant(design) / lift_constant(APPENDIX_4)
    share = 1e4 * weight * length_ratio(design.geometry)  # 1 at a tenth of the lengths
    return _LEAST * min(max(share, 0.0) or 1.0, 1.0)


def trace_order(trace: Trace) -> int:
    """Return the place of a trace among others: the design's before those it is compared with."""
    return 3 if trace.marks else ("", "reference", "as published").index(trace.suffix or "")


def _label(panel: SeriesPanel, trace: Trace) -> str:
    return trace.label if trace.suffix is None else f"{panel.source} {trace.suffix}".strip()


def _color(panel: SeriesPanel, trace: Trace) -> str:
    """Return the color of a trace next to those of other panels."""
    if trace.suffix is None or trace.marks:
        return trace.color
    return panel.color


class ChartShape(NamedTuple):
    """The structure of a chart on the page; data of another shape need another chart.

    Attributes:
        title: Heading.
        strokes: Color, dash and width of each curve, and whether it is one of marks.
        pieces: Pieces of each curve.
        theme: Colors of the page.
    """

    title: str
    strokes: tuple[tuple[str, Dash, float, bool], ...]
    pieces: int
    theme: Theme = LIGHT


def chart_shape(chart: Chart, pieces: int = 1, theme: Theme = LIGHT) -> ChartShape:
    """Return the shape of a chart with at least so many pieces a curve."""
    lines = [trace for trace in chart.traces if not trace.marks]
    needed = max((len(runs(trace.values)) for trace in lines), default=1)
    strokes: tuple[tuple[str, Dash, float, bool], ...] = tuple(
        (theme.shown(t.color), t.dash, t.width, t.marks) for t in chart.traces
    )
    return ChartShape(chart.title, strokes, min(max(needed, pieces), MOST_PIECES), theme)


def uplot_data(chart: Chart, pieces: int) -> tuple[Values, ...]:
    """Return the series: time, range of the axis, failures, then every piece of every curve."""
    index = _shown_samples(chart)
    low, high = bounds(chart.traces)
    # In turns, so that a piece of the time has the whole range as well.
    span = np.where(np.arange(index.size) % 2, high, low)
    found = [chart.t[index], span, chart.failing[index].astype(np.float64)]
    for trace in chart.traces:
        found += _pieces(trace, index, pieces)
    return tuple(found)


def _shown_samples(chart: Chart) -> NDArray[np.intp]:
    """Return which samples are shown: those that draw the curves, and all marks."""
    lines = [trace.values for trace in chart.traces if not trace.marks]
    marks = [np.flatnonzero(~np.isnan(t.values)) for t in chart.traces if t.marks]
    return np.unique(np.concatenate([thinned(lines, MOST_POINTS), *marks]))


def _pieces(trace: Trace, index: NDArray[np.intp], pieces: int) -> list[Values]:
    found = [slice(0, trace.values.size)] if trace.marks else runs(trace.values)
    parts = []
    for number in range(pieces):
        part = np.full(index.size, np.nan)
        if number < len(found):
            inside = (index >= found[number].start) & (index < found[number].stop)
            part[inside] = trace.values[index[inside]]
        parts.append(part)
    return parts


def bounds(traces: tuple[Trace, ...]) -> tuple[float, float]:
    """Return the lowest and the highest value of all curves, apart by at least a little."""
    known = np.concatenate([trace.values[np.isfinite(trace.values)] for trace in traces])
    if not known.size:
        return 0.0, 1.0
    low, high = float(known.min()), float(known.max())
    # Rounding alone is no curve, and uPlot writes three decimals.
    least = max(1e-6 * max(abs(low), abs(high)), 2e-3)
    return (low, high) if high - low > least else (low - least, high + least)


def uplot_options(shape: ChartShape) -> dict[str, Any]:
    """Return the arguments of ``gui.add_uplot`` other than data and size."""
    theme = shape.theme
    mark = _MARK | {"fill": theme.paper}
    hidden = {"stroke": "transparent", "width": 0, "points": {"show": False}}
    series: list[dict[str, Any]] = [
        {},
        hidden | {"auto": True},
        hidden | {"scale": "failing", "fill": _SHADE},
    ]
    for color, dash, width, marks in shape.strokes:
        line = {
            "stroke": color, "width": 1.8 if width > 1 else 1.2, "dash": _DASHES[dash],
            "auto": False, "points": {"show": False},
        }  # fmt: skip
        if marks:
            line |= {"stroke": "transparent", "width": 0, "points": mark | {"stroke": color}}
        series += [line] * shape.pieces
    axis = {
        "stroke": theme.muted, "ticks": {"show": False}, "font": "11px sans-serif", "gap": 3,
        "grid": {"stroke": theme.faint, "width": 1},
    }  # fmt: skip
    time_axis = {"size": 20, "label": "t [s]", "labelSize": 13, "labelGap": -2}
    return {
        "series": tuple(series),
        "title": shape.title,
        "scales": {"x": {"time": False}, "failing": {"range": (0.0, 1.0)}},
        "axes": (
            axis | time_axis | {"labelFont": "11px sans-serif"},
            axis | {"size": 44, "space": 26},
        ),
        "legend": {"show": False},
        "cursor": {"y": False, "points": {"show": False}, "sync": {"key": "paminsa"}},
        "padding": (8, 10, 0, 0),
    }
