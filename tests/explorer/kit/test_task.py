"""One job in the background at a time: the newest wins, its outcome is an action."""

from __future__ import annotations

import threading
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core.place import Place
from paminsa_viz.explorer.features.requirements.actions import LARGEST
from paminsa_viz.explorer.features.springs.actions import FIT
from paminsa_viz.explorer.features.synthesis.actions import SEARCH
from paminsa_viz.explorer.kit.entries import Button
from paminsa_viz.explorer.kit.task import Task, TaskRunner
from paminsa_viz.explorer.state.outcome import Outcome
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.model import PaminsaError
from tests.support.raw_page import TIMEOUT, eventually

PLACE = Place(lambda state: state.tolerances)


def length(state: State) -> float:
    """Return the job of a state: a number that is set."""
    return state.tolerances.settings.length * 10


def with_job(state: State, job: float) -> State:
    return state.updated("tolerances.settings", length=job / 10)


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
        self.task: Task[float, float] = Task(PLACE, length, self._find)
        self.runner = TaskRunner(session, self.task)

    def dispatch(self, source: str, action: Any, *, step: bool, **options: Any) -> None:
        assert not step
        self.state = action(self.state)
        self.sources.append(source.rpartition(".")[2])
        if source == "tolerances.result":
            self.done.release()

    def _find(self, job: float, report: Any) -> float:
        self.ran.append(job)
        self.started.release()
        assert self.may_end.acquire(timeout=TIMEOUT)
        self.canceled.append(True)
        report(0.5)
        self.canceled[-1] = False  # it goes on
        if job > 1:
            raise PaminsaError("not possible")
        return 1 / job

    def draw(self) -> None:
        """Let the view see the state."""
        frame: Any = SimpleNamespace(state=self.state)
        self.runner.draw(frame, False)

    def want(self, job: float) -> None:
        """Have the state want a job, without a view that sees it."""
        self.state = self.task.start(with_job(self.state, job))

    def start(self, job: float) -> None:
        """Start a job, and wait until it runs."""
        self.want(job)
        self.draw()
        assert self.started.acquire(timeout=TIMEOUT)

    def finish(self, count: int = 1) -> Any:
        """Let jobs end; return the task once an outcome was received."""
        self.may_end.release(count)
        assert self.done.acquire(timeout=TIMEOUT)
        return self.state.tolerances


@pytest.fixture
def bench() -> Bench:
    return Bench()


def test_newest_of_waiting_jobs_runs_and_only_its_outcome_is_received(bench: Bench) -> None:
    bench.start(0.1)
    for job in (0.2, 0.3, 0.4):
        bench.want(job)
        bench.draw()
        bench.draw()  # the same again is no new run
    task = bench.finish(2)
    assert (task.result, task.outcome.job, task.done, task.running) == (2.5, 0.4, 0.5, None)
    assert bench.ran == [0.1, 0.4]
    assert bench.canceled == [True, False]
    assert bench.sources == ["progress", "result"]


def test_canceled_job_has_to_stop_and_its_outcome_is_dropped(bench: Bench) -> None:
    bench.start(0.1)
    bench.state = bench.task.stop(bench.state)
    bench.draw()
    bench.may_end.release()
    bench.want(0.2)
    bench.draw()
    assert bench.finish().result == 5.0
    assert bench.ran[-1] == 0.2
    assert bench.sources.count("result") == 1


def test_stop_and_start_again_ends_the_old_run_though_no_view_saw_the_stop(bench: Bench) -> None:
    """The job is the same: only its ticket tells the new run from the old one."""
    bench.start(0.1)
    bench.state = bench.task.stop(bench.state)
    bench.want(0.1)
    bench.may_end.release(2)
    eventually(lambda: not bench.runner.background._busy)
    task = bench.state.tolerances
    assert (task.running, task.outcome) == (0.1, None)  # the old run has found nothing
    bench.draw()
    eventually(lambda: bench.state.tolerances.result == 10.0)
    assert bench.ran == [0.1, 0.1]
    assert bench.canceled == [True, False]
    assert bench.sources.count("progress") == 1


