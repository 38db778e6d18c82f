"""Poses that can be taken and have no value: what maps, hover and tables say of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from paminsa_viz.model import APPENDIX_4, DriveAccuracy, singular_rotation
from paminsa_viz.plots.caption import caption
from paminsa_viz.plots.hover import reasons
from paminsa_viz.plots.map_table import map_table, value_columns
from paminsa_viz.plots.map_values import MapData, difference, map_data, workspace_field
from paminsa_viz.plots.ranges import choose_scales
from paminsa_viz.studies.metrics import global_indices
from paminsa_viz.studies.region import RegionResults, default_region

THETA = singular_rotation(APPENDIX_4.geometry) - 0.1
COARSE = replace(APPENDIX_4, accuracy=DriveAccuracy(resolution_rotary=2e-3))


def near_the_fold(quantity: str, cells: int = 40) -> MapData:
    """A map at which some poses have no bound."""
    field = workspace_field(APPENDIX_4.geometry, THETA, -0.3, cells)
    return map_data(field, COARSE, (0.0, 0.0, THETA, -0.3), (quantity,))


def test_a_cell_without_a_bound_says_why_and_the_linear_estimate_has_a_number() -> None:
    data, linear = near_the_fold("error_theta"), near_the_fold("linear_error_theta")
    empty = (data.status == 0) & np.isnan(data.values[0])
    assert 20 < empty.sum() < (data.status == 0).sum()
    assert np.isfinite(linear.values[0][empty]).all()
    assert linear.missing is None
    found = reasons(data, 0)
    assert {text.split(":")[0] for text in found[empty]} == {"no bound"}
    assert any("cannot be assembled" in text for text in found[empty])
    assert (found[np.isfinite(data.values[0])] == "").all()
    assert all("out of reach" in text for text in found[data.status != 0])


def test_captions_name_what_is_missing() -> None:
    data = near_the_fold("error_theta")
    assert data.missing_word == "no bound"
    assert "Dark gray: no bound." in caption(data, choose_scales(data))
    linear = near_the_fold("linear_error_theta")
    assert "Dark gray" not in caption(linear, choose_scales(linear))


def test_tables_have_si_units_and_the_reason() -> None:
    data = near_the_fold("error_theta")
    assert data.display.text == "″"
    assert data.display.factor == pytest.approx(180 / np.pi * 3600)
    assert value_columns(data) == ("err_theta_rad",)
    table = map_table(data)
    words, values = table.columns["status"], table.columns["err_theta_rad"]
    assert set(words[np.isfinite(values)].tolist()) == {"ok"}
    assert "no-bound:not-assembled" in words.ravel().tolist()
    assert not any("no-bound" in word for word in words[data.status != 0])
    assert table.provenance["unit"] == "rad"


def test_a_difference_has_the_reasons_of_both() -> None:
    fine, coarse = near_the_fold("error_theta"), near_the_fold("error_theta")
    assert fine.missing is not None
    fine = replace(fine, missing=fine.missing._replace(code=np.zeros_like(fine.missing.code)))
    found = difference(fine, coarse)
    assert found.missing is not None
    np.testing.assert_array_equal(found.missing.code, coarse.missing.code)  # type: ignore[union-attr]


def test_global_indices_leave_poses_without_a_bound_out() -> None:
    region = replace(default_region(COARSE), theta=(THETA,), z=(-0.3,))
    values = [metric.value(RegionResults(COARSE, region)) for metric in global_indices(["error_x"])]
    assert np.isfinite(values).all()


def test_a_cell_whose_pose_is_not_held_says_so() -> None:
    """Beside the singular circle the payload pushes the platform away."""
    heavy = APPENDIX_4.vary({"payload.mass": 50.0, "elastic.drive_rotary": 300.0})
    field = workspace_field(heavy.geometry, 0.5, -0.55, 24)
    data = map_data(field, heavy, (0.0, 0.0, 0.5, -0.55), ("frequency_drives",))
    empty = (data.status == 0) & np.isnan(data.values[0])
    assert 3 < empty.sum() < (data.status == 0).sum()
    assert {text.split(":")[0] for text in reasons(data, 0)[empty]} == {"not held"}
    assert data.missing_word == "not held"
