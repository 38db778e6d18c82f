"""Balancing tasks done at once, for tests of their results."""

from __future__ import annotations

from paminsa_viz.explorer.core import motion as motions
from paminsa_viz.explorer.core.frame import compute
from paminsa_viz.explorer.features.balance import actions as balancing
from paminsa_viz.explorer.features.balance.texts import status_html
from paminsa_viz.explorer.state.balance import BalanceJob, BalanceKind
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.model.parameters import Counterweight
from tests.support.tasks import finished

ATTACHED = Counterweight("b8", 8, 0.1, 1.0)

START = motions.choose_preset(initial_state(), "arch")
"""The state at the start, with a motion in the shape of an arch."""


def started(state: State, task: BalanceKind) -> tuple[State, BalanceJob]:
    """Return the state while a task runs, and its job."""
    running = balancing.start(state, task)
    assert running.balance.running is not None
    return running, running.balance.running


def solved(state: State, task: BalanceKind = BalanceKind.OPTIMUM) -> State:
    """Return the state after a task."""
    return finished(balancing.TASKS[task], started(state, task)[0])


def status(state: State) -> str:
    """Return what the page shows of the last optimization."""
    return status_html(compute(state))
