"""One browser tab: its state, its worker, its views.

Callbacks of the page only say that something was touched. One worker a session reads what was
touched, makes the next state, and draws the newest one; a value that has been overtaken is never
drawn, and the last one always is.
"""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Protocol

import viser

from paminsa_viz.explorer import actions
from paminsa_viz.explorer.frame import Frame, compute
from paminsa_viz.explorer.history import History
from paminsa_viz.explorer.placing import start_width
from paminsa_viz.explorer.state import State
from paminsa_viz.model import PaminsaError

log = logging.getLogger(__name__)

Intent = Callable[[State], State]

REST = 0.4
"""Time without a change after which the hand counts as resting [s]."""

BREATH = 0.01
"""Pause between the first views and the others [s]. The browser puts what comes together into one
picture, and shows the robot only when it has read all the numbers; nor can one tab take a core for
itself."""

PATIENCE = 0.02
"""How long a newer position of the hand waits for the slower views of an older one [s]."""


class View(Protocol):
    """Something on the page that shows a frame.

    ``draw`` is called on the session's worker, with ``moving`` True while the hand moves and once
    more with False when it rests. It draws what has changed since it last drew, and nothing else.
    """

    def draw(self, frame: Frame, moving: bool) -> None: ...


class Session:
    """The state of a tab and the worker that draws it.

    Attributes:
        client: The tab.
        first: Views drawn at once, before anything slower: what moves in the scene.
        words: Views drawn a moment after that: numbers and inputs.
        later: Views drawn last, in turns if the hand is quicker: maps and other figures.
        built: Set when all of the page is there.
        panel_width: Width of the map panel at the start [px].
    """

    def __init__(self, client: viser.ClientHandle, state: State) -> None:
        self.client = client
        self.first: list[View] = []
        self.words: list[View] = []
        self.later: list[View] = []
        self.built = threading.Event()
        # Asked now: later the control panel takes its part of the window.
        self.panel_width = start_width(client.camera.image_width, client.camera.image_height)
        self._state = state
        self._history = History()
        self._intents: dict[str, tuple[Intent, bool]] = {}
        self._jobs: list[Callable[[], None]] = []
        self._lock = threading.Lock()
        self._wake = threading.Event()
        self._closed = False
        self._turn = 0
        self._thread = threading.Thread(target=self._run, name="paminsa-session", daemon=True)

    @property
    def state(self) -> State:
        """The newest state."""
        return self._state

    @property
    def can_undo(self) -> bool:
        """Whether there is a step to undo."""
        return bool(self._history.past)

    @property
    def can_redo(self) -> bool:
        """Whether there is a step to redo."""
        return bool(self._history.future)

    @property
    def closed(self) -> bool:
        """Whether the tab has gone."""
        return self._closed

    def start(self) -> None:
        """Draw the first frame and begin to answer."""
        self._thread.start()
        self._wake.set()

    def close(self) -> None:
        """Stop the worker; the tab has gone."""
        self._closed = True
        self._wake.set()

    def dispatch(self, source: str, intent: Intent, *, step: bool = True) -> None:
        """Ask for a change of state; a newer request of the same source replaces an older one.

        Args:
            source: Which control asks; its unfinished earlier request is forgotten.
            intent: Pure function from state to state. It may raise `PaminsaError`, which is shown
                to the person and changes nothing.
            step: Whether it can be undone if it changes the document; the playing of a motion,
                which moves the robot, is no step.
        """
        with self._lock:
            self._intents.pop(source, None)
            self._intents[source] = (intent, step)
        self._wake.set()

    def submit(self, job: Callable[[], None]) -> None:
        """Run something on the worker that is no change of state, such as an export."""
        with self._lock:
            self._jobs.append(job)
        self._wake.set()

    def undo(self) -> None:
        """Take the last step back."""
        self.submit(lambda: self._travel(self._history.undo))

    def redo(self) -> None:
        """Take the last undo back."""
        self.submit(lambda: self._travel(self._history.redo))

    def notify(self, title: str, body: str, *, bad: bool = False) -> None:
        """Show a notice on the page."""
        self.client.add_notification(
            title, body, color="red" if bad else "teal", auto_close_seconds=12 if bad else 5
        )

    def _travel(self, step: Callable[..., object]) -> None:
        document = step(self._state.document)
        if document is not None:
            self._state = actions.restore(self._state, document)  # type: ignore[arg-type]

    def _run(self) -> None:
        resting_due: float | None = None
        drawn: State | None = None
        while not self._closed:
            timeout = None if resting_due is None else max(0.0, resting_due - time.monotonic())
            self._wake.wait(timeout)
            self._wake.clear()
            if self._closed:
                return
            try:
                self._take_requests()
                if self._state is not drawn:
                    drawn = self._state
                    self._draw(drawn, moving=True)
                    resting_due = time.monotonic() + REST
                elif resting_due is not None and time.monotonic() >= resting_due:
                    resting_due = None
                    self._draw(self._state, moving=False)
            except Exception:
                if self._closed:
                    return
                log.exception("a session could not draw")
                self.notify("Something went wrong", "Details are in the program's log.", bad=True)
                resting_due = None

    def _take_requests(self) -> None:
        with self._lock:
            intents, self._intents = self._intents, {}
            jobs, self._jobs = self._jobs, []
        for source, (intent, step) in intents.items():
            self._guard(partial(self._apply, source, intent, step))
        for job in jobs:
            self._guard(job)

    def _apply(self, source: str, intent: Intent, step: bool) -> None:
        before = self._state
        # If the intent fails: a new object, so that the controls are set back to what holds.
        self._state = replace(before)
        self._state = intent(before)
        if step:
            self._history.record(before.document, self._state.document, source, time.monotonic())

    def _guard(self, job: Callable[[], None]) -> None:
        """Run one request; what goes wrong with it is told and stops no other request."""
        try:
            job()
        except PaminsaError as error:
            self.notify("Not possible", str(error), bad=True)
        except Exception:
            if self._closed:
                return
            log.exception("a request failed")
            self.notify("Something went wrong", "Details are in the program's log.", bad=True)

    def _draw(self, state: State, *, moving: bool) -> None:
        frame = compute(state)
        self._draw_together(self.first, frame, moving)
        time.sleep(BREATH)
        self._draw_together(self.words, frame, moving)
        due = time.monotonic() + PATIENCE
        for _ in range(len(self.later)):
            view = self.later[self._turn % len(self.later)]
            self._turn += 1
            view.draw(frame, moving)
            self.client.flush()
            if moving and self._intents and time.monotonic() > due:
                # The hand is already further: the robot first, then the views that are still owed.
                break

    def _draw_together(self, views: list[View], frame: Frame, moving: bool) -> None:
        with self.client.atomic():
            for view in views:
                view.draw(frame, moving)
        self.client.flush()
