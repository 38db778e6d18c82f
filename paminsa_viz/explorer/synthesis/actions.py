"""Actions on the synthesis, each a pure function from state to state."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from paminsa_viz.explorer.actions import load_design, move, stop_following, with_document
from paminsa_viz.explorer.state import State
from paminsa_viz.explorer.synthesis.jobs import (
    BestSoFar,
    PriceJob,
    PriceOutcome,
    Range,
    Shown,
    SynthesisJob,
    SynthesisOutcome,
)
from paminsa_viz.model import InvalidInput


def change_settings(state: State, **changes: Any) -> State:
    """Change the settings of the search."""
    settings = replace(state.synthesizing.settings, **changes)
    return state.updated("synthesizing", settings=settings)


def set_range(state: State, path: str, ends: Range) -> State:
    """Search a number in another range [SI]; hold it where both ends are equal.

    Raises:
        InvalidInput: If the range is not possible.
    """
    if ends[0] > ends[1]:
        raise InvalidInput(path, f"low <= high is needed, not {ends[0]:g} to {ends[1]:g}")
    kept = tuple(item for item in state.synthesizing.settings.ranges if item[0] != path)
    return change_settings(state, ranges=(*kept, (path, ends)))


def start(state: State) -> State:
    """Start a search.

    Raises:
        InvalidInput: If something is missing, such as a workspace.
    """
    from paminsa_viz.explorer.synthesis.cases import case_of  # loads the search

    document, settings = state.document, state.synthesizing.settings
    if document.requirements.workspace is None:
        raise InvalidInput(
            "workspace", "a required workspace is needed; choose one in the tab “Requirements”"
        )
    case = case_of(settings, document.design, document.requirements)
    if settings.against == settings.objective:
        raise InvalidInput("objective", "two different ones are needed for a Pareto front")
    job = SynthesisJob(case, settings.effort, document.design, settings.against)
    return state.updated("synthesizing", running=job, best=BestSoFar())


def stop(state: State) -> State:
    """End the search; what it has found so far stays in sight."""
    return state.updated("synthesizing", running=None)


def tell(state: State, job: SynthesisJob, best: BestSoFar) -> State:
    """Take over how far a search is."""
    if state.synthesizing.running is not job:
        return state
    return state.updated("synthesizing", best=best)


def receive(state: State, outcome: SynthesisOutcome) -> State:
    """Take over a result."""
    return state.updated("synthesizing", running=None, best=None, outcome=outcome, point=0)


def choose_point(state: State, index: int) -> State:
    """Show another robot of the front."""
    outcome = state.synthesizing.outcome
    count = 0 if outcome is None or outcome.front is None else len(outcome.front.points)
    return state.updated("synthesizing", point=index) if 0 <= index < count else state


def start_prices(state: State) -> State:
    """Work out what the requirements of the answer that is shown cost.

    Raises:
        InvalidInput: If there is none.
    """
    result = state.synthesizing.result
    if result is None or not result.feasible:
        raise InvalidInput("synthesis", "no robot has been found yet")
    job = PriceJob(result, state.synthesizing.settings.effort)
    return state.updated("synthesizing", pricing=job, priced=0.0)


def stop_prices(state: State) -> State:
    """End that."""
    return state.updated("synthesizing", pricing=None)


def report_prices(state: State, job: PriceJob, done: float) -> State:
    """Take over what part is done."""
    return (
        state.updated("synthesizing", priced=done) if state.synthesizing.pricing is job else state
    )


def receive_prices(state: State, outcome: PriceOutcome) -> State:
    """Take over the prices."""
    return state.updated("synthesizing", pricing=None, prices=outcome)


def open_result(state: State) -> State:
    """Work on the robot that was found, with the design that the search began with as reference.

    Its workspace becomes the required one, where it was found.

    Raises:
        InvalidInput: If there is none.
    """
    outcome = state.synthesizing.outcome
    result = state.synthesizing.result
    if outcome is None or result is None or not result.feasible:
        raise InvalidInput("synthesis", "no robot has been found yet")
    requirements = replace(outcome.job.case.requirements, workspace=result.workspace)
    shown = stop_following(state)
    document = replace(shown.document, reference=outcome.job.reference, requirements=requirements)
    opened = load_design(with_document(shown, document), result.design)
    x, y, z = (float(place or 0.0) for place in result.workspace.center)
    return move(opened, x=x, y=y, theta=sum(requirements.theta) / 2, z=z)


def previewed(state: State) -> State:
    """Return the state with the best robot so far in the design's place, while it is shown so."""
    synthesizing = state.synthesizing
    best, job = synthesizing.best, synthesizing.running
    if job is None or synthesizing.settings.shown is not Shown.ROBOT:
        return state
    if best is None or best.design is None or state.document.design != job.reference:
        return state
    x, y, z = best.center
    theta = sum(job.case.requirements.theta) / 2
    design = replace(best.design, name=f"{state.document.design.name}, best so far")
    document = replace(state.document, design=design, pose=(x, y, theta, z))
    return with_document(stop_following(state), document)
