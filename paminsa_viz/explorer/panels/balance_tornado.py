"""What each mass and each length matters: a tornado chart, computed beside the page."""

from __future__ import annotations

import json
from typing import Any, cast

from paminsa_viz.balancing import OUTPUTS, Tornado
from paminsa_viz.explorer.balancing import requests
from paminsa_viz.explorer.balancing.jobs import Task
from paminsa_viz.explorer.balancing.settings import RANGES
from paminsa_viz.explorer.controls import Control
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.panels.balance_charts import AXIS, CONFIG, LAYOUT
from paminsa_viz.explorer.panels.balance_words import block, carrier, problem_html
from paminsa_viz.explorer.panels.debounced_input import DebouncedInput
from paminsa_viz.explorer.panels.tables import note
from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.state import State
from paminsa_viz.palette import INK, MUTED
from paminsa_viz.units import number, symbol_html, unit_text

MOST_BARS = 14

NAMES = ("M_p2", "peak, standing", "RMS, standing", "peak, in motion", "RMS, in motion")
"""The outputs on the page, in the order of `OUTPUTS`."""


class TornadoPlot:
    """Button, choice of the output, and the chart, in the current container."""

    def __init__(self, session: Session) -> None:
        gui = session.client.gui
        self._gui = gui
        settings, output = session.state.balancing.settings, session.state.balancing.output
        self._words = gui.add_html("")
        change = gui.add_number(
            "Each by ± [%]", 100 * settings.change, min=100 * RANGES["change"][0],
            max=100 * RANGES["change"][1], step=0.1, hint="Every mass and length, one at a time",
        )  # fmt: skip
        self.run = gui.add_button("See what matters")
        self._place = gui.add_folder(None, visible=False)
        with self._place:
            choice = gui.add_dropdown("Shown", NAMES, initial_value=NAMES[output])
        self._plot: Any = None
        self._drawn: object = None
        self._controls = [
            DebouncedInput(
                session, change, "balance.change",
                lambda s, value: requests.wish(s, change=float(value) / 100),
                lambda s: round(100 * s.balancing.settings.change, 9),
            ),
            Control(
                session, choice, "balance.output",
                lambda s, value: requests.show_output(s, NAMES.index(value)),
                lambda s: NAMES[s.balancing.output],
            ),
        ]  # fmt: skip
        self.run.on_click(
            lambda _: session.dispatch("balance.tornado", lambda s: requests.begin(s, Task.TORNADO))
        )

    def draw(self, frame: Frame, moving: bool) -> None:
        """Follow the state."""
        for control in self._controls:
            control.draw(frame, moving)
        balancing = frame.state.balancing
        outcome = balancing.tornado
        there = outcome is not None and outcome.tornado is not None
        for handle, visible in (
            (self._place, there), (self.run, balancing.running is None),
        ):  # fmt: skip
            if handle.visible != visible:
                handle.visible = visible
        text = words(frame.state)
        if self._words.content != text:
            self._words.content = text
        if outcome is None or outcome.tornado is None or moving:
            return
        if self._drawn != (outcome, balancing.output):
            self._drawn = (outcome, balancing.output)
            figure = cast(Any, TornadoFigure(outcome.tornado, balancing.output))
            if self._plot is None:
                with self._place:
                    self._plot = self._gui.add_plotly(figure, aspect=1.15)
            else:
                self._plot.figure = figure


def words(state: State) -> str:
    """Say what the chart is of, or that it is being worked out, or why there is none."""
    balancing = state.balancing
    if balancing.running is not None and balancing.running.task is Task.TORNADO:
        return block(MUTED, "Changing one value after another …", "tornado")
    outcome = balancing.tornado
    if outcome is not None and outcome.problem is not None:
        return problem_html(outcome.problem)
    text = "How the torques of M1–M3 follow each mass and length by itself."
    if outcome is not None and outcome.tornado is not None:
        text += _where(outcome.tornado)
        if not outcome.tornado.ranked(balancing.output):
            text += " <b>Nothing to show: no value, or none that matters.</b>"
        if outcome.job.design != state.document.design:
            text += " <b>Of an earlier design: compute again.</b>"
    return note(text, "tornado", muted=True)


def _where(tornado: Tornado) -> str:
    lost = max((bar.lost for bar in tornado.bars), default=0)
    text = " LastReachable: in a square around the middle, at the maps’ θ and z."
    return text + (f" Up to {lost} of its poses are out of reach in a variant." if lost else "")


class TornadoFigure:
    """A tornado chart as viser wants a figure: it asks for the JSON and nothing else."""

    def __init__(self, tornado: Tornado, output: int) -> None:
        """Prepare the figure of one of `OUTPUTS`, the longest bar on top."""
        bars = tornado.ranked(output)[:MOST_BARS]
        unit = unit_text(OUTPUTS[output][1])
        names = [carrier(bar.path) for bar in bars]
        percent = number(100 * tornado.change)
        traces = []
        for sign, color in (("+", INK), ("−", MUTED)):
            ends = [float((bar.plus if sign == "+" else bar.minus)[output]) for bar in bars]
            bases = [float(bar.base[output]) for bar in bars]
            traces.append(
                {
                    "type": "bar", "orientation": "h", "name": f"{sign}{percent} %",
                    "x": [end - base for end, base in zip(ends, bases, strict=True)],
                    "y": names, "base": bases, "marker": {"color": color},
                    "customdata": ends,
                    "hovertemplate": f"%{{y}} {sign}{percent} %: %{{customdata:.5~g}} {unit}"
                    "<extra></extra>",
                }
            )  # fmt: skip
        self._tree = {
            "data": traces,
            "layout": LAYOUT | {
                "barmode": "overlay", "bargap": 0.3,
                "legend": LAYOUT["legend"] | {"y": 0},
                "xaxis": AXIS | {"title": {"text": f"{symbol_html(NAMES[output])} [{unit}]"}},
                "yaxis": AXIS | {"autorange": "reversed", "ticks": ""},
            },
            "config": CONFIG,
        }  # fmt: skip

    def to_json(self) -> str:
        """Return the figure as Plotly's JSON."""
        return json.dumps(self._tree)
