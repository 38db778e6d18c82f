"""Starts and stops the tasks of a state, and takes over what comes of them."""

from __future__ import annotations

from operator import attrgetter
from typing import Any

from paminsa_viz.explorer.state.outcome import Outcome
from paminsa_viz.explorer.state.state import State


def start(state: State, path: str, job: object) -> State:
    """Start a job of the task at a place in the state, such as ``"springing"``."""
    return state.updated(path, running=job, done=0.0, stopping=False)


def stop(state: State, path: str) -> State:
    """End the job that runs, without an outcome."""
    return state.updated(path, running=None)


def progress(state: State, path: str, job: object, done: float, **known: Any) -> State:
    """Take over what part of a job is done and what is known, if it is still wanted."""
    return state.updated(path, done=done, **known) if running(state, path) == job else state


def receive(state: State, path: str, outcome: Outcome) -> State:
    """Take over the outcome of the job that runs; that of an older one is dropped."""
    if running(state, path) != outcome.job:
        return state
    return state.updated(path, running=None, outcome=outcome)


def keep(state: State, path: str, outcome: Outcome) -> State:
    """Put an outcome into its place in the state."""
    part, _, name = path.rpartition(".")
    return state.updated(part, **{name: outcome})


def running(state: State, path: str) -> object:
    """Return the job that runs, or None."""
    return attrgetter(path)(state).running
