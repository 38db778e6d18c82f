"""Finds a browser, starts it headless, and drives the explorer's page as a person would."""

from __future__ import annotations

import os
import shutil
import time
from collections.abc import Callable
from typing import Any

import pytest

from paminsa_viz.explorer import persistence
from paminsa_viz.explorer.browser.bridge import STORE_KEY

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

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")

TIMEOUT = 60.0
"""How long a slow machine may take to show something [s]."""


def browser_path() -> str:
    """Return a browser's path; without one skip the test, or fail where one is required."""
    found = next((path for name in NAMES if (path := shutil.which(name))), None)
    if found is None:
        reason = "no Chromium or Chrome is installed, so the page cannot be tried in a browser"
        if os.environ.get("PAMINSA_VIZ_REQUIRE_BROWSER"):
            pytest.fail(reason)
        pytest.skip(reason)
    return found


def until(condition: Callable[[], Any], what: str, timeout: float = TIMEOUT) -> Any:
    """Return the first true value of a condition.

    Raises:
        AssertionError: If it does not come true in time.
    """
    end = time.monotonic() + timeout
    while True:
        value = condition()
        if value:
            return value
        assert time.monotonic() < end, f"not within {timeout:.0f} s: {what}"
        time.sleep(0.03)


def watch_errors(page: Any) -> list[str]:
    """Return a list that collects what goes wrong in a page."""
    errors: list[str] = []
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.on("console", lambda line: errors.append(line.text) if line.type == "error" else None)
    return errors


class Tab:
    """One browser tab on the explorer, and the session behind it.

    Attributes:
        page: The page in the browser.
        app: The explorer.
        session: The session of the page.
        errors: What went wrong in the page.
    """

    session: Any

    def __init__(self, page: Any, app: Any) -> None:
        self.page, self.app = page, app
        self.errors = watch_errors(page)
        page.set_default_timeout(1000 * TIMEOUT)
        self._load(lambda: page.goto(app.url + "?fixedDpr=1"))

    def reload(self) -> None:
        """Load the page again, in a new session."""
        self._load(self.page.reload)

    def _load(self, load: Callable[[], Any]) -> None:
        known = set(self.app.sessions)
        load()
        number = until(lambda: set(self.app.sessions) - known, "a session for the tab").pop()
        self.session = self.app.sessions[number]
        self.page.get_by_test_id("status").wait_for()
        assert self.session.built.wait(TIMEOUT)

    @property
    def state(self) -> Any:
        """The session's newest state."""
        return self.session.state

    def handle(self, label: str) -> Any:
        """Return the input with a label, as the server knows it."""
        inputs = self.session.client.gui._gui_input_handle_from_uuid.values()
        return next(handle for handle in inputs if getattr(handle, "label", None) == label)

    def slider(self, label: str) -> Any:
        """Return the thumb of a slider on the page."""
        return self.page.locator(f'[id="{self.handle(label)._impl.uuid}"] [role=slider]')

    def press(self, label: str, key: str, times: int = 1) -> None:
        """Focus a slider and press a key; the page sends at most one value every 50 ms."""
        self.slider(label).focus()
        for _ in range(times):
            self.page.keyboard.press(key)
        self.page.wait_for_timeout(80)

    def type_number(self, label: str, value: float) -> None:
        """Type into the number box of a slider."""
        track = self.page.locator(f'[id="{self.handle(label)._impl.uuid}"]')
        field = track.locator("xpath=..").locator("input:not([type=hidden])")
        field.fill(str(value))
        field.press("Enter")
        self.page.wait_for_timeout(80)

    def wait_frames(self, milliseconds: float) -> None:
        """Wait for a time and then for some frames, which may take long on a busy machine."""
        self.page.wait_for_timeout(milliseconds)
        for _ in range(3):
            self.page.evaluate("() => new Promise(done => requestAnimationFrame(done))")

    def wait_saved(self) -> None:
        """Wait until the browser keeps what a reload of the tab has to find."""
        until(
            lambda: (
                self.page.evaluate(f"sessionStorage.getItem('{STORE_KEY}')")
                == persistence.dump(self.state.document)
            ),
            "the tab's state is kept",
        )

    def steady_box(self, place: Any) -> Any:
        """Return where an element is, once it stays there: what comes above moves it."""

        def resting() -> Any:
            before = place.bounding_box()
            self.wait_frames(300)
            return before if before == place.bounding_box() else None

        return until(resting, "the element stays where it is")

    def open_tab(self, name: str) -> None:
        """Open a tab of a panel."""
        self.page.get_by_role("tab", name=name, exact=True).click()

    def text(self, test_id: str) -> str:
        """Return the text of a readout."""
        return self.page.get_by_test_id(test_id).inner_text()

    def place(self, node: str) -> list[float]:
        """Return where a scene node stands in the page, [m]."""
        return self.page.evaluate(
            "name => { const n = window.__viserMutable.nodeRefFromName[name];"
            " return n ? n.position.toArray().concat(n.quaternion.toArray()) : null; }",
            node,
        )

    def wait_pose(self, index: int, value: float) -> None:
        """Wait until the standing pose has a coordinate."""
        until(
            lambda: abs(self.state.standing.pose[index] - value) < 1e-6,
            f"coordinate {index} = {value}; it is {self.state.standing.pose}",
        )
