"""What viser has no interface for: functions of ``page.js``, and messages that come back from it.

Clicks on a Plotly figure happen in the page and have to reach the server; and a tab's own store
(``sessionStorage``), unlike viser's ``local_storage``, is not shared between tabs, so that each
finds its own state again after a reload. Messages come back through a hidden text input of the
same tab, which the server's guard checks like any other input.
"""

from __future__ import annotations

import json
import logging
import math
import threading
import weakref
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache
from typing import Any

import viser

from paminsa_viz.explorer.browser import STORE_KEY, TITLE, asset
from paminsa_viz.files.plain_data import parse_json

log = logging.getLogger(__name__)

MESSAGE_LIMIT = 64_000
"""Longest message that is read [characters]; a saved state is a tenth of it."""

HELLO_TIMEOUT = 60.0
"""How long the page is waited for before it is built without knowing its size and what it has kept
[s]; what it says later is taken all the same."""

PARTS = (
    "backdrop.js",
    "tooltips.js",
    "names.js",
    "focus.js",
    "folders.js",
    "tour.js",
    "covers.js",
    "clipboard.js",
    "cursor.js",
    "pictures.js",
    "tabs.js",
    "files.js",
    "docks.js",
    "figures.js",
    "time_cursor.js",
    "keys.js",
    "palette.js",
    "lost.js",
    "self_test.js",
)
"""Scripts that ``page.js`` calls, sent before it."""

FOLDED_DOCK = 60
"""A dock that covers less of the window than this is folded [px]."""

MISSING_AFTER = 10.0
"""How long a name of viser may be missing in a page until it is reported [s]."""


def finite(value: Any) -> float | None:
    """Return a finite number as a float, or None for anything else that a page may send."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return None
    try:
        number = float(value)
    except OverflowError:  # JSON knows integers beyond all floats
        return None
    return number if math.isfinite(number) else None


def finite_place(data: Any) -> tuple[float, float] | None:
    """Return the finite x and y of a message, or None for anything else that a page may send."""
    if not isinstance(data, dict):
        return None
    x, y = finite(data.get("x")), finite(data.get("y"))
    return None if x is None or y is None else (x, y)


class Bridge:
    """Scripts to one tab and messages from it.

    With a viser that has moved what it needs, it reports so once, sends nothing, and says hello in
    the page's place: the page is then there, without what only its script can do.
    """

    def __init__(
        self, client: viser.ClientHandle, closed: Callable[[], bool] = lambda: False
    ) -> None:
        """Prepare for one tab.

        Args:
            client: The tab.
            closed: Whether it has gone; such a one is not waited for.
        """
        self._closed = closed
        self._listeners: dict[str, list[Callable[[Any], None]]] = {}
        self._last = 0
        self._lock = threading.Lock()
        self._inbox = client.gui.add_text("bridge", "", visible=False)
        self._inbox.on_update(self._receive)
        self._run = _script_channel(client)
        if self._run is not None:
            # before there is anything that is marked, a button, or a chart
            for name in ("marks.js", "units.js", "short_numbers.js", "hints.js", "axes.js"):
                self._run(asset(name))
        self.on("missing", _report_missing)

    def open(
        self, tabs: Mapping[str, str] | None = None, *, largest_file: float = math.inf
    ) -> None:
        """Set up the tab's side; a ``hello`` with the saved state, or None, comes back.

        After it comes a ``painted``, once the browser has drawn what has been sent so far, and a
        ``shown``, once it has nothing else to do. A ``graphics`` names what draws the 3D view.
        Where the page says nothing for `HELLO_TIMEOUT` there is a ``late``; all of them may still
        come then.

        Args:
            tabs: Paths of tabs by the names that a browser may have kept of them.
            largest_file: A larger file is not sent [bytes].
        """
        try:
            config = {
                "inbox": self._inbox._impl.uuid,
                "storeKey": STORE_KEY,
                "title": TITLE,
                "missingAfter": MISSING_AFTER,
                "foldedDock": FOLDED_DOCK,
                "tabs": dict(tabs or {}),
                "largestFile": largest_file,
            }
        except AttributeError as error:
            _report_missing([f"messages from the page ({error})"])
            self._run = None
            config = {}
        if self._run is None:
            for kind in ("hello", "painted", "shown"):
                self._deliver(kind, None)
            return
        go_on = weakref.WeakMethod(self._go_on_meanwhile)  # a closed page is not kept for it
        timer = threading.Timer(HELLO_TIMEOUT, lambda: (call := go_on()) and call())
        timer.daemon = True
        self.on("hello", lambda _: timer.cancel())
        timer.start()
        for name in PARTS:
            self._run(asset(name))
        self._run(f"({asset('page.js').rstrip()})({json.dumps(config)})")

    def on(self, kind: str, listener: Callable[[Any], None]) -> None:
        """Call ``listener`` too with the data of every message of one kind."""
        self._listeners.setdefault(kind, []).append(listener)

    def call(self, function: str, *arguments: Any) -> None:
        """Call one of the functions that ``page.js`` offers as ``window.paminsa``."""
        if self._run is not None:
            values = ", ".join(map(json.dumps, arguments))
            self._run(f"window.paminsa?.{function}({values})")

    def hint(self, button: Any, text: str) -> None:
        """Show a tooltip at a button, of which viser shows none.

        Args:
            button: viser's handle of it.
            text: The tooltip.
        """
        if self._run is None:
            return
        try:
            place = button._impl.uuid
        except AttributeError as error:
            _report_missing([f"tooltips of buttons ({error})"])
            return
        self._run(f"window.paminsaHints?.set({json.dumps(place)}, {json.dumps(text)})")

    def save(self, text: str) -> None:
        """Keep a text in the tab's own store, where a reload finds it."""
        self.call("save", text)

    def _go_on_meanwhile(self) -> None:
        if self._closed():
            return
        log.warning(
            "no messages from a page within %g s: it is built with what is known", HELLO_TIMEOUT
        )
        self._deliver("late", None)

    async def _receive(self, event: Any) -> None:
        text = self._inbox.value
        if event.client is None or len(text) > MESSAGE_LIMIT:
            return
        try:
            messages = [(int(number), str(kind), data) for number, kind, data in parse_json(text)]
        except (ValueError, KeyError, TypeError, OverflowError, RecursionError):
            return  # not from this page's script
        with self._lock:
            fresh = sorted((m for m in messages if m[0] > self._last), key=lambda m: m[0])
            if fresh:
                self._last = fresh[-1][0]
        for _, kind, data in fresh:
            self._deliver(kind, data)

    def _deliver(self, kind: str, data: Any) -> None:
        for listener in self._listeners.get(kind, ()):
            try:
                listener(data)
            except Exception:  # the messages that came with it are for others
                log.exception("a message of the page could not be taken: %s", kind)


