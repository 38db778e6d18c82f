"""What a person does is carried out in the order it came, whether the worker keeps up or not."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import pytest
import viser
from hypothesis import given, settings
from hypothesis import strategies as st

from paminsa_viz.explorer.core import history
from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.kit import bindings
from paminsa_viz.explorer.kit.entries import Button, ButtonGroup, Run
from paminsa_viz.explorer.kit.inputs import Checkbox, Slider
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.model import APPENDIX_4
from tests.support.desk import Desk, SilentPage, stop
from tests.support.raw_page import TIMEOUT

Change = Callable[[State], State]


def put(index: int, value: float) -> Change:
    """Return what sets a coordinate of the document's pose, wherever the robot can be."""

    def change(state: State) -> State:
        pose = list(state.document.pose)
        pose[index] = value
        return replace(state, document=replace(state.document, pose=tuple(pose)))

    return change


def press(index: int, factor: float) -> Change:
    """Return what a button does that builds on what was set before."""
    return lambda state: put(index, factor * state.document.pose[index] + 1)(state)


def mixed(pose: tuple[float, ...], part: float) -> float:
    """Return a number that depends on all that was set before."""
    return pose[0] + 3 * pose[1] + 7 * part


@dataclass
class Model:
    """What comes of requests one after the other, and of their steps, with no queue at all.

    Attributes:
        pose: The first two coordinates.
        part: What is not undone.
    """

    pose: tuple[float, ...] = (0.0, 0.0)
    part: float = 0.0
    past: list[tuple[float, ...]] = field(default_factory=list)
    future: list[tuple[float, ...]] = field(default_factory=list)
    dragged: int | None = None

    def set(self, index: int, value: float, source: int | None) -> None:
        if source is None or source != self.dragged:
            self.past.append(self.pose)
        self.dragged = source
        self.future.clear()
        self.pose = tuple(value if i == index else v for i, v in enumerate(self.pose))

    def travel(self, back: bool) -> None:
        self.dragged = None
        source, target = (self.past, self.future) if back else (self.future, self.past)
        if source:
            target.append(self.pose)
            self.pose = source.pop()


KINDS = ("drag x", "drag y", "drag part", "press x", "press y", "press part", "undo", "redo")


def request(session: Session, model: Model, kind: str, number: int) -> None:
    """Request one thing of a session, and do it in the model.

    No value comes twice: a drag that ends where it began is a step only if the worker saw
    what lay between.
    """
    verb, _, what = kind.partition(" ")
    value = 0.123456789 * number
    if verb in ("undo", "redo"):
        getattr(session, verb)()
        model.travel(verb == "undo")
    elif what == "part":

        def change(state: State) -> State:
            x, y, *_ = state.document.pose
            mix = mixed((x, y), state.floor_opacity)
            return replace(state, floor_opacity=value if verb == "drag" else mix)

        session.dispatch(kind, change, step=False, overtakes=verb == "drag")
        model.part = value if verb == "drag" else mixed(model.pose, model.part)
    elif verb == "drag":
        index = "xy".index(what)
        session.dispatch(kind, put(index, value), overtakes=True)
        model.set(index, value, index)
    else:
        index = "xy".index(what)

        def click(state: State) -> State:
            x, y, *_ = state.document.pose
            return put(index, mixed((x, y), state.floor_opacity) + number)(state)

        session.dispatch(kind, click)
        model.set(index, mixed(model.pose, model.part) + number, None)


