"""Runs the search of a session, and tells of the best robot so far."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from paminsa_viz.explorer.state.synthesis import (
    BestSoFar,
    EffortChoice,
    PriceJob,
    SearchResult,
    SynthesisJob,
)
from paminsa_viz.model import PaminsaError
from paminsa_viz.progress import Progress, of_part
from paminsa_viz.studies.executors import Workers, here, processes
from paminsa_viz.synthesis.answer.checks import AnswerMargins, BuildYield, build_yield
from paminsa_viz.synthesis.search.evaluation import Evaluator
from paminsa_viz.synthesis.search.objectives import find_objective
from paminsa_viz.synthesis.search.outer import RegimeState
from paminsa_viz.synthesis.search.result import SynthesisResult
from paminsa_viz.synthesis.search.solve import synthesize

if TYPE_CHECKING:
    from paminsa_viz.synthesis.answer.prices import RequirementPrice

PERIOD = 0.5
"""Time between two robots that are shown [s]: each is drawn with bodies of other lengths."""

POINTS = 6
"""Points of a front."""

BUILT = 200
"""Robots built within tolerances that are measured."""

SEARCH_SHARE, BUILDABLE_SHARE = 0.9, 0.05
"""Parts of a job that the search takes, and whether robots can be built; tolerances take the
rest."""

STOPPED = "Stopped before a robot was found."


@contextmanager
def workers_for(effort: EffortChoice) -> Iterator[Workers]:
    """Work in other processes, so that the page keeps responding; a quick search ends before."""
    if effort is EffortChoice.QUICK:
        yield here
        return
    with processes() as found:
        yield found


class ProgressReport:
    """Turns the progress of a search into what the page shows."""

    def __init__(self, job: SynthesisJob, progress: Progress) -> None:
        self._job, self._progress = job, progress
        self._due = 0.0
        self._search: int | None = None
        self._trials: dict[object, int] = {}
        self._best = (math.inf, BestSoFar())

    def of_front(
        self, done: float, /, *, searches: int, state: RegimeState, **_: Any
    ) -> bool | None:
        """Take over how far the search of a front is; return whether to stop."""
        if searches != self._search:  # another objective or limit
            self._search, self._best = searches, (math.inf, BestSoFar())
        self._trials[searches] = state.trials
        return self._tell(state, SEARCH_SHARE * done, one_objective=False)

    def __call__(self, done: float, /, *, state: RegimeState, **_: Any) -> bool | None:
        """Take over how far a search is; return whether to stop."""
        self._trials[state.regime] = state.trials
        return self._tell(state, SEARCH_SHARE * done)

    def _tell(self, state: RegimeState, done: float, *, one_objective: bool = True) -> bool | None:
        if time.monotonic() < self._due:
            return False
        self._due = time.monotonic() + PERIOD
        best = self._shown(state)
        return self._progress(done, best=best if one_objective else replace(best, cost=math.nan))

    def _shown(self, state: RegimeState) -> BestSoFar:
        cost, known = self._best
        if state.cost < cost:
            cost, known = state.cost, best_robot(self._job, state)
            self._best = cost, known
        sign = find_objective(self._job.case.objective).sign
        return BestSoFar(
            sum(self._trials.values()), sign * cost if known.feasible else math.nan,
            known.feasible, known.design, known.center,
        )  # fmt: skip


def best_robot(job: SynthesisJob, state: RegimeState) -> BestSoFar:
    """Return the best robot of a search so far; none if it does not reach its workspace."""
    case = job.case
    found = Evaluator(case, state.regime).evaluate(np.array([state.best]))[0]
    if found.trial is None:
        return BestSoFar(feasible=False)
    try:
        design = found.trial.design
    except PaminsaError:
        return BestSoFar(feasible=False)
    x, y, z = (float(place or 0.0) for place in found.trial.workspace.center)
    return BestSoFar(feasible=state.feasible, design=design, center=(x, y, z))


def search(job: SynthesisJob, progress: Progress) -> SearchResult:
    """Run a search, then measure robots built within tolerances.

    Raises:
        PaminsaError: If no search is possible, or a front has no points.
    """
    with workers_for(job.effort) as workers:
        shown = ProgressReport(job, progress)
        if job.against:
            return find_front(job, workers, shown, progress)
        answer = synthesize(job.case, workers=workers, progress=shown)
        if answer.canceled and answer.regime is None:
            raise PaminsaError(STOPPED)
        check_buildable([answer], progress)
        built = None
        if answer.feasible and not progress(SEARCH_SHARE + BUILDABLE_SHARE):
            built = tolerances(answer, workers, progress)
    return SearchResult(answer, built)


def check_buildable(results: Sequence[SynthesisResult], progress: Progress) -> None:
    """Work out whether robots can be built, which is kept with them.

    Of the best robot of a search that is stopped too; what is not wanted at all any more, its
    progress ends by an exception.
    """

    def tell(done: float, /, **_: Any) -> None:
        progress(done)

    share = BUILDABLE_SHARE / len(results)
    for index, result in enumerate(results):
        begin = SEARCH_SHARE + share * index
        result.check_buildability(of_part(tell, begin, begin + share))


def find_front(
    job: SynthesisJob, workers: Workers, shown: ProgressReport, progress: Progress
) -> SearchResult:
    """Search for the Pareto front of two objectives.

    Raises:
        PaminsaError: If it has no points.
    """
    from paminsa_viz.synthesis.search.front import design_front

    front = design_front(
        job.case, (job.case.objective, job.against), points=POINTS, workers=workers,
        progress=shown.of_front,
    )  # fmt: skip
    if not front.points:
        problem = "No robot meets all requirements; search one objective alone for the reasons."
        raise PaminsaError(STOPPED if front.canceled else problem)
    check_buildable([point.result for point in front.points], progress)
    return SearchResult(front.points[0].result, front=front)


def find_prices(job: PriceJob, progress: Progress) -> tuple[RequirementPrice, ...]:
    """Work out what the requirements of an answer cost."""
    from paminsa_viz.synthesis.answer.prices import requirement_prices

    with workers_for(job.effort) as workers:
        return requirement_prices(job.answer, workers=workers, progress=progress)


def tolerances(result: SynthesisResult, workers: Workers, progress: Progress) -> BuildYield:
    """Return which part of the robots built within tolerances meets the requirements."""
    rest = of_part(progress, SEARCH_SHARE + BUILDABLE_SHARE, 1.0)
    return build_yield(
        result.design, AnswerMargins.of(result), samples=BUILT, workers=workers,
        seed=result.case.seed, progress=rest,
    )  # fmt: skip
