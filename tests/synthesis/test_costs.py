"""What a trial costs, part by part: by how much it fails, where, and what is least."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.model import APPENDIX_4
from paminsa_viz.quantities.requirements import Requirement, Workspace, WorkspaceShape
from paminsa_viz.synthesis import Evaluator, ObjectiveLimit, Regime
from paminsa_viz.synthesis.search.evaluation import REFUSED, STAGES, TrialEvaluation
from paminsa_viz.synthesis.search.extremes import Extent
from paminsa_viz.synthesis.search.region import SPARSE
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
    turn = 0.13 - 0.14 * np.cos(0.5)  # and the circle is too small by 90 mm
    assert smaller._singular(robots(0.14, 0.13)) == pytest.approx((turn + 0.09) / 0.27, rel=1e-6)
    larger = evaluator(theta=(-0.5, 0.3), regime=Regime.LARGER)
    assert larger._singular(robots(0.1, 0.4)) == 0.0
    assert larger._singular(robots(0.4, 0.1)) == pytest.approx(0.3 / 0.5, rel=1e-6)
    # with other headings the circle is larger: at its least distance from zero
    for theta in ((0.3, 0.6), (-0.6, -0.3)):
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
