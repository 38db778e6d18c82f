"""The application as a whole, without a browser."""

from __future__ import annotations

import gc
import weakref
from typing import Any

import pytest

from paminsa_viz import app as program
from paminsa_viz.app import App, AppOptions
from paminsa_viz.errors import InvalidInput
from paminsa_viz.explorer import page
from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.page import build
from paminsa_viz.model import APPENDIX_4
from tests.support.raw_page import RawPage, eventually


@pytest.mark.slow
def test_what_a_closed_page_held_is_freed_soon(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(program, "COLLECTION_DELAY", 0.1)
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


@pytest.mark.parametrize("pages", [0, -1, program.MOST_PAGES + 1])
def test_a_number_of_pages_out_of_range_is_refused(pages: int) -> None:
    with pytest.raises(InvalidInput, match="--pages"):
        AppOptions(pages=pages)
