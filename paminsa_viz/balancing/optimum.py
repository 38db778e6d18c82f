"""Optimal masses within bounds, with a certificate."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from paminsa_viz.balancing.changes import Changes, MassSpace, mass_space
from paminsa_viz.balancing.enclosure import FEASIBLE
from paminsa_viz.balancing.program import Certified, Infeasible, Program, Solution
from paminsa_viz.balancing.solver import solve
from paminsa_viz.balancing.terms import Term, deviations
from paminsa_viz.checks import require_positive
from paminsa_viz.errors import InvalidInput, PaminsaError
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.design import Design
from paminsa_viz.model.statics import BODIES
from paminsa_viz.units import format_ascii, rounded_to_side

WIDER = 100.0
"""How far bounds are widened to see which would have to move, at least [kg]."""

WIDER_TIMES = 10.0
"""The same over what joints and links of a leg weigh, for robots heavier than Appendix 4's."""

LARGEST = 1e12
"""Largest weight of a goal, and largest limit."""

ACTIVE = 1e-6
"""A bound counts as reached within this part of the range between the bounds."""


@dataclass(frozen=True)
class TermValue:
    """A term before and after.

    Attributes:
        label: What it is, in words.
        unit: Its SI unit.
        before, after: Its values.
        limit: What it was not to exceed; None for a goal.
    """

    label: str
    unit: str
    before: float
    after: float
    limit: float | None = None


@dataclass(frozen=True)
class ActiveConstraint:
    """A bound that the best distribution touches.

    Attributes:
        name: Path of the mass, name of the counterweight range, or label of the limited term.
        side: ``"low"``, ``"high"``, ``"nearest"``, ``"farthest"`` or ``"limit"``.
        bound: Its value.
        unit: Its unit.
        price: What the objective falls by for one unit of relaxation: the bound's multiplier. Where
            several bounds meet in one corner it is one of several possible ones.
    """

    name: str
    side: str
    bound: float
    unit: str
    price: float


@dataclass(frozen=True, eq=False)
class Optimum(Certified):
    """The best distribution.

    Attributes:
        before, after: The designs.
        values: Goals, then limits, before and after.
        objective: Weighted sum of the goals after the change.
        lower_bound: No distribution within the bounds has a smaller objective: the value of the
            dual problem, computed independently of the solver.
        active: Bounds that are reached, those that cost most first.
        rounds: Linear or conic programs solved.
        seconds: Time it took.
    """

    before: Design
    after: Design
    values: tuple[TermValue, ...]
    objective: float
    lower_bound: float
    active: tuple[ActiveConstraint, ...]
    rounds: int
    seconds: float


@dataclass(frozen=True)
class Shortfall:
    """A limit that cannot be met.

    Attributes:
        label: What is limited.
        unit: Its SI unit.
        limit: The requested limit.
        attainable: The least value within the bounds, the other limits met; with the other limits
            left out where they cannot be met either.
    """

    label: str
    unit: str
    limit: float
    attainable: float

    def text(self, name: str) -> str:
        """Return what is required and what is possible, with a name for the limit's label."""
        limit = format_ascii(self.limit, self.unit, 6)
        attainable = format_ascii(self.attainable, self.unit, 6, up=True)
        return f"{name} of at most {limit} is required; the least possible is {attainable}"


@dataclass(frozen=True)
class Relaxation:
    """A bound of a mass to move.

    Attributes:
        name: Path of the mass, or name of the counterweight range.
        side: ``"low"`` or ``"high"``.
        bound: The bound as it is [kg].
        needed: Where it would have to be [kg].
    """

    name: str
    side: str
    bound: float
    needed: float

    def text(self, name: str) -> str:
        """Return how to move the bound, with a name for its mass."""
        how = "raise the upper" if self.side == "high" else "lower the lower"
        needed = rounded_to_side(self.needed, 6, up=self.side == "high")
        return f"{how} bound of {name} from {self.bound:.6g} kg to {needed:.6g} kg"


class InfeasibleBounds(PaminsaError):
    """No masses within the bounds meet all limits.

    Attributes:
        limits: What cannot be met, and the least values instead.
        relax: The bounds whose least movement, added up over the robot, makes it possible; empty if
            none does that `WIDER` looks at.
    """

    def __init__(self, limits: tuple[Shortfall, ...], relax: tuple[Relaxation, ...]) -> None:
        self.limits = limits
        self.relax = relax
        super().__init__(f"the bounds do not allow it: {'; '.join(self.sentences())}")

    def sentences(self, name: Callable[[str], str] = str) -> list[str]:
        """Return what cannot be met, each of them, and what to move.

        Args:
            name: Gives what is said for a label or a path; what it is by default.
        """
        short = [item.text(name(item.label)) for item in self.limits]
        moves = [item.text(name(item.name)) for item in self.relax]
        none = f"bounds {WIDER:g} kg wider would not help: let other masses change"
        return [*short, *(moves or [none])]


