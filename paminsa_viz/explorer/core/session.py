"""One browser tab: its state, its undo, its worker, its views.

Callbacks of the page only dispatch actions. One worker a session carries them out in the order they
came, and then draws the newest state: a value that was overtaken is never drawn, and the last one
always is.
"""

from __future__ import annotations

import logging
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Protocol

import viser

from paminsa_viz.explorer.browser.bridge import Bridge
from paminsa_viz.explorer.core import threads
from paminsa_viz.explorer.core.actions import Action
from paminsa_viz.explorer.core.busy import saying_if_long
from paminsa_viz.explorer.core.frame import Frame, compute
from paminsa_viz.explorer.core.history import History, Snapshot
from paminsa_viz.explorer.core.motion import advance_time, planned
from paminsa_viz.explorer.core.motion_results import MotionStore
from paminsa_viz.explorer.state.document import Document
from paminsa_viz.explorer.state.state import State, Steps
from paminsa_viz.kept import User
from paminsa_viz.model import PaminsaError
from paminsa_viz.units import as_sentence

log = logging.getLogger(__name__)

IDLE_DELAY = 0.4
"""Time without a change after which the page is idle [s]."""

FRAME_PERIOD = 1 / 30
"""Shortest time between two instants of a motion that is played [s]."""

FLUSH_DELAY = 0.01
"""Pause between the immediate views and the others [s]: what comes together the browser draws
together, so the robot would wait for the numbers; nor can one tab take a core for itself."""

DEFERRED_TIMEOUT = 0.02
"""How long a newer state waits for the deferred views of an older one while dragging [s]."""

LONGEST_CLOSING = 5.0
"""How long a session that is closed is waited for [s]."""

SCENE_TIMEOUT = 10.0
"""How long another scene is waited for [s]."""


class View(Protocol):
    """Something on the page that shows a frame.

    ``draw`` is called on the session's worker, with ``dragging`` True for every new state and once
    more with False when the page is idle. It draws what has changed since, and nothing else.
    """

    def draw(self, frame: Frame, dragging: bool, /) -> None: ...


@dataclass(frozen=True)
class _Request:
    """What waits for the worker.

    Attributes:
        run: Does it.
        source: Which input it comes from; empty for what overtakes nothing.
        step: Whether it may be a step of the history.
        changes: Whether it may change the state.
    """

    run: Callable[[], None]
    source: str = ""
    step: bool = True
    changes: bool = True


