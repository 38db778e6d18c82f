"""The nearest pose that breaks a made-up requirement, against its closed form; and the parts."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.model import APPENDIX_4
from paminsa_viz.model.resizing import TURN_LENGTH
from paminsa_viz.quantities.requirements import Requirement, WorkspaceShape
from paminsa_viz.synthesis.proof import bisection
from paminsa_viz.synthesis.proof.bisection import (
    SMALLEST,
    Control,
    Gauge,
    Nearest,
    first_box,
    nearest_violation,
)
from paminsa_viz.synthesis.proof.families import NONE, SLACK, Symmetry
from paminsa_viz.synthesis.proof.regions import PoseRegion

BOX, CYLINDER = WorkspaceShape.BOX, WorkspaceShape.CYLINDER
REGION = PoseRegion(BOX, (0.1, -0.2, -0.5), (0.2, 0.1, 0.4), (-0.3, 0.5))
ALL = (True, True, True)
LENGTHS = [0, 1, 3]


class Balls:
    """Requirements, each broken within a ball of positions and headings; bounds are exact."""

    design = APPENDIX_4
    family = SimpleNamespace(by_height=True)
    z = (-np.inf, np.inf)

    def __init__(self, *balls: tuple[Any, float], theta: Any = (-0.3, 0.5)) -> None:
        self.balls, self.theta = balls, theta
        self.requirements = (Requirement("tau_1", high=1.0),) * len(balls)
        self.sizes = np.ones(len(balls))

    def margins(self, middle: Any, half: Any) -> Any:
        away = [np.maximum(np.abs(middle - at) - half, 0.0) for at, _ in self.balls]
        return np.stack(
            [np.linalg.norm(a, axis=1) - r for a, (_, r) in zip(away, self.balls, strict=True)],
            axis=-1,
        )

    def pose_margins(self, poses: Any) -> Any:
        return self.margins(poses, np.zeros_like(poses))


def patient(rounds: int = 400) -> Control:
    """Return a control that ends a search after so many rounds, whatever time they take."""
    left = iter(range(rounds))
    return Control(60.0, lambda done: next(left, None) is None)


def region_at(scale: float, region: PoseRegion = REGION) -> tuple[Any, Any]:
    whole = region.scaled(scale, ALL)
    low, high = (np.array([*c[:2], t, c[2]]) for c, t in
                 zip((whole.low, whole.high), whole.theta, strict=True))  # fmt: skip
    return 0.5 * (low + high), 0.5 * (high - low)


def nearest(group: Balls, index: int) -> float:
    """The scale at which a region first touches a ball, by halving."""
    low, high = 0.0, 10.0
    for _ in range(60):
        scale = 0.5 * (low + high)
        middle, half = region_at(scale)
        clear = group.margins(middle[None], half[None])[0, index] > 0.0
        low, high = (scale, high) if clear else (low, scale)
    return low


def found(group: Any, upper: float, tolerance: float | None, **more: Any) -> Nearest:
    return nearest_violation(
        group, Gauge(REGION, ALL), upper, tolerance, more.pop("control", None) or patient(), **more
    )


FAR, NEAR = (np.array([0.45, -0.1, 0.2, -0.8]), 0.09), (np.array([-0.2, -0.4, 0.2, -0.3]), 0.16)


@pytest.mark.parametrize("balls", [(FAR, NEAR), (NEAR, FAR)])
@pytest.mark.parametrize("tolerance", [0.1, 0.02])
def test_two_bounds_hold_the_scale_at_which_a_requirement_breaks(
    balls: Any, tolerance: float
) -> None:
    group = Balls(*balls)
    first = [nearest(group, index) for index in range(2)]
    scale, index = min(first), int(np.argmin(first))
    control = patient()
    control.boxes = 7
    got = found(group, 3.0, tolerance, control=control)
    assert got.lower <= scale <= got.upper <= got.lower + tolerance * (1 + 1e-9)
    assert got.requirement == index
    assert got.pose is not None
    assert group.pose_margins(got.pose[None])[0, index] < 0.0
    assert Gauge(REGION, ALL).of_poses(got.pose[None])[0] == got.upper
    assert got.boxes == control.boxes - 7
    assert not len(got.remaining)  # nothing nearer than the tolerance is left
    # margins are those of the region that is proven, or of boxes that reach beyond it
    exact = group.margins(*(part[None] for part in region_at(got.lower)))[0]
    assert (got.margins >= -1e-12).all()
    assert (got.margins <= exact + 1e-9).all()
    assert np.abs(got.margins - exact).max() < 0.1


def test_without_a_broken_pose_all_is_proven() -> None:
    group = Balls(FAR, NEAR)
    scale = 0.95 * min(nearest(group, 0), nearest(group, 1))
    for tolerance in (None, 0.01):
        got = found(group, scale, tolerance)
        assert (got.lower, got.upper) == (scale, scale)
        assert got.pose is None
        assert got.requirement == -1
        assert not len(got.remaining)
        exact = group.margins(*(part[None] for part in region_at(scale)))[0]
        assert (got.margins > 0.0).all()
        assert (got.margins <= exact + 1e-9).all()


def test_the_first_broken_pose_is_enough_where_no_tolerance_is_asked_for() -> None:
    group = Balls(FAR, NEAR)
    quick, close = found(group, 3.0, None), found(group, 3.0, 1e-3)
    assert quick.pose is not None
    assert quick.boxes < close.boxes
    assert quick.lower <= close.upper
    assert quick.lower <= quick.upper
    assert len(quick.remaining)


def test_what_is_left_when_the_time_is_over_covers_the_region() -> None:
    for limits in ({"control": Control(0.0)}, {"time_limit": -1.0}):
        got = found(Balls(FAR), 1.5, 0.01, **limits)
        assert (got.lower, got.upper, got.boxes) == (0.0, 1.5, 0)
        middle, half = region_at(1.5)
        assert got.remaining == pytest.approx(np.array([[middle - half, middle + half]]))
        assert (got.remaining[0, 0] <= middle - half).all()
        assert (got.remaining[0, 1] >= middle + half).all()
        assert (got.margins == np.inf).all()


def test_boxes_that_cannot_be_cut_any_more_bound_what_is_proven(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of a requirement that holds everywhere, but whose bound never says so on one side."""
    tiny = PoseRegion(BOX, (0.0, 0.0, 0.0), (8e-9, 8e-9, 8e-9), (0.0, 0.0))

    class Unknown(Balls):
        def margins(self, middle: Any, half: Any) -> Any:
            self.smallest = min(self.smallest, half[:, 0].min())
            return np.where(middle[:, :1] + half[:, :1] < 3e-9, 1.0, -1.0)

        def pose_margins(self, poses: Any) -> Any:
            return np.ones((len(poses), 1))

    monkeypatch.setattr(bisection, "_SPECK", 0.0)
    for slack in (1.0, 0.4):  # also where a box is as large as the smallest
        region = replace(tiny, half=(8 * slack * SMALLEST,) * 3)
        group = Unknown(FAR, theta=(0.0, 0.0))
        group.smallest = np.inf
        got = nearest_violation(group, Gauge(region, ALL), 1.0, None, patient())  # type: ignore
        assert got.pose is None
        assert not len(got.remaining)
        # the boxes from 3e-9 on are left over
        nearest_left = 3e-9 / region.half[0]
        assert nearest_left - 0.25 / slack <= got.lower <= nearest_left
        assert SMALLEST / 2 < group.smallest <= SMALLEST


