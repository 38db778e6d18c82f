"""Finds a browser, starts it headless, and drives the explorer's page as a person would."""

from __future__ import annotations

import asyncio
import os
import re
import shutil
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from typing import Any

import numpy as np
import pytest

from paminsa_viz.explorer.browser.bridge import STORE_KEY
from paminsa_viz.explorer.core import tab_store
from paminsa_viz.explorer.core.docks import left_dock
from paminsa_viz.explorer.core.workspaces import view_of
from paminsa_viz.explorer.tabs import WORKSPACES
from paminsa_viz.units import TIE
from tests.support.desk import input_labeled

FLAGS = [
    "--headless=new",
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]

FLAGS_OF_TESTS = [
    "--webgl-msaa-sample-count=0", "--disable-gpu-rasterization", "--disable-gpu-compositing",
]  # fmt: skip
"""Less work where edges need not be smooth, and the processor stands for the graphics card."""

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")

PIXEL = 0.008
"""More than a pixel of a map in a dock that is as wide as at first [m]."""

TIMEOUT = 60.0
"""How long a slow machine may take to show something [s]."""

COMPUTING = 4 * TIMEOUT
"""How long it may take to compute something, with kernels that have to be compiled first [s]."""


def browser_path() -> str:
    """Return a browser's path; without one skip the test, or fail where one is required."""
    found = next((path for name in NAMES if (path := shutil.which(name))), None)
    if found is None:
        reason = "no Chromium or Chrome is installed, so the page cannot be tried in a browser"
        if os.environ.get("PAMINSA_VIZ_REQUIRE_BROWSER"):
            pytest.fail(reason)
        pytest.skip(reason)
    return found


NODE_PLACE = """name => {
  const node = window.__viserMutable?.nodeRefFromName[name];
  return node ? node.position.toArray().concat(node.quaternion.toArray()) : null;
}"""


MAP_PLACE = """([x, y]) => {
  const all = [...document.querySelectorAll("[data-paminsa-frame]")];
  const marks = all.find((one) => one.offsetParent);
  if (!marks) return null;
  const { edges: [left, right, bottom, top], panels: [[start, head, width, height]] } =
    JSON.parse(marks.dataset.paminsaFrame);
  const box = marks.getBoundingClientRect();
  const place = [
    box.left + box.width * (start + width * (1e3 * x - left) / (right - left)),
    box.top + box.height * (head + height * (top - 1e3 * y) / (top - bottom)),
  ];
  const under = document.elementFromPoint(...place);
  return [...place, under?.dataset.paminsaPicture ? "" : (under?.outerHTML ?? "").slice(0, 300)];
}"""
"""Where a place (x, y) [m] of the first map is on the page [px], and what covers it, or nothing."""

OPEN_TABS = """() => [...document.querySelectorAll("[role=tab][aria-selected=true]")]
  .filter((tab) => tab.checkVisibility()).map((tab) => tab.textContent.trim())"""
"""Names of the tabs that the page shows; to find one by its role takes ten times as long."""

UNDRAWN = """(() => {
  const draws = Object.getOwnPropertyNames(WebGL2RenderingContext.prototype)
    .filter((name) => /^draw(Arrays|Elements|RangeElements)/.test(name));
  for (const name of draws) {
    const draw = WebGL2RenderingContext.prototype[name];
    WebGL2RenderingContext.prototype[name] = function (...rest) {
      if (window.drawn) draw.apply(this, rest);
    };
  }
})()"""
"""Leaves the 3D view empty until ``drawn`` is set, without a graphics card most of a page's work.
All else is as it is: nodes, shaders, clicks, which viser finds by rays, and how often it draws."""

CLOSE_NOTICE = "document.querySelector('#webgl-software-rendering button')?.click()"
"""Closes viser's notice of software WebGL, which would stay over the view."""


