"""Requirements: which hold, the volume where all do, and the largest proven workspace."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from paminsa_viz.blocks.data import record, robot
from paminsa_viz.blocks.kinds import Block, Note, Row, Table, rows
from paminsa_viz.blocks.proofs import largest_blocks
from paminsa_viz.errors import PaminsaError
from paminsa_viz.model.design import Design
from paminsa_viz.quantities import QUANTITIES
from paminsa_viz.quantities.requirement_text import (
    RequirementText,
    ascii_unit,
    heading_ends,
    headings_text,
    requirement_label,
    requirement_text,
    workspace_text,
    worst_text,
)
from paminsa_viz.quantities.requirements import Requirements
from paminsa_viz.synthesis.proof.largest import largest_workspace
from paminsa_viz.synthesis.volume.causes import CauseKind
from paminsa_viz.synthesis.volume.check import Over, RequirementsCheck, check_requirements
from paminsa_viz.synthesis.volume.conflict import Conflict, VolumeRelaxation
from paminsa_viz.synthesis.volume.solve import Volume, solve_volume
from paminsa_viz.synthesis.volume.surface import volume_surface
from paminsa_viz.synthesis.volume.workspace import RequirementCheck
from paminsa_viz.units import (
    NONE,
    counted,
    format_pose,
    format_value,
    interval_text,
    number,
    percent,
    si_unit,
)

TIME_LIMIT = 10.0
"""How long the proof of the largest workspace may take [s]."""

LITERS = 1e3
"""Cubic decimeters in a cubic meter."""

_OVER = {
    Over.WORKSPACE: "over the required workspace",
    Over.VOLUME: "over the volume where all hold",
    Over.BEST: "each at the position that is best for it, as no position meets all",
}


def requirements_blocks(design: Design, requirements: Requirements) -> list[Block]:
    """Return the verdicts, the volume, and the largest workspace that is proven."""
    volume = solve_volume(design, requirements)
    check = check_requirements(design, requirements, fine=True, volume=volume)
    return [*check_blocks(requirements, check), *_largest(design, requirements)]


def check_blocks(
    requirements: Requirements,
    check: RequirementsCheck,
    conflict: Conflict | None = None,
    text: RequirementText = requirement_label,
) -> list[Block]:
    """Return the verdicts, the volume if it was solved, and the fewest that contradict."""
    blocks = _checks(check, requirements, text)
    if check.volume is not None:
        blocks += _volume(check.volume, text)
    if conflict is not None:
        blocks += conflict_notes(requirements, conflict, text)
    return blocks


def requirements_difference(
    first: Requirements | None, second: Requirements | None, names: tuple[str, str]
) -> list[Block]:
    """Return what one of two files requires alone; nothing where both require the same.

    Args:
        first, second: What the files require; None for nothing.
        names: Headings of their columns.
    """
    held = [required_texts(each) for each in (first, second)]
    found = [
        (text, *("required" if text in each else NONE for each in held))
        for text in dict.fromkeys((*held[0], *held[1]))
        if (text in held[0]) != (text in held[1])
    ]
    return [Table(("Requirement", *names), rows(*found), words=3)] if found else []


def required_texts(requirements: Requirements | None) -> list[str]:
    """Return bounds, headings and workspace as texts; nothing of None."""
    if requirements is None:
        return []
    place = requirements.workspace
    return [
        *map(requirement_text, requirements.bounds),
        f"headings {headings_text(requirements, 10)}",
        *([] if place is None else [f"workspace {workspace_text(place)}"]),
    ]


def _checks(
    check: RequirementsCheck, requirements: Requirements, text: RequirementText
) -> list[Block]:
    head = ("Requirement", "Verdict", "Worst value", "Margin", "Pose")
    found = tuple(check_row(item, requirements, text) for item in check.items)
    blocks: list[Block] = []
    if (workspace := requirements.workspace) is not None:
        if check.center is not None:
            workspace = replace(workspace, center=check.center)
        blocks.append(Note(f"Required workspace: {workspace_text(workspace)}."))
    verdict = Note("All requirements hold.", "ok")
    if not check.holds:
        verdict = Note("A requirement is broken.", "bad")
    table = Table(head, found, f"{over_text(check, requirements)}.", words=2)
    return [*blocks, table, verdict]


def check_row(
    item: RequirementCheck, requirements: Requirements, text: RequirementText = requirement_label
) -> Row:
    """Return a requirement's verdict, worst value, margin, and the pose of the worst value."""
    bound = None if item.requirement is None else requirements.bounds[item.requirement]
    label = item.label if bound is None else text(bound)
    # like the worst value, it never reads as better than it is
    shown = format_value(item.margin, item.unit, 3, up=False)
    margin = shown if math.isfinite(item.margin) else NONE
    verdict = "holds" if item.holds else item.reason or "broken"
    pose = NONE if item.pose is None else format_pose(item.pose)
    cells = (label, verdict, worst_text(item.value, bound), margin, pose)
    return Row(cells, "plain" if item.holds else "marked")


