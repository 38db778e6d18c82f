"""Bounds between the corners of a box, and the proof that it is free of singularities, by others.

Arcs against their closed form and Hermite's cubics, slopes against differences, limits of reach
against all sixteen corners.
"""

from __future__ import annotations

from dataclasses import replace
from importlib import import_module
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline

from paminsa_viz.model import APPENDIX_4, check_reach, inverse_kinematics
from paminsa_viz.model.accuracy import DriveAccuracy
from paminsa_viz.model.kinematics import LEG_AXES
from paminsa_viz.precision.drive_corners import (
    CORNERS,
    _Ends,
    _largest,
    _largest_square,
    beyond_corners,
    beyond_reach,
    corner_errors,
)
from paminsa_viz.precision.drive_errors import Bound, drive_errors
from tests.precision.boxes import edge_points, random_boxes

GEOMETRY = APPENDIX_4.geometry
WIDER = replace(GEOMETRY, base_radius=0.2, platform_radius=0.3)
NARROWER = replace(GEOMETRY, base_radius=0.21, platform_radius=0.2)


class Arcs:
    """Edges (n, 12) along which a place is center + a cos t + b sin t, t from 0 to the turn."""

    def __init__(self, seed: int, count: int, most: float, edges: int = 12) -> None:
        rng, shape = np.random.default_rng(seed), (count, edges)
        self.turn = rng.uniform(1e-3, most, (*shape, 1))
        size = 10.0 ** rng.uniform(-1.0, 1.0, (*shape, 1))
        self.a, self.b = size * rng.normal(size=(2, *shape, 2))
        self.center = rng.normal(size=(*shape, 2)) - self.a * rng.integers(0, 2, (*shape, 1))

    def place(self, t: Any) -> Any:
        return self.center + self.a * np.cos(t) + self.b * np.sin(t)

    def slope(self, t: Any) -> Any:
        return self.b * np.cos(t) - self.a * np.sin(t)

    def end(self, t: Any) -> _Ends:
        return _Ends(self.place(t), self.slope(t))


def test_the_largest_coordinate_of_an_arc_is_at_its_top_or_an_end() -> None:
    arcs = Arcs(0, 200, 2.5)
    found = _largest(arcs.end(0.0), arcs.end(arcs.turn), arcs.turn)
    top = np.mod(np.arctan2(arcs.b, arcs.a), 2.0 * np.pi)
    inside = top < arcs.turn
    ends = np.maximum(arcs.place(0.0), arcs.place(arcs.turn))
    expected = np.where(inside, arcs.center + np.hypot(arcs.a, arcs.b), ends)
    assert 0.1 < inside.mean() < 0.9
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-12)


def reference_square(arcs: Arcs, row: int, edge: int, pieces: int) -> tuple[float, bool]:
    """Bound of the distance's square along one edge, and whether it rises or falls throughout."""
    center, a, b = (part[row, edge] for part in (arcs.center, arcs.a, arcs.b))
    t = np.linspace(0.0, 2.0 * np.pi, 8, endpoint=False)
    around = center + np.cos(t)[:, None] * a + np.sin(t)[:, None] * b
    waves = np.abs(np.fft.rfft((around**2).sum(axis=1))) / 4.0
    step = arcs.turn[row, edge, 0] / pieces
    fourth = (waves[1] + 16.0 * waves[2]) * step**4
    bounds, steady = [], []
    for t in step * np.arange(pieces):
        at = np.array([t, t + step])[:, None]
        place = center + np.cos(at) * a + np.sin(at) * b
        slope = np.cos(at) * b - np.sin(at) * a
        square, rate = (place**2).sum(axis=1), 2.0 * step * (place * slope).sum(axis=1)
        cubic = CubicHermiteSpline([0.0, 1.0], square, rate)
        slopes = np.array([rate[0], rate[1], *cubic.derivative()(_inside(cubic.derivative(2)))])
        steady.append(
            bool(np.abs(np.sign(slopes).sum()) == len(slopes))
            and np.abs(slopes).min() > fourth / (72.0 * np.sqrt(3.0))
        )
        tops = cubic(_inside(cubic.derivative()))
        highest = max(square.max(), tops.max(initial=-np.inf))
        bounds.append(square.max() if steady[-1] else highest + fourth / 384.0)
    return max(bounds), all(steady)


def _inside(polynomial: Any) -> Any:
    roots = polynomial.roots(extrapolate=False)
    return roots[(roots > 0.0) & (roots < 1.0)]


