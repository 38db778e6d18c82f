"""The largest workspace where searches, samples and reach are made up: stages, limits, causes."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.model import APPENDIX_4
from paminsa_viz.quantities.requirements import Requirement, Requirements, WorkspaceShape
from paminsa_viz.synthesis.proof import largest
from paminsa_viz.synthesis.proof.bisection import Gauge, Nearest
from paminsa_viz.synthesis.proof.evidence import Verdict
from paminsa_viz.synthesis.proof.families import Method
from paminsa_viz.synthesis.proof.largest import (
    FIRST_TOLERANCE,
    NOTHING,
    GrowingRegion,
    largest_workspace,
)
from paminsa_viz.synthesis.proof.placement import PlacedCenter
from paminsa_viz.synthesis.proof.regions import Growth, PoseRegion
from tests.synthesis.robots import TURN, cylinder

HALF = (0.15, 0.15, 0.1)
REGION = PoseRegion(WorkspaceShape.CYLINDER, (0.0, 0.0, -0.6), HALF, (-TURN, TURN))
CONDITION, LIFT = Requirement("condition", high=10.0), Requirement("f_4", high=450.0)
SAMPLED = Requirement("transmission", low=0.45)


class Clock(SimpleNamespace):
    """A control whose time does not go on."""

    left, over, boxes, elapsed = 10.0, False, 0, 0.0


def pose_at(scale: float, grows: Any = (True, True, True)) -> Any:
    """A pose of a gauge."""
    if grows[0]:
        return np.array([scale * HALF[0], 0.0, 0.1, -0.6])
    return np.array([0.0, 0.0, 0.1, -0.6 + scale * HALF[2]])


@pytest.fixture
def made_up(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Groups that break at some scales, and what was asked of them."""
    world = SimpleNamespace(reach=1.5, breaks={}, asked=[], left=None)

    def groups(design: Any, requirements: Requirements) -> Any:
        bisected = [b for b in requirements.bounds if b in world.breaks]
        return tuple(SimpleNamespace(requirements=(LIFT, b)) for b in bisected)

    def search(
        group: Any, gauge: Gauge, upper: float, tolerance: float, _: Any, time: float
    ) -> Any:
        bound = group.requirements[1]
        world.asked.append((bound, upper, tolerance, time))
        scale = world.breaks[bound]
        margins = np.array([0.25, 0.5])
        if world.left is not None:
            return Nearest(world.left, upper, None, -1, margins, 3)
        if scale > upper:
            return Nearest(upper, upper, None, -1, margins, 3)
        return Nearest(scale - tolerance, scale, pose_at(scale, gauge.grows), 1, margins, 3)

    monkeypatch.setattr(largest, "groups", groups)
    monkeypatch.setattr(largest, "nearest_violation", search)
    monkeypatch.setattr(largest, "reach_scale", lambda *_: world.reach)
    monkeypatch.setattr(
        largest, "least_free", lambda g, part: (np.full(4, part.half[0]), -0.1, "singularity")
    )
    return world


def growing(*bounds: Requirement, growth: Growth = Growth.ALL, control: Any = None) -> Any:
    requirements = Requirements(bounds, (-TURN, TURN))
    return GrowingRegion(APPENDIX_4, requirements, REGION, growth.axes, control or Clock())


@pytest.mark.parametrize("growth", Growth)
def test_bounds_close_in_stages_and_only_where_they_are_apart(made_up: Any, growth: Growth) -> None:
    """Each stage a quarter of the one before, of the extent that grows most."""
    other = replace(CONDITION, high=12.0)
    made_up.breaks = {CONDITION: 0.9, other: 1.3}
    region = growing(CONDITION, other, growth=growth)
    extent = 2 * (HALF[2] if growth is Growth.VERTICAL else HALF[0])
    region.run(1e-3)
    first = min(FIRST_TOLERANCE, 0.25 * 1.5 * extent)
    steps = [first, first / 4, first / 16, max(first / 64, 1e-3)]
    expected = [
        (CONDITION, 1.5, steps[0] / extent, 5.0),  # of the time what others leave
        (other, 0.9, steps[0] / extent, 10.0),
        *((CONDITION, 0.9, step / extent, np.inf) for step in steps[1:]),
    ]
    assert [row[0] for row in made_up.asked] == [row[0] for row in expected]
    for got, wanted in zip(made_up.asked, expected, strict=True):
        assert got[1:] == pytest.approx(wanted[1:])
    assert region.lower == pytest.approx(0.9 - steps[-1] / extent)
    assert region.upper == 0.9
    assert (region.cause, region.requirement) == ("condition", CONDITION)
    assert region.pose.tolist() == pose_at(0.9, growth.axes).tolist()


