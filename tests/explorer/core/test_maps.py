"""Maps of a state: values, extent, differences, color ranges, and what is solved again."""

from __future__ import annotations

import math
import weakref
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from paminsa_viz.explorer.core import actions, causes, maps
from paminsa_viz.explorer.core.maps import DRAG_BUDGET, KEPT, MapStore, go_to
from paminsa_viz.explorer.features.requirements.actions import suggest
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.model import (
    APPENDIX_4,
    KneeBranch,
    check_reach,
    static_torques,
)
from paminsa_viz.plots import map_values
from paminsa_viz.plots.map_values import COARSE, FULL, MapData, cell_centers, frame_half, half_width
from paminsa_viz.quantities import MAP_BUDGET, QUANTITIES
from tests.support.measured import pointwise

CELLS = 31


def at(**pose: float) -> State:
    """Return the state at a pose of maps with torques of both signs, or at another one."""
    return actions.move(initial_state(), **({"theta": 0.7, "z": -0.5} | pose))


def compared(**changes: float) -> State:
    """Return a state that shows the difference of a changed design from Appendix 4's."""
    state = actions.vary(actions.pin_reference(at()), dict(changes))
    return state.updated("map_view", difference=True)


def poses_of(data: MapData) -> np.ndarray:
    """Return the poses at the middles of the cells, (rows, columns, 4)."""
    x, y = np.meshgrid(data.x, data.y)
    return np.stack([x, y, np.full_like(x, data.theta), np.full_like(x, data.z)], axis=-1)


