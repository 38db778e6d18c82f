"""What is made of a solution, and numbers at the ends of their ranges; little is solved here."""

from __future__ import annotations

import time
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.balancing import (
    Changes,
    Imbalance,
    InfeasibleBounds,
    MassRange,
    SpringPlace,
    at_joint,
    optimize,
    pareto,
    pareto_front,
)
from paminsa_viz.balancing.optimum import Relaxation, Shortfall, active_bounds
from paminsa_viz.balancing.program import Program, Variable
from paminsa_viz.balancing.sensitivity import Tornado, TornadoBar
from paminsa_viz.balancing.springs import spring_variable
from paminsa_viz.model import APPENDIX_4

PLACE = SpringPlace(at_joint(8), at_joint(9), 200.0, 0.1, 0.5)

# ---------------------------------------------------------------------------------------- springs


def test_a_spring_is_a_variable_of_its_places_in_the_state() -> None:
    """K, and K L next to it."""
    variable = spring_variable(PLACE, 2, 6)
    assert (variable.low, variable.high, variable.span) == (0.0, 200.0, (0.1, 0.5))
    np.testing.assert_array_equal(variable.column(0.25), [0.0, 0.0, 1.0, 0.25, 0.0, 0.0])
    assert variable.name == "joint 8 to joint 9"


# ---------------------------------------------------------------------------------------- solutions


def test_levers_of_moments_keep_their_span() -> None:
    effect = np.arange(12.0).reshape(3, 4)
    slot = Variable("slot", 0.2, 4.0, effect, (0.5, 1.5))
    none = Variable("none", 0.0, 4.0, effect, (0.5, 1.5))
    fixed = Variable("fixed", 0.0, 1.0, effect)
    assert none.levers_of(np.zeros(3)) == []
    assert slot.levers_of(np.zeros(3)) == [(1.0, 0.2)]  # no less than its least
    assert slot.levers_of(np.array([9.0, 0.0, 0.0])) == [(1.0, 4.0)]
    assert fixed.levers_of(np.array([0.75])) == [(0.0, 0.75)]
    assert slot.levers_of(np.array([2.0, 9.0, 9.0])) == [(1.5, 2.0)]  # beyond the end
    assert slot.levers_of(np.array([2.0, -9.0, 2.0])) == [(0.5, 2.0)]
    assert slot.levers_of(np.array([2.0, 1.0, 0.1])) == [(1.25, 2.0)]  # those of one lever
    assert slot.levers_of(np.array([2.0, 0.0, 2.0])) == [(0.5, 1.0), (1.5, 1.0)]
    shared = slot.levers_of(np.array([2.0, 0.5, 1.0]))
    u = np.array([2.0 * (lever - 1.0) for lever, _ in shared])
    amounts = np.array([amount for _, amount in shared])
    np.testing.assert_allclose([(amounts * u**k).sum() for k in range(3)], [2.0, 0.5, 1.0])


@pytest.mark.parametrize("seed", range(3))
def test_the_least_of_a_linear_cost_is_at_its_best_levers(seed: int) -> None:
    rng = np.random.default_rng(seed)
    variables = tuple(
        Variable("v", low, low + 1.0, rng.normal(size=(3, 4)), span)
        for low, span in ((0.1, (-1.0, 2.0)), (0.0, (0.0, 0.0)), (0.5, (0.3, 0.4)))
    )
    program = Program(rng.normal(size=4), variables, ())
    gradient = rng.normal(size=4)
    total = gradient @ program.start
    for variable in variables:
        levers = np.linspace(*variable.span, 30_001)
        prices = [gradient @ effect for effect in variable.effect]
        costs = prices[0] + levers * (prices[1] + levers * prices[2])
        lever, cost = variable.cheapest(np.array(prices))
        assert cost == pytest.approx(costs.min(), abs=1e-6)
        assert lever == pytest.approx(levers[costs.argmin()], abs=2e-4)
        total += min(variable.low * costs.min(), variable.high * costs.min())
    assert program.least(gradient) == pytest.approx(total, abs=1e-5)


def test_bounds_count_as_reached_within_a_millionth_of_their_range() -> None:
    """Amounts at their ends, masses at the ends of a span, limits with a price; dearest first."""
    span = (0.1, 0.3)
    near, inside = 0.9e-6 * 2.0, 1.2e-6 * 2.0

    def found(amount: float, price: float, slope: float = 0.0, places: Any = ()) -> list[tuple]:
        variable = Variable("v", 1.0, 3.0, np.zeros((3, 1)), span if places else (0.0, 0.0))
        space: Any = SimpleNamespace(variables=(variable,))
        solution: Any = SimpleNamespace(
            amounts=[amount], prices=[price], slopes=[slope], levers=[places], limit_prices=[],
        )  # fmt: skip
        return [
            (item.side, item.bound, item.unit, item.price)
            for item in active_bounds(space, solution)
        ]

    assert found(1.0 + near, 0.5) == [("low", 1.0, "kg", 0.5)]
    assert found(1.0 + near, -0.5) == [("low", 1.0, "kg", 0.0)]
    assert found(1.0 + inside, 0.5) == found(3.0 - inside, -0.5) == []
    assert found(3.0 - near, -0.5) == [("high", 3.0, "kg", 0.5)]
    assert found(3.0 - near, 0.5) == [("high", 3.0, "kg", 0.0)]
    tight, wide = 0.9e-6 * 0.2, 1.2e-6 * 0.2
    ends = [(0.1 + tight, 0.5), (0.1 + wide, 0.25), (0.3 - wide, 0.25), (0.3 - tight, 1.0)]
    assert found(2.0, 0.0, 2.0, ends) == [
        ("nearest", 0.1, "m", 1.0), ("farthest", 0.3, "m", 0.0),
    ]  # fmt: skip
    assert found(2.0, 0.0, -2.0, ends) == [
        ("farthest", 0.3, "m", 2.0), ("nearest", 0.1, "m", 0.0),
    ]  # fmt: skip
    little = [(0.1, near), (0.2, 2.0), (0.3, inside)]
    assert found(2.0, 0.0, -1.0, little) == [("farthest", 0.3, "m", pytest.approx(inside))]
    term = SimpleNamespace(label="t", unit="N")
    space: Any = SimpleNamespace(variables=())
    solution: Any = SimpleNamespace(
        amounts=[], prices=[], slopes=[], levers=[], limit_prices=[0.5, 0.0, 2.0]
    )
    limits: Any = [(term, 1), (term, 2), (term, 3)]
    assert [(item.side, item.bound, item.price) for item in active_bounds(
        space, solution, limits
    )] == [("limit", 3.0, 2.0), ("limit", 1.0, 0.5)]  # fmt: skip


