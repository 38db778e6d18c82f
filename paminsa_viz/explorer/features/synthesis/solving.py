"""Runs the search of a session, and tells of the best robot so far."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from paminsa_viz.explorer.state.outcome import Report
from paminsa_viz.explorer.state.synthesis import (
    BestSoFar,
    EffortChoice,
    PriceJob,
    SearchResult,
    SynthesisJob,
)
from paminsa_viz.model import PaminsaError
from paminsa_viz.studies.executors import Workers, here, processes
from paminsa_viz.synthesis.answer.checks import AnswerMargins, BuildYield, build_yield
from paminsa_viz.synthesis.search.evaluation import Evaluator
from paminsa_viz.synthesis.search.objectives import find_objective
from paminsa_viz.synthesis.search.outer import SearchProgress
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

SEARCH_SHARE = 0.9
"""Part of a job that the search takes; the tolerances take the rest."""

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

    def __init__(self, job: SynthesisJob, report: Report) -> None:
        self._job, self._report = job, report
        self._due = 0.0
        self._search: int | None = None
        self._trials: dict[object, int] = {}
        self._best = (math.inf, BestSoFar())

    def of_front(self, number: int, count: int, progress: SearchProgress) -> bool:
        """Take over how far the search of a front is; return whether to stop."""
        if number != self._search:  # another objective or limit
            self._search, self._best = number, (math.inf, BestSoFar())
        self._trials[number] = progress.trials
        return self._tell(progress, number / count, one_objective=False)

    def __call__(self, progress: SearchProgress) -> bool:
        """Take over how far a search is; return whether to stop."""
        case = self._job.case
        self._trials[progress.regime] = progress.trials
        turn = case.regimes.index(progress.regime) if progress.regime in case.regimes else 0
        part = min(progress.generation / case.effort.generations, 1.0)
        done = SEARCH_SHARE * (turn + part) / len(case.regimes)
        return self._tell(progress, done)

    def _tell(self, progress: SearchProgress, done: float, *, one_objective: bool = True) -> bool:
        if time.monotonic() < self._due:
            return False
        self._due = time.monotonic() + PERIOD
        best = self._shown(progress)
        return self._report(done, best=best if one_objective else replace(best, cost=math.nan))

    def _shown(self, progress: SearchProgress) -> BestSoFar:
        cost, known = self._best
        if progress.cost < cost:
            cost, known = progress.cost, best_robot(self._job, progress)
            self._best = cost, known
        sign = find_objective(self._job.case.objective).sign
        return BestSoFar(
            sum(self._trials.values()), sign * cost if known.feasible else math.nan,
            known.feasible, known.design, known.center,
        )  # fmt: skip


def best_robot(job: SynthesisJob, progress: SearchProgress) -> BestSoFar:
    """Return the best robot of a search so far; none if it does not reach its workspace."""
    case = job.case
    found = Evaluator(case, progress.regime).evaluate(np.array([progress.best]))[0]
    if found.trial is None:
        return BestSoFar(feasible=False)
    try:
        design = found.trial.design
    except PaminsaError:
        return BestSoFar(feasible=False)
    x, y, z = (float(place or 0.0) for place in found.trial.workspace.center)
    return BestSoFar(feasible=progress.feasible, design=design, center=(x, y, z))


def search(job: SynthesisJob, report: Report) -> SearchResult:
    """Run a search, then measure robots built within tolerances.

    Raises:
        PaminsaError: If no search is possible, or a front has no points.
    """
    with workers_for(job.effort) as workers:
        shown = ProgressReport(job, report)
        if job.against:
            return find_front(job, workers, shown)
        answer = synthesize(job.case, workers=workers, progress=shown)
        if answer.canceled and answer.regime is None:
            raise PaminsaError(STOPPED)
        _ = answer.buildability  # worked out here, and kept with the answer
        built = None
        if answer.feasible and not report(SEARCH_SHARE):
            built = tolerances(answer, workers, report)
    return SearchResult(answer, built)


def find_front(job: SynthesisJob, workers: Workers, shown: ProgressReport) -> SearchResult:
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
    for point in front.points:
        _ = point.result.buildability
    return SearchResult(front.points[0].result, front=front)


def find_prices(job: PriceJob, report: Report) -> tuple[RequirementPrice, ...]:
    """Work out what the requirements of an answer cost."""
    from paminsa_viz.synthesis.answer.prices import requirement_prices

    with workers_for(job.effort) as workers:
        return requirement_prices(
            job.answer, workers=workers, progress=lambda done, count: report(done / count)
        )


def tolerances(result: SynthesisResult, workers: Workers, report: Report) -> BuildYield:
    """Return which part of the robots built within tolerances meets the requirements."""

    def progress(done: int, count: int) -> bool:
        return report(SEARCH_SHARE + (1 - SEARCH_SHARE) * done / count)

    return build_yield(
        result.design, AnswerMargins.of(result), samples=BUILT, workers=workers,
        seed=result.case.seed, progress=progress,
    )  # fmt: skip
