"""The curves of the motion: two charts, the numbers below them, and what they show."""

from __future__ import annotations

import math
from functools import partial
from typing import Any

import numpy as np

from paminsa_viz.engines import why_missing
from paminsa_viz.explorer.browser.bridge import Slots, finite, marker
from paminsa_viz.explorer.core import motion as motions
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.core.motion_results import MotionResults, in_piece
from paminsa_viz.explorer.core.place import Place
from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.features.motion.engine import ask_engine
from paminsa_viz.explorer.features.motion.simulation import SIMULATION
from paminsa_viz.explorer.features.motion.tab import ACTUATORS, status_line
from paminsa_viz.explorer.kit.bindings import Panel
from paminsa_viz.explorer.kit.curves import PLACE, MotionChart, TimeCursor, draw_charts
from paminsa_viz.explorer.kit.inputs import Checkbox, Dropdown, attribute
from paminsa_viz.explorer.kit.task import Follower
from paminsa_viz.explorer.kit.text import render
from paminsa_viz.explorer.state.motion import COMPARED, PLOTS, SIMULATED, Engine
from paminsa_viz.explorer.state.simulation import EngineRequest, serves
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model.arrays import Array
from paminsa_viz.plots.series import Statistics, Trace, statistics
from paminsa_viz.plots.series_builders import build_series
from paminsa_viz.plots.series_uplot import Chart, charts, trace_order
from paminsa_viz.units import MM, NONE, fixed, number


def _engine_switch(key: str, engine: Engine, order: float) -> Checkbox:
    """Return the switch of an engine; at most one is compared with, and one for differences."""

    def apply(state: State, on: bool) -> State:
        if on:
            return state.updated("plots", engine=True, checker=engine)
        return state.updated("plots", engine=False)

    def read(state: State) -> bool:
        return state.plots.needs_engine and state.plots.checker == engine

    return Checkbox(
        key, engine, order=order,
        hint=lambda _: why_missing(engine)
        or f"Compare with {engine}, an independent physics engine; its torques are marks",
        disabled=lambda _: bool(why_missing(engine)),
        visible=lambda state: state.plots.plot in ("torques", "differences"),
        read=read, apply=apply,
    )  # fmt: skip


def wanted_answer(frame: Frame) -> EngineRequest | None:
    """Return what an engine is asked about what is shown, if it is wanted and not known."""
    plots, answer = frame.state.plots, frame.state.engine_answer
    if frame.analysis is None or not plots.needs_engine:
        return None
    if answer is not None and serves(answer, frame.analysis, plots.checker):
        return None
    return EngineRequest(frame.analysis, plots.checker)


ENGINE = Follower(Place(lambda state: state.engine_answer), wanted_answer, ask_engine, idle=True)
"""Asks an engine for the torques along the motion that is shown."""


INPUTS = (
    ENGINE.worker,
    Dropdown(
        "plots.plot", "Show", options=PLOTS, order=5, hint="What is plotted along the motion",
        **attribute("plots.plot"),
    ),
    Dropdown(
        "plots.actuator", "Actuator", options=ACTUATORS, order=6,
        hint="Whose torque is shown by its causes",
        visible=lambda state: state.plots.plot == "breakdown",
        **attribute("plots.actuator"),
    ),
    _engine_switch("plots.engine", "MuJoCo", 6.5),
    _engine_switch("plots.pinocchio", "Pinocchio", 6.6),
    Checkbox(
        "plots.published", "As published", order=7,
        hint="Dotted: what the paper’s formulas give with all their misprints",
        visible=lambda state: state.plots.plot in (*COMPARED, "differences"),
        **attribute("plots.published"),
    ),
)  # fmt: skip


