"""Maps of a state: numbers equal the model's, and no more is solved than what changed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from paminsa_viz.explorer import actions
from paminsa_viz.explorer.maps import COARSE, FULL, MapStore
from paminsa_viz.model import (
    APPENDIX_4,
    KneeBranch,
    Limit,
    check_reach,
    measure_singularity,
    static_torques,
)
from paminsa_viz.plots import map_data
from paminsa_viz.quantities import QUANTITIES
from tests.support.map_states import CELLS, at, poses_of
from tests.support.samples import with_knee


@pytest.fixture
def solved(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Count the cells of every field that is solved."""
    calls: list[int] = []
    real = map_data.solve_field

    def counted(*args, **kwargs):  # type: ignore[no-untyped-def]
        calls.append(args[1].size)
        return real(*args, **kwargs)

    monkeypatch.setattr(map_data, "solve_field", counted)
    return calls


class TestNumbers:
    @pytest.mark.parametrize("knee", list(KneeBranch))
    def test_torques_are_the_model_s(self, knee: KneeBranch) -> None:
        state = actions.set_knee(at(), knee)
        data = MapStore().data(state, CELLS)
        poses = poses_of(data)
        expected = static_torques(with_knee(state.document.design, knee), poses)
        ok = data.status == Limit.OK
        assert 100 < ok.sum() < ok.size - 100
        for panel in range(3):
            np.testing.assert_allclose(
                data.values[panel][ok], expected[..., panel][ok], rtol=1e-12, atol=1e-12
            )

    @pytest.mark.parametrize("quantity", list(QUANTITIES))
    def test_each_quantity_at_the_present_pose(self, quantity: str) -> None:
        """The cell under a pose holds what the model says at that cell's center."""
        store = MapStore()
        state = at()
        data = store.data(state, CELLS, (quantity,))
        row, column = 12, 17
        pose = poses_of(data)[row, column]
        design = state.document.design
        tau = static_torques(design, pose)
        dexterity = measure_singularity(design.geometry, pose)
        expected = {
            "tau_1": tau[0],
            "tau_2": tau[1],
            "tau_3": tau[2],
            "f_4": tau[3],
            "max_torque": np.abs(tau[:3]).max(),
            "rms_torque": np.sqrt((tau[:3] ** 2).mean()),
            "condition": dexterity.condition,
            "determinant": dexterity.determinant,
            "reach_margin": check_reach(design.geometry, pose).margins.min(),
        }[quantity]
        assert data.values[0, row, column] == pytest.approx(float(expected), rel=1e-10)
        assert data.unit == QUANTITIES[quantity].unit

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

    def test_a_position_or_a_color_solves_nothing(self, solved: list[int]) -> None:
        store, state = MapStore(), at()
        store.data(state, CELLS)
        moved = store.data(actions.move(state, x=0.05, y=-0.02), CELLS)
        store.data(state.updated("map_view", shared=False), CELLS)
        assert solved == [CELLS**2]
        assert tuple(moved.pose[:2]) == (0.05, -0.02)

    @pytest.mark.parametrize("change", [{"theta": 0.71}, {"z": -0.51}])
    def test_theta_and_z_solve_again(self, solved: list[int], change: dict[str, float]) -> None:
        store, state = MapStore(), at()
        store.data(state, CELLS)
        store.data(actions.move(state, **change), CELLS)
        assert len(solved) == 2

    def test_another_formula_is_solved_on_the_field_that_is_kept(self, solved: list[int]) -> None:
        store, state = MapStore(), at()
        store.data(state, CELLS)
        store.data(state, CELLS, ("condition",))
        store.data(state, CELLS, ("determinant",))
        store.data(state, CELLS)
        assert len(solved) == 1

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
        state = state.updated("map_view", difference=True)
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
        shown = state.updated("map_view", difference=True)
        delta = store.data(shown, CELLS)
        now, reference = (
            static_torques(design, poses_of(delta))
            for design in (state.document.design, APPENDIX_4)
        )
        ok = delta.status == 0
        expected = now[..., 1][ok] - reference[..., 1][ok]
        np.testing.assert_allclose(delta.values[1][ok], expected, atol=1e-9)
        assert np.abs(expected).max() > 0.1
        assert delta.reference == APPENDIX_4

    def test_another_geometry_is_solved_with_its_own_lengths(self) -> None:
        store = MapStore()
        state = actions.vary(actions.pin_reference(at()), {"geometry.coupler_length": 0.6})
        delta = store.data(state.updated("map_view", difference=True), CELLS)
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
        state = actions.pin_reference(at()).updated("map_view", difference=True)
        assert np.nanmax(np.abs(store.data(state, CELLS).values)) == 0
        assert np.nanmax(np.abs(store.present(state, CELLS).values)) > 1
