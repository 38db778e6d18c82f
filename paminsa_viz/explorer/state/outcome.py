"""Tasks that run in the background, as plain data of the state: what runs, and what came of it."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Generic, Self, TypeVar

from paminsa_viz.model import PaminsaError
from paminsa_viz.progress import Progress, go_on
from paminsa_viz.units import as_sentence

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
        """Why there is nothing, as a sentence for the page."""
        return "" if self.error is None else as_sentence(str(self.error))


@dataclass(frozen=True)
class TaskState(Generic[Job, Result]):
    """A task of a session.

    Attributes:
        running: The job that runs, or None.
        ticket: Number of the last run: what a run says counts as long as this is its number.
        done: What part of it is done, 0 to 1.
        stopping: Whether it was asked to end with what it has so far.
        outcome: What came of the last one, or None.
    """

    running: Job | None = None
    ticket: int = 0
    done: float = 0.0
    stopping: bool = False
    outcome: Outcome[Job, Result] | None = None

    @property
    def result(self) -> Result | None:
        """What the last job found, or None."""
        return None if self.outcome is None else self.outcome.result

    @property
    def kind(self) -> str:
        """Which of several kinds of jobs runs; empty at a place for jobs of one kind."""
        return ""

    @property
    def unkept(self) -> tuple[str, ...]:
        """Kinds of the jobs that a reload ends, or whose results it loses."""
        return (self.kind,) if self.running is not None or self.result is not None else ()

    def runs(self, ticket: int) -> bool:
        """Whether a run is the one that is wanted."""
        return self.running is not None and self.ticket == ticket

    def started(self, job: Job) -> Self:
        """Return the task with a run of a job, even of the same as before."""
        return replace(self, running=job, ticket=self.ticket + 1, done=0.0, stopping=False)

    def ended(self) -> Self:
        """Return the task with nothing that runs; the last outcome stays."""
        return replace(self, running=None)


def solve(
    find: Callable[[Job, Progress], Result], job: Job, progress: Progress = go_on
) -> Outcome[Job, Result]:
    """Return what comes of a job; what is the robot's or the person's fault is part of it."""
    start = time.monotonic()
    try:
        return Outcome(job, find(job, progress), seconds=time.monotonic() - start)
    except PaminsaError as error:
        return Outcome(job, error=error)
