"""Limits of masses and springs that contradict, and the nearest bounds that do not: exact."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from paminsa_viz.balancing.optimum import Relaxation as MassRelaxation
from paminsa_viz.balancing.optimum import movable_bounds
from paminsa_viz.balancing.program import Program
from paminsa_viz.synthesis.masses.program import InnerProgram
from paminsa_viz.synthesis.masses.space import InnerInfeasible, InnerLimit
from paminsa_viz.synthesis.volume.conflict import irreducible_set, smallest_set

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

    find = smallest_set if len(program.limits) <= FEW else irreducible_set
    found = find(program.limits, feasible)
    if not found:
        return None
    relax = []
    for item in found:
        others = tuple(other for other in program.limits if other is not item)
        least = _least(program, item, others)
        sign = -1.0 if item.side == "low" else 1.0
        relax.append(
            NearestBound(item, None, 0.0)
            if least is None
            else NearestBound(item, sign * least[0], least[1])
        )
    return InnerContradiction(found, tuple(relax), _masses(program))


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


def _masses(program: InnerProgram) -> tuple[MassRelaxation, ...]:
    space = program.space
    if space.springs:
        return ()
    bounded = tuple((item.limit, item.term) for item in program.limits)
    return movable_bounds(space, Program(space.start, space.variables, (), bounded))
