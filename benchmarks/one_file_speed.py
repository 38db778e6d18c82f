"""How quickly the page in one file opens and follows its sliders, without server or requests.

Run: ``python -m benchmarks.one_file_speed`` (needs the extra ``test`` and a Chromium or Chrome).

Times are taken inside the page: from a slider's event to the frame after everything was drawn, the
robot in 3D and the three maps. Without a graphics card the browser draws in software, which takes
most of the time; beside it stands a page with one slider, whose event changes one text.
"""

from __future__ import annotations

import argparse
import re
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.measure import heading, number, table
from paminsa_viz.model import APPENDIX_4
from paminsa_viz.webpage import design_page
from tests.support.chromium import FLAGS, browser_path

BARE = """<!doctype html><input type=range min=-550 max=550 step=0.1><p id=status>ready</p>
<script>document.querySelector("input").oninput = (event) => {
  document.getElementById("status").textContent = event.target.value; };</script>"""

DRAG = """async ([index, steps]) => {
  const slider = document.querySelectorAll("input[type=range]")[index];
  const [low, high] = [Number(slider.min), Number(slider.max)];
  const times = [];
  const start = performance.now();
  for (let k = 0; k < steps; k++) {
    slider.value = String(low + (0.4 + 0.2 * k / steps) * (high - low));
    const before = performance.now();
    slider.dispatchEvent(new Event("input", { bubbles: true }));
    await new Promise((done) => requestAnimationFrame(() => setTimeout(done, 0)));
    times.push(performance.now() - before);
  }
  return [times, 1e3 * steps / (performance.now() - start)];
}"""
"""Moves a slider step by step; returns the times from event to frame [ms], and steps a second."""

READY = re.compile(r"\w{4}")
"""The page's status once there is one."""


def measure(page: Any, file: Path, sliders: dict[str, int], steps: int) -> list[list[str]]:
    """Return rows of figures: when the page is ready, then of each slider."""
    start = time.perf_counter()
    page.goto(file.as_uri())
    page.locator("#status", has_text=READY).wait_for()
    opened = 1e3 * (time.perf_counter() - start)
    page.wait_for_timeout(1000)
    rows = [[file.stem, "ready after opening", number(opened), "", ""]]
    for name, index in sliders.items():
        times, rate = page.evaluate(DRAG, [index, steps])
        middle, high = np.percentile(times, (50, 95))
        rows.append([file.stem, f"drag {name}", number(middle), number(high), number(rate)])
    return rows


def main() -> int:
    """Measure both pages in turns and print the table."""
    from playwright.sync_api import sync_playwright

    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n\n")[0])
    parser.add_argument("--steps", type=int, default=100)
    steps = parser.parse_args().steps
    heading("The page in one file, beside a page with one slider and one text")
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as driver:
        bare, whole = Path(folder) / "bare.html", Path(folder) / "explorer.html"
        bare.write_text(BARE)
        whole.write_text(design_page(APPENDIX_4), encoding="utf-8")
        browser = driver.chromium.launch(executable_path=browser_path(), args=FLAGS)
        page = browser.new_page(viewport={"width": 1280, "height": 720})
        rows = measure(page, bare, {"x": 0}, steps)
        rows += measure(page, whole, {"x": 0, "θ": 2}, steps)
        rows += measure(page, bare, {"x": 0}, steps)
        browser.close()
        size = whole.stat().st_size / 1e3
    table(("page", "what", "median [ms]", "p95 [ms]", "steps a second"), rows)
    print(f"explorer.html: {size:.0f} kB")
    return 0


if __name__ == "__main__":
    sys.exit(main())
