"""Pareto fronts between two terms.

The terms are convex, so the least value of the first, as a function of what the second is held
below, is convex, and falls strictly between the two ends of the front. There the limit is always
used up; so a series of convex programs, one a limit, gives points none of which is dominated.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from paminsa_viz.balancing.changes import Changes
from paminsa_viz.balancing.optimum import Optimum, optimize
from paminsa_viz.balancing.terms import Term
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.design import Design
from paminsa_viz.progress import Progress, go_on

SLACK = 1e-9
"""What the ends of a front give up of the one term for the other, relative to the one."""


@dataclass(frozen=True, eq=False)
class ParetoPoint:
    """One distribution of a front.

    Attributes:
        first, second: The values of the two terms [their units].
        optimum: The optimum behind it, with the design and the proof.
    """

    first: float
    second: float
    optimum: Optimum

    @property
    def design(self) -> Design:
        """The design."""
        return self.optimum.after


@dataclass(frozen=True, eq=False)
class ParetoFront:
    """A front: ``first`` rises and ``second`` falls from point to point.

    Attributes:
        labels: What the two are.
        units: Their units.
        points: The distributions; a single one if both terms are least together.
        before: The two values of the design as it was.
    """

    labels: tuple[str, str]
    units: tuple[str, str]
    points: tuple[ParetoPoint, ...]
    before: tuple[float, float]


@of_design
def pareto_front(
    design: Design,
    changes: Changes,
    first: Term,
    second: Term,
    *,
    points: int = 12,
    limits: Sequence[tuple[Term, float]] = (),
    progress: Progress = go_on,
) -> ParetoFront:
    """Return the front between two terms.

    For a third, such as `AddedMass`, hold it below one of several levels in ``limits``, a front
    each.

    Args:
        design: The design to change.
        changes: What may change.
        first, second: The terms, for example `TrajectoryPeak` and `StaticPeak`.
        points: Number of points, at least two.
        limits: Terms with their largest allowed values, for all points.
        progress: Called before each point; true ends it with those found.

    Raises:
        InfeasibleBounds: If no distribution meets the limits.
        InvalidInput: If there are fewer than two points.
    """
    if points < 2:
        raise InvalidInput("points", f"a front has at least two points, not {points}")

    def best(goal: Term, held: Term | None = None, below: float = 0.0) -> Optimum:
        extra = [] if held is None else [(held, below)]
        return optimize(design, changes, goal, limits=[*limits, *extra])

    def point(optimum: Optimum) -> ParetoPoint:
        after = {value.label: value.after for value in optimum.values}
        return ParetoPoint(after[first.label], after[second.label], optimum)

    ends = []
    for one, other in ((first, second), (second, first)):
        alone = best(one)
        least = alone.objective
        ends.append(best(other, one, least + SLACK * max(abs(least), abs(alone.values[0].before))))
    left, right = (point(end) for end in ends)
    start = {value.label: value.before for value in ends[0].values}
    before = (start[first.label], start[second.label])
    found = [left]
    small = 1e-6 * max(abs(before[1]), abs(left.second))
    if left.second - right.second > small:
        levels = np.linspace(left.second, right.second, points)[1:-1]
        for number, level in enumerate(levels, 2):
            if progress(number / points):
                break
            found.append(point(best(first, second, float(level))))
        else:
            found.append(right)
    progress(1.0)
    labels, units = (first.label, second.label), (first.unit, second.unit)
    return ParetoFront(labels, units, tuple(found), before)
