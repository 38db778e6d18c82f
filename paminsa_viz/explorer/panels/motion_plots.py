"""The curves of the motion: two charts, the numbers beside them, and what they show."""

from __future__ import annotations

from html import escape
from typing import Any

from paminsa_viz.explorer.browser.bridge import Bridge
from paminsa_viz.explorer.controls import Control
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.motion import actions as motions
from paminsa_viz.explorer.motion.playback import COMPARED, PLOTS, SIMULATED
from paminsa_viz.explorer.motion.results import MotionResults, MotionStore
from paminsa_viz.explorer.motion.time_cursor import PLACE, TimeCursor
from paminsa_viz.explorer.panels.motion_chart import MotionChart
from paminsa_viz.explorer.panels.motion_engine import MARK, EngineChecker, verdict_html
from paminsa_viz.explorer.panels.motion_numbers import difference_html, numbers_html
from paminsa_viz.explorer.panels.motion_words import status_line
from paminsa_viz.explorer.panels.slots import Slots, marker
from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.state import State
from paminsa_viz.palette import BAD, INK, MUTED
from paminsa_viz.plots.series import Statistics, Trace, statistics
from paminsa_viz.plots.series_builders import build_series
from paminsa_viz.plots.series_uplot import Chart, charts
from paminsa_viz.units import number

ACTUATORS = ("M1", "M2", "M3", "M4")
_LABELS = {plot: label for label, plot in PLOTS.items()}


class MotionPlots:
    """Charts, numbers and inputs of the motion, in the current container of the page.

    Attributes:
        charts: The two charts.
        store: What was worked out along the motion.
    """

    def __init__(
        self, session: Session, bridge: Bridge, slots: Slots, container: Any, store: MotionStore
    ) -> None:
        gui = session.client.gui
        self._slots, self.store = slots, store
        self._moment = TimeCursor(bridge, lambda time: _scrub(session, time))
        gui.add_html(marker(PLACE), order=0)
        self.charts = tuple(MotionChart(gui, container, order) for order in (1.0, 2.0))
        self._caption = gui.add_html("", order=3)
        self._numbers = gui.add_html("", order=4)
        plots = session.state.plots
        shown = gui.add_dropdown(
            "show", tuple(PLOTS), initial_value=_LABELS[plots.plot], order=5,
            hint="What is plotted along the motion",
        )  # fmt: skip
        self.actuator = gui.add_dropdown(
            "actuator", ACTUATORS, initial_value=ACTUATORS[plots.actuator], order=6,
            hint="Whose torque is taken apart",
        )  # fmt: skip
        self.engine = gui.add_checkbox(
            "MuJoCo", plots.engine, order=6.5,
            hint="Marks: the torques that a physics engine finds, which knows none of the formulae",
        )  # fmt: skip
        self.published = gui.add_checkbox(
            "formulae as published", plots.published, order=7,
            hint="Dotted: what the paper's formulae give with all their misprints",
        )  # fmt: skip
        self._controls = [
            Control(
                session, shown, "plots.plot",
                lambda s, value: motions.set_plots(s, plot=PLOTS[value]),
                lambda s: _LABELS[s.plots.plot],
            ),
            Control(
                session, self.actuator, "plots.actuator",
                lambda s, value: motions.set_plots(s, actuator=ACTUATORS.index(value)),
                lambda s: ACTUATORS[s.plots.actuator],
            ),
            Control(
                session, self.engine, "plots.engine",
                lambda s, value: motions.set_plots(s, engine=bool(value)),
                lambda s: s.plots.engine,
            ),
            Control(
                session, self.published, "plots.published",
                lambda s, value: motions.set_plots(s, published=bool(value)),
                lambda s: s.plots.published,
            ),
        ]  # fmt: skip
        self._key: tuple[object, ...] = ()
        self._drawn: tuple[Chart, ...] = ()
        self._read: dict[Trace, Statistics] = {}
        self._checker = EngineChecker(session)

    def draw(self, frame: Frame, moving: bool) -> None:
        """Draw what has changed, unless nobody sees it."""
        state = frame.state
        for control in self._controls:
            control.draw(frame, moving)
        if not self._slots.width(PLACE):
            return
        _show(self.actuator, state.plots.plot == "breakdown")
        _show(self.engine, state.plots.plot == "torques")
        _show(self.published, state.plots.plot in (*COMPARED, "differences"))
        found = self.store.all(state)
        self._checker.draw(found if state.plots.needs_engine else None, moving)
        self._draw_curves(state, found)
        time = state.playback.time
        self._moment.show(time)
        if found is not None and state.plots.plot == "differences":
            _write(self._numbers, difference_html(self._drawn, found, time))
        else:
            _write(self._numbers, numbers_html(self._drawn, self._read, time))

    def _draw_curves(self, state: State, found: MotionResults | None) -> None:
        key = (found, state.plots)
        if key == self._key:
            return
        self._key = key
        self._drawn = () if found is None else drawn_charts(state, found)
        self._read = {
            trace: statistics(chart.t, trace, chart.until)
            for chart in self._drawn
            for trace in chart.traces
        }
        for index, chart in enumerate(self.charts):
            chart.draw(self._drawn[index] if index < len(self._drawn) else None)
        _write(self._caption, caption_html(state, found, self._drawn))


def _scrub(session: Session, time: float) -> None:
    session.dispatch("playback.time", lambda state: motions.scrub(state, time), step=False)


def drawn_charts(state: State, found: MotionResults) -> tuple[Chart, ...]:
    """Return what is plotted; nothing for a simulation that has not been run."""
    if state.plots.plot in SIMULATED and found.sources.simulation is None:
        return ()
    return charts(build_series(state.plots.plot, found.sources), state.plots.actuator)


def caption_html(state: State, found: MotionResults | None, drawn: tuple[Chart, ...]) -> str:
    """Return the line below the charts: which motion, what strokes mean, and whether it fails."""
    if found is None:
        return _instead(status_line(state, None)[1])
    if not drawn:
        return _instead("nothing has been simulated yet: press Simulate in the tab “Motion”")
    t = found.analysis.trajectory
    parts = [f"<b>{escape(t.name)}</b>, {number(t.duration, 4)} s"]
    if found.sources.reference is not None and state.plots.plot in COMPARED:
        parts.append(f"╌ reference “{escape(found.sources.reference.design.name)}”")
    if found.sources.published is not None and state.plots.plot in COMPARED:
        parts.append("┈ formulae as published")
    first = found.analysis.check.first
    if first is not None:
        parts.append(f'<span style="color:{BAD}"><b>fails</b> {escape(first.explanation)}</span>')
    engine = ""
    if state.plots.needs_engine:
        mark = MARK if state.plots.plot == "torques" else ""
        verdict = verdict_html(found.answer, found)
        engine = f'<span style="flex-basis:100%">{mark}{verdict}</span>'
    marks = "click: go to that instant · drag: zoom"
    return (
        '<div class="paminsa-whole" style="display:flex;flex-wrap:wrap;gap:1px 14px;'
        f'font-size:12px;line-height:1.3;color:{INK}">'
        + "".join(f"<span>{part}</span>" for part in parts)
        + f'<span style="margin-left:auto;color:{MUTED}">{marks}</span>'
        + engine
        + "</div>"
    )


def _instead(words: str) -> str:
    style = f"padding:30px;color:{MUTED}"
    return f'<div class="paminsa-whole" style="{style}">{escape(words)}</div>'


def _show(handle: Any, visible: bool) -> None:
    if handle.visible != visible:
        handle.visible = visible


def _write(handle: Any, html: str) -> None:
    if handle.content != html:
        handle.content = html
