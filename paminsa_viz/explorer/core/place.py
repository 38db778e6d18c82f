"""A place in the state, named by the expression that reads it, so that tools can follow it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Generic, TypeVar

from paminsa_viz.explorer.state.state import State

Part = TypeVar("Part")


class _Trace:
    """Remembers the attributes that are read of it."""

    def __init__(self, path: str = "") -> None:
        self.path = path

    def __getattr__(self, name: str) -> _Trace:
        return _Trace(f"{self.path}.{name}".lstrip("."))


class Place(Generic[Part]):
    """A part of the state that is read and replaced: ``Place(lambda state: state.springs)``.

    Attributes:
        read: Returns the part of a state.
        path: Its attributes, such as ``identify.excitation``.
    """

    def __init__(self, read: Callable[[State], Part]) -> None:
        """Name a place by what reads it, which does nothing but read attributes."""
        self.read = read
        trace: Any = _Trace()
        found: Any = read(trace)
        self.path: str = found.path

    def write(self, state: State, part: Part) -> State:
        """Return the state with another part at the place."""
        above, _, name = self.path.rpartition(".")
        return state.updated(above, **{name: part})
