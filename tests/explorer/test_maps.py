"""Maps of a state: numbers equal the model's, and no more is solved than what changed."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from paminsa_viz.explorer import actions, maps
from paminsa_viz.explorer.maps import (
    COARSE,
    FULL,
    MapStore,
    cell_centres,
    choose,
    go_to,
    half_width,
)
from paminsa_viz.explorer.state import MapView, RangeMode, State, initial_state
from paminsa_viz.figures.maps import MapData
from paminsa_viz.model import (
    APPENDIX_4,
    Assembly,
    Limit,
    Quantity,
    check_reach,
    measure_singularity,
    static_torques,
)

CELLS = 31


@pytest.fixture
def solved(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Count the cells of every field that is solved."""
    calls: list[int] = []
    real = maps.solve_field

    def counted(*args, **kwargs):  # type: ignore[no-untyped-def]
        calls.append(args[1].size)
        return real(*args, **kwargs)

    monkeypatch.setattr(maps, "solve_field", counted)
    return calls


def at(**pose: float) -> State:
    return actions.move(initial_state(), **({"theta": 0.7, "z": -0.5} | pose))


def poses_of(data: MapData) -> np.ndarray:
    x, y = np.meshgrid(data.x, data.y)
    return np.stack([x, y, np.full_like(x, data.theta), np.full_like(x, data.z)], axis=-1)


class TestNumbers:
    @pytest.mark.parametrize("assembly", list(Assembly))
    def test_torques_are_the_model_s(self, assembly: Assembly) -> None:
        state = actions.assemble(at(), assembly)
        data = MapStore().data(state, CELLS)
        poses = poses_of(data)
        expected = static_torques(state.document.design, poses, assembly)
        ok = data.status == Limit.OK
        assert 100 < ok.sum() < ok.size - 100
        for panel in range(3):
            np.testing.assert_allclose(
                data.values[panel][ok], expected[..., panel][ok], rtol=1e-12, atol=1e-12
            )

    @pytest.mark.parametrize("quantity", list(Quantity))
    def test_each_quantity_at_the_present_pose(self, quantity: Quantity) -> None:
        """The cell under a pose holds what the model says at that cell's centre."""
        store = MapStore()
        state = at()
        data = store.data(state, CELLS, (quantity,))
        row, column = 12, 17
        pose = poses_of(data)[row, column]
        design = state.document.design
        tau = static_torques(design, pose)
        dexterity = measure_singularity(design.geometry, pose)
        expected = {
            Quantity.TAU_1: tau[0],
            Quantity.TAU_2: tau[1],
            Quantity.TAU_3: tau[2],
            Quantity.F_4: tau[3],
            Quantity.MAX_TORQUE: np.abs(tau[:3]).max(),
            Quantity.RMS_TORQUE: np.sqrt((tau[:3] ** 2).mean()),
            Quantity.CONDITION: dexterity.condition,
            Quantity.DETERMINANT: dexterity.determinant,
            Quantity.REACH_MARGIN: check_reach(design.geometry, pose).margins.min(),
        }[quantity]
        assert data.values[0, row, column] == pytest.approx(float(expected), rel=1e-10)
        assert data.unit == quantity.unit

    def test_cells_out_of_reach_are_masked_with_their_reason(self) -> None:
        data = MapStore().data(at(), CELLS)
        reach = check_reach(APPENDIX_4.geometry, poses_of(data))
        np.testing.assert_array_equal(data.status, reach.status)
        assert data.leg is not None
        np.testing.assert_array_equal(data.leg, reach.leg)
        np.testing.assert_array_equal(
            np.isnan(data.values), np.broadcast_to(reach.status != 0, data.values.shape)
        )


