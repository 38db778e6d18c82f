"""The solver of convex programs on problems whose answer is known otherwise."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import lsq_linear

from paminsa_viz.balancing import backends, solver
from paminsa_viz.balancing.convex import BLOCKS, ConvexTerm, Cuts, MaxAbs, Norm, PositivePartSum
from paminsa_viz.balancing.enclosure import Enclosure
from paminsa_viz.balancing.program import Infeasible, Program, Solution, SolverFailed, Variable
from paminsa_viz.balancing.solver import solve
from paminsa_viz.trajectory.integrals import running_integral, time_weights

SEEDS = st.integers(0, 10_000)


def plain(columns: Any, low: Any, high: Any) -> tuple[Variable, ...]:
    """Variables without a lever."""
    return tuple(
        Variable(f"x{i}", float(a), float(b), np.vstack([column, np.zeros((2, len(column)))]))
        for i, (column, a, b) in enumerate(zip(columns, low, high, strict=True))
    )


@given(seed=SEEDS, size=st.integers(1, 8))
def test_least_squares_within_bounds(seed: int, size: int) -> None:
    rng = np.random.default_rng(seed)
    matrix, offset = rng.normal(size=(12, size)), rng.normal(size=12)
    low = rng.uniform(0, 0.3, size)
    high = low + rng.uniform(0, 1, size)
    program = Program(
        np.zeros(size), plain(np.eye(size), low, high), ((1.0, Norm(matrix, offset)),)
    )
    found = solve(program)
    other = lsq_linear(matrix, -offset, (low, high + 1e-15), method="bvls", tol=1e-14)
    assert found.value == pytest.approx(np.sqrt(2 * other.cost), rel=1e-8)
    assert found.bound <= found.value + 1e-12
    assert found.gap <= 1e-8 * found.value
    assert ((low <= found.amounts) & (found.amounts <= high)).all()


@given(seed=SEEDS, linear=st.booleans(), most=st.sampled_from([0.1, 1.0, 4.0]))
def test_free_lever_is_no_worse_than_random_levers(seed: int, linear: bool, most: float) -> None:
    """With a norm the cone of the moments is a solver's, with linear terms it is cut out."""
    rng = np.random.default_rng(seed)
    effect = rng.normal(size=(3, 4)) / most
    slot = Variable("slot", 0.2 * most, most, effect, (-1.0, 1.0))
    offset = rng.normal(size=4)
    target = MaxAbs(np.eye(4), offset) if linear else Norm(np.eye(4), offset)
    free = solve(Program(np.zeros(4), (slot,), ((1.0, target),)))
    levers, share = rng.uniform(-1, 1, (20_000, 2, 1)), rng.uniform(0, 1, (20_000, 1))
    effects = effect[0] + levers * effect[1] + levers**2 * effect[2]
    state = share * effects[:, 0] + (1 - share) * effects[:, 1]
    state *= most * rng.uniform(0.1, 1.1, (20_000, 1)).clip(0.2, 1.0)
    best = np.linalg.norm(state + offset, ord=np.inf if linear else 2, axis=1).min()
    assert free.bound <= free.value <= best + 1e-9
    assert best - free.value < 0.1
    assert free.gap <= 1e-8 * max(1.0, free.value)
    np.testing.assert_array_equal(Program(np.zeros(4), (slot,), ()).state(free.levers), free.state)
    assert 0.2 - 1e-9 <= free.amounts[0] / most <= 1.0 + 1e-9


@pytest.mark.slow
@given(seed=SEEDS)
def test_piecewise_linear_optima_beat_random_points(seed: int) -> None:
    rng = np.random.default_rng(seed)
    matrix, offset = rng.normal(size=(40, 3)), rng.normal(size=40)
    terms = (MaxAbs(matrix, offset), PositivePartSum(matrix, offset, np.array([0, 10, 20, 30])))
    variables = plain(np.eye(3), np.zeros(3), np.ones(3))
    x = rng.uniform(size=(4000, 3))
    for term in terms:
        found = solve(Program(np.zeros(3), variables, ((1.0, term),)))
        values = x @ matrix.T + offset
        each = np.abs(values).max(axis=1) if term is terms[0] else np.maximum(values, 0).sum(axis=1)
        assert found.gap <= 1e-8 * max(1.0, found.value)
        assert each.min() >= found.bound
        assert found.value == pytest.approx(term.value(found.state), rel=1e-12)


