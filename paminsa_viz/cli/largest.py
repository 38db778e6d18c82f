"""``paminsa-viz requirements largest`` and ``prove``: workspaces with a proof."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Annotated, Any, Literal

import tyro

from paminsa_viz.blocks.requirements import evidence_table, verdict_text, workspace_text
from paminsa_viz.cli.arguments import UsageError
from paminsa_viz.cli.flags import JsonFlags
from paminsa_viz.cli.output import ascii_numbers, print_blocks, print_json, record
from paminsa_viz.cli.requirement_flags import RequirementFlags
from paminsa_viz.model.design import Design
from paminsa_viz.quantities.requirement_text import requirement_text
from paminsa_viz.quantities.requirements import Requirements
from paminsa_viz.synthesis.proof.certificate import prove
from paminsa_viz.synthesis.proof.evidence import Evidence, Proof, Verdict
from paminsa_viz.synthesis.proof.largest import LargestWorkspace, largest_workspace
from paminsa_viz.synthesis.proof.regions import Growth
from paminsa_viz.units import MM, format_ascii, format_pose

_GROWTH = {"all": Growth.ALL, "horizontal": Growth.HORIZONTAL, "vertical": Growth.VERTICAL}


@dataclass(frozen=True, kw_only=True)
class Prove(JsonFlags, RequirementFlags):
    """Prove that all requirements hold over the workspace, or find a pose where one does not.

    Its center has to be given. Exit code 1 if one is broken or undecided; one that can only be
    sampled, see docs/largest-workspace.md, is named and does not change it."""

    time: Annotated[float, tyro.conf.arg(metavar="S")] = 15.0
    """Time after which to answer that it is undecided."""

    def run(self) -> int:
        """Prove and print."""
        design, requirements = self.given()
        _check_time(self.time)
        if requirements.workspace is None:
            raise UsageError("a workspace is needed: --cylinder or --box, or that of a design file")
        if None in requirements.workspace.center:
            raise UsageError("--center: a proof needs three numbers; 'largest' finds a center")
        proof = prove(design, requirements, time_limit=self.time)
        if self.json:
            print_json({"design": design.name, **_proof_data(proof)})
        else:
            print(f"{design.name}, {_place(requirements)}: {verdict_text(proof)}")
            print_blocks([evidence_table(proof, requirement_text)])
            if proof.pose is not None:
                print(f"broken at {format_pose(proof.pose, ascii_only=True)}")
            print(f"{proof.boxes:,} boxes, {proof.seconds:.1f} s; {len(proof.remaining):,} open")
        return 0 if proof.verdict is Verdict.PROVEN else 1


@dataclass(frozen=True, kw_only=True)
class Largest(JsonFlags, RequirementFlags):
    """Find the largest workspace of a shape over which all requirements are proven.

    The sizes of --cylinder or --box are its proportions. Exit code 1 if there is none."""

    grow: Literal["all", "horizontal", "vertical"] = "all"
    """Which extents grow; the others are kept."""
    tolerance: Annotated[float, tyro.conf.arg(metavar="MM")] = 1.0
    """Gap between what is proven and a pose that breaks a requirement, at which to stop."""
    time: Annotated[float, tyro.conf.arg(metavar="S")] = 15.0
    """Time after which to stop; the gap is then what it is."""
    both_sides: bool = False
    """A free height may be on the other side of the guides than home."""

    def run(self) -> int:
        """Search and print."""
        design, requirements = self.given()
        _check_time(self.time)
        if not (math.isfinite(self.tolerance) and self.tolerance > 0.0):
            raise UsageError(f"--tolerance: a number above 0 is needed, not {self.tolerance}")
        if requirements.workspace is None:
            raise UsageError("a shape is needed: --cylinder or --box, or that of a design file")
        found = largest_workspace(
            design,
            requirements,
            growth=_GROWTH[self.grow],
            tolerance=self.tolerance / MM,
            time_limit=self.time,
            both_sides=self.both_sides,
        )
        if self.json:
            print_json(_largest_data(design, found))
        else:
            _print_largest(design, requirements, found)
        return 1 if found.workspace is None else 0


def _check_time(time: float) -> None:
    if not (math.isfinite(time) and time > 0.0):
        raise UsageError(f"--time: a number of seconds above 0 is needed, not {time}")


def _print_largest(design: Design, requirements: Requirements, found: LargestWorkspace) -> None:
    if found.workspace is None:
        undecided = found.proof.verdict is Verdict.UNDECIDED
        why = "undecided in this time" if undecided else "none"
        print(f"{design.name}, largest workspace: {why}{_cause(found)}")
        return
    place = _place(replace(requirements, workspace=found.workspace))
    print(f"{design.name}, largest proven workspace: {place}")
    limit = workspace_text(replace(found.workspace, size=found.limit))
    print(ascii_numbers(f"gap {MM * found.gap:.3g} mm to {limit}{_cause(found)}"))
    print_blocks([evidence_table(found.proof, requirement_text)])
    print(f"{found.boxes:,} boxes, {found.seconds:.1f} s")
    if found.proof.sampled:
        print("what is only sampled is not proven")


def _place(requirements: Requirements) -> str:
    assert requirements.workspace is not None
    low, high = (format_ascii(angle, "rad") for angle in requirements.theta)
    text = f"{workspace_text(requirements.workspace)}, theta {low} to {high}"
    return ascii_numbers(text)


def _cause(found: LargestWorkspace) -> str:
    if found.cause == "home":
        return ": no path from home to its center"
    if found.cause == "volume":
        return ": no position meets all requirements"
    name = found.cause if found.requirement is None else requirement_text(found.requirement)
    if not name:
        return ""
    place = "" if found.pose is None else f" breaks at {format_pose(found.pose, ascii_only=True)}"
    return f": {name}{place}"


def _proof_data(proof: Proof) -> dict[str, Any]:
    """Return a proof for other programs, in SI units."""
    region = proof.region
    return {
        "verdict": proof.verdict.name.lower(),
        **record(region, "shape", "center_m", "theta_rad"),
        "size_m": [2 * half for half in region.half],
        "evidence": [
            {
                "requirement": _text(item),
                "method": item.method.name.lower(),
                "verdict": item.verdict.name.lower(),
                **record(item, "margin", "pose", "boxes"),
            }
            for item in proof.evidence
        ],
        "path_from_home": proof.path,
        "open_boxes": len(proof.remaining),
        **record(proof, "boxes", "seconds"),
    }


def _text(item: Evidence) -> str:
    return item.name if item.requirement is None else requirement_text(item.requirement)


def _largest_data(design: Design, found: LargestWorkspace) -> dict[str, Any]:
    return {
        "design": design.name,
        "found": found.workspace is not None,
        **record(found, "gap_m", "limit_m", "cause"),
        "broken": None if found.requirement is None else requirement_text(found.requirement),
        "pose_outside": found.pose,
        **_proof_data(replace(found.proof, boxes=found.boxes, seconds=found.seconds)),
    }
