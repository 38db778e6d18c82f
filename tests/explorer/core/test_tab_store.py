"""What a tab keeps across a reload, and what of a damaged one."""

from __future__ import annotations

import json
import math
import threading
from dataclasses import replace
from operator import attrgetter
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest

from paminsa_viz.actuation.duty import Duty
from paminsa_viz.errors import PaminsaError
from paminsa_viz.explorer.core import actions, links, tab_store
from paminsa_viz.explorer.core.persistence import share_code
from paminsa_viz.explorer.state.balance import CounterweightSlot, Goal
from paminsa_viz.explorer.state.drives import DriveSettings
from paminsa_viz.explorer.state.maps import MapView, RangeMode
from paminsa_viz.explorer.state.settings import Settings
from paminsa_viz.explorer.state.springs import SpringsFrom
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.explorer.state.view import Dock, Docks
from paminsa_viz.files.drive_catalog import generic_catalog
from paminsa_viz.model import APPENDIX_4
from paminsa_viz.trajectory import PRESET, ControlMode

CHANGED = replace(
    actions.set_layers(actions.move(initial_state(), x=0.02), path=False, mesh=False),
    map_view=MapView("condition", RangeMode.MANUAL, 1.0, 7.5, shared=False, logarithmic=True),
    floor_opacity=0.4,
    condition_limit=12.0,
    table_at_rest=True,
).updated("plots", plot="power", published=True, color=2)
CHANGED = CHANGED.updated(
    "springs.settings", start=SpringsFrom.GUIDE, height=0.2, least=0.1, most=0.3
).updated("tolerances.settings", mass=0.05, length=0.002)
CHANGED = (
    CHANGED.updated("balance.settings", goal=Goal.RMS, slot_b8=CounterweightSlot(0.2, 3.0))
    .updated("drives.settings", order="margin", same=False, dwell=0.5)
    .updated("identification.settings", cut_off=9.0, legs=True, gains="1 2 3 40", harmonics=7)
    .updated("simulation.settings", control=ControlMode.FEED_FORWARD, bandwidth=5.0)
    .updated(
        "synthesis.settings", objective="moving_mass", seed=3,
        ranges=(("geometry.base_radius", (0.2, 0.5)),),
    )
)  # fmt: skip
FORMER = CHANGED
"""What the former version kept as well."""
CHANGED = (
    CHANGED.updated("loads.settings", leg=2, bar="b8", joint="5", along=True)
    .updated("stiffness.settings", mode=2, case="tilt_x", bar="b7")
    .updated("encoder.settings", gear=50.0)
    .updated("pins.settings", keys=("condition", "links.b4"))
    .updated("monte_carlo.settings", robots=500, seed=4, coordinate=3, leg=1, length=5)
    .updated("calibration.settings", poses=20, coordinates=4, held=0.1, seed=3)
    .updated("requirements.largest.settings", growth="VERTICAL", free=True, seconds=60.0)
)


def test_every_setting_is_changed_here() -> None:
    start = initial_state()
    places = [name for name in tab_store.VIEW if isinstance(attrgetter(name)(start), Settings)]
    assert len(places) >= 8
    docks = Docks(Dock(500), Dock(folded=True))
    changed = CHANGED.updated("clearance.settings", required=0.01).updated("", docks=docks)
    for name in places:
        assert attrgetter(name)(changed) != attrgetter(name)(start), name
    assert tab_store.restore(start, tab_store.dump(changed)) == changed


def test_catalog_and_cycle_come_from_files_and_are_not_kept() -> None:
    motion = PRESET["arch"].build(APPENDIX_4.geometry).sample()
    opened = {"catalog": generic_catalog(), "cycle": (Duty(motion),), "dwell": 0.5}
    found = tab_store.restore(
        initial_state(), tab_store.dump(CHANGED.updated("drives.settings", **opened))
    )
    assert found.drives.settings == DriveSettings(order="margin", same=False, dwell=0.5)


def test_everything_kept_comes_back() -> None:
    assert tab_store.restore(initial_state(), tab_store.dump(CHANGED)) == CHANGED