def test_what_does_not_fit_is_said_with_what_would() -> None:
    """Numbers to act on are rounded to the side on which they are enough."""
    short = Shortfall("peak", "N m", 1.23456789, 2.34567123)
    moves = (Relaxation("a", "high", 1.0, 1.23456123), Relaxation("b", "low", 0.5, 0.250000789))
    assert InfeasibleBounds((short,), moves).sentences(str.upper) == [
        "PEAK of at most 1.23457 N·m is required; the least possible is 2.34568 N·m",
        "raise the upper bound of A from 1 kg to 1.23457 kg",
        "lower the lower bound of B from 0.5 kg to 0.25 kg",
    ]
    alone = InfeasibleBounds((short,), ())
    assert alone.sentences()[1:] == ["bounds 100 kg wider would not help: let other masses change"]
    assert str(alone).startswith("the bounds do not allow it: peak of at most")


def test_an_optimum_says_how_long_it_took() -> None:
    began = time.perf_counter()
    found = optimize(APPENDIX_4, Changes((MassRange("joints.j7", 0.1, 1.0),)), Imbalance())
    assert 0.0 < found.seconds <= time.perf_counter() - began


# ------------------------------------------------------------------------------------------- fronts


def test_a_front_has_as_many_points_as_are_asked_for_unless_its_ends_are_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A line from (1, width) to (2, 0), of which each optimum is known."""
    asked: list[float] = []
    first, second = (SimpleNamespace(label=name, unit=f"u{name}") for name in "ab")

    def front(width: float, before: float, points: int = 5, until: float = 2.0) -> Any:
        def optimum(design: Any, changes: Any, goal: Any, limits: Any) -> Any:
            held = {term.label: below for term, below in limits}
            share = held["b"] / width if "b" in held else (held["a"] - 1.0) if "a" in held else 0.0
            if goal.label == "a":
                share = 1.0 - share if "b" in held else 0.0
            else:
                share = share if "a" in held else 1.0
            values = [
                SimpleNamespace(label="a", before=1.5, after=1.0 + share),
                SimpleNamespace(label="b", before=before, after=width * (1.0 - share)),
            ]
            if goal.label == "b":
                values.reverse()
            return SimpleNamespace(values=values, objective=values[0].after, after=None)

        def progress(done: float, **known: Any) -> bool:
            asked.append(done)
            return done > until

        monkeypatch.setattr(pareto, "optimize", optimum)
        asked.clear()
        return pareto_front(
            APPENDIX_4, Changes(), first, second, points=points, progress=progress  # type: ignore
        )  # fmt: skip

    whole = front(4.0, 9.0)
    assert [round(point.first, 6) for point in whole.points] == [1.0, 1.25, 1.5, 1.75, 2.0]
    assert [round(point.second, 6) for point in whole.points] == [4.0, 3.0, 2.0, 1.0, 0.0]
    assert (whole.labels, whole.units, whole.before) == (("a", "b"), ("ua", "ub"), (1.5, 9.0))
    assert asked == [0.4, 0.6, 0.8, 1.0]
    assert len(front(4.0, 9.0, points=2).points) == 2
    assert len(front(4.0, 9.0, until=0.5).points) == 2
    # a front that is narrower than a millionth of the larger of both is a point
    for before, width, count in (
        (-9.0, 0.95e-6 * 9.0, 1), (-9.0, 1.05e-6 * 9.0, 5), (9.0, 0.95e-6 * 9.0, 1),
        (9.0, 1.05e-6 * 9.0, 5),
    ):  # fmt: skip
        assert len(front(width, before).points) == count


# ------------------------------------------------------------------------------------- sensitivity


def test_bars_are_ranked_by_the_larger_of_their_changes() -> None:
    def bar(name: str, minus: float, plus: float) -> TornadoBar:
        base, both = np.full(5, 10.0), [np.full(5, 10.0) for _ in range(2)]
        both[0][2], both[1][2] = minus, plus
        return TornadoBar(name, name, "kg", 1.0, *both, np.zeros(5), base)

    bars = (bar("a", 9.0, 10.5), bar("b", 10.0, 10.0), bar("c", 9.5, 13.0), bar("d", 10.0, 12.0),
            bar("e", np.nan, 12.0))  # fmt: skip
    assert [one.swing(2) for one in bars[:4]] == [1.0, 0.0, 3.0, 2.0]
    found = Tornado(APPENDIX_4, 0.05, np.zeros(5), bars)
    assert [one.path for one in found.ranked(2)] == ["c", "d", "a"]
    assert found.ranked(1) == []
