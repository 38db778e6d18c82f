"""Tasks that run in the background, as plain data of the state: what runs, and what came of it."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from operator import attrgetter
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from paminsa_viz.model import PaminsaError
from paminsa_viz.progress import Progress, go_on

if TYPE_CHECKING:
    from paminsa_viz.explorer.state import State

Job = TypeVar("Job")
Result = TypeVar("Result")


@dataclass(frozen=True, eq=False)
class Outcome(Generic[Job, Result]):
    """What came of a job.

    Attributes:
        job: The job, with all that its result depends on.
        result: What was found, or None.
        error: Why there is nothing.
        seconds: How long it took.
    """

    job: Job
    result: Result | None = None
    error: PaminsaError | None = None
    seconds: float = 0.0

    @property
    def problem(self) -> str:
        """Why there is nothing, for the page."""
        return "" if self.error is None else str(self.error)


@dataclass(frozen=True)
class TaskState(Generic[Job, Result]):
    """A task of a session.

    Attributes:
        running: The job that runs, or None.
        done: What part of it is done, 0 to 1.
        stopping: Whether it was asked to end with what it has so far.
        outcome: What came of the last one, or None.
    """

    running: Job | None = None
    done: float = 0.0
    stopping: bool = False
    outcome: Outcome[Job, Result] | None = None

    @property
    def result(self) -> Result | None:
        """What the last job found, or None."""
        return None if self.outcome is None else self.outcome.result


def solve(
    find: Callable[[Job, Progress], Result], job: Job, report: Progress = go_on
) -> Outcome[Job, Result]:
    """Return what comes of a job; what is the robot's or the person's fault is part of it."""
    start = time.monotonic()
    try:
        return Outcome(job, find(job, report), seconds=time.monotonic() - start)
    except PaminsaError as error:
        return Outcome(job, error=error)


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
