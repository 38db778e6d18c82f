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
import os
import shutil
import subprocess
import sys
import time
from typing import Any, NamedTuple

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
    if (found.some(change => "paminsaPicture" in change.target.dataset)) changes += 1;
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

LABELS = """
window.__labels = 0;
new MutationObserver(() => {
  const count = document.querySelectorAll("label[for]").length;
  if (count !== window.__count) window.__labels = performance.timeOrigin + performance.now();
  window.__count = count;
}).observe(document, {childList: true, subtree: true});
"""
"""Notes when the last input of the page came [ms]."""

OTHERS = ("Strength/Loads", "Strength/Stiffness", "Strength/Errors", "Optimize/Requirements")
"""Sections that are opened while the sliders of the pose are moved."""

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


def environment() -> dict[str, str]:
    """Return the environment of a user, for whom Python keeps what it has compiled."""
    return {name: text for name, text in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}


def start_bare() -> tuple[subprocess.Popen[str], str]:
    """Start the bare page; returns its process and address."""
    process = subprocess.Popen(
        [sys.executable, "-c", BARE, "0"], stdout=subprocess.PIPE, text=True, env=environment()
    )
    assert process.stdout is not None
    while not (line := process.stdout.readline()).startswith("ready"):
        assert process.poll() is None, "the bare page did not start"
    return process, f"http://127.0.0.1:{line.split()[1]}"


def start_explorer() -> tuple[subprocess.Popen[str], str]:
    """Start the explorer as its command does; returns its process and address."""
    process = subprocess.Popen(
        [sys.executable, "-m", "paminsa_viz", "--port", "0", "--no-browser"],
        stdout=subprocess.PIPE, text=True, env=environment(),
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


def launched(driver: Any) -> Any:
    """Return a browser of its own: the last page of another goes on drawing for a while."""
    return driver.chromium.launch(executable_path=installed(), args=FLAGS)


class Start(NamedTuple):
    """How long a start takes, from the command [s].

    Attributes:
        usable: Until the page can be used, over a bare viser page.
        whole: From there until the last input of all sections is there.
    """

    usable: float
    whole: float


def starts(driver: Any, rounds: int, size: tuple[int, int]) -> Start:
    """Time from the command to a page that can be used, both in turn; return medians."""
    rows: dict[str, list[float]] = {"bare viser page": [], "explorer": [], "all its sections": []}
    for turn in range(rounds + 1):
        for name, start, ready in (
            ("bare viser page", start_bare, "[role=slider]"),
            ("explorer", start_explorer, "[data-testid=status]"),
        ):
            browser = launched(driver)
            page = browser.new_page(viewport={"width": size[0], "height": size[1]})
            page.add_init_script(LABELS)
            begin, clock = time.perf_counter(), time.time()
            process, url = start()
            page.goto(url)
            page.locator(ready).first.wait_for()
            rows[name].append(time.perf_counter() - begin)
            if name == "explorer":
                page.wait_for_timeout(6000)
                last = page.evaluate("window.__labels") / 1e3 - clock
                rows["all its sections"].append(last)
            browser.close()
            process.terminate()
            process.wait()
        if turn == 0:  # in which Python compiles what the next ones read
            for times in rows.values():
                times.clear()
    heading("From the command to a page that can be used [s]")
    table(
        ["page", "least", "median"],
        [[name, number(min(t)), number(float(np.median(t)))] for name, t in rows.items()],
    )
    bare, usable, whole = (float(np.median(times)) for times in rows.values())
    return Start(usable - bare, whole - usable)


def latencies(driver: Any, count: int, size: tuple[int, int]) -> dict[str, float]:
    """Time from a slider's event to the changed scene and map.

    Returns:
        95th percentiles by what moves [ms], and how many maps a second follow a drag.
    """
    rows, found = [], {}

    def measure(name: str, where: Any, script: str, arguments: list[str]) -> None:
        press_often(where, script, arguments, 5)
        times = np.array(press_often(where, script, arguments, count))
        low, high = (float(np.nanpercentile(times, share)) for share in (50, 95))
        found[name] = high
        rows.append([name, number(low), number(high), str(int(np.isnan(times).sum()))])

    platform = "/robot/platform"
    for start, ready in ((start_bare, "[role=slider]"), (start_explorer, "[data-testid=status]")):
        browser = launched(driver)
        process, url = start()
        try:
            page = open_page(browser, url, ready, size)
            if start is start_bare:
                measure("bare page: box", page, SCENE, ["x", "/box"])
                continue
            page.wait_for_timeout(15_000)  # until the kernels are compiled
            measure("explorer: platform, x", page, SCENE, ["x [mm]", platform])
            measure("explorer: platform, θ", page, SCENE, ["θ [°]", platform])
            measure("explorer: torque maps, θ", page, MAPS, ["θ [°]"])
            found["maps"] = page.evaluate(DRAG, ["θ [°]", 6])
            last = page.evaluate(LAST, "θ [°]")
            turn = page.evaluate("name => window.__place(name)", platform).split(",")
            shown = np.degrees(2 * np.arctan2(float(turn[5]), float(turn[6])))
            for path in OTHERS:
                page.evaluate("path => window.paminsa.openTab(path)", path)
                page.wait_for_timeout(4000)
                for label in ("x [mm]", "θ [°]"):
                    section = path.partition("/")[2]
                    measure(f"{section} open: platform, {label[0]}", page, SCENE, [label, platform])
        finally:
            browser.close()
            process.terminate()
            process.wait()
    heading(f"From a slider's event to the change [ms], window {size[0]} x {size[1]}")
    table(["what", "p50", "p95", "lost"], rows)
    print(f"Torque maps while θ is dragged: {found['maps']:.1f} a second")
    print(f"A drag of 500 events: slider at {last}°, platform at {shown:.6f}°")
    return found


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
        starts(driver, chosen.rounds, tuple(chosen.size))
        latencies(driver, chosen.count, tuple(chosen.size))


if __name__ == "__main__":
    main()
