"""Every input of every panel: what it shows, takes, refuses and undoes."""

from __future__ import annotations

import math
import re
import threading
from collections import Counter
from collections.abc import Callable, Coroutine, Iterator
from types import SimpleNamespace
from typing import Any

import pytest
import viser

from paminsa_viz.explorer.browser.bridge import Bridge, _report_once, newest_value
from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core import motion as motions
from paminsa_viz.explorer.core.history import Snapshot
from paminsa_viz.explorer.core.maps import MapStore
from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.features.balance import actions as balancing
from paminsa_viz.explorer.features.clearance.tab import CLEARANCE
from paminsa_viz.explorer.features.export.tab import export_entries
from paminsa_viz.explorer.features.files.tab import FILE
from paminsa_viz.explorer.features.maps.tab import single_entries, torque_entries
from paminsa_viz.explorer.features.motion.plots import INPUTS as PLOT_INPUTS
from paminsa_viz.explorer.features.view.tab import view_entries
from paminsa_viz.explorer.kit import bindings
from paminsa_viz.explorer.kit.bindings import Binding, same
from paminsa_viz.explorer.kit.entries import Button, Entry, Upload, Worker, given
from paminsa_viz.explorer.kit.inputs import (
    Checkbox,
    Dropdown,
    Input,
    Number,
    Pair,
    Slider,
    TextBox,
    decimals,
    in_unit,
)
from paminsa_viz.explorer.state.motion import Kind
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.explorer.tabs import sections
from paminsa_viz.model import InvalidInput
from tests.support.desk import SilentPage, desk_with, stop
from tests.support.entries import flat, inputs_in
from tests.support.raw_page import eventually


def name(entry: Input, state: State) -> str:
    """Return what messages call an input."""
    return given(entry.label, state) or entry.key


TAB = {one.name: tuple(one.entries()) for one in sections().values()}
NO_PICTURE: Any = SimpleNamespace(scales=())
PANELS: dict[str, tuple[Entry, ...]] = {
    "pose": TAB["Pose"],
    "design": (*TAB["Lengths"], *TAB["Masses"], *TAB["Load"]),
    "balance": TAB["Balance"],
    "motion": (*TAB["Path"], *TAB["Simulate"]),
    "plots": PLOT_INPUTS,
    "drives": TAB["Drives"],
    "loads": TAB["Loads"],
    "accuracy": TAB["Errors"],
    "stiffness": TAB["Stiffness"],
    "view": (*view_entries(), *CLEARANCE),
    "export": tuple(export_entries(MapStore())),
    "file": FILE,
    "torque maps": torque_entries("torque maps", NO_PICTURE),
    "single map": single_entries("single map", NO_PICTURE),
}
EACH_PANEL = pytest.mark.parametrize("panel", PANELS)
JUNK: dict[type[Input], list[Any]] = {
    Slider: [math.nan, math.inf, 10**400, "1", None, True, [1.0]],
    Number: [math.nan, -math.inf, 10**400, "1", None, False, [1.0]],
    Pair: [[1.0, math.nan], [1.0], [1.0, 2.0, 3.0], [True, 1.0], "ab", None],
    Checkbox: [1, "on", None],
    Dropdown: ["no such text", 3, None],
    TextBox: [3, None],
}
ONE_WAY = {"balance.point", "weights.add"}
"""Inputs that show no value of the state: a step to a design of the front, an action."""


@pytest.fixture(scope="module")
def state() -> State:
    """A state in which as many inputs as possible have something to show."""
    state = actions.pin_reference(actions.move(initial_state(), x=0.02, theta=0.3))
    state = balancing.add_counterweight(state, "b8", 8)
    return motions.choose_kind(state, Kind.ARCH)


def test_labels_of_words_begin_with_a_capital(state: State) -> None:
    in_dock = {"plots", "torque maps", "single map"}  # which are narrow, and have short words
    tables = {**TAB, **{name: table for name, table in PANELS.items() if name not in in_dock}}
    small = {
        entry.key: label
        for table in tables.values()
        for entry in flat(table)
        if re.match("[a-z]{2}", label := str(given(entry.label, state)))
    }
    assert small == {}


def ends(entry: Input, state: State) -> list[tuple[Any, Any]]:
    """Return the lowest and highest values of a number's range, and values beyond them."""
    if isinstance(entry, (Slider, Number)):
        slider = isinstance(entry, Slider)
        low, high = given(entry.range, state) if slider else in_unit(entry.range, entry.unit)
        return [(end, end + sign) for end, sign in ((low, -1.0), (high, 1.0)) if end is not None]
    if isinstance(entry, Pair) and None not in sum(entry.range, ()):
        low, high = zip(*map(in_unit, entry.range, entry.units), strict=True)
        return [(low, (low[0], low[1] - 1.0)), (high, (high[0] + 1.0, high[1]))]
    return []