@pytest.fixture
def solved(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Count the cells of every field that is solved."""
    calls: list[int] = []
    real = map_values.solve_field

    def counted(*args: Any, **kwargs: Any) -> Any:
        calls.append(args[1].size)
        return real(*args, **kwargs)

    monkeypatch.setattr(map_values, "solve_field", counted)
    return calls


@pytest.mark.parametrize("knee", KneeBranch)
def test_cells_hold_the_models_torques_or_why_they_are_out_of_reach(knee: KneeBranch) -> None:
    state = actions.set_knee(at(), knee)
    data = MapStore().data(state, CELLS)
    geometry = state.document.design.geometry
    reach = check_reach(geometry, poses_of(data))
    np.testing.assert_array_equal(data.status, reach.status)
    assert data.leg is not None
    np.testing.assert_array_equal(data.leg, reach.leg)
    expected = np.moveaxis(static_torques(state.document.design, poses_of(data)), -1, 0)[:3]
    expected = np.where(reach.ok, expected, np.nan)
    np.testing.assert_allclose(data.values, expected, rtol=1e-12, atol=1e-12)
    assert 100 < reach.ok.sum() < reach.ok.size - 100


@pytest.mark.slow
def test_each_quantity_is_the_models() -> None:
    state, store = at(), MapStore()
    known = cache(pointwise)
    finite = 0
    for name, quantity in QUANTITIES.items():
        data = store.data(state, 15, (name,))
        row, column = int(0.4 * data.y.size), int(0.57 * data.x.size)
        pose = poses_of(data)[row, column]
        expected = known(state.document.design, tuple(pose.tolist()))[name]
        # NaN for bodies that the robot does not have, in both
        found = data.values[0, row, column]
        assert found == pytest.approx(float(expected), rel=1e-10, nan_ok=True), name
        assert data.unit == quantity.unit
        finite += np.isfinite(found)
    assert finite > 0.9 * len(QUANTITIES)


Change = Callable[[State], State]


@pytest.mark.parametrize(
    ("change", "solutions"),
    [
        (lambda s: actions.vary(s, {"links.b3": 1.2, "payload.mass": 3.0}), 1),
        (lambda s: actions.move(s, x=0.05, y=-0.02), 1),
        (lambda s: s.updated("map_view", shared=False), 1),
        (lambda s: actions.move(s, theta=0.71), 2),
        (lambda s: actions.move(s, z=-0.51), 2),
        (lambda s: actions.vary(s, {"geometry.crank_length": 0.43}), 2),
    ],
    ids=["masses", "position", "colors", "theta", "z", "lengths"],
)
def test_field_is_solved_again_for_theta_z_and_lengths_only(
    solved: list[int], change: Change, solutions: int
) -> None:
    store, state = MapStore(), at()
    before, after = store.data(state, CELLS), store.data(change(state), CELLS)
    assert solved == [CELLS**2] * solutions
    np.testing.assert_array_equal(after.pose, change(state).document.pose)
    masses = change(state).document.design.links != APPENDIX_4.links
    ok = (before.status == 0) & (np.abs(before.values[0]) > 1e-6)
    if solutions == 1:
        ratio = after.values[0][ok] / before.values[0][ok]
        np.testing.assert_allclose(ratio, ratio[0], rtol=1e-9)
        assert (abs(ratio[0] - 1) > 0.1) == masses


def test_cells_that_break_a_requirement_are_found_once_and_for_what_hatches_them_only(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found: list[int] = []
    real = causes.outside_of

    def counted(field: Any, *args: Any) -> Any:
        found.append(field.status.size)
        return real(field, *args)

    monkeypatch.setattr(causes, "outside_of", counted)
    state, store = suggest(actions.pin_reference(at())), MapStore()
    plain = store.data(state, FULL)
    store.scales(state, plain)
    store.current(state, FULL, ("reach_margin",))
    assert plain.outside is None
    assert found == []
    for quantities in (("tau_1",), ("condition",), ("tau_1", "tau_2")):
        assert store.data(state, FULL, quantities, hatched=True).outside is not None
    assert found == [FULL**2]
    store.data(actions.vary(state, {"links.b3": 1.2}), FULL, hatched=True)
    assert found == [FULL**2] * 2


def test_store_keeps_the_latest_fields_for_every_quantity(solved: list[int]) -> None:
    store, state = MapStore(), at()
    first, *others, last = (actions.move(state, theta=0.1 * i) for i in range(KEPT + 1))
    for moved in (first, *others, last):
        store.data(moved, CELLS)
    for quantity in ("condition", "determinant"):
        store.data(last, CELLS, (quantity,))
    assert len(solved) == KEPT + 1
    store.data(first, CELLS)
    assert len(solved) == KEPT + 2


def test_large_fields_at_another_theta_are_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[weakref.ref[Any]] = []
    real = maps.workspace_field

    def followed(*asked: Any) -> Any:
        field = real(*asked)
        made.append(weakref.ref(field))
        return field

    def held() -> int:
        """Return how much the fields take that have not been given up [bytes]."""
        return sum(field.nbytes for one in made if (field := one()) is not None)

    monkeypatch.setattr(maps, "workspace_field", followed)
    store, state = MapStore(), suggest(at())
    store.data(state, CELLS, ("stiffness_x",), hatched=True)
    least = held()
    assert least > 300 * CELLS**2
    monkeypatch.setattr(maps, "MOST_BYTES", 2 * least)
    for theta in (0.1, 0.2, 0.3):
        store.data(actions.move(state, theta=theta), CELLS, ("stiffness_x",), hatched=True)
    assert len(made) == 4
    assert least < held() <= maps.MOST_BYTES
    monkeypatch.setattr(maps, "MOST_BYTES", 0)
    for cells in (CELLS - 1, CELLS):  # both are at the last theta
        store.data(actions.move(state, theta=0.4), cells, ("stiffness_x",))
    assert [one() is not None for one in made] == [False] * 4 + [True] * 2


def test_dragging_a_mass_solves_nothing_with_a_reference_at_both_resolutions(
    solved: list[int],
) -> None:
    store, state = MapStore(), compared(**{"geometry.crank_length": 0.41})
    for mass in (0.5, 0.6, 0.7):
        for cells in (COARSE, FULL):
            store.data(actions.vary(state, {"links.b4": mass}), cells)
        assert len(solved) == 4


@pytest.mark.parametrize("path", ["links.b8", "geometry.coupler_length"])
def test_difference_is_that_of_both_designs_where_both_reach(path: str) -> None:
    store, state = MapStore(), compared(**{path: APPENDIX_4.value(path) * 0.95})
    delta = store.data(state, CELLS)
    designs = state.document.design, APPENDIX_4
    reachable = [check_reach(d.geometry, poses_of(delta)).ok for d in designs]
    ok = delta.status == 0
    np.testing.assert_array_equal(ok, reachable[0] & reachable[1])
    now, reference = (static_torques(design, poses_of(delta))[ok] for design in designs)
    found = np.moveaxis(delta.values, 0, -1)[ok]
    np.testing.assert_allclose(found, (now - reference)[:, :3], atol=1e-9)
    assert np.abs(found).max() > 0.1
    assert delta.reference == APPENDIX_4
    plain = state.updated("map_view", difference=False)
    np.testing.assert_array_equal(
        store.current(state, CELLS).values, store.data(plain, CELLS).values
    )


def test_without_a_reference_values_are_shown() -> None:
    store, state = MapStore(), at()
    found = store.data(state.updated("map_view", difference=True), CELLS)
    np.testing.assert_array_equal(found.values, store.data(state, CELLS).values)


@settings(max_examples=60, deadline=None)
@given(
    theta=st.floats(-math.pi, math.pi),
    z=st.floats(-1.0, 1.0),
    crank=st.floats(0.3, 0.6),
    base=st.floats(0.15, 0.5),
)
def test_nothing_within_reach_is_outside_the_map(
    theta: float, z: float, crank: float, base: float
) -> None:
    geometry = replace(APPENDIX_4.geometry, crank_length=crank, base_radius=base)
    angle = np.linspace(0, 2 * np.pi, 61)
    edge = half_width(geometry) * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    outside = np.concatenate([edge * factor for factor in (1.0, 1.01, 1.2, 2.0)])
    poses = np.column_stack([outside, np.tile([theta, z], (len(outside), 1))])
    assert not check_reach(geometry, poses).ok.any()


@given(
    theta=st.floats(-np.pi, np.pi),
    z=st.floats(-1.0, 0.2),
    crank=st.floats(0.3, 0.6),
    platform=st.floats(0.05, 0.3),
)
def test_frame_holds_the_reach_at_its_angle_and_height(
    theta: float, z: float, crank: float, platform: float
) -> None:
    geometry = replace(APPENDIX_4.geometry, crank_length=crank, platform_radius=platform)
    half = frame_half(geometry, theta, z)
    assert half <= half_width(geometry)
    side = np.linspace(-1.0, 1.0, 101)
    edge = np.concatenate([np.stack([side, np.full_like(side, s)], axis=1) for s in (-1.0, 1.0)])
    edge = half * np.concatenate([edge, edge[:, ::-1]])
    poses = np.column_stack([edge, np.tile([theta, z], (len(edge), 1))])
    assert not check_reach(geometry, poses).ok.any()


def test_extent_follows_the_lengths_and_holds_little_else_than_the_workspace() -> None:
    store, state = MapStore(), at()
    heavier = actions.vary(actions.move(state, theta=-2.0, z=-0.9, x=0.1), {"links.b3": 2.0})
    for each in (state, heavier):
        half = frame_half(APPENDIX_4.geometry, *each.document.pose[2:])
        coarse, fine = (store.data(each, cells).extent for cells in (COARSE, FULL))
        assert coarse == pytest.approx((-half, half, -half, half))
        assert coarse == fine  # to the last bit: both are drawn on the same axes
    for theta, z in ((0.0, -0.0275), (np.pi / 3, -0.55)):
        data = store.data(actions.move(initial_state(), theta=theta, z=z), FULL)
        farthest = np.abs(np.meshgrid(data.x, data.y))[:, data.status == 0].max()
        assert farthest > 0.85 * data.extent[1]
    assert data.extent[1] < 0.8 * half_width(APPENDIX_4.geometry)
    centers = cell_centers(0.3, 7)
    np.testing.assert_allclose(np.diff(centers), 0.6 / 7)
    np.testing.assert_allclose(centers, -centers[::-1], atol=1e-16)


@given(
    x=st.floats(allow_nan=False, allow_infinity=False),
    y=st.floats(allow_nan=False, allow_infinity=False),
)
def test_robot_is_sent_to_places_on_the_map_only(x: float, y: float) -> None:
    pose = go_to(at(), x, y).document.pose
    assert max(map(abs, pose[:2])) <= half_width(APPENDIX_4.geometry)
    assert pose[2:] == at().document.pose[2:]


def test_robot_is_sent_to_a_tenth_of_a_millimeter() -> None:
    state = go_to(at(), 0.0512349, -0.03)
    assert state.last_reachable.pose[:2] == state.document.pose[:2] == (0.0512, -0.03)


@pytest.mark.slow
def test_costly_maps_are_coarser_while_dragging() -> None:
    """Torques have all cells; the first frequency as many as its time allows."""
    state = at()
    store = MapStore()
    sizes = {
        (key, cells): store.data(state, cells, (key,)).x.size
        for key in ("tau_1", "frequency_1")
        for cells in (COARSE, FULL)
    }
    assert sizes["tau_1", COARSE] == COARSE
    assert sizes["tau_1", FULL] == FULL
    cost = QUANTITIES["frequency_1"].cost
    assert sizes["frequency_1", COARSE] ** 2 * cost <= DRAG_BUDGET
    assert sizes["frequency_1", FULL] ** 2 * cost <= MAP_BUDGET
    assert 10 < sizes["frequency_1", COARSE] < sizes["frequency_1", FULL] < COARSE