def newest_value(handle: Any) -> Callable[[], Any]:
    """Return what tells, within a callback of an input, the value that the page has given it.

    viser sets the input and calls back after that. In between, the session's worker may set it to
    the state's value, and what a person has just typed would be lost.
    """
    given: list[Any] = []
    try:
        share = handle._impl.sync_cb  # called before the callbacks are, to tell other pages

        def take(client: Any, updates: Mapping[str, Any]) -> None:
            given[:] = [updates["value"]]
            if share is not None:
                share(client, updates)

        handle._impl.sync_cb = take
    except AttributeError as error:
        _report_missing([f"what is typed while the page is drawn ({error})"])
    return lambda: given.pop() if given else handle.value


def _script_channel(client: viser.ClientHandle) -> Callable[[str], None] | None:
    """Return what runs a script in a tab, or None with a viser that has none."""
    try:
        from viser._messages import RunJavascriptMessage

        queue = client.gui._websock_interface.queue_message
    except (ImportError, AttributeError) as error:
        _report_missing([f"scripts in the page ({error})"])
        return None
    return lambda source: queue(RunJavascriptMessage(source=source))


def _report_missing(names: Any) -> None:
    """Report features that the installed viser does not carry; ``names`` may come from the page."""
    if isinstance(names, list):
        for name in names[:20]:
            _report_once(str(name)[:100])


@cache
def _report_once(name: str) -> None:
    log.warning("viser %s: the page goes on without %r", viser.__version__, name)


NARROWEST, WIDEST = 300, 2400
"""Widths that a picture can have [page pixels]."""
FINEST = 2.0
"""Most device pixels for one page pixel that pictures are made for."""


def marker(name: str, inputs: str = "") -> str:
    """Return the HTML that marks the container it lies in as a place of this name.

    Args:
        name: Name of the place.
        inputs: Where the container's inputs are, for ``browser/page.css``.
    """
    arranged = f' data-paminsa-inputs="{inputs}"' if inputs else ""
    return f'<span data-paminsa-slot="{name}"{arranged}></span>'


class Slots:
    """Widths of the named places, as last reported.

    Attributes:
        ratio: Device pixels for one page pixel.
    """

    def __init__(
        self,
        bridge: Bridge,
        dispatch: Callable[[str, Callable[[Any], Any]], None],
        widths: dict[str, int],
    ) -> None:
        """Start with assumed widths.

        Args:
            bridge: What tells of others.
            dispatch: `Session.dispatch`, for a new drawing.
            widths: By name [page pixels]; 0 for a place that is not seen.
        """
        self._dispatch = dispatch
        self._widths = {name: _width(width) for name, width in widths.items()}
        self.ratio = 1.0
        bridge.on("slots", self._hear)

    def width(self, name: str) -> int:
        """Return how wide a place is [page pixels], 0 if it is not seen."""
        return self._widths.get(name, 0)

    def _hear(self, data: Any) -> None:
        if not isinstance(data, dict):
            return
        widths = {name: _width(data.get(name)) for name in self._widths}
        fine = min(max(finite(data.get("ratio")) or 1.0, 1.0), FINEST)
        if widths == self._widths and fine == self.ratio:
            return
        self._widths, self.ratio = widths, fine
        # A new object, so that what has become visible is drawn.
        self._dispatch("slots", replace)


def _width(value: Any) -> int:
    width = finite(value)
    return int(min(max(width, NARROWEST), WIDEST)) if width is not None and width > 0 else 0
