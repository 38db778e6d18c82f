"""Convex programmes by linear ones: HiGHS, rows and columns added until nothing is missing.

    minimize  sum_g weight_g F_g(s, z)   with  F_l(s, z) <= limit_l,  fixed . s = value,
    s = start + sum_i sum_(levers of i) amount * (e_i0 + e_i1 lever + e_i2 lever^2),
    low_i <= z_i = sum of the amounts of carrier i <= high_i.

A carrier with a span of levers may put its amount at any lever of the span, or share it out: the
programme has a column for every lever, infinitely many. Those that are missing are priced exactly,
as the price of a column is a parabola in the lever. Convex functions F are enclosed by rows
(see `pieces`), added where a trial solution breaks them.

Every round gives a bound from below that holds whatever the solver did: for any multipliers y of
the rows, the least of the Lagrangian over all amounts and levers is worked out in closed form. The
gap between it and the best solution found is the certificate.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from paminsa_viz.balancing.pieces import Piece
from paminsa_viz.model.arrays import Array

Levers = list[list[tuple[float, float]]]
"""For each carrier the levers in use with their amounts."""


@dataclass(frozen=True, eq=False)
class Variable:
    """Something whose amount can be chosen.

    Attributes:
        name: What it is.
        low, high: Bounds of the amount; 0 <= low <= high < infinity.
        effect: (3, d) what one unit adds to the state: effect[0] + effect[1] l + effect[2] l^2.
        span: Least and largest lever l.
    """

    name: str
    low: float
    high: float
    effect: Array
    span: tuple[float, float] = (0.0, 0.0)

    def column(self, lever: float) -> Array:
        """Return what one unit at a lever adds to the state, (d,)."""
        return self.effect[0] + lever * (self.effect[1] + lever * self.effect[2])

    def cheapest(self, prices: Array) -> tuple[float, float]:
        """Return the lever at which the parabola with coefficients (3,) is least, and its value."""
        first, second = self.span
        levers = [first, second] if second > first else [first]
        if second > first and prices[2] > 0:
            levers.append(float(np.clip(-0.5 * prices[1] / prices[2], first, second)))
        values = [prices[0] + lever * (prices[1] + lever * prices[2]) for lever in levers]
        best = int(np.argmin(values))
        return levers[best], values[best]


@dataclass(frozen=True, eq=False)
class Program:
    """See the module. ``scale`` is what the gap is measured by, beside the optimum itself."""

    start: Array
    carriers: tuple[Variable, ...]
    goals: tuple[tuple[float, Piece], ...]
    limits: tuple[tuple[float, Piece], ...] = ()
    fixed: tuple[tuple[Array, float], ...] = ()
    scale: float = 0.0

    @property
    def pieces(self) -> list[Piece]:
        """All pieces, goals first."""
        return [piece for _, piece in (*self.goals, *self.limits)]

    def box(self) -> tuple[Array, Array]:
        """Return a box that holds every state, (d,) each."""
        low, high = self.start.copy(), self.start.copy()
        for carrier in self.carriers:
            ends = [carrier.column(lever) for lever in carrier.span]
            with np.errstate(divide="ignore", invalid="ignore"):
                turn = -0.5 * carrier.effect[1] / carrier.effect[2]
            inside = (turn > carrier.span[0]) & (turn < carrier.span[1])
            t = np.where(inside, turn, carrier.span[0])
            ends.append(carrier.effect[0] + t * (carrier.effect[1] + t * carrier.effect[2]))
            least, most = np.min(ends, axis=0), np.max(ends, axis=0)
            low += np.minimum(carrier.low * least, carrier.high * least)
            high += np.maximum(carrier.low * most, carrier.high * most)
        return low, high


@dataclass(frozen=True, eq=False)
class Solution:
    """What a programme came to.

    Attributes:
        state: (d,) s.
        amounts: (carriers,) z.
        levers: For each carrier the levers in use with their amounts.
        value: The weighted sum of the goals.
        bound: No feasible choice has a smaller one.
        prices: (carriers,) change of the optimum for one more unit, at the best lever.
        slopes: (carriers,) derivatives of that price by the lever, where it is used.
        limit_prices: By limit, what the optimum falls by for a limit higher by one.
        rounds: Linear programmes solved.
    """

    state: Array
    amounts: Array
    levers: Levers
    value: float
    bound: float
    prices: Array
    slopes: Array
    limit_prices: Array
    rounds: int

    @property
    def gap(self) -> float:
        """By how much a better choice could be better at most."""
        return max(0.0, self.value - self.bound)


class Infeasible(Exception):
    """No choice meets all limits; ``excess`` is the least by which the worst is broken."""

    def __init__(self, excess: float) -> None:
        self.excess = excess
        super().__init__(f"limits are broken by {excess:.3g} at least")


def evaluate(program: Program, levers: Levers) -> tuple[Array, Array]:
    """Return state and amounts for levers with amounts."""
    state = program.start.copy()
    amounts = np.zeros(len(program.carriers))
    for number, (carrier, places) in enumerate(zip(program.carriers, levers, strict=True)):
        for lever, amount in places:
            state += amount * carrier.column(lever)
            amounts[number] += amount
    return state, amounts