@pytest.mark.parametrize(
    ("part", "value"),
    [
        ("map_view", {"quantity": "mood"}),
        ("map_view", {"quantity": "condition", "low": 1e300}),
        ("map_view", 7),
        ("plots", {"plot": "nothing"}),
        ("plots", {"plot": "torques", "color": 9}),
        ("floor_opacity", 1.01),
        ("floor_opacity", "much"),
        ("condition_limit", 0.5),
        ("layers", [1, 2]),
        ("table_at_rest", None),
        ("springs.settings", {"height": 2.0}),
        ("springs.settings", {"start": "nowhere"}),
        ("springs.settings", {"least": math.nan}),
        ("tolerances.settings", {"mass": -0.1}),
        ("tolerances.settings", {"length": "long"}),
        ("balance.settings", {"slot_b8": {"max_lever": math.nan}}),
        ("balance.settings", {"motion_weight": 2.0}),
        ("drives.settings", {"order": "beauty"}),
        ("drives.settings", {"cycle": [1]}),
        ("synthesis.settings", {"objective": "beauty"}),
        ("loads.settings", {"leg": 3}),
        ("loads.settings", {"bar": "b99"}),
        ("stiffness.settings", {"case": "gale"}),
        ("monte_carlo.settings", {"robots": 10**9}),
        ("monte_carlo.settings", {"seed": -1}),
        ("monte_carlo.settings", {"leg": 3}),
        ("monte_carlo.settings", {"length": 10**6}),
        ("stiffness.settings", {"mode": -1}),
        ("pins.settings", {"keys": ["mood"]}),
        ("requirements.largest.settings", {"seconds": 1e6}),
        ("requirements.largest.settings", {"growth": "WEALTH"}),
        ("synthesis.settings", {"ranges": [["geometry.base_radius", [math.nan, 1.0]]]}),
    ],
    ids=str,
)
def test_part_that_is_not_possible_keeps_its_default(part: str, value: Any) -> None:
    data = json.loads(tab_store.dump(CHANGED))
    data["view"][part] = value
    found = tab_store.restore(initial_state(), json.dumps(data))
    assert attrgetter(part)(found) == attrgetter(part)(initial_state())
    others = {name for name in tab_store.VIEW if name != part}
    assert all(attrgetter(name)(found) == attrgetter(name)(CHANGED) for name in others)
    assert found.document == CHANGED.document


def test_unknown_layers_are_dropped_and_old_stores_are_read() -> None:
    data = json.loads(tab_store.dump(CHANGED))
    data["view"]["layers"] += ["a layer of another version"]
    assert tab_store.restore(initial_state(), json.dumps(data)).layers == CHANGED.layers
    del data["view"]["springs.settings"], data["view"]["tolerances.settings"]
    old = tab_store.restore(initial_state(), json.dumps(data))
    assert old.map_view == CHANGED.map_view
    assert old.springs == initial_state().springs
    del data["view"]
    assert tab_store.restore(initial_state(), json.dumps(data)).document == CHANGED.document
    with pytest.raises(PaminsaError):
        tab_store.restore(initial_state(), "{}")


def test_tab_that_a_former_version_kept_is_read() -> None:
    """It was saved with `FORMER` when parts of the state had other names, and springs no layer."""
    kept = Path(__file__).with_name("former_tab.json").read_text("utf-8")
    expected = FORMER.updated("clearance.settings", required=0.01)
    found = tab_store.restore(initial_state(), kept)
    assert found.ended == ("synthesis",)
    assert "springs" not in found.layers
    assert replace(found, ended=(), layers=found.layers | {"springs"}) == expected


def test_running_tasks_are_kept_as_ended_by_a_reload() -> None:
    state = initial_state()
    running = state.updated("synthesis", running=object())
    running = running.updated("requirements.largest", running=object())
    found = tab_store.restore(state, tab_store.dump(running))
    assert set(found.ended) == {"synthesis", "requirements.largest"}
    assert found.synthesis.running is None
    assert tab_store.restore(state, tab_store.dump(state)).ended == ()


