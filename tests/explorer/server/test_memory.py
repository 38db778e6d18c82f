"""The garbage collector of the server rests until all is loaded; closed pages are freed anyway."""

from __future__ import annotations

import gc
import threading
import weakref
from collections.abc import Iterator

import pytest

from paminsa_viz.explorer.server import memory
from tests.support.raw_page import eventually


class Held:
    """What only the garbage collector frees."""

    def __init__(self) -> None:
        self.itself = self


@pytest.fixture
def running(monkeypatch: pytest.MonkeyPatch) -> Iterator[memory.Memory]:
    monkeypatch.setattr(memory, "COLLECTION_DELAY", 0.0)
    monkeypatch.setattr(memory, "call_allocator", lambda *_: None)
    memory.set_up()
    others = threading.enumerate()  # an explorer of other tests may run in this process
    running = memory.Memory()
    yield running
    running.stop()
    for thread in threading.enumerate():
        if thread.name == "paminsa-memory" and thread not in others:
            thread.join(10)
            assert not thread.is_alive()
    memory.Memory.rests = False
    gc.enable()


def test_collector_rests_until_all_is_loaded(running: memory.Memory) -> None:
    assert not gc.isenabled()
    loaded = Held()
    running.leave_loaded()
    assert gc.isenabled()
    assert not any(found is loaded for found in gc.get_objects())  # it is not looked through
    running.leave_loaded()
    later = Held()
    assert any(found is later for found in gc.get_objects())


@pytest.mark.parametrize("left_alone", [False, True])
def test_a_page_of_any_time_is_freed(running: memory.Memory, left_alone: bool) -> None:
    page = Held()
    freed = weakref.ref(page)
    if left_alone:
        running.leave_loaded()
    del page
    running.free_closed_page()
    eventually(lambda: freed() is None)


def test_another_process_keeps_its_collector() -> None:
    """A notebook may have an explorer."""
    kept = Held()
    running = memory.Memory()
    running.leave_loaded()
    running.stop()
    assert gc.isenabled()
    assert any(found is kept for found in gc.get_objects())
