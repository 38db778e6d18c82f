"""Errors of the drives over a region: those of its poses, one by one."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from paminsa_viz.model import APPENDIX_4, check_reach, singular_rotation
from paminsa_viz.precision.drive_errors import Bound, drive_errors
from paminsa_viz.precision.error_rows import (
    STATISTICS_OF,
    error_rows,
    region_errors,
    statistics,
)
from paminsa_viz.studies import Region
from paminsa_viz.studies.region import RegionResults

FOLD = singular_rotation(APPENDIX_4.geometry)
REGION = Region(0.3, (-0.2, FOLD - 1e-4), (-0.5, -0.9), cells=6)


def test_rows_are_x_y_their_distance_z_and_theta() -> None:
    pose = np.array([[0.04, -0.02, 0.3, -0.5], [0.1, 0.05, -0.2, -0.6]])
    found = drive_errors(APPENDIX_4.geometry, APPENDIX_4.accuracy, pose)
    rows = error_rows(found)
    assert [(row.name, row.unit) for row in rows] == [
        ("x", "m:um"), ("y", "m:um"), ("xy", "m:um"), ("z", "m:um"), ("θ", "rad:arcsec"),
    ]  # fmt: skip
    for row, place in zip(rows, (0, 1, None, 3, 2), strict=True):
        expected = (
            (found.horizontal, found.linear_horizontal, found.rms_horizontal)
            if place is None
            else (found.worst[:, place], found.linear[:, place], found.rms[:, place])
        )
        for kind, values in zip(STATISTICS_OF, expected, strict=True):
            np.testing.assert_array_equal(getattr(row, kind), values)
    (alone, *_) = error_rows(drive_errors(APPENDIX_4.geometry, APPENDIX_4.accuracy, pose[0]))
    assert alone.worst.shape == (1,)


def test_errors_over_a_region_are_those_of_its_poses() -> None:
    """A region with poses out of reach, poses without a bound and others."""
    side = 0.3 * np.array([-5, -3, -1, 1, 3, 5]) / 6
    theta, z, y, x = np.meshgrid(REGION.theta, REGION.z, side, side, indexing="ij")
    pose = np.stack([x, y, theta, z], axis=-1)[np.hypot(x, y) <= 0.3]
    pose = pose[check_reach(APPENDIX_4.geometry, pose).ok]
    one_by_one = drive_errors(APPENDIX_4.geometry, APPENDIX_4.accuracy, pose)
    over = RegionResults(APPENDIX_4, REGION)
    found = region_errors(over.field, APPENDIX_4.accuracy, over.reached)
    assert found.poses == len(pose) < theta.size
    for row, expected in zip(found.rows, error_rows(one_by_one), strict=True):
        for kind in STATISTICS_OF:
            values = getattr(expected, kind)
            np.testing.assert_allclose(getattr(row, kind), values, rtol=1e-9, atol=1e-15)
    counts = Counter(Bound(code) for code in one_by_one.status.tolist())
    assert counts.pop(Bound.OK) > 0
    assert found.unbounded == dict(counts)
    assert list(found.unbounded) == sorted(found.unbounded)
    assert len(counts) > 0


@pytest.mark.parametrize("nothing", [0, 5])
def test_statistics_are_of_what_has_a_value(nothing: int) -> None:
    """Of the numbers from 0 to 100 the percentiles are themselves."""
    known = np.random.default_rng(0).permutation(np.arange(101.0))
    values = np.concatenate([np.full(nothing, np.nan), known])
    assert statistics(values) == (50.0, 95.0, 100.0)
    assert np.isnan(statistics(np.full(nothing, np.nan))).all()
