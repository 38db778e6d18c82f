"""Texts of the tab *Synthesis*: the question, how far the search is, and the answer."""

from __future__ import annotations

from paminsa_viz.blocks.answer_checks import price_blocks, yield_blocks
from paminsa_viz.blocks.kinds import Note, Table
from paminsa_viz.blocks.synthesis import (
    buildability_blocks,
    effort_note,
    lengths_table,
    objective_text,
    outcomes_table,
    refused_notes,
    relaxed_blocks,
)
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.features.synthesis.actions import PRICES, SEARCH
from paminsa_viz.explorer.features.synthesis.cases import case_of
from paminsa_viz.explorer.kit.text import blocks_html, note, render
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model import PaminsaError
from paminsa_viz.quantities.requirement_text import (
    headings_text,
    requirement_label,
    shape_text,
    workspace_text,
)
from paminsa_viz.units import as_sentence, number


def intro_html(frame: Frame) -> str:
    """Return what is searched for: the requirements with their workspace, or what is missing."""
    state = frame.state
    requirements = state.document.requirements
    problem = ""
    try:
        case_of(state.synthesis.settings, state.document.design, requirements)
    except PaminsaError as error:
        problem = as_sentence(str(error).removeprefix("workspace: "))  # which it says itself
    return render(
        "synthesis/intro.j2", problem=problem, headings=headings_text(requirements),
        labels=[requirement_label(bound) for bound in requirements.bounds],
        workspace="" if (space := requirements.workspace) is None else shape_text(space),
    )  # fmt: skip


def best_html(frame: Frame) -> str:
    """Return how far the search is."""
    synthesis = frame.state.synthesis
    best, job = synthesis.best, synthesis.running
    if job is None or best is None:
        return ""
    found = objective_text(job.case.objective, best.cost)
    if job.against:
        found = "a robot for another point of the front"
    return render(
        "synthesis/best.j2", trials=best.trials, stopping=synthesis.stopping,
        text=found if best.feasible else "no robot yet that meets all requirements",
    )  # fmt: skip


def has_robot(state: State) -> bool:
    """Whether a robot was found that meets all requirements."""
    answer = state.synthesis.answer
    return answer is not None and answer.feasible


def can_price(state: State) -> bool:
    """Whether it can be worked out what the requirements cost: a search needs all cores."""
    return has_robot(state) and state.synthesis.running is None


ANOTHER = "This is of the search before; another one runs."
"""What is said above an answer while the next one is searched for."""


def result_html(frame: Frame) -> str:
    """Return the answer: what was found, what decides, how sure it is, and what has changed.

    While another search runs it is that of the search before.
    """
    synthesis = frame.state.synthesis
    outcome, result = synthesis.outcome, synthesis.answer
    if outcome is None:
        return ""
    # Not what has changed: the design may be the best robot so far of the search that runs.
    stale = SEARCH.stale_text(frame.state) if synthesis.running is None else ANOTHER
    if outcome.result is None or result is None:
        again = f" {ANOTHER}" if synthesis.running is not None else ""
        return note("synthesis-problem", outcome.problem + again)
    built = outcome.result.built
    drawn = buildability_blocks(result)
    relaxed = relaxed_blocks(result)
    lengths = lengths_table(outcome.job.reference, result.design, "geometry.")
    return render(
        "synthesis/result.j2", feasible=result.feasible, seconds=number(outcome.seconds, 2),
        effort=effort_note(result).text, canceled=result.canceled,
        objective=objective_text(result.case.objective, result.objective),
        against=against_text(frame.state),
        regime="" if result.regime is None else result.regime.value,
        workspace=workspace_text(result.workspace), refused=refused_notes(result),
        requirements=outcomes_table(result).columns(0, 1, 2),
        drawn=[one for one in drawn if isinstance(one, Table)],
        overlap=[one for one in drawn if isinstance(one, Note)], relaxed=relaxed,
        built=[] if built is None else yield_blocks(built),
        lengths=lengths.columns(0, 3, 4, 5, hint=1), stale=stale,
    )  # fmt: skip


def against_text(state: State) -> str:
    """Return the second objective of the chosen point of a front, or nothing."""
    front, point = state.synthesis.front, state.synthesis.point
    if front is None or point >= len(front.points):
        return ""
    return objective_text(front.objectives[1], front.points[point].values[1])


def prices_html(frame: Frame) -> str:
    """Return what each requirement costs the objective."""
    synthesis = frame.state.synthesis
    outcome, result = synthesis.prices.outcome, synthesis.answer
    if outcome is None or result is None or outcome.job.answer is not result:
        return ""
    if outcome.result is None:
        return note("prices-problem", outcome.problem)
    blocks: list[Table | Note] = []
    for one in price_blocks(result, outcome.result):
        if isinstance(one, Table):
            blocks += [one.columns(0, 1, 2, 3, 4), Note(one.caption, "muted")]
        else:
            blocks.append(one)
    return blocks_html(
        "synthesis-prices", *blocks, look="pv-causes pv-wrapped",
        stale=PRICES.stale_text(frame.state),
    )  # fmt: skip