def test_poses_that_stand_for_others_keep_some_margin_free(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    class Nearly(Balls):
        def margins(self, middle: Any, half: Any) -> Any:
            return np.full((len(middle), 1), 0.5 * SLACK * 200.0)

        def pose_margins(self, poses: Any) -> Any:
            return self.margins(poses, poses)

    group: Any = Nearly(FAR)
    group.sizes = np.array([200.0])
    assert found(group, 1.0, None).boxes == 1
    monkeypatch.setattr(bisection, "symmetry", lambda *_: Symmetry(False, True))
    seen: list[float] = []
    control = Control(5.0, lambda done: bool(seen.append(done)) or len(seen) > 5)
    assert found(group, 1.0, None, control=control).boxes > 5
    group.sizes = np.array([99.0])
    assert found(group, 1.0, None).boxes == 1


@pytest.mark.parametrize("shape", WorkspaceShape)
@given(seed=st.integers(0, 999))
def test_a_gauge_is_the_scale_of_the_smallest_region_around_a_pose(
    shape: WorkspaceShape, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    half = (0.2, 0.2, 0.4) if shape is CYLINDER else REGION.half
    region = replace(REGION, shape=shape, half=half)
    unit = rng.uniform(-1.5, 1.5, (40, 4))
    poses = unit * [*half[:2], 0.3, half[2]] + [*region.center[:2], 0.0, region.center[2]]
    for grows in product((False, True), repeat=3):
        if grows[0] != grows[1]:
            continue
        gauge = Gauge(region, grows)
        scale = gauge.of_poses(poses)
        share = np.abs(unit[:, LENGTHS])
        if shape is CYLINDER:
            share[:, :2] = np.hypot(*unit[:, :2].T)[:, None]
        beyond = (share > 1.0)[:, ~np.array(grows)].any(axis=1)
        grown = share[:, np.array(grows)].max(axis=1, initial=0.0)
        assert scale == pytest.approx(np.where(beyond, np.inf, grown), rel=1e-12)
        # of boxes that of their nearest pose, never more
        wide = rng.uniform(0.0, 0.1, poses.shape)
        toward = np.array([*region.center[:2], 0.0, region.center[2]])
        near = np.clip(toward, poses - wide, poses + wide)
        least, exact = gauge.of_boxes(poses, wide), gauge.of_poses(near)
        assert (least <= exact).all()
        assert least == pytest.approx(exact, rel=1e-12, abs=1e-12)
    # at the edge of what does not grow nothing is beyond it
    edge = np.array([[region.center[0], region.center[1], 0.0, region.center[2] + half[2]]])
    assert Gauge(region, (True, True, False)).of_poses(edge)[0] == 0.0


def test_the_boxes_of_least_gauge_are_taken_first() -> None:
    middle = np.zeros((5, 4))
    middle[:, 0] = 0.1 + 0.2 * np.array([0.9, 0.1, 0.7, 0.3, 0.5])
    middle[:, 1], middle[:, 3] = -0.2, -0.5
    for count, first in ((2, [0.1, 0.3]), (5, [0.1, 0.3, 0.5, 0.7, 0.9]), (9, None)):
        pool = bisection._Pool(Gauge(REGION, ALL), middle, np.zeros((5, 4)))
        taken, half, near = pool.take(count)
        expected = sorted(first or [0.1, 0.3, 0.5, 0.7, 0.9])
        assert np.sort(near) == pytest.approx(expected)
        assert np.sort((taken[:, 0] - 0.1) / 0.2) == pytest.approx(expected)
        assert half.shape == taken.shape
        assert len(pool.gauge) == len(pool.boxes) == 5 - len(expected)


def test_where_no_pose_is_meant_all_holds() -> None:
    group: Any = Balls(FAR, NEAR)
    group.z = (1.0, 2.0)
    got = found(group, 1.5, None)
    assert (got.lower, got.upper, got.pose, got.requirement) == (1.5, 1.5, None, -1)
    assert (got.margins.tolist(), got.boxes, got.remaining.shape) == ([np.inf] * 2, 0, (0, 2, 4))


def test_a_pose_just_beyond_an_extent_that_does_not_grow_is_beyond_it() -> None:
    """By more than rounding."""
    whole = Gauge(
        PoseRegion(BOX, (0.0, 0.0, 0.0), (1.0, 1.0, 1.0), (0.0, 0.0)), (True, True, False)
    )
    heights = np.array([1.0, 1.0 + 1e-13, 1.0 + 2e-13])
    poses = np.column_stack([np.zeros((3, 3)), heights])
    assert whole.of_poses(poses).tolist() == [0.0, 0.0, np.inf]


def test_a_side_without_width_is_left_by_any_step() -> None:
    flat = Gauge(replace(REGION, half=(0.2, 0.1, 0.0)), ALL)
    poses = np.array([[0.1, -0.2, 0.0, -0.5], [0.3, -0.2, 0.0, -0.5], [0.1, -0.2, 0.0, -0.4999]])
    assert flat.of_poses(poses) == pytest.approx([0.0, 1.0, np.inf])


def test_a_box_is_cut_along_its_longest_side() -> None:
    """A radian counts as the length of a turn; the halves meet and leave nothing out."""
    rng = np.random.default_rng(1)
    middle, half = rng.uniform(-1, 1, (2000, 4)), rng.uniform(0, 1, (2000, 4))
    half[:, 2] /= TURN_LENGTH
    center, size = (part.reshape(2, -1, 4) for part in bisection._cut(middle, half, TURN_LENGTH))
    side = np.argmax(half * [1.0, 1.0, TURN_LENGTH, 1.0], axis=1)
    assert set(side.tolist()) == {0, 1, 2, 3}
    cut = np.eye(4, dtype=bool)[side]
    low, high = center - size, center + size
    for part in range(2):
        np.testing.assert_array_equal(center[part][~cut], middle[~cut])
        np.testing.assert_array_equal(size[part][~cut], half[~cut])
    assert (low[0] <= (middle - half))[cut].all()
    assert (high[1] >= (middle + half))[cut].all()
    assert (high[0] >= low[1])[cut].all()
    assert size[0][cut] == pytest.approx(0.5 * half[cut], rel=1e-13)
    assert high[0][cut] == pytest.approx(middle[cut], abs=1e-14)
    assert low[1][cut] == pytest.approx(middle[cut], abs=1e-14)


def group_of(theta: Any, z: Any, high: bool) -> Any:
    return SimpleNamespace(
        theta=theta, z=z, family=SimpleNamespace(by_height=high)
    )  # fmt: skip


def test_the_first_box_is_around_all_poses_that_are_meant() -> None:
    low, high = np.array([-0.1, -0.3, -0.3, -0.9]), np.array([0.3, -0.1, 0.5, -0.1])
    group = group_of((-0.3, 0.5), (-np.inf, np.inf), True)

    def ends(group: Any, same: Symmetry = NONE, region: PoseRegion = REGION) -> tuple[Any, Any]:
        box = first_box(group, region, same)
        assert box is not None
        (middle,), (half,) = box
        return middle - half, middle + half

    for got, wanted in zip(ends(group), (low, high), strict=True):
        assert got == pytest.approx(wanted, abs=1e-12)
    assert (ends(group)[0] < low).all()
    assert (ends(group)[1] > high).all()
    # headings from zero on stand for all
    assert ends(group, Symmetry(False, True))[0] == pytest.approx([*low[:2], 0.0, low[3]])
    assert ends(group, Symmetry(True, False))[0] == pytest.approx(low)
    # its own heights, and none beyond the region
    part = ends(group_of((0.1, 0.2), (-0.6, 3.0), True))
    assert part[0] == pytest.approx([*low[:2], 0.1, -0.6])
    assert part[1] == pytest.approx([*high[:2], 0.2, -0.1])
    part = ends(group_of((0.1, 0.2), (-3.0, -0.6), True))
    assert (part[0][3], part[1][3]) == pytest.approx((-0.9, -0.6))
    assert first_box(group_of((0.1, 0.2), (0.0, 3.0), True), REGION, NONE) is None
    # a single heading, and heights that play no part: the nearest to the center
    for z, height in (((-np.inf, np.inf), -0.5), ((-0.3, 3.0), -0.3), ((-3.0, -0.7), -0.7)):
        box = first_box(group_of((0.1, 0.1), z, False), REGION, NONE)
        assert box is not None
        assert box[0][0, 3] == height
        assert box[1][0, [2, 3]].tolist() == [0.0, 0.0]
    assert ends(group_of((0.1, 0.1), (-0.9, -0.9), True))[0] == pytest.approx([*low[:2], 0.1, -0.9])


def test_a_search_stops_when_the_progress_function_says_so_and_not_before() -> None:
    told: list[float] = []
    control = Control(1e3, lambda done: bool(told.append(done)) or len(told) == 3)
    assert [control.over for _ in range(4)] == [False, False, True, True]
    assert len(told) == 3
    assert control.boxes == 0
    assert 0.0 <= told[0] <= told[-1] < 1e-3
    assert control.left == pytest.approx(1e3 - control.elapsed, abs=0.1)
    assert not Control(0.9).over
    for limit in (0.0, -1.0):
        told.clear()
        over = Control(limit, lambda done: bool(told.append(done)))
        assert over.over
        assert told == [1.0]


@pytest.mark.parametrize("upper", [np.inf, 1.2, 0.9])
def test_the_nearest_pose_looked_at_that_breaks_a_requirement_counts(upper: float) -> None:
    """Of each box the pose nearest to the center, at its middle heading, and its middle."""
    balls = (np.array([0.3, -0.2, 0.1, -0.5]), 0.15), (np.array([0.1, -0.3, 0.1, -0.6]), 0.1)
    group: Any = Balls(*balls)
    gauge, rng = Gauge(REGION, ALL), np.random.default_rng(3)
    center, size = region_at(1.5)
    for count in (1, 3, 40):
        middle = center + size * rng.uniform(-1, 1, (count, 4))
        half = rng.uniform(0, 0.1, (count, 4))
        best = None
        for m, h in zip(middle, half, strict=True):
            near = np.clip([0.1, -0.2, m[2], -0.5], m - h, m + h)
            for pose in (near, m):
                margins, far = group.pose_margins(pose[None])[0], gauge.of_poses(pose[None])[0]
                if far <= upper and (margins < 0.0).any() and (best is None or far < best[0]):
                    best = far, pose, int(np.argmax(margins < 0.0))
        got = bisection._broken(group, gauge, middle, half, upper)
        assert (got is None) == (best is None)
        if got is not None and best is not None:
            assert (got[0], got[2]) == (best[0], best[2])
            np.testing.assert_array_equal(got[1], best[1])
            # also at the very bound
            assert bisection._broken(group, gauge, middle, half, got[0]) is not None
            assert bisection._broken(group, gauge, middle, half, got[0] * (1 - 1e-12)) is None
    assert best is not None
    none = np.empty((0, 4))
    assert bisection._broken(group, gauge, none, none, upper) is None
    for value, broken in ((0.0, False), (-1e-300, True), (np.nan, True)):
        group.pose_margins = lambda poses, v=value: np.full((len(poses), 2), v)
        assert (bisection._broken(group, gauge, middle, half, upper) is not None) is broken


class Undecided(Balls):
    """Bounds that are all the same, and poses that break nothing."""

    value = -1.0

    def margins(self, middle: Any, half: Any) -> Any:
        return np.full((len(middle), 1), self.value)

    def pose_margins(self, poses: Any) -> Any:
        return np.ones((len(poses), 1))


def test_a_margin_of_nothing_is_enough_and_boxes_of_the_smallest_size_are_not_cut() -> None:
    group = Undecided(FAR)
    group.value = 0.0
    got = found(group, 1.0, None)
    assert (got.boxes, got.margins.tolist(), got.lower) == (1, [0.0], 1.0)
    group.value = -1.0
    still = replace(REGION, center=(0.0, 0.0, 0.0), half=(0.0, 0.0, 0.0), theta=(0.0, 0.0))
    group.theta = (0.0, 0.0)
    assert nearest_violation(group, Gauge(still, ALL), 1.0, None, patient()).boxes == 1  # type: ignore
    unit = replace(still, half=(1.0, 1.0, 1.0))
    box = np.zeros((1, 4)), np.full((1, 4), SMALLEST)
    for size, boxes in ((1.0, 1), (1.0 + 1e-9, 2)):
        control = patient(3)
        with pytest.MonkeyPatch.context() as patched:
            patched.setattr(bisection, "first_box", lambda *_, s=size: (box[0], box[1] * s))
            nearest_violation(group, Gauge(unit, ALL), 1.0, None, control)  # type: ignore
        assert control.boxes >= boxes
        assert (control.boxes == 1) is (boxes == 1)


def test_a_search_ends_where_too_many_boxes_wait(monkeypatch: pytest.MonkeyPatch) -> None:
    for most, boxes in ((3, 3), (4, 7), (7, 7), (8, 15)):
        monkeypatch.setattr(bisection, "MOST_BOXES", most)
        got = found(Undecided(FAR), 1.0, None)
        assert got.boxes == boxes
        assert len(got.remaining) == boxes + 1


def test_the_margin_of_a_region_without_size_is_that_of_its_center() -> None:
    group = Balls(FAR, NEAR)
    got = found(group, 0.0, None)
    exact = group.margins(*(part[None] for part in region_at(0.0)))[0]
    assert got.margins == pytest.approx(exact, abs=1e-9)
