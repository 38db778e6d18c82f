"""Inputs of the page bound to the state: what a person sets is asked for, what holds is shown."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.state import State
from paminsa_viz.model import InvalidInput

Apply = Callable[[State, Any], State]
Show = Callable[[State], Any]


class Control:
    """One input, its way into the state and its way back.

    The value is read when the worker gets to it, not when the callback ran: callbacks may overtake
    each other, the input's own value does not.
    """

    def __init__(
        self,
        session: Session,
        handle: Any,
        name: str,
        apply: Apply,
        show: Show,
        *,
        step: bool = True,
    ) -> None:
        """Bind an input; see `Session.dispatch` for ``step``."""
        self.session, self.handle, self.name = session, handle, name
        self._apply, self._show, self._step = apply, show, step
        # What the input held when it was last read or written here. If it holds something else,
        # the page has just set it, and the callback that says so is on its way.
        self._known: Any = handle.value
        handle.on_update(self._on_update)

    def _on_update(self, event: Any) -> None:
        if event.client is None:  # set by this program
            self._known = self.handle.value
            return
        self.session.dispatch(self.name, self._intent, step=self._step)

    def _intent(self, state: State) -> State:
        value = self._known = self.handle.value
        check_value(self.name, value)
        return self._apply(state, value)

    def draw(self, frame: Frame, moving: bool) -> None:
        """Show what holds, unless the person has set something newer that was not read yet."""
        del moving
        if not same(self.handle.value, self._known):
            return
        value = self._show(frame.state)
        if not same(self._known, value):
            self.handle.value = value
            self._known = value  # and not what the page may have set in this very moment


def check_value(name: str, value: Any) -> None:
    """Refuse numbers that are none.

    Raises:
        InvalidInput: If a number is not finite.
    """
    numbers = value if isinstance(value, tuple) else (value,)
    for number in numbers:
        if isinstance(number, float) and not math.isfinite(number):
            raise InvalidInput(name, "a finite number is needed")


def same(a: Any, b: Any) -> bool:
    """Whether two input values are the same to the eye of the state."""
    if isinstance(a, (int, float)) and isinstance(b, (int, float)):
        if math.isnan(a) and math.isnan(b):
            return True
        return math.isclose(a, b, rel_tol=1e-12, abs_tol=1e-9)
    return a == b
