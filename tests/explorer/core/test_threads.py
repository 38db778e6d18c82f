"""Threads that are used again, and what they keep open."""

from __future__ import annotations

import os
import threading
from pathlib import Path

import pytest

from paminsa_viz.app import App, AppOptions
from paminsa_viz.explorer.core import threads
from paminsa_viz.explorer.server import memory
from paminsa_viz.model import APPENDIX_4
from tests.support.raw_page import RawPage, eventually


def test_one_after_another_takes_one_thread() -> None:
    used: set[int] = set()

    def note() -> None:
        used.add(threading.get_ident())

    threads.start(note).join()
    for _ in range(50):
        running = threads.start(note)
        running.join(10)
        assert not running.is_alive()
    assert len(used) <= 3  # one may end just before the next one begins


def test_thread_goes_on_after_a_failure(monkeypatch: pytest.MonkeyPatch) -> None:
    hooked: list[object] = []
    monkeypatch.setattr(threading, "excepthook", lambda args: hooked.append(args.exc_value))
    error = RuntimeError("broken")

    def fail() -> None:
        raise error

    threads.start(fail).join(10)
    assert hooked == [error]
    done = threading.Event()
    threads.start(done.set)
    assert done.wait(10)


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/fd").exists(), reason="open files are not listed here")
def test_pages_that_come_and_go_leave_no_file_and_no_thread(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(memory, "COLLECTION_DELAY", 0.1)
    running = App(AppOptions(port=0, browser=False), APPENDIX_4)

    def visit() -> None:
        page = RawPage(running.server)
        number = page.client.client_id
        session = eventually(lambda: running.sessions.get(number))
        for kind in ("hello", "shown"):
            session.bridge._deliver(kind, None)
        assert session.built.wait(60)
        maps = session.deferred[0]
        eventually(lambda: maps._torques.data)  # drawn by matplotlib
        page.socket.close()
        eventually(lambda: session.closed and number not in running.sessions)

    def open_files() -> int:
        return len(os.listdir("/proc/self/fd"))

    try:
        for _ in range(2):
            visit()
        before, running_before = open_files(), threading.active_count()
        for _ in range(4):
            visit()
        eventually(lambda: open_files() <= before + 2)  # fonts that no thread uses any more
        # Not one a visit: on a busy machine more of them may run at once than in the first two.
        eventually(lambda: threading.active_count() < running_before + 4)
    finally:
        running.stop()
