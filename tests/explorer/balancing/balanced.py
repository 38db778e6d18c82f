"""Balancing tasks done at once, for tests of their outcomes."""

from __future__ import annotations

from paminsa_viz.explorer import actions
from paminsa_viz.explorer.balancing import actions as balancing
from paminsa_viz.explorer.balancing.jobs import Task
from paminsa_viz.explorer.balancing.solving import run
from paminsa_viz.explorer.frame import compute
from paminsa_viz.explorer.panels.balance_text import status_html
from paminsa_viz.explorer.state import State
from paminsa_viz.model import Design
from paminsa_viz.model.parameters import Counterweight

HANGING = Counterweight("b8", 8, 0.1, 1.0)


def solved(state: State, task: Task = Task.OPTIMUM) -> State:
    """Return the state after a task, done at once."""
    started = balancing.start(state, task)
    assert started.balancing.running is not None
    return balancing.receive_result(started, run(started.balancing.running))


def with_design(state: State, design: Design) -> State:
    """Return the state with another design."""
    return actions.load_design(state, design)


def status(state: State) -> str:
    """Return what the page says of the last optimization."""
    return status_html(compute(state))
