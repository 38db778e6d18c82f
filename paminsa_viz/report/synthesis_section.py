"""Synthesis: the robot that a search found, what decides it, and what it changes."""

from __future__ import annotations

from paminsa_viz.model.design import PARAMETER, Design
from paminsa_viz.quantities.requirement_text import requirement_label
from paminsa_viz.quantities.requirements import Requirement
from paminsa_viz.report.blocks import Block, Note, Row, Section, Table
from paminsa_viz.report.requirements_section import workspace_text
from paminsa_viz.synthesis.search.objectives import find_objective
from paminsa_viz.synthesis.search.result import BoundOutcome, SynthesisResult
from paminsa_viz.units import format_value, percent_change


def synthesis_section(result: SynthesisResult) -> Section:
    """Return the section."""
    objective = find_objective(result.case.objective)
    if result.feasible:
        text = (
            f"Least {objective.label} found: {format_value(result.objective, objective.unit)}, "
            f"with {'' if result.regime is None else result.regime.value}, for the "
            f"{workspace_text(result.workspace)}. The search tried {result.trials} robots and has "
            f"no proof that there is none better; requirements were verified on {result.poses} "
            "poses."
        )
        blocks: list[Block] = [Note(text, "ok")]
    else:
        blocks = [Note(f"None of {result.trials} robots meets all requirements.", "bad")]
    blocks += [
        Note(f"{regime.value} is excluded: {reason}.") for regime, reason in result.refused.items()
    ]
    rows = tuple(_outcome(one) for one in result.outcomes)
    if rows:
        caption = "Requirements at the robot that was found; active ones decide it."
        head = ("Requirement", "Decides", "Worst value", "Margin")
        blocks.append(Table(head, rows, caption, words=2))
    lengths = _lengths(result.case.reference, result.design)
    if lengths:
        head = ("Symbol", "Length", "Before", "Found", "Change")
        blocks.append(Table(head, lengths, "Lengths that changed.", words=2))
    return Section("synthesis", "Synthesis", tuple(blocks))


def _outcome(one: BoundOutcome) -> Row:
    if isinstance(one.bound, Requirement):
        label, unit = requirement_label(one.bound), one.bound.entry.unit
    else:
        objective = find_objective(one.bound.objective)
        label, unit = objective.label, objective.unit
    values = (format_value(value, unit) for value in (one.value, one.margin))
    return Row((label, "active" if one.active else "", *values))


def _lengths(before: Design, after: Design) -> tuple[Row, ...]:
    rows = []
    for item in PARAMETER.values():
        old, new = before.value(item.path), after.value(item.path)
        if item.path.startswith("geometry.") and old != new:
            values = (format_value(value, item.unit or "1") for value in (old, new))
            rows.append(Row((item.symbol, item.label, *values, percent_change(old, new))))
    return tuple(rows)
