"""Work given to others: in order, a few tasks ahead, none left behind; who the workers are."""

from __future__ import annotations

import os
import time
from concurrent.futures import Executor, Future, process
from types import SimpleNamespace
from typing import Any

import pytest

from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.grids import usable_cores
from paminsa_viz.studies import Workers, executors, processes
from paminsa_viz.studies.executors import _start_quiet_tracker, here
from tests.support.chromium import until


class Lazy(Executor):
    """An executor that does nothing until a result is waited for."""

    def __init__(self) -> None:
        self.most = 0
        self.given: list[Future[Any]] = []

    def submit(self, fn, /, *args, **kwargs):
        future = _Waited(lambda: fn(*args, **kwargs))
        self.given.append(future)
        self.most = max(self.most, sum(not one.done() for one in self.given))
        return future


class _Waited(Future[Any]):
    def __init__(self, work) -> None:
        super().__init__()
        self._work = work

    def result(self, timeout: float | None = None) -> Any:
        if not self.done():
            self.set_result(self._work())
        return super().result(timeout)


@pytest.mark.parametrize(("count", "items"), [(1, 10), (2, 10), (2, 4), (3, 0)])
def test_results_come_in_order_with_three_tasks_of_each_worker_in_hand(
    count: int, items: int
) -> None:
    executor = Lazy()
    found = Workers(executor, count).in_order(lambda item: item**2, range(items))
    assert list(found) == [item**2 for item in range(items)]
    assert executor.most == min(3 * count, items)


def test_tasks_that_nobody_waits_for_are_canceled() -> None:
    executor = Lazy()
    found = Workers(executor, 2).in_order(lambda item: item, range(10))
    assert next(found) == 0
    found.close()
    assert [one.cancelled() for one in executor.given] == [False, *[True] * 5]


@pytest.mark.slow
def test_processes_end_with_what_they_do() -> None:
    with processes(2) as workers:
        executor = workers.executor
        assert executor is not None
        assert executor.submit(abs, -1).result() == 1
        long = executor.submit(time.sleep, 60.0)
        until(long.running, "it runs")
        begin = time.monotonic()
    assert time.monotonic() - begin < 10.0


@pytest.mark.slow
def test_a_lack_of_threads_is_what_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    """And not that the pool's own, which has not begun, cannot be waited for."""

    def start(self: Any) -> None:
        raise RuntimeError("can't start new thread")

    monkeypatch.setattr(process._ExecutorManagerThread, "start", start)
    with pytest.raises(RuntimeError, match="can't start new thread"), processes(2) as workers:
        list(workers.in_order(abs, [-1]))


def test_one_process_is_this_one() -> None:
    with processes(1) as workers:
        assert workers is here
        assert (workers.executor, workers.count) == (None, 1)
        assert list(workers.in_order(str, [1, 2])) == ["1", "2"]


def test_one_process_works_where_several_cannot(monkeypatch: pytest.MonkeyPatch) -> None:
    """As multiprocessing says where /dev/shm is missing or read-only."""

    def semaphores(*_: object, **__: object) -> None:
        raise FileNotFoundError(2, "No such file or directory")

    monkeypatch.setattr(executors, "ProcessPoolExecutor", semaphores)
    monkeypatch.setattr(executors, "usable_cores", lambda: 2)
    monkeypatch.setattr(executors.backend, "compile_now", lambda: None)
    with processes() as workers:
        assert workers is here
    with pytest.raises(InvalidInput, match="cannot work together on this system"):
        processes(2).__enter__()


@pytest.mark.parametrize("count", [0, -1])
def test_fewer_than_one_process_is_refused(count: int) -> None:
    with pytest.raises(InvalidInput, match=f"workers: one process at least is needed, not {count}"):
        processes(count).__enter__()


def test_windows_waits_for_61_processes_at_most(monkeypatch: pytest.MonkeyPatch) -> None:
    """Python refuses more there; a machine of 64 cores is no reason to fail."""
    made: list[int] = []

    def pool(count: int, **_: object) -> Executor:
        made.append(count)
        raise ArithmeticError

    monkeypatch.setattr(executors, "MOST_PROCESSES", 61)
    monkeypatch.setattr(executors, "ProcessPoolExecutor", pool)
    monkeypatch.setattr(executors, "usable_cores", lambda: 64)
    monkeypatch.setattr(executors, "_start_quiet_tracker", lambda: None)
    monkeypatch.setattr(executors.backend, "compile_now", lambda: None)
    for count in (None, 61):
        with pytest.raises(ArithmeticError):
            processes(count).__enter__()
    with pytest.raises(InvalidInput, match="on Windows there can be 61 processes at most, not 62"):
        processes(62).__enter__()
    assert made == [61, 61]


def test_cores_are_those_that_this_process_may_use(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "sched_getaffinity", lambda pid: {1, 5, 7}, raising=False)
    assert usable_cores() == 3
    monkeypatch.delattr(os, "sched_getaffinity")
    for known, expected in ((6, 6), (None, 1)):
        monkeypatch.setattr(os, "cpu_count", lambda known=known: known)
        assert usable_cores() == expected


@pytest.mark.parametrize("before", [None, "error"])
def test_warnings_of_children_are_as_before(
    monkeypatch: pytest.MonkeyPatch, before: str | None
) -> None:
    seen: list[str | None] = []
    monkeypatch.delenv("PYTHONWARNINGS", raising=False)
    if before is not None:
        monkeypatch.setenv("PYTHONWARNINGS", before)
    monkeypatch.setattr(
        "paminsa_viz.studies.executors.resource_tracker.ensure_running",
        lambda: seen.append(os.environ.get("PYTHONWARNINGS")),
    )
    _start_quiet_tracker()
    assert seen == [
        "ignore:resource_tracker" if before is None else f"{before},ignore:resource_tracker"
    ]
    assert os.environ.get("PYTHONWARNINGS") == before


def test_windows_has_no_process_that_removes_what_others_leave(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(executors, "sys", SimpleNamespace(platform="win32"))
    monkeypatch.setattr(executors.resource_tracker, "ensure_running", pytest.fail)
    _start_quiet_tracker()
