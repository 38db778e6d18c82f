"""Tables on the clipboard of the browser."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from paminsa_viz.explorer.browser.bridge import Bridge
from paminsa_viz.explorer.entries import Run
from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.state import State
from paminsa_viz.files.tables import DataTable, table_text
from paminsa_viz.model import InvalidInput

LONGEST = 4_000_000
"""Longest text that is put on the clipboard [characters]."""


class Clipboard:
    """Puts tables on the clipboard of one page, and says what came of it."""

    def __init__(self, session: Session, bridge: Bridge | None) -> None:
        self._session, self._bridge = session, bridge
        if bridge is not None:
            bridge.on("copied", self._hear)

    def run(self, what: str, make: Callable[[State], DataTable]) -> Run:
        """Return the effect of a button that copies a table."""
        return Run(lambda session: session.guard(lambda: self.copy(what, make(session.state))))

    def copy(self, what: str, table: DataTable) -> None:
        """Copy a table.

        Raises:
            InvalidInput: If it is too long for a clipboard.
        """
        text = table_text(table)
        if len(text) > LONGEST:
            raise InvalidInput(what, "it is too long for the clipboard; download it as CSV")
        if self._bridge is not None:
            self._bridge.call("copy", what, text)

    def _hear(self, data: Any) -> None:
        """Say what became of it; ``data`` comes from the page."""
        if not isinstance(data, list) or len(data) != 2:
            return
        what = str(data[0])[:60]
        if data[1] == "copied":
            self._session.notify("Copied", f"{what}: paste it into a spreadsheet")
        else:
            self._session.notify("Not copied", "The text is selected: press Ctrl+C", bad=True)