def test_limit_met_by_an_inner_lever_alone() -> None:
    """The first levers tried, the ends and the middle, all break it."""
    effect = np.array([[0.0, 1.0], [0.0, 0.0], [0.0, 0.0]])
    effect[:, 0] = [(0.31) ** 2, -0.62, 1.0]  # (lever - 0.31)^2
    slot = Variable("slot", 1.0, 1.0, effect, (0.0, 1.0))
    limit = MaxAbs(np.array([[1.0, 0.0]]), np.zeros(1), absolute=False)
    goal = MaxAbs(np.array([[0.0, 1.0]]), np.zeros(1))
    found = solve(Program(np.zeros(2), (slot,), ((1.0, goal),), limits=((1e-6, limit),)))
    assert found.state[0] <= 1e-6 + 2e-9
    with pytest.raises(Infeasible):
        solve(Program(np.zeros(2), (slot,), ((1.0, goal),), limits=((-1e-3, limit),)))


@pytest.mark.parametrize("seed", range(4))
def test_a_norm_of_many_rows_is_that_of_their_triangle(seed: int) -> None:
    """Also where a column is empty, so that the triangle has fewer."""
    rng = np.random.default_rng(seed)
    matrix, offset = rng.normal(size=(30, 4)), rng.normal(size=30)
    matrix[:, 1] = 0.0
    states = rng.normal(size=(20, 4))
    for right in (offset, matrix @ [1.0, 2.0, 3.0, 4.0]):  # which no row is left for
        found = Norm.of_many(matrix, right)
        assert len(found.matrix) <= 4
        values = [found.value(state) for state in states]
        np.testing.assert_allclose(values, np.linalg.norm(states @ matrix.T + right, axis=1))


def test_cuts_of_a_maximum_are_the_largest_of_each_block_that_exceed_what_is_known() -> None:
    rng = np.random.default_rng(2)
    offset = rng.normal(size=7 * BLOCKS)
    term, state = MaxAbs(rng.normal(size=(len(offset), 3)), offset), rng.normal(size=3)
    size = np.abs(term.at(state)).reshape(BLOCKS, 7)
    for known, slack in ((-np.inf, 0.0), (np.median(size.max(axis=1)), 0.1)):
        found = term.cuts(state, np.array([known]), slack)
        values = found.matrix @ state + found.offset
        expected = size.max(axis=1)
        np.testing.assert_allclose(values, expected[expected > known + slack])
        assert not found.part.any()
    few = MaxAbs(np.eye(3), np.zeros(3)).cuts(np.ones(3), np.array([0.0]), 0.0)
    np.testing.assert_array_equal(few.matrix, np.eye(3))


@pytest.mark.parametrize("starts", [[0], [0, 1], [0, 2], [0, 1, 2]])
def test_a_limit_of_a_sum_is_of_all_its_groups_together(starts: list[int]) -> None:
    """The dearest unknowns first: the third whole, then half of the second."""
    total = PositivePartSum(np.eye(3), np.zeros(3), np.array(starts))
    goal = MaxAbs(-np.array([[1.0, 2.0, 3.0]]), np.zeros(1), absolute=False)
    variables = plain(np.eye(3), np.zeros(3), np.ones(3))
    found = solve(Program(np.zeros(3), variables, ((1.0, goal),), limits=((1.5, total),)))
    assert found.value == pytest.approx(-4.0, abs=1e-7)
    np.testing.assert_allclose(found.state, [0.0, 0.5, 1.0], atol=1e-6)
    assert found.limit_prices == pytest.approx([2.0], abs=1e-5)  # of more of the second


@pytest.mark.slow
def test_a_small_goal_is_solved_like_a_large_one() -> None:
    """An energy of a small robot: the solvers' own tolerances are absolute."""
    rng, small = np.random.default_rng(1), 2.0**-18
    matrix, offset = rng.normal(size=(300, 3)), rng.normal(size=300)
    variables, starts = plain(np.eye(3), [0, 0, 0], [2, 2, 2]), np.arange(300)

    def solved(size: float) -> Solution:
        goal = PositivePartSum(size * matrix, size * offset, starts)
        goals, before = ((1.0, goal),), goal.value(np.ones(3))
        return solve(Program(np.zeros(3), variables, goals, scale=before))

    large, found = solved(1.0), solved(small)
    assert found.rounds <= 2 * large.rounds
    assert found.gap <= 1e-9 * found.value
    for of_small, of_large in (
        (found.value, large.value), (found.bound, large.bound), (found.prices, large.prices)
    ):  # fmt: skip
        assert of_small == pytest.approx(small * of_large, rel=1e-6, abs=1e-8 * small)


