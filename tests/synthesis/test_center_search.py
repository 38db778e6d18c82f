"""The search for the place of a free center, part by part, with made-up margins and volumes."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.model import APPENDIX_4, KneeBranch
from paminsa_viz.quantities.requirements import Requirement, Requirements, WorkspaceShape
from paminsa_viz.synthesis.proof import placement
from paminsa_viz.synthesis.proof.bisection import Control, Gauge
from paminsa_viz.synthesis.proof.placement import CANDIDATES, CenterSearch, PlacedCenter
from paminsa_viz.synthesis.proof.regions import (
    FIRST,
    SEED,
    Growth,
    PoseRegion,
    freedom,
    from_unit,
)
from tests.support.samples import enlarged

BOX = WorkspaceShape.BOX
REGION = PoseRegion(BOX, (0.0, 0.0, -0.5), (0.1, 0.1, 0.2), (-0.3, 0.5))
CELL = 0.05


def search(free: Any = (True, True, True), growth: Growth = Growth.ALL, **changes: Any) -> Any:
    """A search without a volume."""
    made: Any = CenterSearch.__new__(CenterSearch)
    made._design, made._region, made._grows, made._side = APPENDIX_4, REGION, growth.axes, None
    made._requirements = Requirements((), REGION.theta)
    made._free, made._rng = np.array(free), np.random.default_rng(SEED)
    made._cell, made._groups = CELL, ()
    made._broken = np.empty((0, 3))
    for name, value in changes.items():
        setattr(made, name, value)
    return made


@pytest.mark.parametrize("knee", KneeBranch)
def test_it_starts_from_the_nodes_of_a_volume_and_those_around_it(
    monkeypatch: pytest.MonkeyPatch, knee: KneeBranch
) -> None:
    """Also beyond the grid's end, where the volume goes that far."""
    inside = np.zeros((3, 3, 4), bool)
    inside[1, 1, 1] = inside[2, 1, 1] = True
    x, z = CELL * np.arange(-1.0, 2.0), -0.6 + CELL * np.arange(4.0)
    asked: list[Any] = []

    def volume(*given: Any, **more: Any) -> Any:
        asked.append((given, more))
        return SimpleNamespace(x=x, y=x, z=z, inside=inside, cell=CELL)

    monkeypatch.setattr(placement, "solve_volume", volume)
    needed, design = Requirements((Requirement("condition", high=9.0),)), APPENDIX_4.with_knee(knee)
    for both in (False, True):
        made = CenterSearch(design, needed, REGION, (True,) * 3, (True,) * 3, both)
        side = 1.0 if knee is KneeBranch.LOWER else -1.0
        assert made._side == (None if both else side)
        assert made._end == pytest.approx(0.0 if knee is KneeBranch.LOWER else -0.0275)
        (given, more) = asked.pop()
        assert given == (design, needed)
        assert more == {"resolution": placement.RESOLUTION, "both_sides": both}
        nodes = np.array([[0.0, 0.0, -0.55], [CELL, 0.0, -0.55]])
        np.testing.assert_allclose(made._inside, nodes)
        steps = np.concatenate([np.eye(3), -np.eye(3)]) * CELL
        around = {tuple(np.round(node + step, 9) + 0.0) for node in nodes for step in steps}
        around -= {tuple(np.round(node, 9) + 0.0) for node in nodes}
        assert {tuple(np.round(one, 9) + 0.0) for one in made._broken} == around
        assert len(made._broken) == len(around) == 10
        assert made._cell == CELL
    assert len(made._groups) == 1


def test_of_many_nodes_some_are_chosen() -> None:
    made, axes = search(), [np.arange(4.0), 10 + np.arange(3.0), 20 + np.arange(2.0)]
    every = made._chosen(axes, np.ones((4, 3, 2), bool), 24)
    expected = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 3)
    np.testing.assert_array_equal(every, expected)
    assert made._rng.bit_generator.state == np.random.default_rng(SEED).bit_generator.state
    few = made._chosen(axes, np.ones((4, 3, 2), bool), 23)
    assert len(few) == len(np.unique(few, axis=0)) == 23
    rows = [int(np.flatnonzero((expected == row).all(axis=1))[0]) for row in few]
    assert rows == sorted(rows)


