"""Actions on the synthesis, each a pure function from state to state."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from paminsa_viz.explorer.core.actions import load_design, move_to, stop_following, with_document
from paminsa_viz.explorer.core.place import Place
from paminsa_viz.explorer.kit.task import Task
from paminsa_viz.explorer.state.state import State
from paminsa_viz.explorer.state.synthesis import (
    BestSoFar,
    PriceJob,
    Range,
    SearchOutcome,
    SearchResult,
    Shown,
    SynthesisJob,
)
from paminsa_viz.model import InvalidInput
from paminsa_viz.model.arrays import Pose
from paminsa_viz.progress import Progress
from paminsa_viz.quantities.requirements import Requirements

if TYPE_CHECKING:
    from paminsa_viz.synthesis.answer.prices import RequirementPrice
    from paminsa_viz.synthesis.search.result import SynthesisResult


def set_range(state: State, path: str, ends: Range) -> State:
    """Search a number in another range [SI]; hold it where both ends are equal.

    Raises:
        InvalidInput: If the range is not possible.
    """
    if ends[0] > ends[1]:
        raise InvalidInput(path, f"low <= high is needed, not {ends[0]:g} to {ends[1]:g}")
    kept = tuple(item for item in state.synthesis.settings.ranges if item[0] != path)
    return state.updated("synthesis.settings", ranges=(*kept, (path, ends)))


def search_job(state: State) -> SynthesisJob:
    """Return the search of a state.

    Raises:
        InvalidInput: If something is missing, such as a workspace.
    """
    from paminsa_viz.explorer.features.synthesis.cases import case_of  # loads the search

    document, settings = state.document, state.synthesis.settings
    case = case_of(settings, document.design, document.requirements)
    if settings.against == settings.objective:
        raise InvalidInput("objective", "two different ones are needed for a Pareto front")
    return SynthesisJob(case, settings.effort, document.design, settings.against)


def receive(state: State, outcome: SearchOutcome) -> State:
    """Take over a result; of a front, its first point is shown."""
    return state.updated("synthesis", outcome=outcome, best=None, point=0)


def _again(state: State, outcome: SearchOutcome) -> SynthesisJob:
    """Return the search anew; a robot that it found, at any point of a front, and that is worked on
    by now is no other one."""
    job, document = outcome.job, state.document
    requirements = document.requirements
    found = next((one for one in state.synthesis.answers if one.design == document.design), None)
    if found is not None:
        if requirements.workspace == found.workspace:
            requirements = replace(requirements, workspace=job.case.requirements.workspace)
        changed = replace(document, design=job.reference, requirements=requirements)
        state = replace(state, document=changed)
    return search_job(state)


def _search(job: SynthesisJob, progress: Progress) -> SearchResult:
    from paminsa_viz.explorer.features.synthesis.solving import search  # loads the search

    return search(job, progress)


SEARCH = Task(
    Place(lambda state: state.synthesis), search_job, _search, receive=receive, again=_again,
    bodies=True,
)  # fmt: skip
"""Searches for a robot that meets the requirements."""


def start(state: State) -> State:
    """Start a search.

    Raises:
        InvalidInput: If something is missing, such as a workspace.
    """
    return SEARCH.start(state).updated("synthesis", best=BestSoFar())


def stop(state: State) -> State:
    """End the search with the best robot so far; at once if there is none, or if asked again."""
    best = state.synthesis.best
    if state.synthesis.stopping or best is None or not best.feasible:
        return SEARCH.stop(state)
    return state.updated("synthesis", stopping=True)


def choose_point(state: State, index: int) -> State:
    """Show another robot of the front."""
    front = state.synthesis.front
    count = 0 if front is None else len(front.points)
    return state.updated("synthesis", point=index) if 0 <= index < count else state


def _price_job(state: State) -> PriceJob:
    answer = state.synthesis.answer
    if answer is None or not answer.feasible:
        raise InvalidInput("synthesis", "no robot has been found yet")
    return PriceJob(answer, state.synthesis.settings.effort)


def _find_prices(job: PriceJob, progress: Progress) -> tuple[RequirementPrice, ...]:
    from paminsa_viz.explorer.features.synthesis.solving import find_prices  # loads the search

    return find_prices(job, progress)


PRICES = Task(Place(lambda state: state.synthesis.prices), _price_job, _find_prices)
"""Works out what the requirements of the answer that is shown cost."""


def found_name(result: SynthesisResult) -> str:
    """Return the name of a robot that was found: ``Synthesized, footprint radius 515 mm``."""
    from paminsa_viz.blocks.synthesis import objective_text  # loads the search

    return f"Synthesized, {objective_text(result.case.objective, result.objective, 3)}"


def best_pose(center: Sequence[float | None], requirements: Requirements) -> Pose:
    """Return where a robot of a search is drawn, shown and opened.

    Args:
        center: Middle of its workspace [m].
        requirements: Those of the search, whose middle heading it has.
    """
    x, y, z = (float(place or 0.0) for place in center)
    return x, y, sum(requirements.theta) / 2, z


def open_result(state: State) -> State:
    """Work on the robot that was found, with the design that the search began with as reference.

    Its workspace becomes the required one, where it was found, if the required one is still that of
    the search; no other requirement changes.

    Raises:
        InvalidInput: If there is none.
    """
    outcome, result = state.synthesis.outcome, state.synthesis.answer
    if outcome is None or result is None or not result.feasible:
        raise InvalidInput("synthesis", "no robot has been found yet")
    searched, requirements = outcome.job.case.requirements, state.document.requirements
    if requirements.workspace == searched.workspace:
        requirements = replace(requirements, workspace=result.workspace)
    shown = stop_following(state)
    document = replace(shown.document, reference=outcome.job.reference, requirements=requirements)
    opened = load_design(
        with_document(shown, document), replace(result.design, name=found_name(result))
    )
    return move_to(opened, best_pose(result.workspace.center, searched))


def previewed(state: State) -> State:
    """Return the state with the best robot so far in the design's place, while it is shown so."""
    synthesis = state.synthesis
    best, job = synthesis.best, synthesis.running
    if job is None or synthesis.settings.shown is not Shown.ROBOT:
        return state
    if best is None or best.design is None or state.document.design != job.reference:
        return state
    pose = best_pose(best.center, job.case.requirements)
    design = replace(best.design, name=f"{state.document.design.name}, best so far")
    document = replace(state.document, design=design, pose=pose)
    return with_document(stop_following(state), document)