def test_a_small_reach_has_small_stages_and_a_later_limit_counts(made_up: Any) -> None:
    other = replace(CONDITION, high=12.0)
    made_up.reach, made_up.breaks = 0.1, {other: 0.08, CONDITION: 0.05}
    region = growing(other, CONDITION)
    region.run(1e-5)
    assert made_up.asked[0][1:3] == pytest.approx((0.1, 0.25 * 0.1))
    assert (region.cause, region.requirement) == ("condition", CONDITION)
    assert region.upper == 0.05
    assert region.lower == pytest.approx(0.05 - 1e-5 / 0.3)
    # the first one is known well enough from the first stage on
    assert [row[0] for row in made_up.asked].count(other) == 1
    # of two at the same scale the first one found
    made_up.breaks = {other: 0.05, CONDITION: 0.05}
    first = growing(other, CONDITION)
    first.run(1e-3)
    assert first.requirement == other
    nothing = growing(other)
    nothing.upper = 0.0
    made_up.asked.clear()
    nothing.run(1e-3)
    assert not made_up.asked
    assert nothing.cause == "singularity"


def test_a_search_that_is_over_ends_after_its_stage(made_up: Any) -> None:
    made_up.breaks = {CONDITION: 0.9}
    control = Clock()
    region = growing(CONDITION, control=control)
    control.over = True
    region.run(1e-3)
    assert len(made_up.asked) == 1
    assert region.lower == pytest.approx(0.9 - FIRST_TOLERANCE / 0.3)
    # what is known as well as that is not asked for again
    made_up.breaks = {CONDITION: 0.9}
    known = region._nearest[0]
    region._advance(0, region._groups[0], FIRST_TOLERANCE / 0.3)
    assert len(made_up.asked) == 1
    # nor is an answer taken that is no better
    made_up.left = known.lower
    region._advance(0, region._groups[0], 0.1 * FIRST_TOLERANCE / 0.3)
    assert len(made_up.asked) == 2
    assert region._nearest[0] is known
    made_up.left = None
    # a worse answer than the one before is not taken
    region._nearest[0] = replace(region._nearest[0], lower=0.85)
    made_up.breaks = {CONDITION: 0.84}
    region._advance(0, region._groups[0], 0.01)
    assert region._nearest[0].lower == 0.85
    assert (region.upper, region.pose.tolist()) == (0.84, pose_at(0.84).tolist())


