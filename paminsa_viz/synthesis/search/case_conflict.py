"""Requirements that no robot of a case meets together, the fewest by leaving out one at a time.

That some can be met is certain: a robot is at hand. That they cannot is proven where closed forms
refuse them; otherwise it is the answer of a search that found none.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

from paminsa_viz.progress import Progress, go_on
from paminsa_viz.quantities.requirements import Requirement
from paminsa_viz.studies.executors import Workers, here
from paminsa_viz.synthesis.search.case import Effort, ObjectiveLimit, SynthesisCase
from paminsa_viz.synthesis.search.outer import RegimeState
from paminsa_viz.synthesis.search.refusals import refusal
from paminsa_viz.synthesis.search.solve import synthesize
from paminsa_viz.synthesis.volume.conflict import irreducible_set

EFFORT = Effort(60, 10)
"""How long each of the searches looks for a robot; it ends with the first."""


@dataclass(frozen=True)
class CaseConflict:
    """Requirements that contradict within the ranges of a case.

    Attributes:
        items: The requirements and limits: with any of them left out, a robot was found for the
            rest. None of them where the workspace is already out of reach within the ranges.
        proven: Whether closed forms refuse them; otherwise a search found no robot.
        searches: Searches made.
        canceled: Whether the progress function ended it; the items may then be more than need be.
    """

    items: tuple[Requirement | ObjectiveLimit, ...]
    proven: bool
    searches: int
    canceled: bool


def case_conflict(
    case: SynthesisCase,
    *,
    effort: Effort = EFFORT,
    workers: Workers = here,
    progress: Progress = go_on,
) -> CaseConflict | None:
    """Return which requirements contradict; None if a robot meets them all.

    Args:
        case: The case.
        effort: How long each search looks.
        workers: Where trials are computed.
        progress: Called after each generation with the number of ``searches`` done and the
            ``state`` of the current one, whose part is the one that is done; true ends it.
    """
    run = _Searches(case, effort, workers, progress)
    items = (*case.requirements.bounds, *case.limits)
    places = tuple(range(len(items)))
    possible = run.feasible(places)
    if possible and not run.canceled:
        return None
    if possible:
        found = places  # nothing is known of any
    else:
        found = irreducible_set(places, run.feasible) if run.feasible(()) else ()
    return CaseConflict(
        tuple(items[i] for i in found), run.refused(found), run.searches, run.canceled
    )


@dataclass
class _Searches:
    """Searches for a robot that meets some of the requirements; each set is asked once."""

    case: SynthesisCase
    effort: Effort
    workers: Workers
    progress: Progress
    known: dict[tuple[int, ...], bool] = field(default_factory=dict)
    searches: int = 0
    canceled: bool = False

    def feasible(self, chosen: tuple[int, ...]) -> bool:
        """Whether a robot is found; taken for granted once the search was canceled."""
        if chosen not in self.known:
            self.known[chosen] = not self.refused(chosen) and self._found(self._with(chosen))
        return self.known[chosen]

    def refused(self, chosen: tuple[int, ...]) -> bool:
        """Whether closed forms exclude all robots."""
        case = self._with(chosen)
        return all(refusal(case, regime) for regime in case.regimes)

    def _with(self, chosen: tuple[int, ...]) -> SynthesisCase:
        bounds = self.case.requirements.bounds
        kept = tuple(bounds[i] for i in chosen if i < len(bounds))
        limits = tuple(self.case.limits[i - len(bounds)] for i in chosen if i >= len(bounds))
        requirements = replace(self.case.requirements, bounds=kept)
        # where the bound on clearance is left out, no other comes in its place
        return replace(
            self.case, requirements=requirements, limits=limits, effort=self.effort,
            allow_overlap=True,
        )  # fmt: skip

    def _found(self, case: SynthesisCase) -> bool:
        if self.canceled:
            return True
        found = False

        def stop(done: float, /, *, state: RegimeState, **_: Any) -> bool:
            nonlocal found
            found = found or state.feasible
            if not found and self.progress(done, searches=self.searches, state=state):
                self.canceled = True
            return found or self.canceled

        result = synthesize(case, workers=self.workers, progress=stop, relax=False)
        self.searches += 1
        return found or result.feasible or self.canceled
