"""Requirements: which hold, the volume, the largest proven workspace; and the robot of a search."""

from __future__ import annotations

import math

from paminsa_viz.errors import PaminsaError
from paminsa_viz.model.design import PARAMETER, Design
from paminsa_viz.quantities.requirement_text import requirement_label
from paminsa_viz.quantities.requirements import Requirement, Requirements, Workspace, WorkspaceShape
from paminsa_viz.report.blocks import Block, Note, Row, Section, Table
from paminsa_viz.synthesis.proof.evidence import Evidence
from paminsa_viz.synthesis.proof.largest import largest_workspace
from paminsa_viz.synthesis.search.objectives import find_objective
from paminsa_viz.synthesis.search.result import BoundOutcome, SynthesisResult
from paminsa_viz.synthesis.volume.check import Over, RequirementsCheck, check_requirements
from paminsa_viz.synthesis.volume.solve import Volume, solve_volume
from paminsa_viz.units import NONE, format_value, number, percent_change

TIME_LIMIT = 10.0
"""How long the proof of the largest workspace may take [s]."""

LITERS = 1e3
"""Cubic decimeters in a cubic meter."""

_OVER = {
    Over.WORKSPACE: "over the required workspace",
    Over.VOLUME: "over the volume where all hold",
    Over.BEST: "each at the position that is best for it, as no position meets all",
}


def requirements_section(design: Design, requirements: Requirements) -> Section:
    """Return the section."""
    volume = solve_volume(design, requirements)
    check = check_requirements(design, requirements, fine=True, volume=volume)
    blocks = [*_checks(check, requirements), *_volume(volume), *_largest(design, requirements)]
    return Section("requirements", "Requirements", tuple(blocks))


def workspace_text(workspace: Workspace) -> str:
    """Return a workspace for people: shape, sizes and center."""
    x, y, z = (number(1e3 * extent) for extent in workspace.size)
    if workspace.shape is WorkspaceShape.CYLINDER:
        text = f"cylinder ⌀ {x} × {z} mm"
    else:
        text = f"box {x} × {y} × {z} mm"
    places = zip("xyz", workspace.center, strict=True)
    center = [
        f"{name} {'free' if place is None else format_value(place, 'm')}" for name, place in places
    ]
    return f"{text} about {', '.join(center)}"


def _checks(check: RequirementsCheck, requirements: Requirements) -> list[Block]:
    low, high = (format_value(end, "rad") for end in requirements.theta)
    rows = []
    for item in check.items:
        pose = NONE
        if item.pose is not None:
            x, y, theta, z = (round(value, 9) for value in item.pose)  # no rounding errors
            place = (format_value(value, "m", 3) for value in (x, y, z))
            pose = f"({', '.join(place)}), {format_value(theta, 'rad', 3)}"
        values = (format_value(value, item.unit) for value in (item.value, item.margin))
        rows.append(
            Row(
                (item.label, "holds" if item.holds else item.reason or "broken", *values, pose),
                "plain" if item.holds else "marked",
            )
        )
    caption = (
        f"Worst values {_OVER[check.over]}, from θ {low} to {high}; the poses are (x, y, z), θ."
    )
    head = ("Requirement", "Verdict", "Worst value", "Margin", "Pose")
    blocks: list[Block] = []
    if requirements.workspace is not None:
        blocks.append(Note(f"Required workspace: {workspace_text(requirements.workspace)}."))
    verdict = (
        ("All requirements hold.", "ok") if check.holds else ("A requirement is broken.", "bad")
    )
    return [*blocks, Table(head, tuple(rows), caption, words=2), Note(verdict[0], verdict[1])]  # type: ignore[arg-type]


def _volume(volume: Volume) -> list[Block]:
    if volume.empty:
        return [Note("The volume where all requirements hold is empty.", "bad")]
    share = f"{100 * volume.utilization:.1f} %" if math.isfinite(volume.utilization) else NONE
    text = (
        f"All requirements hold in {number(LITERS * volume.volume)} dm³ "
        f"(± {number(LITERS * volume.error, 2)} dm³), {share} of the "
        f"{number(LITERS * volume.reachable_volume)} dm³ that can be reached with every heading "
        "from home without a singularity between."
    )
    bounds = volume.requirements.bounds
    if not bounds:
        return [Note(text)]
    rows = [
        Row((requirement_label(bound), _percent(alone), _percent(last)))
        for bound, alone, last in zip(
            bounds, volume.removed_alone.tolist(), volume.removed_last.tolist(), strict=True
        )
    ]
    caption = "What each requirement takes off the reachable volume: by itself, and only it."
    return [Note(text), Table(("Requirement", "Alone", "Only it"), tuple(rows), caption)]


def _percent(share: float) -> str:
    return f"{100 * share:.1f} %"


def _largest(design: Design, requirements: Requirements) -> list[Block]:
    if requirements.workspace is None or not requirements.bounds:
        return []
    try:
        found = largest_workspace(design, requirements, time_limit=TIME_LIMIT)
    except PaminsaError as error:
        return [Note(f"The largest workspace is not known: {error}.", "warn")]
    if found.workspace is None:
        return [Note("No workspace of this shape is proven about this center.", "warn")]
    text = (
        "The largest workspace of its proportions that is proven: "
        f"{workspace_text(found.workspace)}. "
        f"A pose that breaks a requirement is within {format_value(found.gap, 'm', 2)} of its size."
    )
    rows = tuple(Row(_evidence(item)) for item in found.proof.evidence)
    caption = "What the proof of the largest workspace rests on."
    return [
        Note(text),
        Table(("Requirement", "Verdict", "By", "Worst value"), rows, caption, words=3),
    ]


def _evidence(item: Evidence) -> tuple[str, ...]:
    label, unit = item.name, "m"
    if item.requirement is not None:
        label, unit = requirement_label(item.requirement), item.requirement.entry.unit
    return label, item.verdict.value, item.method.value, format_value(float(item.bound), unit)


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
