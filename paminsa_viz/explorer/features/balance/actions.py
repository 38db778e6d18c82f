"""The actions of the balance, each a pure function from state to state."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from paminsa_viz.explorer.core import motion as motions
from paminsa_viz.explorer.core import tasks
from paminsa_viz.explorer.core.actions import change_design, plane_job, with_design
from paminsa_viz.explorer.features.balance.solving import run
from paminsa_viz.explorer.state.balance import BalanceJob, Goal, Task
from paminsa_viz.explorer.state.outcome import Outcome, solve
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model import Design, InvalidInput
from paminsa_viz.model.parameters import Counterweight


def change_settings(state: State, **changes: Any) -> State:
    """Change the optimization settings; a failure with earlier settings is forgotten."""
    balancing = state.balancing
    settings = replace(balancing.settings, **changes)
    if settings == balancing.settings:  # an input may say again what it holds
        return state
    refused = balancing.outcome is not None and balancing.outcome.error is not None
    outcome = None if refused else balancing.outcome
    return state.updated("balancing", settings=settings, outcome=outcome)


def choose_goal(state: State, goal: Goal) -> State:
    """Choose what is minimized: a balance is exact; other goals are not, until it is set."""
    if goal is state.balancing.settings.goal:
        return state
    return change_settings(state, goal=goal, exact=goal.static)


def make_job(state: State, task: Task) -> BalanceJob:
    """Return a task for the current state."""
    found = motions.planned(state)
    return plane_job(
        BalanceJob, state, state.balancing.settings, task, found.trajectory, found.problem
    )


def balance_now(state: State) -> State:
    """Balance as in the paper at once: it takes a few milliseconds.

    Raises:
        InvalidInput: If another task runs.
    """
    started = start(state, Task.PAPER)
    job = started.balancing.running
    return started if job is None else receive_result(started, solve(run, job))


def start(state: State, task: Task) -> State:
    """Start a task.

    Raises:
        InvalidInput: If another one runs.
    """
    if state.balancing.running is not None:
        raise InvalidInput("balance", "the last task still runs; stop it or wait")
    return tasks.start(state, "balancing", make_job(state, task))


def receive_result(state: State, outcome: Outcome[BalanceJob, Any]) -> State:
    """Take over the outcome of the task that runs; that of an older one is dropped.

    A better design is worked on from now on, the one before pinned to compare with, if that one was
    not changed in the meantime.
    """
    job, balanced = outcome.job, outcome.result
    if state.balancing.running != job:
        return state
    state = state.updated("balancing", running=None)
    if job.task is Task.FRONT:
        return state.updated("balancing", front=outcome)
    if job.task is Task.SENSITIVITY:
        return state.updated("balancing", tornado=outcome)
    if balanced is not None and state.document.design != job.design:
        error = InvalidInput("design", "it was changed in the meantime; start again")
        return state.updated("balancing", outcome=Outcome(job, error=error))
    state = state.updated("balancing", outcome=outcome)
    if balanced is None or balanced.after == state.document.design:
        return state
    return _compared(state, balanced.after, job.design)


def choose_point(state: State, index: int) -> State:
    """Work on a point of the front, the design it was made from pinned to compare with.

    Raises:
        InvalidInput: If there is no such point.
    """
    front, points = state.balancing.front, state.balancing.points
    if front is None or index not in range(len(points)):
        raise InvalidInput("front", "there is no such point")
    return _compared(state.updated("balancing", outcome=None), points[index], front.job.design)


def chosen_point(state: State) -> int | None:
    """Return which point of the front is worked on, or None."""
    points, design = state.balancing.points, state.document.design
    return points.index(design) if design in points else None


def _compared(state: State, design: Design, reference: Design) -> State:
    return with_design(state.updated("document", reference=reference), design)


def add_counterweight(state: State, bar: str, joint: int) -> State:
    """Attach a counterweight of 1 kg to a bar, 100 mm beyond one of its joints."""
    added = Counterweight(bar, joint, 0.1, 1.0)
    weights = (*state.document.design.counterweights, added)
    return change_design(state, counterweights=weights)


def change_counterweight(state: State, number: int, mass: float, beyond: float) -> State:
    """Change one of the counterweights [kg, m]; nothing if there is none of that number.

    Raises:
        InvalidDesign: If it is not possible.
    """
    weights = list(state.document.design.counterweights)
    if number >= len(weights):
        return state
    weights[number] = replace(weights[number], mass=mass, beyond=beyond)
    return change_design(state, counterweights=tuple(weights))


def remove_counterweight(state: State, number: int) -> State:
    """Remove one of the counterweights; nothing if there is none of that number."""
    weights = state.document.design.counterweights
    if number not in range(len(weights)):
        return state
    return change_design(state, counterweights=weights[:number] + weights[number + 1 :])
