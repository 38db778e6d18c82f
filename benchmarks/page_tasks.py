"""How many clicks and entries twelve tasks of a machine designer take on the page.

Run: ``python -m benchmarks.page_tasks`` (needs the extra ``test`` and a Chromium or Chrome).

Every task is carried out by mouse and keyboard in a page of its own, and its result is looked at.
A press of the mouse, a chosen option and a key combination count as one click each; a number or a
name that is typed, with the Enter or Tab that ends it, counts as one entry. Files are chosen by the
browser's own dialog, which counts as the click that opens it.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.measure import heading, table
from paminsa_viz.app import App, AppOptions
from paminsa_viz.files.example_logs import ExampleLog
from paminsa_viz.model import APPENDIX_4, backend
from paminsa_viz.plots.map_values import frame_half
from tests.support.chromium import FLAGS, FLAGS_OF_TESTS, Tab, browser_path, until

LONG = 300.0
"""How long a search may take on a busy machine [s]."""


SETTLED = 3000.0
"""How long a page is left alone at first, until its keys work [ms]."""


class Person:
    """Uses a page by mouse and keyboard, and counts.

    Attributes:
        tab: The page; what is looked at there counts nothing.
        clicks, entries: How many so far.
        below: What was pressed that had to be scrolled to.

    Args:
        tab: As above.
    """

    def __init__(self, tab: Tab) -> None:
        self.tab, self.page = tab, tab.page
        self.clicks = self.entries = 0
        self.below: list[str] = []

    def press(self, place: Any, name: str = "an input") -> None:
        """Press what is at a place of the page, which may have a name without a text."""
        place = place.first
        place.wait_for()
        box = self.tab.steady_box(place)
        if box["y"] + box["height"] > self.page.viewport_size["height"]:
            self.below.append(place.inner_text() or name)
        place.click()
        self.clicks += 1

    def open(self, *names: str) -> None:
        """Press tabs by their names."""
        for name in names:
            self.press(self.page.get_by_role("tab", name=name, exact=True))

    def button(self, name: str, within: str = "") -> None:
        """Press a button."""
        found = self.page.get_by_role("button", name=name, exact=True)
        if within:
            found = self.page.get_by_text(within, exact=True).locator("xpath=ancestor::*[5]")
            found = found.get_by_role("button", name=name, exact=True)
        self.press(found)

    def link(self, name: str) -> None:
        """Press a link or a folder by its text."""
        self.press(self.page.get_by_text(name, exact=True))

    def switch(self, label: str) -> None:
        """Press a checkbox by its label."""
        self.press(self.tab.element(label))

    def choose(self, label: str, option: str) -> None:
        """Choose an option: a press that opens the list, and one that takes it."""
        self.press(self.tab.element(label))
        self.press(self.page.get_by_role("option", name=option))

    def type(self, label: str, text: str) -> None:
        """Press a box and type into it."""
        self.press(self.tab.element(label), label)
        self.enter(text)

    def enter(self, text: str) -> None:
        """Type into the box that has the focus."""
        self.page.keyboard.press("Control+a")
        self.page.keyboard.type(text)
        self.page.keyboard.press("Enter")
        self.entries += 1

    def key(self, keys: str) -> None:
        """Press a key or a combination."""
        self.page.keyboard.press(keys)
        self.clicks += 1

    def command(self, text: str, found: str) -> None:
        """Type into the command palette: it opens by a key, Enter takes what is found."""
        self.key("Control+k")
        box = self.page.get_by_placeholder("Search commands", exact=False)
        box.fill(text)
        first = self.page.locator(".mantine-Spotlight-action[data-selected]")
        until(lambda: first.count() and found in first.inner_text(), f"{found} is found")
        self.page.keyboard.press("Enter")
        self.entries += 1

    def press_map(self, x: float, y: float) -> None:
        """Press the first torque map at x and y [m]."""
        picture = self.page.locator("[data-paminsa-picture][src]:visible").first
        picture.wait_for()
        half = self._half_frame()
        marks = self.page.locator("[data-paminsa-frame]:visible").first
        frame = json.loads(marks.get_attribute("data-paminsa-frame"))
        left, top, width, height = frame["panels"][0]
        right, down = 0.5 + 0.5 * x / half, 0.5 - 0.5 * y / half
        self.tab.click_in(picture, left + width * right, top + height * down)
        self.clicks += 1

    def _half_frame(self) -> float:
        """Return half of what a map shows [m]."""
        document = self.tab.state.document
        _, _, theta, z = self.tab.state.last_reachable.pose
        return float(frame_half(document.design.geometry, theta, z))

    def sees(self, text: str, timeout: float = LONG) -> None:
        """Wait until a text is on the page."""
        self.page.get_by_text(text, exact=False).first.wait_for(timeout=1000 * timeout)


def figure_3(person: Person) -> None:
    person.button("Fig. 3")
    with person.page.expect_download() as waiting:
        person.button("PDF")
    assert waiting.value.suggested_filename.endswith(".pdf")


def balance(person: Person) -> None:
    person.key("b")
    person.sees("Statically balanced")
    person.link("compare")
    with person.page.expect_download() as waiting:
        person.key("Control+s")
    assert waiting.value.suggested_filename.endswith(".toml")


def motors(person: Person) -> None:
    person.command("m_load 2", "Set m_load to 2 kg")
    person.open("Motion")
    person.button("Draw on a map…")
    for x, y in ((-0.05, -0.05), (0.08, 0.02), (0.0, 0.08)):
        person.press_map(x, y)
    person.open("Drives")
    person.button("Find drives")
    until(lambda: person.tab.state.drives.result is not None, "drives are found", LONG)
    assert person.tab.state.document.design.payload.mass == 2.0
    assert len(person.tab.state.document.motion.waypoints) == 3


def ask(person: Person) -> None:
    """Require what the robot can do, with three numbers of one's own."""
    person.open("Optimize")
    person.button("Suggested set")
    person.press(person.page.get_by_test_id("requirement-0").get_by_role("textbox"), "a bound")
    for index, value in enumerate(("8", "6", "300")):
        person.enter(value)  # Enter goes to the next row
        until(lambda i=index, v=value: bound(person.tab, i) == float(v), "the bound is set")


