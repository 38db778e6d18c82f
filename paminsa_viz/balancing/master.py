"""The linear programme behind a convex one, as far as it has been written down."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from paminsa_viz.balancing.errors import SolverFailed
from paminsa_viz.balancing.pieces import Rows, stacked
from paminsa_viz.balancing.program import Levers, Program, evaluate
from paminsa_viz.model.arrays import Array


@dataclass(eq=False)
class Trial:
    """One solved linear programme."""

    state: Array
    amounts: Array
    levers: Levers
    aux: list[Array]
    excess: float
    bound: float
    prices: Array  # (carriers, 3)
    limit_prices: Array


@dataclass(eq=False)
class Master:
    """The linear programme as far as it has been written down.

    Rows come first from the limits and the fixed sums, then from the pieces.
    """

    program: Program
    levers: list[list[float]] = field(default_factory=list)
    known: list[list[Rows]] = field(default_factory=list)

    def __post_init__(self) -> None:
        p = self.program
        for carrier in p.carriers:
            first, last = carrier.span
            spread = [first, 0.5 * (first + last), last] if last > first else [first]
            self.levers.append(spread)
        size, count = len(p.start), len(p.carriers)
        self.known = [[piece.first(size, count)] for piece in p.pieces]
        low, high = p.box()
        self.aux_bounds = [piece.bounds(low, high) for piece in p.pieces]
        self.sizes = [piece.aux for piece in p.pieces]
        self.offsets = np.concatenate([[0], np.cumsum(self.sizes)]).astype(int)
        self.limit_scale = np.array([max(1.0, abs(limit)) for limit, _ in p.limits])

    def _rows(self) -> tuple[Array, Array, Array, Array]:
        """Return all rows: on the state, on the amounts, on the auxiliary unknowns, right sides."""
        p = self.program
        count, size, total = len(p.carriers), len(p.start), int(self.offsets[-1])
        state, amounts, aux, rhs = [], [], [], []
        for number, (limit, _) in enumerate(p.limits):
            own = np.zeros((1, total))
            own[0, self.offsets[len(p.goals) + number]] = 1.0
            state.append(np.zeros((1, size)))
            amounts.append(np.zeros((1, count)))
            aux.append(own)
            rhs.append([limit])
        for row, value in p.fixed:
            state.append(np.array([row, -row]))
            amounts.append(np.zeros((2, count)))
            aux.append(np.zeros((2, total)))
            rhs.append([value, -value])
        for number, parts in enumerate(self.known):
            found = stacked(parts)
            own = np.zeros((len(found.rhs), total))
            own[:, self.offsets[number] : self.offsets[number + 1]] = found.own
            state.append(found.state)
            amounts.append(found.amounts)
            aux.append(own)
            rhs.append(found.rhs)
        return np.vstack(state), np.vstack(amounts), np.vstack(aux), np.concatenate(rhs)

    def solve(self, *, elastic: bool) -> Trial | None:
        """Solve it, or with ``elastic`` find the least excess over limits; None if it has none."""
        p = self.program
        state, amounts, aux, rhs = self._rows()
        rhs = rhs - state @ p.start
        hard = len(p.limits) + 2 * len(p.fixed)
        columns, owner = [], []
        for number, (carrier, levers) in enumerate(zip(p.carriers, self.levers, strict=True)):
            columns += [state @ carrier.column(v) + amounts[:, number] for v in levers]
            owner += [number] * len(levers)
        spread = [i for i, levers in enumerate(self.levers) if len(levers) > 1]
        share = np.equal.outer(spread, owner).astype(float).reshape(len(spread), len(owner))
        total = int(self.offsets[-1])
        excess = np.zeros((len(rhs), 1))
        excess[: len(p.limits), 0] = -self.limit_scale
        excess[len(p.limits) : hard, 0] = -1.0
        matrix = np.hstack([np.reshape(columns, (len(columns), len(rhs))).T, aux, excess])
        extra = np.hstack([share, np.zeros((len(spread), total + 1))])
        low = np.array([p.carriers[i].low for i in spread])
        high = np.array([p.carriers[i].high for i in spread])
        cost = np.zeros(matrix.shape[1])
        if elastic:
            cost[-1] = 1.0
        else:
            for (weight, _), place in zip(p.goals, self.offsets, strict=False):
                cost[len(owner) + place] += weight
        bounds: list[tuple[float, float]] = [
            (0.0, p.carriers[i].high) if i in spread else (p.carriers[i].low, p.carriers[i].high)
            for i in owner
        ]
        for limits, number in zip(self.aux_bounds, self.sizes, strict=True):
            bounds += [limits] * number
        bounds.append((0.0, np.inf if elastic else 0.0))
        found = _linprog(
            cost, np.vstack([matrix, extra, -extra]), np.concatenate([rhs, high, -low]), bounds
        )
        if found.status == 2:
            return None
        x = found.x
        y = np.minimum(found.ineqlin.marginals[: len(rhs)], 0.0)
        return self._trial(x, y, cost, owner, bounds, (state, amounts, matrix, rhs), elastic)

    def _trial(
        self, x: Array, y: Array, cost: Array, owner: list[int], bounds: list[Any],
        rows: tuple[Array, Array, Array, Array], elastic: bool,
    ) -> Trial:  # fmt: skip
        p = self.program
        state_rows, amount_rows, matrix, rhs = rows
        levers: Levers = [[] for _ in p.carriers]
        position = 0
        for number, (carrier, places) in enumerate(zip(p.carriers, self.levers, strict=True)):
            # what the solver leaves outside the bounds is its rounding
            least = carrier.low if len(places) == 1 else 0.0
            for lever in places:
                amount = min(max(float(x[position]), least), carrier.high)
                levers[number].append((lever, amount))
                position += 1
        # The Lagrangian's least value: carriers at their best lever, auxiliaries at a bound.
        on_state = y @ state_rows
        prices = np.array([-carrier.effect @ on_state for carrier in p.carriers]).reshape(-1, 3)
        prices[:, 0] -= y @ amount_rows
        bound = float(y @ rhs)
        for carrier, price in zip(p.carriers, prices, strict=True):
            _, least = carrier.cheapest(price)
            bound += min(carrier.low * least, carrier.high * least)
        rest = slice(len(owner), len(x) - 1)
        reduced = cost[rest] - y @ matrix[:, rest]
        ends = np.array(bounds[rest]).reshape(-1, 2)
        bound += float(np.minimum(reduced * ends[:, 0], reduced * ends[:, 1]).sum())
        if elastic:
            # the excess itself has no upper end; its price may be negative by rounding alone
            bound -= 1e-9
        state, amounts = evaluate(p, levers)
        aux = [
            x[len(owner) + a : len(owner) + b]
            for a, b in zip(self.offsets, self.offsets[1:], strict=False)
        ]
        return Trial(state, amounts, levers, aux, float(x[-1]), bound, prices, -y[: len(p.limits)])

    def extend(self, trial: Trial, slack: float) -> bool:
        """Add the rows that a trial breaks and the levers that would improve it; False if none."""
        added = False
        p = self.program
        for number, piece in enumerate(p.pieces):
            found = piece.cuts(trial.state, trial.amounts, trial.aux[number], slack)
            if len(found.rhs):
                self.known[number].append(found)
                added = True
        for number, (carrier, price) in enumerate(zip(p.carriers, trial.prices, strict=True)):
            places = self.levers[number]
            lever, value = carrier.cheapest(price)
            held = min(price[0] + v * (price[1] + v * price[2]) for v in places)
            if (held - value) * carrier.high > slack and lever not in places:
                places.append(lever)
                added = True
        return added


def _linprog(cost: Array, matrix: Array, rhs: Array, bounds: list[tuple[float, float]]) -> Any:
    """Call HiGHS with tight tolerances; status 2 is infeasible.

    Raises:
        SolverFailed: If it fails for another reason.
    """
    from scipy.optimize import linprog  # slow to load

    tight = {"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10}
    found: Any = None
    for method, options in (("highs", tight), ("highs-ds", {}), ("highs-ipm", {})):
        found = linprog(cost, matrix, rhs, bounds=bounds, method=method, options=options)
        if found.status in (0, 2):
            return found
    raise SolverFailed(str(found.message))
