"""Ranges of the joints in the scene."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
import viser
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.explorer.features.pose.layers import (
    INNER,
    OUTER,
    JointLimits,
    around,
    marks,
    sector,
    turning_ranges,
)
from paminsa_viz.explorer.scene.context import SceneContext
from paminsa_viz.model import APPENDIX_4, KneeBranch, inverse_kinematics, measure_singularity
from paminsa_viz.model.kinematics import AXIS_ANGLES
from paminsa_viz.model.reach import MARGINS, Limit, home_pose
from tests.support.raw_page import RawPage
from tests.support.samples import random_design
from tests.support.scene import Scene

GUIDE = MARGINS.index(Limit.GUIDE)


@given(st.lists(st.floats(-7.0, 7.0), min_size=1, max_size=30))
def test_arc_around_angles_holds_all_of_them_and_no_shorter_one_does(angles: list[float]) -> None:
    start, end = around(np.array(angles))
    assert 0 <= end - start < 2 * np.pi
    assert abs(start + end) / 2 <= np.pi + 1e-9
    inside = np.mod(np.array(angles) - start + 1e-9, 2 * np.pi)
    assert (inside <= end - start + 2e-9).all()
    others = [np.ptp(np.mod(np.array(angles) - cut, 2 * np.pi)) for cut in np.array(angles) - 1e-9]
    assert end - start <= min(others) + 1e-8


@pytest.mark.parametrize("theta", [0.0, 0.6])
def test_ranges_hold_the_angles_of_the_poses_that_count(theta: float) -> None:
    geometry = APPENDIX_4.geometry
    z = home_pose(geometry)[3]
    ranges = turning_ranges(geometry, theta, z)
    rng = np.random.default_rng(3)
    poses = np.column_stack([rng.uniform(-0.15, 0.15, (60, 2)), np.full(60, theta), np.full(60, z)])
    usable = measure_singularity(geometry, poses).condition < 9
    angles = inverse_kinematics(geometry, poses[usable]).actuators[:, :3]
    assert len(angles) > 20
    for leg, (start, end) in enumerate(ranges):
        off = np.mod(angles[:, leg] - start + 0.05, 2 * np.pi)
        assert (off <= end - start + 0.1).all()
        assert end - start < np.radians(300)


def test_range_where_nothing_counts_is_empty() -> None:
    assert turning_ranges(APPENDIX_4.geometry, 0.0, 4.0) == ((0.0, 0.0),) * 3


def test_sector_is_a_ring_between_its_angles() -> None:
    points, faces = sector(-0.4, 1.1)
    radius, angle = np.hypot(*points[:, :2].T), np.arctan2(points[:, 1], points[:, 0])
    assert set(np.round(radius, 9)) == {INNER, OUTER}
    assert (angle.min(), angle.max()) == pytest.approx((-0.4, 1.1))
    corners = points[faces][..., :2]
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = 0.5 * np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum()
    assert area == pytest.approx(0.75 * (OUTER**2 - INNER**2), rel=1e-3)


@given(seed=st.integers(0, 10**6))
def test_marks_are_as_far_from_the_guides_ends_as_the_margins_say(seed: int) -> None:
    design = random_design(np.random.default_rng(seed))
    configuration = inverse_kinematics(design.geometry, home_pose(design.geometry))
    _, travel, low, high, here = np.moveaxis(marks(configuration), 1, 0)
    middles = np.stack([each.mean(axis=1) for each in (low, high, here)])
    np.testing.assert_allclose(middles[:2], np.moveaxis(travel, 1, 0), atol=1e-12)
    to_ends = np.linalg.norm(middles[:2] - middles[2], axis=-1).min(axis=0)
    np.testing.assert_allclose(to_ends, configuration.reach.margins[:, GUIDE], atol=1e-9)


@pytest.mark.parametrize("knee", KneeBranch)
def test_needle_is_at_theta_in_its_sector(knee: KneeBranch) -> None:
    geometry = APPENDIX_4.with_knee(knee).geometry
    x, y, _, z = home_pose(geometry)
    configuration = inverse_kinematics(geometry, (x + 0.06, y - 0.02, 0.3, z))
    needle = marks(configuration)[:, 0]
    along = needle[:, 1] - needle[:, 0]
    angle = np.arctan2(along[:, 1], along[:, 0])
    zero = np.array(AXIS_ANGLES) + np.pi
    off = np.mod(angle - zero - configuration.actuators[:3] + np.pi, 2 * np.pi) - np.pi
    np.testing.assert_allclose(off, 0.0, atol=1e-9)


@pytest.fixture
def scene(server: viser.ViserServer) -> Iterator[Scene]:
    page = RawPage(server)
    context = SceneContext(page.client.scene)
    yield Scene(page.client.scene, [JointLimits(context)])
    page.socket.close()


def test_limits_are_made_when_shown_and_hidden_again(scene: Scene) -> None:
    scene.draw(layers=[])
    assert not any(name.startswith("/joint_limits") for name in scene.nodes)
    scene.draw(layers=["joint_limits"])
    names = {f"/joint_limits/theta_{leg}" for leg in (1, 2, 3)} | {"/joint_limits/lines"}
    assert scene.shown >= names
    scene.draw(layers=[])
    assert not scene.shown & names
