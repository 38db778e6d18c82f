"""Checking a path: when it fails, where and why, to the instant, also between samples."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import brentq

from paminsa_viz.model import APPENDIX_4, InvalidInput, Limit, check_reach, singular_radius
from paminsa_viz.model.singularity import singular_rotation
from paminsa_viz.trajectory import (
    PRESETS,
    SINGULAR_CLEARANCE,
    ImpossibleTrajectory,
    Trajectory,
    check,
    check_path,
    point_to_point,
    round_trip,
    singular_clearance,
)
from paminsa_viz.trajectory.sampled import Locus, Passage
from tests.support.samples import resized

GEOMETRY = APPENDIX_4.geometry
HOME = np.array([0.0, 0.0, 0.0, -0.5])
TURN = singular_rotation(GEOMETRY)
RADIUS = float(singular_radius(GEOMETRY, 0.0))
SHORT_GUIDE = APPENDIX_4.vary({"geometry.guide_stroke": 0.16}).geometry
NARROW = APPENDIX_4.vary({"geometry.platform_radius": 0.4, "geometry.base_radius": 0.3}).geometry


def to(x: float, y: float, theta: float, z: float, duration: float = 2.0):
    return point_to_point(HOME, [x, y, theta, z], duration)


LIMITS = {
    "circle": ((0.3, 0, 0, -0.5), Limit.SINGULAR, lambda p: RADIUS - SINGULAR_CLEARANCE - p[0]),
    "turn": (
        (0, 0, -1.6, -0.5),
        Limit.SINGULAR,
        lambda p: (
            singular_rotation(GEOMETRY) - SINGULAR_CLEARANCE / GEOMETRY.platform_radius + p[2]
        ),
    ),
    "stretched": (
        (0.01, 0.02, 0, -1.2),
        Limit.STRETCHED,
        lambda p: check_reach(GEOMETRY, p).margins[:, 0].min(),
    ),
}


@pytest.mark.parametrize("name", LIMITS)
@pytest.mark.parametrize("rate", [3.0, 40.0, 1000.0])
def test_a_limit_is_found_to_the_instant(name: str, rate: float) -> None:
    goal, limit, margin = LIMITS[name]
    plan = to(*goal)
    exact = brentq(
        lambda t: float(np.nan_to_num(margin(plan.at(t).pose), nan=-1)), 0, 2, xtol=1e-14
    )
    check = check_path(GEOMETRY, plan.sample(rate))
    assert check.first is not None
    assert check.first.t == pytest.approx(exact, abs=1e-9)
    assert check.first.limit is limit
    assert (check.first.leg == -1) == (limit is Limit.SINGULAR)
    assert check.until == np.searchsorted(plan.sample(rate).t, exact)


def test_a_limit_is_found_to_the_instant_in_the_first_step_of_many() -> None:
    start = np.array([RADIUS - SINGULAR_CLEARANCE - 1e-9, 0.0, 0.0, -0.5])
    plan = point_to_point(start, [0.3, 0.0, 0.0, -0.5], 0.2)
    samples = plan.sample(1000.0)
    exact = brentq(lambda t: RADIUS - SINGULAR_CLEARANCE - plan.at(t).pose[0], 0.0, 0.1)
    check = check_path(GEOMETRY, samples)
    assert exact < samples.t[1]
    assert check.until == 1
    assert check.first is not None
    assert check.first.t == pytest.approx(exact, abs=1e-9)


def test_a_guide_may_be_used_to_its_end_and_no_further() -> None:
    plan = to(0.0, -0.2, 0.1, -0.5)
    check = check_path(SHORT_GUIDE, plan.sample())
    assert check.first is not None
    assert (check.first.limit, check.first.leg) == (Limit.GUIDE, 2)
    reach = check_reach(SHORT_GUIDE, plan.at(check.first.t).pose)
    assert reach.margins[2, 2] == pytest.approx(0.0, abs=1e-12)
    assert "leg 3" in check.first.explanation
    assert "guide" in check.first.explanation
    # a motion that ends where the guide does
    end = brentq(lambda y: check_reach(SHORT_GUIDE, [0, y, 0.1, -0.5]).margins[2, 2], -0.2, 0)
    inside = check_path(SHORT_GUIDE, point_to_point(HOME, [0, end + 1e-12, 0.1, -0.5]).sample())
    assert inside.possible


@pytest.mark.parametrize("goal", [(0.3, 0, 0, -0.5), (0, 0, 1.6, -0.5), (0, 0, 0, -1.3)])
def test_a_failure_between_two_good_samples_is_found(goal) -> None:
    """There and back between two samples: both of them, and every sample, can be taken."""
    plan = round_trip(point_to_point(HOME, goal))
    t = np.array([0.0, 0.2, 1.8, 2.0])
    samples = Trajectory(t, *plan.at(t))
    check = check_path(GEOMETRY, samples)
    assert check.ok.all()
    assert check.first is not None
    assert 0.2 < check.first.t < 1.0
    assert check.until == 2


def test_a_short_dip_between_many_samples_is_found() -> None:
    """A turning point a little beyond the limit, between two of a thousand samples."""
    limit = RADIUS - SINGULAR_CLEARANCE
    for beyond, fails in ((1e-9, True), (-1e-9, False)):
        plan = round_trip(point_to_point(HOME, [limit + beyond, 0, 0, -0.5]))
        t = np.linspace(0, 2, 1000)  # the turning point at 1 s is none of them
        check = check_path(GEOMETRY, Trajectory(t, *plan.at(t)))
        assert check.ok.all()
        assert (check.first is not None) == fails


@pytest.mark.parametrize("after", [True, False])
def test_steps_on_both_sides_of_a_sample_near_a_limit_are_checked(after: bool) -> None:
    """Of 401 samples one is near: the motion leaves it, or comes to it, by way of the limit."""
    limit = RADIUS - SINGULAR_CLEARANCE
    margin = np.full(401, 0.003)
    margin[200], margin[201:] = 0.001, 0.0011
    samples = np.zeros((3, 401, 4))
    samples[0] = HOME
    samples[0, :, 0] = limit - margin
    samples[1, 200, 0] = 2.0  # m/s toward the limit
    if not after:
        samples = samples[:, ::-1] * np.array([1.0, -1.0, 1.0])[:, None, None]
    check = check_path(GEOMETRY, Trajectory(np.linspace(0.0, 4.0, 401), *samples))
    assert check.ok.all()
    assert check.first is not None
    assert check.first.limit is Limit.SINGULAR
    assert (2.0 if after else 1.99) < check.first.t < (2.01 if after else 2.0)


def test_samples_beyond_a_singularity_stay_singular() -> None:
    plan = to(0.3, 0.0, 0.0, -0.5)
    samples = plan.sample(100)
    check = check_path(GEOMETRY, samples)
    assert check_reach(GEOMETRY, samples.pose).ok.all()
    assert (check.status[check.until :] == Limit.SINGULAR).all()
    assert (check.status[: check.until] == Limit.OK).all()
    with pytest.raises(ImpossibleTrajectory, match="too close to a singular pose"):
        check.require()
    # started there, the same poses are fine: no singularity is crossed
    back = check_path(GEOMETRY, point_to_point([0.3, 0, 0, -0.5], [0.28, 0, 0, -0.5]).sample())
    assert back.possible
    assert back.side == (-1.0, 1.0)


coordinate = st.floats(-0.3, 0.3)
goals = st.tuples(coordinate, coordinate, st.floats(-1.5, 1.5), st.floats(-1.1, 0.3))


@given(goals)
def test_samples_agree_with_the_reach_of_their_poses(goal) -> None:
    samples = to(*goal).sample(200)
    check, reach = check_path(GEOMETRY, samples), check_reach(GEOMETRY, samples.pose)
    serial = ~np.isin(check.status, [Limit.OK, Limit.SINGULAR])
    assert not check.ok[~reach.ok].any()
    np.testing.assert_array_equal(check.status[serial], reach.status[serial])
    np.testing.assert_array_equal(check.leg[serial], reach.leg[serial])
    assert check.possible == (check.first is None) == (check.until == samples.size)
    assert check.ok[: check.until].all()
    assert (check.leg[~serial] == -1).all()
    check.words()


@given(goals)
def test_dense_and_coarse_samples_fail_at_the_same_instant(goal) -> None:
    plan = to(*goal)
    coarse, dense = (check_path(GEOMETRY, plan.sample(rate)).first for rate in (7.0, 1000.0))
    assert (coarse is None) == (dense is None)
    if coarse is not None and dense is not None:
        assert coarse.t == pytest.approx(dense.t, abs=1e-7)
        assert (coarse.limit, coarse.leg) == (dense.limit, dense.leg)


@pytest.mark.slow
@given(goals)
def test_a_third_of_a_turn_permutes_the_legs(goal) -> None:
    """As the paper says of its maps."""
    c, s = np.cos(2 * np.pi / 3), np.sin(2 * np.pi / 3)
    x, y, theta, z = goal
    here = check_path(GEOMETRY, to(x, y, theta, z).sample(100)).first
    there = check_path(GEOMETRY, to(c * x - s * y, s * x + c * y, theta, z).sample(100)).first
    assert (here is None) == (there is None)
    if here is not None and there is not None and here.t > 0:
        assert there.t == pytest.approx(here.t, abs=1e-9)
        assert there.limit == here.limit


def test_closest_approach() -> None:
    check = check_path(GEOMETRY, to(0.2, 0.0, 0.0, -0.5).sample())
    assert check.possible
    assert check.closest.t == 2.0
    expected = RADIUS - SINGULAR_CLEARANCE - 0.2
    assert check.closest.margin == pytest.approx(expected, abs=1e-12)
    wide = check_path(GEOMETRY, to(0.2, 0.0, 0.0, -0.5).sample(), clearance=0.0)
    assert wide.closest.margin == pytest.approx(expected + SINGULAR_CLEARANCE, abs=1e-12)


def test_clearance_and_presets_follow_the_size_of_the_robot() -> None:
    """Down to a fiftieth; there all presets but one were refused by the prototype's 5 mm."""
    assert singular_clearance(GEOMETRY) == SINGULAR_CLEARANCE
    for size in (0.02, 5.0):
        geometry = resized(APPENDIX_4, size).geometry
        for preset in PRESETS:
            found = check_path(geometry, preset.build(geometry).sample(50.0))
            assert found.possible, preset.key
            usual = check_path(GEOMETRY, preset.build(GEOMETRY).sample(50.0))
            # Instants between waypoints follow a length for a turn of 1 rad, which stays.
            play = 0.1 if preset.key == "waypoints" else 1e-6
            assert found.closest.margin == pytest.approx(size * usual.closest.margin, play)


