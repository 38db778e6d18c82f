"""Solves convex programs: an enclosure is solved and cut closer until its bound is reached.

The gap between the bound and the best solution found is the certificate of the optimum.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from paminsa_viz.balancing.enclosure import FEASIBLE, RESOLVED, Enclosure, EnclosureSolution
from paminsa_viz.balancing.program import Infeasible, Levers, Program, Solution, SolverFailed
from paminsa_viz.model.arrays import Array

MAX_ROUNDS = 200
"""Rounds after which a solution is returned with the gap it has."""


ACCEPTED = 1e-8
"""The same for a solution without a better one: limits may leave a conic solver no interior."""


REACHED = 1e-6
"""The same for a limit that counts as reached; the others have no price."""


class _Candidate(NamedTuple):
    """A choice of levers, what it comes to, and by how much it breaks the limits themselves."""

    levers: Levers
    state: Array
    value: float
    excess: float

    @property
    def rank(self) -> tuple[float, float]:
        """Smaller for a better one."""
        return (0.0 if self.excess <= FEASIBLE else self.excess, self.value)


def solve(program: Program, *, tolerance: float = 1e-9) -> Solution:
    """Solve a program.

    Args:
        program: See `program`.
        tolerance: Gap to reach, relative to the optimum or to the program's ``scale``.

    Raises:
        Infeasible: If no choice meets the limits.
        SolverFailed: If a solver fails.
    """
    # the solvers' tolerances are absolute: goals and limits of a small robot in parts of their size
    unit = program.unit(*program.goals)
    units = np.array([program.unit((1.0, term)) for _, term in program.limits])
    goals = tuple((weight, term.over(unit)) for weight, term in program.goals)
    limits = tuple(
        (limit / one, term.over(one))
        for (limit, term), one in zip(program.limits, units.tolist(), strict=True)
    )
    scaled = replace(program, goals=goals, limits=limits, scale=program.scale / unit)
    found = _solve(scaled, tolerance)
    return replace(
        found,
        value=unit * found.value,
        bound=unit * found.bound,
        prices=unit * found.prices,
        slopes=unit * found.slopes,
        limit_prices=unit / units * found.limit_prices,
    )


def _solve(program: Program, tolerance: float) -> Solution:
    enclosure = Enclosure(program)
    best: _Candidate | None = None
    proof: EnclosureSolution | None = None
    rounds, relaxed = 0, False
    while rounds < MAX_ROUNDS:
        rounds += 1
        trial = enclosure.solve()
        if trial is None:
            if relaxed:
                break
            rounds += _relax(enclosure)
            relaxed = True
            continue
        found = _candidate(program, trial.levers(program))
        if proof is None or trial.bound > proof.bound:
            proof = trial
        if best is None or found.rank < best.rank:
            best = found
        size = max(abs(proof.bound), program.scale)
        if best.excess <= FEASIBLE and best.value - proof.bound <= tolerance * size:
            break
        if not enclosure.extend(trial, max(0.1 * tolerance * size, RESOLVED)):
            break
    if best is None or proof is None or best.excess > ACCEPTED:
        raise SolverFailed("the limits could not be met within rounding")
    best = _without_rounding_error(program, best, 1e-9 * max(abs(proof.bound), program.scale))
    least = [v.cheapest(price) for v, price in zip(program.variables, proof.prices, strict=True)]
    slopes = [
        price[1] + 2 * at * price[2] for price, (at, _) in zip(proof.prices, least, strict=True)
    ]
    slack = -_excesses(program, best.state)
    return Solution(
        state=best.state,
        amounts=np.array([sum(amount for _, amount in places) for places in best.levers]),
        levers=best.levers,
        value=best.value,
        bound=proof.bound,
        prices=np.array([unit for _, unit in least]),
        slopes=np.array(slopes),
        limit_prices=np.where(slack <= REACHED, proof.limit_prices, 0.0),
        rounds=rounds,
    )


def _candidate(program: Program, levers: Levers) -> _Candidate:
    state = program.state(levers)
    excess = float(_excesses(program, state).max(initial=-np.inf))
    return _Candidate(levers, state, program.value(state), excess)


def _excesses(program: Program, state: Array) -> Array:
    """Return by how much each limit is exceeded, relative to itself (or to 1)."""
    return np.array(
        [(t.value(state) - limit) / max(1.0, abs(limit)) for limit, t in program.limits]
    )


def _relax(enclosure: Enclosure) -> int:
    """Raise limits that are out of reach by rounding alone; return the rounds this took.

    Raises:
        Infeasible: If they are out of reach by more.
    """
    for rounds in range(1, MAX_ROUNDS + 1):
        trial = enclosure.solve(elastic=True)
        if trial is None:
            raise Infeasible(np.inf)
        if trial.bound > FEASIBLE:
            raise Infeasible(trial.bound)
        if not enclosure.extend(trial, RESOLVED):
            if trial.excess > FEASIBLE:
                raise Infeasible(trial.excess)
            enclosure.relax(trial.excess + RESOLVED)
            return rounds
    raise SolverFailed("it could not be decided whether the limits can be met")


def _without_rounding_error(program: Program, best: _Candidate, slack: float) -> _Candidate:
    """Put amounts at the bounds they are near to, and shared amounts at one lever, if that does."""
    for number, variable in enumerate(program.variables):
        places = best.levers[number]
        amount = sum(a for _, a in places)
        near = [b for b in (variable.low, variable.high) if abs(amount - b) <= 1e-9 * variable.high]
        target = near[0] if near else amount
        mean = sum(v * a for v, a in places) / amount if amount > 0 else variable.span[0]
        single = [] if variable.has_lever and target <= 0 else [(mean, target)]
        if single != places:
            levers = [*best.levers[:number], single, *best.levers[number + 1 :]]
            tidy = _candidate(program, levers)
            if tidy.value <= best.value + slack and tidy.excess <= max(best.excess, FEASIBLE):
                best = tidy
    return best
