"""The charts of the balance: the Pareto front and the tornado, as Plotly's JSON."""

from __future__ import annotations

from typing import Any

import numpy as np

from paminsa_viz.balancing import OUTPUTS, ParetoFront, Tornado
from paminsa_viz.blocks.balance import bound_name
from paminsa_viz.explorer.features.balance import actions as balancing
from paminsa_viz.explorer.kit.chart import AXIS, LAYOUT, Tree, figure, front_trace, nearest_point
from paminsa_viz.explorer.state.state import State
from paminsa_viz.palette import INK, MUTED, REFERENCE
from paminsa_viz.units import number, symbols_html, unit_text

FRONT = "front"
"""Name of the front's chart in clicks."""

MAX_BARS = 14

ROUNDING = 1e-9
"""Torques at rest below this share of the largest dynamic one are what rounding leaves of none."""

OUTPUT_LABELS = ("imbalance", "peak, static", "RMS, static", "peak, dynamic", "RMS, dynamic")
"""The outputs of the sensitivity on the page, in the order of `OUTPUTS`."""


def shown_front(state: State) -> tuple[ParetoFront, int | None] | None:
    """Return what the front's chart shows, or None."""
    outcome = state.balance.front
    if outcome is None or outcome.result is None or not outcome.result.designs:
        return None
    return outcome.result.front, balancing.chosen_point(state)


def front_figure(front: ParetoFront, chosen: int | None) -> Tree:
    """Return the figure of a Pareto front with the point that is worked on marked."""
    largest = max(front.before[0], *(p.first for p in front.points))

    def at_rest(torque: float) -> float:
        return torque if torque > ROUNDING * largest else 0.0

    x, y = [p.first for p in front.points], [at_rest(p.second) for p in front.points]
    rest = at_rest(front.before[1])
    hover = "dynamic %{x:.4~r} N·m<br>static %{y:.4~r} N·m<extra></extra>"
    before = {
        "type": "scatter", "mode": "markers", "x": [front.before[0]], "y": [rest],
        "name": "design before", "marker": {"size": 11, "color": REFERENCE, "symbol": "x"},
        "hovertemplate": f"before: {hover}",
    }  # fmt: skip
    optimal = front_trace(x, y, chosen, name="optimal masses", hovertemplate=hover)
    # Above the axes: the design before is worse at both, and so at the top right of them.
    legend = LAYOUT["legend"] | {"y": 1.02, "yanchor": "bottom", "orientation": "h"}
    shown = figure(
        [optimal, before], "peak dynamic torque [N·m]", "peak static torque [N·m]", meta=FRONT,
        legend=legend,
    )  # fmt: skip
    # Of a balanced robot all are zero: beside the dynamic torques, not beside each other.
    above = {"rangemode": "tozero"} if any((*y, rest)) else {"range": [0, largest]}
    shown["layout"]["yaxis"] |= above
    return shown


def clicked_point(data: Any, state: State) -> int | None:
    """Return the point of the front that a click means, or None; ``data`` comes from the page."""
    shown = shown_front(state)
    if shown is None:
        return None
    front, _ = shown
    points = np.array([(point.first, point.second) for point in front.points])
    return nearest_point(data, points, front.before)


def shown_tornado(state: State) -> tuple[Tornado, int] | None:
    """Return what the tornado chart shows, or None."""
    outcome = state.balance.tornado
    found = None if outcome is None else outcome.result
    return None if found is None else (found, state.balance.output)


def tornado_figure(tornado: Tornado, output: int) -> Tree:
    """Return the figure of one of `OUTPUTS`, the longest bar on top."""
    bars = tornado.ranked(output)[:MAX_BARS]
    unit = unit_text(OUTPUTS[output][1])
    names = [symbols_html(bound_name(bar.path)) for bar in bars]
    percent = number(100 * tornado.change)
    bases = [float(bar.base[output]) for bar in bars]
    traces = []
    for sign, color in (("+", INK), ("−", MUTED)):
        ends = [float((bar.plus if sign == "+" else bar.minus)[output]) for bar in bars]
        traces.append(
            {
                "type": "bar", "orientation": "h", "name": f"{sign}{percent} %",
                "x": [end - base for end, base in zip(ends, bases, strict=True)],
                "y": names, "base": bases, "marker": {"color": color},
                "customdata": [number(end, 5) for end in ends],
                "hovertemplate": f"%{{y}} {sign}{percent} %: %{{customdata}} {unit}"
                "<extra></extra>",
            }
        )  # fmt: skip
    title = f"{OUTPUT_LABELS[output]} [{unit}]"
    shown = figure(
        traces, title, "", barmode="overlay", bargap=0.3, legend=LAYOUT["legend"] | {"y": 0}
    )
    shown["layout"]["yaxis"] = AXIS | {"autorange": "reversed", "ticks": ""}
    return shown
