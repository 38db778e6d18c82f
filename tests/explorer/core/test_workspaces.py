"""Workspaces are found again with what they were left with, over a reload as well."""

from __future__ import annotations

import threading
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from paminsa_viz.explorer.core import tab_store
from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.core.workspaces import switch, view_of
from paminsa_viz.explorer.scene import cameras
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.explorer.state.view import Camera, Dock, Docks
from paminsa_viz.explorer.tabs import enter_workspace
from tests.support.desk import SilentPage, stop
from tests.support.raw_page import TIMEOUT, eventually

CAMERA = Camera((1.0, -2.0, 0.5), (0.0, 0.1, -0.4))
WIDE = Docks(left=Dock(500, None))


def test_camera_and_docks_come_back_with_their_workspace() -> None:
    state = replace(initial_state(), workspace="Robot", camera=CAMERA, docks=WIDE)
    away = switch(state, "Motion", "Answer", frozenset({"path"}))
    assert away.camera == CAMERA  # a workspace that is opened first keeps what is seen
    assert away.docks == WIDE
    elsewhere = replace(away, camera=None, docks=Docks())
    back = switch(elsewhere, "Robot", "Torque maps", frozenset())
    assert (back.camera, back.docks) == (CAMERA, WIDE)
    left = view_of(back, "Motion")
    assert left is not None
    assert (left.camera, left.docks, left.beside) == (None, Docks(), "Torque maps")
    again = tab_store.restored(initial_state(), tab_store.dump(back))
    assert (again.camera, again.docks, again.workspaces) == (CAMERA, WIDE, back.workspaces)


def test_views_that_an_earlier_version_has_kept_are_read() -> None:
    state = switch(replace(initial_state(), workspace="Robot"), "Motion", "Answer", frozenset())
    text = tab_store.dump(state).replace(', "camera": null', "")
    assert "camera" not in text
    again = tab_store.restored(initial_state(), text)
    assert again.workspaces == state.workspaces


def test_a_workspace_that_is_left_before_the_worker_has_entered_it_is_left(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(cameras, "camera_of", lambda session: None)
    placed: list[str] = []
    monkeypatch.setattr(cameras, "place", lambda session: placed.append(session.state.workspace))
    page: Any = SilentPage()
    session = Session(page, replace(initial_state(), workspace="Robot"))
    vars(session)["bridge"] = SimpleNamespace(call=lambda *arguments: None)
    busy = threading.Event()

    def work(state: State) -> State:
        assert busy.wait(TIMEOUT)
        return state

    session.start()
    session.dispatch("slow", work)
    for names in (("Motion", "Path"), ("Robot", "Pose"), ("Robot", "Masses")):
        session.open_tabs = frozenset(names)
        enter_workspace(session)
    done: list[str] = []
    session.submit(lambda: done.append(session.state.workspace))
    busy.set()
    eventually(lambda: done)
    assert done == ["Robot"]
    assert placed == ["Motion", "Robot"]  # not once more, or a camera that was moved would go back
    stop(session)
