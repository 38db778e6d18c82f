"""What a trial costs, part by part: by how much it fails, where, and what is least."""

from __future__ import annotations

from dataclasses import fields, replace
from types import SimpleNamespace
from typing import Any, ClassVar

import numpy as np
import pytest

from paminsa_viz.elastostatics import platform_stiffness
from paminsa_viz.errors import InvalidDesign
from paminsa_viz.model import APPENDIX_4, measure_singularity
from paminsa_viz.quantities.requirements import Requirement, Workspace, WorkspaceShape
from paminsa_viz.synthesis import Density, Evaluator, ObjectiveLimit, Regime
from paminsa_viz.synthesis.search import evaluation
from paminsa_viz.synthesis.search.evaluation import REFUSED, STAGES, TrialEvaluation
from paminsa_viz.synthesis.search.extremes import Extent
from paminsa_viz.synthesis.search.region import SPARSE
from paminsa_viz.synthesis.search.trial import Robots, TrialRobot
from tests.synthesis.search_cases import CYLINDER, TURN

NONE = np.zeros(0)


def evaluator(*bounds: Requirement, regime: Regime = Regime.SMALLER, **changes: Any) -> Evaluator:
    own = {name: changes.pop(name) for name in ("tighter", "relaxed") if name in changes}
    theta = changes.pop("theta", CYLINDER.requirements.theta)
    required = replace(CYLINDER.requirements, bounds=bounds, theta=theta)
    return Evaluator(replace(CYLINDER, requirements=required, **changes), regime, **own)


def test_the_sooner_a_trial_fails_the_more_it_costs() -> None:
    def cost(stage: int, violation: float, objective: float = np.nan, sign: float = 1.0) -> float:
        return TrialEvaluation(stage, violation, objective, NONE, NONE, None).cost(sign)

    assert cost(STAGES, 0.0, 2.5) == 2.5
    assert cost(STAGES, 0.0, 2.5, -1.0) == -2.5
    for stage in range(STAGES):
        shares = [0.0, 0.5, 1.0, 3.0, 1e9, np.inf]
        costs = [cost(stage, share) for share in shares]
        assert costs == sorted(costs)
        assert costs[2] == REFUSED * (STAGES - stage + 0.5)
        assert costs[3] == REFUSED * (STAGES - stage + 0.75)
        assert costs[-1] == REFUSED * (STAGES - stage + 1.0)
        assert costs[0] >= REFUSED
    assert cost(3, np.inf) >= cost(4, np.inf) > cost(4, 0.1)
    found = TrialEvaluation(3, 0.1, np.nan, np.array([1.0]), np.array([2.0]), None)
    assert found.values.tolist() == [1.0, 2.0]
    assert not found.feasible


def test_the_value_nearest_to_a_bound_and_by_what_share_it_breaks_it() -> None:
    both = Requirement("tau_1", low=-5.0, high=20.0)
    cases: list[tuple[Requirement, tuple[float, float], tuple[float, float]]] = [
        (Requirement("condition", high=10.0), (2.0, 8.0), (8.0, 0.0)),
        (Requirement("condition", high=10.0), (2.0, 12.0), (12.0, 0.2)),
        (Requirement("stiffness_x", low=4.0), (3.0, 9.0), (3.0, 0.25)),
        (Requirement("tau_1", high=-4.0), (-9.0, -3.0), (-3.0, 0.25)),
        (both, (-4.0, 10.0), (-4.0, 0.0)), (both, (0.0, 19.0), (19.0, 0.0)),
        (both, (-6.0, 10.0), (-6.0, 0.2)), (both, (-5.5, 25.0), (25.0, 0.25)),
        (Requirement("determinant", high=0.0), (-1.0, 0.3), (0.3, 0.3)),
    ]  # fmt: skip
    for bound, extremes, expected in cases:
        assert evaluator(bound)._worst(0, bound, extremes) == pytest.approx(expected), bound
    bound = Requirement("condition", high=10.0)
    tight = evaluator(bound, tighter=(1.5,))
    assert tight._worst(0, bound, (2.0, 8.0)) == pytest.approx((8.0, 0.0))
    assert tight._worst(0, bound, (2.0, 9.5)) == pytest.approx((9.5, 0.1))
    value, broken = tight._worst(0, bound, (np.nan, np.nan))
    assert np.isnan(value)
    assert broken == 0.0
    assert np.isnan(tight._worst(0, bound, (1.0, np.nan))[0])


