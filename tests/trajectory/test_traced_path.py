"""Paths of motions: run through at their length, with derivatives between and at their stops."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.interpolate import BSpline

from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.resizing import TURN_LENGTH
from paminsa_viz.trajectory import chain, circle, paths, point_to_point, via_points
from paminsa_viz.trajectory.paths import (
    TimedPath,
    TracedPath,
    spline_path,
    straight_path,
)
from paminsa_viz.trajectory.plan import Chain, UnitCurve
from paminsa_viz.trajectory.planners import shared_time
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
    np.testing.assert_allclose(growth, (above - below) / 2e-6, rtol=1e-4, atol=1e-5 * squared.max())


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
        (lambda: straight_path([A], B), "two finite poses"),
        (lambda: straight_path(A, [B, C]), "two finite poses"),
        (lambda: spline_path([A]), "at least two finite poses"),
        (lambda: spline_path(A), "at least two finite poses"),
        (lambda: spline_path([A, [np.inf, 0.0, 0.0, 0.0]]), "at least two finite poses"),
    ],
    ids=["same", "lost", "row", "rows", "one", "alone", "infinite"],
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


def test_a_stop_is_one_whose_speed_is_zero_but_for_rounding() -> None:

    class Rounded(Chain):
        def __call__(self, u: Array, order: int = 0) -> Array:
            return super().__call__(u, order) + (1e-16 if order == 1 else 0.0)

    plans = point_to_point(A, B), point_to_point(B, C)
    path = TracedPath(Rounded(tuple(plan.curve for plan in plans), np.array([0.0, 0.5, 1.0])))
    (at,) = path.rests[1:-1]
    assert at == pytest.approx(0.5)
    assert 0.0 < path._speed(path.breaks).min(initial=1.0, where=path.breaks == at) < 1e-12


@pytest.mark.parametrize("beside", [0.1, 0.01, 1e-3])
def test_places_of_a_motion_that_nearly_turns_back_are_found_and_few_cells_are_halved(
    beside: float,
) -> None:
    path = TracedPath(via_points([A, B, A + beside * (C - A)], 2.0).curve)
    s = np.concatenate([np.linspace(0.0, 1.0, 2001), path.place(path.breaks)])
    np.testing.assert_allclose(path.place(path.instant(s)), s, atol=1e-15)
    # two pieces of 16 cells; each bend is halved to at most sixteen times smaller ones
    assert len(path._run.x) - 1 <= 32 + 2 * 16


def test_cells_that_are_still_rough_at_the_last_halving_count(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    curve = via_points([A, B, A + 0.01 * (C - A)], 2.0).curve
    length = TracedPath(curve).length
    monkeypatch.setattr(paths, "_HALVINGS", 1)
    path = TracedPath(curve)
    assert path._run.x[[0, -1]].tolist() == [0.0, 1.0]
    assert path.length == pytest.approx(length, rel=1e-3)


@pytest.mark.parametrize(("off", "cells"), [(0.95e-11, 16), (1.05e-11, 17), (-1.05e-11, 17)])
def test_cells_are_halved_that_are_off_by_a_share_of_1e_11_of_the_speed(
    off: float, cells: int
) -> None:
    """Between the eight speeds of one cell, where its polynomial is as large as that."""
    nodes = 0.5 * (1.0 + np.polynomial.legendre.leggauss(8)[0])
    between = np.concatenate([0.5 * nodes, 0.5 + 0.5 * nodes])
    largest = np.abs(np.prod(between[:, None] - nodes, axis=1)).max()

    class Wavy:
        breaks = np.array([0.0, 1.0])
        bounded_jerk = True

        def __call__(self, u: np.ndarray, order: int = 0) -> np.ndarray:
            cell = 16.0 * u - 5.0
            wave = np.prod(cell[:, None] - nodes, axis=1) / largest
            rate = 3.0 * (1.0 + np.where((cell >= 0.0) & (cell <= 1.0), off * wave, 0.0))
            return rate[:, None] * [1.0, 0.0, 0.0, 0.0]

    assert len(TracedPath(Wavy())._run.x) - 1 == cells


def test_beside_a_stop_directions_are_those_a_hundred_thousandth_of_the_piece_off_it() -> None:
    curve = chain(via_points([A, B, C], 1.0), via_points([C, A, B, C], 3.0)).curve
    path = TracedPath(curve)
    begin, stop, end = path.rests
    s = path.place(path.rests)
    s = np.array([s[0], np.nextafter(s[1], 0.0), s[1], s[2]])
    off = 1e-5 * np.array([stop - begin, end - stop])
    u = np.array([begin + off[0], stop - off[0], stop + off[1], end - off[1]])
    rate = curve(u, 1)
    speed = np.linalg.norm(rate * METRIC, axis=1)[:, None]
    np.testing.assert_allclose(path(s, 1), path.length * rate / speed, rtol=1e-8)


def test_a_spline_path_is_free_of_third_and_fourth_derivatives_at_its_ends() -> None:
    poses = np.array([A, B, C, A + 0.02])
    path = spline_path(poses)
    ends = np.array([0.0, 1.0])
    np.testing.assert_allclose(path(shared_time(poses)), poses, atol=1e-14)
    assert np.abs(path(ends, 3)).max() < 1e-9
    assert np.abs(path(ends, 4)).max() < 1e-7
    assert np.abs(path(np.array([0.5]), 4)).max() > 1.0


KNOTS = np.array([0.0, 0.1, 0.15, 0.4, 0.6, 0.85, 1.0])
SIZES = np.random.default_rng(2).uniform(0.5, 4.0, 6)
Z = BSpline(np.r_[0.0, 0.0, KNOTS, 1.0, 1.0], np.r_[0.0, SIZES, 0.0], 2)
LAW = TimedPath(TracedPath(point_to_point(A, B).curve), Z)
"""A quadratic law at random over the path of a move."""


def test_times_of_a_law_are_integrals_of_one_over_the_rate() -> None:
    """With s a square of its distance from an end, where the rate goes with its root."""
    u = np.sin(np.linspace(0.0, np.pi / 2, 400_001)) ** 2
    rate = np.sqrt(Z(u))
    middle = np.sqrt(Z(np.sin(0.5 * np.pi * (np.arange(400_000) + 0.5) / 400_000) ** 2))
    time = np.concatenate([[0.0], np.cumsum(np.diff(u) / middle)])
    assert rate[[0, -1]].tolist() == [0.0, 0.0]
    assert LAW.duration == pytest.approx(time[-1], rel=1e-6)
    for s in (0.0, 0.013, 0.1, 0.5, 0.6, 0.97):
        assert LAW.time_at(s) == pytest.approx(np.interp(s, u, time), rel=1e-5, abs=1e-9)
    t = np.linspace(0.0, LAW.duration, 50)
    np.testing.assert_allclose(LAW.place_at(t), np.interp(t, time, u), atol=1e-6)


def test_times_and_places_of_a_law_are_inverse() -> None:
    assert LAW.time_at(1.0) == pytest.approx(LAW.duration, rel=1e-14)
    s = np.concatenate([[1e-9, 1e-4], KNOTS, np.linspace(0.02, 0.98, 20)])
    t = np.array([LAW.time_at(float(at)) for at in s])
    np.testing.assert_allclose(LAW.place_at(t), s, atol=1e-12)


def test_places_of_the_last_times_alone_are_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    law, solved = TimedPath(LAW.path, Z), []
    place_at = TimedPath._place_at
    monkeypatch.setattr(
        TimedPath, "_place_at", lambda self, t: (solved.append(t), place_at(self, t))[1]
    )
    first, second = np.array([0.1, 0.2]), np.array([0.1, 0.3])
    for t in (first, first.copy(), second, second, first):
        np.testing.assert_array_equal(law.place_at(t), place_at(law, t))
    assert [t.tolist() for t in solved] == [first.tolist(), second.tolist(), first.tolist()]


def test_breaks_of_a_quadratic_law_are_those_of_its_knots() -> None:
    times = [LAW.time_at(float(at)) for at in KNOTS]
    np.testing.assert_allclose(LAW.breaks * LAW.duration, times, rtol=1e-12)
    cubic = TimedPath(
        LAW.path, BSpline([0.0] * 4 + [0.5] + [1.0] * 4, [0.0, 1.0, 1.0, 1.0, 0.0], 3)
    )
    assert cubic.breaks.tolist() == [0.0, 1.0]


def test_ends_of_a_law_that_are_off_by_rounding_are_ends() -> None:
    off = replace(LAW, rests=(1e-16, 1.0 - 2e-16))
    assert off.duration == pytest.approx(LAW.duration, rel=1e-9)
    assert off.time_at(0.0) == 0.0
    assert off.time_at(1.0) == pytest.approx(off.duration, rel=1e-14)


@pytest.mark.parametrize(
    "curve", [point_to_point(A, B).curve, PLANS["circle"].curve], ids=["straight", "bent"]
)
def test_derivatives_of_a_law_by_unit_time_are_those_of_the_poses(curve: UnitCurve) -> None:
    timed = TimedPath(TracedPath(curve), Z)
    u, h = np.linspace(0.003, 0.997, 37), 1e-6
    for order in (1, 2, 3):
        slope = (timed(u + h, order - 1) - timed(u - h, order - 1)) / (2 * h)
        exact = timed(u, order)
        near = np.abs(u[:, None] - timed.breaks).min(axis=1) > 1e-5
        size = np.abs(exact).max()
        np.testing.assert_allclose(slope[near], exact[near], atol=1e-5 * size)
    assert LAW(np.array([[0.2, 0.4]]), 3).shape == (1, 2, 4)


def test_a_short_motion_stops_no_more_often_than_a_long_one() -> None:
    for size in (1e-6, 1.0, 1e6):
        path = TracedPath(via_points(size * np.array([A, B, C])).curve)
        assert path.rests.tolist() == [0.0, 1.0]


def test_at_a_stop_the_time_by_the_angle_is_what_it_is_next_to_it() -> None:
    """Where s goes with the square of the time, as at both ends of a quadratic law."""
    beside = LAW._slowness(np.array([1e-5, 1.0 - 1e-5]))
    np.testing.assert_allclose(LAW._slowness(np.array([0.0, 1.0])), beside, rtol=1e-3)