def test_a_run_of_a_page_that_is_closed_ends_at_once(bench: Bench) -> None:
    bench.start(0.1)
    bench.closed = True
    bench.may_end.release()
    eventually(lambda: not bench.runner.background._busy)
    assert bench.canceled == [True]
    assert bench.sources == []


def test_a_result_and_an_equal_start_in_one_turn_run_once_more(bench: Bench) -> None:
    """Views see neither that the first run has ended."""
    bench.start(0.1)
    assert bench.finish().result == 10.0
    bench.want(0.1)
    bench.draw()
    assert bench.started.acquire(timeout=TIMEOUT)
    assert bench.finish().running is None
    assert bench.ran == [0.1, 0.1]


@pytest.mark.parametrize(("job", "problem"), [(2.0, "Not possible."), (0.0, "the program’s log")])
def test_errors_are_the_outcome_and_unexpected_ones_are_logged(
    caplog: pytest.LogCaptureFixture, job: float, problem: str
) -> None:
    bench = Bench()
    bench.task = replace(bench.task, job=lambda state: job)
    bench.state = bench.task.start(bench.state)
    bench.draw()
    task = bench.finish()
    assert task.result is None
    assert problem in task.outcome.problem
    assert ("ZeroDivisionError" in caplog.text) is (job == 0)


def test_a_task_is_started_or_stopped_and_outcomes_of_others_are_dropped(bench: Bench) -> None:
    task, idle = bench.task, initial_state()
    entries: Any = task.buttons(Button("draw", "Draw", effect=task.start))
    running = entries[0].effect(idle)
    ticket = running.tolerances.ticket
    assert [entry.visible(idle) for entry in entries] == [True, False, False]
    assert [entry.visible(running) for entry in entries] == [False, True, True]
    assert entries[1].read(task.report(running, ticket, 0.5)) == 0.5
    assert task.report(running, ticket - 1, 0.5) is running
    outcome = Outcome(length(running), 1.0)
    assert task.deliver(running, ticket - 1, outcome) is running
    ended = task.deliver(running, ticket, outcome)
    assert (task.result(ended), ended.tolerances.running) == (1.0, None)
    assert task.deliver(ended, ticket, outcome) is ended
    stopped = entries[2].effect(running)
    assert (stopped.tolerances.running, stopped.tolerances.outcome) == (None, None)
    assert task.outcome(task.forget(ended)) is None


def test_a_result_says_what_has_changed_since(bench: Bench) -> None:
    task, state = bench.task, initial_state()
    made = replace(task, job=lambda state: state.tolerances.settings)
    started = made.start(state)
    found = made.deliver(started, started.tolerances.ticket, Outcome(made.job(state), 1.0))
    assert (made.is_stale(found), made.stale_text(found)) == (False, "")
    other = found.updated("tolerances.settings", mass=0.1, length=0.05)
    assert made.is_stale(other)
    assert made.stale_text(other) == "Changed since: “Masses ±” and “Lengths ±”."
    assert not made.is_stale(other.updated("tolerances", settings=state.tolerances.settings))


def test_the_size_of_the_bodies_is_no_length_and_changes_only_what_depends_on_it() -> None:
    of_robot: Task[Any, float] = Task(PLACE, lambda state: state.document, lambda job, _: 1.0)
    of_bodies, state = replace(of_robot, bodies=True), initial_state()
    started = of_robot.start(state)
    ticket = started.tolerances.ticket
    found = of_robot.deliver(started, ticket, Outcome(of_robot.job(state), 1.0))
    larger = actions.vary(found, {"geometry.body_scale": 1.5})
    assert not of_robot.is_stale(larger)
    assert of_bodies.stale_text(larger) == "Changed since: size of the bodies."
    other = actions.vary(larger, {"geometry.crank_length": 0.43})
    assert of_robot.stale_text(other) == "Changed since: lengths."
    assert of_bodies.stale_text(other) == "Changed since: lengths and size of the bodies."
    assert [SEARCH.bodies, LARGEST.bodies, FIT.bodies] == [True, True, False]