def test_limits_of_other_objectives_are_broken_by_their_share() -> None:
    limits = (ObjectiveLimit("footprint", 0.5), ObjectiveLimit("volume", 0.02))
    volume = SimpleNamespace(size=(0.3, 0.3, 0.2), shape=WorkspaceShape.BOX, center=(0, 0, 0))
    trial: Any = SimpleNamespace(footprint=0.6, workspace=volume)
    one = evaluator(Requirement("condition", high=10.0), limits=limits)
    over, values = one._limits(trial)
    assert values == pytest.approx([0.6, 0.018])
    assert over == pytest.approx(0.1 / 0.5 + 0.002 / 0.02)
    tight = replace(one, tighter=(0.0, 0.05, 0.001))
    assert tight._limits(trial)[0] == pytest.approx(0.15 / 0.5 + 0.003 / 0.02)
    assert replace(one, relaxed=1)._limits(trial)[0] == pytest.approx(0.002 / 0.02)
    assert replace(one, relaxed=2)._limits(trial)[0] == pytest.approx(0.1 / 0.5)
    trial.footprint = 0.4
    assert one._limits(trial)[0] == pytest.approx(0.1)
    for most, share in ((-0.5, 0.9 / 0.5), (0.0, 0.4)):
        none = evaluator(limits=(ObjectiveLimit("footprint", most),))
        assert none._limits(trial)[0] == pytest.approx(share)
    # what is relaxed is minimized, by how much it is broken
    worst, found = np.array([12.0]), np.array([0.6, 0.018])
    assert one._objective(trial, worst, found) == 0.4
    assert replace(one, relaxed=0)._objective(trial, worst, found) == pytest.approx(2.0)
    assert replace(one, relaxed=1)._objective(trial, worst, found) == pytest.approx(0.1)
    assert replace(one, relaxed=2)._objective(trial, worst, found) == pytest.approx(0.002)


def test_a_trial_that_costs_more_anyway_is_given_up() -> None:
    trial: Any = SimpleNamespace(footprint=0.6)
    one = evaluator(Requirement("condition", high=10.0))
    assert one._is_worse(trial, 0.59)
    assert not one._is_worse(trial, 0.6)
    assert not one._is_worse(trial, 0.61)
    assert not one._is_worse(trial, REFUSED)
    assert not replace(one, relaxed=0)._is_worse(trial, 0.1)
    large = evaluator(Requirement("condition", high=10.0), objective="volume")
    trial.workspace = SimpleNamespace(size=(0.3, 0.3, 0.2), shape=WorkspaceShape.BOX)
    assert large._is_worse(trial, -0.0181)
    assert not large._is_worse(trial, -0.0179)


def robots(
    rb: float, rp: float, margins: Any = None, beyond: float = 0.0, wide: float = 0.2
) -> Any:
    geometry = replace(
        APPENDIX_4.geometry, base_radius=rb, platform_radius=rp, crank_length=0.4,
        coupler_length=0.6,
    )  # fmt: skip
    space = Workspace(WorkspaceShape.CYLINDER, (wide, wide, 0.1), (0.0, 0.0, -0.6))
    return SimpleNamespace(
        geometries=[geometry], workspaces=[space], spans=SimpleNamespace(beyond=np.array([beyond])),
        margins=np.array([[0.1] * 4 if margins is None else margins]),
    )  # fmt: skip


