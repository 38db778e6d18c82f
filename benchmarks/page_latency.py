"""How quickly the page answers, beside a bare viser page that moves one box, in one run.

Run: ``python -m benchmarks.page_latency`` (needs the extra ``test`` and a Chromium or Chrome).

Times are taken inside the page: from the slider's key event to the moment the scene node has moved,
and to the moment the torque maps' picture has changed. The page is asked every 4 ms, which is how
finely they are taken; asking all the time would keep one of the machine's cores busy. Without a
graphics card the browser draws in software and its own frames take most of the time; both pages
suffer from that alike, and the explorer, which draws a robot instead of a box, more.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
import time
from typing import Any

import numpy as np

from benchmarks.measure import heading, number, table
from tests.support.chromium import FLAGS, NAMES

BARE = """
import sys, time, viser
server = viser.ViserServer(host="127.0.0.1", port=int(sys.argv[1]), verbose=False)
@server.on_client_connect
def _(client):
    box = client.scene.add_box("/box")
    slider = client.gui.add_slider("x", -180.0, 180.0, 0.5, 0.0)
    @slider.on_update
    def _(_):
        box.position = (slider.value, 0.0, 0.0)
        client.flush()
print("ready", server.get_port(), flush=True)
time.sleep(3600)
"""

SCRIPT = """
window.__place = name => {
  const node = window.__viserMutable && window.__viserMutable.nodeRefFromName[name];
  return node ? node.position.toArray().concat(node.quaternion.toArray()).join() : "";
};
window.__turn = () => new Promise(done => setTimeout(done, 1));
window.__press = async (thumb, key, watch, timeout) => {
  const before = watch();
  const start = performance.now();
  thumb.dispatchEvent(new KeyboardEvent("keydown", {key: key, bubbles: true}));
  while (performance.now() - start < timeout) {
    if (watch() !== before) return performance.now() - start;
    await window.__turn();
  }
  return NaN;
};
"""

SCENE = """async ([label, node, key]) => {
  const thumb = window.__thumb(label);
  return window.__press(thumb, key, () => window.__place(node), 5000);
}"""

MAPS = """async ([label, key]) => {
  const thumb = window.__thumb(label);
  const picture = () => [...document.images].filter(i => i.width > 250).map(i => i.src).join();
  return window.__press(thumb, key, picture, 5000);
}"""

THUMB = """
window.__thumb = label => {
  for (const found of document.querySelectorAll("label"))
    if (found.textContent.replace(/\\s+/g, "") === label.replace(/\\s+/g, ""))
      return document.getElementById(found.htmlFor).querySelector("[role=slider]");
  throw new Error("no slider " + label);
};
"""

DRAG = """async ([label, seconds]) => {
  const thumb = window.__thumb(label);
  let changes = 0, presses = 0;
  const observer = new MutationObserver(found => {
    if (found.some(change => change.target.width > 250)) changes += 1;
  });
  observer.observe(document.body, {subtree: true, attributeFilter: ["src"]});
  const start = performance.now();
  while (performance.now() - start < 1000 * seconds) {
    thumb.dispatchEvent(new KeyboardEvent("keydown",
      {key: presses++ % 80 < 40 ? "ArrowRight" : "ArrowLeft", bubbles: true}));
    await new Promise(done => setTimeout(done, 16));
  }
  observer.disconnect();
  return changes / seconds;
}"""

LAST = """async label => {
  const thumb = window.__thumb(label);
  for (let i = 0; i < 500; i++) {
    thumb.dispatchEvent(new KeyboardEvent("keydown",
      {key: i < 300 ? "ArrowRight" : "ArrowLeft", bubbles: true}));
    await new Promise(done => setTimeout(done, 4));
  }
  await new Promise(done => setTimeout(done, 1500));
  return Number(thumb.getAttribute("aria-valuenow"));
}"""


def start_bare() -> tuple[subprocess.Popen[str], str]:
    """Start the bare page; returns its process and address."""
    process = subprocess.Popen([sys.executable, "-c", BARE, "0"], stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    while not (line := process.stdout.readline()).startswith("ready"):
        assert process.poll() is None, "the bare page did not start"
    return process, f"http://127.0.0.1:{line.split()[1]}"


def start_explorer() -> tuple[subprocess.Popen[str], str]:
    """Start the explorer as its command does; returns its process and address."""
    process = subprocess.Popen(
        [sys.executable, "-m", "paminsa_viz", "--port", "0", "--no-browser"],
        stdout=subprocess.PIPE, text=True,
    )  # fmt: skip
    assert process.stdout is not None
    while "explorer:" not in (line := process.stdout.readline()):
        assert process.poll() is None, "the explorer did not start"
    return process, line.split("explorer:")[1].split()[0]


def open_page(browser: Any, url: str, ready: str, size: tuple[int, int]) -> Any:
    """Open a page and wait until it can be used."""
    page = browser.new_page(viewport={"width": size[0], "height": size[1]})
    page.set_default_timeout(120_000)
    page.goto(url)
    page.locator(ready).first.wait_for()
    page.evaluate(SCRIPT + THUMB + "null")  # not the function itself, which would be called
    return page


def press_often(page: Any, script: str, arguments: list[str], count: int) -> list[float]:
    """Measure many key presses, to and fro, with a rest between them."""
    times = []
    for i in range(count):
        key = "ArrowRight" if i % 20 < 10 else "ArrowLeft"
        times.append(page.evaluate(script, [*arguments, key]))
        page.wait_for_timeout(120)
    return times


def starts(browser: Any, rounds: int, size: tuple[int, int]) -> float:
    """Time from the command to a page that can be used, both in turn; return the difference [s]."""
    rows = {"bare viser page": [], "explorer": []}
    for _ in range(rounds):
        for name, start, ready in (
            ("bare viser page", start_bare, "[role=slider]"),
            ("explorer", start_explorer, "[data-testid=status]"),
        ):
            begin = time.perf_counter()
            process, url = start()
            page = open_page(browser, url, ready, size)
            rows[name].append(time.perf_counter() - begin)
            page.close()
            process.terminate()
            process.wait()
    heading("From the command to a page that can be used [s]")
    table(
        ["page", "least", "median"],
        [[name, number(min(t)), number(float(np.median(t)))] for name, t in rows.items()],
    )
    return float(np.median(rows["explorer"]) - np.median(rows["bare viser page"]))


def latencies(browser: Any, count: int, size: tuple[int, int]) -> dict[str, float]:
    """Time from a slider's event to the changed scene and map.

    Returns:
        95th percentiles by what moves [ms], and how many maps a second follow a drag.
    """
    bare, bare_url = start_bare()
    explorer, url = start_explorer()
    try:
        box = open_page(browser, bare_url, "[role=slider]", size)
        page = open_page(browser, url, "[data-testid=status]", size)
        page.wait_for_timeout(15_000)  # until the kernels are compiled
        rows, found = [], {}
        for name, where, script, arguments in (
            ("bare page: box", box, SCENE, ["x", "/box"]),
            ("explorer: platform, x", page, SCENE, ["x [mm]", "/robot/platform"]),
            ("explorer: platform, θ", page, SCENE, ["θ [°]", "/robot/platform"]),
            ("explorer: torque maps, θ", page, MAPS, ["θ [°]"]),
        ):
            where.bring_to_front()
            press_often(where, script, arguments, 5)
            times = np.array(press_often(where, script, arguments, count))
            found[name] = float(np.nanpercentile(times, 95))
            rows.append(
                [
                    name,
                    number(float(np.nanpercentile(times, 50))),
                    number(found[name]),
                    str(int(np.isnan(times).sum())),
                ]
            )
        heading(f"From a slider's event to the change [ms], window {size[0]} x {size[1]}")
        table(["what", "p50", "p95", "lost"], rows)
        page.bring_to_front()
        found["maps"] = page.evaluate(DRAG, ["θ [°]", 6])
        print(f"Torque maps while θ is dragged: {found['maps']:.1f} a second")
        last = page.evaluate(LAST, "θ [°]")
        turn = page.evaluate("name => window.__place(name)", "/robot/platform").split(",")
        shown = np.degrees(2 * np.arctan2(float(turn[5]), float(turn[6])))
        print(f"A drag of 500 events: slider at {last}°, platform at {shown:.6f}°")
        return found
    finally:
        for process in (bare, explorer):
            process.terminate()
            process.wait()


def installed() -> str:
    """Return the path of a browser; exit without one."""
    path = next((found for name in NAMES if (found := shutil.which(name))), None)
    return path or sys.exit("no Chromium or Chrome is installed")


def main() -> None:
    """Run everything."""
    from playwright.sync_api import sync_playwright

    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--count", type=int, default=60, help="key presses of each kind")
    arguments.add_argument("--rounds", type=int, default=4, help="starts of each page")
    arguments.add_argument("--size", type=int, nargs=2, default=(1280, 720), help="window [px]")
    chosen = arguments.parse_args()
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=installed(), args=FLAGS)
        starts(browser, chosen.rounds, tuple(chosen.size))
        latencies(browser, chosen.count, tuple(chosen.size))
        browser.close()


if __name__ == "__main__":
    main()
