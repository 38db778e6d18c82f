"""An engine's torques on the page: those of a verification, of what is shown, or why not."""

from __future__ import annotations

import sys
import threading
import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from paminsa_viz.engines import EngineMissing, why_missing
from paminsa_viz.engines.verification import TOLERANCE, verify
from paminsa_viz.explorer import actions, exports
from paminsa_viz.explorer.entries import given
from paminsa_viz.explorer.inputs import Checkbox
from paminsa_viz.explorer.motion import actions as motions
from paminsa_viz.explorer.motion.description import Kind
from paminsa_viz.explorer.motion.jobs import MOST_SAMPLES, EngineRequest, ask_engine
from paminsa_viz.explorer.motion.results import MotionResults, MotionStore
from paminsa_viz.explorer.panels import motion_plots
from paminsa_viz.explorer.panels.motion_plots import (
    INPUTS,
    EngineChecker,
    caption_html,
    difference_html,
    drawn_charts,
)
from paminsa_viz.explorer.state import State, initial_state
from paminsa_viz.explorer.tasks import solve
from paminsa_viz.model import InvalidInput, KneeBranch, Misprint, PaminsaError
from paminsa_viz.plots.series_uplot import chart_shape, uplot_data
from paminsa_viz.units import power_of_ten
from tests.support.charts import shown_curve
from tests.support.raw_page import TIMEOUT

needs_mujoco = pytest.mark.usefixtures("mujoco")


@pytest.fixture
def state() -> State:
    """A design of its own on the paper-like motion, its torques next to the engine's."""
    changed = actions.vary(initial_state(), {"payload.mass": 2.0, "links.b4": 0.9})
    return changed.updated("plots", engine=True, published=True)


def analyzed(state: State) -> MotionResults:
    found = MotionStore().all(state)
    assert found is not None
    return found


def caption(found: MotionResults, state: State) -> str:
    """Return what is written below the charts of a state."""
    return caption_html(state, found, drawn_charts(state, found))


def answered(state: State) -> State:
    """Return a state after the engine has computed its motion."""
    request = EngineRequest(analyzed(state).analysis, state.plots.checker)
    answer = solve(lambda asked, _: ask_engine(asked), request)
    return replace(state, engine_answer=answer)


def engine_torques(found: MotionResults) -> Any:
    """Return the engine's torques among results."""
    assert found.answer is not None
    assert found.answer.result is not None
    return found.answer.result


@needs_mujoco
@pytest.mark.parametrize("knee", KneeBranch)
def test_numbers_are_those_of_a_verification(state: State, knee: KneeBranch) -> None:
    found = analyzed(answered(actions.set_knee(state, knee)))
    torques = engine_torques(found)
    assert found.sources.published is not None
    motion = torques.thinned.trajectory
    assert motion.size == MOST_SAMPLES
    assert (motion.t[0], motion.t[-1]) == (0.0, found.analysis.trajectory.t[-1])
    known = verify(found.analysis.design, motion, poses=1, misprints=(Misprint.ALL,))
    np.testing.assert_array_equal(torques.engine.torque, known.engines[0].dynamic.reference)
    own, published = (
        torques.comparison(each) for each in (found.analysis, found.sources.published)
    )
    assert own.agrees(TOLERANCE)
    assert own.relative.max() < 1e-11
    np.testing.assert_allclose(own.scale, known.engines[0].dynamic.scale, rtol=1e-12)
    wanted = known.published[Misprint.ALL]
    np.testing.assert_allclose(published.largest, wanted.largest, rtol=1e-9)
    np.testing.assert_allclose(published.rms, wanted.rms, rtol=1e-9)


@needs_mujoco
def test_friction_is_no_difference_and_few_samples_are_all_computed(state: State) -> None:
    rubbing = {"friction.coulomb_rotary": 0.3, "friction.viscous_linear": 5.0}
    found = analyzed(answered(motions.change(actions.vary(state, rubbing), rate=50.0)))
    torques = engine_torques(found)
    assert torques.comparison(found.analysis).relative.max() < 1e-11
    assert torques.engine.samples.tolist() == list(range(found.analysis.trajectory.size))
    assert found.analysis.trajectory.size < MOST_SAMPLES


@needs_mujoco
def test_answer_holds_for_its_design_and_motion_only(state: State) -> None:
    known = answered(state)
    assert analyzed(known).answer is known.engine_answer
    for other in (
        actions.vary(known, {"links.b3": 0.5}),
        actions.vary(known, {"geometry.crank_length": 0.44}),
        actions.vary(known, {"friction.coulomb_rotary": 0.1}),
        actions.set_knee(known, KneeBranch.UPPER),
        motions.choose_preset(known, "circle"),
    ):
        assert analyzed(other).answer is None
        for plot in ("torques", "differences"):
            shown = other.updated("plots", plot=plot)
            for chart in drawn_charts(shown, analyzed(shown)):
                marks = [t.values for t in chart.traces if t.marks or plot == "differences"]
                assert np.isnan(marks).all()
                assert marks
        assert "computing" in caption(analyzed(shown), shown)
    back = actions.vary(actions.vary(known, {"links.b3": 0.5}), {"links.b3": 0.406})
    assert analyzed(back).answer is known.engine_answer


