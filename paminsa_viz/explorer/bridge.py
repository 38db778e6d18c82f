"""What viser has no handle for: scripts sent to the tab, and messages that come back from it.

Two things need it. Clicks on a Plotly map happen in the page and have to reach the server; and a
tab's own store (``sessionStorage``), unlike viser's ``local_storage``, is not shared between tabs,
so that each finds its own state again after a reload. Messages come back through a hidden text
input of the same tab, which the server's guard checks like any other input.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import viser
from viser import _messages

STORE_KEY = "paminsa_viz"

MESSAGE_LIMIT = 64_000
"""Longest message that is looked at [characters]; a saved state is a tenth of it."""

_SETUP = """
(() => {
  const uuid = %(uuid)s;
  const send = (kind, data) => {
    const viewer = window.__viserMutable;
    if (!viewer) return false;
    viewer.sendMessage({type: "GuiUpdateMessage", uuid: uuid,
      updates: {value: JSON.stringify({kind: kind, data: data, count: (send.count = (send.count || 0) + 1)})}});
    return true;
  };
  window.__paminsaSend = send;
  const hello = () => {
    let saved = null;
    try { saved = sessionStorage.getItem(%(key)s); } catch (error) { saved = null; }
    if (!send("hello", saved)) setTimeout(hello, 50);
  };
  hello();
  if (window.__paminsaClicks) document.removeEventListener("click", window.__paminsaClicks, true);
  let down = null;
  document.addEventListener("mousedown", (event) => { down = [event.clientX, event.clientY]; }, true);
  window.__paminsaClicks = (event) => {
    const plot = event.target.closest && event.target.closest(".js-plotly-plot");
    if (!plot || !plot._fullLayout || !event.target.closest(".draglayer, .nsewdrag")) return;
    if (down && Math.hypot(event.clientX - down[0], event.clientY - down[1]) > 4) return;
    for (const id of Object.keys(plot._fullLayout._plots || {})) {
      const part = plot._fullLayout._plots[id];
      const box = plot.getBoundingClientRect();
      const x = event.clientX - box.left - part.xaxis._offset;
      const y = event.clientY - box.top - part.yaxis._offset;
      if (x < 0 || y < 0 || x > part.xaxis._length || y > part.yaxis._length) continue;
      send("click", {title: String(plot._fullLayout.meta || ""), x: part.xaxis.p2d(x), y: part.yaxis.p2d(y)});
      return;
    }
  };
  document.addEventListener("click", window.__paminsaClicks, true);
})();
"""


class Bridge:
    """Scripts to one tab and messages from it."""

    def __init__(self, client: viser.ClientHandle) -> None:
        self._client = client
        self._listeners: dict[str, Callable[[Any], None]] = {}
        self._inbox = client.gui.add_text("bridge", "", visible=False)
        self._inbox.on_update(self._receive)

    def open(self) -> None:
        """Set up the tab's side; a ``hello`` with the saved state, or None, comes back."""
        self.run(
            _SETUP % {"uuid": json.dumps(self._inbox._impl.uuid), "key": json.dumps(STORE_KEY)}
        )

    def on(self, kind: str, listener: Callable[[Any], None]) -> None:
        """Call ``listener`` with the data of every message of one kind."""
        self._listeners[kind] = listener

    def save(self, text: str) -> None:
        """Keep a text in the tab's own store, where a reload finds it."""
        self.run(
            "try { sessionStorage.setItem(%s, %s); } catch (error) { console.warn(error); }"
            % (json.dumps(STORE_KEY), json.dumps(text))
        )

    def run(self, script: str) -> None:
        """Run a script in the tab."""
        self._client.gui._websock_interface.queue_message(
            _messages.RunJavascriptMessage(source=script)
        )

    def _receive(self, event: Any) -> None:
        if event.client is None or len(self._inbox.value) > MESSAGE_LIMIT:
            return
        try:
            message = json.loads(self._inbox.value)
            listener = self._listeners.get(message["kind"])
            data = message["data"]
        except (ValueError, KeyError, TypeError, RecursionError):
            return  # not from this page's script
        if listener is not None:
            listener(data)