def test_a_platform_larger_than_the_base_has_no_singular_turn() -> None:
    check = check_path(
        NARROW, point_to_point([0, 0, 0, -0.4], [0, 0, 0.05, -0.4]).sample(50), 0.001
    )
    assert np.isfinite(check.closest.margin)


@pytest.mark.parametrize("clearance", [-1e-3, np.nan, np.inf])
def test_impossible_clearances(clearance: float) -> None:
    with pytest.raises(InvalidInput, match="clearance"):
        check_path(GEOMETRY, to(0, 0, 0.1, -0.5).sample(10), clearance)


def test_a_failure_is_found_to_a_1e_12th_of_a_step_wherever_it_begins() -> None:
    """Right behind one of the places at which a step is looked at, where each cut gains least."""
    trajectory = point_to_point([0, 0, 0, -0.5], [0, 0, 0.1, -0.5], 4.0).sample(1)
    for begin in (1.0, 1.25, 1.25 + 1 / 64):
        root = begin + 2e-14

        def margins_at(t: Any, pose: Any, root: float = root) -> Any:
            found = np.ones((len(t), 14))
            found[:, 3] = root - t
            return found

        margins = margins_at(trajectory.t, None)
        exceeded = np.where(margins < 0.0, margins, np.inf)
        event, until = check._first_failure(trajectory, margins, exceeded, margins_at)
        assert event is not None
        assert until == 2
        assert root < event.t < root + 2e-12