@needs_mujoco
def test_marks_are_on_the_curves_and_do_not_change_the_chart(state: State) -> None:
    waiting, found = analyzed(state), analyzed(answered(state))
    for before, chart in zip(drawn_charts(state, waiting), drawn_charts(state, found), strict=True):
        assert chart_shape(before) == chart_shape(chart)
        marks = [number for number, trace in enumerate(chart.traces) if trace.marks]
        series = uplot_data(chart, 1)
        for own, number in zip(chart.traces, marks, strict=False):
            values = chart.traces[number].values
            seen = np.flatnonzero(np.isfinite(values))
            assert 25 <= seen.size <= 51
            np.testing.assert_allclose(values[seen], own.values[seen], atol=1e-9)
            shown = shown_curve(series, chart_shape(chart), number)
            assert np.isfinite(shown).sum() == seen.size


@needs_mujoco
def test_difference_is_plotted_in_a_readable_unit_with_a_verdict(state: State) -> None:
    state = answered(state).updated("plots", plot="differences", published=False)
    found = analyzed(state)
    torques = engine_torques(found)
    turning, lifting = drawn_charts(state, found)
    wanted = (torques.engine.pick(found.analysis.torque) - torques.engine.torque)[:, 0]
    ratio = turning.traces[0].values[wanted != 0] / wanted[wanted != 0]
    np.testing.assert_allclose(ratio, ratio[0], rtol=1e-12)
    assert turning.unit.startswith(power_of_ten(-round(np.log10(ratio[0]))))
    assert 1 <= max(np.abs(trace.values).max() for trace in turning.traces) < 1000
    table = difference_html((turning, lifting), found, 0.1)
    assert (table.count("PASS"), table.count("FAIL")) == (4, 0)
    assert "PASS" in caption(found, state)

    state = state.updated("plots", published=True)
    found = analyzed(state)
    drawn = drawn_charts(state, found)
    assert [chart.unit for chart in drawn] == ["N·m", "N"]
    table = difference_html(drawn, found, 0.1)
    assert (table.count("PASS"), table.count("FAIL")) == (4, 4)
    assert "misprints" in caption(found, state)
    figure = exports.motion_figure(state, "svg")
    assert "comparison" in figure.name
    assert b"Formulas as published and MuJoCo" in figure.content


@needs_mujoco
def test_nothing_is_compared_where_the_motion_fails(state: State) -> None:
    def line(start: float, goal: float) -> State:
        chosen = motions.choose_kind(state, Kind.LINE)
        ends = {"start": (start, 0, 0, -0.55), "goal": (goal, 0, 0, -0.55)}
        return answered(motions.change(chosen, **ends)).updated("plots", plot="differences")

    failing = line(0.0, 0.6)
    found = analyzed(failing)
    torques = engine_torques(found)
    good = found.analysis.check.good[torques.engine.samples]
    assert 0 < good.sum() < good.size
    comparison = torques.comparison(found.analysis)
    assert len(comparison.computed) == good.sum()
    assert comparison.agrees(TOLERANCE)
    (chart, _) = drawn_charts(failing, found)
    np.testing.assert_array_equal(np.isnan(chart.traces[0].values), ~good)
    np.testing.assert_array_equal(chart.failing, ~good)

    nowhere = line(0.9, 0.95)
    assert "cannot run any" in caption(analyzed(nowhere), nowhere)


def test_plain_installation_has_mujoco_and_a_missing_engine_is_disabled(
    state: State, monkeypatch: pytest.MonkeyPatch
) -> None:
    project = tomllib.loads(
        (Path(__file__).parents[3] / "pyproject.toml").read_text(encoding="utf-8")
    )["project"]
    assert any(item.startswith("mujoco") for item in project["dependencies"])
    switch = next(entry for entry in INPUTS if entry.key == "plots.engine")
    assert switch.disabled is not None
    assert not switch.disabled(state)
    monkeypatch.setitem(sys.modules, "mujoco", None)
    why_missing.cache_clear()
    assert switch.disabled(state)
    assert "pip install mujoco" in given(switch.hint, state)
    monkeypatch.undo()
    why_missing.cache_clear()


