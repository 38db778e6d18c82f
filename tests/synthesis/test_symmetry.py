"""Poses that stand for others: their values are the same, and every pose has one."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.model import APPENDIX_4, Design, LoadCase, solve_field
from paminsa_viz.model.grids import Grid
from paminsa_viz.quantities import QUANTITIES
from paminsa_viz.quantities.requirements import Requirement, Requirements, WorkspaceShape
from paminsa_viz.synthesis.proof import bisection
from paminsa_viz.synthesis.proof.bisection import Control, Gauge, nearest_violation
from paminsa_viz.synthesis.proof.families import (
    FAMILIES,
    NONE,
    BoundGroup,
    Family,
    Symmetry,
    groups,
    symmetry,
)
from paminsa_viz.synthesis.proof.regions import PoseRegion, from_unit, lowest
from tests.synthesis.certificate_robots import boxes, robots

BOUNDS = (
    Requirement("condition", high=10.0),
    Requirement("determinant", high=0.0),
    Requirement("max_torque", high=15.0),
    Requirement("rms_torque", high=10.0),
    Requirement("f_4", low=100.0, high=450.0),
)
CENTERED = PoseRegion(WorkspaceShape.CYLINDER, (0.0, 0.0, -0.6), (0.15, 0.15, 0.1), (-0.5, 0.5))


def images(poses: Any) -> list[Any]:
    """Return poses turned by 120 and 240 degrees, and their mirror images."""
    found = []
    for turn in (0.0, 2 * np.pi / 3, 4 * np.pi / 3):
        c, s = np.cos(turn), np.sin(turn)
        x, y, theta, z = poses.T
        turned = np.column_stack([c * x - s * y, s * x + c * y, theta, z])
        found += [turned, turned * [-1.0, 1.0, -1.0, 1.0]]
    return found


@given(design=robots(), seed=st.integers(0, 999))
def test_values_at_images_are_the_same(design: Design, seed: int) -> None:
    design = replace(design, load=LoadCase(force_z=7.0, point_x=0.1))
    poses, _ = boxes(design, seed, 40)
    for group in groups(design, Requirements(BOUNDS, (-0.5, 0.5))):
        assert symmetry(group, CENTERED) == Symmetry(True, True)
        expected = group.pose_margins(poses)
        fine = np.isfinite(expected).all(axis=1) & (np.abs(expected) < 1e4).all(axis=1)
        for image in images(poses):
            found = group.pose_margins(image)
            np.testing.assert_allclose(found[fine], expected[fine], rtol=1e-6, atol=1e-6)


@given(seed=st.integers(0, 999))
def test_every_pose_has_an_image_that_is_kept(seed: int) -> None:
    poses = np.random.default_rng(seed).uniform(-0.5, 0.5, (200, 4))
    kept = [
        Symmetry(True, True).kept(image, np.zeros_like(image)) & (image[:, 2] >= 0.0)
        for image in images(poses)
    ]
    assert np.any(kept, axis=0).all()


@pytest.mark.parametrize(
    ("design", "bound", "region", "theta"),
    [
        (APPENDIX_4, Requirement("tau_1", high=5.0), CENTERED, (-0.5, 0.5)),
        (replace(APPENDIX_4, load=LoadCase(force_x=1.0)), BOUNDS[2], CENTERED, (-0.5, 0.5)),
        (replace(APPENDIX_4, load=LoadCase(moment_z=1.0)), BOUNDS[2], CENTERED, (-0.5, 0.5)),
        (APPENDIX_4, BOUNDS[2], replace(CENTERED, center=(0.1, 0.0, -0.6)), (-0.5, 0.4)),
    ],
)
def test_what_tells_legs_apart_has_no_symmetry(
    design: Design, bound: Requirement, region: PoseRegion, theta: tuple[float, float]
) -> None:
    (group,) = groups(design, Requirements((bound,), theta))
    assert symmetry(group, region) == NONE


def test_a_box_is_no_third_and_other_headings_no_mirror() -> None:
    (group,) = groups(APPENDIX_4, Requirements(BOUNDS[:1], (-0.5, 0.5)))
    box = replace(CENTERED, shape=WorkspaceShape.BOX)
    assert symmetry(group, box) == Symmetry(False, True)
    aside = replace(CENTERED, center=(0.0, 0.1, -0.6))
    assert symmetry(group, aside) == Symmetry(False, True)
    (group,) = groups(APPENDIX_4, Requirements(BOUNDS[:1], (-0.5, 0.6)))
    assert symmetry(group, CENTERED) == Symmetry(True, False)


@pytest.mark.slow
def test_bounds_are_those_of_all_poses(monkeypatch: pytest.MonkeyPatch) -> None:
    needed = Requirements((BOUNDS[0],), (-0.5, 0.5))
    (group,) = groups(APPENDIX_4, needed)
    gauge = Gauge(CENTERED, (True, True, False))
    part = nearest_violation(group, gauge, 1.5, 0.005, Control(60.0))
    monkeypatch.setattr("paminsa_viz.synthesis.proof.bisection.symmetry", lambda *_: NONE)
    whole = nearest_violation(group, gauge, 1.5, 0.005, Control(60.0))
    assert symmetry(group, CENTERED).any
    assert part.lower == pytest.approx(whole.lower, abs=0.006)
    assert part.lower <= whole.upper
    assert whole.lower <= part.upper
    assert part.boxes < 0.4 * whole.boxes


@pytest.mark.parametrize("family", FAMILIES, ids=lambda family: next(iter(family.keys)))
def test_values_that_decide_a_proof_are_those_of_the_maps(family: Family) -> None:
    geometry = replace(APPENDIX_4.geometry, base_radius=0.33)
    design = replace(APPENDIX_4, geometry=geometry, load=LoadCase(force_x=6.0, force_z=-15.0))
    grid = Grid.over((0.0, 0.0, 0.2, -0.5), x=np.linspace(-0.1, 0.12, 5), y=np.linspace(0, 0.1, 4))
    field, found = solve_field(geometry, grid), family.values(design, grid.poses().reshape(-1, 4))
    assert found.keys() >= family.keys.keys()
    for key in family.keys:
        wanted = QUANTITIES[key].over(field, design).ravel()
        np.testing.assert_allclose(found[key], wanted, rtol=1e-9, err_msg=key)


def test_no_more_than_8192_boxes_are_bounded_at_a_time(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of requirements of which nothing is ever known; the nearest boxes come first."""
    (group,) = groups(APPENDIX_4, Requirements(BOUNDS[:1], (-0.5, 0.6)))
    gauge = Gauge(CENTERED, (True, True, False))
    counts: list[int] = []

    def unknown(self: Any, middle: Any, half: Any) -> Any:
        counts.append(len(middle))
        return np.full((len(middle), 1), -1.0)

    monkeypatch.setattr(BoundGroup, "margins", unknown)
    monkeypatch.setattr(bisection, "_broken", lambda *_: None)
    control = Control(60.0, lambda done: sum(counts) > 30_000)
    found = nearest_violation(group, gauge, 1.0, 0.01, control)
    assert counts[:3] == [1, 2, 4]
    assert max(counts) == counts[-1] == 8192
    assert found.boxes == sum(counts)
    assert found.lower < 0.01


def test_the_lowest_value_is_looked_for_at_the_same_poses_in_every_version() -> None:
    seen: list[Any] = []
    lowest(lambda poses: seen.append(poses) or poses[:, 0], CENTERED)
    drawn = np.random.default_rng(15).uniform(-1.3, 1.3, (4096, 4))
    np.testing.assert_allclose(seen[0], from_unit(CENTERED, drawn), atol=1e-12)
