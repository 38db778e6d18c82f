"""Runs the tasks of a session on threads of their own, and the buttons that start and stop them."""

from __future__ import annotations

import logging
import threading
import time
from dataclasses import replace
from functools import partial
from operator import attrgetter
from typing import Any

from paminsa_viz.explorer.core import threads
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.core.session import IDLE_DELAY, Session
from paminsa_viz.explorer.core.tasks import keep, progress, receive, running, stop
from paminsa_viz.explorer.kit.entries import BackgroundJob, Button, Condition, Progress, given
from paminsa_viz.explorer.state import outcome as tasks
from paminsa_viz.explorer.state.outcome import Outcome
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model import PaminsaError

log = logging.getLogger(__name__)


class JobRunner:
    """A view that runs the newest job that is wanted; what comes of it is an action of the session.

    One job runs at a time, and of those that wait only the newest. A job that is no longer wanted
    is asked to stop, and its outcome is dropped.

    Attributes:
        wanted: The job that was requested last, or None.
    """

    def __init__(self, session: Session, entry: BackgroundJob) -> None:
        """Prepare for jobs of one kind."""
        self._session, self._entry = session, entry
        self._lock = threading.Lock()
        self.wanted: Any = None
        self._waiting: Any = None
        self._busy = False
        self._seen: Any = None
        self._since = 0.0

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Run the job that is wanted, unless it can wait or its outcome is known."""
        entry, state = self._entry, frame.state
        if entry.wanted is None:
            self.request(running(state, entry.key))
            return
        job, known, now = entry.wanted(frame), attrgetter(entry.key)(state), time.monotonic()
        if job != self._seen:
            self._seen, self._since = job, now
        changing = dragging and job != self.wanted and now - self._since < IDLE_DELAY
        waits = changing and given(entry.idle, state)
        self.request(None if waits or (known is not None and known.job == job) else job)

    def request(self, job: Any) -> None:
        """Run a job, unless it was the last one requested; with None, cancel what runs."""
        with self._lock:
            if job == self.wanted:
                return
            self.wanted = self._waiting = job
            if job is None or self._busy:
                return
            self._busy = True
        threads.start(self._work)

    def _work(self) -> None:
        entry = self._entry
        while True:
            with self._lock:
                job, self._waiting = self._waiting, None
                if job is None or self._session.closed:
                    self._busy = False
                    return
            try:
                outcome = tasks.solve(entry.find, job, partial(self._report, job))
            except Exception:
                log.exception("a job in the background failed: %s", entry.key)
                error = PaminsaError("it failed; details are in the program's log")
                outcome = Outcome(job, error=error)
            if self.wanted == job:
                action = partial(self._deliver, outcome)
                self._session.dispatch(f"{entry.key}.result", action, step=entry.undo)

    def _deliver(self, outcome: Outcome, state: State) -> State:
        if self._entry.receive is not None:
            return self._entry.receive(state, outcome)
        take_over = receive if self._entry.wanted is None else keep
        return take_over(state, self._entry.key, outcome)

    def _report(self, job: Any, done: float, /, **known: Any) -> bool:
        stopping = False
        if self._entry.wanted is None and self.wanted == job:
            action = partial(progress, path=self._entry.key, job=job, done=done, **known)
            self._session.dispatch(
                f"{self._entry.key}.progress", action, step=False, overtakes=True
            )
            stopping = attrgetter(self._entry.key)(self._session.state).stopping
        return stopping or self._session.closed or self.wanted != job


def is_running(path: str) -> Condition:
    """Return the condition that a job of a task runs."""
    return lambda state: running(state, path) is not None


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
            effect=partial(stop, path=path),
        ),
    )  # fmt: skip
