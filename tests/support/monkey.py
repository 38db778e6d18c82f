"""Random use of the explorer: anything that a page can send, to every input of several pages.

Run: ``python -m tests.support.monkey --seed 1 --minutes 20``. The same seed draws the same inputs
and values; what threads make of them in time differs. It ends with 1 if anything was reported as an
error, a traceback among it.
"""

from __future__ import annotations

import argparse
import contextlib
import logging
import math
import os
import random
import sys
import threading
import time
import traceback
from collections import Counter
from collections.abc import Iterator
from typing import Any

import viser
from websockets.exceptions import ConnectionClosed

from paminsa_viz.app import App, AppOptions, set_up_process
from paminsa_viz.explorer.core.session import Session
from paminsa_viz.model import APPENDIX_4
from tests.support.chromium import until
from tests.support.raw_page import RawPage, update, upload_messages

ODD: tuple[Any, ...] = (
    None, True, False, 0, -1, 1e308, -1e308, 1e-320, math.inf, -math.inf, math.nan, 2**64 - 1, "",
    " ", "nan", "1e999", "\x1b[31m\x00", "<script>alert(1)</script>", "{{7*7}}", "a" * 3000, "٣٤",
    [], [1, 2], {}, {"x": 1}, b"\xff",
)  # fmt: skip
"""Values of wrong kinds and at the ends of numbers."""

TIMEOUT = 120.0
"""How long a page may take on a machine with much to do [s]."""

FILES = (b"", b"\x00\xff", b"[geometry]\nbase_radius = nan\n", b"t_s,x_mm\n0,zero\n", b"{}" * 1000)
"""Contents of uploaded files."""


class Reports(logging.Handler):
    """Collects what is reported as an error, by whomever.

    Attributes:
        found: Texts so far.
    """

    def __init__(self) -> None:
        super().__init__(logging.ERROR)
        self.found: list[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        """Keep a line of a log with its traceback."""
        lines = traceback.format_exception(*record.exc_info) if record.exc_info else []
        self.found.append("".join([f"{record.name}: {record.getMessage()}\n", *lines]))

    def _hook(self, args: Any) -> None:
        lines = traceback.format_exception(args.exc_type, args.exc_value, args.exc_traceback)
        self.found.append("".join([f"thread {args.thread}\n", *lines]))

    @contextlib.contextmanager
    def listening(self) -> Iterator[None]:
        """Context in which logs and threads that end with an error are heard."""
        before, threading.excepthook = threading.excepthook, self._hook
        logging.getLogger().addHandler(self)
        try:
            yield
        finally:
            logging.getLogger().removeHandler(self)
            threading.excepthook = before


class Monkey:
    """Uses pages at random.

    Attributes:
        sent: How many messages of each kind were sent.

    Args:
        app: The explorer.
        seed: Of the random numbers.
    """

    def __init__(self, app: App, seed: int) -> None:
        self._app, self._random = app, random.Random(seed)
        self.sent: Counter[str] = Counter()

    def open(self) -> tuple[RawPage, Session]:
        """Open a page and wait until all of it is there."""
        page = RawPage(self._app.server)
        number = page.client.client_id
        session = until(lambda: self._app.sessions.get(number), "a session", TIMEOUT)
        for kind in ("hello", "shown"):
            session.bridge._deliver(kind, None)
        until(session.built.is_set, "all of the page", TIMEOUT)
        return page, session

    def act(self, page: RawPage, session: Session) -> None:
        """Send one message that moves an input, presses a button or uploads a file."""
        inputs = list(session.client.gui._gui_input_handle_from_uuid.values())
        handle = self._random.choice(inputs)
        kind, value = self._value(handle)
        self.sent[kind] += 1
        identity = handle._impl.uuid
        with contextlib.suppress(ConnectionClosed):  # what no page sends may end a connection
            if isinstance(handle, viser.GuiUploadButtonHandle):
                for message in upload_messages(identity, self._random.choice(FILES)):
                    page.send(message)
            else:
                page.send(update(identity, value))
            with contextlib.suppress(TimeoutError):
                while True:
                    page.socket.recv(timeout=0)

    def _value(self, handle: Any) -> tuple[str, Any]:
        value = getattr(handle, "value", None)
        low, high = getattr(handle, "min", None), getattr(handle, "max", None)
        if isinstance(handle, viser.GuiButtonHandle):
            return "press", True
        if self._random.random() < 0.1:
            return "odd", self._random.choice(ODD)
        if options := getattr(handle, "options", None):
            return "choose", self._random.choice(list(options))
        if isinstance(value, bool):
            return "switch", not value
        if isinstance(value, int | float):
            ends = (value - 1 if low is None else low, value + 1 if high is None else high)
            drawn = self._random.choice([*ends, self._random.uniform(*ends)])
            return "number", round(drawn) if isinstance(value, int) else drawn
        if isinstance(value, tuple):
            return "numbers", [self._random.uniform(0, 255) for _ in value]
        return "text", self._random.choice(["", "name", "0.5", "é✓", "x" * 200])


def run(
    seed: int, *, seconds: float, pages: int, most: int | None = None
) -> tuple[Monkey, Reports]:
    """Use pages at random, which are closed and opened anew now and then.

    Args:
        seed: Of the random numbers.
        seconds: How long, at most.
        pages: How many are open at once.
        most: Largest number of messages; None for no limit.
    """
    reports = Reports()
    with reports.listening():
        app = App(AppOptions(port=0, browser=False), APPENDIX_4)
        monkey, drawn = Monkey(app, seed), random.Random(seed)
        end = time.monotonic() + seconds
        try:
            opened = [monkey.open() for _ in range(pages)]
            while time.monotonic() < end and (most is None or monkey.sent.total() < most):
                place = drawn.randrange(pages)
                if drawn.random() < 0.004 or opened[place][1].closed:
                    opened[place][0].socket.close()
                    opened[place] = monkey.open()
                monkey.act(*opened[place])
                time.sleep(0.02)
            for page, _ in opened:
                page.socket.close()
            until(lambda: not app.sessions, "no session is left", TIMEOUT)
        finally:
            app.stop()
    return monkey, reports


def main() -> int:
    """Run as the command line says, print what was reported, and return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--minutes", type=float, default=20.0)
    parser.add_argument("--pages", type=int, default=3)
    chosen = parser.parse_args()
    set_up_process()
    monkey, reports = run(chosen.seed, seconds=60 * chosen.minutes, pages=chosen.pages)
    for text in reports.found:
        print(text)
    print(f"seed {chosen.seed}: {dict(monkey.sent)} messages, {len(reports.found)} errors")
    return 1 if reports.found else 0


if __name__ == "__main__":
    code = main()
    sys.stdout.flush()
    os._exit(code)  # tasks may still compute in native code, which Python's end would abort
