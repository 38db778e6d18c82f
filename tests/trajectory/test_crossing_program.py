"""The program of a motion through singularities against the robot's own dynamics on any law."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.model import APPENDIX_4, inverse_dynamics, static_torques
from paminsa_viz.trajectory import MotionLimits
from paminsa_viz.trajectory.crossing import crossing_condition, crossings
from paminsa_viz.trajectory.crossing_program import POINTS, CrossingProgram, _pieces, influence
from paminsa_viz.trajectory.paths import Path, spline_path, straight_path
from tests.trajectory.crossings import BALANCED, LINE, PLAIN, TURN, shortest

LIMITS = MotionLimits(torque=9.0, force=400.0, speed=1.3, turn_speed=4.0)
SPLINE = spline_path([[0.1, 0.0, 0.2, -0.5], [0.25, 0.05, 0.3, -0.52], [0.36, 0.02, 0.5, -0.5]])
PATHS = pytest.mark.parametrize("path", [TURN, LINE, SPLINE], ids=["turn", "line", "spline"])


def made(path: Path, limits: MotionLimits = LIMITS) -> tuple[CrossingProgram, Any]:
    """A program, and coefficients of some law."""
    found = crossings(BALANCED.geometry, path)
    program = CrossingProgram(BALANCED, path, found, limits, *PLAIN)
    size = program._rows.factors.shape[1]
    return program, np.random.default_rng(0).uniform(1.0, 4.0, size)


def torques(path: Path, z: Any, s: Any) -> Any:
    """Inverse dynamics of the motion with s'^2 = z, (n, 4)."""
    square, slope = z(s)[:, None], z(s, 1)[:, None]
    velocity = path(s, 1) * np.sqrt(square)
    acceleration = path(s, 2) * square + 0.5 * path(s, 1) * slope
    return inverse_dynamics(BALANCED.without_friction(), path(s), velocity, acceleration).torque


@PATHS
def test_rows_of_torques_are_their_shares_of_the_limits_on_both_sides(path: Path) -> None:
    program, c = made(path)
    s = program._points(POINTS)
    s = s[np.abs(s[:, None] - [item.s for item in program._found]).min(axis=1) > 1e-3]
    factors, constant, limit, of_torque = program._torque_rows(s)
    assert of_torque.all()
    expected = torques(path, program.spline(c), s) / [9.0, 9.0, 9.0, 400.0]
    found = ((factors @ c + constant) / limit).reshape(2, len(s), 4)
    np.testing.assert_allclose(found[0], expected, atol=1e-8 * np.abs(expected).max())
    np.testing.assert_array_equal(found[1], -found[0])
    # the ends, where nothing moves, are held
    np.testing.assert_allclose(found[0, [0, -1]], expected[[0, -1]], atol=1e-9)
    assert s[[0, -1]].tolist() == [0.0, 1.0]


@PATHS
def test_rows_of_a_crossing_are_the_torques_next_to_it(path: Path) -> None:
    """Of a law that satisfies the condition there; other ones have no torque in the limit."""
    program, c = made(path)
    equal, right = program._equal, program._right
    c = c + np.linalg.pinv(equal) @ (right - equal @ c)  # the nearest such law
    assert (c > 0).all()
    z = program.spline(c)
    for item, condition in zip(program._found, program.conditions, strict=True):
        at = np.array([item.s])
        assert condition.residual(
            float(np.sqrt(z(at)[0])), 0.5 * float(z(at, 1)[0])
        ) == pytest.approx(0.0, abs=1e-9)
        factors, constant, limit, of_torque = program._crossing_rows(item)
        assert of_torque.all()
        assert (limit == 1.0).all()
        found = (factors @ c + constant).reshape(2, 4)
        near = torques(path, z, at + np.array([-1e-6, 1e-6])).mean(axis=0)
        np.testing.assert_allclose(found[0], near / [9.0, 9.0, 9.0, 400.0], atol=2e-5)
        np.testing.assert_allclose(found[1], -found[0])


@PATHS
def test_rows_of_speeds_are_squares_of_their_shares(path: Path) -> None:
    program, c = made(path)
    s = program._points(POINTS)
    speed, turn = program._speed_rows(s)
    rate = path(s, 1) * np.sqrt(program.spline(c)(s))[:, None]
    for rows, share in (
        (speed, (rate[:, [0, 1, 3]] ** 2).sum(axis=1) / 1.3**2), (turn, (rate[:, 2] / 4.0) ** 2),
    ):  # fmt: skip
        np.testing.assert_allclose(rows.factors @ c, share, rtol=1e-9, atol=1e-12)
        assert not rows.of_torque.any()
        assert (rows.limit == 1.0).all()
        assert not rows.constant.any()
    alone, _ = made(path, MotionLimits(torque=9.0))
    assert list(alone._speed_rows(s)) == []
    forces, c = made(path, MotionLimits(force=400.0))
    factors = forces._torque_rows(s).factors
    assert len(factors) == 2 * len(s)  # of M4 alone


@pytest.mark.parametrize("s", [0.4567, 0.005, 0.995])
@pytest.mark.parametrize("refinement", [0, 1, 3])
def test_pieces_next_to_a_crossing_are_halved_and_others_are_not(s: float, refinement: int) -> None:
    """Ends at half a piece from it, a fourth and so on; near an end of the path within it."""
    (item,) = crossings(BALANCED.geometry, LINE)
    ends = _pieces((replace(item, s=s),), refinement, 40)
    least = 0.1 * 0.5**refinement / 40
    room = min(1.0, 40 * s, 40 * (1 - s)) / 40
    added = [s + side * room * 0.5**k for side in (-1, 1) for k in range(1, refinement + 1)]
    for wanted in (*np.linspace(0.0, 1.0, 41), *added):
        assert np.abs(ends - wanted).min() <= least  # one that is as near as this is enough
    assert ends[[0, -1]].tolist() == [0.0, 1.0]
    assert (np.diff(ends)[:-1] > least).all()
    assert 41 <= len(ends) <= 41 + 2 * refinement