def until(
    condition: Callable[[], Any], what: str | Callable[[], str], timeout: float = TIMEOUT
) -> Any:
    """Return the first true value of a condition.

    Args:
        condition: As above.
        what: What is waited for, or a function that says it with how things are at the end.
        timeout: How long [s].

    Raises:
        AssertionError: If it does not come true in time.
    """
    end = time.monotonic() + timeout
    while True:
        value = condition()
        if value:
            return value
        if time.monotonic() >= end:
            said = what if isinstance(what, str) else what()
            raise AssertionError(f"not within {timeout:.0f} s: {said}")
        time.sleep(0.03)


def watch_errors(page: Any) -> list[str]:
    """Return a list that collects what goes wrong in a page.

    A picture that is replaced before the browser has read it is no error: viser takes back its
    address. Nor is a figure that viser removes while Plotly still lays out its margins.
    """
    errors: list[str] = []

    def report(line: Any) -> None:
        replaced = line.location.get("url", "").startswith("blob:")
        if line.type == "error" and not (replaced and "ERR_FILE_NOT_FOUND" in line.text):
            errors.append(line.text)

    def fail(error: Any) -> None:
        if "_redrawFromAutoMarginCount" not in str(error):
            errors.append(str(error))

    page.on("pageerror", fail)
    page.on("console", report)
    return errors