def test_only_guides_may_be_used_to_their_end() -> None:
    """Of the four margins of a leg the third is the guide's; the two loci come last."""
    margins = np.ones((14, 14))
    for room, exceeded in ((-1e-12, np.ones(14)), (0.0, np.ones(14)), (1e-12, np.zeros(14))):
        np.fill_diagonal(margins, room)
        wanted = np.diag(exceeded).astype(bool)
        if room == 0.0:
            wanted[[2, 6, 10], [2, 6, 10]] = False
        np.testing.assert_array_equal(check.beyond(margins), wanted)


@pytest.mark.parametrize("inward", [1.0, -1.0])
def test_a_planned_crossing_is_excused_while_it_is_nearer_than_the_clearance(
    inward: float,
) -> None:
    """The motion comes near, leaves again, crosses at 5.4 s, and comes near once more."""
    t = np.arange(11.0)
    poses = np.tile(HOME, (11, 1))
    poses[:, 0] = RADIUS - inward * 1e-3 * np.array([9, 3, 9, 8, 4, 1, -2, -4, -7, -3, -9])
    planned = (Passage(5.4, Locus.CIRCLE),)
    samples = Trajectory(t, poses, 0 * poses, 0 * poses, passages=planned)
    (window,) = check_path(GEOMETRY, samples).windows
    assert window == (planned[0], 3.0, 8.0)
    # as near as the clearance is not nearer; nothing is farther than one that is wide
    exact = float(np.abs(check._singular_distances(GEOMETRY, poses))[3, 0])
    assert check_path(GEOMETRY, samples, exact).windows[0][1:] == (3.0, 10.0)
    assert check_path(GEOMETRY, samples, 0.02).windows[0][1:] == (-np.inf, np.inf)
    times = np.array([0.0, 3.0, 3.001, 5.399, 5.4, 7.999, 8.0, 10.0])
    sides, distances = check.allowed(times, np.array([inward, -1.0]), 0.005, (window,))
    np.testing.assert_array_equal(sides[:, 0], inward * np.array([1, 1, 1, 1, -1, -1, -1, -1]))
    np.testing.assert_array_equal(distances[:, 0] < -1.0, [0, 0, 1, 1, 1, 1, 0, 0])
    np.testing.assert_array_equal(distances[[0, 1, 6, 7], 0], 0.005)
    np.testing.assert_array_equal(sides[:, 1], -1.0)
    np.testing.assert_array_equal(distances[:, 1], 0.005)


