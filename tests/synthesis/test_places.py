"""Where a region of free center goes, and the worst pose of one, against brute force."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.model import APPENDIX_4
from paminsa_viz.quantities.requirements import Requirement, Requirements, WorkspaceShape
from paminsa_viz.synthesis.proof.certificate import sample_requirement
from paminsa_viz.synthesis.proof.placement import CenterSearch
from paminsa_viz.synthesis.proof.regions import FIRST, Growth, PoseRegion, from_unit, lowest

CENTER, HALF, THETA = (0.02, -0.03, -0.55), (0.1, 0.2, 0.15), (-0.1, 0.3)


def region(shape: WorkspaceShape) -> PoseRegion:
    half = (0.1, 0.1, 0.15) if shape is WorkspaceShape.CYLINDER else HALF
    return PoseRegion(shape, CENTER, half, THETA)


def search(
    shape: WorkspaceShape, growth: Growth, side: float | None, broken: Any, end: float = 0.0
) -> Any:
    made: Any = CenterSearch.__new__(CenterSearch)
    made._region, made._grows = region(shape), growth.axes
    made._side, made._end = side, end
    made._broken = np.array(broken, float).reshape(-1, 3)
    return made


@pytest.mark.parametrize("shape", WorkspaceShape)
@pytest.mark.parametrize("growth", Growth)
def test_the_largest_region_about_a_center_holds_no_broken_position(
    shape: WorkspaceShape, growth: Growth
) -> None:
    rng = np.random.default_rng(3)
    broken = rng.uniform(-0.5, 0.5, (200, 3))
    centers = rng.uniform(-0.2, 0.2, (20, 3))
    found = search(shape, growth, None, broken)._scales(centers)
    for center, scale in zip(centers, found, strict=True):
        grown = np.where(growth.axes, np.array(region(shape).half), np.inf)
        kept = np.where(growth.axes, np.inf, np.array(region(shape).half))
        away = np.abs(broken - center)

        def size(half: np.ndarray, away: np.ndarray = away) -> np.ndarray:
            share = away / half
            plan = np.hypot(*share[:, :2].T)
            if shape is WorkspaceShape.BOX:
                plan = share[:, :2].max(axis=1)
            return np.maximum(plan, share[:, 2])

        assert scale == pytest.approx(size(grown)[size(kept) <= 1.0].min(initial=np.inf))
    assert np.isfinite(found).any()


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_region_stays_on_the_side_of_home(side: float) -> None:
    """It may end where that side does, and goes no farther."""
    box, half = WorkspaceShape.BOX, HALF[2]
    heights = -side * np.array([half, 2.0 * half, 0.5 * half, -0.1])
    centers = np.array([[0.0, 0.0, z] for z in heights])
    grown = search(box, Growth.ALL, side, [])._scales(centers)
    assert grown == pytest.approx([1.0, 2.0, 0.5, 0.0])
    kept = search(box, Growth.HORIZONTAL, side, [[0.05, 0.0, z] for z in heights])
    assert kept._scales(centers) == pytest.approx([0.5, 0.5, 0.0, 0.0])
    moved = search(box, Growth.ALL, side, [], 0.7)._scales(np.add(centers, [0.0, 0.0, 0.7]))
    assert moved == pytest.approx([1.0, 2.0, 0.5, 0.0])
    assert np.isinf(search(box, Growth.ALL, None, [])._scales(centers)).all()


@pytest.mark.parametrize("shape", WorkspaceShape)
def test_the_lowest_value_is_found_inside_and_at_the_ends(shape: WorkspaceShape) -> None:
    part = region(shape)
    seen: list[np.ndarray] = []

    def value(poses: np.ndarray) -> np.ndarray:
        seen.append(poses)
        return np.linalg.norm(poses - inside, axis=1)

    inside = np.array([0.05, -0.05, 0.12, -0.5])
    pose, least = lowest(value, part)
    assert pose == pytest.approx(inside, abs=1e-4)
    assert least == pytest.approx(np.linalg.norm(pose - inside))
    # of the first poses some 23 % are at an end of each range: 1 - 1/1.3
    first = seen[0]
    assert len(first) == FIRST
    for column, (low, high) in ((2, THETA), (3, (CENTER[2] - 0.15, CENTER[2] + 0.15))):
        for end in (low, high):
            share = np.mean(np.abs(first[:, column] - end) < 1e-12)
            assert share == pytest.approx(0.5 * (1 - 1 / 1.3), abs=0.02)
    # then about the best, nearer and nearer, at the same poses in every version
    rng = np.random.default_rng(15)
    unit = 1.3 * rng.uniform(-1.0, 1.0, (4096, 4))
    np.testing.assert_array_equal(first, from_unit(part, unit))
    for turn, near in enumerate(seen[1:]):
        best = np.argsort(np.linalg.norm(from_unit(part, unit) - inside, axis=1))[:32]
        drawn = np.clip(np.repeat(unit[best], 32, axis=0), -1.0, 1.0)
        drawn = drawn + 0.3 * 0.6**turn * rng.normal(size=drawn.shape)
        np.testing.assert_allclose(near, from_unit(part, drawn), atol=1e-12)
        unit = np.concatenate([unit[best], drawn])
    assert len(seen) == 1 + 24
    inside = np.array([0.5, -0.5, 1.0, 0.0])
    pose, _ = lowest(value, part)
    assert pose[2:] == pytest.approx([THETA[1], CENTER[2] + 0.15], abs=1e-9)
    corner = np.array([0.1, -0.2])
    if shape is WorkspaceShape.CYLINDER:
        corner = 0.1 * np.array([0.48, -0.47]) / np.hypot(0.48, 0.47)
    assert pose[:2] == pytest.approx(np.array(CENTER[:2]) + corner, abs=1e-3)
    missing = lowest(lambda poses: np.where(poses[:, 0] > 0.1, np.nan, poses[:, 0]), part)
    assert missing[0][0] > 0.1
    assert missing[1] < -1e300


def test_numbers_from_minus_one_to_one_span_a_region() -> None:
    unit = np.array([[-1.0, -1.0, -1.0, -1.0], [1.0, 1.0, 1.0, 1.0], [0.0] * 4, [3.0, 0, -9, 2]])
    box = from_unit(region(WorkspaceShape.BOX), unit)
    assert box[0] == pytest.approx([-0.08, -0.23, -0.1, -0.7])
    assert box[1] == pytest.approx([0.12, 0.17, 0.3, -0.4])
    assert box[2] == pytest.approx([0.02, -0.03, 0.1, -0.55])
    assert box[3] == pytest.approx([0.12, -0.03, -0.1, -0.4])
    round_ = from_unit(region(WorkspaceShape.CYLINDER), unit)[:, :2] - CENTER[:2]
    assert np.hypot(*round_.T) == pytest.approx([0.1, 0.1, 0.0, 0.1])


@pytest.mark.parametrize("shape", WorkspaceShape)
def test_samples_of_what_cannot_be_proven_are_in_their_part(shape: WorkspaceShape) -> None:
    """With the ends of all ranges, and fewer of what takes long; none where no pose is meant."""
    bound = Requirement("stiffness_x", low=1.0, z=(-0.65, -0.2), theta=(0.0, 0.2))
    asked, part = Requirements((bound,), THETA), region(shape)
    poses, margins = sample_requirement(APPENDIX_4, asked, bound, part)
    assert len(poses) == len(margins) > 0
    away = poses[:, [0, 1]] - CENTER[:2]
    size = np.hypot(*away.T) / 0.1
    if shape is WorkspaceShape.BOX:
        size = np.abs(away / HALF[:2]).max(axis=1)
    assert size.max() == pytest.approx(1.0)
    for column, ends in ((2, (0.0, 0.2)), (3, (-0.65, -0.4))):
        assert (poses[:, column].min(), poses[:, column].max()) == pytest.approx(ends)
    made = SimpleNamespace(cost=1e-9, over=lambda field, _: np.zeros(field.grid.shape))
    quick = SimpleNamespace(**{**vars(bound), "entry": made})
    quick.margin = lambda values: values - 1.0  # broken, so that nothing is looked at more closely
    counts = []
    for cost in (1e-9, 1e-6, 1e-3):
        made.cost = cost
        counts.append(len(sample_requirement(APPENDIX_4, asked, quick, part)[0]))  # type: ignore
    assert counts[0] > counts[1] > counts[2] > 9
    elsewhere = Requirement("stiffness_x", low=1.0, z=(-0.3, -0.2))
    poses, margins = sample_requirement(APPENDIX_4, asked, elsewhere, part)
    assert (poses.shape, margins.shape) == ((0, 4), (0,))
