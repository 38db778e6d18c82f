"""Parts of the search by themselves: relaxations, when it ends, trials about an answer, sides."""

from __future__ import annotations

import itertools
from dataclasses import fields, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.progress import Canceled
from paminsa_viz.quantities.requirements import Requirement, Workspace, WorkspaceShape
from paminsa_viz.studies.executors import here
from paminsa_viz.synthesis import Effort, ObjectiveLimit, Regime, SearchRange, SynthesisCase
from paminsa_viz.synthesis.masses.program import InnerSolution
from paminsa_viz.synthesis.search import solve
from paminsa_viz.synthesis.search.evaluation import REFUSED
from paminsa_viz.synthesis.search.outer import (
    EXPLORE,
    PROGRESS,
    ROUND,
    SPREAD,
    STILL,
    RegimeState,
    _has_ended,
    cloud,
    numbers_of,
)
from paminsa_viz.synthesis.search.result import limit_of
from tests.synthesis.search_cases import CYLINDER

BOTH = (Regime.SMALLER, Regime.LARGER)


def relaxed(
    monkeypatch: pytest.MonkeyPatch, case: SynthesisCase, least: dict[int, tuple[float, float]]
) -> Any:
    """Relaxations where the searches of each bound find these excesses; NaN for none."""

    class Run:
        def __init__(self, case: Any, workers: Any, progress: Any, relaxed: int) -> None:
            self.found = least[relaxed]

        def search(self, state: RegimeState) -> RegimeState:
            if progressed.pop(0):
                raise Canceled
            return state

        def verify(self, state: RegimeState) -> Any:
            value = self.found[BOTH.index(state.regime)]
            found = SimpleNamespace(feasible=not np.isnan(value), objective=value)
            return SimpleNamespace(found=found)

    progressed = [False] * 100
    monkeypatch.setattr(solve, "_Run", Run)

    def run(canceled_at: int | None = None) -> Any:
        progressed[:] = [i == canceled_at for i in range(100)]
        return solve.relaxations(case, BOTH, here, lambda *_, **__: None)

    return run


def test_the_nearest_value_of_each_bound_by_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    bounds = (
        Requirement("tau_1", high=-4.0),  # below zero on both sides
        Requirement("tau_2", low=-8.0),
        Requirement("tau_3", low=-5.0, high=20.0),  # each side by itself
        Requirement("tau_1", low=-2.0, high=2.0),  # of a magnitude one
        Requirement("determinant", high=0.0),
    )
    case = replace(
        CYLINDER, requirements=replace(CYLINDER.requirements, bounds=bounds),
        limits=(ObjectiveLimit("moving_mass", 10.0), ObjectiveLimit("volume", 0.05)),
    )  # fmt: skip
    least = {
        0: (1.0, 3.0), 1: (2.0, np.nan), 2: (1.5, 1.0), 3: (np.nan, 7.0), 4: (1.0, 1.0),
        5: (0.75, 0.8), 6: (np.nan, np.nan), 7: (0.001, 0.002),
    }  # fmt: skip
    run = relaxed(monkeypatch, case, least)
    found = {
        (getattr(item.bound, "quantity", "") or item.bound.objective, limit_of(item.bound)): item
        for item in run()
    }
    expected = {
        ("tau_1", -4.0): (-3.0, 0.25), ("tau_2", -8.0): (-10.0, 0.25),
        ("tau_3", -5.0): (-6.0, 0.2), ("tau_3", 20.0): (27.0, 0.35),
        ("tau_1", 2.0): (3.0, 0.5), ("determinant", 0.0): (0.75, 0.75),
        ("moving_mass", 10.0): (np.nan, np.inf), ("volume", 0.05): (0.049, 0.02),
    }  # fmt: skip
    assert found.keys() == expected.keys()
    for key, (nearest, change) in expected.items():
        assert found[key].nearest == pytest.approx(nearest, nan_ok=True), key
        assert found[key].change == pytest.approx(change), key
    changes = [item.change for item in run()]
    assert changes == sorted(changes)
    # what was found before it was ended
    assert len(run(canceled_at=5)) == 2
    assert run(canceled_at=0) == ()


