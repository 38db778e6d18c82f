"""The charts of the balance: the Pareto front and the tornado, as Plotly's JSON."""

from __future__ import annotations

import json
from collections.abc import Callable, Hashable
from typing import Any, NamedTuple, cast

import numpy as np

from paminsa_viz.balancing import OUTPUTS
from paminsa_viz.explorer.balancing import actions as balancing
from paminsa_viz.explorer.balancing.jobs import BalanceJob, MassFront
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.inputs import finite
from paminsa_viz.explorer.panels.balance_text import variable_html
from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.state import State
from paminsa_viz.explorer.tasks import Outcome
from paminsa_viz.palette import INK, MUTED, REFERENCE, Theme
from paminsa_viz.plots.hover import FONT
from paminsa_viz.units import number, symbols_html, unit_text

FRONT = "front"
"""Name of the front's chart in clicks."""

FARTHEST_CLICK = 0.15
"""Largest distance of a click from its point, as a part of the front's width and height."""

MAX_BARS = 14

OUTPUT_LABELS = ("M_p2", "peak, static", "RMS, static", "peak, dynamic", "RMS, dynamic")
"""The outputs of the sensitivity on the page, in the order of `OUTPUTS`."""

AXIS: dict[str, Any] = {
    "fixedrange": True, "gridcolor": "#e4e8ec", "zerolinecolor": "#b9c1c9", "linecolor": MUTED,
    "ticks": "outside", "tickcolor": MUTED, "automargin": True,
}  # fmt: skip

LAYOUT: dict[str, Any] = {
    "font": {"family": FONT, "size": 12, "color": INK},
    "dragmode": False, "hovermode": "closest",
    "margin": {"l": 8, "r": 26, "t": 8, "b": 8}, "showlegend": True,
    "paper_bgcolor": "rgba(0,0,0,0)", "plot_bgcolor": "rgba(0,0,0,0)",
    "legend": {"x": 1, "y": 1, "xanchor": "right", "bgcolor": "rgba(255,255,255,0.7)"},
}  # fmt: skip

CONFIG = {"displayModeBar": False, "doubleClick": False}

Tree = dict[str, Any]


def themed(tree: Any, theme: Theme) -> Any:
    """Return a part of a figure with its colors as the theme has them."""
    if isinstance(tree, dict):
        return {key: themed(value, theme) for key, value in tree.items()}
    if isinstance(tree, list):
        return [themed(value, theme) for value in tree]
    if not isinstance(tree, str) or not tree.startswith(("#", "rgba(255")):
        return tree
    ground = {
        "#e4e8ec": theme.faint, "#b9c1c9": theme.muted, "#c3cad1": theme.muted,
        "rgba(255,255,255,0.7)": f"{theme.paper}b3",
    }  # fmt: skip
    return theme.shown(ground.get(tree, tree))


class ChartFigure(NamedTuple):
    """A figure as viser takes it, of which it needs only the JSON."""

    tree: Tree

    def to_json(self) -> str:
        """Return the figure as Plotly's JSON."""
        return json.dumps(self.tree)


class BalanceChart:
    """A chart that is drawn when there is something to show and nothing is dragged.

    The first one makes viser send Plotly to the page, so it is built only then.
    """

    def __init__(
        self,
        session: Session,
        *,
        key: Callable[[State], Hashable | None],
        figure: Callable[[State], Tree],
        aspect: float,
    ) -> None:
        """Prepare the chart in the current container.

        Args:
            session: The session.
            key: What it shows; None for nothing.
            figure: Makes it.
            aspect: Width over height.
        """
        self._gui = session.client.gui
        self._place = self._gui.add_folder(None)
        self._key, self._figure, self._aspect = key, figure, aspect
        self._drawn: Hashable | None = None
        self._plot: Any = None

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Draw what changed."""
        key = self._key(frame.state)
        theme = frame.state.theme
        if dragging or key is None or (key, theme) == self._drawn:
            return
        self._drawn = (key, theme)
        figure = cast(Any, ChartFigure(themed(self._figure(frame.state), theme)))
        if self._plot is not None:
            self._plot.figure = figure
            return
        with self._place:
            self._plot = self._gui.add_plotly(figure, aspect=self._aspect)


def front_key(state: State) -> Hashable | None:
    """Return what the front's chart shows, or None."""
    if not state.balancing.points:
        return None
    return state.balancing.front, balancing.chosen_point(state)


