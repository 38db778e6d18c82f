"""Fixtures: a guarded server, a panel on a session, a running explorer, tabs of a browser on it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    import viser

    from paminsa_viz.explorer.state.state import State
    from tests.support.chromium import Tab
    from tests.support.desk import Desk
    from tests.support.scene import Scene


@pytest.fixture(scope="module")
def server() -> Iterator[viser.ViserServer]:
    """A guarded server on any free port."""
    from paminsa_viz.explorer.server.listening import open_server

    running = open_server(port=0)
    yield running
    running.stop()


@pytest.fixture
def desk(server: viser.ViserServer, request: pytest.FixtureRequest) -> Iterator[Desk]:
    """The module's ``PANEL`` on a session: a table of entries, or what makes a view."""
    from tests.support.desk import desk_with

    with desk_with(server, request.module.PANEL) as desk:
        yield desk


@pytest.fixture
def scene(server: viser.ViserServer) -> Iterator[Scene]:
    """All animated layers in the scene of a tab; nothing is drawn yet."""
    from paminsa_viz.explorer.scene.build import build_views
    from paminsa_viz.explorer.scene.context import SceneContext
    from tests.support.raw_page import RawPage
    from tests.support.scene import Scene

    page = RawPage(server)
    yield Scene(page.client.scene, build_views(SceneContext(page.client.scene), animated=True))
    page.socket.close()


@pytest.fixture(scope="module")
def app() -> Iterator[Any]:
    """An explorer on any free port."""
    from paminsa_viz.app import App, AppOptions
    from paminsa_viz.model import APPENDIX_4, backend

    backend.compile_now()
    running = App(AppOptions(port=0, browser=False), APPENDIX_4)
    yield running
    running.stop()


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    """A headless browser that spares the processor, which has to draw the 3D view too."""
    from tests.support.chromium import FLAGS, FLAGS_OF_TESTS, browser_path

    playwright = pytest.importorskip("playwright.sync_api")
    path = browser_path()
    with playwright.sync_playwright() as driver:
        chromium = driver.chromium.launch(executable_path=path, args=[*FLAGS, *FLAGS_OF_TESTS])
        yield chromium
        chromium.close()


@contextmanager
def tabs_of(browser: Any, app: Any) -> Iterator[Callable[..., Tab]]:
    """Return a function that opens a tab; at the end nothing may have gone wrong in any page."""
    from tests.support.chromium import Tab

    contexts: list[Any] = []
    tabs: list[Tab] = []

    def start(
        width: int = 1280,
        height: int = 720,
        context: Any = None,
        pixel_ratio: float = 1,
        link: str = "",
        drawn: bool = False,
    ) -> Tab:
        if context is None:
            context = browser.new_context(
                viewport={"width": width, "height": height}, accept_downloads=True
            )
            contexts.append(context)
        tabs.append(Tab(context.new_page(), app, pixel_ratio, link, drawn=drawn))
        return tabs[-1]

    try:
        yield start
    finally:
        for tab in tabs:
            tab.page.close()
        for context in contexts:
            context.close()
    for tab in tabs:
        assert tab.errors == []


@pytest.fixture
def open_tab(browser: Any, app: Any) -> Iterator[Callable[..., Tab]]:
    """A function that opens a tab for one test: a page that stays open goes on drawing."""
    with tabs_of(browser, app) as start:
        yield start


@pytest.fixture(scope="module")
def one_tab(browser: Any, app: Any, request: pytest.FixtureRequest) -> Iterator[Tab]:
    """A tab that the tests of a module share; its view is drawn where the module is ``DRAWN``."""
    with tabs_of(browser, app) as start:
        yield start(drawn=getattr(request.module, "DRAWN", False))


@pytest.fixture
def tab(one_tab: Tab) -> Tab:
    """The shared tab, as it was at the start."""
    from paminsa_viz.explorer.state.state import initial_state
    from tests.support.chromium import until

    def at_start(state: State) -> bool:
        """Whether it is the first state but for what is computed by itself."""
        first = initial_state()
        computed = {"stiffness": first.stiffness, "clearance": first.clearance}
        return replace(state, **computed) == first

    one_tab.page.bring_to_front()
    # What the page has said of its tabs it does not say again.
    one_tab.session.dispatch("test", lambda s: replace(initial_state(), workspace=s.workspace))
    until(lambda: not one_tab.state.workspaces, "the state is as at the start")
    one_tab.open_tab("Pose")
    until(
        lambda: at_start(one_tab.state) and one_tab.handle("x  [mm]").value == 0,
        "the tab is as at the start",
    )
    one_tab.page.wait_for_timeout(200)
    return one_tab