def over_text(check: RequirementsCheck, requirements: Requirements) -> str:
    """Return what the worst values of a check are over."""
    span = "from" if len(heading_ends(requirements)) > 1 else "at"
    return f"Worst values {_OVER[check.over]}, {span} {headings_text(requirements)}"


def _volume(volume: Volume, text: RequirementText) -> list[Block]:
    nodes = (
        f"On {counted(volume.cause.size, 'node')} {format_value(volume.cell, 'm', 3)} apart and "
        f"{counted(volume.sampled_headings, 'heading')}."
    )
    if volume.empty:
        blocks: list[Block] = [
            Note(f"The volume where all requirements hold is empty. {nodes}", "bad")
        ]
    else:
        sentence = (
            f"All requirements hold in {size_text(volume)}, {share_text(volume)} that can be "
            f"reached with every heading from home without a singularity between. {nodes}"
        )
        if not volume.home_inside:
            sentence += " Home is not in it: it is the largest connected part."
        blocks = [Note(sentence)]
    areas = volume_surface(volume).areas()
    shares = {c: s for c, s in volume.shares().items() if c.kind is not CauseKind.INSIDE}
    rows = []
    for cause in sorted({*areas, *shares}, key=lambda c: (-areas.get(c, 0.0), c.code)):
        index = cause.requirement
        removed = ["", ""]
        if index is not None:
            removed = list(removed_texts(volume, index))
        surface = percent(areas[cause] / sum(areas.values()), 1) if cause in areas else ""
        first = percent(shares[cause], 1) if cause in shares else ""
        label = cause.text if index is None else text(volume.requirements.bounds[index])
        rows.append(Row((label, surface, first, *removed)))
    caption = (
        "What ends the volume: share of its surface, of the reachable volume where it is the first "
        "cause, and what each requirement removes without the others, and only it."
    )
    head = ("Cause", "Surface", "Of reachable volume", "Alone", "Only it")
    return [*blocks, Table(head, tuple(rows), caption)] if rows else blocks


def size_text(volume: Volume) -> str:
    """Return a volume with its error, to the same decimal place."""
    return f"{interval_text(LITERS * volume.volume, LITERS * volume.error)} dm³"


def share_text(volume: Volume) -> str:
    """Return its share of the reachable volume."""
    return f"{percent(volume.reachable_share, 1)} of {number(LITERS * volume.reachable_volume)} dm³"


def removed_texts(volume: Volume, requirement: int) -> tuple[str, str]:
    """Return what a requirement takes off the volume without the others, and only it."""
    alone, only = volume.removed_alone[requirement], volume.removed_last[requirement]
    return percent(float(alone), 1), percent(float(only), 1)