class Session:
    """The state of a tab and the worker that draws it.

    Attributes:
        client: The tab.
        immediate: Views drawn at once, before anything slower: what moves in the scene.
        fast: Views drawn a moment after that: numbers and inputs.
        deferred: Views drawn last, in turns if new states come faster: maps and other figures.
        ground: Those of them that draw in the scene.
        built: Set when all of the page is there.
        restored: Set when what the tab has kept is in the state, or it has kept nothing.
        window: Width and height of the browser's window [px].
        camera: The camera preset chosen last, and its position [m].
        motions: What is known along the motion; for the worker alone.
        exporting: Held while a file is made for the tab.
        user: The tab as one who works with results that are kept.
        open_tabs: Paths of the tabs that are open, None until the page has said so.
        paths: Paths of the tabs of sections by their names.
        linked: The document, and what else of the page the address was told last.
        unfold: What unfolds the dock of a tab, by the tab's name.
        fit_docks: Gives the docks the widths and folds that the state has.
    """

    def __init__(
        self, client: viser.ClientHandle, state: State, shown: Action = lambda state: state
    ) -> None:
        """Begin with a state.

        Args:
            client: The tab.
            state: The first state.
            shown: What is drawn of a state, if that is not the state itself.
        """
        self.client = client
        self._shown = shown
        self.immediate: list[View] = []
        self.fast: list[View] = []
        self.deferred: list[View] = []
        self.ground: list[View] = []
        self.built, self.restored = threading.Event(), threading.Event()
        # Asked now: later the panels take their part of it.
        self.window = (float(client.camera.image_width), float(client.camera.image_height))
        self._page_height: float | None = None
        self._state = state
        self._history = History()
        self._requests: list[_Request] = []
        # Only the last are still to be seen.
        self._step_notices: deque[viser.NotificationHandle] = deque(maxlen=8)
        self._lock = threading.Lock()
        self._wake = threading.Event()
        self._closed = False
        self._scene_held = False
        self.camera: tuple[str, tuple[float, float, float]] = ("", (0.0, 0.0, 0.0))
        self.motions = MotionStore()
        self.exporting = threading.Lock()
        self.user = User()
        self.open_tabs: frozenset[str] | None = None
        self.paths: Mapping[str, str] = {}
        self.linked: tuple[Document, dict[str, str]] | None = None
        self.unfold: Mapping[str, Callable[[], None]] = {}
        self.fit_docks: Callable[[], None] = lambda: None
        self._turn = 0
        self._frame_due: float | None = None
        self._thread: threads.Running | None = None

    @cached_property
    def bridge(self) -> Bridge:
        """Scripts to the tab and messages from it."""
        return Bridge(self.client, lambda: self.closed)

    @property
    def state(self) -> State:
        """The newest state."""
        return self._state

    @property
    def closed(self) -> bool:
        """Whether the tab has gone."""
        return self._closed

    def start(self) -> None:
        """Draw the first frame and start to respond."""
        self._thread = threads.start(self._run)
        self._wake.set()

    def close(self) -> None:
        """Stop the worker, as the tab has gone, and wait until it has ended what it was doing."""
        self._closed = True
        self._wake.set()
        if self._thread is not None:
            self._thread.join(LONGEST_CLOSING)
        self.user.leave()

    @property
    def pixel_ratio(self) -> float:
        """Pixels of the 3D view, which the camera counts and viser may make fewer, for one of the
        page's; the view is as high as the window."""
        height = float(self.client.camera.image_height)
        return height / self._page_height if self._page_height and height else 1.0

    def set_window(self, width: float, height: float) -> None:
        """Take the size of the window from the page, which knows its own pixels."""
        self.window, self._page_height = (width, height), height

    def shows(self, tab: str) -> bool:
        """Whether what is in a tab may be seen; without a name, it is in none."""
        return not tab or self.open_tabs is None or tab in self.open_tabs

    def open_tab(self, name: str, *, unfold: bool = True) -> None:
        """Open a tab of the page, so that what a person has asked for is seen.

        Args:
            name: That of a section; or of another tab, after those of the tabs it lies in:
                ``"Strength/Errors/Drives"``.
            unfold: Whether a dock that is folded is unfolded for it.
        """
        if unfold and name in self.unfold:
            self.unfold[name]()
        self.bridge.call("openTab", self.paths.get(name, name))

    def dispatch(
        self,
        source: str,
        action: Action,
        *,
        step: bool = True,
        overtakes: bool = False,
        then: Callable[[], None] | None = None,
    ) -> None:
        """Change the state, after all that was requested before.

        Args:
            source: Which input, button or job it comes from.
            action: Pure function from state to state. It may raise `PaminsaError`, which is
                notified and changes nothing.
            step: Whether it can be undone if it changes the document; the playing of a motion,
                which moves the robot, is no step.
            overtakes: Whether it sets anew what the last action of its source has set, as in a
                drag. Then that one is left out if it still waits, and they are one step if they
                follow each other without a pause; all else comes out as if both were carried out.
            then: Called on the worker once it has been carried out; not if it was refused.
        """
        key = source if overtakes else ""

        def run() -> None:
            self._apply(key, action, step)
            if then is not None:
                then()

        self._request(_Request(run, key, step))

    def submit(self, job: Callable[[], None]) -> None:
        """Run something on the worker, in its turn, that is no change of state."""
        self._request(_Request(job, changes=False))

    def _request(self, request: _Request) -> None:
        with self._lock:
            overtaken = _overtaken(self._requests, request)
            if overtaken is not None:
                del self._requests[overtaken]
            self._requests.append(request)
        self._wake.set()

    @contextmanager
    def holding_scene(self) -> Iterator[None]:
        """Leave the scene to who takes pictures of it; afterwards it shows the state again.

        A browser shows a body that is made anew a moment later than the worker has drawn it, so
        pictures would mix what they are of with what the page has been changed to.
        """
        self._scene_held = True
        try:
            yield
        finally:
            self._scene_held = False
            self.dispatch("scene", replace, step=False)

    def show_scene(self, state: State) -> None:
        """Draw the scene as of another state, while it is held, and wait for it.

        Raises:
            PaminsaError: If it could not be drawn.
        """
        drawn: list[bool] = []
        ended = threading.Event()

        def draw() -> None:
            try:
                _report(self._draw_together(self.immediate, compute(state, self.motions), False))
                drawn.append(True)
            finally:
                ended.set()

        self.submit(draw)
        ended.wait(SCENE_TIMEOUT)
        if not drawn:
            raise PaminsaError("the 3D view could not be drawn")

    def undo(self) -> None:
        """Undo the last step, after all that was requested before."""
        self._request(_Request(partial(self._travel, back=True)))

    def redo(self) -> None:
        """Redo the step undone last."""
        self._request(_Request(partial(self._travel, back=False)))

    def notify(self, title: str, body: str, *, bad: bool = False, of_step: bool = False) -> None:
        """Show a notice on the page, if it is still there; it closes by itself.

        Args:
            title, body: What it says.
            bad: Whether something was not possible.
            of_step: Whether it says what a step has done: undo and redo close it.
        """
        if self._closed:
            return
        notice = self.client.add_notification(
            title, body, color="red" if bad else "teal", auto_close_seconds=12 if bad else 5
        )
        if of_step:
            self._step_notices.append(notice)

    def _travel(self, *, back: bool) -> None:
        found = self._history.travel(Snapshot.of(self._state), back=back)
        if found is not None:
            while self._step_notices:
                self._step_notices.pop().remove()
            self._state = self._with_steps(found.restored(self._state))

    def _run(self) -> None:
        with self.user.working():
            self._work()

    def _work(self) -> None:
        idle_due: float | None = None
        drawn: State | None = None
        failed: State | None = None
        while not self._closed:
            due = idle_due if self._frame_due is None else self._frame_due
            self._wake.wait(None if due is None else max(0.0, due - time.monotonic()))
            self._wake.clear()
            if self._closed:
                return
            try:
                self._serve()
                self._play_on()
                if self._state is not drawn:
                    drawn = self._state
                    self._draw(drawn, dragging=True)
                    idle_due = time.monotonic() + IDLE_DELAY
                elif idle_due is not None and time.monotonic() >= idle_due:
                    idle_due = None
                    self._draw(self._state, dragging=False)
            except Exception:
                if self._closed:
                    return
                log.exception("a session could not draw")
                self.notify("Something went wrong", "Details are in the program’s log.", bad=True)
                # Once more, or it would go on showing what was before.
                again = self._state is not failed
                failed = self._state
                idle_due = time.monotonic() + IDLE_DELAY if again else None

    def _serve(self) -> None:
        """Do all that waits, in its order."""
        with self._lock:
            requests, self._requests = self._requests, []
        for request in requests:
            self.guard(request.run)

    def _apply(self, source: str, action: Action, step: bool) -> None:
        before = self._state
        # If the action fails: a new object, so that the inputs are set back to the state.
        self._state = replace(before)
        with saying_if_long(self.client):
            self._state = action(before)
        if step:
            after = Snapshot.of(self._state)
            self._history.record(Snapshot.of(before), after, source, time.monotonic())
        self._state = self._with_steps(self._state)

    def _with_steps(self, state: State) -> State:
        """Return the state with what can be undone and redone by now."""
        steps = Steps(bool(self._history.past), bool(self._history.future))
        return state if state.steps == steps else replace(state, steps=steps)

    def _play_on(self) -> None:
        """Let a motion that is played move on by the time that has passed.

        So a slow page shows fewer instants and not a slower motion.
        """
        now = time.monotonic()
        if self._frame_due is not None and now >= self._frame_due:
            self._state = advance_time(self._state, now - self._frame_due + FRAME_PERIOD)
            self._frame_due = None
        if not self._state.playback.playing:
            self._frame_due = None
        elif self._frame_due is None:
            self._frame_due = now + FRAME_PERIOD

    def guard(self, job: Callable[[], None]) -> None:
        """Run a request on this thread; its failure is notified and stops no other request."""
        try:
            with self.user.working():
                job()
        except PaminsaError as error:
            self.notify("Not possible", as_sentence(str(error)), bad=True)
        except Exception:
            if self._closed:
                return
            log.exception("a request failed")
            self.notify("Something went wrong", "Details are in the program’s log.", bad=True)

    def _draw(self, state: State, *, dragging: bool) -> None:
        shown = self._shown(state)
        if self.built.is_set():
            # A shortest motion takes seconds, and while views are drawn together nothing is sent.
            with saying_if_long(self.client):
                planned(shown)
        frame = compute(shown, self.motions, is_preview=shown is not state)
        held = self._scene_held
        errors = self._draw_together([] if held else self.immediate, frame, dragging)
        time.sleep(FLUSH_DELAY)
        errors += self._draw_together(self.fast, frame, dragging)
        due = time.monotonic() + DEFERRED_TIMEOUT
        for _ in range(len(self.deferred)):
            view = self.deferred[self._turn % len(self.deferred)]
            self._turn += 1
            if not (held and view in self.ground):
                errors += _attempt(view, frame, dragging)
            self.client.flush()
            now = time.monotonic()
            played_on = self._frame_due is not None and now >= self._frame_due
            if dragging and now > due and (played_on or self._newer_waits()):
                break  # the robot first, then the views that are still due
        _report(errors)

    def _newer_waits(self) -> bool:
        with self._lock:
            return any(request.changes for request in self._requests)

    def _draw_together(self, views: list[View], frame: Frame, dragging: bool) -> list[Exception]:
        """Draw views for one picture of the browser; one that fails stops no other."""
        errors: list[Exception] = []
        with self.client.atomic():
            for view in views:
                errors += _attempt(view, frame, dragging)
        self.client.flush()
        return errors


def _attempt(view: View, frame: Frame, dragging: bool) -> list[Exception]:
    """Draw a view; return its failure, if it fails."""
    try:
        view.draw(frame, dragging)
    except Exception as error:
        return [error]
    return []


def _report(errors: list[Exception]) -> None:
    """Raise what views have failed with."""
    if errors:
        raise ExceptionGroup("views could not be drawn", errors)


def _overtaken(waiting: Sequence[_Request], newer: _Request) -> int | None:
    """Return which request a newer one makes needless: that of its source, unless what came between
    may build on it, or is a step of its own."""
    if not newer.source:
        return None
    for index in reversed(range(len(waiting))):
        older = waiting[index]
        if older.source == newer.source:
            return index
        if not older.source or (older.step and newer.step):
            return None
    return None