@pytest.mark.parametrize("large", [1.0, 1e6])
def test_limits_are_met_closely_however_large_a_goal_is(large: float) -> None:
    """A circle of 4096 tangents, as far as possible toward (1, 2)."""
    angle = 2.0 * np.pi * np.arange(4096) / 4096
    circle = MaxAbs(np.column_stack([np.cos(angle), np.sin(angle)]), np.zeros(4096))
    goal = MaxAbs(-large * np.array([[1.0, 2.0]]), np.zeros(1), absolute=False)
    variables = plain(np.eye(2), [0, 0], [2, 2])
    found = solve(
        Program(np.zeros(2), variables, ((1.0, goal),), limits=((1.0, circle),), scale=large)
    )
    assert circle.value(found.state) <= 1.0 + 1e-8
    assert found.value == pytest.approx(-large * np.sqrt(5.0), rel=1e-6)


@pytest.mark.parametrize(("name", "value"), [("MAX_ROUNDS", 0), ("ACCEPTED", -np.inf)])
def test_what_is_not_solved_is_said_so(
    name: str, value: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(solver, name, value)
    goal = MaxAbs(np.eye(2), np.ones(2))
    limit = MaxAbs(np.eye(2), np.zeros(2))
    program = Program(
        np.zeros(2), plain(np.eye(2), [0, 0], [1, 1]), ((1.0, goal),), limits=((0.5, limit),)
    )
    with pytest.raises(SolverFailed, match="could not be met within rounding") as caught:
        solve(program)
    assert caught.value.reason == "the limits could not be met within rounding"


def test_rounds_are_those_of_the_solver_and_end_at_the_tolerance(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    rng = np.random.default_rng(11)
    slot = Variable("slot", 0.2, 1.0, rng.normal(size=(3, 4)), (-1.0, 1.0))
    term = MaxAbs(np.eye(4), rng.normal(size=4))
    program = Program(np.zeros(4), (slot,), ((1.0, term),))
    solved = []
    of_class = Enclosure.solve

    def counted(self: Enclosure, **options: Any) -> Any:
        solved.append(options)
        return of_class(self, **options)

    monkeypatch.setattr(Enclosure, "solve", counted)
    needed = []
    for tolerance in (1e-9, 0.01, 10.0):
        solved.clear()
        found = solve(program, tolerance=tolerance)
        assert found.rounds == len(solved)
        assert found.gap <= tolerance * found.value
        needed.append(found.rounds)
    assert needed[0] > needed[1] > needed[2] == 1
    # a sum that is out of reach by rounding, which takes rounds of its own
    solved.clear()
    equal = MaxAbs(np.ones((1, 2)), np.array([-2.0 - 1e-10]))
    goal = MaxAbs(np.array([[1.0, 2.0]]), np.zeros(1), absolute=False)
    bars = plain(np.eye(2), [0, 0], [1, 1])
    found = solve(Program(np.zeros(2), bars, ((1.0, goal),), limits=((0.0, equal),)))
    assert {"elastic": True} in solved
    assert found.rounds == len(solved)


def test_a_fixed_sum_out_of_reach_is_infeasible() -> None:
    variables = plain(np.eye(2), [0, 0], [1, 1])
    goal = MaxAbs(np.array([[1.0, 2.0]]), np.zeros(1), absolute=False)

    def fixed(total: float) -> Program:
        equal = MaxAbs(np.array([[1.0, 1.0]]), np.array([-total]))
        return Program(np.zeros(2), variables, ((1.0, goal),), limits=((0.0, equal),))

    assert solve(fixed(1.5)).value == pytest.approx(2.0)
    with pytest.raises(Infeasible) as caught:
        solve(fixed(2.5))
    assert caught.value.excess == pytest.approx(0.5, abs=1e-6)


def test_limits_that_are_relaxed_by_their_least_excess_can_be_met() -> None:
    """x <= 100 and 1 - x/50 <= -1.06 exclude each other by 1 % of the larger limit and of 1."""
    low, high = (
        MaxAbs(np.array([[slope]]), np.array([offset]), absolute=False)
        for slope, offset in ((1.0, 0.0), (-0.02, 1.0))
    )
    goal = MaxAbs(np.eye(1), np.zeros(1))
    limits = ((100.0, low), (-1.06, high))
    program = Program(np.zeros(1), plain(np.eye(1), [0], [200]), ((1.0, goal),), limits=limits)
    # 100 (1 + e) = 50 (2.06 - 1.06 e)
    excess = 3.0 / 153.0
    with pytest.raises(Infeasible) as caught:
        solve(program)
    assert caught.value.excess == pytest.approx(excess, rel=1e-6)
    enclosure = Enclosure(program)
    assert enclosure.solve() is None
    enclosure.relax(excess * (1.0 + 1e-6))
    trial = enclosure.solve()
    assert trial is not None
    assert trial.state[0] == pytest.approx(100.0 * (1.0 + excess), rel=1e-6)
    np.testing.assert_allclose(
        enclosure.limits, [100.0 * (1.0 + excess), -1.06 * (1.0 - excess)], rtol=1e-6
    )


@given(seed=SEEDS)
def test_no_bound_on_terms_that_are_never_negative_is(seed: int) -> None:
    """Not even that of the first cuts."""
    rng = np.random.default_rng(seed)
    goals = tuple((rng.uniform(0.1, 2.0), MaxAbs(rng.normal(size=(3, 2)), rng.normal(size=3)))
                  for _ in range(2))  # fmt: skip
    nothing = ((1.0, MaxAbs(np.zeros((1, 2)), np.zeros(1))),)  # which no cut holds
    for terms in (goals, nothing):
        trial = Enclosure(Program(np.zeros(2), plain(np.eye(2), [0, 0], [3, 3]), terms)).solve()
        assert trial is not None
        assert trial.bound >= -1e-9
        assert trial.parts.min() >= -1e-9


@given(seed=SEEDS, free=st.booleans())
def test_levers_reproduce_their_moments(seed: int, free: bool) -> None:
    rng = np.random.default_rng(seed)
    span = (-0.3, 0.5) if free else (0.2, 0.2)
    slot = Variable("slot", 0.0, 3.0, rng.normal(size=(3, 5)), span)
    amounts, levers = rng.uniform(0, 0.7, 4), rng.uniform(*span, 4)
    state = sum(a * slot.column(v) for a, v in zip(amounts, levers, strict=True))
    u = (levers - 0.1) / 0.4 if free else np.zeros(4)
    moments = np.array([(amounts * u**k).sum() for k in range(3 if free else 1)])
    np.testing.assert_allclose(moments @ slot.moment_columns(), state, rtol=1e-12, atol=1e-12)
    places = slot.levers_of(moments)
    assert len(places) <= 2
    assert all(span[0] <= lever <= span[1] and amount >= 0 for lever, amount in places)
    same = sum(amount * slot.column(lever) for lever, amount in places)
    np.testing.assert_allclose(same, state, rtol=1e-10, atol=1e-10)


@pytest.mark.parametrize("term", [
    Norm(np.eye(2), np.zeros(2)), PositivePartSum(np.eye(2), np.zeros(2), np.array([0])),
    MaxAbs(np.eye(2), np.zeros(2)), MaxAbs(np.eye(2), np.zeros(2), absolute=False),
], ids=["norm", "sum", "absolute", "largest"])  # fmt: skip
def test_a_term_says_whether_it_can_be_negative(term: ConvexTerm) -> None:
    states = np.random.default_rng(0).uniform(-1.0, 1.0, (200, 2))
    assert term.nonnegative == (min(map(term.value, states)) >= 0.0)


@given(seed=SEEDS)
def test_bound_holds_whatever_the_multipliers_are(seed: int) -> None:
    """The certificate is a bound from below for any multipliers, not only the solver's."""
    rng = np.random.default_rng(seed)
    terms = (
        Norm(rng.normal(size=(5, 3)), rng.normal(size=5)),
        PositivePartSum(rng.normal(size=(8, 3)), rng.normal(size=8), np.array([0, 4])),
        MaxAbs(rng.normal(size=(6, 3)), rng.normal(size=6)),
        MaxAbs(rng.normal(size=(6, 3)), rng.normal(size=6) - 5.0, absolute=False),  # below zero
    )
    slot = Variable("slot", 0.1, 1.0, rng.normal(size=(3, 3)), (-1.0, 1.0))
    program = Program(
        rng.normal(size=3), (*plain(rng.normal(size=(2, 3)), [0, 0.2], [1, 0.9]), slot),
        ((1.0, terms[0]), (0.5, terms[1]), (2.0, terms[3])), limits=((50.0, terms[2]),),
    )  # fmt: skip
    enclosure = Enclosure(program)
    cuts = Cuts(*(np.concatenate(column) for column in zip(*enclosure.cuts, strict=True)))
    least = solve(program).value
    for most, for_limit in ((0.1, 0.0), (2.0, 0.01), (2.0, 2.0)):
        weights = rng.uniform(0, most, len(cuts.part))
        weights[cuts.part == enclosure.parts[-1].start] = for_limit
        assert enclosure.lagrangian(cuts, weights, elastic=False)[0] <= least + 1e-9


@given(seed=SEEDS, count=st.integers(2, 30))
def test_weights_of_time_are_those_of_the_running_integral(seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    t, values = np.cumsum(rng.uniform(0.7, 1.3, count)), rng.normal(size=count)
    weights = time_weights(t)
    assert weights @ values == pytest.approx(running_integral(t, values)[-1], abs=1e-12)
    assert (weights >= 0).all()


def test_weights_of_very_uneven_times_stay_positive() -> None:
    t = np.array([0.0, 1.0, 1.001, 2.0, 2.001, 3.0])
    weights = time_weights(t)
    assert (weights >= 0).all()
    assert weights.sum() == pytest.approx(3.0)


def test_how_far_a_solver_is_from_the_optimum_does_not_depend_on_the_sign_of_the_cost() -> None:
    def residual(sign: float) -> float:
        found = SimpleNamespace(
            obj_val=sign * 1e6, obj_val_dual=sign * (1e6 - 1.0), r_prim=1e-9, r_dual=1e-9
        )
        return backends._residual(found)

    assert residual(-1.0) == residual(1.0) == pytest.approx(1e-6)


@pytest.mark.parametrize("part", ["x", "z"])
def test_an_answer_that_is_in_part_no_number_is_none(
    monkeypatch: pytest.MonkeyPatch, part: str
) -> None:
    import clarabel

    numbers = {"x": [0.5, 0.5], "z": [0.0, 1.0, 1.0, 1.0, 1.0]}
    numbers[part] = [np.nan, *numbers[part][1:]]
    answer = SimpleNamespace(
        status="Solved", obj_val=1.0, obj_val_dual=1.0, r_prim=0.0, r_dual=0.0, **numbers
    )
    solver = SimpleNamespace(solve=lambda: answer)
    monkeypatch.setattr(clarabel, "DefaultSolver", lambda *_: solver)
    row, unit = np.array([[-1.0, -1.0]]), np.ones(2)
    program = backends.ConicProgram(unit, row, np.array([-1.0]), 0.0 * unit, unit, [])
    with pytest.raises(SolverFailed, match="Solved"):
        backends.solve_conic(program)


@given(seed=SEEDS, groups=st.integers(1, 6))
def test_a_sum_of_positive_parts_without_cuts_is_within_the_slack(seed: int, groups: int) -> None:
    """Each part may exceed what is known of it by its share of the slack, and no more."""
    rng = np.random.default_rng(seed)
    term = PositivePartSum(np.eye(2 * groups), np.zeros(2 * groups), np.arange(0, 2 * groups, 2))
    known, slack = rng.uniform(size=groups), 0.3
    above = slack / groups * rng.choice([0.9, 1.1], size=groups)
    state = np.column_stack([known + above, -np.ones(groups)]).ravel()
    found = term.cuts(state, known, slack)
    np.testing.assert_array_equal(found.part, np.flatnonzero(above > slack / groups))
    assert len(found.part) or term.value(state) <= known.sum() + slack
