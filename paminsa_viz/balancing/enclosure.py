"""The linear or conic program that encloses a convex one, and the bound that it proves.

All levers and all terms are enclosed from outside, so that every optimum is a bound from below, and
its solution shows which cuts are missing. The bound that is returned does not trust the solver: for
any multipliers y of the cuts the least of the Lagrangian over all amounts and levers is worked out
in closed form.
"""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from paminsa_viz.balancing.backends import ConicProgram, solve_conic, solve_linear
from paminsa_viz.balancing.convex import ConvexTerm, Cuts, Norm
from paminsa_viz.balancing.program import Levers, Program
from paminsa_viz.model.arrays import Array

FEASIBLE = 1e-9
"""By how much of itself (or of 1) a limit may be broken."""

RESOLVED = 2e-10
"""What the solvers' own tolerances leave open in a row."""

TANGENTS = (-1.0, 0.0, 1.0)
"""Scaled levers at which a linear program encloses the moments of levers from the start."""


class EnclosureSolution(NamedTuple):
    """The solution of an enclosure.

    Attributes:
        moments: Those of each variable's levers, (1) or (3).
        state: (d,) the state that they make.
        parts: What the cuts hold the parts of all terms above.
        excess: By how much limits are broken.
        bound: What the multipliers prove.
        prices: (variables, 3) what a unit changes the Lagrangian by, by powers of the lever.
        limit_prices: (limits,) their multipliers.
    """

    moments: list[Array]
    state: Array
    parts: Array
    excess: float
    bound: float
    prices: Array
    limit_prices: Array

    def levers(self, program: Program) -> Levers:
        """Return levers that have the moments."""
        pairs = zip(program.variables, self.moments, strict=True)
        return [variable.levers_of(moments) for variable, moments in pairs]


