"""How fast the program is: each goal beside its figure, as the page ``docs/speed.md``.

Run: ``python -m benchmarks.goals`` on a quiet machine (needs the extra ``test`` and a Chromium or
Chrome); with ``--tests`` the tests are timed too, which takes some minutes.
"""

from __future__ import annotations

import argparse
import os
import re
import resource
import subprocess
import sys
import time
from collections.abc import Iterator
from datetime import date
from pathlib import Path
from typing import Any, NamedTuple

from benchmarks.measure import number, processor
from benchmarks.page_latency import (
    OTHERS,
    environment,
    latencies,
    launched,
    open_page,
    start_explorer,
    starts,
)
from paminsa_viz import __version__

PAGE = Path(__file__).parent.parent / "docs" / "speed.md"
SIZE = (1280, 720)
"""Window of the browser [px]."""

COMMANDS = ("accuracy", "stiffness", "loads")
POSE = ("--pose", "50", "-30", "20", "-550")
PAGES = 3
SETTLED = 20.0
"""How long a page, or its end, is waited for before memory is read [s]."""


class Row(NamedTuple):
    """A goal: what is measured, how much it may be or has to be, in which unit, and the figure."""

    what: str
    goal: float
    unit: str
    figure: float
    least: bool = False

    def __str__(self) -> str:
        met = self.figure >= self.goal if self.least else self.figure <= self.goal
        bound = f"{'≥' if self.least else '≤'} {self.goal:g} {self.unit}"
        return f"| {self.what} | {bound} | {number(self.figure)} | {'yes' if met else 'no'} |"


def page_rows(driver: Any, rounds: int, count: int) -> Iterator[Row]:
    """Yield the goals of a page beside a bare viser page."""
    start = starts(driver, rounds, SIZE)
    yield Row("from the command to a usable page, over a bare viser page", 0.5, "s", start.usable)
    yield Row("from there to the last input of all sections", 1.5, "s", start.whole)
    found = latencies(driver, count, SIZE)
    bare = found["bare page: box"]
    x, theta = (found[f"explorer: platform, {name}"] - bare for name in ("x", "θ"))
    yield Row("a key on the slider of x to the moved platform, over the bare page, p95", 5, "ms", x)
    yield Row("the same with θ", 15, "ms", theta)
    for label, goal in (("x", 5), ("θ", 15)):
        names = [f"{path.partition('/')[2]} open: platform, {label}" for path in OTHERS]
        worst = max(names, key=lambda name: found[name])
        what = f"the same with {label} and another section open, the worst: {worst.split()[0]}"
        yield Row(what, goal, "ms", found[worst] - bare)
    yield Row("torque maps while θ is dragged", 20, "1/s", found["maps"], least=True)


def memory_rows(driver: Any) -> Iterator[Row]:
    """Yield what a server holds with one page, with several, and after them (Linux)."""
    browser = launched(driver)
    process, url = start_explorer()

    def held() -> float:
        time.sleep(SETTLED)
        status = Path(f"/proc/{process.pid}/status").read_text()
        return int(re.findall(r"VmRSS:\s+(\d+)", status)[0]) * 1024 / 1e6

    try:
        before = held()
        pages = [open_page(browser, url, "[data-testid=status]", SIZE)]
        one = held()
        for _ in range(PAGES - 1):
            pages.append(open_page(browser, url, "[data-testid=status]", SIZE))
        several = held()
        for page in pages:
            page.close()
        after = held()
    finally:
        browser.close()
        process.terminate()
        process.wait()
    yield Row("memory of the server with one page", 300, "MB", one)
    yield Row("for each further page, just opened", 25, "MB", (several - one) / (PAGES - 1))
    yield Row("after all are closed, over what it was before", 100, "MB", after - before)


def _processor_time() -> float:
    """Return the time of processes that have been waited for [s]."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def command_rows() -> Iterator[Row]:
    """Yield the processor time of commands for a pose, the least of several runs."""
    for name in COMMANDS:
        times = []
        for _ in range(4):
            start = _processor_time()
            words = [sys.executable, "-m", "paminsa_viz", name, *POSE]
            subprocess.run(words, check=True, stdout=subprocess.DEVNULL, env=environment())
            times.append(_processor_time() - start)
        yield Row(f"`paminsa-viz {name}` of a pose, processor time", 0.5, "s", min(times))


def test_rows() -> Iterator[Row]:
    """Yield the time of the fast tests and of all."""
    for what, goal, words in (
        ('tests, `-m "not slow"`', 60, ("-m", "not slow")),
        ("tests, all", 300, ()),
    ):
        start = time.perf_counter()
        subprocess.run([sys.executable, "-m", "pytest", "-q", *words], check=True)
        yield Row(what, goal, "s", time.perf_counter() - start)


def text(rows: list[Row], note: str) -> str:
    """Return the page."""
    made = f"{date.today().isoformat()}, version {__version__}, {processor()}"
    return f"""# How fast it is

Made by `python -m benchmarks.goals`; the figures are those of one run.

{made}, {os.cpu_count()} cores. The browser is headless, {SIZE[0]}×{SIZE[1]}, and draws in software.
A bare page is one of viser with a slider and a box; below zero the explorer was quicker than it.
{note + chr(10) if note else ""}
| what | goal | measured | met |
|---|---|---|---|
{chr(10).join(map(str, rows))}

Subpackages have benchmarks of their own, which the folder `benchmarks` lists.
"""


def main() -> None:
    """Measure, and write the page."""
    from playwright.sync_api import sync_playwright

    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--count", type=int, default=60, help="key presses of each kind")
    arguments.add_argument("--rounds", type=int, default=4, help="starts of each page")
    arguments.add_argument("--note", default="", help="a sentence for the page")
    arguments.add_argument("--tests", action="store_true", help="time the tests too")
    chosen = arguments.parse_args()
    with sync_playwright() as driver:
        rows = [*page_rows(driver, chosen.rounds, chosen.count), *memory_rows(driver)]
    rows += command_rows()
    if chosen.tests:
        rows += test_rows()
    PAGE.write_text(text(rows, chosen.note), encoding="utf-8")
    print(f"{PAGE}: written")


if __name__ == "__main__":
    main()
