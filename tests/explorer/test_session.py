"""The worker of a tab, with a page that only remembers what it was told."""

from __future__ import annotations

import contextlib
import math
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any, cast

import pytest
import viser

from paminsa_viz.explorer import actions, bindings, session
from paminsa_viz.explorer.bindings import Binding
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.inputs import Slider
from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.state import State, initial_state
from paminsa_viz.model import InvalidInput
from tests.support.raw_page import TIMEOUT, eventually


@dataclass
class Page:
    """Stands in for a tab."""

    told: list[tuple[str, str]] = field(default_factory=list)
    flushes: int = 0
    camera: SimpleNamespace = field(
        default_factory=lambda: SimpleNamespace(image_width=1280, image_height=720)
    )

    def atomic(self) -> contextlib.AbstractContextManager[None]:
        return contextlib.nullcontext()

    def flush(self) -> None:
        self.flushes += 1

    def add_notification(self, title: str, body: str, **options: Any) -> None:
        self.told.append((title, body))


class Watch:
    """A view that remembers what it drew, and can hold the worker up while it draws."""

    def __init__(self) -> None:
        self.drawn: list[tuple[State, bool]] = []
        self.gate = threading.Event()
        self.gate.set()
        self.inside = threading.Event()
        self.trouble: Exception | None = None

    def draw(self, frame: Frame, moving: bool) -> None:
        self.drawn.append((frame.state, moving))
        self.inside.set()
        assert self.gate.wait(TIMEOUT)
        if self.trouble is not None:
            raise self.trouble

    def hold(self) -> None:
        """Stop the worker in its next drawing."""
        self.inside.clear()
        self.gate.clear()


@dataclass
class Desk:
    """A started session with what stands around it."""

    session: Session
    page: Page
    immediate: Watch
    deferred: Watch

    @property
    def x(self) -> float:
        return self.session.state.document.pose[0]

    def rest(self) -> None:
        """Wait until the newest state has been drawn at rest by every view."""
        newest = self.session.state

        def drawn() -> bool:
            return all(
                w.drawn and w.drawn[-1] == (newest, False) for w in (self.immediate, self.deferred)
            )

        eventually(drawn)


@pytest.fixture
def desk(monkeypatch: pytest.MonkeyPatch) -> Iterator[Desk]:
    monkeypatch.setattr(session, "IDLE_DELAY", 0.03)
    page = Page()
    started = Session(cast(viser.ClientHandle, page), initial_state())
    desk = Desk(started, page, Watch(), Watch())
    started.immediate.append(desk.immediate)
    started.deferred.append(desk.deferred)
    started.start()
    yield desk
    for watch in (desk.immediate, desk.deferred):
        watch.gate.set()
    started.close()
    started._thread.join(TIMEOUT)
    assert not started._thread.is_alive()


def to(x: float) -> Callable[[State], State]:
    return lambda state: actions.move(state, x=x)


def test_the_first_frame_is_drawn_without_being_asked_for(desk: Desk) -> None:
    desk.rest()
    assert desk.immediate.drawn[0] == (initial_state(), True)
    assert desk.page.flushes


def test_five_hundred_requests_end_at_the_last_one(desk: Desk) -> None:
    for i in range(1, 501):
        desk.session.dispatch("slider", to(i / 5000))
    eventually(lambda: desk.x == 0.1)
    desk.rest()
    for watch in (desk.immediate, desk.deferred):
        assert watch.drawn[-1][0].document.pose[0] == 0.1
        places = [state.document.pose[0] for state, _ in watch.drawn]
        assert places == sorted(places)  # never back to an older one
        assert len(places) < 500
    desk.session.undo()
    eventually(lambda: desk.x == 0.0)  # one drag, one step


