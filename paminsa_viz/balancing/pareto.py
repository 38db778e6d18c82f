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

    def end(one: Term, other: Term) -> Optimum:
        """Return the distribution with the least of one term, and of such the least of the other.

        The values are those of the other, of the limits, and of the one.
        """
        alone = best(one)
        least = alone.objective
        return best(other, one, least + SLACK * max(abs(least), abs(alone.values[0].before)))

    def point(optimum: Optimum) -> ParetoPoint:
        # by their places: two terms may have one label, as of the same torque on two motions
        return ParetoPoint(optimum.values[0].after, optimum.values[-1].after, optimum)

    least, most = end(first, second), end(second, first)
    left, right = ParetoPoint(least.values[-1].after, least.values[0].after, least), point(most)
    before = (most.values[0].before, most.values[-1].before)
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