@pytest.mark.parametrize(
    ("design", "path"), [(APPENDIX_4, TURN), (BALANCED, LINE)], ids=["turn", "line"]
)
def test_speeds_that_a_crossing_allows_are_those_of_the_slowest_and_the_fastest(
    design: Any, path: Path
) -> None:
    """The largest s'^2 there is that of the law that has the largest everywhere."""
    found = shortest(design, path, MotionLimits(torque=10.0))
    (crossing,) = found.crossings
    s = crossing.crossing.s
    low, high = crossing.speed_range
    assert low == pytest.approx(float(np.sqrt(found.slowest(s))), rel=1e-3, abs=1e-6)
    assert high == pytest.approx(float(np.sqrt(found.fastest(s))), rel=1e-3)
    assert low <= crossing.speed <= high * (1 + 1e-9)
    assert crossing.speed == pytest.approx(high, rel=1e-3)  # of the shortest motion
    inner = np.linspace(0.0, 1.0, 200)
    assert (found.fastest(inner) >= found.slowest(inner) - 1e-9).all()


def test_what_time_laws_can_do_does_not_depend_on_the_size_of_path_and_twist() -> None:
    (item,) = crossings(BALANCED.geometry, LINE)
    condition = crossing_condition(BALANCED, LINE, item.s)
    value = influence(BALANCED, LINE, item, condition)
    assert 0.0 < value <= 1.0
    scaled = replace(
        condition, a=-3.0 * condition.a, twist=tuple(-3.0 * x for x in condition.twist)
    )
    assert influence(BALANCED, LINE, item, scaled) == pytest.approx(value)


@pytest.mark.parametrize("refinement", [1, 2, 3])
@pytest.mark.parametrize(("off", "added"), [(1.05, True), (0.95, False)])
def test_ends_of_pieces_closer_than_a_tenth_of_the_least_piece_are_one(
    refinement: int, off: float, added: bool
) -> None:
    """A crossing so far beside the middle of a piece; its halves are next to the piece's ends."""
    (item,) = crossings(BALANCED.geometry, LINE)
    least = 0.1 * 0.5**refinement / 40
    ends = _pieces((replace(item, s=7.5 / 40 + off * least),), refinement, 40)
    assert len(ends) == 41 + 2 * (refinement - 1) + 2 * added
    assert (np.diff(ends) > least).all()


@pytest.mark.parametrize("s", [1e-4, 1.0 - 1e-4])
def test_a_crossing_next_to_an_end_leaves_the_end_where_it_is(s: float) -> None:
    (item,) = crossings(BALANCED.geometry, LINE)
    assert _pieces((replace(item, s=s),), 1, 40)[[0, -1]].tolist() == [0.0, 1.0]


def test_points_are_left_out_within_a_fifty_thousandth_of_a_crossing() -> None:
    program, _ = made(LINE)
    program._found = ()
    every = program._points(POINTS)
    item = crossings(BALANCED.geometry, LINE)[0]
    for beside, kept in ((1.95e-5, False), (2.05e-5, True)):
        for sign in (1.0, -1.0):
            program._found = (replace(item, s=float(every[100]) + sign * beside),)
            assert len(program._points(POINTS)) == len(every) - 1 + kept


@pytest.mark.slow
def test_limits_are_added_at_the_ends_too_and_nowhere_where_none_is_exceeded() -> None:
    """A robot that stands still all along: the torques are those that hold it."""
    ends = [0.1, 0.0, 0.2, -0.5], [0.14, 0.02, 0.3, -0.5]
    for way in (ends, ends[::-1]):
        assert_limits_are_added_at_the_harder_end(straight_path(*way))


def assert_limits_are_added_at_the_harder_end(path: Path) -> None:
    held = np.abs(static_torques(APPENDIX_4, path(np.array([0.0, 1.0]))))[:, :3]
    program = CrossingProgram(
        APPENDIX_4, path, (), MotionLimits(torque=float(held.max() / 1.01)), *PLAIN
    )
    still = np.zeros(program._rows.factors.shape[1])
    before = len(program._rows.limit)
    assert program.tighten(still)
    _, constant, limit, _ = (part[before:] for part in program._rows)
    assert len(limit) == 2 * 3  # of one place, the end that is harder to hold
    assert np.abs(constant / limit).max() == pytest.approx(1.01)
    loose = CrossingProgram(
        APPENDIX_4, path, (), MotionLimits(torque=float(held.max() * 1.01)), *PLAIN
    )
    before = len(loose._rows.limit)
    assert not loose.tighten(still)
    assert len(loose._rows.limit) == before


@pytest.mark.slow
def test_the_slowest_law_is_below_the_optima_of_other_costs() -> None:
    found = crossings(APPENDIX_4.geometry, TURN)
    program = CrossingProgram(APPENDIX_4, TURN, found, MotionLimits(torque=10.0), *PLAIN)
    slow, fast = program.slowest(), program.fastest()
    rng = np.random.default_rng(3)
    for _ in range(3):
        cost = rng.uniform(0.9, 1.1, len(slow))
        assert slow.sum() <= program._optimum(cost).sum() * (1.0 + 1e-9)
        assert fast.sum() >= program._optimum(-cost).sum() * (1.0 - 1e-9)
