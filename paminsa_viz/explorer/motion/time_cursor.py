"""The time cursor: a line through all charts of the motion, and clicks on them that move it.

A chart is drawn by uPlot in the page. Moving a line there takes a short message; a line that is
part of the data would take all of it thirty times a second.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from paminsa_viz.explorer.browser.bridge import Bridge
from paminsa_viz.explorer.entries import finite

PLACE = "motion"
"""Name of the place (see `panels.slots`) whose charts have the cursor."""


class TimeCursor:
    """The time cursor of one tab.

    Args:
        bridge: The way to the tab.
        chosen: Called with the time [s] that was clicked on a chart.
    """

    def __init__(self, bridge: Bridge, chosen: Callable[[float], None]) -> None:
        self._bridge, self._chosen = bridge, chosen
        self._shown: float | None = None
        bridge.on("time", self._hear)

    def show(self, time: float) -> None:
        """Move the cursor to a time [s]."""
        if time != self._shown:
            self._shown = time
            self._bridge.call("showTime", PLACE, round(time, 6))

    def _hear(self, data: Any) -> None:
        time = finite(data)
        if time is not None:
            self._chosen(time)