def another(entry: Input, state: State) -> Any:
    """Return a possible value that the input does not show."""
    if isinstance(entry, Checkbox):
        return not entry.shown(state)
    if isinstance(entry, Dropdown):
        shown = entry.shown(state)
        return next((text for text in given(entry.options, state) if text != shown), shown)
    if isinstance(entry, TextBox):
        return {"file.name": "light arms"}.get(entry.key, entry.shown(initial_state()))
    if entry.key.endswith(".ends"):
        return (-2.5, 4.0)
    if entry.key.startswith("weights."):
        return (150.0, 2.5)
    if isinstance(entry, Pair):
        return next(end for end, _ in ends(entry, state) if end != entry.shown(state))
    assert isinstance(entry, (Slider, Number))
    value, high, step = entry.shown(state), ends(entry, state)[-1][0], given(entry.step, state)
    return value + step if value < high else value - step


@EACH_PANEL
def test_input_takes_back_what_it_shows(panel: str, state: State) -> None:
    for entry in inputs_in(PANELS[panel]):
        if entry.key not in ONE_WAY:
            shown = entry.shown(state)
            after = entry.apply(state, entry.parse(state, shown))
            assert same(entry.shown(after), shown), entry.key


@EACH_PANEL
def test_value_of_another_kind_is_refused_by_name(panel: str, state: State) -> None:
    for entry in inputs_in(PANELS[panel]):
        for value in JUNK[type(entry)]:
            with pytest.raises(InvalidInput) as error:
                entry.parse(state, value)
            assert error.value.argument == name(entry, state) != ""


@EACH_PANEL
def test_ends_of_a_range_are_possible_and_no_number_beyond_them(panel: str, state: State) -> None:
    for entry in inputs_in(PANELS[panel]):
        if entry.key in ONE_WAY:
            continue
        for end, beyond in ends(entry, state):
            after = entry.apply(state, entry.parse(state, end))
            assert entry.shown(after) == pytest.approx(end, rel=1e-12, abs=5e-4)
            if not isinstance(entry, Slider):
                with pytest.raises(InvalidInput) as error:
                    entry.parse(state, beyond)
                assert error.value.argument == name(entry, state)
            elif entry.fit is None:
                step = math.copysign(given(entry.step, state), beyond - end)
                assert entry.parse(state, end + step) == entry.parse(state, end)
                with pytest.raises(InvalidInput, match="is possible"):
                    entry.parse(state, end + 2 * step)
            else:
                assert entry.parse(state, beyond) == entry.unit.to_si(beyond)


def test_masses_of_a_robot_five_times_as_long_can_be_typed(state: State) -> None:
    entries = {entry.key: entry for panel in PANELS.values() for entry in inputs_in(panel)}
    assert entries["balance.max_increase"].parse(state, 400.0) == 400.0
    assert entries["balance.max_added"].parse(state, 5000.0) == 5000.0
    value = entries["balance.slot_b3"].parse(state, (500.0, 400.0))
    settings = entries["balance.slot_b3"].apply(state, value).balance.settings
    assert settings.possible
    assert settings.slot_b3.max_mass == 400.0


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("balance.max_increase", -1.0),
        ("balance.max_decrease", 150.0),
        ("balance.slot_b8", (2000.0, 1.0)),
        ("balance.slot_b3", (100.0, -1.0)),
        ("balance.max_added", 1e6),
        ("balance.variation", 60.0),
        ("export.width", 1e6),
        ("export.dpi", 1e9),
        ("motion.radius", 0.0),
        ("simulation.bandwidth", 1e4),
    ],
)
def test_absurd_setting_is_refused(key: str, value: object, state: State) -> None:
    entries = {entry.key: entry for panel in PANELS.values() for entry in inputs_in(panel)}
    with pytest.raises(InvalidInput, match=r"is possible|is needed"):
        entries[key].parse(state, value)


@pytest.mark.slow
@EACH_PANEL
def test_every_choice_is_shown_once_it_is_made(panel: str, state: State) -> None:
    for entry in inputs_in(PANELS[panel]):
        if isinstance(entry, Dropdown) and entry.key not in ONE_WAY:
            for text in given(entry.options, state):
                assert entry.shown(entry.apply(state, entry.parse(state, text))) == text


