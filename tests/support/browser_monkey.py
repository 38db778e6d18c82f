"""Random use of the real page in a browser, by mouse and keyboard, and what the server holds.

Run: ``python -m tests.support.browser_monkey --seed 1 --minutes 60``. The same seed draws the same
moves; what is under the mouse depends on the page's speed. Errors of the page's scripts and of the
server end it with 1. Once a minute it prints the server's memory and open files (Linux).
"""

from __future__ import annotations

import argparse
import os
import random
import re
import sys
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

from paminsa_viz.app import App, AppOptions, set_up_process
from paminsa_viz.model import APPENDIX_4
from tests.support.chromium import FLAGS, FLAGS_OF_TESTS, Tab, browser_path
from tests.support.monkey import Reports

MINUTE = 60.0
KEYS = (
    "Enter", "Escape", "Tab", "Shift+Tab", "ArrowLeft", "ArrowRight", "ArrowUp", "PageDown",
    "Control+z", "Control+Shift+Z", "Control+k", "h", " ", *(f"Control+{n}" for n in range(1, 6)),
)  # fmt: skip
TEXTS = ("0", "33.5", "-1e9", "50 mm", "1/2", "nan", "", "m7 3.063", "stiff", "<b>x</b>", "é✓")
SIZES = ((1280, 720), (1400, 900), (900, 600), (1920, 1080))
TARGETS = "button, [role=tab], [role=switch], [role=slider], [role=option], input, summary, a"
PART = 5.0
"""Longest time that one move may take before the next one [s]."""


WITHOUT_VIEWER_SETTINGS = """addEventListener("DOMContentLoaded", () => {
  const style = document.createElement("style");
  style.textContent = '[aria-label="Viewer settings"] { display: none; }';
  document.head.append(style);
})"""
"""viser's own settings hold the server's address: what is typed there ends the page."""

OF_THE_BROWSER = ("showSaveFilePicker", "Failed to load resource")
"""In errors that the browser reports: of a dialog that is closed, of a picture that is replaced."""


def held() -> str:
    """Return this process's memory and number of open files in words."""
    status = Path("/proc/self/status").read_text()
    memory = int(re.findall(r"VmRSS:\s+(\d+)", status)[0]) / 1024
    return f"{memory:.0f} MB, {len(os.listdir('/proc/self/fd'))} files open"


class Hands:
    """Uses one page at random.

    Attributes:
        done: How many moves of each kind were made.

    Args:
        page: The page.
        drawn: Random numbers.
    """

    def __init__(self, page: Any, drawn: random.Random) -> None:
        self._page, self._random = page, drawn
        self.done: Counter[str] = Counter()
        page.on("dialog", lambda dialog: dialog.dismiss())

    def act(self) -> None:
        """Make one move; what it aims at may be gone or covered by then."""
        from playwright.sync_api import Error

        moves: list[tuple[Callable[[], None], int]] = [
            (self._press_target, 10), (self._click, 4), (self._drag, 4), (self._key, 5),
            (self._type, 5), (self._turn_wheel, 2), (self._resize, 1), (self._reload, 1),
        ]  # fmt: skip
        move = self._random.choices(*zip(*moves, strict=True))[0]
        self.done[move.__name__.strip("_")] += 1
        try:
            move()
        except Error:
            self.done["in vain"] += 1

    def _place(self) -> tuple[float, float]:
        size = self._page.viewport_size
        return self._random.uniform(0, size["width"]), self._random.uniform(0, size["height"])

    def _press_target(self) -> None:
        found = self._page.locator(TARGETS).locator("visible=true")
        found.nth(self._random.randrange(max(found.count(), 1))).click(timeout=1e3 * PART)

    def _click(self) -> None:
        self._page.mouse.click(*self._place())

    def _drag(self) -> None:
        self._page.mouse.move(*self._place())
        self._page.mouse.down()
        for _ in range(4):
            self._page.mouse.move(*self._place(), steps=4)
        self._page.mouse.up()

    def _key(self) -> None:
        for _ in range(self._random.choice((1, 1, 5))):
            self._page.keyboard.press(self._random.choice(KEYS))

    def _type(self) -> None:
        boxes = self._page.locator("input:not([type=hidden])").locator("visible=true")
        box = boxes.nth(self._random.randrange(max(boxes.count(), 1)))
        if box.input_value(timeout=1e3 * PART).startswith("ws"):
            return  # the server's address, which viser shows while there is nothing else
        box.click(timeout=1e3 * PART)
        self._page.keyboard.press("Control+a")
        self._page.keyboard.type(self._random.choice(TEXTS), delay=self._random.choice((0, 40)))
        self._page.keyboard.press(self._random.choice(("Enter", "Tab", "Escape")))

    def _turn_wheel(self) -> None:
        self._page.mouse.move(*self._place())
        self._page.mouse.wheel(0, self._random.choice((-400, 400)))

    def _resize(self) -> None:
        width, height = self._random.choice(SIZES)
        self._page.set_viewport_size({"width": width, "height": height})

    def _reload(self) -> None:
        if self._random.random() < 0.2:
            self._page.reload()
            # Until then viser shows the field with the server's address.
            self._page.get_by_test_id("status").wait_for()


def run(seed: int, *, minutes: float, pages: int) -> tuple[Counter[str], list[str]]:
    """Use pages in a browser at random, printing once a minute what the server holds.

    Args:
        seed: Of the random numbers.
        minutes: How long.
        pages: How many are open at once.

    Returns:
        Moves of each kind, and texts of what was reported as an error.
    """
    from playwright.sync_api import sync_playwright

    drawn, reports = random.Random(seed), Reports()
    done: Counter[str] = Counter()
    with reports.listening(), sync_playwright() as driver:
        app = App(AppOptions(port=0, browser=False), APPENDIX_4)
        browser = driver.chromium.launch(
            executable_path=browser_path(), args=[*FLAGS, *FLAGS_OF_TESTS]
        )
        try:
            contexts = [
                browser.new_context(viewport={"width": 1280, "height": 720}) for _ in range(pages)
            ]
            for context in contexts:
                context.add_init_script(WITHOUT_VIEWER_SETTINGS)
            tabs = [Tab(context.new_page(), app) for context in contexts]
            hands = [Hands(tab.page, drawn) for tab in tabs]
            start = said = time.monotonic()
            while (now := time.monotonic()) < start + MINUTE * minutes:
                if now >= said + MINUTE:
                    said = now
                    print(f"{(now - start) / MINUTE:.0f} min: {held()}", flush=True)
                drawn.choice(hands).act()
            reported = [error for tab in tabs for error in tab.errors]
            errors = [one for one in reported if not any(part in one for part in OF_THE_BROWSER)]
            for context in contexts:
                context.close()
            browser.close()
            time.sleep(MINUTE / 2)
            print(f"all pages closed: {held()}", flush=True)
        finally:
            app.stop()
    for one in hands:
        done.update(one.done)
    return done, [*reports.found, *errors]


def main() -> int:
    """Run as the command line says, print what was reported, and return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--pages", type=int, default=3)
    chosen = parser.parse_args()
    set_up_process()
    done, errors = run(chosen.seed, minutes=chosen.minutes, pages=chosen.pages)
    for text in errors:
        print(text)
    print(f"seed {chosen.seed}: {dict(done)} moves, {len(errors)} errors")
    return 1 if errors else 0


if __name__ == "__main__":
    code = main()
    sys.stdout.flush()
    os._exit(code)  # tasks may still compute in native code, which Python's end would abort