@of_design
def optimize(
    design: Design,
    changes: Changes,
    goals: Term | Sequence[tuple[float, Term]],
    *,
    limits: Sequence[tuple[Term, float]] = (),
    tolerance: float = 1e-9,
) -> Optimum:
    """Find the distribution of masses that minimizes a term, or a weighted sum of terms.

    Args:
        design: The design to change.
        changes: What may change, within which bounds.
        goals: What to minimize: one term, or terms with weights [1/unit of the term].
        limits: Terms with their largest allowed values.
        tolerance: Gap to close, relative to the objective before or after; above 0.

    Raises:
        InfeasibleBounds: If no distribution within the bounds meets the limits.
        InvalidInput: If the tolerance, a weight or a limit is out of range, or a term does not fit
            the design.
        SolverFailed: If the solver fails.
    """
    require_positive(tolerance, "tolerance")
    began = time.perf_counter()
    weighted = list(goals) if isinstance(goals, Sequence) else [(1.0, goals)]
    for weight, term in weighted:
        if not 0 <= weight <= LARGEST:
            problem = f"a weight from 0 to {LARGEST:g} is needed, not {weight!r}"
            raise InvalidInput(term.label, problem)
    for term, limit in limits:
        if not abs(limit) <= LARGEST:
            problem = f"a limit of at most {LARGEST:g} is needed, not {limit!r}"
            raise InvalidInput(term.label, problem)
    space = mass_space(design, changes)
    functions = [(weight, term.convex_term(space)) for weight, term in weighted]
    bounded = [(float(limit), term.convex_term(space)) for term, limit in limits]
    now = sum(w * abs(function.value(space.before)) for w, function in functions)
    program = Program(space.start, space.variables, tuple(functions), tuple(bounded), scale=now)
    try:
        found = solve(program, tolerance=tolerance)
    except Infeasible:
        raise infeasible(space, program, [term for term, _ in limits]) from None
    named = [(term, None) for _, term in weighted] + list(limits)
    values = tuple(
        TermValue(term.label, term.unit, f.value(space.before), f.value(found.state), limit)
        for (term, limit), (_, f) in zip(named, functions + bounded, strict=True)
    )
    return Optimum(
        before=design,
        after=space.design_of(found.levers),
        values=values,
        objective=found.value,
        lower_bound=found.bound,
        active=active_bounds(space, found, limits),
        rounds=found.rounds,
        seconds=time.perf_counter() - began,
    )


def active_bounds(
    space: MassSpace, found: Solution, limits: Sequence[tuple[Term, float]] = ()
) -> tuple[ActiveConstraint, ...]:
    """Return the bounds that a solution touches, with their multipliers."""
    active = []
    for number, variable in enumerate(space.variables):
        name, amount, price = variable.name, found.amounts[number], float(found.prices[number])
        near = ACTIVE * max(variable.high - variable.low, 1e-12)
        if amount <= variable.low + near:
            active.append(ActiveConstraint(name, "low", variable.low, "kg", max(0.0, price)))
        if amount >= variable.high - near:
            active.append(ActiveConstraint(name, "high", variable.high, "kg", max(0.0, -price)))
        first, last = variable.span
        if last > first and amount > near:
            slope, close = float(found.slopes[number]), ACTIVE * (last - first)
            places = found.levers[number]
            for side, end, gain, mass in (
                ("nearest", first, slope, sum(a for v, a in places if v <= first + close)),
                ("farthest", last, -slope, sum(a for v, a in places if v >= last - close)),
            ):
                if mass > near:
                    active.append(ActiveConstraint(name, side, end, "m", max(0.0, mass * gain)))
    for (term, limit), price in zip(limits, found.limit_prices, strict=False):
        if price > 0:
            active.append(
                ActiveConstraint(term.label, "limit", float(limit), term.unit, float(price))
            )
    return tuple(sorted(active, key=lambda item: -item.price))


def infeasible(space: MassSpace, program: Program, limits: Sequence[Term]) -> InfeasibleBounds:
    """Return the error for a program whose limits cannot be met, with what would help."""
    short = []
    for number, (term, (limit, function)) in enumerate(zip(limits, program.limits, strict=True)):
        others = tuple(item for i, item in enumerate(program.limits) if i != number)
        now = abs(function.value(space.before))
        alone = replace(program, goals=((1.0, function),), limits=(), scale=now)
        try:
            least = solve(replace(alone, limits=others)).value
        except Infeasible:
            least = solve(alone).value
        short.append(Shortfall(term.label, term.unit, limit, least))
    # one that can be met is no reason beside others that cannot
    units = [program.unit((1.0, function)) for _, function in program.limits]
    missed = [
        item
        for item, unit in zip(short, units, strict=True)
        if item.attainable - item.limit > FEASIBLE * max(unit, abs(item.limit))
    ]
    return InfeasibleBounds(tuple(missed or short), movable_bounds(space, program))


def movable_bounds(space: MassSpace, program: Program) -> tuple[Relaxation, ...]:
    """Return the bounds whose least movement makes the limits of a program feasible, if any."""
    low = np.array([variable.low for variable in space.variables])
    high = np.array([variable.high for variable in space.variables])
    outside = deviations(space, low, high)
    wider = max(WIDER, WIDER_TIMES * sum(map(space.design.value, BODIES)))
    wide = tuple(replace(c, low=0.0, high=c.high + wider) for c in space.variables)
    widened = replace(program, variables=wide, goals=((1.0, outside),), scale=1.0)
    try:
        found = solve(widened, tolerance=1e-8)
    except Infeasible:
        return ()
    moved = []
    for variable, amount in zip(space.variables, map(float, found.amounts), strict=True):
        if amount > variable.high + 1e-9:
            moved.append(Relaxation(variable.name, "high", variable.high, amount))
        elif amount < variable.low - 1e-9:
            moved.append(Relaxation(variable.name, "low", variable.low, amount))
    return tuple(moved)
