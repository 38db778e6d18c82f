"""Charts of the panels that Plotly draws: their looks, their colors in a theme, clicks on them."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple, cast

import numpy as np

from paminsa_viz.explorer.browser.bridge import finite_place
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.kit.entries import Custom, Message
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model.arrays import Array
from paminsa_viz.palette import INK, MUTED, Theme
from paminsa_viz.plots.hover import FONT

FARTHEST_CLICK = 0.15
"""Largest distance of a click from its point, as a part of the front's width and height."""

WRITTEN_OUT = 1e-5, 3e4
"""Steps of an axis whose numbers are written out, without a power of ten."""

AXIS: dict[str, Any] = {
    # Plotly would write 20k and 0.5μ, beside the unit.
    "exponentformat": "power",
    "tickformatstops": [{"dtickrange": list(WRITTEN_OUT), "value": "~f"}],
    "fixedrange": True, "gridcolor": "#e4e8ec", "zerolinecolor": "#b9c1c9", "linecolor": MUTED,
    "ticks": "outside", "tickcolor": MUTED, "automargin": True,
}  # fmt: skip

LAYOUT: dict[str, Any] = {
    "font": {"family": FONT, "size": 12, "color": INK},
    "dragmode": False, "hovermode": "closest", "separators": ".",  # none between thousands
    "margin": {"l": 8, "r": 26, "t": 8, "b": 8}, "showlegend": True,
    "paper_bgcolor": "rgba(0,0,0,0)", "plot_bgcolor": "rgba(0,0,0,0)",
    "legend": {"x": 1, "y": 1, "xanchor": "right", "bgcolor": "rgba(255,255,255,0.7)"},
}  # fmt: skip

LEGEND_ABOVE: dict[str, Any] = {"orientation": "h", "x": 0, "y": 1.02, "yanchor": "bottom"}
"""Place of a legend that would lie over points."""

NUMBERS = ("", "2", "3")
"""Of y axes above each other, as Plotly counts them."""

GAP = 0.06
"""Between two of them, as a part of the height."""

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


class PlotlyChart:
    """A chart that is drawn when there is something to show and nothing is dragged.

    The first one makes viser send Plotly to the page, so it is built only then.
    """

    def __init__(
        self,
        session: Session,
        *,
        shown: Callable[[State], tuple[Any, ...] | None],
        figure: Callable[..., Tree],
        aspect: float,
    ) -> None:
        """Prepare the chart in the current container.

        Args:
            session: The session.
            shown: What it shows, the arguments of ``figure``; None for nothing.
            figure: Makes it.
            aspect: Height over width.
        """
        self._gui = session.client.gui
        self._place = self._gui.add_folder(None)
        self._shown, self._figure, self._aspect = shown, figure, aspect
        self._drawn: tuple[Any, ...] = ()
        self._plot: Any = None

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Draw what changed."""
        if dragging:
            return
        shown, theme = self._shown(frame.state), frame.state.theme
        self._place.visible = shown is not None
        if shown is None or (shown, theme) == self._drawn:
            return
        self._drawn = (shown, theme)
        figure = cast(Any, ChartFigure(themed(self._figure(*shown), theme)))
        if self._plot is not None:
            self._plot.figure = figure
            return
        with self._place:
            self._plot = self._gui.add_plotly(figure, aspect=self._aspect)


def chart(
    key: str,
    shown: Callable[[State], tuple[Any, ...] | None],
    figure: Callable[..., Tree],
    aspect: float,
) -> Custom:
    """Return the entry of a `PlotlyChart`."""
    return Custom(key, make=partial(PlotlyChart, shown=shown, figure=figure, aspect=aspect))


def figure(data: list[Tree], x: str, *y: str, **layout: Any) -> Tree:
    """Return a figure as Plotly's JSON.

    Args:
        data: Its traces.
        x, y: Titles of the axes; several y axes are above each other, the first on top.
        layout: What else of the layout is not as in `LAYOUT`.
    """
    last = NUMBERS[len(y) - 1]
    axes: Tree = {"xaxis": AXIS | {"title": {"text": x}, "anchor": f"y{last}"}}
    for index, (number, title) in enumerate(zip(NUMBERS, y, strict=False)):
        domain = [1 - (index + 1) / len(y) + (GAP if number != last else 0), 1 - index / len(y)]
        axes[f"yaxis{number}"] = AXIS | {"title": {"text": title}, "domain": domain}
    return {"data": data, "layout": LAYOUT | axes | layout, "config": CONFIG}


def front_trace(x: list[float], y: list[float], chosen: int | None, **more: Any) -> Tree:
    """Return the trace of a Pareto front with the chosen point marked."""
    marks = [index == chosen for index in range(len(x))]
    return {
        "type": "scatter", "mode": "lines+markers", "x": x, "y": y, "cliponaxis": False,
        "line": {"color": "#c3cad1", "width": 2},
        "marker": {
            "size": [14 if mark else 9 for mark in marks],
            "color": [INK if mark else MUTED for mark in marks], "opacity": 1,
        },
    } | more  # fmt: skip


def nearest_point(data: Any, points: Array, *others: Any) -> int | None:
    """Return the point that a click means, sent by the page as (x, y) of the chart, or None.

    Args:
        data: What the page sent.
        points: (n, 2) of the chart, one of which can be meant.
        others: What else is in the chart: with the points it spans width and height.
    """
    place = finite_place(data)
    if place is None:
        return None
    span = np.maximum(np.ptp(np.vstack([points, *others]), axis=0), 1e-9)
    distance = np.hypot(*((points - place) / span).T)
    nearest = int(distance.argmin())
    return nearest if distance[nearest] <= FARTHEST_CLICK else None


def chart_clicks(chart: str, key: str, choose: Callable[..., State]) -> Message:
    """Return what dispatches an action whenever a chart is clicked on the page.

    Args:
        chart: The ``meta`` of its layout.
        key: Source of the action.
        choose: The action; its ``data`` comes from the page.
    """

    def click(session: Session, data: Any) -> None:
        if isinstance(data, dict) and data.get("title") == chart:
            session.dispatch(key, partial(choose, data=data))

    return Message("click", receive=click)