@pytest.mark.slow
@pytest.mark.parametrize("pieces", [1, 4])
@np.errstate(all="ignore")
def test_the_distance_along_an_arc_is_bounded_by_a_cubic_and_its_remainder(pieces: int) -> None:
    """By Fourier's waves of the square, and Hermite's cubics; and the bound holds."""
    arcs = Arcs(1, 12, 1.2)
    found = _largest_square(arcs.end(0.0), arcs.end(arcs.turn), arcs.turn, pieces)
    every = [[reference_square(arcs, row, edge, pieces) for edge in range(12)] for row in range(12)]
    np.testing.assert_allclose(found, [max(b for b, _ in row) for row in every], rtol=1e-9)
    steady = [one for row in every for _, one in row]
    assert 20 < sum(steady) < 124
    dense = [(arcs.place(share * arcs.turn) ** 2).sum(axis=-1) for share in np.linspace(0, 1, 201)]
    assert (found >= np.max(dense, axis=(0, 2)) * (1 - 1e-12)).all()
    # a straight edge: only the end that is given
    still: Any = np.zeros((1, 12, 1))
    ends = _Ends(arcs.place(0.0)[:1], np.zeros((1, 12, 2)))
    square = (ends.place**2).sum(axis=-1).max()
    assert _largest_square(ends, ends, still, pieces)[0] == pytest.approx(square)


@pytest.mark.slow
@np.errstate(all="ignore")
def test_of_each_arc_by_itself_the_distance_is_bounded_by_its_cubic() -> None:
    """Sampled; an arc along which the slope may not vanish has its ends, another one a remainder.

    Those are left out whose slope is within a five-hundredth of the limit.
    """
    arcs = Arcs(2, 20_000, 1.2, edges=1)
    low, high = arcs.end(0.0), arcs.end(arcs.turn)
    found = _largest_square(low, high, arcs.turn, 1)
    around = np.array([(arcs.place(t) ** 2).sum(axis=-1) for t in np.arange(8) * np.pi / 4])
    waves = np.abs(np.fft.rfft(around[..., 0], axis=0)) / 4.0
    turn = arcs.turn[:, 0, 0]
    fourth = (waves[1] + 16.0 * waves[2]) * turn**4
    square = np.array([(end.place**2).sum(axis=-1)[:, 0] for end in (low, high)])
    rate = [2.0 * turn * (end.place * end.slope).sum(axis=-1)[:, 0] for end in (low, high)]
    cubic = CubicHermiteSpline([0.0, 1.0], square, np.array(rate))
    share = np.linspace(0.0, 1.0, 301)
    slope, limit = cubic.derivative()(share), fourth / (72.0 * np.sqrt(3.0))
    one_way = np.abs(np.sign(slope).sum(axis=0)) == len(share)
    least = np.abs(slope).min(axis=0)
    steady = one_way & (least > limit)
    expected = np.where(steady, square.max(axis=0), cubic(share).max(axis=0) + fourth / 384.0)
    sure = ~one_way | (np.abs(least / limit - 1.0) > 2e-3)
    assert sure.mean() > 0.99
    np.testing.assert_allclose(found[sure], expected[sure], rtol=3e-5)


@pytest.mark.slow
def test_where_edges_exceed_corners_errors_are_exact_in_x_and_y_and_nearly_in_the_plane() -> None:
    """By forward kinematics at 401 points of each edge."""
    exceeded = 0
    for box in random_boxes(np.random.default_rng(34), 40, 20):
        chosen = (box.found.between[:, [0, 1, 3]] > 1e-4 * box.bounds[:, [0, 1, 3]]).any(axis=1)
        if chosen.any():
            found = drive_errors(box.design.geometry, box.found.accuracy, box.found.pose[chosen])
            box = box._replace(found=found)
            edges = box.worst(edge_points(box.half, 401))
            np.testing.assert_allclose(box.bounds[:, :2], edges[:, :2], rtol=1e-5)
            np.testing.assert_allclose(box.bounds[:, 3], edges[:, 3], rtol=3e-4)
            exceeded += len(edges)
    assert exceeded >= 5


