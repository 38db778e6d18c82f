"""Texts of the tab *Requirements*: the list with its margins, and a line for the strip."""

from __future__ import annotations

from typing import Any

from paminsa_viz.blocks.requirements import (
    check_row,
    over_text,
    removed_texts,
    share_text,
    size_text,
)
from paminsa_viz.explorer.core.causes import CauseGroup, cause_groups
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.core.requirements import current_check, current_volume, last_check
from paminsa_viz.explorer.core.saved_requirements import asked
from paminsa_viz.explorer.features.requirements.actions import End, ends_of
from paminsa_viz.explorer.kit.robot_texts import gray_if, margin_level, margin_share
from paminsa_viz.explorer.kit.text import render
from paminsa_viz.explorer.state.requirements import VolumeResult
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model.arrays import Pose
from paminsa_viz.quantities.requirement_text import ranges_label, requirement_label
from paminsa_viz.quantities.requirements import Requirement, Requirements
from paminsa_viz.synthesis.volume.check import RequirementsCheck
from paminsa_viz.synthesis.volume.solve import Volume
from paminsa_viz.synthesis.volume.workspace import RequirementCheck

AMPLE = 0.1
"""Margin of reach, and distance from singularities, of a full bar [m]."""


def names(state: State) -> dict[str, int]:
    """Return the requirements of a state by short texts."""
    bounds = state.document.requirements.bounds
    return {f"{i + 1}: {requirement_label(one)}": i for i, one in enumerate(bounds)}


def share(item: RequirementCheck, requirements: Requirements) -> float:
    """Return a margin over the size of its bound, -1 to 1."""
    bound = None if item.requirement is None else requirements.bounds[item.requirement]
    return margin_share(item.margin, AMPLE if bound is None else bound.size)


def level(item: RequirementCheck, requirements: Requirements) -> tuple[str, str]:
    """Return the mark of a requirement and the class of its color."""
    if not item.holds:
        return "✗", "pv-bad"
    return "✓", margin_level(share(item, requirements))


def _fields(requirement: Requirement) -> dict[str, dict[str, str]]:
    """Return the boxes of a requirement's numbers, by what they are."""
    unit = requirement.entry.display
    return {
        end.value: {"text": f"{unit.from_si(value):.6g}".replace("-", "−"), "name": FIELDS[end]}
        for end, value in ends_of(requirement).items()
    }


FIELDS = {End.LOW: "at least", End.HIGH: "at most", End.SIZE: "magnitude at most"}
"""What the numbers of a requirement are, for screen readers."""


ALWAYS = ("reach", "singularity")
"""What is checked before all requirements."""

UNCHECKED = "Not checked yet since the last change"
"""Where a check waits, or what it said is behind."""


def _named(label: str) -> dict[str, Any]:
    """Return the row of something of which nothing is known."""
    return {
        "index": -1, "place": label, "text": label, "mark": "", "level": "", "reason": "",
        "worst": "…", "margin": "", "pose": "",
    }  # fmt: skip


def _bound(index: int, bound: Requirement) -> dict[str, Any]:
    """Return the row of a requirement of which nothing else is known."""
    return _named("") | {
        "index": index, "place": index,
        "symbol": bound.entry.symbol, "unit": bound.entry.display.text,
        "fields": _fields(bound), "ranges": ranges_label(bound),
    }  # fmt: skip


def _row(item: RequirementCheck, requirements: Requirements) -> dict[str, Any]:
    mark, name = level(item, requirements)
    index = item.requirement
    row = _named(item.label) if index is None else _bound(index, requirements.bounds[index])
    _, _, worst, margin, pose = check_row(item, requirements).cells
    return row | {
        "mark": mark, "level": name, "reason": item.reason,
        "worst": worst, "margin": f"margin {margin}", "share": share(item, requirements),
        "pose": "" if item.pose is None else pose,
    }  # fmt: skip


def list_html(frame: Frame) -> str:
    """Return the list of the requirements with their worst values and margins.

    Until they are known, and where they cannot be, it has the bounds alone, which can be changed.
    """
    state = frame.state
    requirements, check = state.document.requirements, current_check(state)
    rows, note = [], ""
    if check is not None:
        rows = [_row(item, requirements) for item in check.items]
        note = f"{note_of(state, check)}. Click a worst value to go there."
    elif asked(requirements):
        bounds = [_bound(*each) for each in enumerate(requirements.bounds)]
        rows = [*map(_named, ALWAYS), *bounds]
        known = current_volume(state)
        note = f"{UNCHECKED}." if known is None else known.problem
    return render("requirements/list.j2", rows=rows, chosen=state.requirements.selected, note=note)


def note_of(state: State, check: RequirementsCheck) -> str:
    """Return what a check is over, and how fine."""
    known = state.requirements.fine
    result = None if known is None else known.result
    fine = "finely sampled" if result and result.check is check else "coarsely sampled"
    return f"{over_text(check, state.document.requirements)}, {fine}"


def worst_pose(state: State, place: str) -> Pose | None:
    """Return the worst pose of a requirement, by its index or the name of what comes before it."""
    check = current_check(state)
    items = () if check is None else check.items
    return next((i.pose for i in items if place in (i.label, str(i.requirement))), None)


def strip_html(state: State) -> str:
    """Return which requirements hold, as a line for the strip; nothing without any.

    Until the check after a change is there, the line stays as it was, in gray.
    """
    requirements, check = state.document.requirements, current_check(state)
    stale = check is None
    if check is None:
        last = last_check(state)
        if last is None:
            return ""
        check, requirements = last
    items = []
    for item in check.items:
        symbol = item.label
        if item.requirement is not None:
            symbol = requirements.bounds[item.requirement].entry.symbol
        items.append((*level(item, requirements), symbol))
    note = UNCHECKED if stale else note_of(state, check)
    return gray_if(stale, render("requirements/strip.j2", items=items, note=note))


def volume_html(frame: Frame) -> str:
    """Return the volume where all requirements hold, and what each of them takes off it."""
    state = frame.state
    if not asked(state.document.requirements):
        return ""
    outcome = current_volume(state)
    found = None if outcome is None else outcome.result
    if outcome is None or found is None:
        problem = "" if outcome is None else outcome.problem
        return render("requirements/volume.j2", problem=problem, waiting=outcome is None)
    volume = found.volume
    return render(
        "requirements/volume.j2", problem="", waiting=False, fine=outcome.job.fine,
        volume=size_text(volume), share=share_text(volume),
        searchable=bool(state.document.requirements.bounds), conflict=found.conflict,
        groups=[_group(volume, each) for each in shown_groups(found)],
    )  # fmt: skip


def shown_groups(found: VolumeResult) -> list[CauseGroup]:
    """Return all requirements, and of the other causes those that end the volume somewhere."""
    colors = {part.color for part in found.surface}
    groups, _ = cause_groups(found.volume.causes)
    return [each for each in groups[1:] if each.requirement is not None or each.color in colors]


def _group(volume: Volume, group: CauseGroup) -> dict[str, str]:
    alone = only = ""
    if group.requirement is not None:
        alone, only = removed_texts(volume, group.requirement)
    return {"text": group.text, "color": group.color, "alone": alone, "only": only}