def test_candidates_keep_the_coordinates_that_are_given() -> None:
    made = search((True, False, True))
    made._inside = np.random.default_rng(1).uniform(-1, 1, (1000, 3))
    center = np.array([0.3, 0.0, -0.7])
    assert made._on_axis(center).tolist() == [0.0, 0.0, -0.7]
    assert search((False, True, True))._on_axis(center + 0.1) == pytest.approx([0.4, 0.0, -0.6])
    found = made._around(center)
    assert (found[:, 1] == 0.0).all()
    assert len(np.unique(found, axis=0)) == len(found)
    assert CANDIDATES // 2 * 0.8 < len(found) <= CANDIDATES // 2 + 2
    for one in (center, [0.0, 0.0, -0.7]):
        assert (found == one).all(axis=1).any()
    made._inside = made._inside[:7]
    assert len(made._around(center)) <= 9


@pytest.mark.parametrize("free", [(True, True, True), (True, False, True)])
def test_the_best_center_is_followed_up_in_smaller_and_smaller_steps(free: Any) -> None:
    target, asked = np.array([0.21, -0.13, -0.44]), []
    made = search(free)

    def scales(centers: Any) -> Any:
        asked.append(centers)
        return 2.0 - np.linalg.norm((centers - target)[:, np.array(free)], axis=1)

    made._scales = scales
    start = np.random.default_rng(3).uniform(-0.3, 0.3, (50, 3))
    center, scale = made._largest(start)
    assert center[np.array(free)] == pytest.approx(target[np.array(free)], abs=2e-3)
    assert scale == scales(center[None])[0] == max(scales(part).max() for part in asked[:15])
    assert [len(part) for part in asked[:15]] == [50] + 14 * [8 * 12]
    # a dozen about each of the eight best, at first as far as the next node
    spreads = []
    for part in asked[1:15]:
        blocks = part.reshape(8, 12, 3)
        spreads.append(np.sqrt(blocks.var(axis=1, ddof=1).mean(axis=0)))
        assert (blocks[..., ~np.array(free)] == blocks[:, :1, ~np.array(free)]).all()
    ratio = np.array(spreads)[:, np.array(free)] / (CELL * 0.6 ** np.arange(14.0)[:, None])
    assert ratio.mean() == pytest.approx(1.0, abs=0.04)
    assert ratio[7:].mean() / ratio[:7].mean() == pytest.approx(1.0, abs=0.08)
    best = start[np.argsort(-scales(start))[:8]]
    assert asked[1].reshape(8, 12, 3).mean(axis=1) == pytest.approx(best, abs=0.06)
    # at the same places in every version
    draw = np.random.default_rng(SEED).normal(size=(96, 3))
    np.testing.assert_allclose(asked[1], np.repeat(best, 12, axis=0) + CELL * draw * np.array(free))


BALL, RADIUS = np.array([0.12, 0.13, 0.2, -0.2]), 0.05


def broken_in_a_ball(asked: list[Any], ball: Any = BALL) -> Any:
    def margins(poses: Any) -> Any:
        asked.append(poses)
        return np.linalg.norm(poses - ball, axis=1) - RADIUS

    return margins


def test_positions_are_not_broken_by_headings_that_are_not_required() -> None:
    asked: list[Any] = []
    made = search()
    made._margins = broken_in_a_ball(asked, [*BALL[:2], REGION.theta[1] + 0.01, BALL[3]])
    assert len(made._searched(np.array([0.0, 0.0, -0.5]), 1.6))
    for part in asked[9:]:
        assert part[:, 2].max() <= REGION.theta[1]


