"""One job in the background at a time: the newest wins, its result is an action."""

from __future__ import annotations

import threading
from typing import Any

import pytest

from paminsa_viz.explorer import actions
from paminsa_viz.explorer.background import BackgroundJob
from paminsa_viz.explorer.state import State, initial_state
from tests.support.raw_page import TIMEOUT


class Recorder:
    """Stands in for a session: applies actions at once."""

    closed = False

    def __init__(self) -> None:
        self.state = initial_state()
        self.sources: list[str] = []
        self.done = threading.Semaphore(0)

    def dispatch(self, source: str, action: Any, *, step: bool) -> None:
        self.state = action(self.state)
        self.sources.append(source)
        if source == "job.result":
            self.done.release()

    def wait(self) -> None:
        assert self.done.acquire(timeout=TIMEOUT)


class Work:
    """A job's function that starts and ends when it is let."""

    def __init__(self) -> None:
        self.ran: list[float] = []
        self.started, self.may_end = threading.Semaphore(0), threading.Semaphore(0)
        self.canceled: list[bool] = []

    def __call__(self, job: float, report: Any) -> float:
        self.ran.append(job)
        self.started.release()
        assert self.may_end.acquire(timeout=TIMEOUT)
        self.canceled.append(report(0.5))
        if job < 0:
            raise ZeroDivisionError
        return job


@pytest.fixture
def recorder() -> Recorder:
    return Recorder()


@pytest.fixture
def work() -> Work:
    return Work()


@pytest.fixture
def job(recorder: Recorder, work: Work) -> BackgroundJob[float, float]:
    def receive(state: State, x: float) -> State:
        return actions.move(state, x=x)

    return BackgroundJob(
        recorder, "job", work, receive, failed=lambda job, problem: 0.5,  # type: ignore[arg-type]
        progress=lambda state, job, done: actions.move(state, y=done / 100),
    )  # fmt: skip


def test_newest_of_waiting_jobs_runs_and_only_its_result_is_received(
    job: Any, work: Work, recorder: Recorder
) -> None:
    job.request(0.01)
    assert work.started.acquire(timeout=TIMEOUT)
    for x in (0.02, 0.03, 0.04):
        job.request(x)
    job.request(job._wanted)  # the same again is no new job
    work.may_end.release(2)
    recorder.wait()
    assert work.ran == [0.01, 0.04]
    assert work.canceled == [True, False]
    assert recorder.sources == ["job.progress", "job.result"]
    assert recorder.state.document.pose[:2] == (0.04, 0.005)


def test_canceled_job_is_told_to_stop_and_its_result_is_dropped(
    job: Any, work: Work, recorder: Recorder
) -> None:
    job.request(0.01)
    assert work.started.acquire(timeout=TIMEOUT)
    job.request(None)
    work.may_end.release()
    job.request(0.02)
    work.may_end.release()
    recorder.wait()
    assert work.ran[-1] == 0.02
    assert recorder.state.document.pose[0] == 0.02
    assert recorder.sources.count("job.result") == 1


def test_unexpected_error_is_logged_and_delivered_as_a_failure(
    job: Any, work: Work, recorder: Recorder, caplog: pytest.LogCaptureFixture
) -> None:
    job.request(-1.0)
    work.may_end.release()
    recorder.wait()
    assert recorder.state.document.pose[0] == 0.5
    assert "ZeroDivisionError" in caplog.text
