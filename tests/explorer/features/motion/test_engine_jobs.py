"""When an engine is asked: where it is installed, and once nothing is dragged."""

from __future__ import annotations

import sys
import threading
import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from paminsa_viz.engines import EngineMissing
from paminsa_viz.engines.missing import is_installed
from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core.frame import compute
from paminsa_viz.explorer.core.motion_results import MotionStore
from paminsa_viz.explorer.features.export import exports
from paminsa_viz.explorer.features.motion.plots import ENGINE, INPUTS, difference_html, drawn_charts
from paminsa_viz.explorer.kit import task as background
from paminsa_viz.explorer.kit.entries import given
from paminsa_viz.explorer.kit.inputs import Checkbox
from paminsa_viz.explorer.kit.task import FollowerRunner
from paminsa_viz.explorer.state.simulation import EngineRequest
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model import InvalidInput, PaminsaError
from tests.explorer.features.motion.engine_motions import (
    analyzed,
    answered,
    caption,
    engine_torques,
)
from tests.support.raw_page import TIMEOUT


def test_plain_installation_has_mujoco_and_a_missing_engine_is_disabled(
    state: State, monkeypatch: pytest.MonkeyPatch
) -> None:
    project = tomllib.loads(
        (Path(__file__).parents[4] / "pyproject.toml").read_text(encoding="utf-8")
    )["project"]
    assert any(item.startswith("mujoco") for item in project["dependencies"])
    switch = next(entry for entry in INPUTS if entry.key == "plots.engine")
    assert switch.disabled is not None
    assert not switch.disabled(state)
    monkeypatch.setitem(sys.modules, "mujoco", None)
    is_installed.cache_clear()
    assert switch.disabled(state)
    assert "pip install mujoco" in given(switch.hint, state)
    monkeypatch.undo()
    is_installed.cache_clear()


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
        is_installed.cache_clear()
        assert pinocchio.disabled is not None
        assert pinocchio.disabled(state)
        assert "paminsa-viz[verify]" in given(pinocchio.hint, state)
    is_installed.cache_clear()
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

    def __init__(self, state: State) -> None:
        self.state, self.store = state, MotionStore()
        self.designs: list[float] = []
        self.may, self.came = threading.Semaphore(0), threading.Semaphore(0)
        session: Any = self
        self.runner = FollowerRunner(session, replace(ENGINE, find=self._answer))

    def _answer(self, request: EngineRequest, _: object) -> None:
        self.designs.append(request.analysis.design.links.b3)
        self.came.release()
        assert self.may.acquire(timeout=TIMEOUT)
        raise PaminsaError("no matter")

    def dispatch(self, source: str, action: Any, *, step: bool, overtakes: bool = False) -> None:
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
        self.runner.draw(compute(self.state, self.store), dragging)


def test_newest_design_is_computed_once_nothing_is_dragged(state: State) -> None:
    bench = Bench(state)
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
    bench = Bench(state)
    monkeypatch.setattr(background, "IDLE_DELAY", 0.0)
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
