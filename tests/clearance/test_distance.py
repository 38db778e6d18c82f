"""Distances of solids: proven by their supports, and equal to coal's."""

from __future__ import annotations

from itertools import combinations_with_replacement
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from paminsa_viz.clearance import nearest
from paminsa_viz.clearance.nearest import (
    BOX,
    CAPSULE,
    CYLINDER,
    PRISM,
    ConvexSolid,
    nearest_on_circle,
)
from paminsa_viz.clearance.solids import NO_CORNERS, Primitive, cylinder
from paminsa_viz.model.arrays import Array
from tests.clearance.coal_shapes import coal_request, coal_shape
from tests.clearance.pairs_of_solids import (
    KINDS,
    Found,
    distances,
    extent,
    outside,
    random_solid,
)

PAIRS = list(combinations_with_replacement(KINDS, 2))
POSES = 1000
"""Places of each pair; with ten pairs 10^4 in all."""


def placed(rng: np.random.Generator, poses: int = POSES) -> tuple[Array, Array, Array]:
    """Draw places of two solids: (n, 2, 3), quaternions (n, 2, 4), rotations (n, 2, 3, 3)."""
    turn = Rotation.random(2 * poses, random_state=np.random.RandomState(rng.integers(2**31)))
    wxyz = turn.as_quat(scalar_first=True).reshape(poses, 2, 4)
    place = rng.uniform(-0.5, 0.5, (poses, 2, 3))
    return place, wxyz, turn.as_matrix().reshape(poses, 2, 3, 3)


def certified_gap(
    one: Primitive, other: Primitive, place: Array, rotation: Array, found: Found
) -> Array:
    """Return by how much distances exceed what a plane between the solids proves, (n,) [m].

    No two convex solids are nearer than the gap between two parallel planes that part them.
    """
    along = found.points[:, 1] - found.points[:, 0]
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    far = extent(one, rotation[:, 0], place[:, 0], along)
    near = -extent(other, rotation[:, 1], place[:, 1], -along)
    return found.distance - (near - far)


def in_frame(points: Array, rotation: Array, place: Array) -> Array:
    return np.einsum("nij,ni->nj", rotation, points - place)


def outside_of_both(
    solids: tuple[Primitive, Primitive], found: Found, place: Array, rotation: Array
) -> Array:
    """Return how far the best of the points found is from being common to both solids, (n,)."""
    candidates = (found.points[:, 0], found.points[:, 1], found.points.mean(axis=1))
    beyond = [
        [
            outside(solid, in_frame(points, rotation[:, i], place[:, i]))
            for i, solid in enumerate(solids)
        ]
        for points in candidates
    ]
    return np.max(beyond, axis=1).min(axis=0)


@pytest.mark.parametrize("kinds", PAIRS)
def test_distances_are_proven_by_parallel_planes(kinds: tuple[str, str]) -> None:
    rng = np.random.default_rng(PAIRS.index(kinds))
    one, other = (random_solid(kind, rng) for kind in kinds)
    place, wxyz, rotation = placed(rng)
    found = distances(one, other, place, wxyz)
    apart = found.distance > 0
    assert apart.sum() > POSES / 2
    spread = np.linalg.norm(found.points[:, 1] - found.points[:, 0], axis=1)
    assert spread[apart] == pytest.approx(found.distance[apart], abs=1e-12)
    assert (spread > -found.distance - 1e-12).all()
    proven = np.abs(certified_gap(one, other, place, rotation, found))
    # the direction between points that are close is known to fewer digits
    assert (proven < 1e-12 + 1e-15 / np.abs(found.distance))[apart].all()
    for i, solid in enumerate((one, other)):
        local = in_frame(found.points[:, i], rotation[:, i], place[:, i])
        assert outside(solid, local)[apart].max() < 1e-12


