"""Runs the task that a session asks for on a thread of its own, and hands back its outcome."""

from __future__ import annotations

import logging
import threading

from paminsa_viz.explorer.balancing import requests
from paminsa_viz.explorer.balancing.jobs import Job, Outcome
from paminsa_viz.explorer.balancing.solving import run
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.session import Session
from paminsa_viz.model import InvalidInput

log = logging.getLogger(__name__)


class Balancer:
    """Begins what is asked for; one task at a time."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._begun: Job | None = None

    def draw(self, frame: Frame, moving: bool) -> None:
        """Begin the task that is asked for."""
        del moving
        job = frame.state.balancing.running
        if job is not None and job is not self._begun:
            self._begun = job
            name = "paminsa-balance"
            threading.Thread(target=self._work, args=(job,), name=name, daemon=True).start()

    def _work(self, job: Job) -> None:
        session = self._session

        def progress(done: float) -> bool:
            session.dispatch(
                "balance.progress", lambda s: requests.progressed(s, job, done), step=False
            )
            return session.closed or session.state.balancing.running is not job

        try:
            outcome = run(job, progress)
        except Exception:
            log.exception("balancing failed")
            problem = InvalidInput("balance", "it failed; details are in the program's log")
            outcome = Outcome(job, problem=problem)
        session.dispatch("balance.outcome", lambda state: requests.taken(state, outcome))
