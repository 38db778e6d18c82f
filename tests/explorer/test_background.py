"""One job in the background at a time: the newest wins, its outcome is an action."""

from __future__ import annotations

import threading
from types import SimpleNamespace
from typing import Any

import pytest

from paminsa_viz.explorer.core import tasks
from paminsa_viz.explorer.kit.entries import BackgroundJob, Button
from paminsa_viz.explorer.kit.task import JobRunner, task_entries
from paminsa_viz.explorer.state.outcome import Outcome
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.model import PaminsaError
from tests.support.raw_page import TIMEOUT

PATH = "tolerating"


class Bench:
    """A session that applies actions at once, and jobs that start and end when they are let."""

    closed = False

    def __init__(self) -> None:
        self.state = initial_state()
        self.sources: list[str] = []
        self.done, self.started, self.may_end = (threading.Semaphore(0) for _ in range(3))
        self.ran: list[float] = []
        self.canceled: list[bool] = []
        session: Any = self
        self.runner = JobRunner(session, BackgroundJob(PATH, find=self._find))

    def dispatch(self, source: str, action: Any, *, step: bool, overtakes: bool = False) -> None:
        assert not step
        self.state = action(self.state)
        self.sources.append(source)
        if source == f"{PATH}.result":
            self.done.release()

    def _find(self, job: float, report: Any) -> float:
        self.ran.append(job)
        self.started.release()
        assert self.may_end.acquire(timeout=TIMEOUT)
        self.canceled.append(report(0.5))
        if job > 1:
            raise PaminsaError("not possible")
        return 1 / job

    def want(self, job: float | None) -> None:
        """Have the state want a job, and draw it."""
        change = tasks.stop(self.state, PATH) if job is None else tasks.start(self.state, PATH, job)
        self.state = change
        frame: Any = SimpleNamespace(state=change)
        self.runner.draw(frame, False)

    def start(self, job: float) -> None:
        """Start a job, and wait until it runs."""
        self.want(job)
        assert self.started.acquire(timeout=TIMEOUT)

    def finish(self, count: int = 1) -> Any:
        """Let jobs end; return the task once an outcome was received."""
        self.may_end.release(count)
        assert self.done.acquire(timeout=TIMEOUT)
        assert self.state.tolerating.running is None
        return self.state.tolerating


@pytest.fixture
def bench() -> Bench:
    return Bench()


def test_newest_of_waiting_jobs_runs_and_only_its_outcome_is_received(bench: Bench) -> None:
    bench.start(0.1)
    for job in (0.2, 0.3, 0.4, 0.4):  # the same again is no new job
        bench.want(job)
    task = bench.finish(2)
    assert (task.result, task.outcome.job, task.done) == (2.5, 0.4, 0.5)
    assert bench.ran == [0.1, 0.4]
    assert bench.canceled == [True, False]
    assert bench.sources == [f"{PATH}.progress", f"{PATH}.result"]


def test_canceled_job_has_to_stop_and_its_outcome_is_dropped(bench: Bench) -> None:
    bench.start(0.1)
    bench.want(None)
    bench.may_end.release()
    bench.want(0.2)
    assert bench.finish().result == 5.0
    assert bench.ran[-1] == 0.2
    assert bench.sources.count(f"{PATH}.result") == 1


@pytest.mark.parametrize(("job", "problem"), [(2.0, "not possible"), (0.0, "the program's log")])
def test_errors_are_the_outcome_and_unexpected_ones_are_logged(
    bench: Bench, caplog: pytest.LogCaptureFixture, job: float, problem: str
) -> None:
    bench.start(job)
    task = bench.finish()
    assert task.result is None
    assert problem in task.outcome.problem
    assert ("ZeroDivisionError" in caplog.text) is (job == 0)


def test_a_task_is_started_or_stopped_and_outcomes_of_others_are_dropped() -> None:
    def start(state: State) -> State:
        return tasks.start(state, PATH, 1.0)

    entries: Any = task_entries(PATH, Button("draw", "Draw", effect=start))
    idle = initial_state()
    running = entries[0].effect(idle)
    assert [entry.visible(idle) for entry in entries] == [True, False, False]
    assert [entry.visible(running) for entry in entries] == [False, True, True]
    assert entries[1].read(tasks.progress(running, PATH, 1.0, 0.5)) == 0.5
    assert tasks.progress(running, PATH, 2.0, 0.5) is running
    assert tasks.receive(running, PATH, Outcome(2.0)) is running
    assert entries[2].effect(running) == idle
