"""Tasks of the page done at once, without a thread."""

from __future__ import annotations

from typing import Any

from paminsa_viz.explorer.kit.task import Task
from paminsa_viz.explorer.state.outcome import Outcome, solve
from paminsa_viz.explorer.state.state import State


def delivered(task: Task[Any, Any], state: State, outcome: Outcome) -> State:
    """Return the state with the outcome of the run that is wanted, if there is one."""
    return task.deliver(state, task.place.read(state).ticket, outcome)


def finished(task: Task[Any, Any], started: State) -> State:
    """Return the state after the run that is wanted."""
    job = task.place.read(started).running
    assert job is not None
    return delivered(task, started, solve(task.find, job))
