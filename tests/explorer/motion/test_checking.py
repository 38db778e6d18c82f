"""An engine's torques on the page: right, of what is shown and of nothing else, or why not."""

from __future__ import annotations

import sys
import threading
from typing import Any

import numpy as np
import pytest

from paminsa_viz.engines import EngineMissing
from paminsa_viz.engines.verification import TOLERANCE, verify
from paminsa_viz.explorer import actions, exports
from paminsa_viz.explorer.motion import actions as motions
from paminsa_viz.explorer.motion.description import Kind
from paminsa_viz.explorer.motion.jobs import MOST_SAMPLES, Answer, ask_engine
from paminsa_viz.explorer.motion.results import MotionResults, MotionStore
from paminsa_viz.explorer.panels import motion_plots
from paminsa_viz.explorer.panels.motion_plots import (
    EngineChecker,
    caption_html,
    difference_html,
    drawn_charts,
)
from paminsa_viz.explorer.state import State, initial_state
from paminsa_viz.model import InvalidInput, KneeBranch, Misprint
from paminsa_viz.plots.series_uplot import chart_shape, shown_curve, uplot_data
from paminsa_viz.units import power_of_ten
from tests.support.samples import with_knee

needs_mujoco = pytest.mark.usefixtures("mujoco")


@pytest.fixture
def state() -> State:
    """A design of its own on the paper-like motion, its torques beside the engine's."""
    changed = actions.vary(initial_state(), {"payload.mass": 2.0, "links.b4": 0.9})
    return changed.updated("plots", engine=True, published=True)


def analyzed(state: State) -> MotionResults:
    found = MotionStore().all(state)
    assert found is not None
    return found


def caption(found: MotionResults, state: State) -> str:
    """Return what stands below the charts of a state."""
    return caption_html(state, found, drawn_charts(state, found))


def answered(state: State) -> State:
    """Return a state after the engine was asked about it."""
    return motions.receive_engine_answer(state, ask_engine(analyzed(state).analysis))


@needs_mujoco
@pytest.mark.parametrize("knee", list(KneeBranch))
def test_numbers_are_those_of_a_verification(state: State, knee: KneeBranch) -> None:
    found = analyzed(answered(actions.set_knee(state, knee)))
    assert found.answer is not None
    torques = found.answer.found
    assert torques is not None
    assert found.sources.published is not None
    motion = torques.thinned.trajectory
    assert motion.size == MOST_SAMPLES
    assert (motion.t[0], motion.t[-1]) == (0.0, found.analysis.trajectory.t[-1])
    design = found.analysis.design
    known = verify(with_knee(design, knee), motion, poses=1, misprints=(Misprint.ALL,))
    np.testing.assert_array_equal(torques.engine.torque, known.engines[0].dynamic.reference)
    own, printed = torques.comparison(found.analysis), torques.comparison(found.sources.published)
    assert own.agrees(TOLERANCE)
    assert own.relative.max() < 1e-11
    np.testing.assert_allclose(own.scale, known.engines[0].dynamic.scale, rtol=1e-12)
    wanted = known.published[Misprint.ALL]
    np.testing.assert_allclose(printed.largest, wanted.largest, rtol=1e-9)
    np.testing.assert_allclose(printed.rms, wanted.rms, rtol=1e-9)


@needs_mujoco
def test_friction_is_no_difference(state: State) -> None:
    rubbing = {"friction.coulomb_rotary": 0.3, "friction.viscous_linear": 5.0}
    found = analyzed(answered(actions.vary(state, rubbing)))
    assert found.answer is not None
    assert found.answer.found is not None
    assert found.answer.found.comparison(found.analysis).relative.max() < 1e-11


