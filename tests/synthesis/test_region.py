"""The required poses in closed form against many of them; samples of a workspace."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.model import APPENDIX_4, check_reach, inverse_kinematics, measure_singularity
from paminsa_viz.quantities.requirements import Workspace, WorkspaceShape
from paminsa_viz.synthesis.search.extremes import Extent
from paminsa_viz.synthesis.search.region import (
    SPARSE,
    TRIAL,
    Density,
    center,
    extent,
    farthest,
    ray,
    reach_margins,
    sample,
    spans,
)
from tests.support.samples import random_design

SEEDS = st.integers(0, 10_000)
SHAPES = st.sampled_from(WorkspaceShape)


def workspace(shape: WorkspaceShape, seed: int, far: float = 0.1) -> Workspace:
    """A workspace near the z-axis or off it, of any proportions."""
    rng = np.random.default_rng(seed)
    width, depth, height = rng.uniform(0.05, 0.3, 3)
    depth = width if shape is WorkspaceShape.CYLINDER else depth
    x, y = rng.uniform(-far, far, 2)
    return Workspace(shape, (width, depth, height), (x, y, -0.6))


def positions(space: Workspace, seed: int, count: int = 4000) -> Any:
    """Positions in it, many of them on its outline and at its corners (n, 2)."""
    rng = np.random.default_rng(seed)
    unit = np.clip(rng.uniform(-1.5, 1.5, (count, 2)), -1.0, 1.0)
    if space.shape is WorkspaceShape.CYLINDER:
        turn = rng.uniform(0.0, 2 * np.pi, count)
        unit = np.stack([np.cos(turn), np.sin(turn)], axis=-1)
        unit *= np.sqrt(rng.uniform(0.0, 2.0, (count, 1))).clip(0.0, 1.0)
    x, y, _ = space.center
    return 0.5 * unit * space.size[:2] + [x, y]


@pytest.mark.slow
@given(shape=SHAPES, seed=SEEDS)
def test_extents_and_rays_are_those_of_many_positions(shape: WorkspaceShape, seed: int) -> None:
    space = workspace(shape, seed)
    at = positions(space, seed)
    size = max(space.size)
    assert farthest(space) == pytest.approx(np.hypot(*at.T).max(), abs=1e-2 * size)
    assert farthest(space) >= np.hypot(*at.T).max() - 1e-12
    for turn in np.random.default_rng(seed).uniform(0.0, 2 * np.pi, 4):
        direction = np.array([np.cos(turn), np.sin(turn)])
        most = (at @ direction).max()
        assert most - 1e-12 <= extent(space, direction) <= most + 1e-2 * size
        found = ray(space, direction)
        off = np.abs(np.array(space.center[:2], float)) if shape is WorkspaceShape.BOX else None
        half = 0.5 * np.array(space.size[:2])
        inside = (off <= half).all() if off is not None else np.hypot(*space.center[:2]) <= half[0]
        assert (found > 0) == inside
        if inside:
            middle = np.array(space.center[:2], float)
            for share, within in ((0.999, True), (1.001, False)):
                away = np.abs(share * found * direction - middle)
                out = np.hypot(*away) / half[0] if off is None else (away / half).max()
                assert (out <= 1.0) == within
    assert ray(replace(space, center=(1.0, 0.0, -0.6)), np.array([1.0, 0.0])) == 0.0
    assert ray(replace(space, center=(0.0, -1.0, -0.6)), np.array([0.0, -1.0])) == 0.0


@pytest.mark.slow
@given(shape=SHAPES, seed=SEEDS)
def test_margins_of_reach_are_the_least_of_many_poses(shape: WorkspaceShape, seed: int) -> None:
    """None is smaller, and one is hardly larger; each robot at a height of its own."""
    rng = np.random.default_rng(seed + 99_999)
    designs = [random_design(np.random.default_rng(seed + i)) for i in range(2)]
    designs = [designs[0], designs[1].with_knee(designs[0].geometry.knee)]
    geometries = [design.geometry for design in designs]
    first = workspace(shape, seed, 0.2)
    spaces = [
        replace(first, center=(*first.center[:2], z * g.knee.sign * -1))
        for z, g in zip((0.5, 0.7), geometries, strict=True)
    ]
    start = rng.uniform(-1.5, 1.5)
    theta = (start, start + rng.uniform(0.0, 1.5))
    found = spans(geometries, spaces, theta)
    margins = reach_margins(geometries, found)
    at = positions(first, seed, 10_000)
    turn = theta[0] + (theta[1] - theta[0]) * rng.uniform(-0.5, 1.5, len(at)).clip(0.0, 1.0)
    for row, (geometry, space) in enumerate(zip(geometries, spaces, strict=True)):
        z = space.center[2] + 0.5 * space.size[2] * np.clip(rng.uniform(-2, 2, len(at)), -1, 1)
        pose = np.column_stack([at, turn, z])
        least = check_reach(geometry, pose).margins.min(axis=(0, 1))
        assert (least >= margins[row] - 1e-9).all()
        assert least == pytest.approx(margins[row], abs=5e-3)
        solved = inverse_kinematics(geometry, pose)
        above = (geometry.knee.sign * solved.points[5][..., 2]).max()
        assert above == pytest.approx(found.beyond[row], abs=1e-9)


def test_finer_samples_hold_the_coarse_ones() -> None:
    assert Density(6, 3, 3, 5).finer(3) == Density(18, 7, 7, 13)
    box = workspace(WorkspaceShape.BOX, 1)
    for space in (box, workspace(WorkspaceShape.CYLINDER, 1)):
        coarse, fine = (sample(space, (-0.3, 0.4), d) for d in (TRIAL, TRIAL.finer(2)))
        for name in ("theta", "share"):
            few, many = getattr(coarse, name), getattr(fine, name)
            assert np.isclose(few[:, None], many).any(axis=1).all()
        assert (coarse.theta[0], coarse.theta[-1]) == (-0.3, 0.4)
        assert (coarse.share[0], coarse.share[-1]) == (-0.5, 0.5)
        outline = fine.within[: 3 * TRIAL.finer(2).around]
        gap = np.linalg.norm(coarse.within[:, None] - fine.within, axis=-1).min(axis=1)
        assert gap[: 3 * TRIAL.around].max() < 1e-9
        size = np.abs(outline).max(axis=1) if space is box else np.hypot(*outline.T)
        assert size == pytest.approx(1.0)
        assert coarse.poses == len(coarse.within) * len(coarse.theta) * len(coarse.share)
        placed = coarse.place(coarse.within, space)
        assert placed.mean(axis=0) == pytest.approx(space.center[:2], abs=0.02)
        half = 0.5 * np.array(space.size[:2])
        assert np.abs(placed - space.center[:2]).max(axis=0) == pytest.approx(half, rel=0.02)


@pytest.mark.parametrize("theta", [(-0.4, 0.4), (0.0, 0.4), (0.2, 0.2)])
def test_poses_that_are_alike_are_left_out_and_no_others(theta: tuple[float, float]) -> None:
    """The largest condition number over the whole workspace is that of the part."""
    centered = Workspace(WorkspaceShape.CYLINDER, (0.2, 0.2, 0.2), (0.0, 0.0, -0.6))
    geometry = APPENDIX_4.geometry
    spaces = (centered, *(replace(centered, center=(*xy, -0.6)) for xy in ((0, 0.02), (0.03, 0))))
    for space in spaces:
        few, every = (sample(space, theta, SPARSE, alike=alike) for alike in (True, False))
        mirrored = theta[0] < 0 and space.center[0] == 0.0
        assert (few.poses < every.poses) == (mirrored or space is centered)
        assert (len(few.within) < len(every.within)) == (space is centered)
        worst = []
        for found in (few, every):
            at = found.place(found.within, space)
            pose = np.zeros((len(found.theta), len(at), 4))
            pose[..., :2], pose[..., 2], pose[..., 3] = at, found.theta[:, None], -0.6
            worst.append(measure_singularity(geometry, pose).condition.max())
        assert worst[0] == pytest.approx(worst[1], rel=1e-9)
        assert len(few.theta) == (1 if theta[0] == theta[1] else 2 if mirrored else 3)
    np.testing.assert_allclose(
        every.turns, np.transpose([np.cos(every.theta), np.sin(every.theta)])
    )


@pytest.mark.parametrize("around", [1, 4, 5, 12])
@pytest.mark.parametrize("shape", list(WorkspaceShape))
def test_positions_are_on_outlines_at_even_distances(shape: WorkspaceShape, around: int) -> None:
    """As many for each leg on the outer one, one toward each leg; half as many on those within."""
    density = Density(around, 4, 3, 2)
    found = sample(workspace(shape, 1), (-0.3, 0.4), density)
    size = np.abs(found.within).max(axis=1)
    if shape is WorkspaceShape.CYLINDER:
        size = np.hypot(*found.within.T)
    levels, counts = np.unique(size.round(9), return_counts=True)
    assert levels == pytest.approx([0.0, 1 / 3, 2 / 3, 1.0])
    expected = [3 * max(1, around // 2)] * 2 + [3 * around]
    if shape is WorkspaceShape.BOX:  # as many on each side, its end included
        expected = [4 * max(1, count // 4) for count in expected]
    assert counts.tolist() == [1, *expected]
    for level, count in zip(levels[1:], expected, strict=True):
        outline = found.within[np.isclose(size, level)]
        if shape is WorkspaceShape.BOX:
            for corner in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
                assert np.isclose(outline, level * np.array(corner)).all(axis=1).sum() == 1
            steps = np.abs(np.roll(outline, -1, axis=0) - outline)
            assert steps.max(axis=1) == pytest.approx(np.full(count, 8 * level / count))
            assert steps.min(axis=1).max() < 1e-9
        else:
            angle = np.sort(np.arctan2(outline[:, 1], outline[:, 0]) % (2 * np.pi))
            assert np.diff(angle) == pytest.approx(np.full(count - 1, 2 * np.pi / count))
            for leg in np.radians([90.0, 210.0, 330.0]):
                assert np.abs(angle - leg).min() < 1e-9


@pytest.mark.parametrize("headings", [1, 2, 3, 4, 5])
def test_headings_that_are_the_same_to_both_sides_are_those_of_one(headings: int) -> None:
    space = Workspace(WorkspaceShape.BOX, (0.2, 0.2, 0.2), (0.0, 0.0, -0.6))
    density = Density(4, 2, headings, 2)
    found = sample(space, (-0.4, 0.4), density, alike=True).theta
    assert found == pytest.approx(np.linspace(0.0, 0.4, max(2, (headings + 1) // 2)))
    for theta, alike in (((-0.4, 0.4), False), ((-0.4, 0.3), True), ((0.1, 0.4), True)):
        every = sample(space, theta, density, alike=alike).theta
        assert every == pytest.approx(np.linspace(*theta, headings))


def test_a_center_that_is_not_given_is_the_axis() -> None:
    free = Workspace(WorkspaceShape.BOX, (0.2, 0.4, 0.2), (None, None, None))
    assert center(free).tolist() == [0.0, 0.0]
    assert center(replace(free, center=(0.1, -0.2, None))).tolist() == [0.1, -0.2]
    assert farthest(free) == pytest.approx(np.hypot(0.1, 0.2))
    level = Extent(replace(free, center=(0.0, 0.0, 0.0)), (-0.1, 0.1))
    assert level.heights == pytest.approx((-0.1, 0.1))


@given(shape=SHAPES, seed=SEEDS)
def test_poses_outside_move_to_the_boundary_and_others_stay(
    shape: WorkspaceShape, seed: int
) -> None:
    space = workspace(shape, seed)
    own = Extent(space, (-0.2, 0.3))
    rng = np.random.default_rng(seed)
    inside = np.column_stack([
        positions(space, seed, 200), rng.uniform(-0.2, 0.3, 200),
        -0.6 + space.size[2] * rng.uniform(-0.5, 0.5, 200),
    ])  # fmt: skip
    np.testing.assert_allclose(own.clipped(inside), inside, atol=1e-15)
    anywhere = inside + rng.normal(size=(200, 4)) * 0.3
    found = own.clipped(anywhere)
    np.testing.assert_allclose(own.clipped(found), found, atol=1e-12)
    middle, half = np.array([*space.center[:2], 0.05, -0.6]), 0.5 * np.array(space.size)
    off = np.abs(found - middle)
    assert (off - [half[0], half[1], 0.25, half[2]]).max() <= 1e-12
    if shape is WorkspaceShape.CYLINDER:
        assert (np.hypot(off[:, 0], off[:, 1]) <= half[0] + 1e-12).all()
    # convex, so that the nearest place is the one from which nothing inside is toward the pose
    for part in (slice(0, 2), slice(2, 3), slice(3, 4)):
        away = (anywhere - found)[:, None, part]
        toward = inside[None, :, part] - found[:, None, part]
        assert (np.sum(away * toward, axis=-1) <= 1e-12).all()


@pytest.mark.parametrize("shape", list(WorkspaceShape))
def test_samples_and_random_poses_fill_the_workspace(shape: WorkspaceShape) -> None:
    space = workspace(shape, 3)
    own = Extent(space, (-0.2, 0.3))
    assert own.heights == pytest.approx((-0.6 - space.size[2] / 2, -0.6 + space.size[2] / 2))
    drawn = own.random(20_000, seed=1)
    np.testing.assert_allclose(own.clipped(drawn), drawn, atol=1e-12)
    share = (drawn[:, [0, 1, 3]] - np.array([*space.center[:2], -0.6])) / np.array(space.size)
    turned = (drawn[:, 2] + 0.2) / 0.5 - 0.5
    # second moments of a disc and of a box of width 1
    flat = 1 / 16 if shape is WorkspaceShape.CYLINDER else 1 / 12
    moments = (*(share**2).mean(axis=0), (turned**2).mean())
    assert moments == pytest.approx((flat, flat, 1 / 12, 1 / 12), rel=0.03)
    assert np.abs(share.mean(axis=0)).max() < 0.01
    found = own.samples(SPARSE)
    np.testing.assert_allclose(own.clipped(found), found, atol=1e-12)
    assert (found[:, 2].min(), found[:, 2].max()) == pytest.approx((-0.2, 0.3))
    assert (found[:, 3].min(), found[:, 3].max()) == pytest.approx(own.heights)
    half = 0.5 * np.array(space.size[:2])
    reach = np.abs(found[:, :2] - np.array(space.center[:2])).max(axis=0)
    assert reach == pytest.approx(half, rel=0.15)


def test_a_part_between_two_heights() -> None:
    own = Extent(workspace(WorkspaceShape.BOX, 4), (-0.2, 0.3))
    low, high = own.heights
    middle = 0.5 * (low + high)
    assert own.within(None) is own
    for asked, kept in (
        ((low - 1, high + 1), (low, high)), ((middle, 1.0), (middle, high)),
        ((-2.0, middle), (low, middle)),
    ):  # fmt: skip
        part = own.within(asked)
        assert part is not None
        assert part.heights == pytest.approx(kept)
        assert part.workspace.size[:2] == own.workspace.size[:2]
        assert part.workspace.center[:2] == own.workspace.center[:2]
        assert part.theta == own.theta
    for asked in ((high, high + 1), (low - 1, low), (middle, middle)):
        assert own.within(asked) is None
