"""Running servers for the tests of what gets through to them."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import pytest

from paminsa_viz.explorer.server.listening import Limits
from tests.support.guarded import GuardedServer


@pytest.fixture(scope="module")
def shared_server() -> Iterator[GuardedServer]:
    # The page limit of this one server is wide: the tests come faster than people.
    guarded = GuardedServer(Limits(sessions=200))
    yield guarded
    guarded.close()


@pytest.fixture
def guarded(shared_server: GuardedServer) -> Iterator[GuardedServer]:
    yield shared_server
    shared_server.close_pages()


@pytest.fixture
def start_guarded() -> Iterator[Callable[[Limits], GuardedServer]]:
    started: list[GuardedServer] = []

    def build(limits: Limits) -> GuardedServer:
        started.append(GuardedServer(limits))
        return started[-1]

    yield build
    for each in started:
        each.close()