def test_pinocchio_is_compared_with_and_disabled_with_the_reason_where_it_is_missing(
    state: State, monkeypatch: pytest.MonkeyPatch
) -> None:
    switches = {e.label: e for e in INPUTS if isinstance(e, Checkbox)}
    mujoco, pinocchio = switches["MuJoCo"], switches["Pinocchio"]
    chosen = pinocchio.apply(state, True)
    assert (mujoco.read(chosen), pinocchio.read(chosen)) == (False, True)
    assert not pinocchio.read(pinocchio.apply(chosen, False))
    shown = chosen.updated("plots", plot="differences", engine=False)
    assert pinocchio.read(shown)
    with monkeypatch.context() as patch:
        patch.setitem(sys.modules, "pinocchio", None)
        why_missing.cache_clear()
        assert pinocchio.disabled is not None
        assert pinocchio.disabled(state)
        assert "paminsa-viz[verify]" in given(pinocchio.hint, state)
    why_missing.cache_clear()
    pytest.importorskip("pinocchio")
    assert not pinocchio.disabled(state)
    known = answered(chosen)
    found = engine_torques(analyzed(known))
    assert found.engine.name.startswith("Pinocchio")
    assert found.comparison(analyzed(known).analysis).relative.max() < 1e-11
    assert "Pinocchio" in caption(analyzed(known), known)
    # One engine's answer is not the other's.
    assert analyzed(mujoco.apply(known, True)).answer is None


def test_missing_engine_is_reported_once_for_all_designs(
    state: State, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "mujoco", None)
    state = answered(state)
    for other in (state, actions.vary(state, {"links.b3": 0.5})):
        found = analyzed(other)
        text = caption(found, other)
        assert "pip install" in text
        assert str(EngineMissing("MuJoCo")).split(";")[0] in text
        shown = other.updated("plots", plot="differences")
        assert "–" in difference_html(drawn_charts(shown, found), found, 0.0)
    with pytest.raises(InvalidInput, match="pip install"):
        exports.motion_figure(state.updated("plots", plot="differences"), "png")


class Bench:
    """A session that takes actions at once, and an engine that answers when it is let."""

    closed = False

    def __init__(self, state: State, monkeypatch: pytest.MonkeyPatch) -> None:
        self.state, self.store = state, MotionStore()
        self.designs: list[float] = []
        self.may, self.came = threading.Semaphore(0), threading.Semaphore(0)
        session: Any = self
        self.checker = EngineChecker(session)
        monkeypatch.setattr(motion_plots, "ask_engine", self._answer)

    def _answer(self, request: EngineRequest) -> None:
        self.designs.append(request.analysis.design.links.b3)
        self.came.release()
        assert self.may.acquire(timeout=TIMEOUT)
        raise PaminsaError("no matter")

    def dispatch(self, source: str, action: Any, *, step: bool) -> None:
        assert not step
        self.state = action(self.state)
        self.came.release()

    def wait(self) -> None:
        """Wait until the engine is requested, or has answered."""
        assert self.came.acquire(timeout=TIMEOUT)

    def answer(self) -> None:
        """Let the engine answer, and wait until it has."""
        self.may.release()
        self.wait()

    def draw(self, b3: float, dragging: bool = False) -> None:
        self.state = actions.vary(self.state, {"links.b3": b3})
        self.checker.draw(self.store.all(self.state), "MuJoCo", dragging)


def test_newest_design_is_computed_once_nothing_is_dragged(
    state: State, monkeypatch: pytest.MonkeyPatch
) -> None:
    bench = Bench(state, monkeypatch)
    bench.draw(0.5, dragging=True)
    assert bench.designs == []
    bench.draw(0.5)
    bench.wait()
    for b3 in (0.6, 0.7, 0.8):
        bench.draw(b3)
    bench.answer()
    assert bench.state.engine_answer is None
    bench.answer()
    assert bench.designs == [0.5, 0.8]
    assert analyzed(bench.state).answer is bench.state.engine_answer is not None
    bench.draw(0.8)  # known
    bench.draw(0.5)
    bench.wait()
    bench.answer()
    assert bench.designs == [0.5, 0.8, 0.5]


def test_motion_that_plays_does_not_delay_the_engine(
    state: State, monkeypatch: pytest.MonkeyPatch
) -> None:
    bench = Bench(state, monkeypatch)
    monkeypatch.setattr(motion_plots, "IDLE_DELAY", 0.0)
    bench.draw(0.5, dragging=True)
    bench.wait()
    bench.answer()
    assert bench.designs == [0.5]


@pytest.mark.parametrize(
    ("changes", "needed"),
    [
        ({}, True),
        ({"plot": "power"}, False),
        ({"engine": False}, False),
        ({"engine": False, "plot": "differences"}, True),
    ],
    ids=str,
)
def test_engine_is_needed_where_its_torques_are_shown(
    state: State, changes: dict[str, Any], needed: bool
) -> None:
    assert state.updated("plots", **changes).plots.needs_engine is needed