def test_singularities_in_the_way_as_a_share_of_both_radii() -> None:
    """The circle has to be outside the workspace, the turn beyond the headings."""
    smaller = evaluator(theta=(-0.5, 0.3))
    assert smaller._singular(robots(0.4, 0.1)) == 0.0
    assert smaller._singular(robots(0.24, 0.15)) == pytest.approx(0.01 / 0.39, rel=1e-6)
    turned = evaluator(theta=(2 * np.pi - 0.5, 2 * np.pi + 0.3))
    assert turned._singular(robots(0.4, 0.1)) == 0.0
    turn = 0.13 - 0.14 * np.cos(0.5)  # and the circle is too small by 90 mm
    assert smaller._singular(robots(0.14, 0.13)) == pytest.approx((turn + 0.09) / 0.27, rel=1e-6)
    larger = evaluator(theta=(-0.5, 0.3), regime=Regime.LARGER)
    assert larger._singular(robots(0.1, 0.4)) == 0.0
    assert larger._singular(robots(0.4, 0.1)) == pytest.approx(0.3 / 0.5, rel=1e-6)
    # at half a turn no circle is larger, and every turn is passed
    half = evaluator(theta=(3.0, 3.2), regime=Regime.LARGER)
    assert half._singular(robots(0.05, 0.06, wide=0.21)) == 0.0
    assert evaluator(theta=(0.0, 6.28))._singular(robots(0.4, 0.1)) == pytest.approx(1.0)
    aside = evaluator(theta=(1.5, 2.0), regime=Regime.LARGER)
    assert 0 < aside._singular(robots(0.3, 0.3)) < 1e-8  # as large as each other
    # with other headings the circle is larger: at its least distance from zero, and from full turns
    full = 2 * np.pi
    for theta in ((0.3, 0.6), (-0.6, -0.3), (full - 0.6, full - 0.3), (0.3 - full, 0.6 - full)):
        away = evaluator(theta=theta, regime=Regime.LARGER)
        circle = np.sqrt(0.15**2 + 0.16**2 - 2 * 0.15 * 0.16 * np.cos(0.3))
        assert away._singular(robots(0.15, 0.16)) == pytest.approx((0.1 - circle) / 0.31, rel=1e-6)
    assert 0 < smaller._singular(robots(0.5, 0.25, wide=0.5)) < 1e-8  # the circle touches


def test_reach_that_is_missing_as_a_share_of_the_bars() -> None:
    """A bound on the margin counts where it is more than the case's own; the guide may be used."""
    one = evaluator(margin=0.01)

    def short(found: Evaluator, *margins: float, beyond: float = 0.0) -> float:
        (value,) = found._beyond_reach(robots(0.4, 0.1, margins, beyond))
        return float(value)

    assert short(one, 0.02, 0.02, 0.02, 0.02) == 0.0
    assert short(one, 0.004, 0.02, 0.02, 0.02) == pytest.approx(0.006)
    assert short(one, 0.004, 0.02, 0.0, 0.02) == pytest.approx(0.016)
    bound = Requirement("reach_margin", low=0.03)
    more = evaluator(bound, margin=0.01)
    assert short(more, 0.02, 0.05, 0.05, 0.05) == pytest.approx(0.01)
    assert short(replace(more, relaxed=0), 0.02, 0.05, 0.05, 0.05) == 0.0
    assert short(replace(more, tighter=(0.005,)), 0.02, 0.05, 0.05, 0.05) == pytest.approx(0.015)
    assert short(one, 0.02, 0.02, 0.02, 0.02, beyond=0.2) == pytest.approx(0.2)
    assert short(one, 0.02, 0.02, 0.02, 0.02, beyond=-0.2) == 0.0
    above = evaluator(margin=0.01, above_guides=True)
    assert short(above, 0.02, 0.02, 0.02, 0.02, beyond=0.2) == 0.0
    free = evaluator(margin=0.0)
    for place in range(4):
        margins = [0.02] * 4
        margins[place] = 0.0
        assert (short(free, *margins) > 0.0) == (place != 2)


