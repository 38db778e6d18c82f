"""The tab of answers: what is shown in it, when it opens by itself, and that all jobs have one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import pytest
import viser

from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.core.tab_store import TASKS
from paminsa_viz.explorer.kit import answers
from paminsa_viz.explorer.kit.answers import AnswerTab, PlacedAnswer, answers_of
from paminsa_viz.explorer.kit.entries import Answer, Entry, Folder, Html, Tabs
from paminsa_viz.explorer.state.outcome import Outcome, TaskState
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.explorer.tabs import answers as all_answers
from paminsa_viz.explorer.tabs import sections
from tests.support.desk import Desk, desk_with


def text(key: str) -> Html:
    """Return a text of an answer."""
    return Html(f"{key}.text", content=key)


FITTED = Answer(
    "fitted", "Fitted", found=lambda state: state.springs.outcome, entries=(text("fitted"),)
)
DRAWN = Answer(
    "drawn", "Drawn", found=lambda state: state.tolerances.outcome, entries=(text("drawn"),)
)
HERE = Answer("here", "At the pose", always=True, entries=(text("here"),))

PLACED = [
    PlacedAnswer("Robot/Springs", FITTED), PlacedAnswer("Robot/Springs", DRAWN),
    PlacedAnswer("Strength/Loads", HERE),
]  # fmt: skip


def test_answers_are_found_in_folders_and_tabs_with_the_path_of_their_tab() -> None:
    table = (
        FITTED,
        Folder("f", "F", entries=(HERE,)),
        Tabs("t", tabs={"Inner": (DRAWN,), "Other": (text("x"),)}),
    )
    assert [(one.path, one.answer) for one in answers_of(table, "A/B")] == [
        ("A/B", FITTED), ("A/B", HERE), ("A/B/Inner", DRAWN),
    ]  # fmt: skip


def fitted(state: State) -> State:
    """Return a state with another outcome."""
    return replace(state, springs=replace(state.springs, outcome=Outcome(job=None, result=1)))


@pytest.fixture
def desk(server: viser.ViserServer) -> Iterator[Any]:
    """A tab of answers, and what it has opened."""
    opened: list[tuple[str, bool]] = []

    def make(session: Session) -> AnswerTab:
        session.open_tab = lambda name, *, unfold=True: opened.append((name, unfold))  # type: ignore[method-assign]
        return AnswerTab(session, PLACED)

    with desk_with(server, make) as made:
        yield made, opened


def test_answer_that_comes_opens_its_tab_once_and_one_that_follows_does_not(
    desk: tuple[Desk, list[tuple[str, bool]]],
) -> None:
    page, opened = desk
    tab: AnswerTab = page.panel
    page.dispatch(lambda s: s.updated("document", pose=(0.05, 0.0, 0.0, -0.55)))
    assert opened == []
    assert tab.shown(page.state) is None
    page.session.set_window(1400.0, 900.0)
    page.dispatch(fitted)
    page.until(lambda: opened == [("Answer", True)])
    page.until(lambda: page.state.answer == "fitted")
    page.until(lambda: tab._places["fitted"].visible and not tab._places["here"].visible)
    page.dispatch(lambda s: replace(s, springs=replace(s.springs, outcome=None)))
    page.until(lambda: not tab._places["fitted"].visible)
    assert len(opened) == 1  # there is none any more: that is no answer


def test_narrow_window_says_where_the_answer_is_and_keeps_its_dock_folded(
    desk: tuple[Desk, list[tuple[str, bool]]],
) -> None:
    page, opened = desk
    page.session.set_window(1000.0, 700.0)
    page.dispatch(fitted)
    page.noticed("Answer: Fitted")
    assert opened == [("Answer", False)]


def test_answer_that_comes_is_said_to_a_screen_reader_once(
    desk: tuple[Desk, list[tuple[str, bool]]], monkeypatch: pytest.MonkeyPatch
) -> None:
    """By the region of the page, or by the notice of a narrow window."""
    page, _ = desk
    said: list[tuple[Any, ...]] = []
    monkeypatch.setattr(page.session.bridge, "call", lambda *call: said.append(call))
    page.session.set_window(1000.0, 700.0)
    page.dispatch(fitted)
    page.noticed("Answer: Fitted")
    assert ("say", "Answer: Fitted") not in said
    page.session.set_window(1400.0, 900.0)
    page.dispatch(fitted)
    page.until(lambda: said.count(("say", "Answer: Fitted")) == 1)


@pytest.mark.slow
def test_section_shows_its_answer_and_one_without_keeps_the_last(
    desk: tuple[Desk, list[tuple[str, bool]]], monkeypatch: pytest.MonkeyPatch
) -> None:
    page, opened = desk

    def open_tabs(*paths: str) -> None:
        page.session.open_tabs = frozenset(paths)
        page.dispatch(replace)

    open_tabs("Strength", "Strength/Loads")
    page.until(lambda: page.state.answer == "here")
    open_tabs("Robot", "Robot/Pose")
    page.until(lambda: page.panel._asked == frozenset())
    page.dispatch(fitted)
    page.until(lambda: page.state.answer == "fitted")
    open_tabs("Strength", "Strength/Loads")
    page.until(lambda: page.state.answer == "here")
    open_tabs("Robot", "Robot/Springs")
    page.until(lambda: page.state.answer == "fitted")
    # What is passed through on the way changes nothing.
    monkeypatch.setattr(answers, "SETTLED", 1e9)
    open_tabs("Strength", "Strength/Loads")
    page.dispatch(replace)
    assert page.state.answer == "fitted"
    assert len(opened) == 1


NEVER_FOUND = HERE.found
"""Of an answer that only follows what is shown."""

WITHOUT = {"recording", "synthesis.prices"}
"""Tasks whose outcome is a file, or is told in an answer of another task."""


def test_every_task_has_an_answer_and_no_two_have_one_key() -> None:
    placed = all_answers()
    keys = [one.answer.key for one in placed]
    assert len(set(keys)) == len(keys)
    start = initial_state()
    for place in TASKS:
        if place in WITHOUT:
            continue
        part, _, name = place.rpartition(".")
        owner: Any = start
        for each in filter(None, place.split(".")):
            owner = getattr(owner, each)
        assert isinstance(owner, TaskState)
        done = replace(owner, outcome=Outcome(job=None, result=object()))
        state = start.updated(part, **{name: done})
        news = [one for one in placed if one.answer.found(state) != one.answer.found(start)]
        assert news, f"no answer tells what comes of {place}"


def test_answer_stands_first_where_nothing_asks_for_it_and_else_below_what_does() -> None:
    """In every section and each of its inner tabs alike; those of a job are below its button."""

    def check(path: str, entries: Sequence[Entry]) -> None:
        for entry in entries:
            if isinstance(entry, Tabs):
                for name, inner in entry.tabs.items():
                    check(f"{path}/{name}", inner)
        own = [entry for entry in entries if isinstance(entry, Answer)]
        free = [one for one in own if one.always is True and one.found is NEVER_FOUND]
        assert list(entries[: len(free)]) == free, path
        assert not isinstance(entries[0], Answer) or entries[0] in free, path

    for path, section in sections().items():
        check(path, section.entries())