@pytest.fixture(autouse=True)
def busy_machine_is_no_pause_of_the_person(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(history, "PAUSE", 600.0)


@pytest.mark.slow
@settings(max_examples=150, deadline=None)
@given(turns=st.lists(st.lists(st.sampled_from(KINDS), max_size=12), max_size=4))
def test_turns_of_the_worker_change_nothing_of_what_comes_out(turns: Sequence[list[str]]) -> None:
    page: Any = SilentPage()
    start = replace(put(1, 0.0)(put(0, 0.0)(initial_state())), floor_opacity=0.0)
    session, model, number = Session(page, start), Model(), 0
    for turn in turns:
        for kind in turn:
            number += 1
            request(session, model, kind, number)
        session._serve()
        assert session.state.document.pose[:2] == model.pose
        assert session.state.floor_opacity == model.part
        for kept, expected in (
            (session._history.past, model.past),
            (session._history.future, model.future),
        ):
            assert [snapshot.document.pose[:2] for snapshot in kept] == expected


UNDO, REDO = (Run(each, at_once=True) for each in (Session.undo, Session.redo))


class BusyDesk:
    """A panel of one slider, a switch and buttons, used while the worker does something else.

    Attributes:
        desk: The panel.
    """

    def __init__(self, server: viser.ViserServer) -> None:
        self._all_came = threading.Event()
        entries = (
            Slider(
                "x", range=(-99.0, 99.0), step=0.001, read=lambda state: state.document.pose[0],
                apply=lambda state, value: put(0, value)(state),
            ),
            Checkbox(
                "pinned", read=lambda state: state.document.reference is not None,
                apply=lambda state, on: replace(
                    state, document=replace(state.document, reference=APPENDIX_4 if on else None)
                ),
            ),
            ButtonGroup("row", choices={"x": press(0, 2.0), "y": press(1, 2.0)}),
            Button("add", "Add", effect=press(0, 1.0)),
            ButtonGroup("steps", choices={"Undo": UNDO, "Redo": REDO}),
            Button("end", "End", effect=Run(lambda session: self._all_came.set(), at_once=True)),
        )  # fmt: skip
        self.desk = Desk(server, entries)
        self.desk.dispatch(lambda state: put(1, 0.0)(put(0, 0.0)(state)))
        self.past.clear()

    @property
    def past(self) -> list[history.Snapshot]:
        """Steps that can be undone."""
        return self.desk.session._history.past

    @property
    def place(self) -> tuple[float, ...]:
        """x and y."""
        return self.desk.state.document.pose[:2]

    def do(self, *done: tuple[str, Any]) -> None:
        """Have a person do things in one turn of the worker; wait until they are carried out."""
        busy, may_go_on, carried_out = (threading.Event() for _ in range(3))

        def hold() -> None:
            busy.set()
            assert may_go_on.wait(TIMEOUT)

        self._all_came.clear()
        self.desk.session.submit(hold)
        assert busy.wait(TIMEOUT)
        for name, value in (*done, ("end", True)):
            self.desk.set(name, value)
        assert self._all_came.wait(TIMEOUT)
        self.desk.session.submit(carried_out.set)
        may_go_on.set()
        assert carried_out.wait(TIMEOUT)


@pytest.fixture
def busy(server: viser.ViserServer) -> Iterator[BusyDesk]:
    made = BusyDesk(server)
    yield made
    stop(made.desk.session)
    made.desk.page.socket.close()


def test_two_buttons_of_a_row_do_both(busy: BusyDesk) -> None:
    busy.do(("row", "x"), ("row", "y"))
    assert busy.place == (1.0, 1.0)
    assert len(busy.past) == 2


def test_two_clicks_of_a_button_are_two_and_two_steps(busy: BusyDesk) -> None:
    busy.do(("add", True), ("add", True))
    assert busy.place[0] == 2.0
    busy.do(("add", True))  # at once, in the next turn
    assert busy.place[0] == 3.0
    for x in (2.0, 1.0, 0.0):
        busy.do(("steps", "Undo"))
        assert busy.place[0] == x


def test_switch_that_is_turned_twice_is_two_steps(busy: BusyDesk) -> None:
    busy.do(("pinned", True), ("pinned", False))
    assert busy.desk.state.document.reference is None
    busy.do(("steps", "Undo"))
    assert busy.desk.state.document.reference is not None


def test_undo_comes_before_what_was_done_after_it(busy: BusyDesk) -> None:
    busy.do(("add", True))
    busy.do(("steps", "Undo"), ("row", "y"))
    assert busy.place == (0.0, 1.0)
    busy.do(("row", "x"), ("steps", "Undo"), ("steps", "Redo"), ("add", True))
    assert busy.place == (2.0, 1.0)
    assert len(busy.past) == 3


def test_value_does_not_pass_a_click(busy: BusyDesk) -> None:
    busy.do(("x", 3.0), ("row", "x"), ("x", 5.0), ("steps", "Undo"))
    assert busy.place[0] == 2 * 3.0 + 1
    busy.desk.until(lambda: busy.desk.handle("x").value == 7.0)


def test_drag_is_one_step_and_each_digit_that_is_typed_is_none(busy: BusyDesk) -> None:
    for value in (1.0, 12.0, 12.5):
        busy.do(("x", value))
    busy.do(*(("x", value) for value in (13.0, 14.0, 15.0)))
    assert busy.place[0] == 15.0
    assert len(busy.past) == 1


def test_refused_value_that_is_typed_over_does_not_come_back(
    busy: BusyDesk, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bindings, "TYPING_TIMEOUT", 0.05)
    busy.do(("x", 500.0))
    busy.do(("x", 5.0))
    time.sleep(0.1)
    busy.do()
    assert busy.place[0] == 5.0
    assert not busy.desk.notices
