"""The chart of a Pareto front of robots, as Plotly's JSON."""

from __future__ import annotations

from collections.abc import Hashable
from typing import Any

import numpy as np

from paminsa_viz.explorer.panels.plotly_chart import Tree, figure, front_trace, nearest_point
from paminsa_viz.explorer.state import State
from paminsa_viz.model.arrays import Array
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
    x, y = front_values(front).T.tolist()
    titles = []
    for key in front.objectives[:2]:
        objective = find_objective(key)
        unit = f" [{objective.display.text}]" if objective.display.text else ""
        titles.append(symbols_html(objective.label) + unit)
    trace = front_trace(
        x, y, state.synthesizing.point, showlegend=False,
        hovertemplate="%{x:.4~g}<br>%{y:.4~g}<extra></extra>",
    )  # fmt: skip
    return figure([trace], *titles, meta=DESIGN_FRONT)


def clicked_point(data: Any, state: State) -> int | None:
    """Return the robot that a click means, or None; ``data`` comes from the page."""
    front = front_of(state)
    return None if front is None else nearest_point(data, front_values(front))
