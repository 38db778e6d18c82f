"""Tables on the clipboard of the browser."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.kit.entries import Message, Run
from paminsa_viz.explorer.state.state import State
from paminsa_viz.files.tables import DataTable, table_text
from paminsa_viz.model import InvalidInput

LONGEST = 8_000_000
"""Longest text that is put on the clipboard [characters]; three torque maps are 3 to 5 million."""

USES = {"Link": "it opens this design where paminsa-viz runs at the same address"}
"""What a text is copied for, by its name, if not for a spreadsheet."""


def copy_run(what: str, make: Callable[[State], DataTable]) -> Run:
    """Return the effect of a button that puts a table on the clipboard of the page."""
    return Run(lambda session: session.guard(lambda: _copy(session, what, make(session.state))))


def _copy(session: Session, what: str, table: DataTable) -> None:
    text = table_text(table)
    if len(text) > LONGEST:
        raise InvalidInput(what, "it is too long for the clipboard; download it as CSV")
    session.bridge.call("copy", what, text)


def _hear(session: Session, data: Any) -> None:
    """Say what became of it; ``data`` comes from the page."""
    if not isinstance(data, list) or len(data) != 2:
        return
    what = str(data[0])[:60]
    if data[1] == "copied":
        session.notify("Copied", f"{what}: {USES.get(what, 'paste it into a spreadsheet')}")
    else:
        session.notify("Not copied yet", f"{what}: press “Copy” below the text")


COPIED = Message("copied", receive=_hear)
