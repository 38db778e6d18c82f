"""Fixtures: a guarded server, a panel on a session, a running explorer, tabs of a browser on it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import replace
from functools import partial
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


@pytest.fixture(scope="session")
def app() -> Iterator[Any]:
    """An explorer on any free port."""
    from paminsa_viz.app import App, AppOptions
    from paminsa_viz.explorer.server import memory
    from paminsa_viz.model import APPENDIX_4, backend

    backend.compile_now()
    with pytest.MonkeyPatch.context() as patch:
        # Tests close a page every few seconds; to look through all of the tests' memory for each
        # of them would cost as much as to open it.
        patch.setattr(memory, "COLLECTION_DELAY", 120.0)
        running = App(AppOptions(port=0, browser=False), APPENDIX_4)
        yield running
        running.stop()


WINDOW = {"width": 1280, "height": 720}

opened = 0
"""How many pages of browsers the tests of this process have opened."""


def _count(page: Any) -> None:
    global opened
    opened += 1


class Browser:
    """A browser that is started when a page is wanted, and again if it has died.

    Args:
        start: Starts one.
    """

    def __init__(self, start: Callable[[], Any]) -> None:
        self._start = start
        self._running: Any = None

    def new_context(self, **options: Any) -> Any:
        """Return what pages share that know nothing of others."""
        if self._running is None or not self._running.is_connected():
            self._running = self._start()
        context = self._running.new_context(**options)
        context.on("page", _count)
        return context

    def close(self) -> None:
        """End it, with all of its pages."""
        if self._running is not None:
            self._running.close()


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    """A headless browser that spares the processor, which has to draw the 3D view too."""
    from tests.support.chromium import FLAGS, FLAGS_OF_TESTS, browser_path

    playwright = pytest.importorskip("playwright.sync_api")
    options = {"executable_path": browser_path(), "args": [*FLAGS, *FLAGS_OF_TESTS]}
    with playwright.sync_playwright() as driver:
        one = Browser(lambda: driver.chromium.launch(**options))
        yield one
        one.close()


@contextmanager
def tabs_of(browser: Browser, app: Any) -> Iterator[Callable[..., Tab]]:
    """Return a function that opens a tab; at the end nothing may have gone wrong in any page."""
    from tests.support.chromium import Tab

    contexts: list[Any] = []
    tabs: list[Tab] = []

    def start(
        width: int = 1280,
        height: int = 720,
        context: Any = None,
        pixel_ratio: float | None = 1,
        link: str = "",
    ) -> Tab:
        if context is None:
            viewport = {"width": width, "height": height}
            context = browser.new_context(viewport=viewport, accept_downloads=True)
            contexts.append(context)
        tabs.append(Tab(context.new_page(), app, pixel_ratio, link))
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
def open_tab(browser: Browser, app: Any) -> Iterator[Callable[..., Tab]]:
    """A function that opens a tab for one test: a page that stays open goes on drawing."""
    with tabs_of(browser, app) as start:
        yield start


class SharedTab:
    """A tab that tests share, opened when the first of them wants it.

    Args:
        browser: Where.
        app: The explorer.
    """

    def __init__(self, browser: Browser, app: Any) -> None:
        self._browser, self._app = browser, app
        self._held = ExitStack()
        self._tab: Tab | None = None

    def get(self, *, new: bool) -> Tab:
        """Return the tab, or a new one in its place: the old one may have died."""
        if new:
            with suppress(Exception):  # the test that has failed has said why
                self.close()
        if self._tab is None:
            self._tab = self._held.enter_context(tabs_of(self._browser, self._app))()
        return self._tab

    def close(self) -> None:
        """Close the tab; nothing may have gone wrong in it."""
        self._tab = None
        self._held.close()


@pytest.fixture(scope="session")
def shared_tab(browser: Browser, app: Any) -> Iterator[SharedTab]:
    """The tab that all tests share which need none of their own."""
    shared = SharedTab(browser, app)
    yield shared
    shared.close()


@pytest.fixture
def tab(shared_tab: SharedTab, request: pytest.FixtureRequest) -> Iterator[Tab]:
    """The shared tab, as it was at the start; after a test that failed it is a new one."""
    tab = shared_tab.get(new=getattr(request.node, "execution_count", 1) > 1)
    _reset(tab)
    yield tab
    errors = tab.errors.copy()
    tab.errors.clear()
    assert errors == []


@pytest.fixture
def drawn(tab: Tab) -> Iterator[Tab]:
    """The shared tab with its 3D view drawn, for tests that look at its picture."""
    tab.set_drawn(True)
    yield tab
    if not tab.page.is_closed():
        tab.set_drawn(False)


MINIMIZE = """[...document.querySelectorAll('[aria-label="Minimize panel"]')]
  .filter((button) => button.checkVisibility()).forEach((button) => button.click())"""
"""Folds the panel View, which lies over the scene."""


def _reset(tab: Tab) -> None:
    """Bring a tab back to the start by what a person could do, and wait for it."""
    from paminsa_viz.explorer.scene.cameras import CAMERAS, look
    from paminsa_viz.explorer.state.state import initial_state
    from tests.support.chromium import OPEN_TABS, TIMEOUT, until

    def at_start(state: State) -> bool:
        """Whether it is the first state but for what is computed by itself."""
        first = initial_state()
        computed = {"stiffness": first.stiffness, "clearance": first.clearance}
        return replace(state, **computed) == first

    def is_reset() -> bool:
        return at_start(tab.state) and tab.handle("x  [mm]").value == 0

    tab.page.bring_to_front()
    if tab.page.viewport_size != WINDOW:
        tab.page.set_viewport_size(WINDOW)
        tab.wait_frames(500)  # in which panels follow
    tab.page.emulate_media(color_scheme="light", forced_colors="none")
    for _ in range(3):  # what the page has sent before may arrive after it
        # What the page has said of its tabs it does not say again.
        tab.dispatch(lambda s: replace(initial_state(), workspace=s.workspace))
        for name in sorted({"Pose", "Torque maps"} - set(tab.page.evaluate(OPEN_TABS))):
            tab.open_tab(name)
        with suppress(AssertionError):
            until(is_reset, "the tab is as at the start", TIMEOUT / 3)
            break
    assert is_reset()
    tab.page.evaluate(MINIMIZE)
    tab.session.submit(partial(look, tab.session, CAMERAS[0]))
    tab.page.wait_for_timeout(200)
