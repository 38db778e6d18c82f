"""Several objectives at once: robots of which none is better than another in all of them.

The first objective is minimized under limits on the others, between what each can be at best and
what it is where another is best. So every point is the answer of a search, verified as such, and
points on a part of the front that is not convex are found as well. The later searches start near
the answers of the earlier ones.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from typing import Any

import numpy as np

from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arrays import Array
from paminsa_viz.progress import Progress, go_on
from paminsa_viz.studies.executors import Workers, here
from paminsa_viz.synthesis.search.case import UNLIMITED, ObjectiveLimit, SynthesisCase
from paminsa_viz.synthesis.search.objectives import find_objective
from paminsa_viz.synthesis.search.outer import RegimeState, cloud, numbers_of
from paminsa_viz.synthesis.search.result import SynthesisResult
from paminsa_viz.synthesis.search.solve import synthesize

MOST_POINTS = 200
"""Most searches of a front."""

SLACK = 2e-3
"""What a point gives up of a limited objective, relative: with none a search has no room."""

OTHERS = 0.8
"""Share of the first trials of a later search that are anywhere in the ranges."""

SAME = 1e-3
"""Points closer than this in all objectives, relative to the front's extent, are one."""


@dataclass(frozen=True, eq=False)
class FrontPoint:
    """A robot of a front.

    Attributes:
        values: Its objectives, in the order of the front's [SI].
        result: The answer of its search.
    """

    values: tuple[float, ...]
    result: SynthesisResult


@dataclass(frozen=True, eq=False)
class DesignFront:
    """Robots of which none is better than another in all objectives.

    Attributes:
        objectives: Keys of the objectives.
        points: The robots, by the first objective.
        dominated: Answers that were left out, as another is as good in all objectives and better
            in one.
        searches: Searches made.
        failed: Those of them that found no robot within their limits.
        canceled: Whether the progress function ended it; the points are those found so far.
    """

    objectives: tuple[str, ...]
    points: tuple[FrontPoint, ...]
    dominated: int
    searches: int
    failed: int
    canceled: bool


def nondominated(values: Array) -> list[int]:
    """Return the rows (n, m) than which no other is at least as good in all columns, and better in
    one; of equal rows the first."""
    kept = []
    for index, row in enumerate(values):
        no_worse = (values <= row).all(axis=1)
        better = no_worse & (values < row).any(axis=1)
        equal = no_worse & ~better
        if not better.any() and int(np.argmax(equal)) == index:
            kept.append(index)
    return kept


def design_front(
    case: SynthesisCase,
    objectives: Sequence[str],
    *,
    points: int,
    workers: Workers = here,
    progress: Progress = go_on,
) -> DesignFront:
    """Return the front of a case between several objectives.

    Args:
        case: The case; its own objective does not count, its limits do.
        objectives: Keys of at least two objectives.
        points: Levels of each objective but the first, the ends included: so many points for two
            objectives, by one search more.
        workers: Where trials are computed; the result is the same.
        progress: Called after each generation with the number of ``searches`` done and the
            ``state`` of the current one; true ends it with the points found so far.

    Raises:
        InvalidInput: If there are fewer than two different objectives or points, or too many.
    """
    names = tuple(objectives)
    entries = [find_objective(name) for name in names]
    if len(names) < 2 or len(set(names)) < len(names):
        raise InvalidInput("objectives", "at least two different ones are needed")
    grid = max(0, points) ** (len(names) - 1)
    total = points + 1 if len(names) == 2 else len(names) + grid
    if points < 2 or total > MOST_POINTS:
        problem = f"2 or more, for up to {MOST_POINTS} searches in all, are possible, not {points}"
        raise InvalidInput("points", problem)
    signs = np.array([entry.sign for entry in entries])
    run = _Front(case, names, signs, total, workers, progress)
    # What is best in another objective alone may be bad in the first for nothing: such an answer
    # is no point of the front, it only says how far the front reaches.
    for name in names:
        run.search(name, {})
        if run.canceled or not run.answers:
            return run.front()
    table = signs * np.array([point.values for point in run.answers])
    best, worst = table.min(axis=0), table.max(axis=0)
    levels = [np.linspace(low, high, points) for low, high in zip(best[1:], worst[1:], strict=True)]
    for chosen in product(*levels):
        if len(names) == 2 and chosen[0] == worst[1]:  # the answer of the first search
            continue
        room = SLACK * np.maximum(worst - best, 1e-12)[1:]
        limits = dict(zip(names[1:], (np.array(chosen) + room).tolist(), strict=True))
        run.search(names[0], limits)
        if run.canceled:
            break
    return run.front()


@dataclass
class _Front:
    """A front as it grows."""

    case: SynthesisCase
    names: tuple[str, ...]
    signs: Array
    total: int
    workers: Workers
    progress: Progress
    answers: list[FrontPoint] = field(default_factory=list)
    points: list[FrontPoint] = field(default_factory=list)
    done: int = 0
    failed: int = 0
    canceled: bool = False

    def search(self, objective: str, limits: dict[str, float]) -> None:
        """Search a point; limits are signed as what is minimized."""
        own = {limit.objective: limit for limit in self.case.limits}
        for name, sign in zip(self.names, self.signs.tolist(), strict=True):
            if name != objective:
                most = limits.get(name, UNLIMITED)
                if name in own:
                    most = min(most, sign * own[name].most)
                own[name] = ObjectiveLimit(name, sign * most)
        case = replace(self.case, objective=objective, limits=tuple(own.values()))

        def show(done: float, /, *, state: RegimeState, **_: Any) -> bool:
            part = (self.done + done) / self.total
            stop = self.progress(part, searches=self.done, state=state)
            self.canceled = self.canceled or bool(stop)
            return bool(stop)

        result = synthesize(
            case, workers=self.workers, progress=show, states=self._start(case), relax=False
        )
        self.done += 1
        if self.canceled:
            return
        if not result.feasible:
            self.failed += 1
            return
        values = {
            item.bound.objective: item.value
            for item in result.outcomes
            if isinstance(item.bound, ObjectiveLimit)
        } | {objective: result.objective}
        point = FrontPoint(tuple(float(values[name]) for name in self.names), result)
        self.answers.append(point)
        if objective == self.names[0]:
            self.points.append(point)

    def _start(self, case: SynthesisCase) -> tuple[RegimeState, ...]:
        """Return states of a search that starts near the answers so far."""
        known: dict[object, list[tuple[float, ...]]] = {}
        for point in self.answers:
            result = point.result
            known.setdefault(result.regime, []).append(
                numbers_of(result.case, result.design, result.workspace)
            )
        return tuple(
            RegimeState(
                regime, population=cloud(case, known[regime], 0.05, OTHERS), best=known[regime][-1]
            )
            for regime in case.regimes
            if regime in known
        )

    def front(self) -> DesignFront:
        """Return what there is, without what is dominated."""
        values = np.array([point.values for point in self.points]).reshape(-1, len(self.names))
        if len(values):  # in steps of a part of their extent, so that equal points count as equal
            values = np.round(values / (SAME * np.maximum(np.ptp(values, axis=0), 1e-12)))
        kept = [self.points[i] for i in nondominated(self.signs * values)]
        kept.sort(key=lambda point: self.signs[0] * point.values[0])
        return DesignFront(
            self.names, tuple(kept), len(self.points) - len(kept), self.done, self.failed,
            self.canceled,
        )  # fmt: skip