class TestWhatIsSolved:
    def test_a_mass_only_rescales(self, solved: list[int]) -> None:
        store, state = MapStore(), at()
        before = store.data(state, CELLS)
        heavier = actions.vary(state, {"links.b3": 1.2, "payload.mass": 3.0})
        after = store.data(heavier, CELLS)
        assert solved == [CELLS**2]
        ok = (before.status == 0) & (np.abs(before.values[0]) > 1e-6)
        ratio = after.values[0][ok] / before.values[0][ok]
        np.testing.assert_allclose(ratio, ratio[0], rtol=1e-9)
        assert abs(ratio[0] - 1) > 0.1

    def test_a_position_or_a_colour_solves_nothing(self, solved: list[int]) -> None:
        store, state = MapStore(), at()
        store.data(state, CELLS)
        moved = store.data(actions.move(state, x=0.05, y=-0.02), CELLS)
        store.data(actions.set_map_view(state, shared=False), CELLS)
        assert solved == [CELLS**2]
        assert tuple(moved.pose[:2]) == (0.05, -0.02)

    @pytest.mark.parametrize("change", [{"theta": 0.71}, {"z": -0.51}])
    def test_theta_and_z_solve_again(self, solved: list[int], change: dict[str, float]) -> None:
        store, state = MapStore(), at()
        store.data(state, CELLS)
        store.data(actions.move(state, **change), CELLS)
        assert len(solved) == 2

    def test_dexterity_is_solved_when_it_is_asked_for_and_serves_torques(
        self, solved: list[int]
    ) -> None:
        store, state = MapStore(), at()
        store.data(state, CELLS)
        store.data(state, CELLS, (Quantity.CONDITION,))
        store.data(state, CELLS, (Quantity.DETERMINANT,))
        store.data(state, CELLS)
        assert len(solved) == 2

    def test_only_so_many_fields_are_kept(self, solved: list[int]) -> None:
        store, state = MapStore(kept=3), at()
        for theta in (0.1, 0.2, 0.3, 0.4):
            store.data(actions.move(state, theta=theta), CELLS)
        assert len(store._fields) == 3
        store.data(actions.move(state, theta=0.4), CELLS)
        assert len(solved) == 4
        store.data(actions.move(state, theta=0.1), CELLS)
        assert len(solved) == 5

    def test_a_drag_over_the_default_store_keeps_what_a_mass_needs(self, solved: list[int]) -> None:
        """Coarse and full of design and reference stay while masses move."""
        state = actions.pin_reference(at())
        state = actions.set_map_view(state, difference=True)
        state = actions.vary(state, {"geometry.crank_length": 0.41})
        store = MapStore()
        for cells in (COARSE, FULL):
            store.data(state, cells)
        count = len(solved)
        for mass in (0.5, 0.6, 0.7):
            for cells in (COARSE, FULL):
                store.data(actions.vary(state, {"links.b4": mass}), cells)
        assert len(solved) == count == 4


class TestDifference:
    def test_other_masses(self) -> None:
        store = MapStore()
        state = actions.vary(actions.pin_reference(at()), {"links.b8": 0.9})
        shown = actions.set_map_view(state, difference=True)
        delta = store.data(shown, CELLS)
        now, reference = (
            static_torques(design, poses_of(delta))
            for design in (state.document.design, APPENDIX_4)
        )
        ok = delta.status == 0
        expected = now[..., 1][ok] - reference[..., 1][ok]
        np.testing.assert_allclose(delta.values[1][ok], expected, atol=1e-9)
        assert np.abs(expected).max() > 0.1
        assert delta.provenance.reference == APPENDIX_4.name

    def test_another_geometry_is_solved_with_its_own_lengths(self) -> None:
        store = MapStore()
        state = actions.vary(actions.pin_reference(at()), {"geometry.coupler_length": 0.6})
        delta = store.data(actions.set_map_view(state, difference=True), CELLS)
        poses = poses_of(delta)
        reachable = [
            check_reach(geometry, poses).ok
            for geometry in (state.document.design.geometry, APPENDIX_4.geometry)
        ]
        np.testing.assert_array_equal(delta.status == 0, reachable[0] & reachable[1])
        ok = delta.status == 0
        expected = static_torques(state.document.design, poses) - static_torques(APPENDIX_4, poses)
        np.testing.assert_allclose(delta.values[0][ok], expected[..., 0][ok], atol=1e-9)

    def test_without_a_reference_values_are_shown(self) -> None:
        store, state = MapStore(), at()
        asked = replace(state, map_view=replace(state.map_view, difference=True))
        np.testing.assert_array_equal(
            store.data(asked, CELLS).values, store.data(state, CELLS).values
        )

    def test_the_present_design_can_be_had_in_any_case(self) -> None:
        store = MapStore()
        state = actions.set_map_view(actions.pin_reference(at()), difference=True)
        assert np.nanmax(np.abs(store.data(state, CELLS).values)) == 0
        assert np.nanmax(np.abs(store.present(state, CELLS).values)) > 1


