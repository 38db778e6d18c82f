"""Paths of motions: run through at their length, with derivatives between and at their stops."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from paminsa_viz.errors import InvalidInput
from paminsa_viz.trajectory import chain, circle, point_to_point, via_points
from paminsa_viz.trajectory.paths import TURN_LENGTH, TracedPath, spline_path, straight_path
from paminsa_viz.trajectory.sampled import STEPS, Trajectory
from tests.trajectory.plans import A, B, C

METRIC = np.array([1.0, 1.0, TURN_LENGTH, 1.0])
PLANS = {
    "stops": chain(point_to_point(A, B, 0.5), point_to_point(B, C, 0.7), point_to_point(C, A, 1.0)),
    "no stops": via_points([A, B, C], 2.0),
    "circle": circle(C, 0.07, 2.0),
}


@pytest.mark.parametrize("name", PLANS)
def test_equal_places_are_equally_far_and_derivatives_are_their_slopes(name: str) -> None:
    path = TracedPath(PLANS[name].curve)
    u = np.linspace(0.0, 1.0, 20_001)
    length = np.linalg.norm(np.diff(path.curve(u), axis=0) * METRIC, axis=1)
    assert path.length == pytest.approx(length.sum(), rel=1e-6)
    places = path.place(u[1:])
    np.testing.assert_allclose(places, np.cumsum(length) / length.sum(), atol=1e-6)
    stops = path.place(path.rests)
    assert len(stops) == (4 if name == "stops" else 2)
    inner = [a + (b - a) * np.array([0.02, 0.3, 0.5, 0.97]) for a, b in pairwise(stops)]
    s = np.concatenate(inner)
    np.testing.assert_allclose(path.place(path.instant(s)), s, atol=1e-12)
    np.testing.assert_allclose(path(s), path.curve(path.instant(s)), atol=1e-12)
    step = 1e-5
    for order in (1, 2, 3):
        slope = (path(s + step, order - 1) - path(s - step, order - 1)) / (2 * step)
        size = max(np.abs(slope).max(), path.length)
        np.testing.assert_allclose(path(s, order), slope, atol=1e-4 * size)
    speed = np.linalg.norm(path(s, 1) * METRIC, axis=1)
    np.testing.assert_allclose(speed, path.length, rtol=1e-9)
    squared, growth = path.law(s)
    rate = (path.place(path.instant(s) + 1e-6) - path.place(path.instant(s) - 1e-6)) / 2e-6
    np.testing.assert_allclose(squared, rate**2, rtol=1e-5)
    above, below = (path.law(s + move)[0] for move in (1e-6, -1e-6))
    np.testing.assert_allclose(growth, (above - below) / 2e-6, rtol=1e-4, atol=1e-6 * squared.max())


def test_lengths_are_exact_where_a_motion_nearly_turns_back() -> None:
    """Its speed is nearly zero there, and the length has a bend that is hard to follow."""
    for beside in (0.1, 0.01, 1e-3):
        curve = via_points([A, B, A + beside * (C - A)], 2.0).curve
        path = TracedPath(curve)
        nodes, weights = np.polynomial.legendre.leggauss(8)
        ends = np.unique(np.concatenate([curve.breaks, np.linspace(0.0, 1.0, 20_001)]))
        half = 0.5 * np.diff(ends)
        at = (ends[:-1] + half)[:, None] + half[:, None] * nodes
        speed = np.linalg.norm(curve(at.ravel(), 1) * METRIC, axis=1).reshape(at.shape)
        run = np.concatenate([[0.0], np.cumsum(half * (speed @ weights))])
        assert path.length == pytest.approx(run[-1], rel=1e-10)
        np.testing.assert_allclose(path.place(ends) * path.length, run, atol=1e-10 * run[-1])


def test_at_a_stop_the_direction_is_that_right_after_it() -> None:
    path = TracedPath(PLANS["stops"].curve)
    stops = path.place(path.rests)
    after = path(stops[:-1], 1) / path.length
    legs = np.array([B - A, C - B, A - C])
    legs /= np.linalg.norm(legs * METRIC, axis=1, keepdims=True)
    np.testing.assert_allclose(after, legs, atol=1e-6)
    np.testing.assert_allclose(path(stops[-1:], 1)[0] / path.length, legs[-1], atol=1e-6)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: straight_path(A, A), "two different poses"),
        (lambda: straight_path(A, [*B[:3], np.nan]), "two finite poses"),
        (lambda: spline_path([A]), "at least two finite poses"),
        (lambda: spline_path(A), "at least two finite poses"),
        (lambda: spline_path([A, [np.inf, 0.0, 0.0, 0.0]]), "at least two finite poses"),
    ],
    ids=["same", "lost", "one", "alone", "infinite"],
)
def test_what_is_no_path_is_refused(make, words: str) -> None:
    with pytest.raises(InvalidInput, match=f"poses: {words}"):
        make()


@pytest.mark.parametrize(
    ("t", "words"),
    [
        ([0.0, 1.0, np.inf], "times have to be finite and to increase"),
        ([0.0, 1.0, 1.0], "times have to be finite and to increase"),
        ([0.0, 0.5 * STEPS[0], 1.0], "from 1e-12 s to 1e[+]12 s apart"),
        ([0.0, 1.0, 1.05 * STEPS[1]], "from 1e-12 s to 1e[+]12 s apart"),
        ([1e12, 1e12 + 2e-4, 1e12 + 1.0], "less exact than they are apart"),
    ],
    ids=["infinite", "same", "near", "far", "inexact"],
)
def test_times_say_why_they_are_refused(t: list[float], words: str) -> None:
    rows = np.tile(A, (3, 1))
    with pytest.raises(InvalidInput, match=f"t: .*{words}"):
        Trajectory(np.array(t), rows, 0 * rows, 0 * rows)
    for step in STEPS:
        Trajectory(np.array([0.0, step]), rows[:2], 0 * rows[:2], 0 * rows[:2])
