"""What a tab keeps across a reload, and what of a damaged one."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from operator import attrgetter
from typing import Any

import pytest

from paminsa_viz.errors import PaminsaError
from paminsa_viz.explorer import actions, tab_store
from paminsa_viz.explorer.balancing.springs import SpringsFrom
from paminsa_viz.explorer.state import MapView, RangeMode, initial_state

CHANGED = replace(
    actions.set_layers(actions.move(initial_state(), x=0.02), path=False, mesh=False),
    map_view=MapView("condition", RangeMode.MANUAL, 1.0, 7.5, shared=False, logarithmic=True),
    floor_opacity=0.4,
    condition_limit=12.0,
    table_at_rest=True,
).updated("plots", plot="power", published=True, color=2)
CHANGED = CHANGED.updated(
    "springing.settings", start=SpringsFrom.GUIDE, height=0.2, least=0.1, most=0.3
).updated("tolerating.settings", mass=0.05, length=0.002)


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
        ("floor_opacity", 3.0),
        ("floor_opacity", "much"),
        ("condition_limit", 0.5),
        ("layers", [1, 2]),
        ("table_at_rest", None),
        ("springing.settings", {"height": 2.0}),
        ("springing.settings", {"start": "nowhere"}),
        ("springing.settings", {"least": math.nan}),
        ("tolerating.settings", {"mass": -0.1}),
        ("tolerating.settings", {"length": "long"}),
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
    del data["view"]["springing.settings"], data["view"]["tolerating.settings"]
    old = tab_store.restore(initial_state(), json.dumps(data))
    assert old.map_view == CHANGED.map_view
    assert old.springing == initial_state().springing
    del data["view"]
    assert tab_store.restore(initial_state(), json.dumps(data)).document == CHANGED.document
    with pytest.raises(PaminsaError):
        tab_store.restore(initial_state(), "{}")
