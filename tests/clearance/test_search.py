"""The search over bodies: bounds that hold, solids where they are placed, and nothing left out."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from paminsa_viz.clearance import clearance, group_clearance, kernels, pair_clearance, shapes_of
from paminsa_viz.clearance.clearance import _placements
from paminsa_viz.clearance.nearest import convex_solid
from paminsa_viz.clearance.search import (
    box_gap,
    box_gaps,
    place_box,
    place_frames,
    place_rod,
    place_solid,
    rod_distance,
    rod_gap,
)
from paminsa_viz.clearance.shapes import FRAMES, arrays_of
from paminsa_viz.clearance.solids import WORLD, Body, BodyPart, capsule
from paminsa_viz.dimensions.placement import BODIES
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import APPENDIX_4, Counterweight, Design, KneeBranch, Payload
from tests.clearance.pairs_of_solids import KINDS, may_meet, outside, random_solid
from tests.support.samples import random_poses, with_knee

LOADED = replace(
    APPENDIX_4,
    payload=Payload(mass=3.0),
    counterweights=(Counterweight("b8", 8, 0.2, 2.0), Counterweight("b4", 9, -0.1, 1.0)),
)
RNG = np.random.default_rng(7)
TURNS = Rotation.random(40, random_state=7).as_matrix()
PLACES = RNG.uniform(-0.5, 0.5, (40, 3))
FRAMES_OF_SOLIDS = np.concatenate([TURNS.reshape(40, 9), PLACES], axis=1)


@pytest.fixture(autouse=True)
def compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kernels, "least_distances", lambda _: kernels.compiled())


def gap_of_segments(a: Array, b: Array) -> float:
    """Least distance of two segments (2, 3): that of lines where it is within both, or of ends."""

    def to_segment(point: Array, ends: Array) -> float:
        along = ends[1] - ends[0]
        share = np.clip((point - ends[0]) @ along / max(along @ along, 1e-300), 0.0, 1.0)
        return float(np.linalg.norm(point - ends[0] - share * along))

    found = [to_segment(p, b) for p in a] + [to_segment(p, a) for p in b]
    matrix = np.stack([a[1] - a[0], b[0] - b[1]], axis=1)
    shares, _, rank, _ = np.linalg.lstsq(matrix, b[0] - a[0])
    if rank == 2 and (shares >= 0).all() and (shares <= 1).all():
        found.append(float(np.linalg.norm(matrix @ shares - (b[0] - a[0]))))
    return min(found)


@pytest.mark.slow
def test_the_gap_of_rods_is_that_of_their_segments_less_their_radii() -> None:
    rods = RNG.uniform(-1.0, 1.0, (40, 7))
    rods[:, 6] = np.abs(rods[:, 6])
    rods[10:20, 3:6] = rods[10:20, :3] + 0.05 * rods[10:20, 3:6]  # short
    rods[20:24, 3:6] = rods[20:24, :3]  # balls
    rods[24:32, 3:6] = rods[24:32, :3] + RNG.uniform(-2, 2, (8, 1)) * [1.0, 0.0, 0.0]  # parallel
    rods[36:, 3:6] = rods[36:, :3] + 1e-4 * rods[36:, 3:6]  # very short
    rods[32:36, :6] = np.array(rods[32:36, :6] > 0, float)  # corners of a cube: some meet
    for i, j in product(range(40), repeat=2):
        expected = gap_of_segments(rods[i, :6].reshape(2, 3), rods[j, :6].reshape(2, 3))
        found = rod_gap(rods, i, rods, j) + rods[i, 6] + rods[j, 6]
        assert found == pytest.approx(expected, abs=1e-7), (i, j)


@pytest.mark.parametrize("kind", KINDS)
def test_the_gap_of_a_rod_and_a_solid_is_the_least_of_its_places(kind: str) -> None:
    solid = random_solid(kind, np.random.default_rng(3))
    body = Body("a", "a", WORLD, BodyPart.FRAME, 0, (solid,))
    convex = convex_solid(arrays_of((body,)), 0)
    rods = RNG.uniform(-0.6, 0.6, (40, 7))
    rods[:, 6] = np.abs(rods[:, 6])
    rods[:5, 3:6] = 2 * PLACES[:5] - rods[:5, :3]  # through the middle of the solid
    share = np.linspace(0.0, 1.0, 2001)[:, None]
    inside = 0
    for i, (rod, turn, place) in enumerate(zip(rods, TURNS, PLACES, strict=True)):
        found = rod_distance(rods, i, convex, FRAMES_OF_SOLIDS[i])
        along = (1 - share) * rod[:3] + share * rod[3:6]
        core = solid if kind != "capsule" else replace(solid, radius=0.0)
        least = float(outside(core, (along - place) @ turn).min())
        if found == -np.inf:
            inside += 1
            assert least < 1e-3
        else:
            assert found + solid.radius + rod[6] == pytest.approx(least, abs=1e-3)
            assert found + solid.radius + rod[6] < least + 1e-12
    assert inside > 0


def test_gaps_of_upright_boxes_are_the_largest_along_an_axis() -> None:
    low = RNG.uniform(-1.0, 1.0, (12, 3))
    boxes = np.concatenate([low, low + RNG.uniform(0.0, 0.6, (12, 3))], axis=1)
    gaps = np.empty((12, 12))
    box_gaps(boxes.T, gaps)
    low, high = boxes[:, :3], boxes[:, 3:]
    apart = np.maximum(low[:, None] - high, low - high[:, None]).max(axis=-1)
    np.testing.assert_array_equal(gaps, apart)
    one_by_one = [[box_gap(boxes, i, boxes, j) for j in range(12)] for i in range(12)]
    np.testing.assert_array_equal(one_by_one, apart)


def test_solids_boxes_and_rods_are_placed_with_their_frames() -> None:
    turn, place = TURNS[0], PLACES[0]
    frame = FRAMES_OF_SOLIDS[0]
    own, center = TURNS[1], PLACES[1]
    placed = np.empty(12)
    place_solid(FRAMES_OF_SOLIDS[1], frame, placed)
    np.testing.assert_allclose(placed[:9].reshape(3, 3), turn @ own, atol=1e-15)
    np.testing.assert_allclose(placed[9:], turn @ center + place, atol=1e-15)
    rods, out = RNG.uniform(-1.0, 1.0, (3, 7)), np.empty((3, 7))
    half = RNG.uniform(0.1, 1.0, (3, 3))
    boxes = np.empty((3, 6))
    corners = np.array(list(product((-1, 1), repeat=3)))
    for i in range(3):
        place_rod(rods, i, frame, out)
        place_box(rods[:, :3], half, i, frame, boxes)
        ends = rods[i, :6].reshape(2, 3) @ turn.T + place
        np.testing.assert_allclose(out[i], [*ends.ravel(), rods[i, 6]], atol=1e-15)
        points = (rods[i, :3] + corners * half[i]) @ turn.T + place
        expected = [*points.min(axis=0), *points.max(axis=0)]
        np.testing.assert_allclose(boxes[i], expected, atol=1e-14)


def test_frames_are_those_of_the_quaternions_and_finite_if_all_numbers_are() -> None:
    turns = Rotation.random(5, random_state=3)
    position, wxyz = RNG.normal(size=(5, 3)), turns.as_quat(scalar_first=True)
    frames = np.empty((5, 12))
    assert place_frames(position, wxyz, frames)
    np.testing.assert_allclose(frames[:, :9].reshape(5, 3, 3), turns.as_matrix(), atol=1e-15)
    np.testing.assert_array_equal(frames[:, 9:], position)
    for values, columns in ((position, 3), (wxyz, 4)):
        for row, column in product((0, 4), range(columns)):
            kept = values[row, column]
            values[row, column] = np.nan
            assert not place_frames(position, wxyz, frames)
            values[row, column] = kept
    assert place_frames(position, wxyz, frames)


def distances_of_solids(design: Design, pose: Array) -> list[float]:
    """Distance of each pair of bodies in a pose, from those of all their solids, one by one."""
    shapes = shapes_of(design)
    solids = [(body, solid) for body in shapes.bodies for solid in body.solids]
    number = {(id(body), id(solid)): i for i, (body, solid) in enumerate(solids)}
    alone = tuple(
        Body(str(i), "", body.frame, BodyPart.FRAME, 0, (solid,))
        for i, (body, solid) in enumerate(solids)
    )
    arrays, position, quaternion = arrays_of(alone), *_placements(design, pose[None])
    kinds, search = [], kernels.compiled()
    for pair, (i, j) in enumerate(shapes.pairs):
        one, other = shapes.bodies[i], shapes.bodies[j]
        kinds += [
            (pair, number[id(one), id(a)], number[id(other), id(b)])
            for a, b in product(one.solids, other.solids)
            if may_meet(one, a, other, b)
        ]
    least = np.full(len(shapes.pairs), np.inf)
    for start in range(0, len(kinds), 400):
        pair, first, second = np.array(kinds[start : start + 400]).T
        n = len(pair)
        distance, nearest = np.empty((1, n)), np.empty((1, n), np.int64)
        search(
            arrays, position, quaternion, first.copy(), second.copy(), np.arange(n),
            distance, nearest, np.empty((1, n, 6)),
        )  # fmt: skip
        np.minimum.at(least, pair, distance[0])
    return least.tolist()


@pytest.mark.slow
@pytest.mark.parametrize("knee", list(KneeBranch))
def test_the_distance_of_bodies_is_the_least_of_their_solids(knee: KneeBranch) -> None:
    """Whatever the search leaves out, it is not the nearest; pins and layers aside."""
    design = with_knee(LOADED, knee)
    for pose in random_poses(np.random.default_rng(2), design, 2):
        expected = np.array(distances_of_solids(design, pose))
        found = pair_clearance(design, pose)
        apart = expected > 0
        assert apart.any()
        assert (~apart).any()
        np.testing.assert_allclose(found[apart], expected[apart], atol=1e-12)
        assert (found[~apart] <= 0).all()


def test_of_solids_of_a_body_that_are_as_near_the_first_one_is_kept() -> None:
    """And of two bodies that are as near, the first pair."""
    balls = [capsule([x, 0.0, 0.0], [x, 0.0, 0.0], 0.25) for x in (-1.0, 1.0)]
    bodies = tuple(
        Body(name, name, frame, BodyPart.FRAME, 0, solids)
        for name, frame, solids in zip("abc", BODIES, (tuple(balls), *((ball,) for ball in balls)),
                                       strict=False)
    )  # fmt: skip
    place, level = np.zeros((1, 4, 3)), np.tile([1.0, 0.0, 0.0, 0.0], (1, 4, 1))
    place[0, 1], place[0, 2] = (1.0, 0.0, 0.0), (-1.0, 0.0, 0.0)  # both are in the middle
    first, second = np.array([0, 0, 1]), np.array([1, 2, 2])
    distance, nearest = np.empty((1, 2)), np.empty((1, 2), np.int64)
    points = np.empty((1, 2, 6))
    arrays = arrays_of(bodies)
    kernels.compiled()(
        arrays, place, level, first, second, np.array([0, 0, 1]), distance, nearest, points
    )
    assert distance.tolist() == [[0.5, -0.5]]
    assert nearest.tolist() == [[0, 2]]
    assert points[0, 0].tolist() == [-0.75, 0.0, 0.0, -0.25, 0.0, 0.0]


@pytest.mark.slow
def test_poses_of_a_batch_do_not_depend_on_each_other() -> None:
    """The pair that was the nearest before comes first, and what stands still is placed once."""
    given = random_poses(np.random.default_rng(4), LOADED, 12)
    given[[3, 7], 0] = 5.0
    found = clearance(LOADED, given)
    groups, pairs = group_clearance(LOADED, given), pair_clearance(LOADED, given)
    for i, pose in enumerate(given):
        alone = clearance(LOADED, pose)
        np.testing.assert_array_equal(alone.least, found.least[i])
        np.testing.assert_array_equal(alone.pair, found.pair[i])
        np.testing.assert_array_equal(alone.points, found.points[i])
        np.testing.assert_array_equal(group_clearance(LOADED, pose), groups[i])
        np.testing.assert_array_equal(pair_clearance(LOADED, pose), pairs[i])
    assert np.isnan(found.points[3]).all()


def test_nearest_points_are_on_the_bodies_and_as_far_apart_as_the_clearance() -> None:
    given = random_poses(np.random.default_rng(6), APPENDIX_4, 20)
    shapes = shapes_of(APPENDIX_4)
    for group in set(shapes.groups):
        found = clearance(APPENDIX_4, given, [group])
        position, quaternion = _placements(APPENDIX_4, given)
        apart = found.least > 0
        spread = np.linalg.norm(found.points[:, 1] - found.points[:, 0], axis=1)
        np.testing.assert_allclose(spread[apart], found.least[apart], atol=1e-12)
        for n in np.flatnonzero(apart):
            for point, index in zip(found.points[n], shapes.pairs[found.pair[n]], strict=True):
                body = shapes.bodies[index]
                frame = FRAMES.index(body.frame)
                turn = Rotation.from_quat(quaternion[n, frame], scalar_first=True)
                local: Any = turn.inv().apply(point - position[n, frame])
                assert min(outside(solid, local) for solid in body.solids) < 1e-12
