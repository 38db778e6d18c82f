"""The maps' color ranges."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from paminsa_viz.explorer.maps import COARSE, FULL, MapStore, choose
from paminsa_viz.explorer.state import MapView, RangeMode
from tests.support.map_states import CELLS, at


class TestColors:
    def scales(self, view: MapView, quantities=("tau_1", "tau_2")):  # type: ignore[no-untyped-def]
        store = MapStore()
        state = replace(at(), map_view=view)
        data = store.data(state, FULL, quantities)
        return data, store.scales(state, data, quantities)

    def test_the_robust_range_is_the_same_coarse_and_full(self) -> None:
        store, state = MapStore(), at(theta=1.0)
        scales = [store.scales(state, store.data(state, cells)) for cells in (COARSE, FULL)]
        assert scales[0] == scales[1]

    def test_a_manual_range_holds_in_its_unit_only(self) -> None:
        view = MapView(range_mode=RangeMode.MANUAL, low=-3.0, high=4.5)
        _, scales = self.scales(view)
        assert {(s.low, s.high) for s in scales} == {(-3.0, 4.5)}
        _, forces = self.scales(view, ("f_4",))
        assert (forces[0].low, forces[0].high) != (-3.0, 4.5)

    @pytest.mark.parametrize("ends", [(2.0, 2.0), (0.0, 0.0), (1e300, 2e300), (math.nan, 1.0)])
    def test_an_impossible_manual_range_is_not_used(self, ends: tuple[float, float]) -> None:
        _, robust = self.scales(MapView())
        _, scales = self.scales(MapView(range_mode=RangeMode.MANUAL, low=ends[0], high=ends[1]))
        assert scales == robust

    def test_a_manual_range_may_be_given_backwards(self) -> None:
        _, scales = self.scales(MapView(range_mode=RangeMode.MANUAL, low=5.0, high=-2.0))
        assert (scales[0].low, scales[0].high) == (-2.0, 5.0)

    @pytest.mark.parametrize("shared", [True, False])
    def test_the_full_range_holds_every_value(self, shared: bool) -> None:
        data, scales = self.scales(MapView(range_mode=RangeMode.FULL, shared=shared))
        for values, scale in zip(data.values, scales, strict=True):
            assert scale.low <= np.nanmin(values)
            assert np.nanmax(values) <= scale.high
            assert scale.low == -scale.high
        if shared:
            assert scales[0] == scales[1]

    def test_the_full_range_of_a_magnitude_is_tight(self) -> None:
        data, (scale,) = self.scales(MapView(range_mode=RangeMode.FULL), ("f_4",))
        low, high = np.nanmin(data.values), np.nanmax(data.values)
        assert scale.low <= low
        assert high <= scale.high
        assert scale.high - scale.low < 1.2 * (high - low)

    def test_log_and_own_ranges(self) -> None:
        _, scales = self.scales(MapView(logarithmic=True, shared=False))
        assert {s.kind for s in scales} == {"symlog"}

    def test_nothing_in_reach_still_has_a_scale(self) -> None:
        store = MapStore()
        state = at(z=-5.0)
        for mode in RangeMode:
            view = MapView(range_mode=mode)
            data = store.data(state, CELLS)
            assert np.isnan(data.values).all()
            assert len(choose(data, data, view)) == 3