class MotionPlots:
    """Charts, numbers and inputs of the motion, in the current container of the page.

    Attributes:
        charts: The two charts.
        inputs: What they show.
    """

    def __init__(self, session: Session, slots: Slots, container: Any) -> None:
        gui = session.client.gui
        self._slots, self._bridge = slots, session.bridge
        self._cursor = TimeCursor(session.bridge, lambda time: _scrub(session, time))
        gui.add_html(marker(PLACE), order=0)
        self.charts = tuple(MotionChart(gui, container, order) for order in (1.0, 2.0))
        self.fit(session.window[1])
        self._caption = gui.add_html("", order=3)
        self._numbers = gui.add_html("", order=4)
        self.inputs = Panel(session, INPUTS)
        self._key: tuple[object, ...] = ()
        self._drawn: tuple[Chart, ...] = ()
        self._read: dict[Trace, Statistics] = {}
        self._piece: tuple[object, ...] = ()
        session.bridge.on("piece", partial(_take_piece, session))

    def fit(self, window_height: float) -> None:
        """Let the charts fill a window of a height [px]."""
        for chart in self.charts:
            chart.fit(window_height)

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Draw what has changed, unless nobody sees it."""
        state = frame.state
        self.inputs.draw(frame, dragging)
        self._mark_piece(frame)
        if not self._slots.width(PLACE):
            return
        found = frame.motions.all(state)
        self._draw_curves(state, found)
        time = state.playback.time
        self._cursor.show(time)
        if found is not None and state.plots.plot == "differences":
            self._numbers.content = difference_html(self._drawn, found, time)
        else:
            largest = "Least" if state.plots.plot == "clearance" else "Largest"
            self._numbers.content = numbers_html(self._drawn, self._read, time, largest)

    def _mark_piece(self, frame: Frame) -> None:
        """Mark the path of the piece of time that the charts show in the maps."""
        piece = frame.state.playback.piece
        trajectory = None if frame.analysis is None or piece is None else frame.analysis.trajectory
        if (piece, trajectory) == self._piece:
            return
        self._piece = (piece, trajectory)
        places: list[list[float]] = []
        if trajectory is not None:
            inside = np.flatnonzero(in_piece(trajectory.t, piece))
            some = np.linspace(0, inside.size - 1, min(inside.size, PIECE_POINTS)).round()
            places = (MM * trajectory.pose[inside[some.astype(np.intp)], :2]).round(1).tolist()
        self._bridge.call("showPiece", places)

    def _draw_curves(self, state: State, found: MotionResults | None) -> None:
        key = (found, state.plots, state.theme)
        if key == self._key:
            return
        self._key = key
        self._drawn = () if found is None else drawn_charts(state, found)
        measure = least if state.plots.plot == "clearance" else statistics
        self._read = {
            trace: measure(chart.t, trace) for chart in self._drawn for trace in chart.traces
        }
        draw_charts(self.charts, self._drawn, state.theme)
        self._caption.content = caption_html(state, found, self._drawn)


PIECE_POINTS = 120
"""Most points of a piece of the path in a map."""


def piece_of(data: Any) -> tuple[float, float] | None:
    """Return the piece of time (from, to) [s] that the page says the charts show, None for all."""
    given = data if isinstance(data, dict) else {}
    start, end = finite(given.get("from")), finite(given.get("to"))
    return None if start is None or end is None or start >= end else (start, end)


def _take_piece(session: Session, data: Any) -> None:
    action = partial(motions.show_piece, piece=piece_of(data))
    session.dispatch("playback.piece", action, step=False)


def _scrub(session: Session, time: float) -> None:
    action = partial(motions.scrub, time=time)
    session.dispatch("playback.time", action, step=False, overtakes=True)


def drawn_charts(state: State, found: MotionResults) -> tuple[Chart, ...]:
    """Return what is plotted; nothing for a simulation that has not been run."""
    if state.plots.plot in SIMULATED and found.sources.simulation is None:
        return ()
    return charts(build_series(state.plots.plot, found.sources), state.plots.actuator)


_ROUNDING = 1e-12
"""Values up to this are rounding errors [N m, N, ...]."""

_SMALL = 1e-4
"""Values below this have a power of ten, beside which there is no room for four digits."""

_LARGE = 1e5
"""Values from here on have one, too."""


def caption_html(state: State, found: MotionResults | None, drawn: tuple[Chart, ...]) -> str:
    """Return the line below the charts: which motion, what strokes mean, and whether it fails."""
    if found is None:
        return render("motion/empty.j2", text=status_line(state, None)[1])
    if not drawn:
        text = "nothing has been simulated yet: press Simulate in the section Simulate"
        if SIMULATION.runs(state):
            text = "Simulating …"
        return render("motion/empty.j2", text=text)
    sources, failure = found.sources, found.analysis.failure
    compared = state.plots.plot in COMPARED
    reference = sources.reference if compared else None
    worse = None if reference is None or failure is not None else reference.failure
    return render(
        "motion/caption.j2",
        trajectory=found.analysis.trajectory,
        problem=motions.planned(state).problem,
        reference="" if reference is None else reference.design.name,
        reference_failure="" if worse is None else worse.explanation,
        published=compared and sources.published is not None,
        failure="" if failure is None else failure.explanation,
        engine=_engine(state, found) if state.plots.needs_engine else None,
    )


def _engine(state: State, found: MotionResults) -> dict[str, object]:
    """Return what the caption says of an engine's torques."""
    context: dict[str, object] = {
        "marked": state.plots.plot == "torques", "answer": found.answer, "own": None
    }  # fmt: skip
    check = found.answer.result if found.answer else None
    if check is not None:
        published = found.sources.published
        context |= {
            "name": check.engine.name,
            "tolerance": check.tolerance,
            "own": check.comparison(found.analysis),
            "published": None if published is None else check.comparison(published),
        }
    return context


