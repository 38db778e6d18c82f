"""Sessions without a browser: a panel driven over a socket, and a page that only listens."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator, Sequence
from types import SimpleNamespace
from typing import Any

import viser

from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.core.session import Session, View
from paminsa_viz.explorer.kit.answers import answers_of
from paminsa_viz.explorer.kit.bindings import Panel
from paminsa_viz.explorer.kit.entries import Entry
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.model import Design
from tests.support.raw_page import TIMEOUT, RawPage, eventually, update

Make = Sequence[Entry] | Callable[[Session], View]


def input_labeled(session: Session, label: str) -> Any:
    """Return viser's handle of the first input with a label."""
    inputs = list(session.client.gui._gui_input_handle_from_uuid.values())
    return next(handle for handle in inputs if getattr(handle, "label", None) == label)


def stop(session: Session) -> None:
    """End a session and wait for its worker."""
    session.close()
    session._thread.join(TIMEOUT)
    assert not session._thread.is_alive()


class SilentPage:
    """Stands in for viser's handle of a tab.

    Attributes:
        notices: Notices so far, title and text.
        removed: Those of them that were closed.
        flushes: How often it was flushed.
    """

    camera = SimpleNamespace(image_width=1280, image_height=720)
    atomic = staticmethod(contextlib.nullcontext)

    def __init__(self) -> None:
        self.notices: list[tuple[str, str]] = []
        self.removed: list[tuple[str, str]] = []
        self.flushes = 0

    def flush(self) -> None:
        """Count."""
        self.flushes += 1

    def add_notification(self, title: str, body: str, **options: Any) -> SimpleNamespace:
        """Remember a notice."""
        self.notices.append((title, body))
        return SimpleNamespace(remove=lambda: self.removed.append((title, body)))


class Whole:
    """A panel with its answers, which the page has in the left dock; all of them are drawn.

    Attributes:
        handles: viser's handles of all entries by their keys.
    """

    def __init__(self, session: Session, entries: Sequence[Entry]) -> None:
        tables = [entries, *(one.answer.entries for one in answers_of(entries))]
        self._panels = [Panel(session, table) for table in tables]
        self.handles = {key: one for panel in self._panels for key, one in panel.handles.items()}

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Follow the state."""
        for panel in self._panels:
            panel.draw(frame, dragging)


class Desk:
    """A panel on a session and a real server.

    Attributes:
        page: The socket's end.
        session: The session.
        panel: The panel.
        notices: Notices so far, title and text.
    """

    def __init__(self, server: viser.ViserServer, make: Make) -> None:
        self.page = RawPage(server)
        self.session = Session(self.page.client, initial_state())
        self.notices: list[tuple[str, str]] = []
        self.session.notify = (  # type: ignore[method-assign]
            lambda title, body, **_: self.notices.append((title, body))
        )
        self.panel: Any = make(self.session) if callable(make) else Whole(self.session, make)
        self.session.immediate.append(self.panel)
        self.session.start()

    def handle(self, name: str) -> Any:
        """Return the input with a key or, of a panel without keys, with a label."""
        handles = getattr(self.panel, "handles", {})
        return handles[name] if name in handles else input_labeled(self.session, name)

    @property
    def state(self) -> State:
        """The newest state."""
        return self.session.state

    @property
    def design(self) -> Design:
        """The current design."""
        return self.state.document.design

    def set(self, name: str, value: Any) -> None:
        """Send what the page sends when a person sets an input or presses a button."""
        self.page.send(update(self.handle(name)._impl.uuid, value))

    def say(self, kind: str, data: Any) -> None:
        """Send a message as the page does."""
        self.session.bridge._deliver(kind, data)

    def until(self, condition: Callable[[], Any]) -> Any:
        """Wait until something holds."""
        return eventually(condition)

    def noticed(self, text: str) -> None:
        """Wait until a notice contains a text."""
        eventually(lambda: any(text in title + body for title, body in self.notices))

    def dispatch(self, action: Callable[[State], State]) -> None:
        """Change the state from elsewhere, and wait until the worker has done so."""
        done: list[bool] = []
        self.session.dispatch("elsewhere", action)
        self.session.submit(lambda: done.append(True))
        eventually(lambda: done)


@contextlib.contextmanager
def desk_with(server: viser.ViserServer, make: Make) -> Iterator[Desk]:
    """Set a panel up, and clear away after it."""
    desk = Desk(server, make)
    try:
        yield desk
    finally:
        stop(desk.session)
        desk.page.socket.close()
