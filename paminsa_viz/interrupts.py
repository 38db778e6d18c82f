"""Ctrl-C: ends the program from wherever it is, and leaves no half-written file.

A `KeyboardInterrupt` reaches only the code that is running, and only when that returns to Python: a
library's callback may swallow it, an import or a native solver is torn or not stopped at all.
Therefore the program takes no exception. The system's signal wakes a thread, and that ends the
process.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from importlib import import_module
from types import ModuleType

EXIT_CODE = 130
"""Exit code of a program stopped with Ctrl-C, as shells have it."""

TIMEOUT = 1.0
"""How long an interrupt waits at most for steps and actions [s]."""

_step = threading.RLock()
_actions: list[Callable[[], str | None]] = []


@contextmanager
def indivisible() -> Iterator[None]:
    """Keep an interrupt from ending the program within a short step, such as replacing a file."""
    with _step:
        yield


@contextmanager
def on_interrupt(action: Callable[[], str | None]) -> Iterator[None]:
    """Call ``action`` if the program is interrupted within the block.

    Args:
        action: Removes or restores what must not stay as it is. A text that it returns is the
            line that the program ends with. It must not wait for other threads.
    """
    with _step:
        _actions.append(action)
    try:
        yield
    finally:
        with _step:
            _actions.remove(action)


def exit_on_interrupt(program: str) -> None:
    """From now on let Ctrl-C end the process with `EXIT_CODE` and one line on stderr.

    The first process of a container is ended so by SIGTERM as well: Linux gives that one no signal
    for which it has no handler, and `docker stop` would wait 10 s. To be called from the main
    thread.

    Args:
        program: Name that begins the line.
    """
    reading, writing = os.pipe()
    if hasattr(os, "set_blocking"):  # not on Windows before Python 3.12, which does not ask for it
        os.set_blocking(writing, False)
    signal.set_wakeup_fd(writing, warn_on_full_buffer=False)
    signal.signal(signal.SIGINT, lambda *_: None)
    if os.getpid() == 1:
        signal.signal(signal.SIGTERM, lambda *_: None)
    # Last, as it takes longest: a signal that comes before it waits in the pipe.
    threading.Thread(target=_watch, args=(reading, program), daemon=True).start()


def _watch(reading: int, program: str) -> None:
    while (number := os.read(reading, 1)[0]) not in (signal.SIGINT, signal.SIGTERM):
        pass  # another signal that has a handler
    code = 128 + number
    deadline = threading.Timer(TIMEOUT, _end, [program, "stopped", code])
    deadline.daemon = True
    deadline.start()
    _step.acquire()  # never released: nothing begins from here on
    line = "stopped"
    for action in reversed(_actions):
        with suppress(Exception):
            line = action() or line
    _end(program, line, code)


def _end(program: str, line: str, code: int) -> None:
    with suppress(OSError):
        os.write(2, f"{program}: {line}\n".encode())
    os._exit(code)


def ignore_interrupts() -> None:
    """Let Ctrl-C do nothing from now on: the work is done, and only Python has to end."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


@contextmanager
def hidden_from_children() -> Iterator[None]:
    """Start processes that Ctrl-C does not reach: their first process ends them."""
    masks = getattr(signal, "pthread_sigmask", None)
    if masks is None:  # Windows
        yield
        return
    with _step:
        before = masks(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            yield
        finally:
            masks(signal.SIG_SETMASK, before)


def import_whole(name: str) -> ModuleType:
    """Import a module that a `KeyboardInterrupt` must not tear, such as that of a notebook's stop.

    Python would keep the parts of a library that were loaded, and every later import of it would
    fail until the process ends. An interrupt reaches the main thread alone: another one imports.

    Args:
        name: The module's full name.
    """
    if name not in sys.modules and threading.current_thread() is threading.main_thread():
        thread = threading.Thread(target=_try_import, args=(name,), daemon=True)
        thread.start()
        thread.join()
    return import_module(name)  # which waits for one that an interrupted call has begun


def _try_import(name: str) -> None:
    with suppress(Exception):  # who has asked imports again, and gets the error
        import_module(name)