def test_a_straight_edge_is_off_its_chord_by_an_eighth_of_its_length_times_its_turn() -> None:
    """Along an edge that lies on a line of symmetry the platform hardly turns, either way."""
    angle, radius = np.meshgrid(
        np.radians([30.0, 150.0, 270.0]), 0.125 + np.linspace(-4e-5, 4e-5, 41)
    )
    poses = np.zeros((123, 4))
    poses[:, 0], poses[:, 1] = (radius * np.cos(angle)).ravel(), (radius * np.sin(angle)).ravel()
    poses[:, 3] = -0.6
    found = drive_errors(GEOMETRY, DriveAccuracy(), poses)
    first, last = (
        np.concatenate([np.flatnonzero(sign * CORNERS[:, j] > 0) for j in range(3)])
        for sign in (-1.0, 1.0)
    )
    apart = found.corners[:, last] - found.corners[:, first]
    turn, length = apart[..., 2], np.hypot(apart[..., 0], apart[..., 1])
    off = np.where(np.abs(turn) < 1e-7, length * turn / 8.0, 0.0)
    most = np.abs(off).max(axis=1)
    assert most.min() > 1e-14
    assert (off.max(axis=1) < 0.9 * most).any()  # it turns back
    np.testing.assert_allclose(found.between[:, 0], most, rtol=1e-3)
    np.testing.assert_allclose(found.between[60:63, 3], most[60:63], rtol=1e-3)  # in the middle
    assert (found.between[:, 3] > most * (1 - 1e-9)).all()


def test_between_corners_that_differ_by_next_to_no_turn_edges_are_their_chords() -> None:
    """All twelve edges of made-up corners: what they exceed them by is a chord's arc alone."""
    moved = np.zeros((5, 8, 3))
    moved[..., :2] = 1e-4 * np.random.default_rng(1).normal(size=(5, 8, 2))
    moved[..., 2] = 3e-8 * CORNERS.sum(axis=1)  # 6e-8 along each edge
    found = beyond_corners(GEOMETRY, np.tile([0.02, -0.01, 0.1, -0.5], (5, 1)), moved)
    apart = np.linalg.norm(moved[:, :, None, :2] - moved[:, None, :, :2], axis=-1)
    edges = np.abs(CORNERS[:, None] - CORNERS).sum(axis=-1) == 2.0
    off = np.where(edges, apart, 0.0).max(axis=(1, 2)) * 6e-8 / 8.0
    for column in (0, 1, 3):
        np.testing.assert_allclose(found[:, column], off, rtol=1e-3)


