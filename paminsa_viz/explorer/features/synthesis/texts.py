"""Texts of the tab *Synthesis*: the question, how far the search is, and the answer."""

from __future__ import annotations

import math
from typing import Any

from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.features.synthesis.actions import PRICES, SEARCH
from paminsa_viz.explorer.features.synthesis.cases import case_of
from paminsa_viz.explorer.kit.design_numbers import is_changed
from paminsa_viz.explorer.kit.robot_texts import workspace_text
from paminsa_viz.explorer.kit.text import note, render
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model import PARAMETER, Design, InvalidInput, PaminsaError
from paminsa_viz.model.parameters import Parameter
from paminsa_viz.quantities.requirement_text import requirement_label
from paminsa_viz.quantities.requirements import Requirement, Workspace
from paminsa_viz.synthesis.answer.prices import STEP
from paminsa_viz.synthesis.search.buildability import OVERLAP_ALLOWED, buildability_rows
from paminsa_viz.synthesis.search.case import ObjectiveLimit
from paminsa_viz.synthesis.search.objectives import find_objective
from paminsa_viz.synthesis.search.result import BoundOutcome, SynthesisResult
from paminsa_viz.units import format_value, number, percent_change


def intro_html(frame: Frame) -> str:
    """Return what is searched for: the requirements with their workspace, or what is missing."""
    state = frame.state
    requirements = state.document.requirements
    low, high = (format_value(end, "rad") for end in requirements.theta)
    problem = ""
    try:
        case_of(state.synthesis.settings, state.document.design, requirements)
    except PaminsaError as error:
        problem = str(error)
        if isinstance(error, InvalidInput) and requirements.workspace is None:
            problem = "A required workspace is needed; choose one in the tab “Requirements”."
    return render(
        "synthesis/intro.j2", problem=problem, low=low, high=high,
        labels=[requirement_label(bound) for bound in requirements.bounds],
        workspace="" if (space := requirements.workspace) is None else workspace_text(space),
    )  # fmt: skip


def best_html(frame: Frame) -> str:
    """Return how far the search is."""
    synthesis = frame.state.synthesis
    best, job = synthesis.best, synthesis.running
    if job is None or best is None:
        return ""
    objective = find_objective(job.case.objective)
    found = f"{objective.label} {format_value(best.cost, objective.unit)}"
    if job.against:
        found = "a robot for another point of the front"
    return render(
        "synthesis/best.j2", trials=best.trials, stopping=synthesis.stopping,
        text=found if best.feasible else "no robot yet that meets all requirements",
    )  # fmt: skip


def has_robot(state: State) -> bool:
    """Whether a robot was found that meets all requirements."""
    answer = state.synthesis.answer
    return answer is not None and answer.feasible and state.synthesis.running is None


def result_html(frame: Frame) -> str:
    """Return the answer: what was found, what decides, how sure it is, and what has changed."""
    synthesis = frame.state.synthesis
    outcome, result = synthesis.outcome, synthesis.answer
    if outcome is None or synthesis.running is not None:
        return ""
    if outcome.result is None or result is None:
        return note("synthesis-problem", outcome.problem)
    objective = find_objective(result.case.objective)
    built = outcome.result.built
    return render(
        "synthesis/result.j2", feasible=result.feasible, seconds=number(outcome.seconds, 2),
        trials=result.trials, poses=result.poses, canceled=result.canceled,
        objective=f"{objective.label} {format_value(result.objective, objective.unit)}",
        against=against_text(frame.state),
        regime="" if result.regime is None else result.regime.value,
        workspace=placed_text(result.workspace), refused=refusals(result), nearest=nearest(result),
        rows=[_row(one) for one in result.outcomes],
        built=None if built is None else {
            "share": number(100 * built.fraction.value, 3),
            "low": number(100 * built.fraction.low, 3),
            "high": number(100 * built.fraction.high, 3),
            "count": built.fraction.samples, "missed": list(built.missed.items())[:3],
        },
        drawn=() if result.buildability is None else buildability_rows(*result.buildability),
        overlap="" if result.case.clear else OVERLAP_ALLOWED,
        lengths=changed_lengths(outcome.job.reference, result.design),
        stale=SEARCH.stale_text(frame.state),
    )  # fmt: skip


def changed_lengths(before: Design, after: Design) -> list[tuple[Parameter, str, str, str]]:
    """Return the lengths that differ: before, after, and the change."""
    return [
        (
            item, item.display.format(before.value(item.path), 4),
            item.display.format(after.value(item.path), 4),
            percent_change(before.value(item.path), after.value(item.path)),
        )
        for item in PARAMETER.values()
        if item.path.startswith("geometry.") and is_changed(after, item.path, before)
    ]  # fmt: skip


def placed_text(workspace: Workspace) -> str:
    """Return a workspace and the height of its center."""
    z = workspace.center[2]
    return workspace_text(workspace) + ("" if z is None else f" at z {format_value(z, 'm')}")


def refusals(result: SynthesisResult) -> list[tuple[str, str]]:
    """Return the regimes that were excluded, and why."""
    return [(regime.value, reason) for regime, reason in result.refused.items()]


def against_text(state: State) -> str:
    """Return the second objective of the chosen point of a front, or nothing."""
    front, point = state.synthesis.front, state.synthesis.point
    if front is None or point >= len(front.points):
        return ""
    objective = find_objective(front.objectives[1])
    return f"{objective.label} {format_value(front.points[point].values[1], objective.unit)}"


def prices_html(frame: Frame) -> str:
    """Return what each requirement costs the objective."""
    synthesis = frame.state.synthesis
    outcome, result = synthesis.prices.outcome, synthesis.answer
    if outcome is None or result is None or outcome.job.answer is not result:
        return ""
    if outcome.result is None:
        return note("prices-problem", outcome.problem)
    objective = find_objective(result.case.objective)
    rows = [
        (
            one.label, format_value(one.bound, one.unit or "1"),
            format_value(one.relaxed - result.objective, objective.unit, 3),
            format_value(one.tightened - result.objective, objective.unit, 3),
        )
        for one in outcome.result
    ]  # fmt: skip
    steps = f"{100 * STEP:g} %"
    return render(
        "synthesis/prices.j2", rows=rows, step=steps, objective=objective.label,
        stale=PRICES.stale_text(frame.state),
    )  # fmt: skip


def nearest(result: SynthesisResult) -> list[str]:
    """Return the nearest bounds that the others leave possible, as texts."""
    found = []
    for one in result.relaxed:
        if math.isfinite(one.nearest):
            label, unit = bound_text(one.bound)
            found.append(f"{label}: {format_value(one.nearest, unit)}")
    return found


def bound_text(bound: Requirement | ObjectiveLimit) -> tuple[str, str]:
    """Return a bound for people, and its SI unit."""
    if isinstance(bound, Requirement):
        return requirement_label(bound), bound.entry.unit
    objective = find_objective(bound.objective)
    sign = "≥" if objective.largest else "≤"
    return f"{objective.label} {sign} {format_value(bound.most, objective.unit)}", objective.unit


def _row(one: BoundOutcome) -> dict[str, Any]:
    label, unit = bound_text(one.bound)
    mark, level = ("✓", "pv-ok") if one.margin >= 0 else ("✗", "pv-bad")
    if math.isnan(one.margin):  # a bound before it is broken already
        mark, level = "–", "pv-plain"
    return {
        "label": label, "value": format_value(one.value, unit), "active": one.active,
        "level": level, "mark": mark,
    }  # fmt: skip