def test_sides_of_a_range_and_what_has_one() -> None:
    one = Requirement("tau_1", low=-1.0, high=3.0, theta=(0.0, 0.1))
    low, high = solve.sides(one)
    assert (low.low, low.high, low.theta) == (-1.0, None, (0.0, 0.1))
    assert (high.low, high.high, high.theta) == (None, 3.0, (0.0, 0.1))
    for kept in (
        Requirement("tau_1", low=-1.0), Requirement("tau_1", high=-1.0),
        Requirement("tau_1", low=-2.0, high=2.0),
    ):  # fmt: skip
        assert solve.sides(kept) == (kept,)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_a_search_ends_where_it_stands_still(sense: float) -> None:
    """Late, feasible all the while, and by less than its share in so many rounds."""
    case = replace(CYLINDER, effort=Effort(100, 4))
    back = STILL * ROUND
    late = int(EXPLORE * 100) + back
    cost = 50.0 * sense

    def ended(generation: int, history: list[float], converged: bool = False) -> bool:
        state = RegimeState(Regime.SMALLER, generation, history=tuple(history))
        return _has_ended(case, state, converged)

    still = [cost] * (back + 1)
    assert ended(late, still)
    assert not ended(late - 1, still)
    assert not ended(late, still[:-1])
    assert ended(100, [])
    assert not ended(99, [])
    assert ended(0, [], True)
    for share, done in ((0.9, True), (1.1, False)):
        start = cost + share * PROGRESS * abs(cost)
        assert ended(late, [start, *still[1:]]) is done
        assert ended(late, [0.0, start, *still[1:]]) is done  # only the last rounds count
    assert not ended(late, [*still[1:], cost - 1.1 * PROGRESS * abs(cost)])
    assert ended(late, [0.0] * (back + 1))  # no cost at all, as a torque may have
    assert not ended(late, [REFUSED, *still[1:]])
    assert not ended(late, [REFUSED, *[REFUSED * (1 - 0.1 * PROGRESS)] * back])
    assert not ended(late, [2 * REFUSED] * (back + 1))


def test_trials_about_an_answer() -> None:
    low, high = CYLINDER.bounds.T
    dimensions = len(low)
    shares = np.array([[0.3] * dimensions, [0.6] * dimensions])
    answers = (low + (high - low) * shares).tolist()
    case = replace(CYLINDER, effort=Effort(10, 7))
    assert len(cloud(case, answers[:1])) == 7 * dimensions
    many = [answers[0]] * 40
    assert len(cloud(case, many)) == 80
    rows = np.array(cloud(case, answers, count=4000))
    assert rows.shape == (4000, dimensions)
    assert rows[:2] == pytest.approx(shares)
    for start in (0, 1):
        off = rows[2 + start :: 2] - shares[start]
        assert np.abs(off.mean(axis=0)).max() < 0.1 * SPREAD
        assert off.std() == pytest.approx(SPREAD, rel=0.05)
    wide = np.array(cloud(case, answers, 0.5, 0.25, count=4000))
    assert ((wide >= 0.0) & (wide <= 1.0)).all()
    assert (wide[:3000] == 1.0).any()
    assert not (wide[3000:] == 1.0).any()
    assert wide[3000:].mean() == pytest.approx(0.5, abs=0.02)
    assert wide[3000:].std() == pytest.approx(np.sqrt(1 / 12), rel=0.03)
    assert wide[:2] == pytest.approx(shares)
    # the same for the same seed and turn, others for others
    turns = [cloud(case, answers, turn=turn) for turn in (0, 2, 3)]
    assert turns[0] == turns[1] != turns[2]
    assert cloud(case, answers) == turns[0]
    assert cloud(replace(case, seed=1), answers) != turns[0]


def test_a_solution_is_printed_without_its_program() -> None:
    assert [item.name for item in fields(InnerSolution) if not item.repr] == ["program", "solution"]


def test_a_robot_as_numbers_of_the_search() -> None:
    numbers = np.array([0.3, 0.1, 3.5, 0.5, 0.6, -0.7])
    design = CYLINDER.design(CYLINDER.geometry(numbers))
    place = CYLINDER.workspace_of(numbers)
    assert numbers_of(CYLINDER, design, place) == pytest.approx(numbers)
    box = Workspace(WorkspaceShape.BOX, (0.3, 0.2, 0.4))
    case = replace(
        CYLINDER, requirements=replace(CYLINDER.requirements, workspace=box),
        ranges=(
            SearchRange("workspace.height", 0.1, 0.9), SearchRange("workspace.width", 0.1, 0.9),
            *CYLINDER.ranges[:1],
        ),
    )  # fmt: skip
    numbers = np.array([0.5, 0.6, 0.3, -0.7])
    place = case.workspace_of(numbers)
    assert place.size == pytest.approx((0.6, 0.4, 0.5))
    assert numbers_of(case, case.design(case.geometry(numbers)), place) == pytest.approx(numbers)


def test_the_part_that_is_done_goes_through_the_regimes() -> None:
    """From nothing to all, each regime in its turn."""
    case = replace(CYLINDER, effort=Effort(3, 4), seed=2)
    seen: list[tuple[Regime, float]] = []
    result = solve.synthesize(
        case, progress=lambda done, *, state: seen.append((state.regime, done)), relax=False
    )
    regimes = [regime for regime in BOTH if regime not in result.refused]
    for regime in regimes:
        turn = BOTH.index(regime)
        parts = [done for one, done in seen if one is regime]
        assert parts == sorted(parts)
        assert min(parts) > turn / 2
        assert parts[2] == pytest.approx((turn + 1) / 2)
    assert [regime for regime, _ in itertools.groupby(seen, lambda one: one[0])] == regimes
