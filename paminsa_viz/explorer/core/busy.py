"""A notice that the page computes, where the worker of a session takes long over it."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial

import viser

from paminsa_viz.explorer.core import threads

DELAY = 0.8
"""How long it takes until the page says so [s]."""


@contextmanager
def saying_if_long(client: viser.ClientHandle) -> Iterator[None]:
    """Show the notice on a tab while what is within takes longer than `DELAY`."""
    over = threading.Event()
    threads.start(partial(_say_until, over, client))
    try:
        yield
    finally:
        over.set()


def _say_until(over: threading.Event, client: viser.ClientHandle) -> None:
    if over.wait(DELAY):
        return
    shown = client.add_notification("Computing …", "", loading=True, with_close_button=False)
    over.wait()
    shown.remove()
