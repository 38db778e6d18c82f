"""The actions of the balance, each a pure function from state to state."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from paminsa_viz.explorer.actions import renamed_if_changed, with_document
from paminsa_viz.explorer.balancing.jobs import Goal, Job, Outcome, Task
from paminsa_viz.explorer.balancing.solving import run
from paminsa_viz.explorer.motion import actions as motions
from paminsa_viz.explorer.state import State
from paminsa_viz.model import Design, InvalidInput
from paminsa_viz.model.parameters import Counterweight


def change_settings(state: State, **changes: Any) -> State:
    """Change the optimization settings; a failure with earlier settings is forgotten."""
    balancing = state.balancing
    settings = replace(balancing.settings, **changes)
    if settings == balancing.settings:  # an input may say again what it holds
        return state
    refused = balancing.outcome is not None and balancing.outcome.problem is not None
    outcome = None if refused else balancing.outcome
    return state.updated("balancing", settings=settings, outcome=outcome)


def choose_goal(state: State, goal: Goal) -> State:
    """Choose what is minimized: a balance is exact; other goals are not, until it is set."""
    if goal is state.balancing.settings.goal:
        return state
    return change_settings(state, goal=goal, exact=goal.static)


def make_job(state: State, task: Task) -> Job:
    """Return a task for the current state."""
    document = state.document
    found = motions.planned(state)
    return Job(
        task, document.design, *document.pose[2:], found.trajectory,
        found.problem, state.balancing.settings, state.condition_limit,
    )  # fmt: skip


def balance_now(state: State) -> State:
    """Balance as in the paper at once: it takes a few milliseconds.

    Raises:
        InvalidInput: If another task runs.
    """
    started = start(state, Task.PAPER)
    job = started.balancing.running
    return started if job is None else receive_result(started, run(job))


def start(state: State, task: Task) -> State:
    """Start a task.

    Raises:
        InvalidInput: If another one runs.
    """
    if state.balancing.running is not None:
        raise InvalidInput("balance", "the last task still runs; stop it or wait")
    running = make_job(state, task)
    return state.updated("balancing", running=running, done=0.0)


def stop(state: State) -> State:
    """Cancel the task that runs."""
    return state.updated("balancing", running=None)


def report_progress(state: State, job: Job, done: float) -> State:
    """Show how far a task is, 0 to 1."""
    if state.balancing.running is not job:
        return state
    return state.updated("balancing", done=done)


def receive_result(state: State, outcome: Outcome) -> State:
    """Take over the outcome of the task that runs; that of an older one is dropped.

    A better design is worked on from now on, the one before pinned to compare with, if that one was
    not changed in the meantime.
    """
    if state.balancing.running is not outcome.job:
        return state
    if outcome.job.task is Task.FRONT:
        return state.updated("balancing", running=None, front=outcome)
    if outcome.job.task is Task.SENSITIVITY:
        return state.updated("balancing", running=None, tornado=outcome)
    if outcome.after is not None and state.document.design != outcome.job.design:
        problem = InvalidInput("design", "it was changed in the meantime; start again")
        outcome = Outcome(outcome.job, problem=problem)
    state = state.updated("balancing", running=None, outcome=outcome)
    if outcome.after is None or outcome.after == state.document.design:
        return state
    return _compared(state, outcome.after, outcome.job.design)


def choose_point(state: State, index: int) -> State:
    """Work on a point of the front, the design it was made from pinned to compare with.

    Raises:
        InvalidInput: If there is no such point.
    """
    found = state.balancing.front
    if found is None or index not in range(len(found.designs)):
        raise InvalidInput("front", "there is no such point")
    return _compared(
        state.updated("balancing", outcome=None), found.designs[index], found.job.design
    )


def chosen_point(state: State) -> int | None:
    """Return which point of the front is worked on, or None."""
    found = state.balancing.front
    designs = () if found is None else found.designs
    return designs.index(state.document.design) if state.document.design in designs else None


def _compared(state: State, design: Design, reference: Design) -> State:
    design = renamed_if_changed(design)
    return with_document(state, replace(state.document, design=design, reference=reference))


def set_counterweights(state: State, weights: tuple[Counterweight, ...]) -> State:
    """Attach these counterweights to every leg, and no others.

    Raises:
        InvalidDesign: If they are too many.
    """
    changed = replace(state.document.design, counterweights=weights)
    design = renamed_if_changed(changed)
    return with_document(state, replace(state.document, design=design))


def add_counterweight(state: State, bar: str, joint: int) -> State:
    """Attach a counterweight of 1 kg to a bar, 100 mm beyond one of its joints."""
    added = Counterweight(bar, joint, 0.1, 1.0)
    return set_counterweights(state, (*state.document.design.counterweights, added))


def change_counterweight(state: State, number: int, mass: float, beyond: float) -> State:
    """Change one of the counterweights [kg, m]; nothing if there is none of that number.

    Raises:
        InvalidDesign: If it is not possible.
    """
    weights = list(state.document.design.counterweights)
    if number >= len(weights):
        return state
    weights[number] = replace(weights[number], mass=mass, beyond=beyond)
    return set_counterweights(state, tuple(weights))


def remove_counterweight(state: State, number: int) -> State:
    """Remove one of the counterweights; nothing if there is none of that number."""
    weights = state.document.design.counterweights
    if number not in range(len(weights)):
        return state
    return set_counterweights(state, weights[:number] + weights[number + 1 :])