class Enclosure:
    """A program's enclosure, with the cuts so far.

    Its unknowns are the moments of the variables, then one for each part of every term, which the
    cuts hold above that part, then the excess over the limits.
    """

    def __init__(self, program: Program) -> None:
        p = self.program = program
        self.terms: list[ConvexTerm] = [term for _, term in (*p.goals, *p.limits)]
        columns = [variable.moment_columns() for variable in p.variables]
        self.effect = np.vstack([np.empty((0, len(p.start))), *columns]).T
        self.count = self.effect.shape[1]
        self.moments = _slices([len(c) for c in columns])
        self.parts = _slices([term.parts for term in self.terms])
        self.part_count = sum(term.parts for term in self.terms)
        self.norms = [i for i, term in enumerate(self.terms) if isinstance(term, Norm)]
        self.limits = np.array([limit for limit, _ in p.limits], float)
        self.limit_scale = np.maximum(1.0, np.abs(self.limits))
        self.cuts = [Cuts(np.empty(0, np.intp), np.empty((0, len(p.start))), np.empty(0))]
        levered = [i for i, variable in enumerate(p.variables) if variable.has_lever]
        self.tangents = [(i, u) for i in levered for u in TANGENTS]
        for share in (0.0, 0.5, 1.0):
            levers = [[(0.5 * sum(v.span), v.low + share * (v.high - v.low))] for v in p.variables]
            self._cut(p.state(levers), np.full(self.part_count, -np.inf), 0.0)

    def relax(self, excess: float) -> None:
        """Raise the limits."""
        self.limits = self.limits + excess * self.limit_scale

    def extend(self, trial: EnclosureSolution, slack: float) -> bool:
        """Add what a trial breaks by more than ``slack``; False if that is nothing."""
        added = self._cut(trial.state, trial.parts, slack)
        for number, moments in enumerate(trial.moments):
            if not self.norms and len(moments) == 3 and moments[0] > 0:
                u = float(np.clip(moments[1] / moments[0], -1.0, 1.0))
                excess = 2.0 * u * moments[1] - u**2 * moments[0] - moments[2]
                if excess > RESOLVED and (number, u) not in self.tangents:
                    self.tangents.append((number, u))
                    added = True
        return added

    def _cut(self, state: Array, known: Array, slack: float) -> bool:
        added = False
        # a limit has to be met more closely than a goal has to be known
        goals = len(self.program.goals)
        allowed = [slack] * goals + [min(slack, 0.5 * FEASIBLE * s) for s in self.limit_scale]
        for term, place, most in zip(self.terms, self.parts, allowed, strict=True):
            found = term.cuts(state, known[place], most)
            if len(found.part):
                self.cuts.append(found._replace(part=found.part + place.start))
                added = True
        return added

    def solve(self, *, elastic: bool = False) -> EnclosureSolution | None:
        """Solve it, or with ``elastic`` find the least excess over limits; None if it has none."""
        p, n = self.program, self.count
        cuts = Cuts(*(np.concatenate(column) for column in zip(*self.cuts, strict=True)))
        found = (solve_conic if self.norms else solve_linear)(self._assembled(cuts, elastic))
        if found is None:
            return None
        weights = found.multipliers[: len(cuts.part)]
        for number, u in zip(self.norms, found.cone_multipliers, strict=False):
            # the norm is the largest of all u . v with |u| = 1
            cone, size = self.terms[number], float(np.linalg.norm(u))
            if isinstance(cone, Norm) and size > 0:
                cuts = Cuts(
                    np.append(cuts.part, self.parts[number].start),
                    np.vstack([cuts.matrix, u @ cone.matrix / size]),
                    np.append(cuts.offset, u @ cone.offset / size),
                )
                weights = np.append(weights, size)
        bound, prices, limit_prices = self.lagrangian(cuts, weights, elastic)
        x = found.x
        return EnclosureSolution(
            [x[place] for place in self.moments], p.start + self.effect @ x[:n], x[n:-1],
            float(x[-1]), bound, prices, limit_prices,
        )  # fmt: skip

    def _assembled(self, cuts: Cuts, elastic: bool) -> ConicProgram:
        p, n = self.program, self.count
        size = n + self.part_count + 1
        cost, low, high = np.zeros(size), np.full(size, -np.inf), np.full(size, np.inf)
        for variable, place in zip(p.variables, self.moments, strict=True):
            low[place.start], high[place.start] = variable.low, variable.high
        for term, place in zip(self.terms, self.parts, strict=True):
            low[n + place.start : n + place.stop] = 0.0 if term.nonnegative else -np.inf
        low[-1], high[-1] = 0.0, np.inf if elastic else 0.0
        cost[-1] = 1.0 if elastic else 0.0
        for (weight, _), place in zip(p.goals, self.parts, strict=False):
            cost[n + place.start : n + place.stop] = 0.0 if elastic else weight

        enclosing = np.zeros((len(cuts.part), size))
        enclosing[:, :n] = cuts.matrix @ self.effect
        enclosing[np.arange(len(cuts.part)), n + cuts.part] = -1.0
        rows, right = [enclosing], [-cuts.offset - cuts.matrix @ p.start]
        limits = zip(self.limits, self.limit_scale, self.parts[len(p.goals) :], strict=True)
        for limit, scale, place in limits:
            if place.stop - place.start == 1 and not elastic:
                low[n + place.start] = high[n + place.start] = limit
                continue
            row = np.zeros((1, size))
            row[0, n + place.start : n + place.stop], row[0, -1] = 1.0, -scale
            rows.append(row)
            right.append(np.array([limit]))
        for variable, place in zip(p.variables, self.moments, strict=True):
            if variable.has_lever:
                rows.append(_row(size, place, (-1.0, 0.0, 1.0)))
        if not self.norms:
            rows += [
                _row(size, self.moments[i], (-(u**2), 2.0 * u, -1.0)) for i, u in self.tangents
            ]
        matrix = np.vstack(rows)
        sides = np.concatenate([*right, np.zeros(len(matrix) - sum(map(len, right)))])
        return ConicProgram(cost, matrix, sides, low, high, self._cones(size))

    def _cones(self, size: int) -> list[tuple[Array, Array]]:
        """Return the cones of the norms, then those of the levers' moments."""
        cones = []
        for number in self.norms:
            term = self.terms[number]
            if isinstance(term, Norm):
                rows = np.zeros((1 + len(term.offset), size))
                rows[0, self.count + self.parts[number].start] = -1.0
                rows[1:, : self.count] = -term.matrix @ self.effect
                right = np.append(0.0, term.offset + term.matrix @ self.program.start)
                cones.append((rows, right))
        for variable, place in zip(self.program.variables, self.moments, strict=True):
            if variable.has_lever and self.norms:
                coefficients = ((-1.0, 0.0, -1.0), (-1.0, 0.0, 1.0), (0.0, -2.0, 0.0))
                rows = np.vstack([_row(size, place, c) for c in coefficients])
                cones.append((rows, np.zeros(3)))
        return cones

    def lagrangian(self, cuts: Cuts, weights: Array, elastic: bool) -> tuple[float, Array, Array]:
        """Return the Lagrangian's least value, and the prices of variables and of limits.

        What the cuts of a part weigh together may not exceed the weight of its term: then their sum
        is nowhere above the term.
        """
        p = self.program
        weights = self._canceled(cuts, np.maximum(weights, 0.0))
        total = np.bincount(cuts.part, weights, self.part_count)
        factor, limit_prices = np.ones(self.part_count), np.empty(len(p.limits))
        for number, (term, place) in enumerate(zip(self.terms, self.parts, strict=True)):
            if number >= len(p.goals):
                limit_prices[number - len(p.goals)] = total[place].max(initial=0.0)
                continue
            weight = 0.0 if elastic else p.goals[number][0]
            for part in range(place.start, place.stop):
                if total[part] > weight or (total[part] > 0 and not term.nonnegative):
                    factor[part] = weight / total[part]
        weights = weights * factor[cuts.part]
        gradient = weights @ cuts.matrix
        bound = float(weights @ cuts.offset - limit_prices @ self.limits) + p.least(gradient)
        if elastic:
            # multipliers of an excess of 1 for every limit add up to 1
            bound /= max(float(limit_prices @ self.limit_scale), 1e-300)
        return bound, p.prices(gradient), limit_prices

    def _canceled(self, cuts: Cuts, weights: Array) -> Array:
        """Return weights of which opposite cuts of a limit of zero, f <= 0 and -f <= 0, share none.

        Both are reached there. What they have in common changes nothing but the limit's price.
        """
        weights = weights.copy()
        for limit, place in zip(self.limits, self.parts[len(self.program.goals) :], strict=True):
            if abs(limit) > FEASIBLE or place.stop - place.start != 1:
                continue
            mine = np.flatnonzero((cuts.part == place.start) & (weights > 0))
            rows = np.column_stack([cuts.matrix, cuts.offset])
            for i in mine:
                for j in mine[(rows[mine] == -rows[i]).all(axis=1)]:
                    weights[[i, j]] -= min(weights[i], weights[j])
        return weights


def _slices(sizes: list[int]) -> list[slice]:
    ends = np.cumsum([0, *sizes]).tolist()
    return [slice(a, b) for a, b in pairwise(ends)]


def _row(size: int, place: slice, coefficients: tuple[float, float, float]) -> Array:
    row = np.zeros((1, size))
    row[0, place] = coefficients
    return row
