"""Threads that are used again: for sessions, and for tasks in the background.

matplotlib keeps the fonts that a thread has drawn with, and their files open, for each thread of
its own, also when that has ended. So there are only as many threads as have ever run at once.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from contextvars import copy_context
from queue import SimpleQueue


class Running:
    """Something that a thread does, for the same user of `kept` as who has started it."""

    def __init__(self, run: Callable[[], None]) -> None:
        self._run, self._context = run, copy_context()
        self._ended = threading.Event()

    def join(self, timeout: float | None = None) -> None:
        """Wait until it has ended, but no longer than so many seconds."""
        self._ended.wait(timeout)

    def is_alive(self) -> bool:
        """Whether it has not ended yet."""
        return not self._ended.is_set()

    def work(self) -> None:
        """Do it; what fails is for the thread's own hook, as in a thread that ends with it."""
        try:
            self._context.run(self._run)
        except Exception as error:
            thread = threading.current_thread()
            hook = threading.ExceptHookArgs((type(error), error, error.__traceback__, thread))
            threading.excepthook(hook)
        finally:
            self._ended.set()


_lock = threading.Lock()
_idle: list[SimpleQueue[Running]] = []


def start(run: Callable[[], None]) -> Running:
    """Run something on a thread that has nothing to do, or on a new one if there is none."""
    running = Running(run)
    with _lock:
        inbox = _idle.pop() if _idle else None
    if inbox is None:
        inbox = SimpleQueue()
        threading.Thread(target=_serve, args=(inbox,), name="paminsa-worker", daemon=True).start()
    inbox.put(running)
    return running


def _serve(inbox: SimpleQueue[Running]) -> None:
    while True:
        inbox.get().work()
        with _lock:
            _idle.append(inbox)
