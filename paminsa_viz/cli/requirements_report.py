"""What ``paminsa-viz requirements check`` prints."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from paminsa_viz import __version__
from paminsa_viz.cli.output import print_table
from paminsa_viz.model.design import Design
from paminsa_viz.quantities.requirement_text import ascii_unit, requirement_text
from paminsa_viz.quantities.requirements import Requirements, WorkspaceShape
from paminsa_viz.synthesis.volume.causes import CauseKind, VolumeCause
from paminsa_viz.synthesis.volume.check import Over, RequirementsCheck
from paminsa_viz.synthesis.volume.conflict import Conflict, VolumeRelaxation
from paminsa_viz.synthesis.volume.solve import Volume
from paminsa_viz.synthesis.volume.surface import volume_surface
from paminsa_viz.synthesis.volume.workspace import RequirementCheck
from paminsa_viz.units import DEGREES, MM, DisplayUnit, format_ascii

LITERS = 1e3
"""Cubic decimeters in a cubic meter."""


@dataclass(frozen=True, eq=False)
class CheckReport:
    """What was found.

    Attributes:
        design, requirements: What was checked.
        found: Which requirements hold.
        conflict: The fewest that contradict, None where that is not known or there are none.
    """

    design: Design
    requirements: Requirements
    found: RequirementsCheck
    conflict: Conflict | None

    def text(self, item: RequirementCheck) -> str:
        """Return an item's requirement as ASCII text."""
        if item.requirement is None:
            return item.label
        return requirement_text(self.requirements.bounds[item.requirement])


def print_check(report: CheckReport) -> None:
    """Print the check as a table, then the volume and what contradicts."""
    low, high = (DEGREES * angle for angle in report.requirements.theta)
    print(f"{report.design.name}, {_over(report)}, theta {low:.4g} to {high:.4g} deg")
    rows = [("", "requirement", "worst", "margin", "at")]
    for item in report.found.items:
        worst = format_ascii(item.value, item.unit) if not math.isnan(item.value) else "-"
        margin = format_ascii(item.margin, item.unit, 3) if math.isfinite(item.margin) else "-"
        where = "" if item.pose is None else _pose(item.pose)
        note = f"  {item.reason}" if item.reason else ""
        rows.append((_mark(item.holds), report.text(item), worst, margin, where + note))
    print_table(rows)
    if report.found.volume is not None:
        _print_volume(report.found.volume)
    if report.conflict is not None:
        _print_conflict(report)


def _print_volume(volume: Volume) -> None:
    """Print a volume, its utilization, and what cuts it."""
    print()
    if volume.empty:
        print("volume: empty")
    else:
        print(
            f"volume: {LITERS * volume.volume:.4g} +- {LITERS * volume.error:.2g} dm^3, "
            f"{100 * volume.utilization:.1f} % of the reachable "
            f"{LITERS * volume.reachable_volume:.4g} dm^3"
        )
        if not volume.home_inside:
            print("home is not in it: the largest connected part that can be reached from home")
    nodes = f"{volume.cause.size:,} nodes {MM * volume.cell:.3g} mm apart"
    print(f"on {nodes}, {volume.headings} headings")
    areas = volume_surface(volume).areas()
    shares = {c: s for c, s in volume.shares().items() if c.kind is not CauseKind.INSIDE}
    rows = [("cut by", "surface", "of reachable volume", "alone", "by it only")]
    for cause in sorted({*areas, *shares}, key=lambda c: (-areas.get(c, 0.0), c.code)):
        index = cause.requirement
        alone, last = "", ""
        if index is not None:
            alone, last = (
                _percent(volume.removed_alone[index]),
                _percent(volume.removed_last[index]),
            )
        surface = _percent(areas[cause] / sum(areas.values())) if cause in areas else ""
        removed = _percent(shares[cause]) if cause in shares else ""
        rows.append((_cause(volume, cause), surface, removed, alone, last))
    if len(rows) > 1:
        print_table(rows, words=1)


def _percent(share: float) -> str:
    return f"{100 * share:.1f} %"


def _cause(volume: Volume, cause: VolumeCause) -> str:
    """Return a cause as text that every terminal shows."""
    if cause.requirement is None:
        return cause.text
    return requirement_text(volume.requirements.bounds[cause.requirement])


