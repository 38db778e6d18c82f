"""Takes the pictures of the page in README and docs: ``python -m docs.pictures [name ...]``.

Needs the extra ``test`` and a Chromium or Chrome. Figures of the command line, such as
``torque-maps.png``, come from the commands that the pages quote.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from playwright.sync_api import sync_playwright

from paminsa_viz.app import App, AppOptions
from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core import motion as motions
from paminsa_viz.explorer.features.identification import actions as identify_actions
from paminsa_viz.explorer.state.state import State
from paminsa_viz.files.example_logs import example_log
from paminsa_viz.model import APPENDIX_4, Design, backend
from tests.support.chromium import FLAGS, Tab, browser_path, until

FOLDER = Path(__file__).parent / "images"
WIDTH, HEIGHT = 1400, 900

LOADED = replace(
    APPENDIX_4, name="Loaded", load=replace(APPENDIX_4.load, force_x=15.0, force_y=-20.0,
    force_z=-30.0, moment_z=2.0),
)  # fmt: skip
HEAVY = replace(APPENDIX_4, name="10 kg", payload=replace(APPENDIX_4.payload, mass=10.0))


def start(tab: Tab, pose: tuple[float, float, float], design: Design = APPENDIX_4) -> None:
    """Show a design at x, y [m] and theta [rad], in full detail."""
    x, y, theta = pose

    def shown(state: State) -> State:
        state = actions.with_design(state, design)
        return actions.set_layers(actions.move(state, x=x, y=y, theta=theta), fine=True)

    tab.dispatch(shown)
    until(lambda: tab.state.document.pose[0] == x, "the pose")


def show(tab: Tab, quantity: str, **layers: bool) -> None:
    """Show a quantity as the single map and on the floor, and layers of the scene."""
    tab.open_tab("Single map")
    tab.dispatch(
        lambda state: actions.set_layers(state, **layers).updated("map_view", quantity=quantity)
    )


def explorer(tab: Tab) -> None:
    start(tab, (0.06, -0.04, 0.5))


def motion(tab: Tab) -> None:
    start(tab, (0.06, -0.04, 0.5))
    tab.open_tab("Path")
    tab.open_tab("Motion plots")
    tab.dispatch(lambda state: motions.scrub(actions.set_layers(state, path=True), 0.988))


def dark(tab: Tab) -> None:
    tab.open_tab("Requirements")
    tab.open_tab("Single map")
    tab.click("Suggested set")
    volume(tab)


def requirements(tab: Tab) -> None:
    start(tab, (0.05, -0.03, 0.3))
    tab.open_tab("Requirements")
    tab.open_tab("Single map")
    tab.click("Suggested set")
    volume(tab)


def volume(tab: Tab) -> None:
    """Wait for the volume of the requirements, finely sampled."""
    until(lambda: tab.state.requirements.fine is not None, "the volume")


def synthesize(tab: Tab) -> None:
    requirements(tab)
    tab.open_tab("Synthesis")
    tab.click("Search")
    until(lambda: tab.state.synthesis.outcome is not None, "the answer", 300.0)
    tab.page.get_by_role("button", name="Open as current design").scroll_into_view_if_needed()


def accuracy(tab: Tab) -> None:
    start(tab, (0.08, 0.03, 1.0))
    tab.open_tab("Errors")
    show(tab, "error_horizontal", drive_errors=True, torques=False)


def loads(tab: Tab) -> None:
    start(tab, (0.0, 0.0, 0.0))
    tab.open_tab("Loads")
    tab.open_tab("Motion plots")
    layers = {"joint_forces": True, "utilization": True, "torques": False}

    def shown(state: State) -> State:
        state = actions.set_layers(state, **layers).updated("plots", plot="loads")
        return motions.scrub(state, 0.4)

    tab.dispatch(shown)


def vibration(tab: Tab) -> None:
    start(tab, (0.05, 0.02, np.pi / 6), HEAVY)
    tab.dispatch(lambda state: actions.move(state, z=-0.6))
    tab.open_tab("Stiffness")
    show(tab, "frequency_1", mode_shape=True)


def identify(tab: Tab) -> None:
    tab.open_tab("Logs")
    log = example_log()
    tab.dispatch(lambda state: identify_actions.use_log(state, "log", log))
    until(lambda: tab.state.identification.result is not None, "the log is identified")


def drives(tab: Tab) -> None:
    tab.open_tab("Drives")
    tab.click("Find drives")
    until(lambda: tab.state.drives.result is not None, "the drives")


def forces(tab: Tab) -> None:
    start(tab, (0.05, -0.03, 0.3), LOADED)
    tab.dispatch(lambda state: actions.set_layers(state, force_polygon=True, torques=False))
    camera = tab.session.client.camera
    camera.position, camera.look_at = (0.62, -0.72, -0.12), (0.05, -0.03, -0.55)
    for _ in ("left dock", "right dock"):
        tab.page.get_by_role("button", name="Collapse panel area").first.click()


PICTURES: dict[str, tuple[Callable[[Tab], None], dict[str, Any]]] = {
    "explorer": (explorer, {}),
    "motion": (motion, {}),
    "dark": (dark, {"color_scheme": "dark"}),
    "requirements": (requirements, {}),
    "synthesize": (synthesize, {}),
    "accuracy": (accuracy, {}),
    "loads": (loads, {}),
    "vibration": (vibration, {}),
    "forces": (forces, {}),
    "identify": (identify, {}),
    "drives": (drives, {}),
}
"""What is done for each, and options of the browser's context."""


def take(browser: Any, app: App, name: str) -> None:
    """Take one picture."""
    prepare, options = PICTURES[name]
    context = browser.new_context(viewport={"width": WIDTH, "height": HEIGHT}, **options)
    try:
        tab = Tab(context.new_page(), app, drawn=True)
        tab.wait_frames(3000)
        notice = tab.page.locator("[class*=Notification] button")  # of drawing in software
        if notice.count():
            notice.first.click()
        prepare(tab)
        tab.page.mouse.move(WIDTH / 2 - 150, 120)  # off tables and bodies, which would mark it
        tab.wait_frames(8000)  # maps and bodies at full resolution
        tab.page.screenshot(path=FOLDER / f"{name}.png")
    finally:
        context.close()


def main() -> None:
    """Take the pictures named on the command line, or all."""
    backend.compile_now()
    app = App(AppOptions(port=0, browser=False), APPENDIX_4)
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=browser_path(), args=FLAGS)
        for name in sys.argv[1:] or PICTURES:
            take(browser, app, name)
            print(FOLDER / f"{name}.png", flush=True)
        browser.close()
    app.stop()


if __name__ == "__main__":
    main()
