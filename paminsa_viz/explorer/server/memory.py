"""Memory of the server's process: when the garbage collector works, and what is given back."""

from __future__ import annotations

import contextlib
import ctypes
import gc
import threading

COLLECTION_DELAY = 3.0
"""Time from the closing of a page to the freeing of its memory [s]."""

TRIM_PERIOD = 20.0
"""How often memory that open pages no longer need is given back [s]: glibc keeps it, and beside
what is in use that can be as much again."""

M_ARENA_MAX, ARENAS = -8, 2
"""How many pools of memory glibc keeps. With one for every thread, half of what the pages take
stays with the program when they are closed."""

M_MMAP_THRESHOLD, KEPT_BLOCK = -3, 2**18
"""Largest block [bytes] that glibc keeps for another use when it is freed. By itself it keeps all
that are no larger than one that was freed once, and a page takes half as much again."""


def call_allocator(function: str, *arguments: int) -> None:
    """Call a function of the C library's memory allocator, if it has it: glibc does."""
    with contextlib.suppress(OSError, AttributeError, TypeError):
        getattr(ctypes.CDLL(None), function)(*arguments)


def set_up() -> None:
    """Set the allocator, and let the garbage collector rest until `Memory.leave_loaded`.

    What is loaded stays: the collector would look through all of it four times before the first
    page is complete, and everything waits for that.
    """
    call_allocator("mallopt", M_ARENA_MAX, ARENAS)
    call_allocator("mallopt", M_MMAP_THRESHOLD, KEPT_BLOCK)
    Memory.rests = True
    gc.disable()


class Memory:
    """Frees what closed pages held, soon after they are gone, and at times what open ones did.

    A page of viser and its callbacks hold each other, so only the garbage collector frees them; on
    its own it would do so after hundreds of megabytes.

    Attributes:
        rests: Whether the garbage collector rests since `set_up`.
    """

    rests = False

    def __init__(self) -> None:
        self._closed_page, self._stopped = threading.Event(), threading.Event()
        self._left_alone = False
        threading.Thread(target=self._free, name="paminsa-memory", daemon=True).start()

    def leave_loaded(self) -> None:
        """Start the garbage collector after `set_up`; it leaves alone what is there already."""
        if self.rests:
            Memory.rests = False
            self._left_alone = True
            gc.collect()
            gc.freeze()
            gc.enable()

    def free_closed_page(self) -> None:
        """Note that a page was closed."""
        self._closed_page.set()

    def stop(self) -> None:
        """End the freeing."""
        self._stopped.set()
        self._closed_page.set()

    def _free(self) -> None:
        again = False  # a task of a closed page may have ended only after the first time
        while not self._stopped.is_set():
            closed = self._closed_page.wait(TRIM_PERIOD)
            if closed and self._stopped.wait(COLLECTION_DELAY):
                return
            self._closed_page.clear()
            if closed or again:
                from paminsa_viz.plots.text import close_fonts

                close_fonts()
                self._collect()
            again = closed
            call_allocator("malloc_trim", 0)

    def _collect(self) -> None:
        """Free all garbage, also of pages that were there when the collector started."""
        if self._left_alone:
            gc.unfreeze()
        gc.collect()
        if self._left_alone:
            gc.freeze()
