"""A page that is slow, or whose scripts come late: it is whole in the end, and loses nothing."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from paminsa_viz.explorer.browser import bridge as bridges
from paminsa_viz.explorer.browser.bridge import STORE_KEY
from paminsa_viz.explorer.browser.style import CONTROLS_WIDTH, dock_width
from paminsa_viz.explorer.core import actions, tab_store
from paminsa_viz.explorer.core.docks import EDGE
from paminsa_viz.explorer.state.state import initial_state
from paminsa_viz.explorer.state.view import Docks
from tests.support.chromium import Tab, until

pytestmark = pytest.mark.browser

X = "x  [mm]"

HOLD = """() => {
  // Scripts that the server sends wait, in their order, until `release` is called.
  const RealFunction = window.Function;
  let held = [];
  window.release = () => { const runs = held; held = null; runs.forEach((run) => run()); };
  const made = (...parts) => {
    const run = new RealFunction(...parts);
    return /paminsa/i.test(parts.at(-1)) ? () => (held ? held.push(run) : run()) : run;
  };
  window.Function = new Proxy(RealFunction, {
    construct: (_, parts) => made(...parts),
    apply: (_, __, parts) => made(...parts),
  });
}"""

KEEP = f"""kept => {{
  if (!sessionStorage.getItem("{STORE_KEY}")) sessionStorage.setItem("{STORE_KEY}", kept);
}}"""
"""Makes the page one that was loaded before, and has kept a state."""

EDGES = """() => {
  const box = window.__viserMutable.canvas.getBoundingClientRect();
  return [box.left, box.right];
}"""


@pytest.fixture
def late_page(browser: Any) -> Iterator[Any]:
    """A page of the browser whose scripts are held back."""
    context = browser.new_context(viewport={"width": 1280, "height": 720})
    page = context.new_page()
    yield page
    context.close()


def wait_whole(tab: Tab) -> None:
    """Wait until a page has the sizes and all else that a page in time has."""
    window = (1280, 720)
    edges = [dock_width(*window) + EDGE, window[0] - CONTROLS_WIDTH - EDGE]
    until(lambda: tab.session.window == window, "its window")
    until(lambda: np.allclose(tab.page.evaluate(EDGES), edges, atol=2), "its docks", timeout=180)
    until(lambda: "PAMINSA explorer" in tab.page.title(), "its title")
    until(lambda: tab.page.locator("[data-paminsa-unit]").count() > 3, "units behind the boxes")
    until(lambda: tab.page.locator(".pv-legend").count() == 1, "the legend")


def test_page_whose_scripts_come_late_is_whole(
    late_page: Any, app: Any, tab: Tab, monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:  # fmt: skip
    monkeypatch.setattr(bridges, "HELLO_TIMEOUT", 0.2)  # built before the page has said a word
    late_page.add_init_script(f"({HOLD})()")
    late = Tab(late_page, app, pixel_ratio=0.5)
    assert "no messages from a page" in caplog.text
    assert late.session.window != (1280, 720)
    box = late.number_box(X)
    box.click()
    before = late.state.document.pose[0]
    late_page.keyboard.type("33.5", delay=300)
    assert late.state.document.pose[0] == before
    late_page.evaluate("release()")
    late_page.keyboard.press("Enter")
    late.wait_pose(0, 0.0335)
    wait_whole(late)
    late.wait_frames(1500)  # in which the page tells of its docks
    assert late.state.docks == Docks()
    late.dispatch(actions.go_home)
    until(
        lambda: np.allclose(late.session.camera[1], tab.session.camera[1], atol=3e-3),
        "the camera is where it is in time",
    )
    assert late.errors == []


def test_kept_state_that_comes_late_is_taken_and_not_written_over_newer_work(
    late_page: Any, app: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bridges, "HELLO_TIMEOUT", 0.2)
    kept = tab_store.dump(actions.move(initial_state(), x=-0.05))
    late_page.add_init_script(f"({KEEP})({json.dumps(kept)})")
    late_page.add_init_script(f"({HOLD})()")
    tab = Tab(late_page, app)
    assert tab.state.document.pose[0] != -0.05
    late_page.wait_for_timeout(1000)  # in which an idle page is saved
    tab.cut_connection()  # what the lost session sent comes before what the new one sends
    assert tab.state.document.pose[0] != -0.05
    late_page.evaluate("release()")
    tab.wait_pose(0, -0.05)
    assert not tab.state.offered
    tab.wait_saved()
    tab.reload()  # and this time something is set meanwhile
    tab.type_number(X, 33.5)
    tab.wait_pose(0, 0.0335)
    late_page.evaluate("release()")
    until(lambda: tab.state.offered, "the kept state is offered")
    assert tab.state.document.pose[0] == pytest.approx(0.0335)
    tab.wait_saved()
    tab.reload()  # again too late: the offer is kept with the newer work
    late_page.evaluate("release()")
    tab.wait_pose(0, 0.0335)
    tab.click("Open it")
    tab.wait_pose(0, -0.05)
    assert not tab.state.offered
    tab.click("Undo")
    tab.wait_pose(0, 0.0335)


def test_slow_browser_behind_a_slow_line_gets_a_whole_page(late_page: Any, app: Any) -> None:
    devtools = late_page.context.new_cdp_session(late_page)
    # By which Chromium keeps a processor busy: a larger one costs the other tests as much.
    devtools.send("Emulation.setCPUThrottlingRate", {"rate": 3})
    line = {"offline": False, "latency": 100, "downloadThroughput": 125_000}
    devtools.send("Network.emulateNetworkConditions", line | {"uploadThroughput": 125_000})
    tab = Tab(late_page, app)
    wait_whole(tab)
    before = tab.state.document.pose[0]
    box = tab.number_box(X)
    box.click()
    for key in "33.5":
        late_page.keyboard.press(key)
        assert tab.state.document.pose[0] == before
    box.press("Enter")
    tab.wait_pose(0, 0.0335)
    assert tab.state.docks == Docks()


def test_browser_tab_is_named_after_the_design(tab: Tab) -> None:
    name = tab.state.document.design.name
    until(lambda: tab.page.title() == f"{name} - PAMINSA explorer", "the design's name")
    tab.dispatch(lambda state: actions.vary(state, {"geometry.base_radius": 0.3}))
    until(
        lambda: (
            tab.state.document.design.name != name
            and tab.page.title() == f"{tab.state.document.design.name} - PAMINSA explorer"
        ),
        "it follows the design",
    )
