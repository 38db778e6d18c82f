"""Maps: the values of the pointwise functions at every pose, whatever the axes and the blocks."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict
from functools import cache
from itertools import permutations
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.model import (
    APPENDIX_4,
    Design,
    Field,
    Grid,
    InvalidInput,
    KneeBranch,
    Limit,
    backend,
    check_reach,
    grids,
    measure_singularity,
    rotary_torques,
    solve_field,
    static_torques,
    unit_torques,
    xy_grid,
)
from paminsa_viz.model.singularity import DEXTERITY
from paminsa_viz.model.statics import UNIT_TORQUES
from paminsa_viz.quantities import QUANTITIES, find
from tests.support.cases import BOTH, Case, cases
from tests.support.measured import pointwise
from tests.support.samples import with_knee

VALUES = {
    "x": np.linspace(-0.25, 0.3, 4),
    "y": np.linspace(-0.3, 0.22, 3),
    "theta": np.array([-1.4, -0.2, 0.3, 0.9, 1.6]),
    "z": np.array([-0.9, -0.5]),
}
FIXED = (0.02, -0.03, 0.25, -0.45)
NAMES = [names for n in range(5) for names in permutations(VALUES, n)]
"""Every choice of axes in every order, 65 of them."""


def near(got: Any, expected: Any, relative: float = 1e-11) -> None:
    """Equal but for rounding; NaN in the same places."""
    if np.isnan(expected).all():
        assert np.isnan(got).all()
        return
    size = np.nanmax(np.abs(expected), initial=1e-300)
    np.testing.assert_allclose(got, expected, rtol=relative, atol=relative * size)


def measured(design: Design, pose: Any) -> dict[str, Any]:
    """Return what a field holds and every quantity, by the pointwise functions."""
    geometry = design.geometry
    reach, singular = check_reach(geometry, pose), measure_singularity(geometry, pose)
    return {
        "status": reach.status,
        "leg": reach.leg,
        "margin": reach.margins.min(axis=(-1, -2)),
        "gamma": np.moveaxis(unit_torques(geometry, pose), -1, 0),
        "determinant": singular.determinant,
        "condition": singular.condition,
        "torques": np.moveaxis(static_torques(design, pose), -1, 0),
        **{f"quantity {name}": values for name, values in pointwise(design, pose).items()},
    }


@cache
def at_all_values() -> dict[str, Any]:
    """Return what is measured at every pose of `FIXED` (index 0) and `VALUES`, axes as there."""
    axes = [np.r_[FIXED[grids.COORDINATES.index(name)], VALUES[name]] for name in VALUES]
    places = dict(zip(VALUES, np.meshgrid(*axes, indexing="ij"), strict=True))
    return measured(APPENDIX_4, np.stack([places[name] for name in grids.COORDINATES], axis=-1))


def check_field(
    field: Field, design: Design, expected: dict[str, Any], quantities: Iterable[str] = QUANTITIES
) -> None:
    """Compare a field, and quantities over it, with the pointwise functions at its poses."""
    compared = {name.removeprefix("quantity ") for name in expected if name.startswith("quantity ")}
    assert compared == set(QUANTITIES), "tests/support/measured.py has every one"
    for name in ("status", "leg"):
        np.testing.assert_array_equal(getattr(field, name), expected[name])
    for name in ("margin", "gamma", "determinant"):
        near(getattr(field, name), expected[name])
    near(field.condition, expected["condition"], 1e-9)
    near(field.torques(design), expected["torques"])
    for name in quantities:
        got = QUANTITIES[name].over(field, design)
        assert np.shape(got) == field.grid.shape
        near(got, expected[f"quantity {name}"], 1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("names", NAMES, ids="-".join)
def test_any_axes_in_any_order(names: tuple[str, ...]) -> None:
    grid = Grid.over(FIXED, **{name: VALUES[name] for name in names})
    assert grid.shape == tuple(VALUES[name].size for name in names)
    assert grid.size == int(np.prod(grid.shape, dtype=int))
    pose = grid.poses()
    assert pose.shape == (*grid.shape, 4)
    for axis, name in enumerate(names):
        coordinate = np.moveaxis(pose[..., grids.COORDINATES.index(name)], axis, -1)
        np.testing.assert_array_equal(coordinate, np.broadcast_to(VALUES[name], coordinate.shape))
    for index, name in enumerate(grids.COORDINATES):
        if name not in names:
            np.testing.assert_array_equal(pose[..., index], FIXED[index])
    field = solve_field(APPENDIX_4.geometry, grid)
    chosen = (..., *(slice(1, None) if name in names else 0 for name in VALUES))
    own = [name for name in VALUES if name in names]  # the order of the axes that are left
    order = [own.index(name) - len(names) for name in names]
    back = list(range(-len(names), 0))
    check_field(
        field,
        APPENDIX_4,
        {key: np.moveaxis(values[chosen], order, back) for key, values in at_all_values().items()},
        list(QUANTITIES)[NAMES.index(names) % 5 :: 5],  # each one in a fifth of the orders
    )
    assert field.gamma.shape == (4, *grid.shape)
    torques = rotary_torques(APPENDIX_4, grid)
    near(torques, field.torques(APPENDIX_4)[:3])


@pytest.mark.slow
@given(case=cases(), names=st.sampled_from(NAMES))
def test_any_robot(case: Case, names: tuple[str, ...]) -> None:
    rng = np.random.default_rng(case.seed)
    g = case.geometry
    size = {"x": g.base_radius, "y": g.base_radius, "theta": np.pi, "z": 2 * g.coupler_length}
    axes = {name: rng.uniform(-1, 1, rng.integers(1, 7)) * size[name] for name in names}
    # off the center, where legs would tie for the worst
    fixed = [0.011 * g.base_radius, -0.023 * g.base_radius, 0.1, -0.6 * g.coupler_length]
    grid = Grid.over(fixed, **axes)
    field = solve_field(g, grid)
    check_field(field, case.design, measured(case.design, grid.poses()))
    assert (field.geometry, field.grid) == (g, grid)


@pytest.mark.slow
@pytest.mark.parametrize("numpy", [False, True])
@pytest.mark.parametrize("names", [("y", "x"), ("x", "theta"), ("z", "theta", "x"), ("theta",)])
def test_blocks_and_threads_change_nothing(
    monkeypatch: pytest.MonkeyPatch, names: tuple[str, ...], numpy: bool
) -> None:
    count = {"z": 2}
    axes = {name: np.linspace(*VALUES[name][[0, -1]], count.get(name, 5)) for name in names}
    grid = Grid.over(FIXED, **axes)
    reference = solve_field(APPENDIX_4.geometry, grid, threads=1)

    def compare() -> None:
        for threads in (None, 1, 3):
            field = solve_field(APPENDIX_4.geometry, grid, threads=threads)
            np.testing.assert_array_equal(field.status, reference.status)
            np.testing.assert_array_equal(field.leg, reference.leg)
            for name in ("gamma", "margin", "determinant", "condition"):
                near(getattr(field, name), getattr(reference, name))
            near(
                rotary_torques(APPENDIX_4, grid, threads=threads), reference.torques(APPENDIX_4)[:3]
            )

    for block in (1, 3, 5, 20, 2**15):
        monkeypatch.setattr(grids, "BLOCK", block)
        if numpy:
            with backend.use_numpy():
                compare()
        else:
            compare()


@BOTH
def test_masked_cells_carry_their_reason(knee: KneeBranch) -> None:
    """Stretched, folded, guide, axis, not finite and singular ones in one map; no warning."""
    design = APPENDIX_4.vary(
        {
            "geometry.base_radius": 0.5,
            "geometry.platform_radius": 0.25,
            "geometry.guide_stroke": 0.3,
        }
    )
    x = np.array([0.0, 0.25, 0.45, np.nan])
    z = np.array([-1.2, -0.5, -0.0275])
    field = solve_field(with_knee(design.geometry, knee), Grid.over([0.0, 0.0, 0.0, 0.0], z=z, x=x))
    words = [[Limit(s).word for s in row] for row in field.status]
    assert words == [
        ["stretched", "stretched", "stretched", "not-finite"],
        ["ok", "singular", "stretched", "not-finite"],
        ["ok", "folded", "guide", "not-finite"],
    ]
    on_axis = solve_field(with_knee(design.geometry, knee), Grid.over([0.0, 0.25, 0.0, -0.5]))
    assert on_axis.status == Limit.AXIS
    assert on_axis.leg == 2
    assert np.isnan(field.gamma).any(axis=0).tolist() == (field.status != Limit.OK).tolist()
    for quantity in QUANTITIES:
        if QUANTITIES[quantity].formula == UNIT_TORQUES:
            values = QUANTITIES[quantity].over(field, design)
            np.testing.assert_array_equal(np.isnan(values), field.status != Limit.OK)


def test_masses_only_rescale_a_field() -> None:
    """What a mass slider costs: no solving, one factor."""
    axis = np.linspace(-0.2, 0.2, 9)
    field = solve_field(APPENDIX_4.geometry, xy_grid(axis, axis, np.pi / 3, -0.5))
    heavy = APPENDIX_4.vary({"joints.j9": 2.0, "links.b4": 1.5, "gravity": 3.7})
    check = static_torques(heavy, field.grid.poses())
    near(field.torques(heavy), np.moveaxis(check, -1, 0))
    before = field.gamma.copy()
    field.torques(heavy)
    np.testing.assert_array_equal(field.gamma, before)


def test_rows_of_a_map_are_along_y() -> None:
    grid = xy_grid([0.1, 0.2, 0.3], [-0.1, 0.1], 0.4, -0.5)
    assert grid.shape == (2, 3)
    np.testing.assert_array_equal(grid.poses()[1, 2], [0.3, 0.1, 0.4, -0.5])


@given(
    names=st.sampled_from(NAMES),
    sizes=st.lists(st.integers(1, 6), min_size=4, max_size=4),
    poses=st.integers(1, 200),
)
def test_splitting_covers_a_grid_once(names: tuple[str, ...], sizes: list[int], poses: int) -> None:
    axes = {name: np.arange(size) + 0.5 for name, size in zip(names, sizes, strict=False)}
    grid = Grid.over(FIXED, **axes)
    seen = np.zeros(grid.shape, dtype=int)
    whole = grid.poses()
    for index, piece in grid.split(poses):
        assert 1 <= piece.size <= poses
        np.testing.assert_array_equal(piece.poses(), whole[index])
        seen[index] += 1
    np.testing.assert_array_equal(seen, 1)
    assert len(list(grid.split(grid.size))) == 1


@pytest.mark.parametrize(
    ("axes", "argument", "problem"),
    [
        ({"u": [0.0]}, "u", "a grid varies x, y, theta, z"),
        ({"x": []}, "x", "one axis of values"),
        ({"x": 0.3}, "x", "one axis of values"),
        ({"theta": [[0.1, 0.2]]}, "theta", "one axis of values"),
        ({"y": ["a"]}, "y", "real numbers"),
        ({"z": [1j]}, "z", "real numbers"),
    ],
)
def test_impossible_axes_are_refused(axes: Any, argument: str, problem: str) -> None:
    for make in (lambda: Grid.over(FIXED, **axes), lambda: Grid(tuple(axes.items()), FIXED)):
        with pytest.raises(InvalidInput, match=problem) as caught:
            make()
        assert caught.value.argument == argument


def test_a_coordinate_that_is_named_twice_is_refused() -> None:
    with pytest.raises(InvalidInput, match="x: a grid varies it along one axis"):
        Grid((("x", np.zeros(3)), ("x", np.zeros(2))), FIXED)


def test_unusable_input_is_refused() -> None:
    with pytest.raises(InvalidInput, match=r"fixed: one pose \(4,\)"):
        Grid.over(np.zeros((2, 4)))
    with pytest.raises(InvalidInput, match="fixed: the last axis"):
        Grid.over([0.0, 0.0])
    with pytest.raises(InvalidInput, match="theta: a number is needed, not a ndarray"):
        xy_grid([0.0], [0.0], np.array([0.1, 0.2]), -0.5)  # type: ignore[arg-type]
    with pytest.raises(InvalidInput, match=r"no quantity 'weight'; there are .*tau_1, "):
        find(("tau_1", "weight"))


def test_a_formula_is_solved_at_the_first_call_and_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    """A slider of a mass or a load, of any quantity, solves nothing again."""
    field = solve_field(APPENDIX_4.geometry, Grid.over(FIXED, x=VALUES["x"]))
    solved = QUANTITIES["condition"].over(field, APPENDIX_4)
    loaded = APPENDIX_4.vary({"load.force_x": 1.0})
    for quantity in QUANTITIES.values():
        quantity.over(field, loaded)
    monkeypatch.setattr(grids, "_evaluate", None)
    assert np.shares_memory(field.solve(DEXTERITY), solved)
    assert "_solved" not in repr(field)
    assert "_kept" not in repr(field)
    changed = APPENDIX_4.vary({"links.b3": 1.0, "load.force_y": 5.0, "load.point_x": 0.1})
    for quantity in QUANTITIES.values():
        assert quantity.over(field, changed).shape == field.grid.shape


def test_a_field_can_be_taken_apart_by_dataclasses() -> None:
    """`asdict` makes a dict of every data class in it, which no key of its results can be."""
    field = solve_field(APPENDIX_4, Grid.over(FIXED, x=VALUES["x"]))
    parts = asdict(field)
    assert parts["geometry"] == asdict(APPENDIX_4.geometry)
    np.testing.assert_array_equal(parts["status"], field.status)
