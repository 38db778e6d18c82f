"""The actions of the balance, each a pure function from state to state."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

from paminsa_viz.explorer.core import motion as motions
from paminsa_viz.explorer.core.actions import change_design, plane_job, with_design
from paminsa_viz.explorer.core.place import Place
from paminsa_viz.explorer.features.balance.solving import run
from paminsa_viz.explorer.kit.task import Task
from paminsa_viz.explorer.state.balance import (
    Balanced,
    BalanceJob,
    BalanceKind,
    Goal,
    MassFront,
)
from paminsa_viz.explorer.state.outcome import Outcome, solve
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model import Design, InvalidInput
from paminsa_viz.model.parameters import Counterweight

AnyOutcome = Outcome[BalanceJob, Any]


def change_settings(state: State, **changes: Any) -> State:
    """Change the optimization settings; a failure with earlier settings is forgotten."""
    balance = state.balance
    settings = replace(balance.settings, **changes)
    if settings == balance.settings:  # an input may say again what it holds
        return state
    refused = balance.outcome is not None and balance.outcome.error is not None
    outcome = None if refused else balance.outcome
    return state.updated("balance", settings=settings, outcome=outcome)


def choose_goal(state: State, goal: Goal) -> State:
    """Choose what is minimized: a balance is exact; other goals are not, until it is set."""
    if goal is state.balance.settings.goal:
        return state
    return change_settings(state, goal=goal, exact=goal.static)


def make_job(state: State, task: BalanceKind) -> BalanceJob:
    """Return a task for the current state, with the settings that it depends on."""
    found = motions.planned(state)
    settings = state.balance.settings.of(task)
    return plane_job(BalanceJob, state, settings, task, found.trajectory, found.problem)


def balance_now(state: State) -> State:
    """Balance as in the paper at once: it takes a few milliseconds.

    Raises:
        InvalidInput: If a task runs.
    """
    _require_idle(state)
    return receive_result(state, solve(run, make_job(state, BalanceKind.PAPER)))


def start(state: State, task: BalanceKind) -> State:
    """Start a task.

    Raises:
        InvalidInput: If another one runs.
    """
    _require_idle(state)
    return TASKS[task].start(state)


def _require_idle(state: State) -> None:
    if state.balance.running is not None:
        raise InvalidInput("balance", "the last task still runs; stop it or wait")


def receive_result(state: State, outcome: AnyOutcome) -> State:
    """Take over the outcome of a task.

    A better design is worked on from now on, the one before pinned to compare with, if that one was
    not changed in the meantime.
    """
    job, balanced = outcome.job, outcome.result
    if job.task is BalanceKind.FRONT:
        return state.updated("balance", front=outcome)
    if job.task is BalanceKind.SENSITIVITY:
        return state.updated("balance", tornado=outcome)
    if balanced is not None and state.document.design != job.design:
        error = InvalidInput("design", "it was changed in the meantime; start again")
        return state.updated("balance", outcome=Outcome(job, error=error))
    state = state.updated("balance", outcome=outcome)
    if balanced is None or balanced.after == state.document.design:
        return state
    return _compared(state, balanced.after, job.design)


def _again(state: State, outcome: AnyOutcome) -> BalanceJob:
    """Return a task anew; a design that it found and is worked on by now is no other one."""
    found, design = outcome.result, state.document.design
    job = make_job(state, outcome.job.task)
    own = isinstance(found, Balanced) and design == found.after
    own = own or (isinstance(found, MassFront) and design in found.designs)
    return replace(job, design=outcome.job.design) if own else job


def _task(kind: BalanceKind, kept: Callable[[State], AnyOutcome | None]) -> Task[BalanceJob, Any]:
    kinds = (BalanceKind.PAPER, BalanceKind.OPTIMUM)
    own = kinds if kind in kinds else (kind,)
    return Task(
        Place(lambda state: state.balance), partial(make_job, task=kind), run,
        receive=receive_result, kept=kept, own=lambda job: job.task in own, again=_again, undo=True,
    )  # fmt: skip


TASKS = {
    BalanceKind.OPTIMUM: _task(BalanceKind.OPTIMUM, lambda state: state.balance.outcome),
    BalanceKind.FRONT: _task(BalanceKind.FRONT, lambda state: state.balance.front),
    BalanceKind.SENSITIVITY: _task(BalanceKind.SENSITIVITY, lambda state: state.balance.tornado),
}
"""The tasks of the balance; one of them runs at a time."""

OPTIMUM, FRONT, SENSITIVITY = TASKS.values()


def choose_point(state: State, index: int | None) -> State:
    """Work on a point of the front, the design it was made from pinned to compare with.

    Args:
        state: A state with a front.
        index: Which point, or None for the design that the front was made from.

    Raises:
        InvalidInput: If there is no such point.
    """
    front, points = state.balance.front, state.balance.points
    if front is None or (index is not None and index not in range(len(points))):
        raise InvalidInput("front", "there is no such point")
    before = front.job.design
    chosen = before if index is None else points[index]
    return _compared(state.updated("balance", outcome=None), chosen, before)


def chosen_point(state: State) -> int | None:
    """Return which point of the front is worked on, or None."""
    points, design = state.balance.points, state.document.design
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
