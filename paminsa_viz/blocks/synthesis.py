"""Synthesis: the robot that a search found, what decides it, and what it changes."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any

from paminsa_viz.blocks.data import record
from paminsa_viz.blocks.design import changes_table
from paminsa_viz.blocks.kinds import Block, Cell, Note, Row, Table, rows
from paminsa_viz.blocks.proofs import evidence_table, verdict_text
from paminsa_viz.model.design import Design, stated_parameters
from paminsa_viz.quantities.quantity import Quantity
from paminsa_viz.quantities.requirement_text import (
    headings_text,
    requirement_label,
    requirement_text,
    workspace_text,
    worst_text,
)
from paminsa_viz.quantities.requirements import Requirement
from paminsa_viz.synthesis import (
    BoundOutcome,
    Buildability,
    Objective,
    ObjectiveLimit,
    SynthesisCase,
    SynthesisResult,
    find_objective,
)
from paminsa_viz.synthesis.search.front import DesignFront
from paminsa_viz.units import (
    NONE,
    counted,
    format_ascii,
    format_value,
    number,
    percent,
    si_unit,
    unit_text,
)

OVERLAP_ALLOWED = "Overlap was allowed: the robot need not be one that can be built as it is drawn."
"""What marks an answer for which it was not required that the bodies do not overlap."""

BoundText = Callable[[Requirement | ObjectiveLimit], str]
"""A requirement or a limit as text."""


def bound_label(bound: Requirement | ObjectiveLimit, *, ascii_only: bool = False) -> str:
    """Return a requirement or a limit for people, with symbols; if ASCII, as files have it."""
    if isinstance(bound, Requirement):
        return requirement_text(bound) if ascii_only else requirement_label(bound)
    objective = find_objective(bound.objective)
    if ascii_only:
        name, sign, text = objective.key, "<>"[objective.largest] + "=", format_ascii
    else:
        name, sign, text = objective.label, "≤≥"[objective.largest], format_value
    return f"{name} {sign} {text(bound.most, objective.unit)}"


bound_text: BoundText = partial(bound_label, ascii_only=True)
"""The same as flags, files and JSON have it."""


def synthesis_blocks(result: SynthesisResult, text: BoundText = bound_label) -> list[Block]:
    """Return the answer, what decides it, what would have to give way, and what is proven."""
    if result.feasible:
        objective = find_objective(result.case.objective)
        sentence = (
            f"Least {objective.label} found: {format_value(result.objective, objective.unit)}, "
            f"with {'' if result.regime is None else result.regime.value}, for the "
            f"{workspace_text(result.workspace)}."
        )
        blocks: list[Block] = [Note(sentence, "ok")]
    else:
        blocks = [Note("No robot meets all requirements; below is the nearest one.", "bad")]
    blocks.append(effort_note(result))
    blocks += refused_notes(result)
    if any(math.isfinite(item.value) for item in _required(result)):
        blocks.append(outcomes_table(result, text))
    blocks += relaxed_blocks(result, text)
    blocks += buildability_blocks(result)
    lengths = lengths_table(result.case.reference, result.design)
    if lengths.rows:
        blocks.append(lengths)
    if result.proof is not None:
        verdict = f"Proof over the whole workspace: {verdict_text(result.proof)}."
        blocks += [Note(verdict), evidence_table(result.proof, text)]
    return blocks


def objective_text(key: str, value: float, digits: int = 4) -> str:
    """Return a value of an objective, and what it is."""
    objective = find_objective(key)
    return f"{objective.label} {format_value(value, objective.unit, digits)}"


def effort_note(result: SynthesisResult) -> Note:
    """Return how an answer was searched and verified, and what that does not prove."""
    text = f"The search tried {counted(result.trials, 'robot')}"
    if result.canceled:
        text += " before it was stopped"
    if result.feasible:
        text += (
            " and has no proof that there is none better; requirements were verified on "
            f"{counted(result.poses, 'pose')}, {headings_text(result.case.requirements)} from the "
            "heading where joints 5 are toward their leg axes"
        )
    return Note(f"{text}.", "muted")


def refused_notes(result: SynthesisResult) -> list[Note]:
    """Return the regimes that were excluded, and why."""
    return [
        Note(f"{regime.value} is excluded: {_with_signs(reason)}.")
        for regime, reason in result.refused.items()
    ]


def _with_signs(text: str) -> str:
    """Return a message with its formulas as they are read: ``|R_b − R_pl| ≥ 3``."""
    for plain, sign in ((" - ", " − "), ("<=", "≤"), (">=", "≥")):
        text = text.replace(plain, sign)
    return text


def _required(result: SynthesisResult) -> list[BoundOutcome]:
    """Return the outcomes of what was required: without limits that are none."""
    return [
        one for one in result.outcomes
        if not isinstance(one.bound, ObjectiveLimit) or one.bound.is_limit
    ]  # fmt: skip


def outcomes_table(result: SynthesisResult, text: BoundText = bound_label) -> Table:
    """Return the requirements at a robot with their worst values and margins."""
    found = tuple(
        Row(
            (
                text(one.bound), "active" if one.active else "",
                _worst(one.value, one.bound), _margin(one.margin, one.bound),
            ),
            # One before it is broken already where there is no margin.
            level="none" if math.isnan(one.margin) else "ok" if one.margin >= 0 else "bad",
        )
        for one in _required(result)
    )  # fmt: skip
    caption = "Requirements at the best robot that was found; active ones decide it."
    return Table(("Requirement", "Decides", "Worst value", "Margin"), found, caption, words=2)


def inner_blocks(result: SynthesisResult) -> list[Block]:
    """Return the masses and springs that were chosen for the lengths; nothing where none were."""
    if result.inner is None:
        return []
    inner = result.inner
    chosen = [
        (f"counterweight on {weight.place}", format_value(weight.mass, "kg"))
        for weight in inner.design.counterweights
    ]
    chosen += [
        (
            f"spring from {spring.first.name} to {spring.second.name}",
            f"{format_value(spring.stiffness, 'N/m')}, free length "
            f"{format_value(spring.free_length, 'm')}",
        )
        for spring in inner.springs
    ]
    costly = [item for item in inner.active if item.price > 0]
    chosen += [
        (
            f"{item.name}, {item.side} {number(item.bound, 6)} {unit_text(item.unit)}",
            f"price {number(item.price)} per {unit_text(item.unit)}",
        )
        for item in costly
    ]
    caption = (
        "Masses and springs for these lengths are the best; others are better by "
        f"{number(inner.gap, 2)} at most."
    )
    return [Table(("What", "Value"), rows(*chosen), caption, words=2)]


def front_blocks(case: SynthesisCase, front: DesignFront) -> list[Block]:
    """Return the robots of a front, with the lengths that the case may change."""
    entries = [find_objective(name) for name in front.objectives]
    paths = [path for path in case.paths if path.startswith("geometry.")]
    cells = (
        (
            str(place),
            *(format_value(v, e.unit) for v, e in zip(point.values, entries, strict=True)),
            *(number(point.result.design.value(path)) for path in paths),
        )
        for place, point in enumerate(front.points, 1)
    )
    text = (
        f"{counted(len(front.points), 'Pareto-optimal robot')} by "
        f"{counted(front.searches, 'search', 'searches')}; {front.dominated} dominated, "
        f"{front.failed} without a robot."
    )
    head = ("", *(entry.label for entry in entries), *(path.partition(".")[2] for path in paths))
    blocks: list[Block] = [Table(head, rows(*cells), text)]
    for place, point in enumerate(front.points, 1):
        blocks += [Note(f"Robot {place}"), *buildability_blocks(point.result)]
    return blocks


def buildability_blocks(result: SynthesisResult) -> list[Table | Note]:
    """Return whether the robot can be built as it is drawn, beside the one before."""
    if result.buildability is None:
        return []
    table = buildability_table(*result.buildability)
    return [table] if result.case.clear else [Note(OVERLAP_ALLOWED, "warn"), table]


def buildability_table(found: Buildability, reference: Buildability) -> Table:
    """Return the table of a robot beside the one before; what is a fault of the robot is marked."""

    def value(number: float, unit: str) -> str:
        return format_value(number, unit) if math.isfinite(number) else NONE

    def share(number: float) -> str:
        return percent(number, digits=3) if math.isfinite(number) else NONE

    def length(own: float, needed: float) -> str:
        return f"{value(own, 'm')}, needed {value(needed, 'm')}"

    def both(one: Buildability) -> str:
        return " and ".join(one.bodies) if one.bodies[0] else NONE

    def row(what: str, text: Callable[[Buildability], str], fault: bool = False) -> Row:
        own = Cell(text(found), kind="bad" if fault else "plain")
        return Row((what, own, text(reference)), "marked" if fault else "plain")

    overlaps = not found.clearance > 0
    compared = (
        row("Least clearance as drawn", lambda b: value(b.clearance, "m"), overlaps),
        row("Between", both, overlaps),
        row("Poses that overlap", lambda b: share(b.overlapping), found.overlapping > 0),
        row("Least horizontal stiffness", lambda b: value(b.stiffness, "N/m")),
        row(
            "Least first natural frequency", lambda b: value(b.frequency, "Hz"),
            not math.isfinite(found.frequency),
        ),
        row(
            "Guide B10", lambda b: length(b.guide, b.needed_guide), found.guide < found.needed_guide
        ),
        row(
            "Shaft B2", lambda b: length(b.shaft, b.needed_shaft), found.shaft < found.needed_shaft
        ),
        row("Moving mass", lambda b: value(b.moving_mass, "kg")),
        row("Center of the workspace, z", lambda b: value(b.center[2], "m")),
        row("Poses within reach", lambda b: share(b.within_reach), found.within_reach < 1),
    )  # fmt: skip
    caption = (
        "Whether the robot can be built as it is drawn, over the workspace; marked is what it "
        "cannot be with."
    )
    return Table(("As drawn", "Found", "Before"), compared, caption)


def relaxed_blocks(result: SynthesisResult, text: BoundText = bound_label) -> list[Table | Note]:
    """Return which single requirement would have to give way, and how far."""
    possible = [item for item in result.relaxed if math.isfinite(item.nearest)]
    if not possible:
        problem = "Relaxing a single one of the requirements does not help."
        return [Note(problem)] if result.relaxed else []
    found = (
        (
            text(item.bound),
            _worst(item.nearest, item.bound),
            percent(item.change, digits=3, sign=True),
        )
        for item in possible
    )
    caption = "One of these would have to be relaxed, the others kept; the nearest found."
    return [Table(("Requirement", "Possible", "Change"), rows(*found), caption)]


def _worst(value: float, bound: Requirement | ObjectiveLimit) -> str:
    """Return a worst value, or what a bound would have to be, none that is too good by rounding."""
    if not math.isfinite(value):
        return NONE
    if isinstance(bound, Requirement):
        return worst_text(value, bound)
    objective = find_objective(bound.objective)
    return objective.display.format(value, up=not objective.largest)


def _margin(value: float, bound: Requirement | ObjectiveLimit) -> str:
    return _entry(bound).display.format(value, up=False) if math.isfinite(value) else NONE


def _entry(bound: Requirement | ObjectiveLimit) -> Quantity | Objective:
    return bound.entry if isinstance(bound, Requirement) else find_objective(bound.objective)


def lengths_table(before: Design, after: Design, path: str = "") -> Table:
    """Return the lengths and masses that changed; those whose path begins so."""
    caption = "Lengths and masses that changed."
    return changes_table(before, after, ("Before", "Found"), under=path, caption=caption)


def synthesis_data(result: SynthesisResult, seconds: float) -> dict[str, Any]:
    """Return the answer as data for JSON, in SI units."""
    case = result.case
    return {
        "case": case.name,
        "feasible": result.feasible,
        "objective": {"key": case.objective, "value": result.objective},
        "regime": result.regime,
        "refused": {regime.value: reason for regime, reason in result.refused.items()},
        "seed": case.seed,
        "seconds": round(seconds, 3),
        **record(result, "trials", "poses"),
        "workspace_center_m": result.workspace.center,
        "overlap_allowed": not case.clear,
        "buildability": buildability_data(result),
        "design": {
            item.path: result.design.value(item.path)
            for item in stated_parameters(result.design)
        },
        "requirements": [
            {
                "text": bound_text(item.bound), "worst": item.value,
                "unit": si_unit(_entry(item.bound).unit),
                **record(item, "margin", "active"),
            }
            for item in _required(result)
        ],
        "relaxed": [
            {"text": bound_text(item.bound), "unit": si_unit(_entry(item.bound).unit)}
            | record(item, "nearest", "change")
            for item in result.relaxed
        ],
        "proof": result.proof and result.proof.verdict,
    }  # fmt: skip


def front_data(case: SynthesisCase, front: DesignFront, seconds: float) -> dict[str, Any]:
    """Return a front as data for JSON, in SI units."""
    return {
        "case": case.name, "overlap_allowed": not case.clear, "seed": case.seed,
        "seconds": round(seconds, 3),
        **record(front, "objectives", "dominated", "searches", "failed", "canceled"),
        "points": [
            {
                "values": point.values,
                "numbers": {p: point.result.design.value(p) for p in case.paths if "geometry" in p},
                "workspace_center_m": point.result.workspace.center,
                "buildability": buildability_data(point.result),
            }
            for point in front.points
        ],
    }  # fmt: skip


def buildability_data(result: SynthesisResult) -> dict[str, Any] | None:
    """Return whether the robot and the reference can be built, as data for JSON, in SI units."""
    if result.buildability is None:
        return None
    names = ("robot", "reference")
    return dict(zip(names, map(_buildability, result.buildability), strict=True))


def _buildability(found: Buildability) -> dict[str, Any]:
    return {
        "workspace_center_m": found.center,
        **record(found, "within_reach", "clearance_m"),
        "nearest_bodies": found.bodies,
        "nearest_at": found.worst,
        "overlapping": found.overlapping,
        "stiffness_horizontal_N_per_m": found.stiffness,
        "frequency_1_Hz": found.frequency,
        **record(found, "guide_m", "needed_guide_m", "shaft_m", "needed_shaft_m", "moving_mass_kg"),
    }