def test_boxes_whose_bound_is_not_their_corners_are_bounded_in_four_pieces(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Where the bound of whole edges is more than a millionth above the farthest corner."""
    module, looked_at = import_module("paminsa_viz.precision.drive_corners"), []

    def looking(low: _Ends, high: _Ends, turn: Any, pieces: int) -> Any:
        square = _largest_square(low, high, turn, pieces)
        looked_at.append((pieces, low.place, square.copy()))
        return square

    monkeypatch.setattr(module, "_largest_square", looking)
    for box in random_boxes(np.random.default_rng(3), 6, 20):
        looked_at.clear()
        found = drive_errors(box.design.geometry, box.found.accuracy, box.found.pose)
        (whole, places, square), (pieces, again, finer) = looked_at
        farthest = (found.corners[..., :2] ** 2).sum(axis=-1).max(axis=1)
        beyond = square / farthest - 1.0 > 1e-6
        assert (whole, pieces) == (1, 4)
        np.testing.assert_array_equal(again, places[beyond])
        square[beyond] = finer
        expected = np.maximum(np.sqrt(square) - np.sqrt(farthest), 0.0)
        np.testing.assert_allclose(found.between[:, 3], expected, atol=1e-12)


def modes(beta: Any) -> Any:
    """a and b of the closure equations of headings (..., 3), see `kinematics`."""
    axes = np.arctan2(LEG_AXES[:, 1], LEG_AXES[:, 0])
    turn = np.sin(np.roll(beta, -1, axis=-1) - np.roll(beta, -2, axis=-1))
    return (turn * np.sin(beta - axes)).sum(axis=-1), (turn * np.cos(beta - axes)).sum(axis=-1)


@pytest.mark.parametrize(
    "geometry", [GEOMETRY, WIDER, NARROWER], ids=["appendix4", "R_pl>R_b", "R_pl<R_b"]
)
def test_modes_are_apart_by_a_taylor_expansion_with_differences_for_slopes(geometry: Any) -> None:
    rng = np.random.default_rng(8)
    poses = rng.uniform([-0.25, -0.25, -1.3, -0.3], [0.25, 0.25, 1.3, -0.3], (3000, 4))
    half = np.radians([2.0, 5.0, 3.0])
    proven = corner_errors(geometry, poses, half)[2]
    beta = inverse_kinematics(geometry, poses).beta
    step = 1e-6 * np.eye(3)
    ahead, behind = (np.array(modes(beta[:, None] + sign * step)) for sign in (1.0, -1.0))
    slopes = (ahead - behind) / 2e-6
    (a, b), rest = modes(beta), 1.5 * half.sum() ** 2
    weight = np.sqrt(abs((geometry.base_radius / geometry.platform_radius) ** 2 - 1.0))
    if geometry.platform_radius > geometry.base_radius:
        change = np.abs(slopes) @ half + rest
        room = np.hypot(weight * a, b) - np.hypot(weight * change[0], change[1])
    else:
        room = np.min(
            [
                np.abs(b + way * a) - np.abs(slopes[1] + way * slopes[0]) @ half
                - (1.0 + weight) * rest
                for way in (weight, -weight)
            ],
            axis=0,
        )  # fmt: skip
    assert 300 < proven.sum() < 2900
    np.testing.assert_array_equal(proven, room > 0.0)


def test_limits_within_a_box_are_those_of_its_sixteen_corners(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """And the leg is that of the first of them; the lower eight are looked at first.

    Corners are looked at of those that are within the joints' way of a limit, and of no others.
    """
    looked_at = []

    def looking(geometry: Any, pose: Any, moved: Any, lift: float) -> Any:
        looked_at.append(pose)
        return beyond_reach(geometry, pose, moved, lift)

    module = import_module("paminsa_viz.precision.drive_errors")
    monkeypatch.setattr(module, "beyond_reach", looking)
    rng = np.random.default_rng(12)
    accuracy = DriveAccuracy(resolution_rotary=np.radians(3.0), resolution_linear=6e-3)
    half = np.array(accuracy.half_widths)
    lift = GEOMETRY.magnification * half[3]
    low, high = [-0.25, -0.25, -1.0, -0.95], [0.25, 0.25, 1.0, -0.05]
    design = APPENDIX_4.vary({"geometry.guide_stroke": 0.35})
    geometry = design.geometry
    poses = rng.uniform(low, high, (12_000, 4))
    reach = check_reach(geometry, poses)
    margin = reach.margins.min(axis=(-1, -2))
    poses = poses[reach.ok & (margin < 0.06)]
    found = drive_errors(geometry, accuracy, poses)
    known = np.isin(found.status, [Bound.OK, Bound.LIMIT])
    poses, status, leg = poses[known], found.status[known], found.leg[known]
    moved = corner_errors(geometry, poses, half[:3])[0]
    sideways = np.hypot(moved[..., 0], moved[..., 1]).max(axis=1)
    turn = np.maximum(moved[..., 2].max(axis=1), -moved[..., 2].min(axis=1))
    k = geometry.magnification
    way = k / (k - 1) * (sideways + geometry.platform_radius * turn) + lift
    near = check_reach(geometry, poses).margins.min(axis=(-1, -2)) <= way
    assert 100 < near.sum() < len(near) - 100
    np.testing.assert_array_equal(np.concatenate(looked_at), poses[near])
    corners = np.repeat(poses[:, None], 16, axis=1)
    corners[:, :8, :3] += moved
    corners[:, 8:, :3] += moved
    corners[:, :8, 3] -= lift
    corners[:, 8:, 3] += lift
    every = check_reach(geometry, corners)
    lost = ~every.ok.all(axis=1)
    first = np.argmin(every.ok, axis=1)
    assert lost.sum() > 100
    assert (~lost).sum() > 100
    assert set(first[lost]) >= {0, 1, 2, 3, 8}
    np.testing.assert_array_equal(status == Bound.LIMIT, lost)
    wanted = np.where(lost, every.leg[np.arange(len(poses)), first], -1)
    np.testing.assert_array_equal(leg, wanted)
    outside, which = beyond_reach(geometry, poses, moved, lift)
    np.testing.assert_array_equal(outside, lost)
    np.testing.assert_array_equal(which[lost], wanted[lost])


def test_corners_are_in_the_order_of_their_actuators_and_opposite_ones_mirror() -> None:
    assert CORNERS.tolist() == [
        [x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)
    ]
    np.testing.assert_array_equal(CORNERS, -CORNERS[::-1])
    with pytest.raises(ValueError, match="read-only"):
        CORNERS[0, 0] = 1.0
