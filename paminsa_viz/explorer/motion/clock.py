"""Lets a motion that is played move on, about thirty times a second."""

from __future__ import annotations

import threading
import time

from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.motion import actions as motions
from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.state import State

BEAT = 1 / 30
"""Time between two requests [s]."""


class Clock:
    """Asks for the next instant as long as the motion plays; it rests otherwise.

    The time that has passed is read when the worker gets to a request, so a slow page shows fewer
    instants and not a slower motion.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._last = 0.0
        self._beating: threading.Thread | None = None

    def draw(self, frame: Frame, moving: bool) -> None:
        """Start to beat when the motion starts to play."""
        del moving
        if frame.state.playback.playing and self._beating is None:
            self._last = time.monotonic()
            self._beating = threading.Thread(target=self._beat, name="paminsa-clock", daemon=True)
            self._beating.start()
        elif not frame.state.playback.playing:
            self._beating = None

    def _beat(self) -> None:
        me = threading.current_thread()
        while self._beating is me and not self._session.closed:
            self._session.dispatch("playback.clock", self._intent, step=False)
            time.sleep(BEAT)

    def _intent(self, state: State) -> State:
        now = time.monotonic()
        passed, self._last = now - self._last, now
        return motions.advance_time(state, passed)
