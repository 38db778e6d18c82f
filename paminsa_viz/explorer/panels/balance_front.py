"""The front between moving and standing: computed beside the page, plotted, gone along."""

from __future__ import annotations

import json
from typing import Any, cast

import numpy as np

from paminsa_viz.explorer.balancing import requests
from paminsa_viz.explorer.balancing.jobs import Outcome, Task
from paminsa_viz.explorer.browser.bridge import Bridge
from paminsa_viz.explorer.controls import Control
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.panels.balance_charts import AXIS, CONFIG, LAYOUT
from paminsa_viz.explorer.panels.balance_words import problem_html
from paminsa_viz.explorer.panels.tables import note
from paminsa_viz.explorer.panels.validation import number
from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.state import State
from paminsa_viz.palette import INK, MUTED, REFERENCE

NAME = "front"
"""What the plot calls itself when it is clicked."""

FARTHEST_CLICK = 0.15
"""Largest distance of a click from its point, as a part of the front's width and height."""


class FrontPlot:
    """Button, progress, plot, and a slider along the points, in the current container."""

    def __init__(self, session: Session, bridge: Bridge) -> None:
        gui = session.client.gui
        self._session, self._gui = session, gui
        self._words = gui.add_html("")
        self.run = gui.add_button("Compute the front")
        self._bar = gui.add_progress_bar(0.0, visible=False, animated=True)
        self.stop = gui.add_button("Stop", color="gray", visible=False)
        self._place = gui.add_folder(None, visible=False)
        self._plot: Any = None
        self._drawn: object = None
        with self._place:
            self.slider = gui.add_slider(
                "Point", 1, 2, 1, 1, hint="Works on a point of the front; undo goes back"
            )
        self._control = Control(
            session, self.slider, "balance.point",
            lambda s, value: requests.choose_point(s, int(value) - 1), self._shown,
        )  # fmt: skip
        self.run.on_click(
            lambda _: session.dispatch("balance.front", lambda s: requests.begin(s, Task.FRONT))
        )
        self.stop.on_click(lambda _: session.dispatch("balance.stop", requests.stop))
        bridge.on("click", self._click)

    def _shown(self, state: State) -> int:
        chosen = requests.chosen_point(state)
        return int(self.slider.value) if chosen is None else chosen + 1

    def _click(self, data: Any) -> None:
        """Work on the point that was clicked; ``data`` comes from the page."""

        def choose(state: State) -> State:
            index = clicked_point(data, state.balancing.front)
            return state if index is None else requests.choose_point(state, index)

        if isinstance(data, dict) and data.get("title") == NAME:
            self._session.dispatch("balance.point", choose)

    def draw(self, frame: Frame, moving: bool) -> None:
        """Follow the state."""
        state = frame.state
        balancing = state.balancing
        outcome, running = balancing.front, balancing.running
        busy = running is not None and running.task is Task.FRONT
        there = outcome is not None and bool(outcome.designs)
        for handle, visible in (
            (self.run, not busy), (self._bar, busy), (self.stop, busy), (self._place, there),
        ):  # fmt: skip
            if handle.visible != visible:
                handle.visible = visible
        if self._bar.value != 100 * balancing.done:
            self._bar.value = 100 * balancing.done
        text = words(outcome)
        if self._words.content != text:
            self._words.content = text
        if outcome is None or not outcome.designs:
            return
        count = max(len(outcome.designs), 2)
        if self.slider.max != count:
            self.slider.max = count
        self._control.draw(frame, moving)
        chosen = requests.chosen_point(state)
        if not moving and (self._drawn is None or self._drawn != (outcome, chosen)):
            self._drawn = (outcome, chosen)
            self._show(FrontFigure(outcome, chosen))

    def _show(self, figure: FrontFigure) -> None:
        if self._plot is None:
            with self._place:
                above = self.slider.order - 0.5
                self._plot = self._gui.add_plotly(cast(Any, figure), aspect=0.82, order=above)
        else:
            self._plot.figure = cast(Any, figure)


def words(outcome: Outcome | None) -> str:
    """Say what the front is, or why there is none."""
    if outcome is not None and outcome.problem is not None:
        return problem_html(outcome.problem)
    text = (
        "Masses that balance the robot make it heavier to move. Each point is the best there is: "
        "no masses within the bounds above have both peaks lower."
    )
    if outcome is not None and len(outcome.designs) == 1:
        text += " Here one design is best at both."
    elif outcome is not None:
        text += " Click a point to work on that design."
    return note(text, "front", muted=True)


def clicked_point(data: Any, outcome: Outcome | None) -> int | None:
    """Return the point that a click means, sent by the page as (x, y) of the plot, or None."""
    if outcome is None or outcome.front is None or not isinstance(data, dict):
        return None
    x, y = number(data.get("x")), number(data.get("y"))
    if x is None or y is None:
        return None
    points = np.array([[p.first, p.second] for p in outcome.front.points])
    span = np.maximum(np.ptp(np.vstack([points, outcome.front.before]), axis=0), 1e-9)
    distance = np.hypot(*((points - [x, y]) / span).T)
    nearest = int(distance.argmin())
    return nearest if distance[nearest] <= FARTHEST_CLICK else None


class FrontFigure:
    """A front as viser wants a figure: it asks for the JSON and nothing else."""

    def __init__(self, outcome: Outcome, chosen: int | None) -> None:
        """Prepare the figure, with one of the points marked."""
        front = outcome.front
        if front is None:
            raise ValueError("there is no front")
        x, y = ([getattr(p, name) for p in front.points] for name in ("first", "second"))
        sizes = [14 if index == chosen else 9 for index in range(len(x))]
        colors = [INK if index == chosen else MUTED for index in range(len(x))]
        hover = "in motion %{x:.4~g} N·m<br>standing %{y:.4~g} N·m<extra></extra>"
        self._tree = {
            "data": [
                {
                    "type": "scatter", "mode": "lines+markers", "x": x, "y": y,
                    "line": {"color": "#c3cad1", "width": 2},
                    "marker": {"size": sizes, "color": colors, "opacity": 1},
                    "hovertemplate": hover, "name": "best masses", "cliponaxis": False,
                },
                {
                    "type": "scatter", "mode": "markers", "x": [front.before[0]],
                    "y": [front.before[1]], "name": "design before",
                    "marker": {"size": 11, "color": REFERENCE, "symbol": "x"},
                    "hovertemplate": f"before: {hover}",
                },
            ],
            "layout": LAYOUT | {
                "meta": NAME,
                "xaxis": AXIS | {"title": {"text": "peak torque in motion [N·m]"}},
                "yaxis": AXIS | {
                    "title": {"text": "peak torque standing [N·m]"}, "rangemode": "tozero"
                },
            },
            "config": CONFIG,
        }  # fmt: skip

    def to_json(self) -> str:
        """Return the figure as Plotly's JSON."""
        return json.dumps(self._tree)
