"""What viser has no handle for: scripts sent to the tab, and messages that come back from it.

Two things need it. Clicks on a Plotly figure happen in the page and have to reach the server; and a
tab's own store (``sessionStorage``), unlike viser's ``local_storage``, is not shared between tabs,
so that each finds its own state again after a reload. Messages come back through a hidden text
input of the same tab, which the server's guard checks like any other input.
"""

from __future__ import annotations

import json
import threading
from collections.abc import Callable
from typing import Any

import viser
from viser import _messages

STORE_KEY = "paminsa_viz"

MESSAGE_LIMIT = 64_000
"""Longest message that is looked at [characters]; a saved state is a tenth of it."""

_SETUP = """
(() => {
  const uuid = __UUID__;
  const recent = [];
  let count = 0;
  const send = (kind, data) => {
    const viewer = window.__viserMutable;
    if (!viewer) return false;
    recent.push([++count, kind, data]);
    while (recent.length > 4) recent.shift();
    viewer.sendMessage({type: "GuiUpdateMessage", uuid: uuid,
      updates: {value: JSON.stringify(recent)}});
    return true;
  };
  window.__paminsaSend = send;
  const hello = () => {
    let saved = null;
    try { saved = sessionStorage.getItem(__KEY__); } catch (error) { saved = null; }
    if (!send("hello", saved)) setTimeout(hello, 50);
  };
  hello();
  const graphics = () => {
    const canvas = window.__viserMutable && window.__viserMutable.canvas;
    if (!canvas) { setTimeout(graphics, 200); return; }
    const gl = canvas.getContext("webgl2");
    const names = gl && gl.getExtension("WEBGL_debug_renderer_info");
    send("graphics", names ? String(gl.getParameter(names.UNMASKED_RENDERER_WEBGL)) : "");
  };
  graphics();
  const shown = () => { if (!send("shown", null)) setTimeout(shown, 50); };
  const calm = window.requestIdleCallback || ((run) => setTimeout(run, 200));
  requestAnimationFrame(() => calm(shown, {timeout: 1000}));
  setTimeout(shown, 2000); // a tab in the background draws nothing
  if (window.__paminsaClicks)
    for (const kind of ["pointerdown", "pointerup"])
      document.removeEventListener(kind, window.__paminsaClicks, true);
  let down = null;
  // Not the page's own click: while a figure is pressed, Plotly lays a cover over the window.
  window.__paminsaClicks = (event) => {
    const place = [event.clientX, event.clientY];
    const figures = document.elementsFromPoint(...place).map((e) => e.closest(".js-plotly-plot"));
    const plot = figures.find((figure) => figure && figure._fullLayout);
    if (event.type === "pointerdown") { down = event.button === 0 && plot ? place : null; return; }
    if (!plot || !down || Math.hypot(place[0] - down[0], place[1] - down[1]) > 4) return;
    const box = plot.getBoundingClientRect();
    for (const part of Object.values(plot._fullLayout._plots || {})) {
      const x = place[0] - box.left - part.xaxis._offset;
      const y = place[1] - box.top - part.yaxis._offset;
      if (x < 0 || y < 0 || x > part.xaxis._length || y > part.yaxis._length) continue;
      send("click", {title: String(plot._fullLayout.meta || ""),
        x: part.xaxis.p2d(x), y: part.yaxis.p2d(y)});
      return;
    }
  };
  for (const kind of ["pointerdown", "pointerup"])
    document.addEventListener(kind, window.__paminsaClicks, true);
})();
"""
"""The tab's side. Each message repeats the last few: the input holds only the newest text, and one
that follows another at once would otherwise take its place before it is read."""


class Bridge:
    """Scripts to one tab and messages from it."""

    def __init__(self, client: viser.ClientHandle) -> None:
        self._client = client
        self._listeners: dict[str, list[Callable[[Any], None]]] = {}
        self._last = 0
        self._lock = threading.Lock()
        self._inbox = client.gui.add_text("bridge", "", visible=False)
        self._inbox.on_update(self._receive)

    def open(self) -> None:
        """Set up the tab's side; a ``hello`` with the saved state, or None, comes back.

        After it comes a ``shown``, once what has been sent so far stands on the screen; it may come
        twice. A ``graphics`` names what draws the 3D view.
        """
        script = _SETUP.replace("__UUID__", json.dumps(self._inbox._impl.uuid))
        self.run(script.replace("__KEY__", json.dumps(STORE_KEY)))

    def on(self, kind: str, listener: Callable[[Any], None]) -> None:
        """Call ``listener`` too with the data of every message of one kind."""
        self._listeners.setdefault(kind, []).append(listener)

    def save(self, text: str) -> None:
        """Keep a text in the tab's own store, where a reload finds it."""
        store = f"sessionStorage.setItem({json.dumps(STORE_KEY)}, {json.dumps(text)})"
        self.run(f"try {{ {store}; }} catch (error) {{ console.warn(error); }}")

    def run(self, script: str) -> None:
        """Run a script in the tab."""
        self._client.gui._websock_interface.queue_message(
            _messages.RunJavascriptMessage(source=script)
        )

    def _receive(self, event: Any) -> None:
        text = self._inbox.value
        if event.client is None or len(text) > MESSAGE_LIMIT:
            return
        try:
            messages = [(int(number), str(kind), data) for number, kind, data in json.loads(text)]
        except (ValueError, KeyError, TypeError, OverflowError, RecursionError):
            return  # not from this page's script
        with self._lock:
            fresh = sorted((m for m in messages if m[0] > self._last), key=lambda m: m[0])
            if fresh:
                self._last = fresh[-1][0]
        for _, kind, data in fresh:
            for listener in self._listeners.get(kind, ()):
                listener(data)
