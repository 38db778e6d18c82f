"""An input that is typed figure by figure, and may be impossible on the way."""

from __future__ import annotations

import threading
from typing import Any

from paminsa_viz.explorer.controls import Control
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.state import State
from paminsa_viz.model import PaminsaError

PATIENCE = 1.0
"""How long an impossible number may stand before it is pointed out [s].

Typing 0.5 passes through 0, and a mass of 0 may be impossible; nobody wants to be told so then."""


class DebouncedInput(Control):
    """A control whose number is typed figure by figure.

    A number that is not possible changes nothing at first. Only if it still stands after `PATIENCE`
    is the person told, and the input set back.
    """

    _standing: Any = None
    _timer: threading.Timer | None = None

    def _intent(self, state: State) -> State:
        if self._timer is not None:
            self._timer.cancel()
        self._standing = None
        try:
            return super()._intent(state)
        except PaminsaError:
            self._standing = self._known
            self._timer = threading.Timer(PATIENCE, self._insist)
            self._timer.daemon = True
            self._timer.start()
            return state

    def _insist(self) -> None:
        if self._standing is not None:
            self.session.dispatch(self.name, self._last_word)

    def _last_word(self, state: State) -> State:
        self._standing = None
        return super()._intent(state)  # raises again, and now the session tells

    def draw(self, frame: Frame, moving: bool) -> None:
        """Show what holds, but leave a number alone that is still being typed."""
        if self._standing is None:
            super().draw(frame, moving)