def test_of_what_came_while_drawing_only_the_newest_of_each_control_runs(desk: Desk) -> None:
    desk.rest()
    ran: list[str] = []

    def counted(name: str, intent: Callable[[State], State]) -> Callable[[State], State]:
        def run(state: State) -> State:
            ran.append(name)
            return intent(state)

        return run

    desk.immediate.hold()
    desk.session.dispatch("x", to(0.01))
    assert desk.immediate.inside.wait(TIMEOUT)
    for i in range(100):
        desk.session.dispatch("x", counted(f"x{i}", to(i / 1000)))
        desk.session.dispatch("y", counted(f"y{i}", lambda s, i=i: actions.move(s, y=i / 1000)))
    desk.immediate.gate.set()
    eventually(lambda: desk.session.state.document.pose[:2] == (0.099, 0.099))
    desk.rest()
    assert ran == ["x99", "y99"]


@pytest.mark.parametrize("error", [InvalidInput("x", "it is not liked"), RuntimeError("broken")])
def test_a_request_that_raises_changes_nothing_is_told_and_is_set_back(
    desk: Desk, error: Exception
) -> None:
    def wrong(state: State) -> State:
        raise error

    desk.rest()
    before, drawn = desk.session.state, len(desk.immediate.drawn)
    desk.session.dispatch("wrong", wrong)
    eventually(lambda: desk.page.told)
    eventually(lambda: len(desk.immediate.drawn) > drawn)  # so that the input is set back
    assert desk.session.state == before
    assert not desk.session.can_undo
    (told,) = desk.page.told
    assert told[1] == str(error) if isinstance(error, InvalidInput) else "broken" not in told[1]


def test_a_request_that_raises_takes_no_other_one_with_it(desk: Desk) -> None:
    def wrong(state: State) -> State:
        raise RuntimeError("broken")

    def wrong_job() -> None:
        raise InvalidInput("file", "it is not liked")

    done = threading.Event()
    desk.rest()
    desk.immediate.hold()
    desk.session.dispatch("start", to(0.01))
    assert desk.immediate.inside.wait(TIMEOUT)
    desk.session.dispatch("wrong", wrong)
    desk.session.dispatch("x", to(0.02))
    desk.session.submit(wrong_job)
    desk.session.submit(done.set)
    desk.immediate.gate.set()
    assert done.wait(TIMEOUT)
    desk.rest()
    assert desk.x == 0.02
    assert len(desk.page.told) == 2


def test_a_view_that_fails_does_not_end_the_session(desk: Desk) -> None:
    desk.rest()
    desk.immediate.trouble = RuntimeError("broken")
    desk.session.dispatch("x", to(0.01))
    eventually(lambda: desk.page.told)
    desk.immediate.trouble = None
    desk.session.dispatch("x", to(0.02))
    eventually(lambda: desk.x == 0.02)
    desk.rest()


def test_slow_views_wait_while_the_hand_is_ahead_but_see_the_end(desk: Desk) -> None:
    second = Watch()
    desk.session.deferred.append(second)
    desk.rest()
    views = (desk.deferred, second)  # they take turns, so that either may be the first
    for view in views:
        view.hold()
    desk.session.dispatch("x", to(0.01))
    eventually(lambda: any(view.inside.is_set() for view in views))
    waiting = next(view for view in views if not view.inside.is_set())
    desk.session.dispatch("x", to(0.02))  # while the first of the slow views draws,
    time.sleep(2 * session.DEFERRED_TIMEOUT)  # and draws
    for view in views:
        view.gate.set()
    eventually(lambda: waiting.drawn and waiting.drawn[-1][0].document.pose[0] == 0.02)
    assert 0.01 not in [state.document.pose[0] for state, _ in waiting.drawn]


def test_the_scene_goes_first_then_the_numbers_then_what_is_slow(desk: Desk) -> None:
    desk.rest()
    order: list[str] = []
    for name, views in (
        ("deferred", desk.session.deferred),
        ("fast", desk.session.fast),
        ("immediate", desk.session.immediate),
    ):
        view = SimpleNamespace(draw=lambda frame, moving, name=name: order.append(name))
        views.append(cast(session.View, view))
    desk.session.dispatch("x", to(0.03))
    eventually(lambda: len(order) == 6)  # while dragging, and once more when idle
    assert order == 2 * ["immediate", "fast", "deferred"]


