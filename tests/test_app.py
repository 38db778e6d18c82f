"""The application as a whole, without a browser."""

from __future__ import annotations

import gc
import io
import json
import subprocess
import sys
import threading
import weakref
from pathlib import Path
from typing import Any, cast

import pytest
import viser

from paminsa_viz import app as program
from paminsa_viz import kept
from paminsa_viz.app import App, AppOptions
from paminsa_viz.errors import InvalidInput
from paminsa_viz.explorer import page
from paminsa_viz.explorer.browser.bridge import Bridge
from paminsa_viz.explorer.core import actions, tab_store
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.core.saved_requirements import MOST_REQUIREMENTS
from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.page import build
from paminsa_viz.explorer.scene import cameras
from paminsa_viz.explorer.server import memory
from paminsa_viz.explorer.state.state import initial_state
from paminsa_viz.files.design_file import save_design
from paminsa_viz.meshes import prepare
from paminsa_viz.model import APPENDIX_4, backend
from paminsa_viz.quantities.requirements import Requirement, Requirements
from tests.support.raw_page import RawPage, eventually


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:Queued a .* on a closed connection")
def test_what_a_closed_page_held_is_freed_soon(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(memory, "COLLECTION_DELAY", 0.1)
    running = App(AppOptions(port=0, browser=False), APPENDIX_4)
    gc.disable()  # what is freed is freed by the program
    try:
        page = RawPage(running.server)
        number = page.client.client_id
        eventually(lambda: number in running.sessions)
        session = weakref.ref(running.sessions[number])
        del page.client
        page.socket.close()
        eventually(lambda: session() is None)
    finally:
        gc.enable()
        running.stop()


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:Queued a .* on a closed connection")
def test_results_that_only_a_closed_page_asked_for_are_not_kept() -> None:
    for function in kept._functions:
        function.cache_clear()  # what other tests have kept would give way to what this one needs
    running = App(AppOptions(port=0, browser=False), APPENDIX_4)

    def visit() -> int:
        """Use a page with a design of its own, and return how much was kept meanwhile."""
        page = RawPage(running.server)
        number = page.client.client_id
        session = eventually(lambda: running.sessions.get(number))
        for kind in ("hello", "shown"):
            session.bridge._deliver(kind, None)
        assert session.built.wait(60)
        drawn = threading.Event()
        changes = {"geometry.base_radius": 0.31 + number / 1e4}
        session.dispatch("test", lambda state: actions.vary(state, changes))
        session.submit(lambda: session.submit(drawn.set))  # after the next picture
        assert drawn.wait(60)
        assert session.state.document.design.geometry.base_radius > 0.305
        held = kept.kept_bytes()
        page.socket.close()
        eventually(lambda: number not in running.sessions)
        return held

    try:
        for fine in (False, True):
            prepare(APPENDIX_4.geometry, fine=fine)  # what the program keeps for the next page
        visit()
        first = kept.kept_bytes()
        assert visit() > first + 100_000
        assert kept.kept_bytes() <= first
    finally:
        running.stop()


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:Queued a .* on a closed connection")
def test_what_a_tab_has_kept_comes_while_the_page_is_drawn_and_is_not_written_over(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    saved: list[str] = []
    monkeypatch.setattr(Bridge, "save", lambda bridge, text: saved.append(text))
    stored = tab_store.dump(actions.move(initial_state(), x=-0.05))
    running = App(AppOptions(port=0, browser=False), APPENDIX_4)
    try:
        page = RawPage(running.server)
        session = eventually(lambda: running.sessions.get(page.client.client_id))

        class Hello:
            """The hello comes while a drawing goes on, before the tab's store has its turn."""

            came = False

            def draw(self, frame: Frame, dragging: bool) -> None:
                if session.built.is_set() and not dragging and not self.came:
                    self.came = True
                    session.bridge._deliver("hello", stored)

        session.fast.append(Hello())
        session.bridge._deliver("late", None)
        assert session.built.wait(60)
        eventually(lambda: saved)
        assert json.loads(saved[0])["pose"][0] == -0.05
    finally:
        running.stop()


def test_memory_is_given_back_while_pages_are_open(monkeypatch: pytest.MonkeyPatch) -> None:
    called: list[str] = []
    monkeypatch.setattr(memory, "TRIM_PERIOD", 0.02)
    monkeypatch.setattr(memory, "call_allocator", lambda name, *_: called.append(name))
    running = App(AppOptions(port=0, browser=False), APPENDIX_4)
    try:
        eventually(lambda: called.count("malloc_trim") > 1)
    finally:
        running.stop()


@pytest.mark.filterwarnings("ignore:Queued a:UserWarning")  # viser's, of what nobody receives
def test_a_tab_that_left_while_its_page_was_built_leaves_no_session(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    built: list[Session] = []

    def build_late(client: Any, *arguments: Any) -> Session:
        eventually(lambda: client.client_id not in running.server.get_clients())
        built.append(build(client, *arguments))
        return built[0]

    monkeypatch.setattr(page, "build", build_late)
    running = App(AppOptions(port=0, browser=False), APPENDIX_4)
    try:
        RawPage(running.server).socket.close()
        eventually(lambda: built and built[0].closed)
        eventually(lambda: not running.sessions)
    finally:
        running.stop()


def test_no_page_waits_for_a_compilation(monkeypatch: pytest.MonkeyPatch) -> None:
    """The first one may draw many maps before the kernels are loaded in the background."""
    kernels = backend._Kernels()
    kernels.deferred = False
    monkeypatch.setattr(backend, "_kernels", kernels)
    assert kernels.pays(2 * backend.WORTH_LOADING)

    class Over(Exception):
        pass

    class FirstTab(threading.Event):
        def wait(self, timeout: float | None = None) -> bool:
            assert not kernels.pays(2 * backend.WORTH_LOADING)
            raise Over  # the rest is not loaded here

    with pytest.raises(Over):
        program._load(cast(Any, None), FirstTab())


@pytest.mark.filterwarnings("ignore:Queued a:UserWarning")  # viser's, of what nobody receives
def test_a_window_that_is_resized_while_the_robot_is_built_is_fitted(
    server: viser.ViserServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    building, resized = threading.Event(), threading.Event()
    fitted: list[tuple[float, float]] = []

    def build_slowly(*_: Any, **__: Any) -> list[Any]:
        building.set()
        assert resized.wait(60)
        return []

    monkeypatch.setattr(page, "build_views", build_slowly)
    monkeypatch.setattr(cameras, "fit", lambda session: fitted.append(session.window))
    session = build(RawPage(server).client, APPENDIX_4)
    session.bridge._deliver("window", [1280, 720])
    session.bridge._deliver("painted", None)
    assert building.wait(60)
    assert not fitted
    session.bridge._deliver("window", [900, 700])
    resized.set()
    eventually(lambda: fitted)
    assert fitted == [(900, 700)]
    session.close()


@pytest.mark.parametrize(
    ("options", "wanted"),
    [
        ({}, False),
        ({"token": "on"}, True),
        ({"host": "0.0.0.0"}, True),
        ({"allow_host": ("robot.example",)}, True),
        ({"allow_host": ("localhost:9000",)}, False),
    ],
    ids=str,
)
def test_a_token_is_needed_where_others_can_connect(options: dict, wanted: bool) -> None:
    running = App(AppOptions(port=0, browser=False, **options), APPENDIX_4)
    running.stop()
    assert (running.token is not None) == wanted
    assert ("token=" in running.url) == wanted


@pytest.mark.parametrize("options", [{"host": "0.0.0.0"}, {"allow_host": ("robot.example",)}])
def test_no_option_serves_others_without_a_token(options: dict) -> None:
    with pytest.raises(InvalidInput, match="--token"):
        AppOptions(token="off", **options)


LOADED = """
import sys
from paminsa_viz.app import set_up_process
set_up_process()
from paminsa_viz.meshes import prepare
from paminsa_viz.model import APPENDIX_4
prepare(APPENDIX_4.geometry, fine=True)
print(*(name for name in sys.modules if name.startswith("networkx.")))
"""


@pytest.mark.slow
def test_a_server_makes_bodies_without_what_trimesh_alone_would_load() -> None:
    command = [sys.executable, "-c", LOADED]
    made = subprocess.run(command, capture_output=True, text=True, timeout=120, check=True)
    assert made.stdout.strip() == ""


@pytest.mark.parametrize("pages", [0, -1, program.MOST_PAGES + 1])
def test_a_number_of_pages_out_of_range_is_refused(pages: int) -> None:
    with pytest.raises(InvalidInput, match="--pages"):
        AppOptions(pages=pages)


def test_requirements_that_no_page_can_keep_are_refused_at_the_start(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A tab that was loaded again would open without all that was done in it."""
    monkeypatch.setattr(program, "set_up_process", lambda: None)
    monkeypatch.setattr(program, "App", None)  # it is not started
    needed = Requirements((Requirement("condition", high=8.0),) * (MOST_REQUIREMENTS + 1))
    path = save_design(APPENDIX_4, tmp_path / "robot.toml", requirements=needed)
    with pytest.raises(InvalidInput, match=f"at most {MOST_REQUIREMENTS} are possible here"):
        program.run(AppOptions(port=0, browser=False, design=path))


class _Closed(io.StringIO):
    """An output whose reader has gone when the address is printed."""

    def flush(self) -> None:
        if self.getvalue().count("\n") == 1:
            raise BrokenPipeError


def test_a_server_that_can_build_no_page_ends_with_the_reason(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Matplotlib needs a folder that it can write; that nobody reads the address is no reason."""

    def load(*_: object) -> None:
        raise OSError("a folder is needed")

    monkeypatch.setattr(program, "set_up_process", lambda: None)
    monkeypatch.setattr(program, "_load", load)
    monkeypatch.setattr(sys, "stdout", _Closed())
    with pytest.raises(OSError, match="a folder is needed"):
        program.run(AppOptions(port=0, browser=False))
