"""A panel on a real session and server, driven over a socket instead of by a browser."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import viser

from paminsa_viz.explorer.bindings import Panel
from paminsa_viz.explorer.entries import Entry
from paminsa_viz.explorer.inputs import Input
from paminsa_viz.explorer.session import Session, View
from paminsa_viz.explorer.state import State, initial_state
from paminsa_viz.model import Design
from tests.support.raw_page import TIMEOUT, RawPage, eventually, update

Make = Sequence[Entry] | Callable[[Session], View]


def inputs_in(entries: Sequence[Entry]) -> Iterator[Input]:
    """Yield all inputs of a table, those in folders and tabs as well."""
    for entry in entries:
        if isinstance(entry, Input):
            yield entry
        for inner in (getattr(entry, "entries", ()), *getattr(entry, "tabs", {}).values()):
            yield from inputs_in(inner)


class Desk:
    """A panel and its session.

    Attributes:
        panel: The panel.
        session: The session.
        page: The socket's end.
        told: Notices so far, title and text.
    """

    def __init__(self, server: viser.ViserServer, make: Make) -> None:
        self.page = RawPage(server)
        self.session = Session(self.page.client, initial_state())
        self.told: list[tuple[str, str]] = []
        self.session.notify = self._tell  # type: ignore[method-assign]
        self.panel: Any = make(self.session) if callable(make) else Panel(self.session, make)
        self.session.immediate.append(self.panel)
        self.session.start()

    def _tell(self, title: str, body: str, *, bad: bool = False) -> None:
        del bad
        self.told.append((title, body))

    def handle(self, key: str) -> Any:
        """Return the input with a key."""
        return self.panel.handles[key]

    @property
    def state(self) -> State:
        """The newest state."""
        return self.session.state

    @property
    def design(self) -> Design:
        """The present design."""
        return self.state.document.design

    def set(self, handle: Any, value: Any) -> None:
        """Do what the page does when a person sets an input or presses a button."""
        self.page.send(update(handle._impl.uuid, value))

    def until(self, condition: Callable[[], Any]) -> Any:
        """Wait until something holds."""
        return eventually(condition)

    def dispatch(self, intent: Callable[[State], State]) -> None:
        """Change the state from elsewhere, and wait until it has been taken."""
        done: list[bool] = []
        self.session.dispatch("elsewhere", intent)
        self.session.submit(lambda: done.append(True))
        eventually(lambda: done)


@contextmanager
def desk_with(server: viser.ViserServer, make: Make) -> Iterator[Desk]:
    """Set a panel up, and clear away after it."""
    desk = Desk(server, make)
    try:
        yield desk
    finally:
        desk.session.close()
        desk.session._thread.join(TIMEOUT)
        desk.page.socket.close()