def _print_conflict(report: CheckReport) -> None:
    conflict = report.conflict
    assert conflict is not None
    print()
    if not conflict.requirements:
        what = "no pose" if report.requirements.workspace is None else "no place for the workspace"
        print(f"{what} can be reached with every heading, whatever the bounds")
        return
    place = "pose" if report.requirements.workspace is None else "place of the workspace"
    texts = [requirement_text(report.requirements.bounds[i]) for i in conflict.requirements]
    if len(texts) > 1:
        print(f"no {place} meets these together: {'; '.join(texts)}")
    else:
        print(f"no {place} meets {texts[0]}")
    for relaxation in conflict.relaxations:
        print(f"  {_relaxation_text(report, relaxation)}")


def _relaxation_text(report: CheckReport, relaxation: VolumeRelaxation) -> str:
    bound = report.requirements.bounds[relaxation.requirement]
    text = requirement_text(bound)
    if relaxation.relaxed is None or relaxation.by is None:
        return f"{text}: no other bound of it helps"
    by = format_ascii(relaxation.by, bound.entry.unit, 3)
    ends = [
        f"{name} {_rounded(new, bound.entry.display, direction)}"
        for name, old, new, direction in (
            ("at least", bound.low, relaxation.relaxed.low, math.floor),
            ("at most", bound.high, relaxation.relaxed.high, math.ceil),
        )
        if new is not None and new != old
    ]
    return f"{text}: would do with {' and '.join(ends)} (moved by {by})"


def _rounded(value: float, unit: DisplayUnit, direction: Callable[[float], int]) -> str:
    """Return a bound with four digits, rounded to the side on which it still helps."""
    shown = value * unit.factor
    step = 10.0 ** (math.floor(math.log10(abs(shown))) - 3) if shown else 1.0
    return f"{direction(shown / step) * step:.4g} {ascii_unit(unit)}".rstrip()


def _over(report: CheckReport) -> str:
    found, workspace = report.found, report.requirements.workspace
    if workspace is None or found.center is None:
        return f"over the {found.over.value}" if found.over is Over.VOLUME else found.over.value
    x, y, z = (f"{MM * extent:.4g}" for extent in workspace.size)
    size = f"d {x} x {z}" if workspace.shape is WorkspaceShape.CYLINDER else f"{x} x {y} x {z}"
    center = ", ".join(f"{MM * place + 0.0:.4g}" for place in found.center)
    return f"{workspace.shape.value} {size} mm about ({center}) mm"


def _pose(pose: tuple[float, float, float, float]) -> str:
    x, y, theta, z = pose
    lengths = [
        f"{name} {round(MM * value, 1) + 0.0:g}"
        for name, value in zip("xyz", (x, y, z), strict=True)
    ]
    return f"{', '.join(lengths)} mm, theta {round(DEGREES * theta, 2) + 0.0:g} deg"


def _mark(holds: bool) -> str:
    """Return a check mark or a cross, or words where the terminal has none."""
    marks = ("✗", "✓")
    try:
        "".join(marks).encode(sys.stdout.encoding or "ascii")
    except (UnicodeEncodeError, LookupError):
        marks = ("BROKEN", "ok")
    return marks[holds]


def check_data(report: CheckReport) -> dict[str, Any]:
    """Return the check for other programs, in SI units."""
    found = report.found
    data: dict[str, Any] = {
        "made_by": f"paminsa_viz {__version__}",
        "design": report.design.name,
        "holds": report.found.holds,
        "over": found.over.name.lower(),
        "theta": list(report.requirements.theta),
        "center": None if found.center is None else list(found.center),
        "items": [
            {
                "requirement": report.text(item),
                "unit": item.unit,
                "worst": item.value,
                "margin": item.margin,
                "pose": None if item.pose is None else list(item.pose),
                "holds": item.holds,
                "reason": item.reason,
            }
            for item in found.items
        ],
    }
    if (volume := found.volume) is not None:
        data["volume"] = {
            "volume_m3": volume.volume,
            "error_m3": volume.error,
            "reachable_m3": volume.reachable_volume,
            "utilization": volume.utilization,
            "home_inside": volume.home_inside,
            "nodes": list(volume.cause.shape),
            "cell_m": volume.cell,
            "headings": volume.headings,
            "shares": {cause.word: share for cause, share in volume.shares().items()},
            "removed_alone": volume.removed_alone.tolist(),
            "removed_last": volume.removed_last.tolist(),
        }
    if (conflict := report.conflict) is not None:
        data["conflict"] = {
            "requirements": list(conflict.requirements),
            "relaxations": [
                {
                    "requirement": item.requirement,
                    "by": item.by,
                    "low": None if item.relaxed is None else item.relaxed.low,
                    "high": None if item.relaxed is None else item.relaxed.high,
                }
                for item in conflict.relaxations
            ],
        }
    return data
