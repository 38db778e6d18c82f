"""Runs the tasks of a session on threads of their own, and the buttons that start and stop them."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from operator import attrgetter
from typing import Generic

from paminsa_viz.explorer import tasks
from paminsa_viz.explorer.entries import Button, Condition, Progress
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.state import State
from paminsa_viz.explorer.tasks import Job, Outcome, Report, Result
from paminsa_viz.model import PaminsaError

log = logging.getLogger(__name__)


class JobRunner(Generic[Job, Result]):
    """Runs the newest job that is requested; what comes of it is an action of the session.

    One job runs at a time, and of those that wait only the newest. A job that is no longer wanted
    is asked to stop, and its outcome is dropped.

    Attributes:
        wanted: The job that was requested last, or None.
    """

    def __init__(
        self,
        session: Session,
        key: str,
        find: Callable[[Job, Report], Result],
        receive: Callable[[State, Outcome[Job, Result]], State],
        undo: bool = False,
    ) -> None:
        """Prepare for jobs of one kind.

        Args:
            session: The session.
            key: Name of the actions.
            find: Finds the result of a job; called on the job's thread.
            receive: Takes an outcome over into the state.
            undo: Whether what an outcome changes can be undone.
        """
        self._session, self._key, self._undo = session, key, undo
        self._find, self._receive = find, receive
        self._lock = threading.Lock()
        self.wanted: Job | None = None
        self._waiting: Job | None = None
        self._busy = False

    def request(self, job: Job | None) -> None:
        """Run a job, unless it was the last one requested; with None, cancel what runs."""
        with self._lock:
            if job == self.wanted:
                return
            self.wanted = self._waiting = job
            if job is None or self._busy:
                return
            self._busy = True
        threading.Thread(target=self._work, name=f"paminsa-{self._key}", daemon=True).start()

    def _work(self) -> None:
        while True:
            with self._lock:
                job, self._waiting = self._waiting, None
                if job is None or self._session.closed:
                    self._busy = False
                    return
            try:
                outcome = tasks.solve(self._find, job, partial(self._report, job))
            except Exception:
                log.exception("a job in the background failed: %s", self._key)
                error = PaminsaError("it failed; details are in the program's log")
                outcome = Outcome(job, error=error)
            if self.wanted == job:
                action = partial(self._deliver, outcome)
                self._session.dispatch(f"{self._key}.result", action, step=self._undo)

    def _deliver(self, outcome: Outcome[Job, Result], state: State) -> State:
        return self._receive(state, outcome)

    def _report(self, job: Job, done: float) -> bool:
        del done
        return self._session.closed or self.wanted != job


class TaskRunner(JobRunner[Job, Result]):
    """A view that runs the job that a task of the state wants, and reports its progress there."""

    def __init__(
        self,
        session: Session,
        path: str,
        find: Callable[[Job, Report], Result],
        receive: Callable[[State, Outcome[Job, Result]], State] | None = None,
        undo: bool = False,
    ) -> None:
        """Prepare for the jobs of one task; other arguments as of `JobRunner`.

        Args:
            session: The session.
            path: The task's place in the state, such as ``"springing"``.
            find: Finds the result of a job.
            receive: Takes an outcome over, where that is more than to keep it.
            undo: Whether what an outcome changes can be undone.
        """
        keep = receive or (lambda state, outcome: tasks.receive(state, path, outcome))
        super().__init__(session, path, find, keep, undo)

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Run the job that the state wants."""
        self.request(attrgetter(self._key)(frame.state).running)

    def _report(self, job: Job, done: float) -> bool:
        if self.wanted == job:
            action = partial(tasks.progress, path=self._key, job=job, done=done)
            self._session.dispatch(f"{self._key}.progress", action, step=False)
        return super()._report(job, done)


def is_running(path: str) -> Condition:
    """Return the condition that a job of a task runs."""
    return lambda state: tasks.running(state, path) is not None


def task_entries(
    path: str, start: Button, runs: Condition | None = None
) -> tuple[Button, Progress, Button]:
    """Return a task's button and, while it runs, its progress and a button that stops it.

    Args:
        path: The task's place in the state.
        start: The button that starts it.
        runs: Whether what the button started runs, where the task has several kinds of jobs.
    """
    runs, key = runs or is_running(path), start.key

    def can_start(state: State) -> bool:
        return not runs(state) and (start.visible is None or start.visible(state))

    return (
        replace(start, visible=can_start),
        Progress(f"{key}.progress", visible=runs, read=attrgetter(f"{path}.done")),
        Button(
            f"{key}.stop", "Stop", color="gray", visible=runs, undo=False,
            effect=partial(tasks.stop, path=path),
        ),
    )  # fmt: skip