def test_the_clearance_that_every_pose_needs() -> None:
    def needed(*bounds: Requirement, **changes: Any) -> float | None:
        return evaluator(*bounds, **changes)._needed_clearance

    plain, more = Requirement("clearance", low=0.002), Requirement("clearance", low=0.005)
    assert needed() is None
    assert needed(plain, more) == 0.005
    assert needed(plain, more, relaxed=1) == 0.002
    assert needed(plain, tighter=(0.001,)) == pytest.approx(0.003)
    assert needed(Requirement("clearance", low=0.002, theta=(0.0, 0.1))) is None
    assert needed(Requirement("clearance", low=0.002, z=(-1.0, -0.5))) is None
    assert needed(Requirement("clearance", high=0.5)) is None
    one = evaluator(plain)
    trial: Any = SimpleNamespace(
        plate_distance=lambda theta, enough: 0.5 * enough, geometry=APPENDIX_4.geometry
    )
    assert one._beside_platform(trial) == pytest.approx(0.001 / 0.1)
    assert evaluator()._beside_platform(trial) == 0.0
    # those that are looked at last
    bounds = (Requirement("condition", high=9.0), plain, Requirement("clearance", high=0.5))
    assert evaluator(*bounds)._clearances == (1,)


@pytest.mark.parametrize(("times", "count"), [(1, 117), (2, 925)])
def test_what_takes_long_is_measured_at_as_many_poses_as_the_page_says(
    times: int, count: int
) -> None:
    space = Workspace(WorkspaceShape.CYLINDER, (0.3, 0.3, 0.4), (0.0, 0.0, -0.9))
    assert len(Extent(space, (-TURN, TURN)).samples(SPARSE.finer(times))) == count


def test_what_is_largest_has_the_other_sign_unless_a_bound_is_relaxed() -> None:
    assert evaluator()._sign == 1.0
    assert evaluator(objective="volume")._sign == -1.0
    assert evaluator(Requirement("f_4", high=1.0), objective="volume", relaxed=0)._sign == 1.0


# ---------------------------------------------------------------- stage by stage


class MadeUp(Evaluator):
    """An evaluator whose values over the poses are given."""

    beside = 0.0
    values: ClassVar[dict[int, tuple[float, float]]] = {}
    least: ClassVar[dict[int, float]] = {}
    limited: ClassVar[list[float]] = []
    asked: ClassVar[list[int]] = []

    def _beside_platform(self, trial: Any) -> float:
        return self.beside

    def _of(self, *quantities: str) -> Any:
        for index, bound in enumerate(self.case.requirements.bounds):
            if bound.quantity in quantities:
                self.asked.append(index)
                yield index, self.values[index]

    def _conditions(self, trial: Any) -> Any:
        return self._of("condition")

    def _torques(self, trial: Any) -> Any:
        return self._of("tau_1", "f_4")

    def _others(self, trial: Any) -> Any:
        return self._of("determinant")

    def _least(self, trial: Any, bound: Requirement) -> float:
        index = self.case.requirements.bounds.index(bound)
        self.asked.append(index)
        return self.least[index]


BOUNDS = (
    Requirement("condition", high=10.0), Requirement("condition", high=4.0, theta=(0.0, 0.0)),
    Requirement("tau_1", high=8.0), Requirement("f_4", low=100.0),
    Requirement("determinant", high=2.0), Requirement("clearance", low=0.5),
    Requirement("clearance", low=0.25, theta=(0.0, 0.1)), Requirement("reach_margin", low=0.01),
)  # fmt: skip
MET = {0: (1.0, 9.0), 1: (1.0, 3.0), 2: (-1.0, 7.0), 3: (101.0, 200.0), 4: (-3.0, 1.0)}
LEAST = {5: 0.6, 6: 0.3}