class TestExtent:
    @settings(max_examples=60, deadline=None)
    @given(
        theta=st.floats(-math.pi, math.pi),
        z=st.floats(-1.0, 1.0),
        crank=st.floats(0.3, 0.6),
        base=st.floats(0.15, 0.5),
    )
    def test_nothing_within_reach_lies_outside(
        self, theta: float, z: float, crank: float, base: float
    ) -> None:
        geometry = replace(APPENDIX_4.geometry, crank_length=crank, base_radius=base)
        half = half_width(geometry)
        angle = np.linspace(0, 2 * np.pi, 61)
        edge = half * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        outside = np.concatenate([edge * factor for factor in (1.0, 1.01, 1.2, 2.0)])
        poses = np.column_stack([outside, np.tile([theta, z], (len(outside), 1))])
        assert not check_reach(geometry, poses).ok.any()

    def test_it_stays_while_pose_and_masses_change(self) -> None:
        store, state = MapStore(), at()
        extents = {
            store.data(s, cells).extent
            for s in (
                state,
                actions.move(state, theta=-2.0, z=-0.9, x=0.1),
                actions.vary(state, {"links.b3": 2.0}),
            )
            for cells in (COARSE, FULL)
        }
        half = half_width(APPENDIX_4.geometry)
        np.testing.assert_allclose(list(extents), [(-half, half, -half, half)] * len(extents))

    def test_it_is_not_much_larger_than_the_workspace(self) -> None:
        state = actions.move(initial_state(), theta=0.0, z=-0.0275)
        data = MapStore().data(state, FULL)
        radius = np.hypot(*np.meshgrid(data.x, data.y))[data.status == 0].max()
        assert radius > 0.9 * half_width(APPENDIX_4.geometry)

    def test_cells_are_equal_and_symmetric(self) -> None:
        centres = cell_centres(0.3, 7)
        np.testing.assert_allclose(np.diff(centres), 0.6 / 7)
        np.testing.assert_allclose(centres, -centres[::-1], atol=1e-16)


class TestColours:
    def scales(self, view: MapView, quantities=(Quantity.TAU_1, Quantity.TAU_2)):  # type: ignore[no-untyped-def]
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
        _, forces = self.scales(view, (Quantity.F_4,))
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
        data, (scale,) = self.scales(MapView(range_mode=RangeMode.FULL), (Quantity.F_4,))
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


class TestGoTo:
    @given(
        x=st.floats(allow_nan=False, allow_infinity=False),
        y=st.floats(allow_nan=False, allow_infinity=False),
    )
    def test_it_stays_on_the_map(self, x: float, y: float) -> None:
        half = half_width(APPENDIX_4.geometry)
        state = go_to(at(), x, y)
        assert max(map(abs, state.document.pose[:2])) <= half
        assert state.document.pose[2:] == at().document.pose[2:]

    def test_a_reachable_place_is_taken(self) -> None:
        state = go_to(at(), 0.0512349, -0.03)
        assert state.document.pose[:2] == (0.0512, -0.03)
        assert state.standing.pose == state.document.pose
