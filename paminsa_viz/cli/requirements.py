"""``paminsa-viz requirements``: what a robot is needed for, checked."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import tyro

from paminsa_viz.blocks.kinds import Table, rows
from paminsa_viz.blocks.requirements import check_blocks
from paminsa_viz.cli.arguments import UsageError
from paminsa_viz.cli.flags import JsonFlags, check_output
from paminsa_viz.cli.largest import Largest, Prove
from paminsa_viz.cli.output import print_blocks, print_json, print_written, record
from paminsa_viz.cli.requirement_flags import RequirementFlags
from paminsa_viz.files.atomic import write_bytes
from paminsa_viz.model.design import Design
from paminsa_viz.quantities import QUANTITIES
from paminsa_viz.quantities.requirement_text import (
    EXAMPLE,
    ascii_unit,
    requirement_text,
)
from paminsa_viz.quantities.requirements import Requirements
from paminsa_viz.synthesis.volume.check import RequirementsCheck, check_requirements
from paminsa_viz.synthesis.volume.conflict import Conflict, smallest_conflict
from paminsa_viz.synthesis.volume.grid import COARSE, FINE
from paminsa_viz.synthesis.volume.solve import solve_volume
from paminsa_viz.synthesis.volume.surface import VOLUME_FORMATS, volume_bytes

DESCRIPTION = """\
Requirements: bounds on quantities, headings and a workspace, of a design file or as text.

  paminsa-viz requirements check robot.toml             those of the file
  paminsa-viz requirements check --require "condition <= 10" --require "|tau_1| <= 15 N m"
                                 --theta -30 30 --cylinder 300 400
  paminsa-viz requirements check robot.toml --volume --out volume.stl --out volume.csv
  paminsa-viz requirements largest robot.toml --cylinder 300 400
  paminsa-viz requirements prove robot.toml --cylinder 300 400 --center 0 0 -600
  paminsa-viz requirements quantities                   what can be bounded, and its unit

A requirement is "QUANTITY <= NUMBER", with >= or |QUANTITY| as well, a unit, and ranges such as
"for theta -30..30, z -900..-500" (degrees, millimeters) if it holds only over these. Poses have to
be reachable and free of singularities with every heading. See docs/requirements.md.

Exit code of check: 0 all requirements hold; 1 one is broken, or the volume is empty; 2 a wrong
argument or file."""


@dataclass(frozen=True, kw_only=True)
class CheckRequirements(JsonFlags, RequirementFlags):
    """Say which requirements hold, with margins and the worst poses; exit code 1 if one does not.

    Over the required workspace; without one, over the volume where all hold."""

    volume: bool = False
    """Solve the volume where all requirements hold: dm^3, utilization, and what cuts it."""
    both_sides: bool = False
    """Heights on the other side of the guides count as well."""
    coarse: bool = False
    """Sample coarsely: some ten milliseconds instead of a second."""
    out: Annotated[tuple[Path, ...], tyro.conf.arg(metavar="FILE")] = ()
    """File for the volume: its surface as .stl [mm] or .glb, its nodes as .csv or .npz; may be
    given several times."""

    def run(self) -> int:
        """Check, print, write."""
        for path in self.out:
            check_output("--out", path, [f".{kind}" for kind in VOLUME_FORMATS])
        design, requirements = self.given()
        if not requirements.bounds and requirements.workspace is None and not self.volume:
            raise UsageError(
                f"there is no requirement; give one as --require {EXAMPLE!r}, or a design file "
                f"that has some"
            )
        volume = None
        if self.volume or self.out or self.both_sides:
            volume = solve_volume(
                design,
                requirements,
                resolution=COARSE if self.coarse else FINE,
                both_sides=self.both_sides,
            )
        found = check_requirements(design, requirements, fine=not self.coarse, volume=volume)
        volume = found.volume
        conflict = None
        if volume is not None and not found.holds:
            conflict = smallest_conflict(volume, requirements.workspace)
        if self.json:
            print_json(_data(design, requirements, found, conflict))
        else:
            print(design.name)
            print_blocks(check_blocks(requirements, found, conflict, requirement_text))
        if volume is not None:
            files = [(path, volume_bytes(volume, path.suffix.lower()[1:])) for path in self.out]
            for path, content in files:
                write_bytes(path, content)
            if not self.json:
                print_written(self.out)
        return 0 if found.holds else 1


@dataclass(frozen=True, kw_only=True)
class Quantities(JsonFlags):
    """List the quantities that can be bounded, and the unit of their bounds."""

    def run(self) -> int:
        """Print them."""
        if self.json:
            print_json(
                {
                    entry.key: record(entry, "symbol", "unit", "title")
                    for entry in QUANTITIES.values()
                },
                signed=False,
            )
            return 0
        cells = ((key, ascii_unit(entry.display), entry.title) for key, entry in QUANTITIES.items())
        print_blocks([Table(("Quantity", "Unit", ""), rows(*cells), words=3)])
        return 0


FLAGS: Any = (
    Annotated[CheckRequirements, tyro.conf.subcommand("check")]
    | Annotated[Largest, tyro.conf.subcommand("largest")]
    | Annotated[Prove, tyro.conf.subcommand("prove")]
    | Annotated[Quantities, tyro.conf.subcommand("quantities")]
)


def _data(
    design: Design, requirements: Requirements, found: RequirementsCheck, conflict: Conflict | None
) -> dict[str, Any]:
    """Return the check for other programs, in SI units."""
    bounds = requirements.bounds
    data: dict[str, Any] = {
        "design": design.name,
        "holds": found.holds,
        "over": found.over.name.lower(),
        "theta": requirements.theta,
        "center": found.center,
        "items": [
            {
                "requirement": item.label
                if item.requirement is None
                else requirement_text(bounds[item.requirement]),
                "worst": item.value,
                **record(item, "unit", "margin", "pose", "holds", "reason"),
            }
            for item in found.items
        ],
    }
    if (volume := found.volume) is not None:
        data["volume"] = {
            "reachable_m3": volume.reachable_volume,
            "nodes": volume.cause.shape,
            "shares": {cause.word: share for cause, share in volume.shares().items()},
            **record(
                volume,
                "volume_m3",
                "error_m3",
                "utilization",
                "home_inside",
                "cell_m",
                "headings",
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