def front_figure(state: State) -> Tree:
    """Return the figure of the Pareto front with the point that is worked on marked."""
    outcome, chosen = state.balancing.front, balancing.chosen_point(state)
    if outcome is None or outcome.result is None:
        raise ValueError("there is no front")
    front = outcome.result.front
    x, y = ([getattr(p, name) for p in front.points] for name in ("first", "second"))
    sizes = [14 if index == chosen else 9 for index in range(len(x))]
    colors = [INK if index == chosen else MUTED for index in range(len(x))]
    hover = "dynamic %{x:.4~g} N·m<br>static %{y:.4~g} N·m<extra></extra>"
    return {
        "data": [
            {
                "type": "scatter", "mode": "lines+markers", "x": x, "y": y,
                "line": {"color": "#c3cad1", "width": 2},
                "marker": {"size": sizes, "color": colors, "opacity": 1},
                "hovertemplate": hover, "name": "optimal masses", "cliponaxis": False,
            },
            {
                "type": "scatter", "mode": "markers", "x": [front.before[0]],
                "y": [front.before[1]], "name": "design before",
                "marker": {"size": 11, "color": REFERENCE, "symbol": "x"},
                "hovertemplate": f"before: {hover}",
            },
        ],
        "layout": LAYOUT | {
            "meta": FRONT,
            "xaxis": AXIS | {"title": {"text": "peak dynamic torque [N·m]"}},
            "yaxis": AXIS | {"title": {"text": "peak static torque [N·m]"}, "rangemode": "tozero"},
        },
        "config": CONFIG,
    }  # fmt: skip


def clicked_point(data: Any, outcome: Outcome[BalanceJob, MassFront] | None) -> int | None:
    """Return the point that a click means, sent by the page as (x, y) of the chart, or None."""
    if outcome is None or outcome.result is None or not isinstance(data, dict):
        return None
    front = outcome.result.front
    x, y = finite(data.get("x")), finite(data.get("y"))
    if x is None or y is None:
        return None
    points = np.array([[p.first, p.second] for p in front.points])
    span = np.maximum(np.ptp(np.vstack([points, front.before]), axis=0), 1e-9)
    distance = np.hypot(*((points - [x, y]) / span).T)
    nearest = int(distance.argmin())
    return nearest if distance[nearest] <= FARTHEST_CLICK else None


def tornado_key(state: State) -> Hashable | None:
    """Return what the tornado chart shows, or None."""
    outcome = state.balancing.tornado
    return None if outcome is None or outcome.result is None else (outcome, state.balancing.output)


def tornado_figure(state: State) -> Tree:
    """Return the figure of the chosen one of `OUTPUTS`, the longest bar on top."""
    outcome, output = state.balancing.tornado, state.balancing.output
    if outcome is None or outcome.result is None:
        raise ValueError("there is no sensitivity")
    tornado = outcome.result
    bars = tornado.ranked(output)[:MAX_BARS]
    unit = unit_text(OUTPUTS[output][1])
    names = [variable_html(bar.path) for bar in bars]
    percent = number(100 * tornado.change)
    bases = [float(bar.base[output]) for bar in bars]
    traces = []
    for sign, color in (("+", INK), ("−", MUTED)):
        ends = [float((bar.plus if sign == "+" else bar.minus)[output]) for bar in bars]
        traces.append(
            {
                "type": "bar", "orientation": "h", "name": f"{sign}{percent} %",
                "x": [end - base for end, base in zip(ends, bases, strict=True)],
                "y": names, "base": bases, "marker": {"color": color}, "customdata": ends,
                "hovertemplate": f"%{{y}} {sign}{percent} %: %{{customdata:.5~g}} {unit}"
                "<extra></extra>",
            }
        )  # fmt: skip
    title = f"{symbols_html(OUTPUT_LABELS[output])} [{unit}]"
    return {
        "data": traces,
        "layout": LAYOUT | {
            "barmode": "overlay", "bargap": 0.3, "legend": LAYOUT["legend"] | {"y": 0},
            "xaxis": AXIS | {"title": {"text": title}},
            "yaxis": AXIS | {"autorange": "reversed", "ticks": ""},
        },
        "config": CONFIG,
    }  # fmt: skip
