"""One job in the background at a time: the newest wins, its result is an action."""

from __future__ import annotations

import threading
from typing import Any

import pytest

from paminsa_viz.explorer import actions
from paminsa_viz.explorer.background import BackgroundJob
from paminsa_viz.explorer.state import initial_state
from tests.support.raw_page import TIMEOUT


class Bench:
    """A session that applies actions at once, and a job that starts and ends when it is let."""

    closed = False

    def __init__(self) -> None:
        self.state = initial_state()
        self.sources: list[str] = []
        self.done, self.started, self.may_end = (threading.Semaphore(0) for _ in range(3))
        self.ran: list[float] = []
        self.canceled: list[bool] = []
        session: Any = self
        self.job: Any = BackgroundJob(
            session, "job", self._run, lambda state, x: actions.move(state, x=x),
            failed=lambda job, problem: 0.5,
            progress=lambda state, job, done: actions.move(state, y=done / 100),
        )  # fmt: skip

    def dispatch(self, source: str, action: Any, *, step: bool) -> None:
        self.state = action(self.state)
        self.sources.append(source)
        if source == "job.result":
            self.done.release()

    def _run(self, job: float, report: Any) -> float:
        self.ran.append(job)
        self.started.release()
        assert self.may_end.acquire(timeout=TIMEOUT)
        self.canceled.append(report(0.5))
        return job / (job >= 0)

    def start(self, job: float) -> None:
        """Request a job, and wait until it runs."""
        self.job.request(job)
        assert self.started.acquire(timeout=TIMEOUT)

    def finish(self, count: int = 1) -> tuple[float, ...]:
        """Let jobs end; return the position after the first result."""
        self.may_end.release(count)
        assert self.done.acquire(timeout=TIMEOUT)
        return self.state.document.pose[:2]


@pytest.fixture
def bench() -> Bench:
    return Bench()


def test_newest_of_waiting_jobs_runs_and_only_its_result_is_received(bench: Bench) -> None:
    bench.start(0.01)
    for x in (0.02, 0.03, 0.04):
        bench.job.request(x)
    bench.job.request(bench.job._wanted)  # the same again is no new job
    assert bench.finish(2) == (0.04, 0.005)
    assert bench.ran == [0.01, 0.04]
    assert bench.canceled == [True, False]
    assert bench.sources == ["job.progress", "job.result"]


def test_canceled_job_has_to_stop_and_its_result_is_dropped(bench: Bench) -> None:
    bench.start(0.01)
    bench.job.request(None)
    bench.may_end.release()
    bench.job.request(0.02)
    assert bench.finish()[0] == 0.02
    assert bench.ran[-1] == 0.02
    assert bench.sources.count("job.result") == 1


def test_unexpected_error_is_logged_and_delivered_as_a_failure(
    bench: Bench, caplog: pytest.LogCaptureFixture
) -> None:
    bench.start(-1.0)
    assert bench.finish()[0] == 0.5
    assert "ZeroDivisionError" in caplog.text
