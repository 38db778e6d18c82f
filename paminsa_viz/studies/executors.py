"""Where a study's rows are computed: in this process, in several, or on a Dask cluster."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import threading
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing import resource_tracker
from multiprocessing.connection import wait
from typing import Any, TypeVar

from paminsa_viz.checks import kinds_checked
from paminsa_viz.errors import InvalidInput
from paminsa_viz.interrupts import hidden_from_children, on_interrupt
from paminsa_viz.model import backend
from paminsa_viz.model.grids import usable_cores

Item = TypeVar("Item")
Result = TypeVar("Result")

AHEAD = 3
"""Tasks in hand for each worker, the current one included."""

MOST_PROCESSES = 61 if sys.platform == "win32" else sys.maxsize
"""How many processes Python can wait for at a time."""

CONNECT_TIMEOUT = 15
"""How long to look for a cluster's scheduler [s]."""


@dataclass(frozen=True)
class Workers:
    """Where tasks run, several at a time.

    Attributes:
        executor: An executor of `concurrent.futures`, or None to work in this process.
        count: How many tasks run at a time.
    """

    executor: Executor | None = None
    count: int = 1

    def in_order(
        self, function: Callable[[Item], Result], items: Iterable[Item]
    ) -> Iterator[Result]:
        """Yield a function's results in the order of the items, a few of which are ahead."""
        if self.executor is None:
            yield from map(function, items)
            return
        waiting: deque[Future[Result]] = deque()
        try:
            for item in items:
                with hidden_from_children():  # this is where an executor starts its processes
                    waiting.append(self.executor.submit(function, item))
                if len(waiting) >= AHEAD * self.count:
                    yield waiting.popleft().result()
            while waiting:
                yield waiting.popleft().result()
        finally:
            for future in waiting:
                future.cancel()


here = Workers()
"""No other process."""


@contextmanager
def processes(count: int | None = None) -> Iterator[Workers]:
    """Work in several processes of this machine.

    Each imports the script that starts them: there, do it below ``if __name__ == "__main__":``.

    Args:
        count: Their number; None for one on each core, if they can work together here. One process
            is this one.

    Raises:
        InvalidInput: If the number is below 1 or above what the system allows, or several cannot
            work together.
    """
    given = count is not None
    count = count if count is not None else min(usable_cores(), MOST_PROCESSES)
    if count < 1:
        raise InvalidInput("workers", f"one process at least is needed, not {count}")
    if count > MOST_PROCESSES:
        problem = f"on Windows there can be {MOST_PROCESSES} processes at most, not {count}"
        raise InvalidInput("workers", problem)
    if count == 1:
        yield here
        return
    # Compiled here once, so that the processes find the formulas on the disk.
    backend.compile_now()
    # Not forked: a fork takes over threads' locks, and differs from what Windows and macOS do.
    context = multiprocessing.get_context("spawn")
    _start_quiet_tracker()
    try:
        pool = ProcessPoolExecutor(count, mp_context=context, initializer=_start_process)
    except (OSError, NotImplementedError) as error:  # no semaphores, as where /dev/shm is missing
        if given:
            problem = "processes cannot work together on this system, as without /dev/shm"
            raise InvalidInput("workers", f"{problem}; 1 works in this one") from error
        yield here
        return
    try:
        with on_interrupt(_end_processes):
            yield Workers(pool, count)
    finally:
        # Nobody waits for what they still do: a search that is canceled would go on for seconds.
        for process in list(pool._processes.values()):
            process.kill()
        with suppress(RuntimeError):  # of its own thread, where the system starts no more
            pool.shutdown(wait=True, cancel_futures=True)


@kinds_checked
@contextmanager
def cluster(address: str) -> Iterator[Workers]:
    """Work on a Dask cluster, on whose machines paminsa_viz is installed.

    Args:
        address: Of the scheduler, such as ``tcp://10.0.0.1:8786``.

    Raises:
        InvalidInput: If Dask is not installed, nothing answers there, or it has no workers.
    """
    try:
        from distributed import Client
        from distributed.comm.addressing import resolve_address
    except ImportError:
        problem = 'Dask is not installed; it comes with pip install "paminsa-viz[dask]"'
        raise InvalidInput("dask", problem) from None
    try:
        resolve_address(address)  # a client of a place that cannot be leaves slowly and noisily
        client = Client(address, timeout=CONNECT_TIMEOUT, set_as_default=False)
    except (OSError, ValueError) as error:
        raise InvalidInput("dask", f"no scheduler answers at {address[:60]}: {error}") from None
    with client:
        threads: Any = client.nthreads()
        count = sum(threads.values())
        if not count:
            raise InvalidInput("dask", f"the scheduler at {address[:60]} has no workers")
        with client.get_executor(pure=False, retries=2) as executor:
            yield Workers(executor, count)


def _start_quiet_tracker() -> None:
    """Start the process that removes what a stopped program leaves, without a word of it."""
    if sys.platform == "win32":
        return  # nothing has to be removed there, and there is no such process
    variable = "PYTHONWARNINGS"
    before = os.environ.get(variable)
    os.environ[variable] = ",".join(filter(None, (before, "ignore:resource_tracker")))
    try:
        resource_tracker.ensure_running()
    finally:
        os.environ.pop(variable) if before is None else os.environ.update({variable: before})


def _end_processes() -> None:
    for process in multiprocessing.active_children():
        process.kill()


def _start_process() -> None:
    """Prepare a worker process."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # where `hidden_from_children` can do nothing
    threading.Thread(target=_end_with_parent, daemon=True).start()
    backend.compile_now()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        wait([parent.sentinel])
        os._exit(1)
