"""The tab *Answer* of the left dock: one answer at a time, which opens it when it comes.

What an answer is, a feature declares in the table of its section, as an `Answer`.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

from paminsa_viz.explorer.browser.style import is_folded
from paminsa_viz.explorer.core.docks import ANSWER_TAB
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.kit.bindings import Panel
from paminsa_viz.explorer.kit.entries import Answer, Entry, Folder, Html, Message, Tabs
from paminsa_viz.explorer.kit.inputs import Dropdown
from paminsa_viz.explorer.kit.text import render
from paminsa_viz.explorer.state.state import State

SECTION = "answer-section"
"""Message of the page: the section of the answer was pressed."""


SETTLED = 0.3
"""How long a section is open until its answer is shown [s]: a workspace passes through another one
on the way to it. Less than `IDLE_DELAY`, after which there is a drawing at the latest."""


class PlacedAnswer(NamedTuple):
    """An answer, and the path of the tab that asks for it; empty for none."""

    path: str
    answer: Answer


def answers_of(entries: Sequence[Entry], path: str = "") -> Iterator[PlacedAnswer]:
    """Yield the answers in a table of entries.

    Args:
        entries: The table.
        path: Path of the tab that it is in, see `Session.open_tab`.
    """
    for entry in entries:
        match entry:
            case Answer():
                yield PlacedAnswer(path, entry)
            case Folder():
                yield from answers_of(entry.entries, path)
            case Tabs():
                for name, inner in entry.tabs.items():
                    yield from answers_of(inner, f"{path}/{name}")


class AnswerTab:
    """The answers, in the current container of the page."""

    def __init__(self, session: Session, answers: Sequence[PlacedAnswer]) -> None:
        """Build all of them; one is seen at a time.

        Args:
            session: The session.
            answers: The answers of all sections.
        """
        self._session = session
        self._all = {one.answer.key: one for one in answers}
        assert len(self._all) == len(answers), "two answers have the same key"
        self._seen = {key: one.answer.found(session.state) for key, one in self._all.items()}
        self._asked: frozenset[str] | None = None
        self._open, self._since = frozenset[str](), -math.inf
        self._head = Panel(session, self._heading(), ANSWER_TAB)
        self._places: dict[str, Any] = {}
        self._panels: dict[str, Panel] = {}
        for key, one in self._all.items():
            self._places[key] = session.client.gui.add_folder(None, visible=False)
            with self._places[key]:
                self._panels[key] = Panel(session, one.answer.entries, ANSWER_TAB)

    def shown(self, state: State) -> PlacedAnswer | None:
        """Return the answer that is shown, or None."""
        one = self._all.get(state.answer)
        return one if one is not None and one.answer.exists(state) else None

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Show the answer of the state; one that has just come opens the tab."""
        state = frame.state
        self._follow_sections(state)
        self._announce(state)
        one = self.shown(state)
        key = "" if one is None else one.answer.key
        for each, place in self._places.items():
            if place.visible != (each == key):
                place.visible = each == key
        self._head.draw(frame, dragging)
        if key:
            self._panels[key].draw(frame, dragging)

    def _announce(self, state: State) -> None:
        """Show what has come since the last time."""
        now = {key: one.answer.found(state) for key, one in self._all.items()}
        come = [key for key, found in now.items() if found not in (None, self._seen[key])]
        self._seen = now
        if not come:
            return
        answer = self._all[come[-1]].answer
        self._session.dispatch("answer", answer.show, step=False)
        narrow = is_folded(self._session.window[0])
        self._session.open_tab(ANSWER_TAB, unfold=not narrow)
        title = f"Answer: {answer.label}"
        if narrow:
            self._session.notify(title, "It is in the dock on the left.")
        else:
            self._session.bridge.call("say", title)  # a notice is said by itself

    def _follow_sections(self, state: State) -> None:
        """Show an answer of the section that has been opened; one that asks for none keeps it."""
        paths = {one.path for one in self._all.values()}
        asked = frozenset(self._session.open_tabs or ()) & paths
        if asked != self._open:
            self._open, self._since = asked, time.monotonic()
        if asked == self._asked or time.monotonic() - self._since < SETTLED:
            return
        self._asked = asked
        own = [one.answer for one in self._all.values() if one.path in asked]
        keys = [answer.key for answer in own if answer.exists(state)]
        if own and state.answer not in keys:
            first = next(iter(keys), "")
            self._session.dispatch("answer", lambda now: replace(now, answer=first), step=False)

    def _heading(self) -> tuple[Entry, ...]:
        return (
            Message(SECTION, receive=self._go),
            Dropdown(
                "answer", "Answer", options=self._options, undo=False,
                visible=lambda state: len(self._options(state)) > 1,
                hint="Whatever there is an answer to",
                read=self._chosen, apply=lambda state, key: replace(state, answer=key),
            ),
            Html("answer.heading", content=self._title),
        )  # fmt: skip

    def _options(self, state: State) -> dict[str, str]:
        found = {
            str(one.answer.label): key for key, one in self._all.items() if one.answer.exists(state)
        }
        return found if self.shown(state) is not None else {"–": "", **found}

    def _chosen(self, state: State) -> str:
        return "" if self.shown(state) is None else state.answer

    def _title(self, frame: Frame) -> str:
        one = self.shown(frame.state)
        if one is None:
            return render("answer.j2", label="", path="", message="")
        return render(
            "answer.j2", label=one.answer.label, path=one.path.replace("/", " · "), message=SECTION
        )

    def _go(self, session: Session, data: Any) -> None:
        """Open the section of the answer; ``data`` comes from the page."""
        one = self.shown(session.state)
        if one is not None and one.path:
            session.open_tab(one.path)