class Saver:
    """What the store needs of a session."""

    def __init__(self, state: State) -> None:
        self.state = state
        self.saved: list[str] = []
        self.called: list[tuple[str, str]] = []
        self.linked: object = None
        self.paths: dict[str, str] = {"Masses": "Robot/Masses"}
        self.open_tabs: frozenset[str] | None = None
        self.bridge = SimpleNamespace(
            save=self.saved.append, call=lambda *call: self.called.append(call)
        )
        self.restored = threading.Event()
        self.restored.set()


def test_nothing_is_written_over_what_a_tab_has_kept_before_that_was_taken() -> None:
    session = Saver(initial_state())
    session.restored.clear()
    store = tab_store.TabStore(cast(Any, session))
    store.draw(cast(Any, None), False)
    assert not session.saved
    assert not session.called
    session.restored.set()
    store.draw(cast(Any, None), False)
    assert session.saved == [tab_store.dump(session.state)]


def test_changes_are_saved_while_the_page_is_not_idle_but_not_with_every_frame(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    now = [0.0]
    monkeypatch.setattr(tab_store.time, "monotonic", lambda: now[0])
    session = Saver(initial_state())
    store = tab_store.TabStore(cast(Any, session))
    for step in range(50):
        now[0] = 0.1 * step
        session.state = session.state.updated("document", pose=(0.001 * step, 0.0, 0.0, -0.5))
        store.draw(cast(Any, None), dragging=True)
    assert len(session.saved) == 3  # at 0, 2 and 4 s
    store.draw(cast(Any, None), dragging=False)
    assert session.saved[-1] == tab_store.dump(session.state)
    assert len(session.called) == len(session.saved)
    assert session.called[-1] == ("followLink", links.link_of(cast(Any, session)))


def test_address_follows_back_to_what_is_saved_already() -> None:
    """A link is opened and left again before the page is idle: what is saved has not changed."""
    session = Saver(initial_state())
    store = tab_store.TabStore(cast(Any, session))
    store.draw(cast(Any, None), dragging=False)
    first = session.state
    session.state = first.updated("document", pose=(0.01, 0.0, 0.0, -0.5))
    links.follow_link(cast(Any, session))
    session.state = first
    store.draw(cast(Any, None), dragging=False)
    code = share_code(first.document)
    assert session.called[-1] == ("followLink", f"{code}&map={first.map_view.quantity}")
    assert len(session.saved) == 1


def test_address_of_a_document_too_long_for_a_code_is_empty(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    session = Saver(initial_state())
    monkeypatch.setattr(links.persistence, "LONGEST_CODE", 10)
    links.follow_link(cast(Any, session))
    assert session.called == [("followLink", "")]


def test_link_says_what_is_shown_and_is_written_once() -> None:
    session = Saver(initial_state())
    for _ in range(2):
        links.follow_link(cast(Any, session))
    assert len(session.called) == 1
    session.open_tabs = frozenset({"Robot", "Robot/Masses", "Motion plots"})
    links.follow_link(cast(Any, session))
    shown = session.called[-1][1].split("&")[1:]
    assert shown[:2] == ["section=Robot/Masses", "beside=Motion plots"]


LAYERS_FIRST = {"Robot": frozenset[str](), "Optimize": frozenset({"volume"})}


@pytest.mark.parametrize("workspace", ["", "Robot", "Optimize"])
def test_link_shows_its_workspace_and_map_on_any_page(workspace: str) -> None:
    state = replace(initial_state(), workspace=workspace, layers=frozenset())
    state = state.updated("map_view", quantity="tau_1")
    code = share_code(replace(state.document, pose=(0.01, 0.0, 0.0, -0.5)))
    found = links.opened(state, f"{code}&section=Optimize/Balance&map=stiffness_z", LAYERS_FIRST)
    assert found.document.pose == (0.01, 0.0, 0.0, -0.5)
    assert found.workspace == "Optimize"
    assert ("volume" in found.layers) == (workspace != "Optimize")  # shown when first opened
    assert found.map_view.quantity == "stiffness_z"
    odd = links.opened(state, f"{code}&section=None/None&map=none&more=%ff&&=", LAYERS_FIRST)
    assert (odd.workspace, odd.map_view.quantity) == (workspace, "tau_1")
