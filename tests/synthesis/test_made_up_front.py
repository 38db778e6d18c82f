"""Which searches a front makes: their limits, their order, and what becomes of their answers."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.errors import InvalidInput
from paminsa_viz.quantities.requirements import Workspace
from paminsa_viz.synthesis import ObjectiveLimit, Regime, SynthesisCase
from paminsa_viz.synthesis.search import front
from paminsa_viz.synthesis.search.front import MOST_POINTS, OTHERS, SLACK, design_front
from paminsa_viz.synthesis.search.outer import RegimeState
from tests.synthesis.search_cases import CYLINDER

NAMES = ("moving_mass", "volume")
LEAST, LARGEST = 0.1, 0.5
"""Volumes that there are; a robot of volume v has a mass of 1 + v² at least."""


class Searches:
    """Answers in closed form, in place of searches."""

    def __init__(self, fail: tuple[int, ...] = (), parts: int = 2) -> None:
        self.cases: list[SynthesisCase] = []
        self.states: list[tuple[RegimeState, ...]] = []
        self.fail, self.parts = fail, parts

    def __call__(
        self, case: SynthesisCase, *, workers: Any, progress: Any, states: Any, relax: bool
    ) -> Any:
        assert not relax
        number = len(self.cases)
        self.cases.append(case)
        self.states.append(states)
        for part in range(self.parts):
            state = RegimeState(Regime.SMALLER, part)
            if progress((part + 1) / self.parts, state=state):
                break
        limits = {limit.objective: limit for limit in case.limits}
        if case.objective == "volume":
            most = min(limits["moving_mass"].most, 10.0)
            volume = min(LARGEST, np.sqrt(most - 1.0)) if most > 1.0 else np.nan
            mass = 1.0 + volume**2
        else:
            volume = max(LEAST, limits["volume"].most)
            mass = 1.0 + volume**2
        values = {"volume": volume, "moving_mass": mass}
        outcomes = [
            SimpleNamespace(bound=limit, value=values.get(name, 3.0))
            for name, limit in limits.items()
        ]
        space = Workspace(case.workspace.shape, case.workspace.size, (0.0, 0.0, -0.7))
        return SimpleNamespace(
            case=case, design=case.reference, workspace=space, outcomes=outcomes,
            regime=Regime.SMALLER, feasible=number not in self.fail,
            objective=values.get(case.objective, 3.0),
        )  # fmt: skip


@pytest.fixture
def searches(monkeypatch: pytest.MonkeyPatch) -> Any:
    def make(**options: Any) -> Searches:
        made = Searches(**options)
        monkeypatch.setattr(front, "synthesize", made)
        return made

    return make


def test_the_other_objectives_are_limited_in_equal_steps(searches: Any) -> None:
    made, parts = searches(), []

    def watch(done: float, *, searches: int, state: RegimeState) -> None:
        parts.append((searches, done))

    found = design_front(CYLINDER, NAMES, points=5, progress=watch)
    assert [case.objective for case in made.cases] == ["moving_mass", "volume", *NAMES[:1] * 4]
    slack = SLACK * (LARGEST - LEAST)
    asked = [case.limits[0] for case in made.cases[2:]]
    assert {limit.objective for limit in asked} == {"volume"}
    volumes = np.linspace(LARGEST, LEAST, 5)[:4] - slack
    assert [limit.most for limit in asked] == pytest.approx(volumes)
    # the first one is the end without a limit, and is not searched again
    kept = np.sort([LEAST, *volumes])
    assert np.array([point.values for point in found.points]) == pytest.approx(
        np.array([(1.0 + v * v, v) for v in kept])
    )
    assert (found.searches, found.failed, found.dominated, found.canceled) == (6, 0, 0, False)
    assert found.objectives == NAMES
    assert parts == [(n, pytest.approx((n + part) / 6)) for n in range(6) for part in (0.5, 1.0)]


def test_limits_of_the_case_count_where_they_are_tighter(searches: Any) -> None:
    made = searches()
    limits = (ObjectiveLimit("volume", 0.3), ObjectiveLimit("footprint", 0.9))
    found = design_front(replace(CYLINDER, limits=limits), NAMES, points=3)
    for case in made.cases:
        assert ObjectiveLimit("footprint", 0.9) in case.limits
    volumes = [
        {limit.objective: limit.most for limit in case.limits}["volume"] for case in made.cases
    ]
    slack = SLACK * (LARGEST - 0.3)
    assert volumes == pytest.approx([0.3, 0.3, LARGEST - slack, 0.4 - slack])
    assert len(found.points) == 3


def test_later_searches_start_near_the_answers(searches: Any) -> None:
    made = searches()
    design_front(CYLINDER, NAMES, points=3)
    assert made.states[0] == ()
    for number, states in enumerate(made.states[1:], 1):
        (state,) = states
        case = made.cases[number]
        assert state.regime is Regime.SMALLER
        rows = np.array(state.population)
        low, high = case.bounds.T
        numbers = np.array([*(case.reference.value(path) for path in case.paths[:-1]), -0.7])
        assert np.array(state.best) == pytest.approx(numbers)
        share = np.clip((numbers - low) / (high - low), 0.0, 1.0)
        assert rows[:number] == pytest.approx(np.tile(share, (number, 1)))
        near = (np.abs(rows - share) < 0.25).all(axis=1).sum()
        assert near / len(rows) == pytest.approx(1.0 - OTHERS, abs=0.1)


def test_what_fails_is_dominated_or_canceled_is_no_point(searches: Any) -> None:
    searches(fail=(3,))
    found = design_front(CYLINDER, NAMES, points=4)
    assert (found.searches, found.failed, len(found.points)) == (5, 1, 3)
    searches(fail=(0, 1))
    found = design_front(CYLINDER, NAMES, points=4)
    assert (found.searches, found.failed, found.points) == (1, 1, ())
    searches()
    found = design_front(
        CYLINDER, NAMES, points=4, progress=lambda done, searches, state: searches == 3
    )
    assert (found.canceled, found.searches, len(found.points)) == (True, 4, 2)
    # as good in all, of a part of the extent less than what counts as equal
    run = front._Front(CYLINDER, NAMES, np.array([1.0, -1.0]), 5, None, None)  # type: ignore
    values = [(1.0, 0.1), (2.0, 0.5), (1.5, 0.3), (1.6, 0.3), (1.50002, 0.3), (1.49, 0.2)]
    run.points = [front.FrontPoint(value, None) for value in values]  # type: ignore
    kept = run.front()
    assert [point.values for point in kept.points] == [values[0], values[5], values[2], values[1]]
    assert kept.dominated == 2


def test_equal_points_are_so_in_parts_of_their_extent_and_are_in_the_order_of_the_first(
    searches: Any,
) -> None:
    """Whatever their units; with three objectives another one has an order of its own."""
    values = np.array([
        (1.0, 3.0, 2.0), (2.0, 1.0, 3.0), (3.0, 2.0, 1.0), (3.0004, 2.0004, 1.0004), (2.9, 3.0, 3.0)
    ])  # fmt: skip
    for factor in (1.0, 1e-3, 1e4):
        names = ("a", "b", "c")
        run = front._Front(CYLINDER, names, np.ones(3), 5, None, None)  # type: ignore
        rows = factor * values[[2, 4, 1, 3, 0]]
        run.points = [front.FrontPoint(tuple(row), None) for row in rows.tolist()]  # type: ignore
        found = run.front()
        assert np.array([point.values for point in found.points]) == pytest.approx(
            factor * values[:3]
        )
        assert found.dominated == 2


def test_limits_go_from_the_best_to_the_worst_of_each_objective(searches: Any) -> None:
    made = searches()
    names = ("moving_mass", "volume", "static_torque")
    found = design_front(CYLINDER, names, points=3)
    assert found.searches == 3 + 3**2
    asked = [{limit.objective: limit.most for limit in case.limits} for case in made.cases[3:]]
    slack = SLACK * (LARGEST - LEAST)
    levels = np.linspace(LARGEST, LEAST, 3) - slack
    assert [one["volume"] for one in asked] == pytest.approx(np.repeat(levels, 3))
    assert [one["static_torque"] for one in asked] == pytest.approx(np.full(9, 3.0))


@pytest.mark.slow
def test_how_many_searches_are_possible(searches: Any) -> None:
    searches(parts=0)
    three = ("moving_mass", "volume", "static_torque")
    assert design_front(CYLINDER, NAMES, points=2).searches == 3
    assert design_front(CYLINDER, NAMES, points=MOST_POINTS - 1).searches == MOST_POINTS
    most = int(np.sqrt(MOST_POINTS - 3))
    assert design_front(CYLINDER, three, points=most).searches == 3 + most**2
    for names, points in (
        (NAMES, 1), (NAMES, MOST_POINTS), (three, most + 1), (three, 0), (NAMES, -5),
        (NAMES[:1], 4), (("volume", "volume"), 4),
    ):  # fmt: skip
        with pytest.raises(InvalidInput):
            design_front(CYLINDER, names, points=points)
