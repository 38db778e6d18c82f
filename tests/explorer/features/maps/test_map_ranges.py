"""Color ranges of a state's maps: robust, full and manual ones, and while a mass is dragged."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core.maps import MapStore, select_scales
from paminsa_viz.explorer.state.maps import MapView, RangeMode
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.model import Design, Limit
from paminsa_viz.plots.map_values import COARSE, FULL, MapData
from paminsa_viz.plots.scale import Scale
from tests.support.samples import LOADS, possible_designs

STATE = actions.move(initial_state(), theta=0.7, z=-0.5)
"""Torques of both signs."""


def scales(
    view: MapView, quantities: tuple[str, ...] = ("tau_1", "tau_2"), cells: int = FULL
) -> tuple[MapData, tuple[Scale, ...]]:
    """Return maps and their color ranges."""
    store, state = MapStore(), replace(STATE, map_view=view)
    data = store.data(state, cells, quantities)
    return data, store.scales(state, data, quantities)


def manual(low: float, high: float) -> MapView:
    """Return a view with a manual range."""
    return MapView(range_mode=RangeMode.MANUAL, low=low, high=high)


def test_robust_range_is_the_same_at_both_resolutions() -> None:
    assert scales(MapView(), cells=COARSE)[1] == scales(MapView(), cells=FULL)[1]
    assert {s.kind for s in scales(MapView(logarithmic=True, shared=False))[1]} == {"symlog"}


@pytest.mark.parametrize("ends", [(-3.0, 4.5), (4.5, -3.0)])
def test_manual_range_is_used_in_its_unit_only(ends: tuple[float, float]) -> None:
    assert {(s.low, s.high) for s in scales(manual(*ends))[1]} == {(-3.0, 4.5)}
    _, (force,) = scales(manual(*ends), ("f_4",))
    assert (force.low, force.high) != (-3.0, 4.5)


@pytest.mark.parametrize("ends", [(2.0, 2.0), (0.0, 0.0), (1e300, 2e300), (math.nan, 1.0)])
def test_impossible_manual_range_is_not_used(ends: tuple[float, float]) -> None:
    assert scales(manual(*ends))[1] == scales(MapView())[1]


@pytest.mark.parametrize("shared", [True, False])
def test_full_range_contains_every_value(shared: bool) -> None:
    data, found = scales(MapView(range_mode=RangeMode.FULL, shared=shared))
    for values, scale in zip(data.values, found, strict=True):
        assert -scale.low == scale.high >= np.nanmax(np.abs(values))
    assert (found[0] == found[1]) == shared


def test_full_range_of_a_force_is_tight() -> None:
    data, (scale,) = scales(MapView(range_mode=RangeMode.FULL), ("f_4",))
    low, high = np.nanmin(data.values), np.nanmax(data.values)
    assert scale.low <= low < high <= scale.high < scale.low + 1.2 * (high - low)


@pytest.mark.parametrize("mode", RangeMode)
def test_map_with_nothing_in_reach_has_a_scale(mode: RangeMode) -> None:
    data = MapStore().data(actions.move(STATE, z=-5.0), COARSE)
    assert np.isnan(data.values).all()
    assert len(select_scales(data, data, MapView(range_mode=mode))) == 3


@given(design=possible_designs(LOADS), mode=st.sampled_from(RangeMode), logarithmic=st.booleans())
def test_any_possible_masses_have_maps_and_colors(
    design: Design, mode: RangeMode, logarithmic: bool
) -> None:
    view = MapView(range_mode=mode, logarithmic=logarithmic)
    state = initial_state(design).updated("map_view", range_mode=mode)
    for quantities in (("tau_1", "tau_2", "tau_3"), ("f_4",)):
        data = MapStore().data(state, COARSE, quantities)
        assert np.isfinite(data.values[:, data.status == Limit.OK]).all()
        assert len(select_scales(data, data, view)) == len(quantities)


def test_maps_fade_while_a_mass_is_dragged_and_next_to_a_reference() -> None:
    store, start = MapStore(), actions.move(initial_state(), theta=0.5)
    balanced = actions.vary(start, {"joints.j7": 3.0})

    def found(state: State, *, dragging: bool) -> tuple[Scale, ...]:
        return store.scales(state, store.data(state, COARSE), dragging=dragging)

    wide = found(start, dragging=False)
    assert found(balanced, dragging=True) == wide
    narrow = found(balanced, dragging=False)
    assert narrow[0].high < 0.2 * wide[0].high
    pinned = actions.vary(actions.pin_reference(start), {"joints.j7": 3.0})
    assert found(pinned, dragging=False) == wide
    assert found(actions.swap_reference(pinned), dragging=False) == wide
    delta = pinned.updated("map_view", difference=True)
    assert store.scales(delta, store.data(delta, COARSE))[0].high > 0
    # Another view is another range, also in the middle of a drag.
    logarithmic = balanced.updated("map_view", logarithmic=True)
    assert found(logarithmic, dragging=True)[0].kind == "symlog"


def test_a_range_that_is_held_may_be_dropped_by_an_export_as_it_is_looked_up() -> None:
    store = MapStore()
    data = store.data(STATE, COARSE)
    wide = store.scales(STATE, data)

    class Dropped(dict[Any, Any]):
        def __contains__(self, key: object) -> bool:
            store._held = {}
            return super().__contains__(key)

        def get(self, key: Any, default: Any = None) -> Any:
            store._held = {}
            return super().get(key, default)

    store._held = Dropped(store._held)
    assert store.scales(STATE, data, dragging=True) is wide
