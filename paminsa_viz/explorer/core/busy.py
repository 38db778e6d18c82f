"""A notice that the page computes, where the worker of a session takes long over it."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager

import viser

DELAY = 0.8
"""How long it takes until the page says so [s]."""


class _Notice:
    """The notice; it may be over before it is shown."""

    def __init__(self, client: viser.ClientHandle) -> None:
        self._client, self._lock = client, threading.Lock()
        self._over = False
        self._shown: viser.NotificationHandle | None = None

    def show(self) -> None:
        """Show it, unless it is over."""
        with self._lock:
            if not self._over:
                self._shown = self._client.add_notification(
                    "Computing …", "", loading=True, with_close_button=False
                )

    def end(self) -> None:
        """Remove it, if it is shown."""
        with self._lock:
            self._over = True
            if self._shown is not None:
                self._shown.remove()


@contextmanager
def saying_if_long(client: viser.ClientHandle) -> Iterator[None]:
    """Show the notice on a tab while what is within takes longer than `DELAY`."""
    notice = _Notice(client)
    timer = threading.Timer(DELAY, notice.show)
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
        notice.end()
