"""Map data: validation, read-only arrays, differences, and the model's values."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.errors import InvalidInput
from paminsa_viz.model import APPENDIX_4, solve_field, static_torques, xy_grid
from paminsa_viz.model.grids import Grid
from paminsa_viz.model.reach import Limit, check_reach, workspace_radius
from paminsa_viz.palette import LEG_COLORS
from paminsa_viz.plots.caption import caption
from paminsa_viz.plots.contours import contour_lines
from paminsa_viz.plots.map_values import (
    FRAMES,
    PROBES,
    cell_centers,
    difference,
    frame_half,
    half_width,
    map_data,
    workspace_field,
)
from paminsa_viz.plots.ranges import ScaleChoice, choose_scales
from paminsa_viz.quantities import QUANTITIES, Missing
from tests.plots.samples import made_up, real
from tests.support.samples import resized

POSE = (0.05, -0.03, np.pi / 3, -0.5)


def test_arrays_are_read_only_views_of_the_callers() -> None:
    pose = np.array([0.0, 0.0, 1.0, -0.5])
    data = made_up(pose=pose)
    pose[0] = 1.0
    for name in ("x", "y", "values", "status", "pose", "margin", "leg"):
        with pytest.raises(ValueError, match="read-only"):
            getattr(data, name)[...] = 0


def test_masked_cells_lose_their_values() -> None:
    data = made_up(values=np.ones((3, 27, 31)))
    assert np.isnan(data.values[:, data.status != 0]).all()
    assert (data.values[:, data.status == 0] == 1).all()


def test_extent_reaches_half_a_cell_beyond_the_centers() -> None:
    assert made_up(nx=29, ny=25).extent == pytest.approx((-0.435, 0.435, -0.375, 0.375))


def test_the_marker_moves_but_not_theta_or_z() -> None:
    data = made_up()
    assert data.with_pose((0.1, 0.2, 1.0, -0.5)).pose.tolist() == [0.1, 0.2, 1.0, -0.5]
    with pytest.raises(InvalidInput):
        data.with_pose((0.1, 0.2, 1.1, -0.5))


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("x", np.linspace(1, 0, 31)), ("x", np.geomspace(1, 2, 31)), ("x", np.full(31, np.nan)),
        ("values", np.zeros((3, 27, 30))), ("values", np.zeros((2, 27, 31))),
        ("values", np.zeros((3, 31, 27))), ("status", np.zeros((27, 31))),
        ("status", np.full((27, 31), 9, np.uint8)), ("status", np.zeros((3, 27, 31), np.uint8)),
        ("colors", ("#000000",)), ("pose", (0, 0, 0)), ("singular_radius", float("nan")),
        ("singular_radius", -1.0), ("margin", np.zeros((31, 27))),
        ("leg", np.full((27, 31), 3, np.int8)),
    ],
)  # fmt: skip
def test_invalid_field_is_named(field: str, value: Any) -> None:
    with pytest.raises(InvalidInput) as caught:
        made_up(**{field: value})
    assert caught.value.argument == field


def test_difference_is_masked_where_either_is() -> None:
    current = made_up()
    status = np.zeros((27, 31), dtype=np.uint8)
    status[:5] = Limit.GUIDE
    leg = np.where(status != 0, np.int8(2), np.int8(-1))
    reference = made_up(values=np.full((3, 27, 31), 0.25), status=status, leg=leg)
    result = difference(current, reference)
    both = (current.status == 0) & (status == 0)
    assert np.array_equal(result.status == 0, both)
    assert np.array_equal(result.values[:, both], current.values[:, both] - 0.25)
    assert np.isnan(result.values[:, ~both]).all()
    only_reference = (current.status == 0) & (status != 0)
    assert (result.status[only_reference] == Limit.GUIDE).all()
    assert result.leg is not None
    assert (result.leg[only_reference] == 2).all()
    assert result.names == ("Δτ₁", "Δτ₂", "Δτ₃")
    assert result.signed
    assert result.reference is reference.design


def test_difference_has_the_nearer_limit_and_the_reasons_of_both() -> None:
    texts, words = ("", "no bound: at a singularity", "no value: none"), ("", "a", "b")
    code = np.zeros((27, 31), np.uint8)
    code[13:, :10], code[:, 12] = 1, 2
    other = np.zeros((27, 31), np.uint8)
    other[10:16, 5:25] = 2
    margin = np.linspace(-0.1, 0.2, 27 * 31).reshape(27, 31)
    first = made_up(missing=Missing(code, texts, words))
    second = made_up(
        missing=Missing(other, texts, words), margin=margin, status=np.zeros_like(code)
    )
    found = difference(first, second)
    assert found.missing is not None
    np.testing.assert_array_equal(found.missing.code, np.where(code != 0, code, other))
    np.testing.assert_array_equal(found.margin, np.minimum(first.margin, margin))
    np.testing.assert_array_equal(found.status, first.status)
    np.testing.assert_array_equal(found.leg, np.where(first.status != 0, 1, second.leg))
    assert found.title == "Made-up torques, difference"
    assert difference(made_up(title=""), second).title == "Difference"
    for name in ("margin", "leg"):
        bare = replace(first, **{name: None})
        assert getattr(difference(bare, second), name) is None
    assert difference(replace(first, leg=None), second).leg is None
    kept = difference(first, replace(second, margin=None)).margin
    np.testing.assert_array_equal(kept, first.margin)
    alone = difference(first, replace(second, missing=None)).missing
    assert alone is not None
    np.testing.assert_array_equal(alone.code, code)


def test_what_is_missing_is_named_where_poses_can_be_taken() -> None:
    texts, words = ("", "no bound: at a singularity", "no value: none"), ("", "a", "b")
    out = made_up().status != 0
    for where, code, word in ((~out, 1, "no bound"), (~out, 2, "no value"), (out, 1, "")):
        missing = Missing(np.where(where, code, 0).astype(np.uint8), texts, words)
        assert made_up(missing=missing).missing_word == word
    assert made_up().missing_word == ""


@pytest.mark.parametrize("value", [1.5, np.inf], ids=["finite", "infinite"])
def test_difference_of_equal_maps_is_zero_or_not_a_number(value: float) -> None:
    data = made_up(values=np.full((3, 27, 31), value))
    good = difference(data, data).values[:, data.status == 0]
    assert np.array_equal(good, np.full(good.shape, value - value), equal_nan=True)


@pytest.mark.parametrize(
    "changes",
    [
        {"pose": (0.0, 0.0, 0.9, -0.5)}, {"unit": "N"}, {"names": ("a", "b", "c")},
        {"x": np.linspace(-0.4, 0.4, 31)},
    ],
)  # fmt: skip
def test_difference_needs_maps_of_the_same_thing(changes: dict[str, Any]) -> None:
    data = made_up()
    with pytest.raises(InvalidInput):
        difference(data, replace(data, **changes))


def test_values_are_the_model_s_at_every_cell() -> None:
    data = real(21)
    x, y = np.meshgrid(data.x, data.y)
    pose = np.stack([x, y, np.full_like(x, POSE[2]), np.full_like(x, POSE[3])], axis=-1)
    torque = np.moveaxis(static_torques(APPENDIX_4, pose)[..., :3], -1, 0)
    good = data.status == 0
    assert 100 < good.sum() < good.size
    assert np.allclose(data.values[:, good], torque[:, good], rtol=1e-10)
    assert np.isnan(data.values[:, ~good]).all()
    assert data.colors == LEG_COLORS
    assert data.names == ("τ₁", "τ₂", "τ₃")
    assert data.singular_radius == pytest.approx(np.sqrt(0.35**2 + 0.1**2 - 0.035))


ROBOTS = (
    APPENDIX_4.geometry,
    APPENDIX_4.vary({"geometry.base_radius": 0.36, "geometry.platform_radius": 0.3}).geometry,
)


@pytest.mark.parametrize("geometry", ROBOTS)
def test_a_map_covers_all_that_is_within_reach_rounded_up_to_a_centimeter(geometry) -> None:
    half, radius = half_width(geometry), 1.005 * workspace_radius(geometry)
    assert radius <= half + 1e-8 < radius + 0.01
    assert 100 * half == pytest.approx(round(100 * half), abs=1e-9)
    centers = workspace_field(geometry, 0.3, -0.5, 9).grid.axes[0][1]
    np.testing.assert_allclose(centers, cell_centers(half, 9))
    narrower = workspace_field(geometry, 0.3, -0.5, 9, 0.2).grid.axes[1][1]
    np.testing.assert_allclose(narrower, cell_centers(0.2, 9))
    steps = np.diff(cell_centers(half, 7))
    np.testing.assert_allclose(steps, 2 * half / 7)
    np.testing.assert_allclose(cell_centers(half, 7)[[0, -1]], [half / 7 - half, half - half / 7])


@pytest.mark.parametrize("times", [1e-1, 1e-2, 1e-3, 1e-5])
def test_a_map_of_a_small_robot_is_as_wide_as_it_reaches(times: float) -> None:
    geometry, whole = resized(APPENDIX_4, times).geometry, APPENDIX_4.geometry
    assert half_width(geometry) == pytest.approx(times * half_width(whole))
    frame = frame_half(geometry, 1.0, -0.5 * times)
    assert frame == pytest.approx(times * frame_half(whole, 1.0, -0.5))


@pytest.mark.parametrize("geometry", ROBOTS)
@pytest.mark.parametrize("theta", [0.0, 1.0, 2.5])
@pytest.mark.parametrize("z", [-0.3, -0.6, -0.9])
def test_a_frame_is_the_least_of_its_sizes_that_holds_what_is_within_reach(
    geometry, theta, z
) -> None:
    half, most = frame_half(geometry, theta, z), half_width(geometry)
    size = FRAMES * half / most
    assert size == pytest.approx(round(size), abs=1e-9)

    def far(cells: int) -> float:
        """Return the largest size of x or y within reach, of so many cells along each side."""
        centers = cell_centers(most, cells)
        grid = xy_grid(centers, centers, theta, z).poses()
        ok = check_reach(geometry, grid).ok
        return max((abs(grid[ok][:, :2])).max(initial=0.0), 0.0)

    if not far(PROBES):
        assert half == most
        return
    assert far(301) <= half
    needed = far(PROBES) + 2 * most / PROBES
    assert half == pytest.approx(
        min(math.ceil(FRAMES * needed / most - 1e-9), FRAMES) * most / FRAMES
    )


WITHOUT_BODIES = ("clearance_payload", "clearance_counterweights")
"""Quantities of bodies that the robot of Appendix 4 does not have."""


@pytest.mark.slow
def test_every_quantity_has_a_legend_and_can_be_mapped() -> None:
    for quantity in QUANTITIES:
        data = real(21, quantities=(quantity,))
        assert data.design is APPENDIX_4
        assert data.title == QUANTITIES[quantity].title
        shown = data.values[np.isfinite(data.values)]
        assert (shown.size == 0) == (quantity in WITHOUT_BODIES), quantity
        if not data.signed:
            assert (shown >= 0).all() or (shown <= 0).all(), quantity
        elif quantity.startswith("deviation_"):
            assert not shown.any(), quantity  # all legs are alike
        elif not quantity.startswith("clearance_"):  # bodies of a group may keep apart everywhere
            assert shown.min() < 0 < shown.max(), quantity


@pytest.mark.slow
def test_every_quantity_has_colors_contours_and_a_caption() -> None:
    for quantity in QUANTITIES.values():
        data = real(21, quantities=(quantity.key,))
        for choice in (ScaleChoice(), ScaleChoice(kind="symlog")):
            (scale,) = choose_scales(data, choice)
            lines, text = contour_lines(data, 0, scale), caption(data, (scale,))
            ticks = scale.ticks(8)
            assert scale.low <= min(ticks) < max(ticks) <= scale.high, quantity.key
            assert all(scale.low < level < scale.high for level in lines), quantity.key
            assert lines or "Contours" not in text, quantity.key


def test_inconsistent_inputs_are_refused() -> None:
    axis = np.linspace(-0.1, 0.1, 5)
    field = solve_field(APPENDIX_4.geometry, xy_grid(axis, axis, POSE[2], POSE[3]))
    across = replace(field, grid=Grid.over(POSE, x=axis, y=axis))
    wider = APPENDIX_4.vary({"geometry.base_radius": 0.36})
    cases: dict[str, tuple[Any, ...]] = {
        "pose": (field, APPENDIX_4, (0.0, 0.0, 1.0, -0.5)),
        "design": (field, wider, POSE),
        "quantities": (field, APPENDIX_4, POSE, ("tau_1", "f_4")),
        "field": (across, APPENDIX_4, POSE),
    }
    for argument, given in cases.items():
        with pytest.raises(InvalidInput) as caught:
            map_data(*given)
        assert caught.value.argument == argument
    with pytest.raises(InvalidInput, match="unit"):
        map_data(field, APPENDIX_4, POSE, ())
