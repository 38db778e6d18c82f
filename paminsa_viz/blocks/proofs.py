"""Proofs of requirements over a workspace, and the largest one that is proven."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any, Literal

from paminsa_viz.blocks.data import record, robot
from paminsa_viz.blocks.kinds import Block, Note, Row, Table
from paminsa_viz.model.design import Design
from paminsa_viz.quantities.requirement_text import (
    RequirementText,
    headings_text,
    requirement_label,
    requirement_text,
    workspace_text,
    worst_text,
)
from paminsa_viz.quantities.requirements import Requirements
from paminsa_viz.synthesis.proof.evidence import Evidence, Proof, Verdict
from paminsa_viz.synthesis.proof.families import Method
from paminsa_viz.synthesis.proof.largest import LargestWorkspace
from paminsa_viz.units import counted, format_pose, format_value, rounded_to_side, si_unit

_PROPERTIES = {
    "reach": "reachable: margin to every limit",
    "singularity": "no singular pose: distance to them",
    "home": "joined to home",
}
"""What is proven besides the requirements."""


def verdict_text(proof: Proof) -> str:
    """Return what a proof came to as a whole, and whether it leaves requirements out."""
    if proof.verdict is Verdict.PROVEN and proof.sampled:
        return "proven, but for requirements that are only sampled"
    return proof.verdict.value


_LEVELS: dict[Verdict, Literal["ok", "warn"]] = {Verdict.PROVEN: "ok", Verdict.SAMPLED: "warn"}


def evidence_table(proof: Proof, text: RequirementText = requirement_label) -> Table:
    """Return what a proof rests on, with the worst values, ``≤`` where a bound is proven."""
    rows = []
    for item in proof.evidence:
        label = _PROPERTIES.get(item.name, item.name)
        if item.requirement is not None:
            label = text(item.requirement)
        cells = (label, item.verdict.value, item.method.value, _worst(item))
        rows.append(Row(cells, level=_LEVELS.get(item.verdict, "bad")))
    head = ("Requirement", "Verdict", "By", "Worst value")
    return Table(head, tuple(rows), "What the proof rests on.", words=3)


def _worst(item: Evidence) -> str:
    bound = item.requirement
    if not math.isfinite(item.margin):
        return ""
    if bound is None:
        return worst_text(item.margin, None)
    if math.isnan(item.bound):
        return f"margin {format_value(item.margin, bound.entry.unit, up=False)}"
    proven = item.method is not Method.SAMPLED and item.verdict is Verdict.PROVEN
    sign = ("≤ " if bound.low is None else "≥ ") if proven else ""
    return sign + worst_text(item.bound, bound)


_MORE_TIME = "more time may decide it"


def proof_blocks(
    requirements: Requirements, proof: Proof, text: RequirementText = requirement_label, *,
    advice: str = _MORE_TIME,
) -> list[Block]:  # fmt: skip
    """Return what a proof over the required workspace came to, and what it rests on.

    Args:
        requirements: What had to be proven.
        proof: The proof.
        text: How requirements are written.
        advice: What may decide a proof that boxes are left of.
    """
    kind = "ok" if proof.verdict is Verdict.PROVEN else "bad"
    blocks: list[Block] = [
        Note(f"Requirements over the {_place(requirements)}: {verdict_text(proof)}", kind),
        evidence_table(proof, text),
    ]
    if proof.pose is not None:
        blocks.append(Note(f"broken at {format_pose(proof.pose)}"))
    blocks.append(Note(f"{_effort(proof)}; {len(proof.remaining):,} open"))
    if proof.verdict is Verdict.UNDECIDED and len(proof.remaining):  # a path from home needs none
        blocks.append(Note(advice))
    return blocks


def largest_blocks(
    requirements: Requirements, found: LargestWorkspace,
    text: RequirementText = requirement_label, *, advice: str = _MORE_TIME,
) -> list[Table | Note]:  # fmt: skip
    """Return the largest proven workspace, what ends it, and what its proof rests on.

    Args:
        requirements: What has to hold over it.
        found: The answer.
        text: How requirements are written.
        advice: What may decide a search that has proven nothing yet.
    """
    if found.workspace is None:
        undecided = found.proof.verdict is Verdict.UNDECIDED
        why = "undecided" if undecided else "none"
        head = Note(f"Largest workspace: {why}{_cause(found, text)}", "bad")
        if undecided:  # a path from home is looked for once, however long the search
            return [head] if found.cause == "home" else [head, Note(advice)]
        place = requirements.workspace
        if place and None in place.center and found.cause not in ("home", "volume"):
            other = "about every other center that was tried a requirement breaks as well"
            return [head, Note(other)]
        return [head]
    # what is told is no larger than what is proven, and no smaller than what breaks
    size, beyond = (
        tuple(rounded_to_side(extent, 4, up=up) for extent in extents)
        for extents, up in ((found.workspace.size, False), (found.limit, True))
    )
    place = _place(replace(requirements, workspace=replace(found.workspace, size=size)))
    limit = workspace_text(replace(found.workspace, size=beyond))
    sampled = bool(found.proof.sampled)
    what = "Largest workspace by proof and samples" if sampled else "Largest proven workspace"
    blocks: list[Table | Note] = [
        Note(f"{what}: {place}", "warn" if sampled else "ok"),
        Note(f"gap {format_value(found.gap, 'm', 3)} to {limit}{_cause(found, text)}"),
        evidence_table(found.proof, text),
        Note(_effort(found)),
    ]
    if sampled:
        doubt = "what is only sampled is not proven: a pose between samples may break it"
        blocks.append(Note(f"{doubt}, whatever the gap", "warn"))
    return blocks


def _effort(found: Proof | LargestWorkspace) -> str:
    return f"{counted(found.boxes, 'box', 'boxes')}, {found.seconds:.1f} s"


def _place(requirements: Requirements) -> str:
    assert requirements.workspace is not None
    return f"{workspace_text(requirements.workspace)}, {headings_text(requirements)}"


def _cause(found: LargestWorkspace, text: RequirementText) -> str:
    if found.cause == "home":
        return ": no path from home to its center"
    if found.cause == "volume":
        return ": no position meets all requirements"
    name = found.cause if found.requirement is None else text(found.requirement)
    if not name:
        return ""
    place = "" if found.pose is None else f" breaks at {format_pose(found.pose)}"
    return f": {name}{place}"


def proof_data(proof: Proof) -> dict[str, Any]:
    """Return a proof for other programs, in SI units."""
    region = proof.region
    return {
        "verdict": proof.verdict.name.lower(),
        **record(region, "shape", "center_m", "theta_rad"),
        "size_m": [2 * half for half in region.half],
        "evidence": [
            {
                "requirement": _evidence_text(item),
                "method": item.method.name.lower(),
                "verdict": item.verdict.name.lower(),
                "unit": "m" if item.requirement is None else si_unit(item.requirement.entry.unit),
                **record(item, "margin", "pose", "boxes"),
            }
            for item in proof.evidence
        ],
        "path_from_home": proof.path,
        "open_boxes": len(proof.remaining),
        **record(proof, "boxes", "seconds"),
    }


def _evidence_text(item: Evidence) -> str:
    return item.name if item.requirement is None else requirement_text(item.requirement)


def largest_data(design: Design, found: LargestWorkspace) -> dict[str, Any]:
    """Return the largest proven workspace for other programs, in SI units."""
    return {
        **robot(design),
        "found": found.workspace is not None,
        **record(found, "gap_m", "limit_m", "cause"),
        "broken": None if found.requirement is None else requirement_text(found.requirement),
        "pose_outside": found.pose,
        **proof_data(replace(found.proof, boxes=found.boxes, seconds=found.seconds)),
    }