class Tab:
    """One browser tab on the explorer, and the session behind it.

    Attributes:
        page: The page in the browser.
        app: The explorer.
        errors: What went wrong in the page.

    Args:
        page: As above.
        app: As above.
        pixel_ratio: Pixels of the 3D view for one of the page's; None leaves it to the page.
        link: What follows the # of the address.
        drawn: Whether the 3D view is drawn, for tests that look at its picture.
    """

    def __init__(
        self,
        page: Any,
        app: Any,
        pixel_ratio: float | None = 1,
        link: str = "",
        *,
        drawn: bool = False,
    ) -> None:
        self.page, self.app = page, app
        self.errors = watch_errors(page)
        if not drawn:
            page.add_init_script(UNDRAWN)
        page.set_default_timeout(1000 * TIMEOUT)
        self._address = app.url if pixel_ratio is None else f"{app.url}?fixedDpr={pixel_ratio}"
        self._load(lambda: page.goto(f"{self._address}#{link}".rstrip("#")))

    def set_drawn(self, drawn: bool) -> None:
        """Draw the 3D view from now on, or leave it empty."""
        self.page.evaluate("drawn => { window.drawn = drawn; }", drawn)

    def open_link(self, link: str) -> None:
        """Load the page by a link, in a new session; from elsewhere, so that it is loaded."""
        self.page.goto("about:blank")
        self._load(lambda: self.page.goto(f"{self._address}#{link}"))

    def cut_connection(self) -> None:
        """Cut the connection; the page connects again, and all of it is made again."""
        before, server = self.session, self.app.server._websock_server
        connection = server._live_connections[before.client.client_id]  # other tabs keep theirs
        asyncio.run_coroutine_threadsafe(connection.close(), server._background_event_loop)
        until(lambda: before.closed, "the connection is lost")

    def reload(self) -> None:
        """Load the page again, in a new session."""
        self._load(self.page.reload)

    def _load(self, load: Callable[[], Any]) -> None:
        self._known = set(self.app.sessions)
        load()
        self.page.get_by_test_id("status").wait_for()
        self.page.evaluate(CLOSE_NOTICE)
        self._session = until(self._built, "a session for the tab")

    def _built(self) -> Any:
        """Return the newest session that is built; a browser may have tried to connect twice."""
        found = [n for n in list(self.app.sessions) if n not in self._known]
        new = [one for one in map(self.app.sessions.get, found) if one and one.built.is_set()]
        return next((one for one in reversed(new) if not one.closed), None)

    @property
    def session(self) -> Any:
        """The session of the page, which connects again if it has lost its connection."""
        if self._session.closed:
            self._session = until(self._built, "the page connects again")
        return self._session

    @property
    def state(self) -> Any:
        """The session's newest state."""
        return self.session.state

    def dispatch(self, action: Callable[[Any], Any]) -> None:
        """Change the state from elsewhere, and wait until that has been carried out."""
        done = threading.Event()
        self.session.dispatch("test", action)
        self.session.submit(done.set)
        assert done.wait(TIMEOUT), "the session does not get to it"

    def handle(self, label: str) -> Any:
        """Return the input with a label, as the server knows it, once its section is built."""

        def built() -> Any:
            with suppress(StopIteration):
                return input_labeled(self.session, label)

        return until(built, f"the input {label}")

    def element(self, label: str) -> Any:
        """Return the input with a label on the page."""
        return self.page.locator(f'[id="{self.handle(label)._impl.uuid}"]')

    def slider(self, label: str) -> Any:
        """Return the thumb of a slider on the page."""
        return self.element(label).locator("[role=slider]")

    def number_box(self, label: str) -> Any:
        """Return the number box of a slider on the page."""
        return self.element(label).locator("xpath=..").locator("input:not([type=hidden])")

    def press(self, label: str, key: str, times: int = 1) -> None:
        """Focus a slider and press a key; the page sends at most one value every 50 ms."""
        self.slider(label).focus()
        for _ in range(times):
            self.page.keyboard.press(key)
        self.page.wait_for_timeout(80)

    def type_number(self, label: str, value: float) -> None:
        """Type into the number box of a slider."""
        field = self.number_box(label)
        field.fill(str(value))
        field.press("Enter")
        self.page.wait_for_timeout(80)

    def click(self, button: str) -> None:
        """Click a button, once what opens above it has opened."""
        place = self.page.get_by_role("button", name=button, exact=True).first
        self.steady_box(place)
        place.click()

    def unfold(self, title: str) -> None:
        """Open a folder that is seen; a test before on the same page may have left it open."""
        head = self.page.get_by_role("button", name=title, exact=True).locator("visible=true").last
        self.steady_box(head)
        if head.get_attribute("aria-expanded") == "false":
            head.click()
        until(lambda: head.get_attribute("aria-expanded") == "true", f"{title} is unfolded")

    def click_in(self, place: Any, right: float = 0.5, down: float = 0.5) -> None:
        """Click into an element that stays where it is, at shares of its width and height."""
        box = self.steady_box(place)
        x, y = box["x"] + right * box["width"], box["y"] + down * box["height"]
        self.page.mouse.click(x, y)

    def click_map(self, x: float, y: float) -> None:
        """Click on the first map that is seen, at a place [m], once the map stays as it is."""
        right, down, cover = self._steady(lambda: self.page.evaluate(MAP_PLACE, [x, y]), "map")
        assert not cover, f"the map at {right:.0f}, {down:.0f} is covered by {cover}"
        self.page.mouse.click(right, down)

    def upload(self, button: str, name: str, content: bytes) -> None:
        """Press an upload button, and give it a file with a content."""
        self.choose_file(button, {"name": name, "mimeType": "text/plain", "buffer": content})

    def choose_file(self, button: str, file: Any) -> None:
        """Press an upload button, and give it a file, by its path or as Playwright describes it."""
        with self.page.expect_file_chooser() as asked:
            self.click(button)
        asked.value.set_files(file)

    def wait_frames(self, milliseconds: float) -> None:
        """Wait for a time and then for some frames, which may take long on a busy machine."""
        self.page.wait_for_timeout(milliseconds)
        for _ in range(3):
            self.page.evaluate("() => new Promise(done => requestAnimationFrame(done))")

    def wait_saved(self) -> None:
        """Wait until the browser has saved what a reload of the tab has to find."""
        saved = f"sessionStorage.getItem('{STORE_KEY}')"
        until(
            lambda: self.page.evaluate(saved) == tab_store.dump(self.state),
            "the tab's state is saved",
        )

    def steady_box(self, place: Any) -> Any:
        """Return where an element is, once it stays there: what comes above moves it."""
        return self._steady(place.bounding_box, "element")

    def _steady(self, measure: Callable[[], Any], what: str) -> Any:
        """Return where something is, once it is there and stays."""

        def steady() -> Any:
            before = measure()
            self.wait_frames(150)
            return before if before == measure() else None

        return until(steady, f"the {what} stays where it is")

    def is_open(self, name: str) -> bool:
        """Whether a section, or another tab of a panel, is what the page shows."""
        return name in self.page.evaluate(OPEN_TABS)

    def open_tab(self, name: str) -> None:
        """Open a section, with its workspace; another tab of a panel; or the folder of files."""
        path = self.session.paths.get(name)
        if name == "File":
            if not self.page.get_by_test_id("gallery").is_visible():
                self.page.get_by_text("File", exact=True).first.click()
                self.page.get_by_test_id("gallery").wait_for()
                self.steady_box(self.page.get_by_test_id("gallery"))
            return
        if path is not None:
            self.open_workspace(path.partition("/")[0])
        self.page.get_by_role("tab", name=name, exact=True).click()

    def open_workspace(self, name: str) -> None:
        """Open a workspace, and wait for the tab of the left dock that opens with it."""
        before, known = self.state.workspace, view_of(self.state, name)
        self.page.get_by_role("tab", name=name, exact=True).click()
        until(lambda: self.state.workspace == name, f"workspace {name}")
        if before in ("", name) or left_dock(self.state, self.session.window)[1]:
            return
        first = next(one.beside for one in WORKSPACES if one.name == name)
        beside = first if known is None or not known.beside else known.beside
        found = self.page.get_by_role("tab", name=beside, exact=True)
        until(lambda: found.get_attribute("aria-selected") == "true", f"{beside} beside {name}")

    def text(self, test_id: str) -> str:
        """Return the text of a readout, with plain spaces."""
        return self.page.get_by_test_id(test_id).inner_text().replace(TIE, " ")

    def torques(self) -> np.ndarray:
        """Return the torques and the force of M1..M4 in the readout."""
        found = re.findall(r"M\d\s+(−?[\d.]+)", self.text("actuators"))
        return np.array([float(number.replace("−", "-")) for number in found])

    def place(self, node: str) -> list[float]:
        """Return position [m] and quaternion (x, y, z, w) of a scene node in the page."""
        return self.page.evaluate(NODE_PLACE, node)

    def platform(self) -> np.ndarray:
        """Return (x, y, theta, z) of the platform in the page's scene, once it is there."""
        place = until(lambda: self.place("/robot/platform"), "the robot is in the scene")
        x, y, z, _, _, k, w = place
        return np.array([x, y, 2 * np.arctan2(k, w), z])

    def last_messages(self) -> str:
        """Return the last messages of the page's script, as they came."""
        return self.session.bridge._inbox.value

    def wait_pose(self, index: int, value: float) -> None:
        """Wait until the last reachable pose has a coordinate."""
        until(
            lambda: abs(self.state.last_reachable.pose[index] - value) < 1e-6,
            lambda: f"coordinate {index} = {value}; it is {self.state.last_reachable.pose}",
        )

    def wait_platform(self, pose: Any = None) -> None:
        """Wait until the page draws the platform at a pose, or at the last reachable one."""
        until(
            lambda: np.allclose(
                self.platform(), self.state.last_reachable.pose if pose is None else pose, atol=1e-6
            ),
            "the platform is drawn at its pose",
        )


def wait_theme(tab: Tab, scheme: str) -> None:
    """Wait until the page has a theme, and its maps too."""
    tab.page.wait_for_selector(f'html[data-mantine-color-scheme="{scheme}"]', state="attached")