def test_undo_and_redo_go_step_by_step(desk: Desk) -> None:
    assert not desk.session.can_undo
    for name, x in (("a", 0.01), ("b", 0.02), ("c", 0.03)):
        desk.session.dispatch(name, to(x))
        eventually(lambda x=x: desk.x == x)
    for x in (0.02, 0.01, 0.0):
        desk.session.undo()
        eventually(lambda x=x: desk.x == x)
    assert not desk.session.can_undo
    desk.session.undo()
    for x in (0.01, 0.02, 0.03):
        desk.session.redo()
        eventually(lambda x=x: desk.x == x)
    assert not desk.session.can_redo
    desk.rest()


def test_a_closed_session_does_nothing_more(desk: Desk) -> None:
    desk.rest()
    desk.session.close()
    desk.session._thread.join(TIMEOUT)
    assert not desk.session._thread.is_alive()
    drawn = len(desk.immediate.drawn)
    desk.session.dispatch("x", to(0.05))
    desk.session.submit(lambda: desk.page.told.append(("", "")))
    assert desk.x == 0.0
    assert len(desk.immediate.drawn) == drawn
    assert not desk.page.told


def test_a_tab_that_goes_while_it_is_drawn_leaves_quietly(
    desk: Desk, caplog: pytest.LogCaptureFixture
) -> None:
    desk.rest()
    desk.immediate.hold()
    desk.immediate.trouble = RuntimeError("the socket is gone")
    desk.session.dispatch("x", to(0.01))
    assert desk.immediate.inside.wait(TIMEOUT)
    desk.session.close()
    desk.immediate.gate.set()
    desk.session._thread.join(TIMEOUT)
    assert not desk.session._thread.is_alive()
    assert not caplog.records
    assert not desk.page.told


class Input:
    """Stands in for an input of the page: its value is set at once, its callback comes later."""

    def __init__(self, value: float) -> None:
        self.value = value
        self.callback: Callable[[Any], None] = lambda event: None

    def on_update(self, callback: Callable[[Any], None]) -> None:
        self.callback = callback

    def told(self) -> None:
        """Run the callback of a value that the page has set."""
        self.callback(SimpleNamespace(client=self))


def bound(desk: Desk, handle: Input, apply: Callable[[State, float], State]) -> Binding:
    """Bind a stand-in of an input to x, as a view of the session."""
    entry = Slider(
        "x", range=(-1.0, 1.0), step=0.001, read=lambda state: state.document.pose[0], apply=apply
    )
    binding = Binding(desk.session, entry, handle)
    view = SimpleNamespace(draw=lambda frame, dragging: binding.draw(frame.state))
    desk.session.immediate.append(cast(session.View, view))
    return binding


def test_value_set_while_another_frame_is_drawn_is_kept(desk: Desk) -> None:
    handle = Input(0.0)
    bound(desk, handle, lambda state, value: actions.move(state, x=value))
    handle.value = 0.07  # the callback is still on its way
    desk.session.dispatch("y", lambda state: actions.move(state, y=0.02))
    eventually(lambda: desk.session.state.document.pose[1] == 0.02)
    desk.rest()
    assert handle.value == 0.07
    handle.told()
    eventually(lambda: desk.x == 0.07)
    desk.session.undo()
    eventually(lambda: handle.value == 0.0)


@pytest.mark.parametrize("wrong", [0.07, math.nan, math.inf])
def test_input_is_set_back_after_a_refused_value(
    desk: Desk, wrong: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(state: State, value: float) -> State:
        raise InvalidInput("x", "it is not liked")

    monkeypatch.setattr(bindings, "TYPING_TIMEOUT", 0.05)
    handle = Input(0.0)
    bound(desk, handle, refuse)
    handle.value = wrong
    handle.told()
    eventually(lambda: handle.value == 0.0)
    assert len(desk.page.told) == 1
