"""The data object: what it accepts, what it keeps, how maps are cut out and subtracted."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.model.errors import InvalidInput, PaminsaError
from paminsa_viz.model.reach import Limit
from paminsa_viz.plots.map_data import difference
from tests.plots.samples import made_up


def test_arrays_can_not_be_written() -> None:
    data = made_up()
    for name in ("x", "y", "values", "status", "pose", "margin", "leg"):
        with pytest.raises(ValueError, match="read-only"):
            getattr(data, name)[...] = 0


def test_the_caller_s_arrays_stay_writable() -> None:
    pose = np.array([0.0, 0.0, 1.0, -0.5])
    made_up(pose=pose)
    pose[0] = 1.0


def test_masked_cells_lose_their_values() -> None:
    data = made_up(values=np.ones((3, 27, 31)))
    assert np.isnan(data.values[:, data.status != 0]).all()
    assert (data.values[:, data.status == 0] == 1).all()


def test_extent_reaches_half_a_cell_beyond_the_centers() -> None:
    left, right, bottom, top = made_up(nx=29, ny=25).extent
    assert np.allclose([left, right, bottom, top], [-0.435, 0.435, -0.375, 0.375])


def test_a_panel_is_a_map_of_its_own() -> None:
    data = made_up()
    one = data.panel(1)
    assert one.names == ("τ₂",)
    assert one.colors == data.colors[1:2]
    assert np.array_equal(one.values[0], data.values[1], equal_nan=True)
    with pytest.raises(InvalidInput):
        data.panel(3)


def test_the_marker_moves_but_not_theta_or_z() -> None:
    data = made_up()
    moved = data.with_pose((0.1, 0.2, 1.0, -0.5))
    assert moved.pose.tolist() == [0.1, 0.2, 1.0, -0.5]
    with pytest.raises(InvalidInput):
        data.with_pose((0.1, 0.2, 1.1, -0.5))


@pytest.mark.parametrize(
    "changes",
    [
        {"x": np.linspace(0, 1, 30)},
        {"x": np.linspace(1, 0, 31)},
        {"x": np.geomspace(1, 2, 31)},
        {"x": np.full(31, np.nan)},
        {"values": np.zeros((2, 27, 31))},
        {"values": np.zeros((3, 31, 27))},
        {"status": np.zeros((27, 31))},
        {"status": np.full((27, 31), 9, dtype=np.uint8)},
        {"status": np.zeros((3, 27, 31), dtype=np.uint8)},
        {"colors": ("#000000",)},
        {"pose": (0, 0, 0)},
        {"singular_radius": float("nan")},
        {"singular_radius": -1.0},
        {"margin": np.zeros((31, 27))},
        {"leg": np.full((27, 31), 3, dtype=np.int8)},
    ],
)
def test_what_does_not_fit_is_refused(changes: dict[str, Any]) -> None:
    with pytest.raises(PaminsaError):
        made_up(**changes)


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
    assert result.provenance.reference == "Sample"


def test_difference_of_equal_maps_is_zero() -> None:
    data = made_up()
    result = difference(data, data)
    assert (result.values[:, data.status == 0] == 0).all()


@pytest.mark.parametrize(
    "changes",
    [
        {"pose": (0.0, 0.0, 0.9, -0.5)},
        {"unit": "N"},
        {"names": ("a", "b", "c")},
        {"x": np.linspace(-0.4, 0.4, 31)},
    ],
)
def test_difference_needs_maps_of_the_same_thing(changes: dict[str, Any]) -> None:
    data = made_up()
    with pytest.raises(InvalidInput):
        difference(data, replace(data, **changes))


def test_infinite_values_cancel_without_a_warning() -> None:
    values = np.full((3, 27, 31), np.inf)
    data = made_up(values=values)
    assert np.isnan(difference(data, data).values).all()