@needs_mujoco
def test_an_answer_holds_for_what_was_asked_about_alone(state: State) -> None:
    known = answered(state)
    assert analyzed(known).answer is known.engine_answer
    for other in (
        actions.vary(known, {"links.b3": 0.5}),
        actions.vary(known, {"geometry.crank_length": 0.44}),
        actions.vary(known, {"friction.coulomb_rotary": 0.1}),
        actions.set_knee(known, KneeBranch.UPPER),
        motions.choose_preset(known, "circle"),
    ):
        found = analyzed(other)
        assert found.answer is None
        for chart in drawn_charts(other, found):
            marks = [trace for trace in chart.traces if trace.marks]
            assert marks
            assert all(np.isnan(trace.values).all() for trace in marks)
        other = other.updated("plots", plot="differences")
        for chart in drawn_charts(other, analyzed(other)):
            assert all(np.isnan(trace.values).all() for trace in chart.traces)
        assert "computing" in caption(found, other)
    back = actions.vary(actions.vary(known, {"links.b3": 0.5}), {"links.b3": 0.406})
    assert analyzed(back).answer is known.engine_answer


@needs_mujoco
def test_marks_lie_on_the_curves_and_charts_stay(state: State) -> None:
    waiting, found = analyzed(state), analyzed(answered(state))
    for before, chart in zip(drawn_charts(state, waiting), drawn_charts(state, found), strict=True):
        assert chart_shape(before) == chart_shape(chart)
        marks = [trace for trace in chart.traces if trace.marks]
        series = uplot_data(chart, 1)
        for number, trace in enumerate(chart.traces):
            if trace not in marks:
                continue
            seen = np.flatnonzero(np.isfinite(trace.values))
            assert 25 <= seen.size <= 51
            own = chart.traces[marks.index(trace)].values
            np.testing.assert_allclose(trace.values[seen], own[seen], atol=1e-9)
            shown = shown_curve(series, chart_shape(chart), number)
            assert np.isfinite(shown).sum() == seen.size


@needs_mujoco
def test_the_difference_is_plotted_and_the_misprints_are_told(state: State) -> None:
    state = answered(state).updated("plots", plot="differences", published=False)
    found = analyzed(state)
    assert found.answer is not None
    torques = found.answer.found
    assert torques is not None
    turning, lifting = drawn_charts(state, found)
    assert "10⁻" in turning.unit
    wanted = (torques.engine.pick(found.analysis.torque) - torques.engine.torque)[:, 0]
    ratio = turning.traces[0].values[wanted != 0] / wanted[wanted != 0]
    np.testing.assert_allclose(ratio, ratio[0], rtol=1e-12)
    assert turning.unit.startswith(power_of_ten(-round(np.log10(ratio[0]))))
    assert 1 <= max(np.abs(trace.values).max() for trace in turning.traces) < 1000
    table = difference_html((turning, lifting), found, 0.1)
    assert table.count("PASS") == 4
    assert "FAIL" not in table
    assert "PASS" in caption(found, state)

    state = state.updated("plots", published=True)
    found = analyzed(state)
    drawn = drawn_charts(state, found)
    assert (drawn[0].unit, drawn[1].unit) == ("N·m", "N")
    table = difference_html(drawn, found, 0.1)
    assert (table.count("PASS"), table.count("FAIL")) == (4, 4)
    assert "misprints" in caption(found, state)
    figure = exports.motion_figure(state, "svg")
    assert "comparison" in figure.name
    assert b"Formulas as published and MuJoCo" in figure.content


@needs_mujoco
def test_where_the_motion_fails_nothing_is_compared(state: State) -> None:
    line = motions.choose_kind(state, Kind.LINE)
    line = motions.change(line, start=(0, 0, 0, -0.55), goal=(0.6, 0, 0, -0.55))
    found = analyzed(answered(line))
    assert found.answer is not None
    torques = found.answer.found
    assert torques is not None
    good = found.analysis.check.good[torques.engine.samples]
    assert 0 < good.sum() < good.size
    comparison = torques.comparison(found.analysis)
    assert len(comparison.computed) == good.sum()
    assert comparison.agrees(TOLERANCE)
    (chart, _) = drawn_charts(line.updated("plots", plot="differences"), found)
    np.testing.assert_array_equal(np.isnan(chart.traces[0].values), ~good)
    np.testing.assert_array_equal(chart.failing, ~good)

    away = motions.change(line, start=(0.9, 0, 0, -0.55), goal=(0.95, 0, 0, -0.55))
    found = analyzed(answered(away))
    assert found.answer is not None
    assert "cannot run any" in found.answer.problem
    assert "cannot run any" in caption(found, away)


