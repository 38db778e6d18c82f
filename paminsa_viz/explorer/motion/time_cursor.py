"""The time cursor: a line through all charts of the motion, and clicks on them that move it.

A chart is drawn by uPlot in the page. Moving a line there takes a short message; a line that is
part of the data would take all of it thirty times a second.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

from paminsa_viz.explorer.browser.bridge import Bridge
from paminsa_viz.explorer.panels.validation import number

PLACE = "motion"
"""Name of the place (see `panels.slots`) whose charts have the cursor."""

_SCRIPT = """
(() => {
  clearInterval(window.__paminsaCharts);
  let moment = null;
  const charts = () => {
    const mark = document.querySelector('[data-paminsa-slot="__PLACE__"]');
    const host = mark && mark.parentElement && mark.parentElement.parentElement;
    const known = (window.__viserTestpoints || {}).uplots || {};
    return Object.values(known).map((entry) => entry.chart)
      .filter((chart) => host && host.contains(chart.root));
  };
  const prepare = (chart) => {
    const line = document.createElement("div");
    line.className = "paminsa-moment";
    line.style.cssText =
      "position:absolute;top:0;bottom:0;width:0;border-left:1.5px solid #1f2933;" +
      "pointer-events:none;z-index:90";
    chart.over.appendChild(line);
    let down = null;
    chart.over.addEventListener("mousedown", (event) => { down = event.clientX; });
    chart.over.addEventListener("mouseup", (event) => {
      if (event.button !== 0 || down === null || Math.abs(event.clientX - down) > 3) return;
      const box = chart.over.getBoundingClientRect();
      if (window.__paminsaSend)
        window.__paminsaSend("moment", chart.posToVal(event.clientX - box.left, "x"));
    });
    return line;
  };
  const draw = () => {
    for (const chart of charts()) {
      const line = chart.over.querySelector(".paminsa-moment") || prepare(chart);
      const x = moment === null ? NaN : chart.valToPos(moment, "x");
      const shown = x >= -1 && x <= chart.over.clientWidth + 1;
      line.style.display = shown ? "" : "none";
      if (shown) line.style.transform = `translateX(${x}px)`;
    }
  };
  window.__paminsaMoment = (value) => { moment = value; draw(); };
  window.__paminsaCharts = setInterval(draw, 200);
})();
"""
"""Charts are looked for again and again: they are made again, widened and zoomed by the page."""


class TimeCursor:
    """The time cursor of one tab.

    Args:
        bridge: The way to the tab.
        chosen: Called with the time [s] that was clicked on a chart.
    """

    def __init__(self, bridge: Bridge, chosen: Callable[[float], None]) -> None:
        self._bridge, self._chosen = bridge, chosen
        self._shown: float | None = None
        bridge.on("moment", self._hear)
        bridge.run(_SCRIPT.replace("__PLACE__", PLACE))

    def show(self, time: float) -> None:
        """Move the cursor to a time [s]."""
        if time != self._shown:
            self._shown = time
            self._bridge.run(f"window.__paminsaMoment({json.dumps(round(time, 6))})")

    def _hear(self, data: Any) -> None:
        time = number(data)
        if time is not None:
            self._chosen(time)