def test_the_side_is_that_of_the_first_sample() -> None:
    """Also where the second one is beyond the locus already."""
    for start, goal, side in ((0.01, -0.01, 1.0), (-0.01, 0.01, -1.0)):
        poses = np.tile(HOME, (2, 1))
        poses[:, 0] = RADIUS - np.array([start, goal])
        found = check_path(GEOMETRY, Trajectory([0.0, 1.0], poses, 0 * poses, 0 * poses))
        assert found.side == (side, 1.0)
        assert found.status.tolist() == [Limit.OK, Limit.SINGULAR]
    poses[:, :3] = [
        [0.0, 0.0, TURN],
        [0.0, 0.0, TURN - 0.1],
    ]  # on a locus itself it is the inner one
    found = check_path(GEOMETRY, Trajectory([0.0, 1.0], poses, 0 * poses, 0 * poses))
    assert found.side == (1.0, 1.0)
    assert found.status.tolist() == [Limit.SINGULAR, Limit.OK]


def test_a_motion_that_fails_at_once_has_its_first_failure_and_closest_limit_there() -> None:
    poses = np.array([[RADIUS - 0.003, 0.0, 0.0, -0.5], [RADIUS - 0.001, 0.0, 0.1, -0.5], HOME])
    found = check_path(GEOMETRY, Trajectory([3.0, 4.0, 5.0], poses, 0 * poses, 0 * poses))
    assert found.until == 0
    for event in (found.first, found.closest):
        assert event is not None
        assert (event.t, event.limit, event.leg) == (3.0, Limit.SINGULAR, -1)
        assert event.pose == tuple(poses[0])
        assert event.margin == pytest.approx(0.003 - SINGULAR_CLEARANCE)


