"""Where bars would touch: distances against dense sampling, and the shaft at the root of B10."""

from __future__ import annotations

import numpy as np
import pytest

from paminsa_viz.elastostatics.leg_frame import (
    PAIRS,
    Contacts,
    _nearest,
    contacts,
    leg_frame,
    pair_name,
)
from paminsa_viz.model.design import APPENDIX_4, KneeBranch
from paminsa_viz.model.kinematics import LEG_AXES, inverse_kinematics
from tests.elastostatics.robots import POSE, elastic_design, poses_of

ENDS = {"b2": (3, 2), "b3": (7, 4), "b4": (9, 5), "b7": (8, 7), "b8": (8, 9)}


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_gaps_are_those_of_sampled_center_lines(seed: int) -> None:
    design = elastic_design(seed)
    pose = poses_of(design, 1, seed)[0]
    found = contacts(design, pose)
    points = inverse_kinematics(design.geometry, pose).points
    share = np.linspace(0, 1, 401)[:, None]
    for leg in range(3):
        base = np.array([*(design.geometry.base_radius * LEG_AXES[leg]), 0.0])
        outward = points[8][leg] - base
        outward *= design.geometry.guide_link_length / np.linalg.norm(outward)
        lines = {b: points[i][leg] + share * (points[j][leg] - points[i][leg])
                 for b, (i, j) in ENDS.items()}  # fmt: skip
        lines["b10"] = base + share * outward
        for index, (first, second) in enumerate(PAIRS):
            a, b = lines[first], lines[second]
            distance = np.sqrt(((a[:, None] - b[None]) ** 2).sum(axis=-1).min())
            radii = 0.5 * sum(design.value(f"elastic.{bar}_outer") for bar in (first, second))
            assert found.gap[leg, index] == pytest.approx(distance - radii, abs=2e-3)
            at = found.point[leg, index]
            for line in (a, b):
                nearest = np.linalg.norm(line - at, axis=-1).min()
                assert nearest == pytest.approx(0.5 * distance, abs=2e-3)


def test_hanging_the_shaft_passes_the_root_of_b10() -> None:
    index = PAIRS.index(("b2", "b10"))
    found = contacts(APPENDIX_4, POSE)
    np.testing.assert_allclose(found.point[:, index, :2], 0.35 * LEG_AXES, atol=1e-12)
    np.testing.assert_allclose(found.point[:, index, 2], 0.0, atol=1e-12)
    assert "B2–B10" in found.touching()
    standing = contacts(APPENDIX_4.with_knee(KneeBranch.UPPER), (0.0, 0.0, 0.0, 0.6))
    assert "B2–B10" not in standing.touching()


def test_segments_are_as_near_as_their_nearest_points() -> None:
    """Of random ones, a third of which cross, against all pairs of points of both."""
    a, b, c, d = np.random.default_rng(3).uniform(-1, 1, (4, 60, 2))
    distance, place = _nearest(a, b, c, d)
    share = np.linspace(0, 1, 101)[:, None, None]
    one, other = (p + share * (q - p) for p, q in ((a, b), (c, d)))
    apart = np.linalg.norm(one[:, None] - other[None], axis=-1).reshape(-1, 60)
    np.testing.assert_allclose(distance, apart.min(axis=0), atol=0.02)
    assert 10 < (distance == 0).sum() < 50
    for line in (one, other):
        np.testing.assert_allclose(
            np.linalg.norm(line - place, axis=-1).min(axis=0), distance / 2, atol=0.02
        )


def test_bars_touch_where_any_pose_brings_them_nearer_than_their_radii() -> None:
    design = APPENDIX_4.with_knee(KneeBranch.UPPER)
    poses = np.array([(0.0, 0.0, 0.0, 0.6), (0.0, 0.0, 0.0, -0.6)])
    alone = [set(contacts(design, pose).touching()) for pose in poses]
    assert set(contacts(design, poses).touching()) == alone[0] | alone[1] > alone[0]
    gap = np.ones((2, 3, len(PAIRS)))
    gap[0, 1, 2], gap[1, 2, 3] = 0.0, -1e-9
    assert Contacts(gap, np.zeros((*gap.shape, 3))).touching() == [pair_name(3)]


def test_joints_of_several_poses_are_those_of_each() -> None:
    poses = poses_of(APPENDIX_4, 4)
    every = leg_frame(APPENDIX_4.geometry, poses).joints
    for number, pose in enumerate(poses):
        for joint, place in leg_frame(APPENDIX_4.geometry, pose).joints.items():
            np.testing.assert_array_equal(every[joint][number], place)


def test_unreachable_pose_has_no_gaps() -> None:
    found = contacts(APPENDIX_4, [POSE, (2.0, 0.0, 0.0, -0.5)])
    assert np.isnan(found.gap[1]).all()
    assert np.isfinite(found.gap[0]).all()