def conflict_notes(
    requirements: Requirements, conflict: Conflict, text: RequirementText = requirement_label
) -> list[Note]:
    """Return the fewest requirements that contradict, and which bounds of them would do."""
    free = requirements.workspace is None
    if not conflict.requirements:
        what = "No pose" if free else "No place for the workspace"
        return [Note(f"{what} can be reached with every heading, whatever the bounds.", "bad")]
    place = "pose" if free else "place of the workspace"
    texts = [text(requirements.bounds[i]) for i in conflict.requirements]
    together = "these together: " if len(texts) > 1 else ""
    first = Note(f"No {place} meets {together}{'; '.join(texts)}.", "bad")
    return [first, *(_relaxation(requirements, item, text) for item in conflict.relaxations)]


def _relaxation(requirements: Requirements, item: VolumeRelaxation, text: RequirementText) -> Note:
    bound = requirements.bounds[item.requirement]
    if item.relaxed is None or item.by is None:
        others = " while the others stay as they are" if len(requirements.bounds) > 1 else ""
        return Note(f"{text(bound)}: no other bound of it helps{others}.")
    ends = [
        f"{name} {bound.entry.display.format(new, up=name == 'at most')}"
        for name, old, new in (
            ("at least", bound.low, item.relaxed.low),
            ("at most", bound.high, item.relaxed.high),
        )
        if new is not None and new != old
    ]
    by = format_value(item.by, bound.entry.unit, 3)
    return Note(f"{text(bound)}: would do with {' and '.join(ends)} (moved by {by}).")


def _largest(design: Design, requirements: Requirements) -> list[Block]:
    if requirements.workspace is None or not requirements.bounds:
        return []
    try:
        found = largest_workspace(design, requirements, time_limit=TIME_LIMIT)
    except PaminsaError as error:
        return [Note(f"The largest workspace is not known: {error}.", "warn")]
    return list(largest_blocks(requirements, found))


def check_data(
    design: Design, requirements: Requirements, found: RequirementsCheck, conflict: Conflict | None
) -> dict[str, Any]:
    """Return the check for other programs, in SI units."""
    bounds = requirements.bounds
    data: dict[str, Any] = {
        **robot(design),
        "holds": found.holds,
        "over": found.over.name.lower(),
        "theta_rad": requirements.theta,
        "center_m": found.center,
        "items": [
            {
                "requirement": item.label
                if item.requirement is None
                else requirement_text(bounds[item.requirement]),
                "worst": item.value,
                "unit": si_unit(item.unit),
                **record(item, "margin", "pose", "holds", "reason"),
            }
            for item in found.items
        ],
    }
    if (volume := found.volume) is not None:
        data["volume"] = {
            "reachable_m3": volume.reachable_volume,
            "nodes": volume.cause.shape,
            "headings": volume.sampled_headings,
            "shares": {cause.word: share for cause, share in volume.shares().items()},
            **record(
                volume,
                "volume_m3",
                "error_m3",
                "reachable_share",
                "home_inside",
                "cell_m",
                "removed_alone",
                "removed_last",
            ),
        }
    if conflict is not None:
        data["conflict"] = {
            "requirements": conflict.requirements,
            "relaxations": [
                {
                    **record(item, "requirement", "by"),
                    "low": None if item.relaxed is None else item.relaxed.low,
                    "high": None if item.relaxed is None else item.relaxed.high,
                }
                for item in conflict.relaxations
            ],
        }
    return data


def quantities_table() -> Table:
    """Return the quantities that can be bounded, and the units of their bounds."""
    cells = ((key, ascii_unit(entry.display), entry.title) for key, entry in QUANTITIES.items())
    return Table(("Quantity", "Unit", ""), rows(*cells), words=3)


def quantities_data() -> dict[str, Any]:
    """Return the quantities that can be bounded for other programs."""
    return {
        entry.key: record(entry, "symbol", "title") | {"unit": si_unit(entry.unit)}
        for entry in QUANTITIES.values()
    }