@pytest.mark.parametrize("kinds", PAIRS)
def test_an_overlap_is_one_and_its_depth_parts_the_solids(kinds: tuple[str, str]) -> None:
    rng = np.random.default_rng(PAIRS.index(kinds))
    one, other = (random_solid(kind, rng) for kind in kinds)
    place, wxyz, rotation = placed(rng)
    found = distances(one, other, 0.5 * place, wxyz)
    over = found.distance < 0
    assert over.sum() > 20
    assert outside_of_both((one, other), found, 0.5 * place, rotation)[over].max() < 1e-9
    depths = np.linalg.norm(found.points[:, 0] - found.points[:, 1], axis=1)
    assert depths[over] == pytest.approx(-found.distance[over], abs=1e-12)
    shifted = 0.5 * place
    shifted[:, 0] -= found.points[:, 0] - found.points[:, 1]
    assert distances(one, other, shifted, wxyz).distance[over].min() > -1e-9


@pytest.mark.parametrize("turn", [0.0, 0.1, np.pi / 2])
def test_long_cylinders_whose_axes_meet_are_parted_across_them(turn: float) -> None:
    """As joint 3 in joint 1: along the axis, or across one of two, the way would be longer."""
    one, other = cylinder(0.03, -0.3, 0.3), cylinder(0.02, -0.4, 0.4)
    place, wxyz = np.zeros((3, 2, 3)), np.empty((3, 2, 4))
    for row, axis in enumerate(np.eye(3)):  # axes along z, and horizontal
        first = Rotation.from_rotvec(0.5 * np.pi * axis)
        second = first * Rotation.from_rotvec([turn, 0.0, 0.0])
        wxyz[row] = [turned.as_quat(scalar_first=True) for turned in (first, second)]
    found = distances(one, other, place, wxyz)
    assert found.distance == pytest.approx(-0.05, abs=1e-12)
    shift = found.points[:, 0] - found.points[:, 1]
    assert np.linalg.norm(shift, axis=1) == pytest.approx(0.05, abs=1e-12)
    place[:, 0] -= shift
    assert np.abs(distances(one, other, place, wxyz).distance).max() < 1e-9


@pytest.mark.parametrize("kinds", PAIRS)
def test_distances_are_those_of_coal(kinds: tuple[str, str]) -> None:
    """Coal's iteration ends early, or fails, for some places of cylinders; most agree."""
    coal: Any = pytest.importorskip("coal")
    rng = np.random.default_rng(PAIRS.index(kinds))
    one, other = (random_solid(kind, rng) for kind in kinds)
    place, wxyz, rotation = placed(rng)
    found = distances(one, other, place, wxyz)
    request = coal_request()
    shapes = [coal_shape(solid) for solid in (one, other)]
    theirs = []
    for i in range(POSES):
        places = [coal.Transform3s(rotation[i, k], place[i, k]) for k in range(2)]
        result = coal.DistanceResult()
        theirs.append(coal.distance(shapes[0], places[0], shapes[1], places[1], request, result))
    error = np.abs(found.distance - np.array(theirs))
    if "cylinder" not in kinds:
        assert error.max() < 1e-9
    else:
        assert np.mean(error[found.distance > 0] < 1e-9) > 0.97


QUARTERS = st.integers(0, 3).map(lambda n: n * np.pi / 2)
STEPS = st.sampled_from([-0.3, -0.1, -0.05, 0.0, 0.05, 0.1, 0.3])


