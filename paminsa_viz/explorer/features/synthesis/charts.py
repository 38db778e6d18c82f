"""The chart of a Pareto front of robots, as Plotly's JSON."""

from __future__ import annotations

from typing import Any

import numpy as np

from paminsa_viz.explorer.kit.chart import Tree, figure, front_trace, nearest_point
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model.arrays import Array
from paminsa_viz.synthesis.search.front import DesignFront
from paminsa_viz.synthesis.search.objectives import find_objective
from paminsa_viz.units import symbols_html

DESIGN_FRONT = "design front"
"""Name of the chart in clicks."""


def shown_front(state: State) -> tuple[DesignFront, int] | None:
    """Return the front that is shown and its chosen point, or None."""
    front = state.synthesis.front
    return None if front is None else (front, state.synthesis.point)


def front_values(front: DesignFront) -> Array:
    """Return the two objectives of all points as they are shown (n, 2)."""
    units = [find_objective(key).display for key in front.objectives[:2]]
    return np.array(
        [
            [unit.from_si(value) for unit, value in zip(units, point.values, strict=False)]
            for point in front.points
        ]
    )


def front_figure(front: DesignFront, chosen: int) -> Tree:
    """Return the figure of a front with the chosen robot marked."""
    x, y = front_values(front).T.tolist()
    titles = []
    for key in front.objectives[:2]:
        objective = find_objective(key)
        unit = f" [{objective.display.text}]" if objective.display.text else ""
        titles.append(symbols_html(objective.label) + unit)
    trace = front_trace(
        x, y, chosen, showlegend=False,
        hovertemplate="%{x:.4~r}<br>%{y:.4~r}<extra></extra>",
    )  # fmt: skip
    return figure([trace], *titles, meta=DESIGN_FRONT)


def clicked_point(data: Any, state: State) -> int | None:
    """Return the robot that a click means, or None; ``data`` comes from the page."""
    shown = shown_front(state)
    return None if shown is None else nearest_point(data, front_values(shown[0]))