def test_keys_and_labels_tell_inputs_apart(state: State) -> None:
    keys = Counter(entry.key for entries in PANELS.values() for entry in inputs_in(entries))
    assert {key for key, count in keys.items() if count > 1} == {"layers.path"}  # in two panels
    for entries in PANELS.values():
        names = Counter(name(entry, state) for entry in inputs_in(entries))
        assert max(names.values()) == 1, names.most_common(1)


@pytest.mark.slow
@EACH_PANEL
def test_each_input_sets_the_state_and_undo_takes_it_back(
    server: viser.ViserServer, panel: str, state: State
) -> None:
    entries = [entry for entry in PANELS[panel] if not isinstance(entry, Worker)]
    with desk_with(server, entries) as desk:
        for entry in inputs_in(entries):
            if entry.key in ONE_WAY or (entry.key.startswith("weights.") and entry.key[-1] != "0"):
                continue
            desk.dispatch(lambda _: state)
            desk.until(lambda e=entry: desk.handle(e.key).value == e.shown(state))
            value = another(entry, state)
            expected = entry.apply(state, entry.parse(state, value))
            desk.set(entry.key, value)
            desk.until(lambda e=entry, s=expected: e.read(desk.state) == e.read(s))
            assert desk.state == expected
            if expected.document != state.document and entry.undo:
                desk.session.undo()
                desk.until(lambda: desk.state.document == state.document)
                assert not desk.notices


def test_what_undo_sets_back_beside_the_document_is_a_step_of_its_own(state: State) -> None:
    """Or undo of the step before would take it back with that, without a word."""
    before = Snapshot.of(state)
    for entries in PANELS.values():
        for entry in inputs_in(entries):
            if not entry.undo and entry.key not in ONE_WAY:
                after = Snapshot.of(entry.apply(state, entry.parse(state, another(entry, state))))
                assert after._replace(document=before.document) == before, entry.key


@pytest.fixture
def session() -> Iterator[Session]:
    page: Any = SilentPage()
    started = Session(page, initial_state())
    started.start()
    yield started
    stop(started)


class FakeInput:
    """Stands in for an input of the page: its value is set at once, its callback comes later."""

    value = 0.0

    def __init__(self, session: Session, apply: Callable[[State, float], State]) -> None:
        entry = Slider(
            "x", range=(-1.0, 1.0), step=0.001, read=lambda s: s.document.pose[0], apply=apply
        )
        self._impl = SimpleNamespace(sync_cb=lambda client, updates: None)
        binding = Binding(session, entry, self)
        view: Any = SimpleNamespace(draw=lambda frame, dragging: binding.draw(frame.state))
        session.immediate.append(view)

    def on_update(self, callback: Callable[[Any], Coroutine[Any, Any, None]]) -> None:
        self.callback = callback

    def receive(self, value: float, between: float | None = None) -> None:
        """Do what the server does with a value from the page, in one go on its event loop.

        Args:
            value: As above.
            between: What the worker sets the input to before the callback.
        """
        self.value = value
        self._impl.sync_cb(1, {"value": value})
        self.value = value if between is None else between
        with pytest.raises(StopIteration):  # at its end; a browser test may have a loop that runs
            self.callback(SimpleNamespace(client=self)).send(None)


@pytest.mark.parametrize("between", [None, 0.0])
def test_value_that_the_worker_writes_over_as_it_arrives_is_kept(
    session: Session, between: float | None
) -> None:
    handle = FakeInput(session, lambda state, value: actions.move(state, x=value))
    drawing, arrived = threading.Event(), threading.Event()

    def write_over(state: State) -> State:
        drawing.set()
        assert arrived.wait(10)
        handle.value = 0.0  # the write of a frame that was drawn before
        return state

    session.dispatch("worker", write_over)
    assert drawing.wait(10)
    handle.receive(0.07, between)
    arrived.set()
    eventually(lambda: session.state.document.pose[0] == 0.07)
    eventually(lambda: handle.value == 0.07)
    session.undo()
    eventually(lambda: handle.value == 0.0)


