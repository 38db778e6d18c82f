"""Synthesis: the robot that a search found, what decides it, and what it changes."""

from __future__ import annotations

import math
from collections.abc import Callable

from paminsa_viz.blocks.kinds import Block, Note, Row, Table, rows
from paminsa_viz.blocks.requirements import (
    evidence_table,
    verdict_text,
    workspace_text,
)
from paminsa_viz.model.design import Design, stated_parameters
from paminsa_viz.quantities.requirement_text import requirement_label
from paminsa_viz.quantities.requirements import Requirement
from paminsa_viz.synthesis import (
    ObjectiveLimit,
    SynthesisResult,
    buildability_rows,
    find_objective,
)
from paminsa_viz.synthesis.search.buildability import OVERLAP_ALLOWED
from paminsa_viz.units import NONE, format_value, percent_change

BoundText = Callable[[Requirement | ObjectiveLimit], str]
"""A requirement or a limit as text."""


def bound_label(bound: Requirement | ObjectiveLimit) -> str:
    """Return a requirement or a limit for people, with symbols."""
    if isinstance(bound, Requirement):
        return requirement_label(bound)
    return find_objective(bound.objective).label


def synthesis_blocks(result: SynthesisResult, text: BoundText = bound_label) -> list[Block]:
    """Return the answer, what decides it, what would have to give way, and what is proven."""
    objective = find_objective(result.case.objective)
    if result.feasible:
        low, high = (format_value(end, "rad") for end in result.case.requirements.theta)
        sentence = (
            f"Least {objective.label} found: {format_value(result.objective, objective.unit)}, "
            f"with {'' if result.regime is None else result.regime.value}, for the "
            f"{workspace_text(result.workspace)}. The search tried {result.trials} robots and has "
            f"no proof that there is none better; requirements were verified on {result.poses} "
            f"poses, θ {low} to {high} from the heading where joints 5 are toward their leg axes."
        )
        blocks: list[Block] = [Note(sentence, "ok")]
    else:
        blocks = [Note(f"None of {result.trials} robots meets all requirements.", "bad")]
    blocks += [
        Note(f"{regime.value} is excluded: {reason}.") for regime, reason in result.refused.items()
    ]
    if any(math.isfinite(item.value) for item in result.outcomes):
        found = (
            (
                text(one.bound), "active" if one.active else "",
                *(_value(value, one.bound) for value in (one.value, one.margin)),
            )
            for one in result.outcomes
        )  # fmt: skip
        caption = "Requirements at the best robot that was found; active ones decide it."
        head = ("Requirement", "Decides", "Worst value", "Margin")
        blocks.append(Table(head, rows(*found), caption, words=2))
    blocks += _relaxed(result, text)
    blocks += buildability_blocks(result)
    if lengths := _lengths(result.case.reference, result.design):
        head = ("Symbol", "Length", "Before", "Found", "Change")
        blocks.append(Table(head, lengths, "Lengths and masses that changed.", words=2))
    if result.proof is not None:
        verdict = f"Proof over the whole workspace: {verdict_text(result.proof)}."
        blocks += [Note(verdict), evidence_table(result.proof, text)]
    return blocks


def buildability_blocks(result: SynthesisResult) -> list[Block]:
    """Return whether the robot can be built as it is drawn, beside the reference."""
    found = result.buildability
    if found is None:
        return []
    head = ("As drawn, over the workspace", "Found", "Reference")
    table = tuple(
        Row(cells[:3], "marked" if cells[3] else "plain") for cells in buildability_rows(*found)
    )
    caption = "Whether the robot can be built as it is drawn; marked is what it cannot be with."
    blocks: list[Block] = [Table(head, table, caption)]
    if not result.case.clear:
        blocks.insert(0, Note(OVERLAP_ALLOWED, "warn"))
    return blocks


def _relaxed(result: SynthesisResult, text: BoundText) -> list[Block]:
    possible = [item for item in result.relaxed if math.isfinite(item.nearest)]
    if not possible:
        problem = "Relaxing a single one of the requirements does not help."
        return [Note(problem)] if result.relaxed else []
    found = (
        (text(item.bound), _value(item.nearest, item.bound), f"{100 * item.change:+.3g} %")
        for item in possible
    )
    caption = "One of these would have to be relaxed, the others kept; the nearest found."
    return [Table(("Requirement", "Possible", "Change"), rows(*found), caption)]


def _value(value: float, bound: Requirement | ObjectiveLimit) -> str:
    if isinstance(bound, Requirement):
        unit = bound.entry.unit
    else:
        unit = find_objective(bound.objective).unit
    return format_value(value, unit) if math.isfinite(value) else NONE


def _lengths(before: Design, after: Design) -> tuple[Row, ...]:
    found = []
    for item in stated_parameters(after):
        old, new = before.value(item.path), after.value(item.path)
        if item.path != "geometry.guide_stroke" and old != new:  # the stroke follows B10
            values = (format_value(value, item.unit or "1") for value in (old, new))
            found.append((item.symbol, item.label, *values, percent_change(old, new)))
    return rows(*found)