def test_a_sample_that_fails_by_rounding_alone_is_the_failure() -> None:
    """Where its own margins are negative, but nothing between it and the sample before is."""
    samples = point_to_point(HOME, [0.1, 0.0, 0.1, -0.5], 4.0).sample(1)
    margins = np.ones((5, 14))
    margins[2:, 5] = -1e-18
    exceeded = np.where(margins < 0, margins, np.inf)
    event, until = check._first_failure(
        samples, margins, exceeded, lambda t, pose: np.ones((len(t), 14))
    )
    assert event is not None
    assert (event.t, event.limit, event.leg, event.margin) == (2.0, Limit.FOLDED, 1, -1e-18)
    assert event.pose == tuple(samples.pose[2])
    assert until == 2


def test_a_sample_on_a_locus_is_the_failure_at_any_speed_and_number_of_samples() -> None:
    """At even speed the margin of the sample before is what one step takes, no less."""
    plan = point_to_point(HOME, [0.1, 0.0, 0.1, -0.5], 4.0)
    for count in (3, 513):
        t = np.linspace(0.0, 4.0, count)

        def margins_at(t: Any, pose: Any = None) -> Any:
            margins = np.ones((np.size(t), 14))
            margins[:, 12] = 4.0 - np.asarray(t)  # exact, as is each step of it
            return margins

        margins = margins_at(t)
        exceeded = np.where(check.beyond(margins), margins, np.inf)
        event, until = check._first_failure(
            Trajectory(t, *plan.at(t)), margins, exceeded, margins_at
        )
        assert event is not None
        assert (event.t, event.limit, event.margin) == (4.0, Limit.SINGULAR, 0.0)
        assert until == count - 1


def test_of_many_samples_only_those_near_a_limit_are_looked_beside(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of few, every step; each in 32 parts."""
    looked: list[int] = []

    def at(self: Trajectory, t: Any, real: Any = Trajectory.at) -> Any:
        looked.append(np.size(t))
        return real(self, t)

    monkeypatch.setattr(Trajectory, "at", at)
    poses = np.tile(HOME, (401, 1))
    poses[:, 0] = RADIUS - SINGULAR_CLEARANCE - 0.003
    near = poses.copy()
    near[200, 0] += 0.002
    for rows, steps in ((poses[:300], 299), (poses[:301], 0), (near, 2), (near[:202], 201)):
        looked.clear()
        samples = Trajectory(np.arange(float(len(rows))), rows, 0 * rows, 0 * rows)
        assert check_path(GEOMETRY, samples).possible
        assert looked == [32 * steps] * (steps > 0)


@pytest.mark.parametrize(("least", "looked"), [(2.0, []), (np.nextafter(2.0, 0.0), [64])])
def test_steps_are_looked_into_beside_a_margin_that_is_less_than_they_take(
    least: float, looked: list[int]
) -> None:
    """Not beside one that is just as much: it cannot dip below zero and back."""
    margins = np.full((401, 14), 4.0)
    margins[200, 12] = least
    poses = np.tile(HOME, (401, 1))
    found: list[int] = []

    def margins_at(t: Any, pose: Any) -> Any:
        found.append(len(t))
        return np.ones((len(t), 14))

    samples = Trajectory(np.arange(401.0), poses, 0 * poses, 0 * poses)
    exceeded = np.full_like(margins, np.inf)
    assert check._first_failure(samples, margins, exceeded, margins_at) == (None, 401)
    assert found == looked
