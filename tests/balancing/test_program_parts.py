"""Parts of programs and of their solver: at limits, with made-up solvers and small programs."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.balancing import (
    backends,
    solver,
)
from paminsa_viz.balancing.convex import Cuts, MaxAbs, Norm, PositivePartSum
from paminsa_viz.balancing.enclosure import FEASIBLE, RESOLVED, Enclosure
from paminsa_viz.balancing.program import Infeasible, Program, SolverFailed, Variable
from paminsa_viz.balancing.solver import _candidate, _excesses, _relax, _without_rounding_error
from tests.balancing.test_programs import plain

UP = MaxAbs(np.array([[1.0]]), np.zeros(1), absolute=False)


def one(low: float = 0.0, high: float = 2.0, name: str = "x") -> Variable:
    return Variable(name, low, high, np.array([[1.0], [0.0], [0.0]]))


# ---------------------------------------------------------------- programs and their solver


def test_limits_are_exceeded_as_a_part_of_themselves_or_of_one() -> None:
    limits = ((0.5, UP), (20.0, UP), (-20.0, UP))
    program = Program(np.zeros(1), (one(),), ((2.0, UP), (0.5, UP)), limits)
    assert _excesses(program, np.array([1.0])) == pytest.approx([0.5, -19 / 20, 21 / 20])
    found = _candidate(program, [[(0.0, 1.0)]])
    assert (found.value, found.excess) == (2.5, pytest.approx(21 / 20))
    assert found.rank == (pytest.approx(21 / 20), 2.5)
    free = _candidate(replace(program, limits=()), [[(0.0, 1.0)]])
    assert (free.excess, free.rank) == (-np.inf, (0.0, 2.5))
    for by, first in ((0.0, 0.0), (0.9 * FEASIBLE, 0.0), (1.1 * FEASIBLE, 1.1 * FEASIBLE)):
        limited = replace(program, limits=((1.0 - by, UP),))
        assert _candidate(limited, [[(0.0, 1.0)]]).rank[0] == pytest.approx(first, rel=1e-4)


class Elastic:
    """An enclosure whose trials are made up."""

    def __init__(self, trials: list[Any], extends: list[bool]) -> None:
        self.trials, self.extends = list(trials), list(extends)
        self.relaxed: list[float] = []
        self.slacks: list[float] = []

    def solve(self, *, elastic: bool = False) -> Any:
        assert elastic
        return self.trials.pop(0)

    def extend(self, trial: Any, slack: float) -> bool:
        self.slacks.append(slack)
        return self.extends.pop(0)

    def relax(self, excess: float) -> None:
        self.relaxed.append(excess)


def trial(bound: float, excess: float) -> Any:
    return SimpleNamespace(bound=bound, excess=excess)


def test_limits_out_of_reach_by_rounding_alone_are_raised_and_others_refused() -> None:
    small = 0.5 * FEASIBLE
    made: Any = Elastic([trial(0.0, 0.0), trial(small, small)], [True, False])
    assert _relax(made) == 2
    assert made.relaxed == [pytest.approx(small + RESOLVED, rel=1e-12)]
    assert made.slacks == [RESOLVED] * 2
    assert _relax(Elastic([trial(FEASIBLE, FEASIBLE)], [False])) == 1  # type: ignore
    for trials, extends, excess in (
        ([None], [], np.inf), ([trial(1.1 * FEASIBLE, 0.0)], [], 1.1 * FEASIBLE),
        ([trial(0.0, 1.1 * FEASIBLE)], [False], 1.1 * FEASIBLE),
    ):  # fmt: skip
        with pytest.raises(Infeasible) as caught:
            _relax(Elastic(trials, extends))  # type: ignore
        assert caught.value.excess == pytest.approx(excess)
    endless = Elastic([trial(0.0, 1.0)] * 300, [True] * 300)
    with pytest.raises(SolverFailed, match="could not be decided"):
        _relax(endless)  # type: ignore
    assert len(endless.slacks) == solver.MAX_ROUNDS


def test_amounts_near_their_bounds_are_put_there_and_shared_ones_at_one_lever() -> None:
    goal = MaxAbs(np.array([[1.0]]), np.zeros(1), absolute=False)

    def tidy(variable: Variable, places: list[tuple[float, float]], slack: float = 1e-6) -> Any:
        program = Program(np.zeros(1), (variable,), ((1.0, goal),))
        return _without_rounding_error(program, _candidate(program, [places]), slack).levers[0]

    plain_one = one(0.5, 2.0)
    for amount, wanted in (
        (0.5 + 1.9e-9, 0.5), (2.0 - 1.9e-9, 2.0), (0.5 + 2.1e-9, 0.5 + 2.1e-9), (1.2, 1.2),
    ):  # fmt: skip
        assert tidy(plain_one, [(0.0, amount)]) == [(0.0, wanted)]
    # not where the goal becomes worse by more than the slack
    assert tidy(plain_one, [(0.0, 2.0 - 1.9e-9)], 1e-12) == [(0.0, 2.0 - 1.9e-9)]
    levered = Variable("y", 0.0, 2.0, np.array([[1.0], [0.0], [0.0]]), (-1.0, 1.0))
    assert tidy(levered, [(-0.5, 0.3), (1.0, 0.1)]) == [(pytest.approx(-0.125), pytest.approx(0.4))]
    assert tidy(levered, [(0.5, 1e-9)]) == []
    assert tidy(levered, []) == []
    curved = Variable("z", 0.0, 2.0, np.array([[0.0], [0.0], [-1.0]]), (-1.0, 1.0))
    shared = [(-1.0, 0.2), (1.0, 0.2)]
    assert tidy(curved, shared) == shared  # together they are worth more than at their mean


@pytest.mark.parametrize(("share", "count"), [(0.0, 1), (1.0, 2), (0.5, 2)])
def test_a_lever_at_the_far_end_alone_has_one_place(share: float, count: int) -> None:
    slot = Variable("slot", 0.0, 3.0, np.zeros((3, 1)), (-0.5, 1.5))
    levers, amounts = np.array([-0.3, 1.0]), np.array([2.0 - share, share])
    moments = np.array([(amounts * levers**k).sum() for k in range(3)])
    places = slot.levers_of(moments)
    assert len(places) == count
    assert sum(amount for _, amount in places) == pytest.approx(2.0)
    scaled = [((lever - 0.5) / 1.0, amount) for lever, amount in places]
    for power in range(3):
        total = sum(amount * u**power for u, amount in scaled)
        assert total == pytest.approx(moments[power], abs=1e-12)
    # moments that no levers have are those of one
    assert slot.levers_of(np.array([2.0, 1.0, 0.1])) == [(pytest.approx(1.0), 2.0)]
    assert slot.levers_of(np.array([2.0, 5.0, 2.0])) == [(1.5, 2.0)]
    assert slot.levers_of(np.array([0.0, 0.0, 0.0])) == []
    assert slot.levers_of(np.array([5.0, 0.0, 0.0]))[0][1] == 3.0
    # more spread than the levers have is that of the ends
    wide = slot.levers_of(np.array([2.0, 0.0, 9.0]))
    assert wide == [(pytest.approx(-0.5), pytest.approx(1.0)), (1.5, pytest.approx(1.0))]


def test_the_cheapest_lever_is_that_of_the_parabola_or_an_end() -> None:
    slot = Variable("slot", 0.0, 1.0, np.zeros((3, 1)), (-0.5, 2.0))
    for prices, lever in (
        ((1.0, -2.0, 1.0), 1.0), ((1.0, 2.0, 1.0), -0.5), ((1.0, -9.0, 1.0), 2.0),
        ((1.0, 1.0, -1.0), 2.0), ((1.0, 2.0, -1.0), -0.5), ((1.0, 1.0, 0.0), -0.5),
    ):  # fmt: skip
        at, value = slot.cheapest(np.array(prices))
        assert at == pytest.approx(lever)
        every = np.linspace(-0.5, 2.0, 2501)
        assert value == pytest.approx((prices[0] + every * (prices[1] + every * prices[2])).min())
    fixed = Variable("fixed", 0.0, 1.0, np.zeros((3, 1)), (0.5, 0.5))
    assert fixed.cheapest(np.array([1.0, -2.0, 1.0])) == (0.5, 0.25)


def test_an_enclosure_starts_with_the_cuts_at_three_levels() -> None:
    """All amounts at their least, halfway, and most, the levers in the middle."""
    slot = Variable("slot", 0.5, 2.0, np.array([[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]]), (0.0, 1.0))
    seen: list[Any] = []

    class Noted(MaxAbs):
        def cuts(self, state: Any, known: Any, slack: float) -> Cuts:
            seen.append((state.tolist(), known.tolist(), slack))
            return super().cuts(state, known, slack)

    goal, limit = Noted(np.eye(2), np.zeros(2)), Noted(np.eye(2), np.zeros(2))
    program = Program(np.array([1.0, 0.0]), (slot,), ((1.0, goal),), ((4.0, limit),))
    made = Enclosure(program)
    states = [[1.0 + a, 0.5 * a] for a in (0.5, 1.25, 2.0)]
    assert [row[0] for row in seen[::2]] == [pytest.approx(state) for state in states]
    assert [row[0] for row in seen[1::2]] == [pytest.approx(state) for state in states]
    assert {(row[1][0], row[2]) for row in seen} == {(-np.inf, 0.0)}
    assert made.limit_scale.tolist() == [4.0]
    made.relax(0.01)
    assert made.limits.tolist() == [pytest.approx(4.04)]
    # limits have to be met more closely than goals be known
    seen.clear()
    assert not made._cut(np.array([0.0, 0.0]), np.full(2, np.inf), 1e-3)
    assert [row[2] for row in seen] == [1e-3, 0.5 * FEASIBLE * 4.0]
    seen.clear()
    made._cut(np.array([0.0, 0.0]), np.full(2, np.inf), 1e-12)
    assert [row[2] for row in seen] == [1e-12, 1e-12]


def test_tangents_are_added_where_moments_break_them() -> None:
    slot = Variable("slot", 0.0, 2.0, np.array([[1.0], [1.0], [1.0]]), (-1.0, 1.0))
    program = Program(np.zeros(1), (slot,), ((1.0, UP),))
    made = Enclosure(program)
    assert made.tangents == [(0, -1.0), (0, 0.0), (0, 1.0)]

    def extended(moments: Any, made: Any = made) -> bool:
        given: Any = SimpleNamespace(
            state=np.zeros(1), parts=np.full(1, np.inf), moments=[np.array(moments)]
        )
        return made.extend(given, 1.0)

    # a second moment below the square of the first over the amount
    assert extended([2.0, 1.0, 0.4])
    assert made.tangents[-1] == (0, 0.5)
    assert not extended([2.0, 1.0, 0.4])  # it is there already
    assert not extended([2.0, 1.2, 0.72])
    assert not extended([2.0, 1.2, 0.72 - 0.9 * RESOLVED])
    assert extended([2.0, 1.2, 0.72 - 2.0 * RESOLVED])
    assert not extended([0.0, 0.0, 0.0])
    # beyond the ends of the levers it is the tangent there
    assert not extended([2.0, 2.4, 1.0])
    assert not extended([2.0, -2.4, 1.0])
    norm = Enclosure(replace(program, goals=((1.0, Norm(np.eye(1), np.zeros(1))),)))
    assert not extended([2.0, 1.0, 0.4], norm)


def test_opposite_cuts_of_a_limit_of_zero_share_no_weight() -> None:
    """Of other limits, and of sums of parts, they are left alone."""
    equal = MaxAbs(np.array([[1.0]]), np.array([-1.0]))
    cuts = Cuts(
        np.array([1, 1, 1, 0]), np.array([[1.0], [-1.0], [2.0], [1.0]]),
        np.array([-1.0, 1.0, -2.0, 0.0]),
    )  # fmt: skip
    weights = np.array([0.5, 0.2, 0.7, 0.9])
    for limit, expected in (
        (0.0, [0.3, 0.0, 0.7, 0.9]), (0.9 * FEASIBLE, [0.3, 0.0, 0.7, 0.9]),
        (FEASIBLE, [0.3, 0.0, 0.7, 0.9]), (1.1 * FEASIBLE, weights), (1.0, weights),
    ):  # fmt: skip
        program = Program(np.zeros(1), (one(),), ((1.0, UP),), ((limit, equal),))
        found = Enclosure(program)._canceled(cuts, weights)
        assert found == pytest.approx(expected, abs=1e-15)
    assert weights.tolist() == [0.5, 0.2, 0.7, 0.9]
    total = PositivePartSum(np.eye(1).repeat(2, 0), np.zeros(2), np.array([0, 1]))
    program = Program(np.zeros(1), (one(),), ((1.0, UP),), ((0.0, total),))
    found = Enclosure(program)._canceled(cuts, weights)
    assert found.tolist() == weights.tolist()


def test_prices_of_limits_are_the_multipliers_of_all_their_cuts() -> None:
    """And the least of the Lagrangian is a bound whatever they are."""
    limit = MaxAbs(np.eye(2), np.zeros(2))
    goal = MaxAbs(-np.ones((1, 2)), np.zeros(1), absolute=False)
    program = Program(
        np.zeros(2), plain(np.eye(2), [0, 0], [2, 2]), ((1.0, goal),), ((1.0, limit),)
    )
    made = Enclosure(program)
    cuts = Cuts(np.array([0, 1, 1]), np.array([[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]]), np.zeros(3))
    for weights, price in (((1.0, 1.0, 1.0), 2.0), ((1.0, 0.3, 0.5), 0.8), ((1.0, 0.0, 0.0), 0.0)):
        bound, prices, limits = made.lagrangian(cuts, np.array(weights), elastic=False)
        assert limits == pytest.approx([price])
        x, y = np.meshgrid(np.linspace(0, 2, 21), np.linspace(0, 2, 21))
        least = (-x - y + weights[1] * (x - 0) + weights[2] * y - price).min()
        assert bound == pytest.approx(least)
        assert prices[:, 0] == pytest.approx([-1 + weights[1], -1 + weights[2]])
    # without limits there are none
    free = Enclosure(replace(program, limits=()))
    only = Cuts(np.array([0]), np.array([[-1.0, -1.0]]), np.zeros(1))
    assert free.lagrangian(only, np.ones(1), elastic=False)[2].shape == (0,)


# ---------------------------------------------------------------- terms


def test_a_part_that_is_just_as_large_as_known_has_no_cut() -> None:
    total = PositivePartSum(np.eye(2), np.zeros(2), np.array([0, 1]))
    known = np.array([0.25, 0.5])
    found = total.cuts(known + 0.125, known, 0.25)
    assert not len(found.part)
    assert total.cuts(known + 0.125 + 1e-9, known, 0.25).part.tolist() == [0, 1]
    assert (total.parts, total.nonnegative) == (2, True)
    assert (UP.parts, UP.nonnegative) == (1, False)
    assert MaxAbs(np.eye(1), np.zeros(1)).nonnegative
    assert Norm(np.eye(1), np.zeros(1)).nonnegative
    empty = Norm(np.eye(3), np.zeros(3)).cuts(np.ones(3), np.zeros(1), 0.0)
    assert [part.shape for part in empty] == [(0,), (0, 3), (0,)]


# ---------------------------------------------------------------- solvers of other packages


def scripted(monkeypatch: pytest.MonkeyPatch, answers: list[Any]) -> list[Any]:
    """Let Clarabel return these answers; what it is given is noted."""
    import clarabel

    given: list[Any] = []

    def make(*arguments: Any) -> Any:
        given.append((*arguments, arguments[-1].static_regularization_constant))
        return SimpleNamespace(solve=lambda: answers[len(given) - 1])

    monkeypatch.setattr(clarabel, "DefaultSolver", make)
    return given


def answer(status: str, residual: float, x: float) -> Any:
    return SimpleNamespace(
        status=status, obj_val=0.0, obj_val_dual=0.0, r_prim=residual, r_dual=residual, x=[x],
        z=[1.0, 2.0, 3.0],
    )  # fmt: skip


def test_of_several_tries_the_closest_counts_or_the_first_that_is_solved(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    program = backends.ConicProgram(
        np.array([1.0]), np.array([[-4.0]]), np.array([-1.0]), np.zeros(1), np.array([2.0]), []
    )
    for tries, count, x in (
        ([("Almost", 1e-6), ("Almost", 1e-8), ("Almost", 1e-7)], 3, 0.2),
        ([("Almost", 1e-9), ("Almost", 1e-8), ("Almost", 1e-7)], 3, 0.1),
        ([("Almost", 1e-8), ("Almost", 1e-8), ("Almost", 1e-8)], 3, 0.1),
        ([("Almost", 1e-9), ("Solved", 1e-3)], 2, 0.2),
        ([("Almost", np.nan), ("Almost", 1.0), ("Almost", 2.0)], 3, 0.2),
    ):
        answers = [answer(*one, 0.1 + 0.1 * number) for number, one in enumerate(tries)]
        given = scripted(monkeypatch, answers)
        found = backends.solve_conic(program)
        assert found is not None
        assert found.x == pytest.approx([2.0 * x])  # of its upper bound
        assert [one[-1] for one in given] == list(backends.REGULARIZATIONS[:count])
        # rows in parts of their largest coefficients: -4 x 2, then 2 of both bounds
        assert found.multipliers == pytest.approx([1.0 / 8.0])
        assert given[0][2].toarray() == pytest.approx(np.array([[-1.0], [1.0], [-1.0]]))
    settings = given[0][5]
    assert settings.tol_gap_abs == settings.tol_gap_rel == settings.tol_feas == 1e-11
    assert settings.iterative_refinement_reltol == settings.iterative_refinement_abstol == 1e-15
    assert settings.iterative_refinement_max_iter == 30
    assert not settings.verbose
    scripted(monkeypatch, [answer("PrimalInfeasible", 1.0, 0.1)])
    assert backends.solve_conic(program) is None


def test_fixed_unknowns_are_left_out_and_only_bounds_that_there_are_have_rows(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    rows, inf = np.array([[3.0, 2.0, -8.0]]), np.inf
    program = backends.ConicProgram(
        np.array([1.0, 2.0, 3.0]), rows, np.array([10.0]), np.array([1.0, 0.5, -inf]),
        np.array([1.0, inf, 2.0]), [],
    )  # fmt: skip
    found = answer("Solved", 0.0, 0.0)
    found.x = [0.7, 0.25]
    given = scripted(monkeypatch, [found])
    solution = backends.solve_conic(program)
    assert solution is not None
    # of the last in parts of its upper bound
    assert solution.x.tolist() == [1.0, 0.7, 0.5]
    quadratic, cost, matrix, right, cones, *_ = given[0]
    assert quadratic.shape == (2, 2)
    assert cost.tolist() == [2.0, 6.0]
    assert matrix.toarray() == pytest.approx(np.array([[2.0 / 16, -1.0], [0.0, 1.0], [-1.0, 0.0]]))
    assert right == pytest.approx([7.0 / 16, 1.0, -0.5])
    assert [cone.dim for cone in cones] == [3]


def test_a_residual_is_the_largest_of_three_as_a_share_of_the_cost_or_of_one() -> None:
    def of(cost: float, dual: float, primal: float, other: float) -> float:
        return backends._residual(
            SimpleNamespace(obj_val=cost, obj_val_dual=dual, r_prim=primal, r_dual=other)
        )

    assert of(0.5, 0.2, 0.0, 0.0) == pytest.approx(0.3)
    assert of(-4.0, -3.0, 0.0, 0.0) == pytest.approx(0.25)
    assert of(1.0, 1.0, 0.4, 0.1) == 0.4
    assert of(1.0, 1.0, 0.1, 0.4) == 0.4
    assert of(1.0, np.nan, 0.0, 0.0) == np.inf


def test_a_norm_of_many_rows_keeps_columns_that_have_zeros() -> None:
    matrix = np.array([[1.0, 0.0], [0.0, 2.0], [3.0, 4.0]])
    found = Norm.of_many(matrix, np.array([1.0, -1.0, 0.5]))
    for state in np.array([[0.0, 0.0], [1.0, -2.0], [-0.3, 0.7]]):
        expected = np.linalg.norm(matrix @ state + [1.0, -1.0, 0.5])
        assert found.value(state) == pytest.approx(expected)


def test_a_norm_is_least_from_any_start() -> None:
    rng = np.random.default_rng(4)
    matrix, offset, start = rng.normal(size=(6, 2)), rng.normal(size=6), np.array([0.7, -1.3])
    program = Program(
        start, plain(np.eye(2), [0, 0], [3, 3]), ((1.0, Norm(matrix, offset)),), scale=1.0
    )
    found = solver.solve(program)
    x, y = np.meshgrid(np.linspace(0, 3, 301), np.linspace(0, 3, 301))
    states = start + np.column_stack([x.ravel(), y.ravel()])
    least = np.linalg.norm(states @ matrix.T + offset, axis=1).min()
    assert least - 0.05 < found.value <= least + 1e-9


def test_limits_that_exclude_each_other_are_exceeded_by_the_least_share() -> None:
    """x <= 1 and x >= 3: by 1 of the one and by 1/3 of the other where x is 2."""
    low = MaxAbs(np.array([[-1.0]]), np.zeros(1), absolute=False)
    program = Program(np.zeros(1), (one(0.0, 9.0),), ((1.0, UP),), ((1.0, UP), (-3.0, low)))
    made = Enclosure(program)
    assert made.solve() is None
    found = made.solve(elastic=True)
    assert found is not None
    assert found.excess == pytest.approx(0.5)  # x = 1.5 of both
    assert found.state == pytest.approx([1.5])
    assert found.bound == pytest.approx(0.5)


def test_only_cuts_that_are_opposite_in_all_share_no_weight() -> None:
    equal = MaxAbs(np.array([[1.0]]), np.array([-1.0]))
    cuts = Cuts(np.array([1, 1]), np.array([[1.0], [-1.0]]), np.array([-1.0, 7.0]))
    program = Program(np.zeros(1), (one(),), ((1.0, UP),), ((0.0, equal),))
    weights = np.array([0.5, 0.2])
    assert Enclosure(program)._canceled(cuts, weights).tolist() == [0.5, 0.2]
