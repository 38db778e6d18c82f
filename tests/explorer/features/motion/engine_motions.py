"""Motions whose torques an engine computes, too."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from paminsa_viz.explorer.core.motion_results import MotionResults, MotionStore
from paminsa_viz.explorer.features.motion.engine import ask_engine
from paminsa_viz.explorer.features.motion.plots import caption_html, drawn_charts
from paminsa_viz.explorer.state.outcome import solve
from paminsa_viz.explorer.state.simulation import EngineRequest
from paminsa_viz.explorer.state.state import State


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
    answer = solve(ask_engine, request)
    return replace(state, engine_answer=answer)


def engine_torques(found: MotionResults) -> Any:
    """Return the engine's torques among results."""
    assert found.answer is not None
    assert found.answer.result is not None
    return found.answer.result