def judged(
    monkeypatch: pytest.MonkeyPatch,
    values: dict[int, tuple[float, float]] | None = None,
    least: dict[int, float] | None = None,
    *,
    beside: float = 0.0,
    most: float = np.inf,
    best: float = np.inf,
    footprint: float = 0.6,
    mass: float = 3.0,
    **more: Any,
) -> tuple[TrialEvaluation, list[int]]:
    """What becomes of a trial that meets all but what is given, and the bounds that are asked."""
    for name, value in (
        ("values", MET | (values or {})), ("least", LEAST | (least or {})), ("beside", beside),
        ("asked", []),
    ):  # fmt: skip
        monkeypatch.setattr(MadeUp, name, value)
    plain = evaluator(*BOUNDS, limits=(ObjectiveLimit("static_torque", 5.0),), **more)
    one = MadeUp(plain.case, plain.regime, tighter=plain.tighter, relaxed=plain.relaxed)
    trial: Any = SimpleNamespace(footprint=footprint, static_torque=mass, inner=None)
    return one._over_poses(trial, np.array([0.3, 0.2, 0.4, 0.5]), most, best), MadeUp.asked


def test_a_trial_fails_at_the_first_stage_with_all_that_is_broken_there(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found, asked = judged(monkeypatch)
    assert (found.stage, found.violation, found.objective) == (STAGES, 0.0, 0.6)
    assert found.worst.tolist() == [9.0, 3.0, 7.0, 101.0, 1.0, 0.6, 0.3, 0.2]
    assert found.limits.tolist() == [3.0]
    assert asked == [0, 1, 2, 3, 4, 5, 6]
    # exactly at the bounds nothing is broken
    at = {0: (1.0, 10.0), 1: (1.0, 4.0), 2: (-1.0, 8.0), 3: (100.0, 200.0), 4: (0.0, 2.0)}
    assert judged(monkeypatch, at, {5: 0.5, 6: 0.25}, mass=5.0)[0].feasible
    broken = {0: (1.0, 11.0), 1: (1.0, 5.0), 2: (0.0, 10.0), 3: (90.0, 95.0), 4: (0.0, 3.0)}
    few, many = {5: 0.4, 6: 0.2}, 6.0
    for stage, violation, asked in (
        (4, 0.07, []), (5, 0.1 + 0.25, [0, 1]), (6, 0.25 + 0.1 + 0.2, [0, 1, 2, 3]),
        (7, 0.5, [0, 1, 2, 3, 4]), (7, 0.2 + 0.2, [0, 1, 2, 3, 4, 5, 6]),
    ):  # fmt: skip
        found, seen = judged(
            monkeypatch, broken, few, beside=0.07 if stage == 4 else 0.0, mass=many
        )
        assert (found.stage, seen) == (stage, asked)
        assert found.violation == pytest.approx(violation)
        assert np.isnan(found.objective)
        assert np.isfinite(found.worst[:7]).tolist() == [i in seen for i in range(7)]
        assert found.worst[7] == 0.2
        assert np.isnan(found.limits).all() == (stage < 6)
        # what was broken there is mended, and the next stage decides
        for index in seen:
            broken.pop(index, None)
        many = 3.0 if stage == 6 else many
        if stage == 7 and len(seen) == 5:
            broken = {}


def test_what_is_relaxed_breaks_nothing_and_is_minimized(monkeypatch: pytest.MonkeyPatch) -> None:
    for index, extremes, by in (
        (0, (1.0, 13.0), 3.0), (1, (1.0, 6.0), 2.0), (2, (-1.0, 9.5), 1.5), (3, (40.0, 90.0), 60.0),
        (4, (0.0, 7.0), 5.0), (2, (-1.0, 6.0), -2.0),
    ):  # fmt: skip
        found, _ = judged(monkeypatch, {index: extremes}, relaxed=index)
        assert found.feasible
        assert found.objective == pytest.approx(by)
        found, asked = judged(monkeypatch, {index: extremes}, relaxed=index, best=by)
        assert found.feasible
        assert 5 not in asked
    for index, low, by in ((5, 0.1, 0.4), (6, 0.2, 0.05), (5, 0.8, -0.3)):
        # whatever the best of the others costs: only then is it known
        found, asked = judged(monkeypatch, least={index: low}, relaxed=index, best=-100.0)
        assert found.feasible
        assert found.objective == pytest.approx(by)
        assert asked[-2:] == [5, 6]
        found, _ = judged(monkeypatch, least={11 - index: 0.0}, relaxed=index)
        assert (found.stage, found.violation) == (STAGES - 1, 1.0)
    found, _ = judged(monkeypatch, mass=7.0, relaxed=8)
    assert (found.feasible, found.objective) == (True, 2.0)


def test_distances_are_looked_at_where_a_trial_may_become_the_best(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    near = {5: 0.1}
    for best, known in ((0.61, True), (0.6, False), (0.5, False), (np.inf, True)):
        found, asked = judged(monkeypatch, least=near, best=best)
        assert (5 in asked) is known
        assert found.feasible is not known
        assert found.objective == 0.6 or known
    # none at all where it costs too much anyway
    found, asked = judged(monkeypatch, {0: (1.0, 11.0)}, near, most=0.59, beside=0.2)
    assert (found.feasible, found.violation, found.objective, asked) == (True, 0.0, 0.6, [])
    assert found.worst[7] == 0.2
    # what has no value is refused after all else
    found, _ = judged(monkeypatch, footprint=np.inf)
    assert (found.stage, found.violation) == (STAGES - 1, np.inf)
    found, _ = judged(monkeypatch, {0: (np.nan, np.nan)}, {5: np.nan})
    assert found.feasible


@pytest.mark.slow
def test_a_batch_is_judged_as_each_by_itself() -> None:
    """Lengths that are no robot, out of reach, singular, near and fine, in any order."""
    bounds = (Requirement("condition", high=10.0), Requirement("clearance", low=0.001))
    one = evaluator(*bounds, allow_overlap=False)
    good = [0.295, 0.085, 4.8, 0.79, 0.28, -0.77]
    rows = np.array([
        [-0.1, *good[1:]], good, [0.1, *good[1:]], [*good[:2], 0.9, *good[3:]],
        [*good[:5], -1.9], [0.4, 0.085, 4.2, 0.79, 0.45, -0.85], [0.4, *good[1:]],
        [0.3, 0.1, 3.0, 0.5, 0.6, -0.55],
    ])  # fmt: skip
    found = one.evaluate(rows)
    stages = [item.stage for item in found]
    assert stages[0] == stages[3] == 0
    assert (stages[2], stages[4]) == (1, 2)
    assert {0, 1, 2, 3} < set(stages)
    for row, item in zip(rows, found, strict=True):
        (single,) = one.evaluate(row[None])
        assert (single.stage, single.violation) == (item.stage, item.violation)
        np.testing.assert_equal(single.values, item.values)
        if item.trial is not None:
            assert item.trial.numbers.tolist() == row.tolist()
            assert item.trial.geometry.base_radius == row[0]
            assert item.trial.workspace.center[2] == row[5]
    # the limit that is told of each counts for it alone
    finite = [item.cost(1.0) for item in found]
    whole = one.costs(list(rows))
    assert whole == finite
    most = [0.0, 9e9, *[0.0] * 6]
    told = one.costs(list(rows), most)
    assert told[1] == whole[1]
    nothing = one.evaluate(rows[[0, 3]])
    assert [(item.stage, item.violation, item.trial) for item in nothing] == [(0, np.inf, None)] * 2
    robots_ = Robots.of(one.case, rows[[0, 3]])
    assert [len(part) for part in robots_.spans] == [0] * 5
    assert robots_.margins.shape == (0, 4)
    assert robots_.possible.tolist() == [False] * 2


def test_the_least_of_a_quantity_is_that_of_sparse_samples_first(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Finer ones and a search from them for the verification, if it takes no long time."""
    asked: list[Any] = []

    def noted(name: str, value: Any) -> None:
        monkeypatch.setattr(evaluation, name, lambda *given: asked.append((name, *given)) or value)

    noted("least_on_samples", 0.3)
    noted("least_of", SimpleNamespace(value=0.2))
    space = Workspace(WorkspaceShape.CYLINDER, (0.3, 0.3, 0.4), (0.0, 0.0, -0.6))
    trial: Any = SimpleNamespace(workspace=space, drawn="drawn", design="design")
    part = (-0.7, -0.5)
    near = Requirement("clearance", low=0.001, theta=(0.0, 0.1), z=part)
    stiff, slow = Requirement("stiffness_x", low=4.0), Requirement("frequency_1", low=4.0)
    assert stiff.entry.cost < evaluation.SLOW < slow.entry.cost
    one = evaluator(near, stiff, slow)
    for finer in (False, True):
        asked.clear()
        same = replace(one, density=Density().finer(4)) if finer else one
        values = [same._least(trial, bound) for bound in (near, stiff, slow)]
        assert values == [0.2 if finer else 0.3] * 3
        name = "least_of" if finer else "least_on_samples"
        assert [given[:3] for given in asked] == [
            (name, "clearance", "drawn"), (name, "stiffness_x", "design"),
            (name, "frequency_1", "design"),
        ]  # fmt: skip
        assert asked[0][3].theta == (0.0, 0.1)
        assert asked[0][3].heights == pytest.approx(part)
        assert asked[1][3] == Extent(space, CYLINDER.requirements.theta)
        if finer:
            close = SPARSE.finer(evaluation.CLOSER)
            assert [given[4] for given in asked] == [close, close, SPARSE.finer(1)]
    assert np.isnan(one._least(trial, replace(near, z=(0.0, 1.0))))

    class NoDesign:
        workspace = space

        @property
        def design(self) -> Any:
            raise InvalidDesign("crank_length", -1.0, "above 0")

    robot: Any = NoDesign()
    assert one._least(robot, stiff) == -np.inf


@pytest.mark.slow
def test_quantities_without_a_kernel_have_their_extremes_over_all_samples() -> None:
    """From the model's own functions; nothing where no pose counts, and what is least elsewhere."""
    part = (-0.7, -0.6)
    bounds = (
        Requirement("determinant", high=1.0), Requirement("stiffness_x", low=1.0),
        Requirement("clearance", low=-1.0),
        Requirement("stiffness_x", high=1e9, theta=(0.1, 0.1), z=part),
        Requirement("determinant", high=1.0, z=(0.0, 1.0)), Requirement("reach_margin", low=0.0),
    )  # fmt: skip
    one = replace(evaluator(*bounds), density=SPARSE)
    numbers = np.array([[0.295, 0.085, 4.8, 0.79, 0.28, -0.77]])
    (trial,) = Robots.of(one.case, numbers).trials(one._poses, [0])
    values = dict(one._others(trial))
    assert sorted(values) == [0, 1, 3]
    whole = Extent(trial.workspace, (-TURN, TURN)).samples(SPARSE)
    found = measure_singularity(trial.geometry, whole).determinant
    assert values[0] == pytest.approx((found.min(), found.max()), rel=1e-9)
    found = platform_stiffness(trial.design, whole).along(0)
    assert found.min() * 0.6 < values[1][0] <= found.min() * (1 + 1e-9)
    assert values[1][1] == np.inf
    upper = Extent(trial.workspace, (0.1, 0.1)).within(part)
    assert upper is not None
    found = platform_stiffness(trial.design, upper.samples(SPARSE)).along(0)
    assert values[3] == pytest.approx((found.min(), found.max()), rel=1e-9)
    # no value at one of the poses, and no design at all
    high = replace(trial, workspace=replace(trial.workspace, center=(0.0, 0.0, -0.5)))
    assert dict(one._others(high))[0] == (-np.inf, np.inf)

    class NoDesign(TrialRobot):
        @property
        def design(self) -> Any:
            raise InvalidDesign("crank_length", -1.0, "above 0")

    none = NoDesign(**{field.name: getattr(trial, field.name) for field in fields(trial)})
    nothing = (-np.inf, np.inf)
    assert dict(one._others(none)) == {0: nothing, 1: nothing, 3: nothing}
