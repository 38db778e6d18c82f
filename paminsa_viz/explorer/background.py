"""Work that takes longer than a frame, on a thread of its own."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable
from functools import partial
from typing import Generic, TypeVar

from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.state import State

log = logging.getLogger(__name__)

Job = TypeVar("Job")
Result = TypeVar("Result")

Report = Callable[[float], bool]
"""Takes what part of a job is done, 0 to 1, and returns whether to stop."""


class BackgroundJob(Generic[Job, Result]):
    """Runs the newest job that is requested; its result comes back to the session as an action.

    One job runs at a time, and of those that wait only the newest. A job that is no longer wanted
    is asked to stop, and its result is dropped.
    """

    def __init__(
        self,
        session: Session,
        key: str,
        run: Callable[[Job, Report], Result],
        receive: Callable[[State, Result], State],
        failed: Callable[[Job, str], Result],
        progress: Callable[[State, Job, float], State] | None = None,
        undo: bool = True,
    ) -> None:
        """Prepare for jobs of one kind.

        Args:
            session: The session.
            key: Name of the actions.
            run: Solves a job; called on the job's thread.
            receive: Takes a result over into the state.
            failed: The result of a job that raised what is no fault of the person's, with the text
                for the page.
            progress: Takes over what part is done.
            undo: Whether what a result changes can be undone.
        """
        self._session, self._key, self._undo = session, key, undo
        self._run, self._receive, self._failed, self._progress = run, receive, failed, progress
        self._lock = threading.Lock()
        self._wanted: Job | None = None
        self._waiting: Job | None = None
        self._busy = False

    def request(self, job: Job | None) -> None:
        """Run a job, unless it was the last one requested; with None, cancel what runs."""
        with self._lock:
            if job is self._wanted:
                return
            self._wanted = self._waiting = job
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
                result = self._run(job, partial(self._report, job))
            except Exception:
                log.exception("a job in the background failed: %s", self._key)
                result = self._failed(job, "it failed; details are in the program's log")
            if self._wanted is job:
                action = partial(self._deliver, result)
                self._session.dispatch(f"{self._key}.result", action, step=self._undo)

    def _deliver(self, result: Result, state: State) -> State:
        return self._receive(state, result)

    def _report(self, job: Job, done: float) -> bool:
        if self._progress is not None and self._wanted is job:
            progress = self._progress
            self._session.dispatch(
                f"{self._key}.progress", lambda state: progress(state, job, done), step=False
            )
        return self._session.closed or self._wanted is not job