@given(
    st.sampled_from(PAIRS), st.integers(0, 3), st.tuples(STEPS, STEPS, STEPS),
    st.tuples(QUARTERS, QUARTERS, QUARTERS), st.sampled_from([0.0, 1e-12, 1e-9, 1e-6, 1e-3]),
)  # fmt: skip
def test_parallel_crossing_and_touching_solids(
    kinds: tuple[str, str], seed: int, place: tuple[float, ...], turns: tuple[float, ...],
    tilt: float,
) -> None:  # fmt: skip
    """Faces, edges and axes that are parallel or in one line, and nearly so."""
    rng = np.random.default_rng(seed)
    one, other = (_round_sizes(random_solid(kind, rng)) for kind in kinds)
    turn = Rotation.from_euler("xyz", np.array(turns) + tilt * np.array([1.0, 0.7, 0.3]))
    where = np.array([[(0.0, 0.0, 0.0), place]])
    wxyz = np.array([[(1.0, 0.0, 0.0, 0.0), turn.as_quat(scalar_first=True)]])
    rotation = np.array([[np.eye(3), turn.as_matrix()]])
    found = distances(one, other, where, wxyz)
    swapped = distances(other, one, where[:, ::-1], wxyz[:, ::-1])
    assert found.distance == pytest.approx(swapped.distance, abs=1e-9)
    if found.distance[0] > 1e-9:
        assert abs(certified_gap(one, other, where, rotation, found)[0]) < 1e-9
    else:
        assert outside_of_both((one, other), found, where, rotation)[0] < 1e-9


def _round_sizes(solid: Primitive) -> Primitive:
    """Return a solid whose sizes are multiples of 50 mm, so that faces and edges coincide."""
    size = np.maximum(np.round(solid.size / 0.05), 1.0) * 0.05
    radius = 0.05 if solid.kind == CAPSULE else 0.0
    if solid.kind == CAPSULE:
        size[:2] = 0.0
    if solid.kind == CYLINDER:
        size[1] = size[0]
    corners = solid.corners
    if len(corners):
        size[:2] = 0.1
        corners = np.array([(-0.1, -0.1), (0.1, -0.1), (0.1, 0.05), (0.05, 0.1), (-0.1, 0.1)])
    else:
        corners = NO_CORNERS
    return Primitive(solid.kind, size, radius, corners, np.eye(3), np.zeros(3))


def test_a_ball_and_a_bar_of_no_length() -> None:
    ball = Primitive(CAPSULE, np.zeros(3), 0.1, NO_CORNERS, np.eye(3), np.zeros(3))
    where = np.array([[(0.0, 0.0, 0.0), (0.5, 0.0, 0.0)], [(0.0, 0.0, 0.0), (0.0, 0.0, 0.0)]])
    upright = np.tile([1.0, 0.0, 0.0, 0.0], (2, 2, 1))
    assert distances(ball, ball, where, upright).distance == pytest.approx([0.3, -0.2])


def test_a_place_between_samples_may_be_nearer_than_the_nearest_sample() -> None:
    """A corner toward one sample of a circle, and a farther one between two others."""
    angle, radius = np.radians([0.0, 127.5, 250.0]), np.array([0.08, 0.0805, 0.07])
    corners = (radius * np.stack([np.cos(angle), np.sin(angle)])).T
    solid = ConvexSolid(PRISM, 0.08, 0.08, 0.01, 0.0, corners, 0, 3)
    found = nearest_on_circle(solid, 0.0, 0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 0.1, 0.0)
    assert found == pytest.approx((np.cos(angle[1]), np.sin(angle[1])))


def convex(kind: str, rng: np.random.Generator) -> ConvexSolid:
    """Return a random solid as the search has it, without a radius."""
    solid = random_solid(kind, rng)
    return ConvexSolid(solid.kind, *solid.size, 0.0, solid.corners, 0, len(solid.corners))


def circle(rng: np.random.Generator) -> list[float]:
    """Return center and two radii of a random circle."""
    radii = Rotation.random(random_state=rng.integers(2**31)).as_matrix()[:2]
    return [*rng.uniform(-0.5, 0.5, 3), *(10 ** rng.uniform(-2, -0.2) * radii).ravel()]


