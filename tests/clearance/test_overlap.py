"""By how much solids overlap: the least of all shifts along the directions that can part them."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from paminsa_viz.clearance.distance import TOUCH, least_shift, solid_distance
from paminsa_viz.clearance.nearest import BOX, CAPSULE, CYLINDER, PRISM, ConvexSolid, convex_solid
from paminsa_viz.clearance.search import place_rod, rod_distance, rod_gap
from paminsa_viz.clearance.shapes import arrays_of
from paminsa_viz.clearance.solids import NO_CORNERS, WORLD, Body, BodyPart, Primitive
from paminsa_viz.model.arrays import Array
from tests.clearance.pairs_of_solids import KINDS, distances, extent, random_solid

BALL = ConvexSolid(CAPSULE, 0.0, 0.0, 0.0, 0.1, NO_CORNERS, 0, 0)


def normals_and_edges(solid: Primitive) -> tuple[Array, Array]:
    """Normals of a solid's faces and directions of its edges; its axis where it is round."""
    if solid.kind == BOX:
        return np.eye(3), np.eye(3)
    along = np.array([[0.0, 0.0, 1.0]])
    if solid.kind != PRISM:
        return along, along
    edges = np.insert(np.roll(solid.corners, -1, axis=0) - solid.corners, 2, 0.0, axis=1)
    return np.concatenate([along, np.cross(edges, along)]), np.concatenate([along, edges])


def shifts(solids: tuple[Primitive, ...], turns: Array, places: Array) -> tuple[Array, Array]:
    """All directions that are looked along (n, 3), both ways, and the shifts that part there."""
    (faces, edges), (other_faces, other_edges) = (
        [own @ turn.T for own in normals_and_edges(solid)]
        for solid, turn in zip(solids, turns, strict=True)
    )
    products = [np.cross(a, b) for a, b in product(edges, other_edges)]
    found = [*faces, *other_faces, *products]
    between = places[1] - places[0]
    for solid, turn in zip(solids, turns, strict=True):
        if solid.kind == CYLINDER:
            found.append(between - turn[:, 2] * (between @ turn[:, 2]))
    directions = np.array(found)
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    directions = np.concatenate([directions, -directions])
    n = len(directions)
    reach = [
        extent(solid, np.tile(turn, (n, 1, 1)), np.tile(place, (n, 1)), sign * directions)
        for solid, turn, place, sign in zip(solids, turns, places, (1, -1), strict=True)
    ]
    return directions, np.maximum(reach[0] + reach[1], 0.0)


@pytest.mark.parametrize("kinds", list(product(KINDS, repeat=2)))
def test_the_shift_is_the_least_along_all_directions(kinds: tuple[str, str]) -> None:
    rng = np.random.default_rng([*KINDS].index(kinds[0]) + 10 * [*KINDS].index(kinds[1]))
    for seed in range(4):
        solids = tuple(random_solid(kind, rng) for kind in kinds)
        cores = tuple(
            Primitive(s.kind, s.size, 0.0, s.corners, s.rotation, s.center) for s in solids
        )
        turns = Rotation.random(2, random_state=seed).as_matrix()
        places = rng.uniform(-0.5, 0.5, 3) + np.array([[0, 0, 0], rng.uniform(-0.05, 0.05, 3)])
        arrays = arrays_of(tuple(Body("", "", WORLD, BodyPart.FRAME, 0, (s,)) for s in solids))
        one, other = convex_solid(arrays, 0), convex_solid(arrays, 1)
        frames = [np.append(turn.ravel(), place) for turn, place in zip(turns, places, strict=True)]
        normal = np.zeros(3)
        found = least_shift(one, frames[0], other, frames[1], normal)
        directions, every = shifts(cores, turns, places)
        if set(kinds) == {"capsule"}:
            assert found == 0.0
            continue
        assert found == pytest.approx(every.min(), abs=1e-14)
        index = np.linalg.norm(directions - normal, axis=1).argmin()
        np.testing.assert_allclose(directions[index], normal, atol=1e-12)
        assert every[index] == pytest.approx(found, abs=1e-14)


@pytest.mark.parametrize("kinds", list(product(KINDS, repeat=2)))
def test_what_parts_capsules_about_solids_parts_the_solids(kinds: tuple[str, str]) -> None:
    """The distance is that of the solids, or that of a capsule in place of one if that is more."""
    rng = np.random.default_rng(20 + [*KINDS].index(kinds[0]) + 10 * [*KINDS].index(kinds[1]))
    one, other = (random_solid(kind, rng) for kind in kinds)
    arrays = arrays_of(tuple(Body("", "", WORLD, BodyPart.FRAME, 0, (s,)) for s in (one, other)))
    convex = [convex_solid(arrays, index) for index in range(2)]
    turn = Rotation.random(24, random_state=1)
    turns, wxyz = turn.as_matrix().reshape(12, 2, 9), turn.as_quat(scalar_first=True)
    places = rng.uniform(-0.3, 0.3, (12, 2, 3)) * np.repeat([0.1, 1.0], 6)[:, None, None]
    found = distances(one, other, places, wxyz.reshape(12, 2, 4)).distance
    for n, frames in enumerate(np.concatenate([turns, places], axis=2)):
        rods = np.empty((2, 7))
        for index in range(2):
            place_rod(arrays.rod, index, frames[index], rods)
        bounds = [rod_gap(rods, 0, rods, 1)]
        if "capsule" not in kinds:
            bounds += [rod_distance(rods, index, convex[1 - index], frames[1 - index])
                       for index in range(2)]  # fmt: skip
        own = solid_distance(convex[0], frames[0], convex[1], frames[1], np.empty(12), np.empty(7))
        assert found[n] == pytest.approx(max(own, *bounds), abs=1e-12)


def test_cores_that_hardly_touch_are_parted_along_their_distance() -> None:
    """Up to a picometer they count as overlapping, along some direction."""
    upright = np.array([1.0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0])
    for squared, along in ((TOUCH, False), (1.05 * TOUCH, True)):
        other, best = upright.copy(), np.empty(7)
        other[9] = np.sqrt(squared)
        assert other[9] ** 2 <= TOUCH or along
        depth = solid_distance(BALL, upright, BALL, other, np.empty(12), best)
        assert depth == pytest.approx(-0.2)
        assert (abs(best[1] - best[4]) == pytest.approx(0.2)) == along
    assert np.sqrt(TOUCH) == 1e-12


def test_cylinders_about_one_axis_are_parted_along_it() -> None:
    """As long as their axes are less than a nanometer apart, which shows no direction."""
    rod = ConvexSolid(CYLINDER, 0.1, 0.1, 0.5, 0.0, NO_CORNERS, 0, 0)
    frame = np.array([1.0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0])
    for apart, shift in ((0.0, 1.0), (0.99e-9, 1.0), (1e-9, 0.2), (1.05e-9, 0.2)):
        other, normal = frame.copy(), np.empty(3)
        other[9] = apart
        assert least_shift(rod, frame, rod, other, normal) == pytest.approx(shift)
        assert np.abs(normal).tolist() == [float(shift == 0.2), 0.0, float(shift == 1.0)]
