"""The paper's static balance by redistribution of masses (Eqs. 7-8).

The static torques of M1..M3 are M_p2 times a map of the geometry, so that the whole workspace is
balanced, on both branches of the knee, by the one equation M_p2 = 0. It leaves a choice, which the
paper does not settle. Here it is the least added mass or the least mass moved: a linear program
with one equation.
"""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np

from paminsa_viz.balancing.changes import MOST, Changes, MassRange, MassSpace, mass_space
from paminsa_viz.balancing.convex import MaxAbs
from paminsa_viz.balancing.optimum import (
    ActiveConstraint,
    InfeasibleBounds,
    Optimum,
    Shortfall,
    TermValue,
    active_bounds,
    movable_bounds,
)
from paminsa_viz.balancing.program import Infeasible, Levers, Program, Solution, SolverFailed
from paminsa_viz.balancing.solver import solve
from paminsa_viz.balancing.terms import MP2, AddedMass, MassChange
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.design import Design
from paminsa_viz.model.statics import static_imbalance

MASSES_IN_MP2 = (
    "joints.j4", "joints.j7", "joints.j9", "links.b3", "links.b4", "links.b7", "links.b8",
)  # fmt: skip
"""Masses that stand in M_p2 (Appendix 2)."""

MOST_ADDED = 20.0
"""By how much each of them may grow by default, at least [kg]."""

MOST_TIMES = 8.0
"""The same over what they weigh together, for robots whose masses are larger than Appendix 4's."""


@of_design
def paper_changes(design: Design, most: float | None = None) -> Changes:
    """Return what the paper's balance may change: the masses in M_p2, each only upward.

    What is there can carry a weight; that it could be made lighter is not known. Moments of inertia
    stay, as a weight at a bar's middle adds none about it.

    Args:
        design: The design.
        most: By how much each mass may grow [kg]; default `MOST_ADDED`, or `MOST_TIMES` the sum of
            these masses of a leg if that is more.
    """
    held = {path: design.value(path) for path in MASSES_IN_MP2}
    if most is None:
        most = max(MOST_ADDED, MOST_TIMES * sum(held.values()))
    return Changes(
        tuple(MassRange(p, m, min(m + most, MOST), inertia_follows=False) for p, m in held.items())
    )


@of_design
def balance(
    design: Design,
    changes: Changes | None = None,
    criterion: AddedMass | MassChange | None = None,
    *,
    exact: bool = False,
) -> Optimum:
    """Balance a design statically over its whole workspace, on both branches of the knee.

    M_p2 becomes zero where the bounds allow it, to rounding; otherwise it comes as near to zero as
    they allow. Of all such distributions the one with the least ``criterion`` is returned.

    Args:
        design: The design to change.
        changes: What may change; default `paper_changes`.
        criterion: What is least among the balanced ones; default `AddedMass`.
        exact: Whether M_p2 = 0 is required.

    Raises:
        InfeasibleBounds: If M_p2 = 0 is required and the bounds do not allow it.
        SolverFailed: If rounding is larger than what is left of M_p2.
    """
    began = time.perf_counter()
    chosen = criterion or AddedMass()
    space = mass_space(design, paper_changes(design) if changes is None else changes)
    row = np.eye(1, len(space.start), MP2)[0]
    free = Program(space.start, space.variables, ())
    target = min(max(0.0, free.least(row)), -free.least(-row))
    function = chosen.convex_term(space)
    equal = MaxAbs(row[None], np.array([-target]))
    program = replace(free, goals=((1.0, function),), limits=((0.0, equal),), scale=1.0)
    if target != 0.0 and exact:
        wanted = replace(program, limits=((0.0, MaxAbs(row[None], np.zeros(1))),))
        short = Shortfall("|M_p2|", "N", 0.0, abs(target))
        raise InfeasibleBounds((short,), movable_bounds(space, wanted))
    try:
        found = solve(program)
    except Infeasible as error:
        # The target is what the bounds allow, so that only rounding can be in the way.
        raise SolverFailed("M_p2 cannot be brought to its least within rounding") from error
    levers = found.levers if target != 0.0 else _exact(space, found.levers)
    after = space.design_of(levers)
    return Optimum(
        before=design,
        after=after,
        values=(
            TermValue("M_p2", "N", static_imbalance(design), static_imbalance(after)),
            TermValue(
                chosen.label, chosen.unit,
                function.value(space.before), function.value(found.state),
            ),
        ),
        objective=found.value,
        lower_bound=found.bound,
        active=active_bounds(space, found) if target == 0.0 else _in_the_way(space, found, target),
        rounds=found.rounds,
        seconds=time.perf_counter() - began,
    )  # fmt: skip


def _in_the_way(space: MassSpace, found: Solution, target: float) -> tuple[ActiveConstraint, ...]:
    """Return the bounds that keep M_p2 from zero; their prices are in N of |M_p2| for a kg."""
    toward = -np.sign(target)
    active = []
    for variable, places in zip(space.variables, found.levers, strict=True):
        levers = [lever for lever, _ in places] or list(variable.span)
        effect = max((toward * variable.column(lever)[MP2] for lever in levers), key=abs)
        if effect != 0:
            side, bound = ("high", variable.high) if effect > 0 else ("low", variable.low)
            active.append(ActiveConstraint(variable.name, side, bound, "kg", float(abs(effect))))
    return tuple(sorted(active, key=lambda item: -item.price))


def _exact(space: MassSpace, levers: Levers) -> Levers:
    """Take the linear solver's rounding out of M_p2: move the mass that is free to move."""
    exact = [list(places) for places in levers]
    free: list[tuple[float, int, int]] = []
    for number, (variable, places) in enumerate(zip(space.variables, exact, strict=True)):
        if variable.low < sum(amount for _, amount in places) < variable.high:
            for index, (lever, _) in enumerate(places):
                share = variable.column(lever)[MP2]
                if share != 0:
                    free.append((share, number, index))
    if free:
        share, number, index = max(free, key=lambda item: abs(item[0]))
        for _ in range(3):
            lever, amount = exact[number][index]
            left = static_imbalance(space.design_of(exact))
            exact[number][index] = (lever, max(amount - left / share, 0.0))
    return exact