def least(t: Array, trace: Trace) -> Statistics:
    """Return the least value of a curve, when it is [s], and its RMS, which is not asked for."""
    if not np.isfinite(trace.values).any():
        return Statistics(math.nan, math.nan, math.nan)
    low = int(np.nanargmin(trace.values))
    return Statistics(float(trace.values[low]), float(t[low]), math.nan)


def numbers_html(
    drawn: tuple[Chart, ...], read: dict[Trace, Statistics], time: float, largest: str = "Largest"
) -> str:
    """Return the table of the curves: the value at the cursor, the largest one, the RMS.

    Args:
        drawn: The charts.
        read: Peak and RMS of every curve.
        time: Of the cursor [s].
        largest: What ``read`` has of a curve: its largest or least value.
    """
    peaks = {chart.unit: 0.0 for chart in drawn}
    for chart, trace in _rows(drawn):
        peaks[chart.unit] = max(peaks[chart.unit], np.nan_to_num(abs(read[trace].peak)))

    def row(chart: Chart, trace: Trace) -> tuple[Trace, tuple[str, ...], None]:
        peak, peak_t, mean = read[trace]
        at = f"{peak_t:.3f} s" if math.isfinite(peak_t) else NONE
        now, most, usual = (
            _value(one, peaks[chart.unit]) for one in (chart.value_at(trace, time), peak, mean)
        )
        return trace, (now, most, at, usual, chart.unit), None

    groups = [(title, [row(*each) for each in rows]) for title, rows in _groups(drawn)]
    heads = (f"At {time:.3f} s", largest, "At", "RMS", "")
    return render("motion/numbers.j2", heads=heads, groups=groups)


def difference_html(drawn: tuple[Chart, ...], found: MotionResults, time: float) -> str:
    """Return the table of differences to an engine, over the largest torque, with a verdict."""
    check = found.answer.result if found.answer else None
    shares: dict[str, list[float]] = {}
    if check is not None:
        for suffix, analysis in (("", found.analysis), ("as published", found.sources.published)):
            if analysis is not None:
                shares[suffix] = check.comparison(analysis).relative.tolist()
    rows = []
    for chart, trace in _rows(drawn):
        if check is None:
            rows.append((trace, (NONE, NONE, NONE, "", NONE, ""), None))
            continue
        values = trace.values[np.isfinite(trace.values)]
        share = shares[trace.suffix or ""].pop(0)
        cells = (
            _value(chart.value_at(trace, time)),
            _value(float(np.abs(values).max())),
            _value(float(np.sqrt((values**2).mean()))),
            chart.unit,
            number(share, 2),
        )
        rows.append((trace, cells, share <= check.tolerance))
    heads = (f"At {time:.3f} s", "Largest", "RMS", "", "Relative", "")
    return render("motion/numbers.j2", heads=heads, groups=[("", rows)] if rows else [])


def _rows(drawn: tuple[Chart, ...]) -> list[tuple[Chart, Trace]]:
    """Return the curves in the order of their rows: the design's of all charts before others."""
    rows = [(chart, trace) for chart in drawn for trace in chart.traces if not trace.marks]
    return sorted(rows, key=lambda row: trace_order(row[1]))


def _groups(drawn: tuple[Chart, ...]) -> list[tuple[str, list[tuple[Chart, Trace]]]]:
    """Return the rows below the titles of their charts, where charts share names of curves; else
    all without a title."""
    rows = _rows(drawn)
    if len({trace.label for _, trace in rows}) == len(rows):
        return [("", rows)] if rows else []
    titles = {chart: chart.title.partition(" [")[0] for chart in drawn}
    return [(title, [row for row in rows if row[0] is chart]) for chart, title in titles.items()]


def _value(value: float, peak: float = 0.0) -> str:
    """Return a value of a curve; a rounding error as 0.

    Args:
        value: As above.
        peak: The largest one in its unit, which has four digits: the others have as many decimals,
            so that points are below each other. Without one, each has four digits of its own.
    """
    if not math.isfinite(value):
        return NONE
    value = value if abs(value) > _ROUNDING else 0.0
    if _SMALL <= peak < _LARGE:
        return fixed(value, max(3 - math.floor(math.log10(peak)), 0))
    return number(value, 4 if abs(value) >= _SMALL else 2)
