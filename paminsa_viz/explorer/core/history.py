"""Undo and redo: the steps of one session."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import NamedTuple

from paminsa_viz.explorer.core.actions import restore
from paminsa_viz.explorer.state.accuracy import EncoderSettings
from paminsa_viz.explorer.state.document import Document
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model.singular_limit import CONDITION_LIMIT

PAUSE = 0.8
"""Values of one input that follow each other faster than this are one step [s]."""

DEPTH = 200
"""Steps that are kept."""


class Snapshot(NamedTuple):
    """What undo brings back: the document, and what else numbers of it are set or judged by.

    Attributes:
        document: What is worked on.
        condition_limit: Which poses count.
        encoder: What bits of an encoder are turned into a count of the design with.
    """

    document: Document
    condition_limit: float = CONDITION_LIMIT
    encoder: EncoderSettings = EncoderSettings()

    @classmethod
    def of(cls, state: State) -> Snapshot:
        """Return that of a state."""
        return cls(state.document, state.condition_limit, state.encoder.settings)

    def restored(self, state: State) -> State:
        """Return a state with this snapshot's parts."""
        restored = replace(restore(state, self.document), condition_limit=self.condition_limit)
        return restored.updated("encoder", settings=self.encoder)


@dataclass
class History:
    """Past and undone snapshots of one session."""

    past: list[Snapshot] = field(default_factory=list)
    future: list[Snapshot] = field(default_factory=list)
    _source: str = ""
    _time: float = -1e9

    def record(self, before: Snapshot, after: Snapshot, source: str, now: float) -> None:
        """Remember a change from ``before`` to ``after``, made by ``source`` at ``now`` [s].

        Without a source it is a step of its own, such as a click.
        """
        if before == after and before.document.design.name == after.document.design.name:
            return
        follows = source == self._source and now - self._time < PAUSE
        same_drag = bool(source) and follows and bool(self.past)
        self._source, self._time = source, now
        self.future.clear()
        if not same_drag:
            self.past.append(before)
            del self.past[:-DEPTH]

    def travel(self, current: Snapshot, *, back: bool) -> Snapshot | None:
        """Return the snapshot before the last step, or the one that the last undo left, or None."""
        self._source = ""
        source, target = (self.past, self.future) if back else (self.future, self.past)
        if not source:
            return None
        target.append(current)
        return source.pop()