def bound(tab: Tab, index: int) -> float:
    """Return the upper bound of a requirement in the unit shown."""
    one = tab.state.document.requirements.bounds[index]
    return round(one.entry.display.from_si(one.high or np.nan), 9)


def largest(person: Person) -> None:
    ask(person)
    person.link("Find the largest workspace")
    until(lambda: person.tab.state.requirements.largest.result, "the largest", LONG)


def synthesis(person: Person) -> None:
    person.tab.open_tab("Requirements")  # they stand there already
    person.tab.click("Suggested set")
    person.open("Synthesis")
    person.button("Search")
    until(lambda: person.tab.state.synthesis.result, "a robot is found", LONG)
    person.button("Open as current design")
    until(lambda: person.tab.state.document.design.geometry != APPENDIX_4.geometry, "it is opened")


def softest(person: Person) -> None:
    person.open("Strength", "Stiffness")
    person.sees("Softest horizontal direction")


def encoder_map(person: Person) -> None:
    person.open("Strength", "Errors")
    person.type("encoder M1–M3 [bit]", "12")
    person.button("position")
    until(lambda: person.tab.state.map_view.quantity == "error_horizontal", "the map")
    count = person.tab.state.document.design.accuracy.resolution_rotary
    assert np.isclose(count, 2 * np.pi / 4096)


def log(person: Person) -> None:
    with tempfile.TemporaryDirectory() as folder:
        name = ExampleLog.BEST.value
        path = Path(folder) / name
        path.write_bytes(files("paminsa_viz.files").joinpath(name).read_bytes())
        person.open("Built")
        with person.page.expect_file_chooser() as chooser:
            person.button("Open a log…")
        chooser.value.set_files(path)
        until(lambda: person.tab.state.identification.log, "the log is read", LONG)
    until(lambda: person.tab.state.identification.result, "the robot is identified", LONG)
    before = person.tab.state.document.design
    person.button("Use as design")
    until(lambda: person.tab.state.document.design != before, "it is used")


def crossing(person: Person) -> None:
    person.open("Motion")
    person.button("Draw on a map…")
    for x, y in ((0.03, 0.1), (0.07, 0.335)):
        person.press_map(x, y)
    person.switch("Pass singularities")
    person.button("Change the limits")
    until(lambda: person.page.evaluate(FOCUSED).startswith("M1–M3"), "the box has the focus")
    person.enter("100")
    person.sees("Passes 1 singularity")