@pytest.fixture
def steps(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Return a list that grows by one with every step of a bracket."""
    found: list[int] = []
    narrowed = nearest._narrowed
    monkeypatch.setattr(nearest, "_narrowed", lambda *at: (found.append(1), narrowed(*at))[1])
    return found


def test_brackets_shrink_in_some_thirteen_steps(steps: list[int]) -> None:
    """Of segments past cylinders, and of circles about prisms; halving alone takes fifty each."""
    rng, searched = np.random.default_rng(0), 0
    for _ in range(60):
        before, radius, half = len(steps), *10 ** rng.uniform(-2, -0.4, 2)
        solid = ConvexSolid(CYLINDER, radius, radius, half, 0.0, NO_CORNERS, 0, 0)
        nearest.nearest_on_segment(solid, *rng.uniform(-0.5, 0.5, 3), *rng.uniform(-1, 1, 3))
        searched += len(steps) > before
    assert searched > 20
    assert len(steps) / searched < 12.8
    steps.clear()
    for _ in range(30):
        nearest_on_circle(convex("prism", rng), *circle(rng))
    assert len(steps) / 30 < 14.8


def test_brackets_shrink_along_faces_that_are_nearly_parallel(steps: list[int]) -> None:
    """There secants alone take 200 steps, which is the most, and halving every fifth time 150."""
    rng, most = np.random.default_rng(0), 0
    for kind in ("cylinder", "prism") * 50:
        solid, before = convex(kind, rng), len(steps)
        place = np.append(rng.uniform(-1.2, 1.2, 2) * solid.a, 1.5 * solid.c)
        along = rng.normal(size=3) * [1.0, 1.0, 1e-7]
        place[:2] -= along[:2] * rng.uniform(size=2)
        nearest.nearest_on_segment(solid, *place, *along)
        most = max(most, len(steps) - before)
    assert 100 < most < 145
    rng, most = np.random.default_rng(0), 0
    for _ in range(60):
        solid, radius = convex("cylinder", rng), 10 ** rng.uniform(-2, -0.2)
        before, (u, v) = len(steps), 1e-7 * radius * rng.normal(size=2)
        x, y = 1.2 * max(solid.a, 0.05) * rng.uniform(-1, 1, 2)
        nearest_on_circle(solid, x, y, 1.5 * solid.c, radius, 0.0, u, 0.0, radius, v)
        most = max(most, len(steps) - before)
    assert 100 < most < 140


@pytest.mark.parametrize("kind", KINDS)
def test_the_nearest_places_do_not_depend_on_the_unit_of_length(kind: str) -> None:
    """Not in a single bit, where the units are powers of two of each other."""
    rng = np.random.default_rng(4)
    for unit in (2.0**-20, 2.0**20) * 5:
        solid, around, along = convex(kind, rng), circle(rng), rng.uniform(-0.5, 0.5, 6)
        a, b, c = (unit * value for value in solid[1:4])
        other = solid._replace(a=a, b=b, c=c, corners=unit * solid.corners)
        found = nearest_on_circle(other, *(unit * value for value in around))
        assert found == nearest_on_circle(solid, *around)
        t = nearest.nearest_on_segment(other, *(unit * along))
        assert t == nearest.nearest_on_segment(solid, *along)


def test_of_places_that_are_as_near_the_first_one_is_kept() -> None:
    """A circle about a box that is a line, and a bar across the middle of a box."""
    long = ConvexSolid(BOX, 1.0, 0.0, 0.0, 0.0, NO_CORNERS, 0, 0)
    around = nearest_on_circle(long, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 2.0, 0.0)
    assert around == (1.0, 0.0)
    box, bar = (
        Primitive(BOX, np.array(half), 0.0, NO_CORNERS, np.eye(3), np.zeros(3))
        for half in ((0.25, 0.125, 0.0625), (0.5, 0.03125, 0.03125))
    )
    place = np.array([[[0.0, 0.0, 0.0], [0.0, 0.0, 0.5]]])
    found = distances(box, bar, place, np.tile([1.0, 0.0, 0.0, 0.0], (1, 2, 1)))
    assert found.distance[0] == 0.40625
    assert (found.points[0, :, 0] == -0.25).all()