def test_the_limit_of_reach_is_named_by_a_pose_just_beyond(
    made_up: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    region = growing()
    region.run(1e-3)
    assert (region.lower, region.upper, region.cause) == (1.5, 1.5, "singularity")
    assert region.pose == pytest.approx(np.full(4, 1.5 * HALF[0] * (1 + 1e-6)), rel=1e-9)
    for value, cause in ((0.0, "singularity"), (1e-12, "")):
        monkeypatch.setattr(largest, "least_free", lambda g, p, v=value: (p, v, "singularity"))
        region = growing()
        region.run(1e-3)
        assert region.cause == cause
    margin = Requirement("reach_margin", low=0.05)
    region = growing(CONDITION, margin)
    region.run(1e-3)
    assert (region.cause, region.requirement, region.pose) == ("reach_margin", margin, None)


def sampled_at(scale: float, asked: list[float]) -> Any:
    """Samples of which those beyond a scale break a requirement, one of them without a value."""

    def sample(design: Any, requirements: Any, requirement: Any, region: Any) -> Any:
        assert requirement is SAMPLED
        share = region.half[0] / HALF[0]
        asked.append(share)
        scales = share * np.linspace(1.0, 0.0, 11)
        margins = scale - scales
        margins[0] = np.nan if margins[0] < 0.0 else margins[0]
        return np.array([pose_at(one) for one in scales]), margins

    return sample


def test_samples_limit_both_bounds(made_up: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[float] = []
    monkeypatch.setattr(largest, "sample_requirement", sampled_at(0.7, asked))
    region = growing(CONDITION, SAMPLED)
    region.run(1e-3)
    # the nearest sample that breaks it is at half of all, then halfway between what holds and it
    assert asked[:3] == pytest.approx([1.5, 0.375, 0.5625])
    # down to the tolerance, which is 1 mm of the diameter
    step = 1e-3 / (2 * HALF[0])
    assert region.lower <= 0.7 < region.upper <= region.lower + step
    assert len(asked) < 20
    assert (region.cause, region.requirement) == ("transmission", SAMPLED)


def test_no_samples_are_taken_twice_and_none_for_the_evidence(
    made_up: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[float] = []
    monkeypatch.setattr(largest, "sample_requirement", sampled_at(0.7, asked))
    region = growing(CONDITION, SAMPLED)
    region.run(1e-3)
    assert len(set(asked)) == len(asked)
    inside = pytest.approx(region.lower * (1 - 1e-9), rel=1e-12)
    assert [share for share in asked if share == inside]
    count = len(asked)
    found = region.evidence(region.found)
    assert len(asked) == count
    assert (found[-1].key, found[-1].verdict) == (SAMPLED, Verdict.SAMPLED)
    assert found[-1].margin == pytest.approx(0.7 - region.lower, abs=1e-8)


def test_samples_end_at_the_first_that_hold_when_the_time_is_over(
    made_up: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[float] = []
    monkeypatch.setattr(largest, "sample_requirement", sampled_at(0.7, asked))
    control = Clock()
    control.over = True
    region = growing(SAMPLED, control=control)
    region.run(1e-3)
    # what breaks it at 1.5 is at 0.75 or more; half of that holds
    assert asked == pytest.approx([1.5, 0.375])
    assert region.lower == pytest.approx(0.375)
    assert 0.7 < region.upper <= 0.75 + 1e-9
    # what was found before the time was over is as fine as it was then
    known = growing(SAMPLED)
    known._sample()
    known.lower, known.control = 1.4, control
    asked.clear()
    known._sample_inside()
    assert 0.69 < known.lower <= 0.7
    assert len(asked) <= 1


def test_a_sample_that_just_holds_breaks_nothing(
    made_up: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    poses = np.array([pose_at(0.5)])
    for margin, broken in ((0.0, False), (-1e-300, True)):
        monkeypatch.setattr(
            largest, "sample_requirement", lambda *_, m=margin: (poses, np.array([m]))
        )
        region = growing(SAMPLED)
        assert region._sampled(SAMPLED, 1.0) is broken
        assert region.upper == (0.5 if broken else 1.5)
    # nothing is not looked at
    region.lower = NOTHING
    monkeypatch.setattr(largest, "sample_requirement", None)
    region._sample_inside()


def test_without_a_path_from_home_there_is_nothing(
    made_up: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(largest, "home_path", lambda *_: np.empty((0, 4)))
    monkeypatch.setattr(largest, "least_free", lambda *_: (np.zeros(4), 0.1, "reach"))
    region = growing(CONDITION, Requirement("reach_margin", low=0.01))
    region.run(1e-3)
    assert region.cause == ""
    assert (region.lower, region.upper, region.pose, made_up.asked) == (0.0, 0.0, None, [])


def test_what_is_nothing_is_no_region(made_up: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    region = growing()
    region.lower = 0.5
    monkeypatch.setattr(largest, "NOTHING", 0.5 * largest._INSIDE)
    assert region.found is None
    monkeypatch.undo()
    for lower, scale in ((0.5, 0.5), (1.001 * NOTHING, 1.001 * NOTHING), (NOTHING, None)):
        region.lower = lower
        if scale is None:
            assert region.found is None
        else:
            assert region.found.half == pytest.approx(
                np.array(HALF) * scale * (1 - 1e-9), rel=1e-12
            )


def test_evidence_is_what_the_searches_proved(
    made_up: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    made_up.breaks = {CONDITION: 0.3}
    region = growing(LIFT, CONDITION)
    region.run(1e-3)
    found = region.evidence(region.found)
    names = [(item.name, item.method, item.verdict) for item in found]
    assert names == [
        *((name, Method.CLOSED_FORM, Verdict.PROVEN) for name in ("reach", "singularity", "home")),
        ("f_4", Method.BISECTION, Verdict.PROVEN),
        ("condition", Method.BISECTION, Verdict.PROVEN),
    ]
    assert [(item.margin, item.boxes) for item in found[3:]] == [(0.25, 3), (0.5, 3)]


@pytest.mark.parametrize(
    ("place", "upper", "lower", "cause", "limit", "expected"),
    [
        (PlacedCenter((0.0, 0.0, -0.5), 1.2), 0.9, 0.8, "condition", 1.2, "condition"),
        (PlacedCenter((0.0, 0.0, -0.5), 0.7), 0.9, 0.8, "", 0.9, ""),
        (PlacedCenter((0.0, 0.0, -0.5), 0.7), 0.9, 0.0, "f_4", 0.9, "f_4"),
        (PlacedCenter((0.0, 0.0, -0.5), 0.0), 0.0, 0.0, "", 0.0, "home"),
        (None, 0.9, 0.8, "", 0.0, "volume"),
    ],
)
def test_an_answer_states_its_limit_its_gap_and_what_ends_it(
    made_up: Any, monkeypatch: pytest.MonkeyPatch, place: PlacedCenter | None, upper: float,
    lower: float, cause: str, limit: float, expected: str,
) -> None:  # fmt: skip
    """The limit is that about its center, or what poses tell of the best one."""
    free: list[Any] = []

    def search(*given: Any) -> Any:
        free.append(given[-2:])
        return SimpleNamespace(find=lambda control: place)

    def run(self: GrowingRegion, tolerance: float) -> None:
        assert tolerance == 1e-3
        self.lower, self.upper, self.cause = lower, upper, cause
        self.pose, self.requirement = np.arange(4.0), CONDITION

    limits: list[float] = []
    control = largest.Control
    monkeypatch.setattr(
        largest, "Control", lambda time, progress: limits.append(time) or control(time, progress)
    )
    monkeypatch.setattr(largest, "CenterSearch", search)
    monkeypatch.setattr(GrowingRegion, "run", run)
    needed = Requirements((CONDITION,), (-TURN, TURN))
    found = largest_workspace(APPENDIX_4, needed, cylinder(0.3, 0.2, None))
    assert free == [([False, False, True], False)]
    assert limits == [15.0]
    assert found.limit == pytest.approx([2 * limit * half for half in HALF] if place else [0.0] * 3)
    assert found.cause == expected
    proven = place is not None and lower > 0.0
    size = [2 * lower * half * (1 - 1e-9) if proven else 0.0 for half in HALF]
    assert found.gap == pytest.approx(max(np.subtract(found.limit, size)))
    assert found.theta == (-TURN, TURN)
    if proven:
        assert found.workspace is not None
        assert found.workspace.size == pytest.approx(size, rel=1e-12)
        assert found.workspace.center == (0.0, 0.0, -0.5)
        assert found.proof.verdict is Verdict.PROVEN
        assert len(found.proof.path) > 1
    else:
        open_ = place is not None and limit > 0.0
        assert found.workspace is None
        assert found.proof.verdict is (Verdict.UNDECIDED if open_ else Verdict.REFUTED)
        assert found.proof.region.half == (0.0, 0.0, 0.0)
    if proven:  # about a center that is given only its own limit counts
        given = largest_workspace(APPENDIX_4, needed, cylinder(0.3, 0.2, -0.5))
        assert given.limit == pytest.approx([2 * upper * half for half in HALF])
    assert (found.pose, found.requirement) == (
        ((0.0, 1.0, 2.0, 3.0), CONDITION) if place else (None, None)
    )
