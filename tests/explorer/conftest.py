"""Fixtures: a guarded server, a panel on a session, a running explorer, tabs of a browser on it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import pytest
import viser

from paminsa_viz.explorer.server.listening import open_server
from paminsa_viz.explorer.state import initial_state
from tests.explorer.chromium import TIMEOUT, Tab, until
from tests.explorer.panel_desk import Desk, desk_with


@pytest.fixture(scope="module")
def server() -> Iterator[viser.ViserServer]:
    """A guarded server on any free port."""
    running = open_server(port=0)
    yield running
    running.stop()


@pytest.fixture
def desk(server: viser.ViserServer, request: pytest.FixtureRequest) -> Iterator[Desk]:
    """The module's ``PANEL`` on a session: a table of entries, or what makes a view."""
    with desk_with(server, request.module.PANEL) as desk:
        yield desk


@pytest.fixture(scope="module")
def app() -> Iterator[Any]:
    """An explorer on any free port."""
    from paminsa_viz.app import App, AppOptions
    from paminsa_viz.model import APPENDIX_4, backend

    backend.compile_now()
    running = App(AppOptions(port=0, browser=False), APPENDIX_4)
    yield running
    running.stop()


@pytest.fixture(scope="module")
def open_tab(browser: Any, app: Any) -> Iterator[Callable[..., Tab]]:
    """A function that opens a tab; at the end no tab may have complained."""
    contexts: list[Any] = []
    tabs: list[Tab] = []

    def start(width: int = 1280, height: int = 720, context: Any = None) -> Tab:
        if context is None:
            context = browser.new_context(
                viewport={"width": width, "height": height}, accept_downloads=True
            )
            contexts.append(context)
        page = context.new_page()
        page.set_default_timeout(1000 * TIMEOUT)
        complaints: list[str] = []
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on("console", lambda message: _complain(complaints, message))
        known = set(app.sessions)
        page.goto(app.url + "?fixedDpr=1")
        number = until(lambda: set(app.sessions) - known, "a session for the tab").pop()
        tab = Tab(page, app, app.sessions[number], complaints)
        page.get_by_test_id("status").wait_for()
        assert tab.session.built.wait(TIMEOUT)
        tabs.append(tab)
        return tab

    yield start
    for context in contexts:
        context.close()
    for tab in tabs:
        assert tab.complaints == []


def _complain(complaints: list[str], message: Any) -> None:
    if message.type == "error":
        complaints.append(message.text)


@pytest.fixture(scope="module")
def one_tab(open_tab: Callable[..., Tab]) -> Tab:
    """A tab that the tests of a module share."""
    return open_tab()


@pytest.fixture
def tab(one_tab: Tab) -> Tab:
    """The shared tab, as it was at the start."""
    one_tab.page.bring_to_front()
    one_tab.session.dispatch("test", lambda _: initial_state())
    one_tab.open_tab("Pose")
    until(
        lambda: one_tab.state == initial_state() and one_tab.handle("x  [mm]").value == 0,
        "the tab is as at the start",
    )
    one_tab.page.wait_for_timeout(200)
    return one_tab
