"""Convex programs in masses and in the places where they are put.

    minimize  sum_g weight_g F_g(s)   with  F_l(s) <= limit_l,
    s = start + sum_i sum_(levers of i) amount * (e_i0 + e_i1 lever + e_i2 lever^2),
    low_i <= sum of the amounts of variable i <= high_i.

A variable with a span of levers may put its amount at any lever of the span, or share it out. Its
effect depends on the amount m_0 and on the first and second moments m_1, m_2 of the levers alone,
and with levers scaled to u = -1..1 these can be exactly what satisfies m_1^2 <= m_0 m_2 and
m_2 <= m_0: one second-order cone, so that the program stays convex.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from paminsa_viz.balancing.convex import ConvexTerm
from paminsa_viz.errors import PaminsaError
from paminsa_viz.model.arrays import Array

Levers = list[list[tuple[float, float]]]
"""For each variable the levers in use with their amounts."""


@dataclass(frozen=True, eq=False)
class Variable:
    """An amount to choose, and for some also its lever.

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

    @property
    def has_lever(self) -> bool:
        """Whether there is a lever to choose."""
        return self.span[1] > self.span[0]

    def column(self, lever: float) -> Array:
        """Return what one unit at a lever adds to the state, (d,)."""
        return self.effect[0] + lever * (self.effect[1] + lever * self.effect[2])

    def moment_columns(self) -> Array:
        """Return what the moments of the scaled levers add to the state, (1 or 3, d)."""
        if not self.has_lever:
            return self.column(self.span[0])[None]
        middle, half = 0.5 * (self.span[0] + self.span[1]), 0.5 * (self.span[1] - self.span[0])
        slope = half * (self.effect[1] + 2.0 * middle * self.effect[2])
        return np.array([self.column(middle), slope, half**2 * self.effect[2]])

    def levers_of(self, moments: Array) -> list[tuple[float, float]]:
        """Return levers with amounts that have these moments; one or two of them.

        Moments that no levers have (m_1^2 > m_0 m_2) are taken as those of one lever.
        """
        amount = float(np.clip(moments[0], self.low, self.high))
        if not self.has_lever:
            return [(self.span[0], amount)]
        if amount <= 0:
            return []
        mean = float(moments[1]) / amount
        variance = min(float(moments[2]) / amount, 1.0) - mean**2
        places = [(mean, amount)]
        if variance > 0:
            # the part that is at the far end; the rest is at one other lever
            share = variance / (variance + (1.0 - mean) ** 2)
            places = [
                (mean - variance / (1.0 - mean), (1.0 - share) * amount),
                (1.0, share * amount),
            ]
        middle, half = 0.5 * (self.span[0] + self.span[1]), 0.5 * (self.span[1] - self.span[0])
        return [(float(np.clip(middle + half * u, *self.span)), a) for u, a in places if a > 0]

    def cheapest(self, prices: Array) -> tuple[float, float]:
        """Return the lever at which the parabola with coefficients (3,) is least, and its value."""
        first, last = self.span
        levers = [first, last] if self.has_lever else [first]
        if self.has_lever and prices[2] > 0:
            levers.append(float(np.clip(-0.5 * prices[1] / prices[2], first, last)))
        values = [prices[0] + lever * (prices[1] + lever * prices[2]) for lever in levers]
        best = int(np.argmin(values))
        return levers[best], values[best]


@dataclass(frozen=True, eq=False)
class Program:
    """See the module. ``scale`` is what the gap is measured by where the optimum is smaller."""

    start: Array
    variables: tuple[Variable, ...]
    goals: tuple[tuple[float, ConvexTerm], ...]
    limits: tuple[tuple[float, ConvexTerm], ...] = ()
    scale: float = 0.0

    def state(self, levers: Levers) -> Array:
        """Return the state (d,) for levers with amounts."""
        state = self.start.copy()
        for variable, places in zip(self.variables, levers, strict=True):
            for lever, amount in places:
                state += amount * variable.column(lever)
        return state

    def prices(self, gradient: Array) -> Array:
        """Return what a unit of a variable adds to gradient . s, by power of the lever, (n, 3)."""
        return np.array([v.effect @ gradient for v in self.variables]).reshape(-1, 3)

    def least(self, gradient: Array) -> float:
        """Return the least value of gradient . s over all choices, in closed form."""
        total = float(gradient @ self.start)
        for variable, price in zip(self.variables, self.prices(gradient), strict=True):
            _, unit = variable.cheapest(price)
            total += min(variable.low * unit, variable.high * unit)
        return total

    def unit(self, *terms: tuple[float, ConvexTerm]) -> float:
        """Return the unit of a weighted sum of terms, for tolerances that are absolute.

        It is 1, or less where the shares of all masses that may be there come to less: those of a
        small robot do. What is left where they cancel, as in a balanced robot, does not count.
        """
        most = abs(self.start)
        for variable in self.variables:
            shares = [abs(variable.column(lever)) for lever in variable.span]
            most = most + variable.high * np.maximum(*shares)
        size = sum(abs(weight) * term.most(most) for weight, term in terms)
        return size if 0.0 < size < 1.0 else 1.0

    def value(self, state: Array) -> float:
        """Return the weighted sum of the goals at a state."""
        return float(sum(weight * term.value(state) for weight, term in self.goals))


@dataclass(frozen=True, eq=False)
class Solution:
    """The solution of a program.

    Attributes:
        state: (d,) s.
        amounts: (variables,) their amounts.
        levers: For each variable the levers in use with their amounts.
        value: The weighted sum of the goals.
        bound: No feasible choice has a smaller one.
        prices: (variables,) change of the optimum for one more unit, at the best lever.
        slopes: (variables,) derivatives of that price by the lever, where it is used.
        limit_prices: By limit, what the optimum falls by for a limit higher by one.
        rounds: Linear or conic programs solved.
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


class Certified:
    """What has an objective, and a bound that no better choice is below.

    Attributes:
        objective: The value of what is minimized.
        lower_bound: No choice has a smaller one: the value of the dual program.
    """

    objective: float
    lower_bound: float

    @property
    def gap(self) -> float:
        """By how much a better choice could be better at most: the certificate."""
        return max(0.0, self.objective - self.lower_bound)


class Infeasible(Exception):
    """No choice meets all limits; ``excess`` is the least by which the worst is broken."""

    def __init__(self, excess: float) -> None:
        self.excess = excess
        super().__init__(f"limits are broken by {excess:.3g} at least")


class SolverFailed(PaminsaError):
    """A program that the linear solver could not finish; its numbers may differ too much in size.

    Attributes:
        reason: What went wrong, in words.
    """

    def __init__(self, reason: str) -> None:
        self.reason = reason
        super().__init__(f"no optimal masses could be computed: {reason}")
