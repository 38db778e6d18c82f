"""The chart of a Pareto front of robots, as Plotly's JSON."""

from __future__ import annotations

from collections.abc import Hashable
from typing import Any

import numpy as np

from paminsa_viz.explorer.inputs import finite
from paminsa_viz.explorer.panels.balance_charts import (
    AXIS,
    CONFIG,
    FARTHEST_CLICK,
    LAYOUT,
    Tree,
)
from paminsa_viz.explorer.state import State
from paminsa_viz.model.arrays import Array
from paminsa_viz.palette import INK, MUTED
from paminsa_viz.synthesis.search.front import DesignFront
from paminsa_viz.synthesis.search.objectives import find_objective
from paminsa_viz.units import symbols_html

DESIGN_FRONT = "design front"
"""Name of the chart in clicks."""


def front_of(state: State) -> DesignFront | None:
    """Return the front that is shown, or None."""
    return None if state.synthesizing.running else state.synthesizing.front


def front_key(state: State) -> Hashable | None:
    """Return what the chart shows, or None."""
    front = front_of(state)
    return None if front is None else (front, state.synthesizing.point)


def front_values(front: DesignFront) -> Array:
    """Return the two objectives of all points as they are shown (n, 2)."""
    units = [find_objective(key).display for key in front.objectives[:2]]
    return np.array(
        [
            [unit.from_si(value) for unit, value in zip(units, point.values, strict=False)]
            for point in front.points
        ]
    )


def front_figure(state: State) -> Tree:
    """Return the figure of the front with the chosen robot marked."""
    front = front_of(state)
    if front is None:
        raise ValueError("there is no front")
    chosen = state.synthesizing.point
    x, y = front_values(front).T.tolist()
    titles = []
    for key in front.objectives[:2]:
        objective = find_objective(key)
        unit = f" [{objective.display.text}]" if objective.display.text else ""
        titles.append(symbols_html(objective.label) + unit)
    sizes = [14 if index == chosen else 9 for index in range(len(x))]
    colors = [INK if index == chosen else MUTED for index in range(len(x))]
    return {
        "data": [
            {
                "type": "scatter", "mode": "lines+markers", "x": x, "y": y, "showlegend": False,
                "line": {"color": "#c3cad1", "width": 2, "shape": "linear"},
                "marker": {"size": sizes, "color": colors, "opacity": 1},
                "hovertemplate": "%{x:.4~g}<br>%{y:.4~g}<extra></extra>", "cliponaxis": False,
            },
        ],
        "layout": LAYOUT | {
            "meta": DESIGN_FRONT,
            "xaxis": AXIS | {"title": {"text": titles[0]}},
            "yaxis": AXIS | {"title": {"text": titles[1]}},
        },
        "config": CONFIG,
    }  # fmt: skip


def clicked_point(data: Any, state: State) -> int | None:
    """Return the robot that a click means, sent by the page as (x, y) of the chart, or None."""
    front = front_of(state)
    if front is None or not isinstance(data, dict):
        return None
    x, y = finite(data.get("x")), finite(data.get("y"))
    if x is None or y is None:
        return None
    points = front_values(front)
    span = np.maximum(np.ptp(points, axis=0), 1e-9)
    distance = np.hypot(*((points - [x, y]) / span).T)
    nearest = int(distance.argmin())
    return nearest if distance[nearest] <= FARTHEST_CLICK else None
