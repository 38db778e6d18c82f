"""The worker of a tab: it draws the newest state, and failures stay single."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.explorer.core import actions, busy, history, session
from paminsa_viz.explorer.core import motion as motions
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.kit.bindings import perform
from paminsa_viz.explorer.kit.entries import Then
from paminsa_viz.explorer.state.motion import Timing
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.model import InvalidInput, PaminsaError
from tests.support.desk import SilentPage, stop
from tests.support.raw_page import TIMEOUT, eventually


class Watch:
    """A view that remembers what it drew, and can hold the worker up while it draws."""

    def __init__(self) -> None:
        self.drawn: list[tuple[State, bool]] = []
        self.gate, self.inside = threading.Event(), threading.Event()
        self.gate.set()
        self.error: Exception | None = None

    def draw(self, frame: Frame, dragging: bool) -> None:
        self.drawn.append((frame.state, dragging))
        self.inside.set()
        assert self.gate.wait(TIMEOUT)
        if self.error is not None:
            raise self.error

    def hold(self) -> None:
        """Stop the worker in its next drawing."""
        self.inside.clear()
        self.gate.clear()


class Bench:
    """A started session on a page that only listens, with two views."""

    def __init__(self) -> None:
        self.page: Any = SilentPage()
        self.session = Session(self.page, initial_state())
        self.immediate, self.deferred = Watch(), Watch()
        self.session.immediate.append(self.immediate)
        self.session.deferred.append(self.deferred)
        self.session.start()
        self.idle()

    @property
    def x(self) -> float:
        return self.session.state.document.pose[0]

    def idle(self) -> None:
        """Wait until every view has drawn the newest state when idle."""
        last = (self.session.state, False)
        eventually(
            lambda: all(w.drawn and w.drawn[-1] == last for w in (self.immediate, self.deferred))
        )

    def hold(self) -> None:
        """Stop the worker while it draws another x."""
        self.immediate.hold()
        self.session.dispatch("start", to(0.01))
        assert self.immediate.inside.wait(TIMEOUT)


@pytest.fixture
def bench(monkeypatch: pytest.MonkeyPatch) -> Iterator[Bench]:
    monkeypatch.setattr(session, "IDLE_DELAY", 0.03)
    bench = Bench()
    yield bench
    for watch in (bench.immediate, bench.deferred):
        watch.gate.set()
    stop(bench.session)


def to(x: float) -> Callable[[State], State]:
    return lambda state: actions.move(state, x=x)


def fail(error: Exception) -> Callable[..., Any]:
    """Return an action or job that raises."""

    def run(*_: Any) -> Any:
        raise error

    return run


def test_first_frame_is_drawn_at_once(bench: Bench) -> None:
    assert bench.immediate.drawn[0] == (initial_state(), True)
    assert bench.page.flushes


def test_what_is_shown_in_place_of_the_state_is_marked_as_a_preview() -> None:
    def shown(state: State) -> State:
        return actions.move(state, y=0.01) if state.document.pose[0] else state

    frames: list[Frame] = []
    view: Any = SimpleNamespace(draw=lambda frame, dragging: frames.append(frame))
    made = Session(SilentPage(), initial_state(), shown)  # type: ignore[arg-type]
    made.immediate.append(view)
    made.start()
    eventually(lambda: frames)
    made.dispatch("x", to(0.02))
    eventually(lambda: frames[-1].state.document.pose[:2] == (0.02, 0.01))
    stop(made)
    assert not frames[0].is_preview
    assert frames[-1].is_preview


def test_last_of_500_requests_wins_and_is_one_step(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(history, "PAUSE", 60.0)  # a busy machine is no pause of the person
    for i in range(1, 501):
        bench.session.dispatch("slider", to(i / 5000), overtakes=True)
    eventually(lambda: bench.x == 0.1)
    bench.idle()
    for watch in (bench.immediate, bench.deferred):
        places = [state.document.pose[0] for state, _ in watch.drawn]
        assert places == sorted(places)  # never back to an older one
        assert len(places) < 500
    bench.session.undo()
    eventually(lambda: bench.x == 0.0)


def test_value_that_was_overtaken_is_not_even_applied(bench: Bench) -> None:
    ran: list[str] = []

    def counted(name: str, action: Callable[[State], State]) -> Callable[[State], State]:
        def run(state: State) -> State:
            ran.append(name)
            return action(state)

        return run

    def opacity(value: float) -> Callable[[State], State]:
        return lambda state: replace(state, floor_opacity=value)

    bench.hold()
    for i in range(100):  # a drag, and two jobs that say how far they are
        value = i / 1000
        moved = counted(f"x{i}", to(value))
        bench.session.dispatch("x", moved, overtakes=True)
        for job in "ab":
            done = counted(f"{job}{i}", opacity(value))
            bench.session.dispatch(job, done, step=False, overtakes=True)
    bench.immediate.gate.set()
    eventually(lambda: bench.x == 0.099 and "b99" in ran)  # the last of those that may run
    assert ran == ["x99", "a99", "b99"]
    eventually(lambda: bench.session.state.floor_opacity == 0.099)


@pytest.mark.parametrize("error", [InvalidInput("x", "it is not liked"), RuntimeError("broken")])
def test_failed_request_is_notified_and_set_back_and_stops_no_other(
    bench: Bench, error: Exception
) -> None:
    before, drawn = bench.session.state, len(bench.immediate.drawn)
    bench.session.dispatch("wrong", fail(error))
    ((_, text),) = eventually(lambda: bench.page.notices)
    assert (text == f"{error}.") == isinstance(error, InvalidInput)
    assert "broken" not in text
    eventually(lambda: len(bench.immediate.drawn) > drawn)  # so that the input is set back
    assert bench.session.state == before
    assert not bench.session._history.past
    done = threading.Event()
    bench.hold()
    bench.session.dispatch("wrong", fail(error))
    bench.session.dispatch("x", to(0.02))
    bench.session.submit(fail(error))
    bench.session.submit(done.set)
    bench.immediate.gate.set()
    assert done.wait(TIMEOUT)
    assert bench.x == 0.02
    assert len(bench.page.notices) == 3


def test_failing_view_does_not_end_the_session(bench: Bench) -> None:
    bench.immediate.error = RuntimeError("broken")
    bench.session.dispatch("x", to(0.01))
    eventually(lambda: bench.page.notices)
    bench.immediate.error = None
    bench.session.dispatch("x", to(0.02))
    eventually(lambda: bench.x == 0.02)
    bench.idle()


def test_frame_that_failed_is_drawn_again_and_stops_no_other_view(bench: Bench) -> None:
    second = Watch()
    bench.session.immediate.append(second)
    failing = iter([RuntimeError("broken"), None])
    bench.immediate.error = next(failing)
    draw = bench.immediate.draw

    def once(frame: Frame, dragging: bool) -> None:
        try:
            draw(frame, dragging)
        finally:
            bench.immediate.error = next(failing, None)

    bench.immediate.draw = once  # type: ignore[method-assign]
    bench.session.dispatch("x", to(0.01))
    eventually(lambda: bench.x == 0.01)
    bench.idle()  # every view has drawn the newest state, without another change
    assert second.drawn[0][0].document.pose[0] == 0.01
    assert len(bench.page.notices) == 1


def test_frame_that_always_fails_is_not_tried_without_end(bench: Bench) -> None:
    bench.immediate.error = RuntimeError("broken")
    before = len(bench.immediate.drawn)
    bench.session.dispatch("x", to(0.01))
    eventually(lambda: len(bench.page.notices) == 2)
    time.sleep(5 * session.IDLE_DELAY)
    assert len(bench.immediate.drawn) == before + 2
    bench.immediate.error = None


def test_deferred_views_skip_states_while_dragging_but_draw_the_last(bench: Bench) -> None:
    second = Watch()
    bench.session.deferred.append(second)
    views = (bench.deferred, second)  # they take turns, so that either may be the first
    for view in views:
        view.hold()
    bench.session.dispatch("x", to(0.01))
    eventually(lambda: any(view.inside.is_set() for view in views))
    waiting = next(view for view in views if not view.inside.is_set())
    bench.session.dispatch("x", to(0.02))  # while the first of the deferred views draws,
    time.sleep(2 * session.DEFERRED_TIMEOUT)  # and draws
    for view in views:
        view.gate.set()
    eventually(lambda: waiting.drawn and waiting.drawn[-1][0].document.pose[0] == 0.02)
    assert 0.01 not in [state.document.pose[0] for state, _ in waiting.drawn]


def test_views_are_drawn_in_the_order_of_their_urgency(bench: Bench) -> None:
    order: list[str] = []
    for name in ("deferred", "fast", "immediate"):
        view: Any = SimpleNamespace(draw=lambda frame, dragging, name=name: order.append(name))
        getattr(bench.session, name).append(view)
    bench.session.dispatch("x", to(0.03))
    eventually(lambda: len(order) == 6)  # while dragging, and once more when idle
    assert order == 2 * ["immediate", "fast", "deferred"]


def test_undo_and_redo_go_step_by_step(bench: Bench) -> None:
    steps = (0.01, 0.02, 0.03)
    for x in steps:
        bench.session.dispatch(f"to {x}", to(x))
        eventually(lambda x=x: bench.x == x)
    for x in (0.02, 0.01, 0.0):
        bench.session.undo()
        eventually(lambda x=x: bench.x == x)
    assert not bench.session._history.past
    bench.session.undo()
    for x in steps:
        bench.session.redo()
        eventually(lambda x=x: bench.x == x)
    assert not bench.session._history.future


def test_undo_closes_notices_of_the_step_and_no_others(bench: Bench) -> None:
    done = ("Done", "x is 0.01 now")
    tell = Then(to(0.01), done[1])
    perform(bench.session, "x", tell)
    eventually(lambda: done in bench.page.notices)
    bench.session.notify("Exported", "a file")
    assert bench.page.removed == []
    bench.session.undo()
    eventually(lambda: bench.x == 0.0)
    eventually(lambda: bench.page.removed == [done])
    bench.session.undo()  # nothing is left to undo
    bench.session.redo()
    eventually(lambda: bench.x == 0.01)
    assert bench.page.removed == [done]


def test_page_says_that_it_computes_while_that_takes_long(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(busy, "DELAY", 0.01)
    told = ("Computing …", "")

    def slow(state: State) -> State:
        eventually(lambda: told in bench.page.notices)
        assert not bench.page.removed
        return to(0.01)(state)

    bench.session.dispatch("slow", slow)
    eventually(lambda: bench.x == 0.01)
    eventually(lambda: bench.page.removed == [told])
    # So it does of a motion that is planned for what is drawn, as after another mass.
    bench.page.notices.clear()
    bench.page.removed.clear()
    monkeypatch.setattr(session, "planned", slow)
    bench.session.built.set()
    bench.session.dispatch("x", to(0.02))
    eventually(lambda: bench.page.removed)


def test_undo_takes_back_which_poses_count(bench: Bench) -> None:
    before = bench.session.state.condition_limit
    bench.session.dispatch("limit", lambda state: replace(state, condition_limit=4.0))
    eventually(lambda: bench.session.state.condition_limit == 4.0)
    bench.session.undo()
    eventually(lambda: bench.session.state.condition_limit == before)
    bench.session.redo()
    eventually(lambda: bench.session.state.condition_limit == 4.0)


def test_closed_session_does_nothing_more(bench: Bench) -> None:
    stop(bench.session)
    drawn = len(bench.immediate.drawn)
    bench.session.dispatch("x", to(0.05))
    bench.session.submit(lambda: bench.page.notices.append(("", "")))
    bench.session.notify("Not exported", "viser warns of what a closed tab is sent")
    assert bench.x == 0.0
    assert len(bench.immediate.drawn) == drawn
    assert not bench.page.notices


def test_tab_that_closes_while_it_is_drawn_is_no_error_and_is_waited_for(
    bench: Bench, caplog: pytest.LogCaptureFixture
) -> None:
    bench.immediate.error = RuntimeError("the socket is gone")
    bench.hold()
    closing = threading.Thread(target=bench.session.close)
    closing.start()
    eventually(lambda: bench.session.closed)
    assert closing.is_alive()
    bench.immediate.gate.set()
    stop(bench.session)
    closing.join(TIMEOUT)
    assert not closing.is_alive()
    assert not caplog.records
    assert not bench.page.notices


def play_short_motion(bench: Bench, *, loop: bool) -> list[tuple[float, tuple[float, ...]]]:
    """Play a motion of 0.3 s; return the instants and poses that are drawn, as they come."""
    found: list[tuple[float, tuple[float, ...]]] = []

    def draw(frame: Frame, dragging: bool) -> None:
        found.append((frame.state.playback.time, tuple(frame.configuration.pose)))

    def play(state: State) -> State:
        short = motions.change(state, timing=Timing.GIVEN, duration=0.3)
        return motions.play(short.updated("playback", loop=loop))

    view: Any = SimpleNamespace(draw=draw)
    bench.session.immediate.append(view)
    bench.session.dispatch("play", play, step=False)
    eventually(lambda: found)
    return found


def test_motion_is_played_to_its_end_and_is_no_step(bench: Bench) -> None:
    drawn = play_short_motion(bench, loop=False)
    eventually(lambda: drawn[-1][0] == 0.3)
    eventually(lambda: not bench.session.state.playback.playing)
    times = [t for t, _ in drawn]
    assert times == sorted(times)
    assert any(0.0 < t < 0.3 for t in times)
    motion = motions.planned(bench.session.state).trajectory
    assert motion is not None
    for t, pose in drawn[-3:]:
        np.testing.assert_allclose(pose, motion.at(t).pose, atol=1e-12)
    assert not bench.session._history.past


def test_motion_repeats_until_it_is_paused(bench: Bench) -> None:
    drawn = play_short_motion(bench, loop=True)
    eventually(lambda: (np.diff([t for t, _ in drawn]) < 0).sum() >= 2)
    bench.session.dispatch("pause", motions.pause, step=False)
    eventually(lambda: not bench.session.state.playback.playing)
    stopped = bench.session.state.playback.time
    assert 0 <= stopped < 0.3
    bench.session.dispatch("play", motions.play, step=False)
    eventually(lambda: bench.session.state.playback.time != stopped)


def test_scene_that_cannot_be_drawn_is_refused_at_once(bench: Bench) -> None:
    bench.immediate.error = RuntimeError("broken")
    begin = time.monotonic()
    with pytest.raises(PaminsaError, match="could not be drawn"):
        bench.session.show_scene(bench.session.state)
    bench.immediate.error = None
    no_robot: Any = None
    with pytest.raises(PaminsaError, match="could not be drawn"):
        bench.session.show_scene(no_robot)
    assert time.monotonic() - begin < session.SCENE_TIMEOUT / 2
    bench.session.show_scene(bench.session.state)


def test_what_follows_an_action_is_done_unless_it_was_refused(bench: Bench) -> None:
    told: list[str] = []
    refuse = fail(InvalidInput("x", "it is not liked"))
    bench.session.dispatch("file", refuse, then=lambda: told.append("refused one opened"))
    bench.session.dispatch("file", to(0.02), then=lambda: told.append(f"opened at {bench.x}"))
    eventually(lambda: told)
    assert told == ["opened at 0.02"]
    assert [text for _, text in bench.page.notices] == ["x: it is not liked."]
