"""Best masses, counterweights and springs of a robot of given lengths, with their certificate.

Torques are linear in masses, in stiffnesses K and in K L (`space`). So peak torque and energy
of motions, moving mass, and bounds on torques at rest make one convex program, which is solved to
its global optimum; the value of the dual program bounds it from below independently of the solver.
The outer search solves it for each set of lengths that it tries.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from paminsa_viz.balancing import ActiveConstraint, Spring, spring_torques
from paminsa_viz.balancing.convex import ConvexTerm
from paminsa_viz.balancing.optimum import Relaxation as MassRelaxation
from paminsa_viz.balancing.optimum import active_bounds, movable_bounds
from paminsa_viz.balancing.program import Certified, Infeasible, Program, Solution
from paminsa_viz.balancing.solver import solve
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.statics import static_torques
from paminsa_viz.synthesis.masses.case import InnerCase, MotionRows, find_goal, peak_term
from paminsa_viz.synthesis.masses.space import (
    InnerInfeasible,
    InnerLimit,
    InnerSpace,
    inner_space,
    limits_at_rest,
    motion_rows,
    sampled_solution,
)
from paminsa_viz.synthesis.volume.conflict import irreducible_set


@dataclass(frozen=True, eq=False)
class InnerSolution(Certified):
    """The best masses and springs of a robot of given lengths.

    Attributes:
        design: The robot with these masses and counterweights.
        springs: Its springs, one a place; they are no part of the design.
        goal: Key of what was minimized; empty for what is none of `case.GOALS`.
        objective: Its value [SI].
        lower_bound: No masses and springs within the bounds have a smaller one: the value of the
            dual program.
        active: Bounds that are reached, with their shadow prices, the highest first.
        rounds: Linear programs solved.
        seconds: Time it took.
    """

    design: Design
    springs: tuple[Spring, ...]
    goal: str
    objective: float
    lower_bound: float
    active: tuple[ActiveConstraint, ...]
    rounds: int
    seconds: float
    program: InnerProgram = field(repr=False)
    solution: Solution = field(repr=False)

    def value(self, key: str) -> float:
        """Return the value of a goal, which need not be the one that was minimized [SI].

        Raises:
            InvalidInput: If there is no such goal, or it needs motions and there are none.
        """
        if key == self.goal:
            return self.objective
        program = self.program
        goal = find_goal(key, free=program.case.free, motions=len(program.motions))
        return goal.term(program.space, program.motions).value(self.solution.state)

    def held(self, pose: Array) -> Array:
        """Return static torques with the springs, (..., 4) [N m, N]."""
        torque = static_torques(self.design, pose)
        if self.springs:
            torque += spring_torques(self.design.geometry, self.springs, pose)
        return torque


@dataclass(frozen=True, eq=False)
class InnerProgram:
    """The program of a case for one set of lengths.

    Attributes:
        case: The case.
        space: Masses and springs as states.
        goal: What to minimize.
        limits: What to keep.
        motions: The motions with their torques as functions of the state.
        key: Key of the goal; empty for what is none of `case.GOALS`.
    """

    case: InnerCase
    space: InnerSpace
    goal: ConvexTerm
    limits: tuple[InnerLimit, ...]
    motions: tuple[MotionRows, ...]
    key: str

    def solve(
        self, limits: Sequence[InnerLimit] | None = None, tolerance: float = 1e-9
    ) -> InnerSolution:
        """Solve it, with all limits or with those that are given.

        Raises:
            InnerInfeasible: If nothing within the bounds keeps the limits.
            SolverFailed: If a solver fails.
        """
        began = time.perf_counter()
        kept = self.limits if limits is None else tuple(limits)
        bounded = tuple((item.limit, item.term) for item in kept)
        scale = abs(self.goal.value(self.space.before))
        program = Program(
            self.space.start, self.space.variables, ((1.0, self.goal),), bounded, scale=scale
        )
        try:
            found = solve(program, tolerance=tolerance)
        except Infeasible as error:
            names = ", ".join(dict.fromkeys(item.label for item in kept))
            reason = f"no masses or springs within their bounds keep the limits on {names}"
            raise InnerInfeasible(error.excess, reason) from None
        return InnerSolution(
            self.space.design_of(found.levers), self.space.springs_of(found.state),
            self.key, found.value, found.bound, self._active(found, kept), found.rounds,
            time.perf_counter() - began, self, found,
        )  # fmt: skip

    def _active(
        self, found: Solution, limits: Sequence[InnerLimit]
    ) -> tuple[ActiveConstraint, ...]:
        """Return the bounds that a solution touches, those of springs in their own unit."""
        stiffness = {v.name for v in self.space.variables[len(self.space.counts) :]}
        bounds = [
            replace(item, unit="N/m") if item.name in stiffness and item.unit == "kg" else item
            for item in active_bounds(self.space, found)
        ]
        for item, price in zip(limits, found.limit_prices.tolist(), strict=True):
            if price > 0:
                bounds.append(ActiveConstraint(item.label, item.side, item.bound, item.unit, price))
        return tuple(sorted(bounds, key=lambda item: -item.price))


def inner_program(design: Design, case: InnerCase, pose: Array) -> InnerProgram:
    """Return the program of a case for a robot's lengths.

    Args:
        design: The robot; what is not free stays as it is.
        case: The case.
        pose: (n, 4) poses at which bounds at rest count, those of each bound within its own
            headings and heights [m, m, rad, m].

    Raises:
        InnerInfeasible: If a pose or a motion is out of reach.
        InvalidInput: If a mass is not one of the design's.
    """
    space = inner_space(design, case.changes(design), case.springs)
    motions: list[MotionRows] = []
    for trajectory in case.motions:
        motion = sampled_solution(design.geometry, trajectory, design.gravity)
        if motion.check.first is not None:
            raise InnerInfeasible(np.inf, f"the motion fails {motion.check.first.explanation}")
        motions.append((motion, *motion_rows(space, motion)))
    goal = find_goal(case.goal, free=case.free, motions=len(motions)).term(space, motions)
    limits = [item for bound in case.bounds for item in limits_at_rest(space, bound, pose)]
    for name, limit, actuators, unit in (
        ("torque of M1-M3 on the motions", case.motion_torque, (0, 1, 2), "N m"),
        ("force of M4 on the motions", case.motion_force, (3,), "N"),
    ):
        if limit is not None:
            term = peak_term(motions, actuators)
            limits.append(InnerLimit(name, unit, "high", limit, None, term))
    for key, most in case.most:
        other = find_goal(key, free=case.free, motions=len(motions))
        term = other.term(space, motions)
        limits.append(InnerLimit(other.label, other.unit, "high", most, None, term))
    return InnerProgram(case, space, goal, tuple(limits), tuple(motions), case.goal)


def solve_inner(
    design: Design, case: InnerCase, pose: Array, *, tolerance: float = 1e-9
) -> InnerSolution:
    """Return the best masses and springs; arguments as in `inner_program`.

    Args:
        design, case, pose: As in `inner_program`.
        tolerance: Gap to close, relative to the goal before or after; 1e-4 is enough in a search.

    Raises:
        InnerInfeasible: If a pose or a motion is out of reach, or nothing within the bounds keeps
            the limits.
        InvalidInput: If a mass is not one of the design's.
        SolverFailed: If a solver fails.
    """
    return inner_program(design, case, pose).solve(tolerance=tolerance)


FEW = 8
"""Limits up to which all sets are tried, the smallest first."""


@dataclass(frozen=True)
class NearestBound:
    """The nearest bound of a limit at which all can be met, the others unchanged.

    Attributes:
        limit: The limit.
        bound: Its nearest bound [SI]; None if no bound helps, as the others contradict already.
        gap: By how much a nearer one could do at most [SI].
    """

    limit: InnerLimit
    bound: float | None
    gap: float


@dataclass(frozen=True)
class InnerContradiction:
    """Limits that no masses and springs within their bounds meet together.

    Attributes:
        limits: The fewest that contradict (by the deletion filter for more than `FEW`).
        relax: For each of them the nearest bound, all other limits of the case kept.
        masses: The bounds of masses whose least movement makes all limits feasible; none if no
            masses help, or there are springs.
    """

    limits: tuple[InnerLimit, ...]
    relax: tuple[NearestBound, ...]
    masses: tuple[MassRelaxation, ...]


def inner_contradiction(program: InnerProgram) -> InnerContradiction | None:
    """Return which limits contradict and what would help; None if all can be met.

    Exact: each answer is the optimum of a convex program with its certificate.

    Args:
        program: Masses and springs of a robot of given lengths.

    Raises:
        SolverFailed: If a solver fails.
    """

    def feasible(limits: tuple[InnerLimit, ...]) -> bool:
        return _least(program, None, limits) is not None

    found = irreducible_set(program.limits, feasible, FEW)
    if not found:
        return None
    relax = []
    for item in found:
        others = tuple(other for other in program.limits if other is not item)
        least = _least(program, item, others)
        nearest, gap = (None, 0.0) if least is None else least
        if nearest is not None and item.side == "low":
            nearest = -nearest
        relax.append(NearestBound(item, nearest, gap))
    space, masses = program.space, ()
    if not space.springs:
        bounded = tuple((item.limit, item.term) for item in program.limits)
        masses = movable_bounds(space, Program(space.start, space.variables, (), bounded))
    return InnerContradiction(found, tuple(relax), masses)


def _least(
    program: InnerProgram, goal: InnerLimit | None, limits: Sequence[InnerLimit]
) -> tuple[float, float] | None:
    """Return the least value of a limit's function (or zero) with its gap; None if infeasible."""
    term = program.goal if goal is None else goal.term
    try:
        found = replace(program, goal=term, key="").solve(
            limits, tolerance=1e-6 if goal is None else 1e-9
        )
    except InnerInfeasible:
        return None
    return found.objective, found.gap
