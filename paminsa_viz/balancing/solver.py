"""Solves convex programmes: rows and columns added to a linear one until the gap is closed."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from paminsa_viz.balancing.errors import SolverFailed
from paminsa_viz.balancing.master import Master, Trial
from paminsa_viz.balancing.program import Infeasible, Levers, Program, Solution, evaluate
from paminsa_viz.model.arrays import Array

MOST_ROUNDS = 200
"""Rounds after which a solution is returned with the gap it has."""

FEASIBLE = 1e-9
"""By how much of itself (or of 1) a limit may be broken."""

RESOLVED = 2e-10
"""What the linear solver's own tolerance leaves open in a row."""


class _Found(NamedTuple):
    value: float
    state: Array
    amounts: Array
    levers: Levers


def solve(program: Program, *, tolerance: float = 1e-9) -> Solution:
    """Solve a programme.

    Args:
        program: See `program`.
        tolerance: Gap to reach, relative to the optimum or to the programme's ``scale``.

    Raises:
        Infeasible: If no choice meets the limits.
        SolverFailed: If the linear solver fails.
    """
    master = Master(program)
    best: _Found | None = None
    bound, prices, limit_prices = -np.inf, np.zeros((len(program.carriers), 3)), np.zeros(0)
    rounds = 0
    while rounds < MOST_ROUNDS:
        rounds += 1
        trial = master.solve(elastic=False)
        if trial is None:
            rounds += _make_feasible(master)
            continue
        found = _measured(program, trial.levers)
        if trial.bound > bound:
            bound, prices, limit_prices = trial.bound, trial.prices, trial.limit_prices
        if _meets(program, found) and (best is None or found.value < best.value):
            best = found
        size = max(abs(bound), program.scale)
        if best is not None and best.value - bound <= tolerance * size:
            break
        if not master.extend(trial, max(0.1 * tolerance * size, RESOLVED)):
            break
    if best is None:
        raise SolverFailed("the limits could not be met within rounding")
    best = _tidied(program, best, bound)
    least = [
        carrier.cheapest(price) for carrier, price in zip(program.carriers, prices, strict=True)
    ]
    slopes = [price[1] + 2 * at * price[2] for price, (at, _) in zip(prices, least, strict=True)]
    return Solution(
        best.state, best.amounts, best.levers, best.value, bound,
        np.array([value for _, value in least]), np.array(slopes), limit_prices, rounds,
    )  # fmt: skip


def _measured(program: Program, levers: Levers) -> _Found:
    state, amounts = evaluate(program, levers)
    value = sum(weight * piece.value(state, amounts) for weight, piece in program.goals)
    return _Found(float(value), state, amounts, levers)


def _meets(program: Program, found: _Found) -> bool:
    """Whether limits are met themselves, not only the rows so far."""
    return all(
        piece.value(found.state, found.amounts) <= limit + FEASIBLE * max(1.0, abs(limit))
        for limit, piece in program.limits
    )


def _make_feasible(master: Master) -> int:
    """Add levers and rows until the limits can be met; return the rounds.

    Raises:
        Infeasible: If they cannot.
    """
    for rounds in range(1, MOST_ROUNDS + 1):
        trial: Trial | None = master.solve(elastic=True)
        if trial is None:
            raise Infeasible(np.inf)
        if trial.bound > FEASIBLE:
            raise Infeasible(trial.bound)
        if trial.excess <= RESOLVED or not master.extend(trial, RESOLVED):
            if trial.excess > FEASIBLE:
                raise Infeasible(trial.excess)
            return rounds
    raise SolverFailed("it could not be decided whether the limits can be met")


def _tidied(program: Program, best: _Found, bound: float) -> _Found:
    """Leave out levers without amount, and join neighbors that stand for one lever."""
    levers: Levers = []
    for carrier, places in zip(program.carriers, best.levers, strict=True):
        used = sorted((v, a) for v, a in places if a > 1e-9 * carrier.high)
        close = 1e-3 * (carrier.span[1] - carrier.span[0])
        joined: list[tuple[float, float]] = []
        for lever, amount in used:
            if joined and lever - joined[-1][0] <= close:
                old, held = joined.pop()
                joined.append(((old * held + lever * amount) / (held + amount), held + amount))
            else:
                joined.append((lever, amount))
        levers.append(joined if len(places) > 1 else places)
    tidy = _measured(program, levers)
    allowed = best.value + 1e-9 * max(abs(bound), program.scale)
    return tidy if tidy.value <= allowed and _meets(program, tidy) else best