def test_a_missing_engine_is_told_once_for_all_designs(
    state: State, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "mujoco", None)
    state = answered(state)
    for other in (state, actions.vary(state, {"links.b3": 0.5})):
        found = analyzed(other)
        assert found.answer is not None
        said = caption(found, other)
        assert "pip install" in said
        assert str(EngineMissing("MuJoCo")).split(";")[0] in said
        assert "–" in difference_html(
            drawn_charts(other.updated("plots", plot="differences"), found), found, 0.0
        )
    with pytest.raises(InvalidInput, match="pip install"):
        exports.motion_figure(state.updated("plots", plot="differences"), "png")


class Asked:
    """A session that takes requests at once, and an engine that answers when it is let."""

    closed = False

    def __init__(self, state: State, monkeypatch: pytest.MonkeyPatch) -> None:
        self.state, self.store = state, MotionStore()
        self.designs: list[float] = []
        self.may, self.came = threading.Semaphore(0), threading.Semaphore(0)
        self.checker = EngineChecker(self)  # type: ignore[arg-type]
        monkeypatch.setattr(motion_plots, "ask_engine", self._answer)

    def _answer(self, analysis: Any) -> Answer:
        self.designs.append(analysis.design.links.b3)
        self.came.release()
        assert self.may.acquire(timeout=20)
        return Answer(analysis, None, "no matter")

    def dispatch(self, source: str, intent: Any, *, step: bool) -> None:
        assert not step
        self.state = intent(self.state)
        self.came.release()

    def wait(self) -> None:
        """Wait until the engine is asked, or has answered."""
        assert self.came.acquire(timeout=20)

    def draw(self, b3: float, moving: bool = False) -> None:
        self.state = actions.vary(self.state, {"links.b3": b3})
        self.checker.draw(self.store.all(self.state), moving)


def test_of_many_questions_the_newest_is_answered(
    state: State, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = Asked(state, monkeypatch)
    asked.draw(0.5, moving=True)
    assert asked.designs == []
    asked.draw(0.5)
    asked.wait()
    for b3 in (0.6, 0.7, 0.8):
        asked.draw(b3)
    asked.may.release()
    asked.wait()
    assert asked.state.engine_answer is None
    asked.may.release()
    asked.wait()
    assert asked.designs == [0.5, 0.8]
    assert analyzed(asked.state).answer is asked.state.engine_answer is not None
    asked.draw(0.8)
    asked.draw(0.5)
    asked.wait()
    asked.may.release()
    asked.wait()
    assert asked.designs == [0.5, 0.8, 0.5]


def test_a_motion_that_plays_keeps_no_one_waiting(
    state: State, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = Asked(state, monkeypatch)
    monkeypatch.setattr(motion_plots, "IDLE_DELAY", 0.0)
    asked.draw(0.5, moving=True)
    asked.wait()
    asked.may.release()
    asked.wait()
    assert asked.designs == [0.5]


def test_nothing_is_asked_that_is_not_shown(state: State) -> None:
    assert state.plots.needs_engine
    assert not state.updated("plots", plot="power").plots.needs_engine
    assert not state.updated("plots", engine=False).plots.needs_engine
    assert state.updated("plots", engine=False, plot="differences").plots.needs_engine


@needs_mujoco
def test_of_few_samples_all_are_computed(state: State) -> None:
    state = answered(motions.change(state, rate=50.0))
    answer, motion = state.engine_answer, motions.planned(state).trajectory
    assert answer is not None
    assert answer.found is not None
    assert motion is not None
    assert answer.found.engine.samples.tolist() == list(range(motion.size))
    assert motion.size < MOST_SAMPLES