def test_the_nearest_positions_that_break_a_requirement_are_found() -> None:
    asked: list[Any] = []
    made = search()
    margins = made._margins = broken_in_a_ball(asked)
    center, scale = np.array([0.0, 0.0, -0.5]), 1.6
    found = made._searched(center, scale)
    calls = list(asked)
    gauge = Gauge(REGION, (True,) * 3)

    def clear(at: float) -> bool:
        half = at * np.array(REGION.half)
        near = np.clip(BALL[[0, 1, 3]], center - half, center + half)
        return bool(np.linalg.norm(near - BALL[[0, 1, 3]]) > RADIUS)

    low, high = 0.0, 2.0
    for _ in range(50):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if clear(middle) else (low, middle)
    poses = np.column_stack([found[:, :2], np.full(len(found), BALL[2]), found[:, 2]])
    assert (margins(poses) < 1e-12).all()  # with some heading
    reach = gauge.of_poses(poses)
    assert (reach <= scale * (1 + 1e-12)).all()
    assert low <= reach.min() <= low + 0.01
    assert np.sort(reach[:32])[-1] <= low + 0.1
    assert 32 < len(found) <= 64
    # first anywhere, then about the worst, at the same poses in every version
    assert [len(part) for part in calls[:9]] == [FIRST // 2] + 8 * [32 * 16]
    rng, whole = np.random.default_rng(SEED), replace(REGION, center=(0.0, 0.0, -0.5))
    whole = whole.scaled(scale, (True,) * 3)
    unit = 1.3 * rng.uniform(-1.0, 1.0, (FIRST // 2, 4))
    width = 0.3
    for part in calls[:9]:
        np.testing.assert_allclose(part, from_unit(whole, unit[-len(part) :]), atol=1e-12)
        order = np.argsort(margins(from_unit(whole, unit)))[:32]
        near = np.repeat(np.clip(unit[order], -1.0, 1.0), 16, axis=0)
        unit = np.concatenate([unit, near + width * rng.normal(size=near.shape)])
        width *= 0.5
    # then back toward the center, by halves
    followed = calls[9:23]
    assert len({len(part) for part in followed}) == 1
    assert len(followed[0]) <= 400
    worst = followed[0]
    toward = np.array([0.0, 0.0, 0.0, -0.5])
    share = (followed[0] - toward)[:, 3] / (followed[1] - toward)[:, 3]
    assert (np.isclose(share, 2.0) | np.isclose(share, 2 / 3)).all()
    assert (worst[:, 2] == followed[13][:, 2]).all()
    # and to nearer ones, within the headings
    nearer = calls[23:]
    assert len(nearer) == 12
    assert all(len(part) <= 32 * 32 for part in nearer)
    for part in nearer:
        assert part[:, 2].min() >= -0.3
        assert part[:, 2].max() <= 0.5


class Level:
    """A gauge for which all poses of a call are as far out, and those asked for first nearer."""

    nearer = True

    def __init__(self, *_: Any) -> None:
        self.calls = 0

    def of_poses(self, poses: Any) -> Any:
        self.calls += 1
        return np.full(len(poses), float(self.calls) if self.nearer else 0.0)


@pytest.mark.parametrize("nearer_ones", [True, False])
def test_nearer_poses_are_looked_for_in_smaller_and_smaller_steps(
    monkeypatch: pytest.MonkeyPatch, nearer_ones: bool
) -> None:
    """Along the line from the center until the requirement holds, then about the nearest.

    A pose at which it just holds breaks nothing; nor does one that is no nearer count.
    """
    asked: list[Any] = []
    made, center = search(), np.array([0.02, 0.01, -0.5])
    middle, mask = np.array([0.02, 0.01, 0.0, -0.5]), np.array([True, True, False, True])

    def margins(poses: Any) -> Any:  # whatever the heading; on a shell it just holds
        asked.append(poses)
        away = np.linalg.norm((poses - BALL)[:, mask], axis=1)
        return np.where(away < RADIUS, -1.0, np.where(away < 1.4 * RADIUS, 0.0, 1.0))

    made._margins = margins
    monkeypatch.setattr(placement, "Gauge", type("Own", (Level,), {"nearer": nearer_ones}))
    found = made._searched(center, 1.6)
    back, nearer = asked[9:23], asked[23:]
    # by halves along the line, the heading kept
    start = 2.0 * back[0] - middle
    assert (back[0][:, 2] == back[1][:, 2]).all()
    low, high = np.zeros(len(start)), np.ones(len(start))
    start[:, 2] = back[0][:, 2]
    for tried in back:
        share = 0.5 * (low + high)
        line = np.where(mask, middle + share[:, None] * (start - middle), start)
        np.testing.assert_allclose(tried, line, atol=1e-12)
        holds = np.linalg.norm((tried - BALL)[:, mask], axis=1) >= RADIUS
        low, high = np.where(holds, share, low), np.where(holds, high, share)
    ends = np.where(mask, middle + high[:, None] * (start - middle), start)
    away = np.linalg.norm((ends - BALL)[:, mask], axis=1)
    assert away == pytest.approx(np.full(len(away), RADIUS), abs=1e-4)
    assert (away < RADIUS).all()
    every = len(ends) // 32 + 1
    np.testing.assert_allclose(found[32:], ends[::every][:, mask], atol=1e-12)
    assert len(found) == 32 + len(ends[::every])
    assert (np.linalg.norm(found - BALL[mask], axis=1) < RADIUS).all()
    if not nearer_ones:
        assert [len(part) for part in nearer] == 12 * [0]
        return
    assert [len(part) for part in nearer] == 12 * [32 * 32]
    sides = np.array([0.16, 0.16, 0.4, 0.32])
    blocks = [part.reshape(32, 32, 4) / sides for part in nearer]
    clipped = [np.isin(part[:, 2], (-0.3, 0.5)).reshape(32, 32).any(axis=1) for part in nearer]
    whole = [~np.outer(cut, [0, 0, 1, 0]).astype(bool) for cut in clipped]
    spreads = np.array(
        [
            np.sqrt(block.var(axis=1, ddof=1).mean(axis=0, where=counts))
            for block, counts in zip(blocks, whole, strict=True)
        ]
    )
    assert spreads == pytest.approx(0.1 * 0.7 ** np.arange(12.0)[:, None] + np.zeros(4), rel=0.09)
    assert (spreads / 0.1 / 0.7 ** np.arange(12.0)[:, None]).mean(axis=0) == pytest.approx(
        np.ones(4), abs=0.02
    )


def test_headings_of_nearer_poses_stay_in_their_range() -> None:
    asked: list[Any] = []
    made = search(_region=replace(REGION, theta=(0.15, 0.2)))

    def margins(poses: Any) -> Any:
        asked.append(poses)
        return np.full(len(poses), -1.0)

    made._margins = margins
    made._searched(np.array([0.0, 0.0, -0.5]), 1.0)
    turns = np.concatenate([part[:, 2] for part in asked])
    assert (turns.min(), turns.max()) == pytest.approx((0.15, 0.2), abs=1e-15)


def test_where_nothing_breaks_nothing_is_found() -> None:
    for value in (1.0, 0.0):
        made = search(_margins=lambda poses, v=value: np.full(len(poses), v))
        assert made._searched(np.zeros(3), 1.0).shape == (0, 3)


def test_a_position_just_beyond_reach_counts_as_broken(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[Any] = []

    def reach(*given: Any) -> float:
        seen.append(given)
        return 0.8

    def free(geometry: Any, region: PoseRegion) -> Any:
        seen.append(region)
        return np.array([1.0, 2.0, 3.0, 4.0]), value, "reach"

    value = 0.0
    monkeypatch.setattr(placement, "reach_scale", reach)
    monkeypatch.setattr(placement, "least_free", free)
    made, center = search(), np.array([0.1, 0.2, -0.3])
    for given, expected in ((-1e-9, [[1.0, 2.0, 4.0]]), (0.0, []), (0.1, [])):
        value = given
        seen.clear()
        assert made._beyond(center, 0.9).tolist() == expected
        assert seen[0][2].center == (0.1, 0.2, -0.3)
        assert seen[0][3:] == ((True,) * 3, 26)
        assert seen[1].half == pytest.approx(0.8 * (1 + 2e-4) * np.array(REGION.half), rel=1e-12)
        assert seen[1].center == (0.1, 0.2, -0.3)
    assert made._beyond(center, 0.9).shape == (0, 3)
    for scale in (0.8, 0.79):
        seen.clear()
        assert made._beyond(center, scale).shape == (0, 3)
        assert len(seen) == 1


def test_margins_are_shares_of_their_bounds_where_they_count() -> None:
    """Of each group over its own headings and heights; a pose without a value breaks it."""

    def group(theta: Any, z: Any, scale: float, margin: float) -> Any:
        made = SimpleNamespace(theta=theta, z=z, sizes=np.array([scale, 1e9]))
        made.pose_margins = lambda poses: np.tile([margin, 1e9], (len(poses), 1))
        return made

    everywhere = (-np.inf, np.inf)
    poses = np.array([[0.0, 0.0, t, z] for t in (-0.2, 0.0, 0.2) for z in (-0.6, -0.5, -0.4)])
    base = freedom(APPENDIX_4.geometry, poses).min(axis=0)
    assert base.min() > 0.05
    made = search()
    np.testing.assert_array_equal(made._margins(poses), base)
    for theta, z, counts in (
        ((-0.2, 0.2), everywhere, [1] * 9), ((0.0, 0.1), everywhere, [0, 0, 0, 1, 1, 1, 0, 0, 0]),
        ((-0.1, 0.2), (-0.5, -0.5), [0, 0, 0, 0, 1, 0, 0, 1, 0]),
        ((-0.2, 0.0), (-0.6, -0.45), [1, 1, 0, 1, 1, 0, 0, 0, 0]),
    ):  # fmt: skip
        for scale, margin, least in ((4.0, 0.02, 0.005), (0.0, -2.0, -2e9), (3.0, np.nan, -1.0)):
            made._groups = (group(theta, z, scale, margin),)
            expected = np.where(np.array(counts, bool), np.minimum(base, least), base)
            assert made._margins(poses) == pytest.approx(expected)


def test_kept_extents_have_to_hold_about_a_center() -> None:
    """At their edge, their ends and every heading; what grows may be as small as it takes."""
    design = replace(APPENDIX_4, geometry=replace(APPENDIX_4.geometry, platform_joint_height=0.0))
    centers = np.array([[0.0, 0.0, -0.1 * n] for n in range(3, 9)])
    low = replace(REGION, theta=(-0.3, 0.3))

    def held(bound: Requirement, growth: Growth, free: Any = (False, False, True)) -> Any:
        needed = Requirements((bound,), low.theta)
        made = search(free, growth, _design=design, _requirements=needed, _region=low)
        return np.round(made._holding(centers)[:, 2], 9).tolist()

    every = [-0.3, -0.4, -0.5, -0.6, -0.7, -0.8]
    turned = Requirement("tau_1", high=0.0)  # of the other sign for half of the headings
    assert held(turned, Growth.ALL) == []
    assert held(turned, Growth.ALL, (True, True, True)) == every  # nodes of the volume
    wide = Requirement("condition", high=3.0)  # up to about 0.1 m off the axis
    assert held(wide, Growth.ALL) == every
    assert held(wide, Growth.HORIZONTAL) == every[:-1]  # 0.2 m lower is out of reach
    assert held(wide, Growth.VERTICAL) == []
    deep = Requirement("reach_margin", low=0.1)
    assert held(deep, Growth.ALL) == every
    assert held(deep, Growth.HORIZONTAL) == every[:4]  # at -0.9 m less than 0.1 m are left


def test_where_no_center_holds_the_one_next_to_home_is_said_at_once() -> None:
    made = search((False, False, True), _inside=np.array([[0, 0, -z] for z in (0.3, 0.56, 0.8)]))
    made._requirements = Requirements((Requirement("tau_1", high=0.0),), REGION.theta)
    made._largest = None  # is not asked
    assert made.find(Control(5.0)) == PlacedCenter((0.0, 0.0, -0.56), 0.0)


class Rounds:
    """A search whose parts are made up: centers along x, broken ones further in each round."""

    def __init__(self, scales: Any, found: Any, centers: Any) -> None:
        self.made = search()
        self.calls: list[Any] = []
        made, self.centers = self.made, list(centers)
        made._inside = np.array([[0.5, 0.5, 0.5]])
        made._scales = lambda rows: np.array([scales(row, len(self.calls)) for row in rows])
        made._searched = lambda center, scale: np.empty((found(len(self.calls)), 3))
        made._beyond = lambda center, scale: np.empty((0, 3))
        made._largest = self.largest

    def largest(self, centers: Any) -> Any:
        self.calls.append(centers)
        return self.centers[min(len(self.calls), len(self.centers)) - 1]


def test_rounds_go_on_until_nothing_more_is_found_or_the_bound_is_near() -> None:
    def center(x: float, scale: float) -> Any:
        return np.array([x, 0.0, -0.5]), scale

    both = [center(0.2, 2.0), center(0.3, 1.5), center(0.1, 1.2)]
    held = {0.2: 1.0, 0.3: 1.1, 0.1: 0.9, 0.0: 0.1}
    far = lambda row, _: held[round(float(row[0]), 3)]  # noqa: E731
    done = Rounds(far, lambda n: 0, both)
    assert done.made.find(Control(5.0)) == PlacedCenter((0.2, 0.0, -0.5), 2.0)
    assert len(done.calls) == 1
    done = Rounds(far, lambda n: 1 if n < 3 else 0, both)
    # the best of all that were tried, and the bound of the last round
    assert done.made.find(Control(5.0)) == PlacedCenter((0.3, 0.0, -0.5), 1.2)
    assert len(done.calls) == 3
    assert done.made._broken.shape == (2, 3)
    assert done.calls[2][-1].tolist() == [0.3, 0.0, -0.5]
    # near enough: within a thousandth
    for scale, rounds in ((1.1 * 1.0009, 2), (1.1 * (1.0 + 1e-3), 2), (1.1 * 1.0011, 4)):
        near = [both[0], center(0.3, scale), both[2], center(0.1, 0.9)]
        done = Rounds(far, lambda n: 1, near)
        done.made.find(Control(5.0))
        assert len(done.calls) == rounds
    # a hundred rounds at most, and 40 % of the time that is left
    done = Rounds(far, lambda n: 1, [both[0]])
    done.made.find(Control(5.0))
    assert len(done.calls) == 100
    done = Rounds(far, lambda n: 1, [both[0]])
    clock = SimpleNamespace(over=False, elapsed=0.0, left=10.0)

    def slow(*_: Any) -> Any:
        clock.elapsed += 0.85
        return np.ones((1, 3))

    done.made._searched = slow
    done.made.find(clock)
    assert len(done.calls) == 5
    done = Rounds(far, lambda n: 1, [both[0]])
    done.made.find(SimpleNamespace(over=True, elapsed=0.0, left=10.0))
    assert len(done.calls) == 1
    nothing = search(_inside=np.empty((0, 3)))
    assert nothing.find(Control(5.0)) is None


@pytest.mark.parametrize(
    ("free", "kept", "expected"),
    [
        ((True, True, True), lambda row: 1.0, (0.0, 0.0, -0.512)),
        ((True, True, True), lambda row: 1.0 if row[0] else 0.9985, (0.012, 0.035, -0.512)),
        ((True, True, True), lambda row: 1.0 if row[0] else 0.9995, (0.0, 0.0, -0.512)),
        (
            (True, True, True), lambda row: 1.0 if row[0] == pytest.approx(0.01234) else 0.9985,
            (0.01234, 0.03456, -0.51234),
        ),
        ((True, True, True), lambda row: 1.0 if row[0] else 1.0 - 1e-3, (0.0, 0.0, -0.512)),
        ((True, True, True), lambda row: 4.0 if row[0] else 3.9, (0.012, 0.035, -0.512)),
        ((False, True, False), lambda row: 1.0, (0.01234, 0.0, -0.51234)),
        ((True, True, True), lambda row: 0.0, (0.01234, 0.03456, -0.51234)),
    ],
)  # fmt: skip
def test_a_plain_place_is_taken_where_it_costs_nothing(free: Any, kept: Any, expected: Any) -> None:
    """On the axis, else to whole millimeters, within a thousandth of the scale.

    Of a small robot to less: a millimeter would be all of its workspace.
    """
    for factor in (1.0, 0.01):
        place = factor * np.array([0.01234, 0.03456, -0.51234]), 1.0
        rounds = Rounds(lambda row, _, f=factor: kept(row / f), lambda n: 0, [place])
        rounds.made._design = enlarged(APPENDIX_4, factor)
        rounds.made._free = np.array(free)
        rounds.made._holding = lambda centers: centers
        found = rounds.made.find(Control(5.0))
        assert found is not None
        assert np.divide(found.center, factor) == pytest.approx(expected, abs=1e-10)
        assert not np.signbit(found.center[:2]).any()


def test_a_place_on_the_axis_has_no_minus_zero() -> None:
    place = np.array([-0.001, -0.002, -0.5]), 1.0
    found = Rounds(lambda row, _: 1.0, lambda n: 0, [place]).made.find(Control(5.0))
    assert found == PlacedCenter((0.0, 0.0, -0.5), 1.0)
    assert not np.signbit(found.center[:2]).any()


def test_many_centers_are_compared_in_parts() -> None:
    """A broken position at the very end of a height that is kept counts; beyond it does not."""
    rng = np.random.default_rng(3)
    broken, centers = rng.uniform(-1, 1, (3000, 3)), rng.uniform(-0.2, 0.2, (150, 3))
    whole = search(_broken=broken)._scales(centers)
    parts = [search(_broken=broken)._scales(centers[i : i + 1])[0] for i in range(150)]
    np.testing.assert_array_equal(whole, parts)
    edge = np.array([[0.05, 0.0, 0.25]])
    for growth, half, scale in (
        (Growth.HORIZONTAL, (0.1, 0.1, 0.25), 0.5), (Growth.VERTICAL, (0.05, 0.1, 0.5), 0.5),
    ):  # fmt: skip
        for by, expected in ((0.0, scale), (1e-9, np.inf)):
            place = edge + ([0, 0, by] if growth is Growth.HORIZONTAL else [by, 0, 0])
            region = replace(REGION, half=half)
            made = search(growth=growth, _broken=place, _region=region)
            assert made._scales(np.zeros((1, 3)))[0] == expected
