"""The curves of the motion: two charts, the numbers below them, and what they show."""

from __future__ import annotations

import time
from typing import Any

from paminsa_viz.explorer.background import BackgroundJob
from paminsa_viz.explorer.bindings import Panel
from paminsa_viz.explorer.browser.bridge import Bridge, Slots, marker
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.inputs import Checkbox, Dropdown, attribute
from paminsa_viz.explorer.motion import actions as motions
from paminsa_viz.explorer.motion.engine_check import Answer, ask_engine
from paminsa_viz.explorer.motion.playback import COMPARED, PLOTS, SIMULATED
from paminsa_viz.explorer.motion.results import MotionResults, MotionStore
from paminsa_viz.explorer.panels import motion_text as text
from paminsa_viz.explorer.panels.motion_chart import PLACE, MotionChart, TimeCursor
from paminsa_viz.explorer.panels.motion_panel import ACTUATORS
from paminsa_viz.explorer.session import IDLE_DELAY, Session
from paminsa_viz.explorer.state import State
from paminsa_viz.plots.series import Statistics, Trace, statistics
from paminsa_viz.plots.series_builders import build_series
from paminsa_viz.plots.series_uplot import Chart, charts
from paminsa_viz.trajectory import TrajectoryAnalysis

INPUTS = (
    Dropdown(
        "plots.plot", "show", options=PLOTS, order=5, hint="What is plotted along the motion",
        **attribute("plots.plot"),
    ),
    Dropdown(
        "plots.actuator", "actuator", options=ACTUATORS, order=6,
        hint="Whose torque is shown by its causes",
        visible=lambda state: state.plots.plot == "breakdown",
        **attribute("plots.actuator"),
    ),
    Checkbox(
        "plots.engine", "MuJoCo", order=6.5,
        hint="Marks: the torques of an independent physics engine",
        visible=lambda state: state.plots.plot == "torques",
        **attribute("plots.engine"),
    ),
    Checkbox(
        "plots.published", "as published", order=7,
        hint="Dotted: what the paper's formulas give with all their misprints",
        visible=lambda state: state.plots.plot in (*COMPARED, "differences"),
        **attribute("plots.published"),
    ),
)  # fmt: skip


class MotionPlots:
    """Charts, numbers and inputs of the motion, in the current container of the page.

    Attributes:
        charts: The two charts.
        inputs: What they show.
        store: Results along the motion.
    """

    def __init__(
        self, session: Session, bridge: Bridge, slots: Slots, container: Any, store: MotionStore
    ) -> None:
        gui = session.client.gui
        self._slots, self.store = slots, store
        self._cursor = TimeCursor(bridge, lambda time: _scrub(session, time))
        gui.add_html(marker(PLACE), order=0)
        self.charts = tuple(MotionChart(gui, container, order) for order in (1.0, 2.0))
        self._caption = gui.add_html("", order=3)
        self._numbers = gui.add_html("", order=4)
        self.inputs = Panel(session, INPUTS)
        self._key: tuple[object, ...] = ()
        self._drawn: tuple[Chart, ...] = ()
        self._read: dict[Trace, Statistics] = {}
        self._checker = EngineChecker(session)

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Draw what has changed, unless nobody sees it."""
        state = frame.state
        self.inputs.draw(frame, dragging)
        if not self._slots.width(PLACE):
            return
        found = self.store.all(state)
        self._checker.draw(found if state.plots.needs_engine else None, dragging)
        self._draw_curves(state, found)
        time = state.playback.time
        self._cursor.show(time)
        if found is not None and state.plots.plot == "differences":
            self._numbers.content = text.difference_html(self._drawn, found, time)
        else:
            self._numbers.content = text.numbers_html(self._drawn, self._read, time)

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
        self._caption.content = text.caption_html(state, found, self._drawn)


def _scrub(session: Session, time: float) -> None:
    session.dispatch("playback.time", lambda state: motions.scrub(state, time), step=False)


def drawn_charts(state: State, found: MotionResults) -> tuple[Chart, ...]:
    """Return what is plotted; nothing for a simulation that has not been run."""
    if state.plots.plot in SIMULATED and found.sources.simulation is None:
        return ()
    return charts(build_series(state.plots.plot, found.sources), state.plots.actuator)


class EngineChecker:
    """Asks the engine as soon as a design and motion have not changed for a while."""

    def __init__(self, session: Session) -> None:
        self._job: BackgroundJob[TrajectoryAnalysis, Answer] = BackgroundJob(
            session, "plots.engine_answer", lambda analysis, _: ask_engine(analysis),
            motions.receive_engine_answer,
            failed=lambda analysis, problem: Answer(analysis, None, problem), undo=False,
        )  # fmt: skip
        self._seen: TrajectoryAnalysis | None = None
        self._since = 0.0

    def draw(self, found: MotionResults | None, dragging: bool) -> None:
        """Ask about what is shown, unless it still changes or the answer is known.

        Args:
            found: The motion that an engine's torques are wanted for, or None.
            dragging: Whether the state changes; perhaps something else, or the motion plays.
        """
        now = time.monotonic()
        wanted = None if found is None else found.analysis
        if wanted is not self._seen:
            self._seen, self._since = wanted, now
        if found is None or found.answer is not None:
            return
        if not dragging or now - self._since >= IDLE_DELAY:
            self._job.request(wanted)
