"""Prices of requirements where the optimum of every case is a made-up function."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.progress import Progress, keep_on
from paminsa_viz.synthesis import Effort, Regime, SynthesisResult, synthesize
from paminsa_viz.synthesis.answer import prices
from paminsa_viz.synthesis.answer.prices import Requirable, requirement_prices
from tests.synthesis.test_prices import one_length

BASE = 10.0
FREE = 2e-4
"""Share of the optimum that a search leaves open."""


@dataclass
class MadeUp:
    """What `prices.refined` was asked for, and an answer whose requirements are made up."""

    result: SynthesisResult
    asked: list[tuple[list[float], int]]
    requirables: list[Requirable]
    sign: float
    base: float = BASE

    def add(
        self,
        label: str,
        bound: float,
        tighter: float,
        optimum: Callable[[float], float],
        possible: Callable[[float], bool] = lambda value: True,
    ) -> None:
        def moved(value: float) -> Any:
            if not possible(value):
                raise ValueError(label)
            case = self.result.case
            return SimpleNamespace(bounds=case.bounds + 0.2 * value, optimum=optimum(value))

        self.requirables.append(Requirable(label, "kg", bound, tighter, moved))


@pytest.fixture(params=[1.0, -1.0], ids=["minimized", "maximized"])
def made_up(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> MadeUp:
    """The same optimum whether the objective is minimized, or its negative maximized."""
    sign = request.param
    result = synthesize(one_length(effort=Effort(1, 4)), relax=False)
    result = replace(result, feasible=True, regime=Regime.SMALLER)
    found = MadeUp(result, [], [], sign)

    def refined(
        case: Any, regime: Regime, numbers: list[float], *, rounds: int, workers: Any,
        progress: Progress,
    ) -> Any:  # fmt: skip
        keep_on(progress, 0.5)
        found.asked.append((numbers, rounds))
        assert regime is Regime.SMALLER
        return SimpleNamespace(objective=sign * getattr(case, "optimum", found.base))

    monkeypatch.setattr(prices, "refined", refined)
    monkeypatch.setattr(prices, "_requirables", lambda *_: iter(found.requirables))
    monkeypatch.setattr(prices, "find_objective", lambda _: SimpleNamespace(sign=sign))
    return found


def test_a_price_is_the_slope_of_the_optimum_against_the_bound(made_up: MadeUp) -> None:
    """Per unit, whichever way it is tightened, of one side where the other is impossible."""
    nothing = float("nan")
    made_up.add("up", 2.0, 1.0, lambda v: BASE + 3 * (v - 2))
    made_up.add("down", -4.0, -1.0, lambda v: BASE - 0.5 * (v + 4))
    made_up.add("at zero", 0.0, 1.0, lambda v: BASE + 7 * v)
    made_up.add("one way", 5.0, 1.0, lambda v: BASE + 0.25 * (v - 5), lambda v: v < 5.0)
    made_up.add("other way", 8.0, 1.0, lambda v: BASE + (v - 8) if v > 8.0 else nothing)
    made_up.add("no way", 1.0, 1.0, lambda v: nothing)
    made_up.add("free", 1.0, 1.0, lambda v: BASE + 0.99 * FREE * BASE * (v - 1) / 0.04)
    made_up.add("dear", 1.0, 1.0, lambda v: BASE + 1.01 * FREE * BASE * (v - 1) / 0.04)
    made_up.add("bend", 1.0, 1.0, lambda v: BASE + (v - 1) * (6.0 if v > 1 else 4.0))
    parts: list[float] = []
    found = requirement_prices(made_up.result, progress=lambda done: bool(parts.append(done)))
    rows = {row.label: row for row in found}
    price = {
        "up": 3.0, "down": 0.5, "at zero": 7.0, "one way": 0.25, "other way": 1.0,
        "no way": nothing, "free": 0.0, "dear": 1.01 * FREE * BASE / 0.04, "bend": 5.0,
    }  # fmt: skip
    step = {
        "up": 0.04, "down": 0.08, "at zero": 0.02, "one way": 0.1, "other way": 0.16,
        "no way": 0.02, "free": 0.02, "dear": 0.02, "bend": 0.02,
    }  # fmt: skip
    ends = {
        "up": (10.12, 9.88), "down": (10.04, 9.96), "at zero": (10.14, 9.86),
        "one way": (nothing, 9.975), "other way": (10.16, nothing), "no way": (nothing, nothing),
        "bend": (10.12, 9.92),
    }  # fmt: skip
    assert rows.keys() == price.keys()
    for label, row in rows.items():
        assert row.price == pytest.approx(price[label], rel=1e-9, nan_ok=True), label
        assert row.step == pytest.approx(step[label]), label
        assert row.unit == "kg"
        if label in ends:
            both = made_up.sign * np.array(ends[label])
            assert (row.tightened, row.relaxed) == pytest.approx(both, nan_ok=True), label
    # by what a step changes; what is not known comes with what costs nothing
    order = sorted(price, key=lambda label: -np.nan_to_num(price[label]) * step[label])
    assert [row.label for row in found][:7] == order[:7]
    assert {row.label for row in found[7:]} == {"no way", "free"}
    # halfway in each of 19 searches but the impossible one, and after each requirement
    halves = [0.5 + n for n in range(19) if n != 7]
    assert 19 * np.array(parts) == pytest.approx(sorted([*halves, *range(3, 20, 2)]))


def test_what_costs_nothing_is_within_a_share_of_the_optimum_of_either_sign(
    made_up: MadeUp, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also where tightening seems to gain, which a search may leave open."""
    monkeypatch.setattr(prices, "STILL", 0.25)
    made_up.base = -8.0  # so that 2 is still nothing
    made_up.add("just free", 1.0, 1.0, lambda v: -7.0 if v > 1 else -9.0)
    made_up.add("dear", 1.0, 1.0, lambda v: -6.875 if v > 1 else -9.0)
    made_up.add("gains", 1.0, 1.0, lambda v: -10.0 if v > 1 else -7.0)
    found = requirement_prices(made_up.result, step=0.5)
    assert [(row.label, row.price) for row in found] == [
        ("gains", -3.0), ("dear", 2.125), ("just free", 0.0),
    ]  # fmt: skip


def test_each_search_starts_at_the_answer_within_its_ranges(made_up: MadeUp) -> None:
    result = made_up.result
    (number,) = prices.numbers_of(result.case, result.design, result.workspace)
    ((low, high),) = result.case.bounds
    made_up.add("moved", 2.0, 1.0, lambda v: BASE)
    made_up.add("never asked", 2.0, 1.0, lambda v: BASE)
    assert requirement_prices(result, progress=lambda done: done > 0.2) == ()  # half of "moved"
    made_up.asked.clear()
    (row,) = requirement_prices(result, step=0.5, progress=lambda done: done > 0.55)
    assert row.label == "moved"
    shifts = (0.0, 0.6, 0.2)  # of the made-up cases' ranges, the tightened one first
    expected = [[min(max(number, low + by), high + by)] for by in shifts]
    assert [numbers for numbers, _ in made_up.asked] == [pytest.approx(row) for row in expected]
    assert len({tuple(row) for row in expected}) > 1
    assert {rounds for _, rounds in made_up.asked} == {4}
    made_up.asked.clear()
    made_up.requirables.clear()
    assert requirement_prices(result) == ()
    assert not made_up.asked