def test_refused_value_that_was_written_over_as_it_arrived_is_still_there_while_typed(
    session: Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(state: State, value: float) -> State:
        raise InvalidInput("x", "it is not liked")

    monkeypatch.setattr(bindings, "TYPING_TIMEOUT", 1e4)
    handle = FakeInput(session, refuse)
    session.submit(lambda: handle.receive(0.07, between=0.0))
    eventually(lambda: handle.value == 0.07)
    assert not session.client.notices


@pytest.mark.parametrize("wrong", [0.07, math.nan, math.inf])
def test_input_is_set_back_after_a_refused_value(
    session: Session, wrong: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(state: State, value: float) -> State:
        raise InvalidInput("x", "it is not liked")

    monkeypatch.setattr(bindings, "TYPING_TIMEOUT", 0.05)
    handle = FakeInput(session, refuse)
    session.submit(lambda: handle.receive(wrong))  # so that nothing is drawn in between
    eventually(lambda: session.client.notices)
    eventually(lambda: handle.value == 0.0)
    assert len(session.client.notices) == 1


def test_viser_calls_back_after_it_has_told_the_value(server: viser.ViserServer) -> None:
    entry = next(e for e in inputs_in(PANELS["pose"]) if isinstance(e, Slider))
    with desk_with(server, [entry]) as desk:
        handle = desk.handle(entry.key)
        take, shown = handle._impl.sync_cb, entry.shown(desk.state)

        def then_write_over(client: Any, updates: Any) -> None:
            take(client, updates)
            handle._impl.value = shown

        handle._impl.sync_cb = then_write_over
        desk.set(entry.key, another(entry, desk.state))
        desk.until(lambda: entry.shown(desk.state) != shown)


def test_without_the_name_in_viser_the_input_itself_is_read(caplog: Any) -> None:
    _report_once.cache_clear()
    assert newest_value(SimpleNamespace(value=3.0))() == 3.0
    assert "what is typed while the page is drawn" in caplog.text
    _report_once.cache_clear()


def test_a_number_typed_again_as_it_is_shown_changes_nothing(server: viser.ViserServer) -> None:
    path = "geometry.guide_link_length"
    entry = next(e for e in inputs_in(PANELS["design"]) if e.key == f"design.{path}")
    assert isinstance(entry, Slider)
    with desk_with(server, [entry]) as desk:
        for value in (0.3635, 0.1 + 0.2, 1 / 3):  # not the number shown, in meters, to the last bit
            desk.dispatch(lambda s, v=value: actions.vary(s, {path: v}))
            desk.until(lambda: desk.handle(entry.key).value == entry.shown(desk.state))
            before = desk.state.document.design
            places = entry.places(desk.state)
            desk.set(entry.key, round(desk.handle(entry.key).value, places))
            desk.dispatch(lambda s: s)
            assert desk.state.document.design == before
            desk.set(entry.key, 300.25)
            desk.until(lambda b=before: desk.state.document.design != b)


def test_a_small_number_is_shown_with_its_digits() -> None:
    """3.8e-8 kg·m² in a box of the prototype was 0.0000000; 1e-16 mm of a pose is 0."""
    assert [decimals(step) for step in (0.00005, 0.5, 10.0)] == [7, 3, 3]
    for value in (3.81234e-8, -9.87654e-6, 2.5e-30):
        assert float(f"{value:.{decimals(0.00005, value)}f}") == value
    for value in (1e-5, 0.0038, 0.0, 12.0):
        assert decimals(0.00005, value) == 7, value
    masses = next(e for e in inputs_in(PANELS["design"]) if e.key == "design.links.b1")
    pose = next(e for e in inputs_in(PANELS["pose"]) if isinstance(e, Slider))
    state = actions.vary(initial_state(), {"links.b1": 2.5e-7})
    state = actions.move(state, x=1e-12)
    assert isinstance(masses, Slider)
    assert (masses.places(state), pose.places(state)) == (12, 3)


def test_the_page_is_told_tooltips_of_buttons_and_their_changes(
    server: viser.ViserServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    def stay(state: State) -> State:
        return state

    told: list[tuple[str, str]] = []
    monkeypatch.setattr(Bridge, "hint", lambda _, button, text: told.append((button.label, text)))
    entries = (
        Button("go", "Go", hint="Goes", effect=stay),
        Button("at", "At", hint=lambda s: f"x = {s.document.pose[0]:.3g}", effect=stay),
        Upload("open", "Open", mime_type="", hint="Opens", receive=lambda *_: None),
        Button("plain", "Plain", effect=stay),
    )
    with desk_with(server, entries) as desk:
        first = f"x = {desk.state.document.pose[0]:.3g}"
        assert told == [("Go", "Goes"), ("At", first), ("Open", "Opens")]
        for _ in range(2):
            desk.dispatch(lambda s: actions.move(s, x=0.1))
        desk.until(lambda: told[3:] == [("At", "x = 0.1")])