FOCUSED = "() => document.activeElement?.labels?.[0]?.textContent ?? ''"
"""Script that returns the label of the box that has the focus."""


def share(person: Person) -> None:
    person.key("Control+Shift+l")
    person.sees("it opens this design where paminsa-viz runs")


def limits_force(person: Person) -> None:
    person.tab.open_tab("Requirements")  # they stand there already
    person.tab.click("Suggested set")
    before = person.tab.state.document.pose
    row = person.page.get_by_test_id("requirement-2")
    person.press(row.locator("[data-paminsa-send='worst pose']"))
    until(lambda: person.tab.state.document.pose != before, "the worst pose")
    person.open("Strength")
    person.sees("Axial load of M4")
    person.page.locator("tr b").first.wait_for()


def lightest(person: Person) -> None:
    person.tab.open_tab("Requirements")  # they stand there already
    person.tab.click("Suggested set")
    person.open("Synthesis")
    person.choose("Objective", "least moving mass")
    person.button("Search")
    until(lambda: person.tab.state.synthesis.result, "a robot is found", LONG)
    person.button("Open as current design")
    until(lambda: person.tab.state.document.design.geometry != APPENDIX_4.geometry, "it is opened")


@dataclass(frozen=True)
class Task:
    """A task, and what it took before.

    Attributes:
        name: What is done.
        run: Does it.
        before: Clicks and entries on the page of 14 tabs, before there were workspaces, counted by
            hand; None where it was not counted.
    """

    name: str
    run: Callable[[Person], None]
    before: tuple[int, int] | None = None


TASKS = (
    Task("Fig. 3 as PDF", figure_3, (3, 0)),
    Task("balance, compare, save the design", balance, (5, 0)),
    Task("motors for an own motion with 2 kg", motors, (13, 6)),
    Task("three own requirements, largest workspace", largest, (13, 3)),
    Task("synthesize, compare, open", synthesis, (4, 0)),
    Task("softest direction", softest, (5, 0)),
    Task("accuracy with 12 bits as a map", encoder_map, (9, 1)),
    Task("log to design", log, (4, 0)),
    Task("motion through a singularity", crossing, (7, 9)),
    Task("share a link", share, (3, 0)),
    Task("what limits F₄, and the worst bar there", limits_force),
    Task("lightest robot for the requirements", lightest),
)


def main() -> int:
    """Carry out all tasks and print what they took."""
    from playwright.sync_api import sync_playwright

    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n\n")[0])
    parser.add_argument("--only", default="", help="tasks whose name has this in it")
    chosen = [task for task in TASKS if parser.parse_args().only in task.name]
    backend.compile_now()
    app = App(AppOptions(port=0, browser=False), APPENDIX_4)
    rows: list[tuple[str, ...]] = []
    sums = np.zeros(2, int)
    try:
        with sync_playwright() as driver:
            browser = driver.chromium.launch(
                executable_path=browser_path(), args=[*FLAGS, *FLAGS_OF_TESTS]
            )
            for task in chosen:
                context = browser.new_context(
                    viewport={"width": 1280, "height": 720}, permissions=["clipboard-write"]
                )
                person = Person(Tab(context.new_page(), app))
                person.page.wait_for_timeout(SETTLED)
                start = time.perf_counter()
                task.run(person)
                took = f"{person.clicks} + {person.entries}"
                before = "–" if task.before is None else f"{task.before[0]} + {task.before[1]}"
                if task.before is not None:
                    sums += (sum(task.before), person.clicks + person.entries)
                below = ", ".join(person.below) or "nothing"
                rows.append((task.name, before, took, below))
                print(f"{task.name}: {took} ({time.perf_counter() - start:.0f} s)", file=sys.stderr)
                context.close()
            browser.close()
    finally:
        app.stop()
    heading("Clicks + entries of tasks on the page")
    rows.append(("sum of those counted before", str(sums[0]), str(sums[1]), ""))
    table(("task", "before", "now", "below the fold at 1280×720"), rows)
    return 0


if __name__ == "__main__":
    sys.exit(main())
