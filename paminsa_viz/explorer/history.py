"""Undo and redo over documents; a drag counts as one step."""

from __future__ import annotations

from dataclasses import dataclass, field

from paminsa_viz.explorer.state import Document

PAUSE = 0.8
"""Changes by one control that follow each other faster than this are one step [s]."""

DEPTH = 200
"""Steps that are kept."""


@dataclass
class History:
    """Past and undone documents of one session."""

    past: list[Document] = field(default_factory=list)
    future: list[Document] = field(default_factory=list)
    _source: str = ""
    _time: float = -1e9

    def record(self, before: Document, after: Document, source: str, now: float) -> None:
        """Remember a change from ``before`` to ``after``, made by ``source`` at ``now`` [s]."""
        if before == after and before.design.name == after.design.name:
            return
        same_drag = source == self._source and now - self._time < PAUSE and bool(self.past)
        self._source, self._time = source, now
        self.future.clear()
        if not same_drag:
            self.past.append(before)
            del self.past[:-DEPTH]

    def undo(self, present: Document) -> Document | None:
        """Return the document before the last step, or None."""
        self._source = ""
        if not self.past:
            return None
        self.future.append(present)
        return self.past.pop()

    def redo(self, present: Document) -> Document | None:
        """Return the document that the last undo left, or None."""
        self._source = ""
        if not self.future:
            return None
        self.past.append(present)
        return self.future.pop()
