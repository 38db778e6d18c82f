"""``paminsa-viz requirements``: what a robot is needed for, checked."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, Literal

import tyro

from paminsa_viz.blocks.data import robot
from paminsa_viz.blocks.kinds import Note
from paminsa_viz.blocks.proofs import largest_blocks, largest_data, proof_blocks, proof_data
from paminsa_viz.blocks.requirements import (
    check_blocks,
    check_data,
    quantities_data,
    quantities_table,
)
from paminsa_viz.cli.arguments import OrNone, UsageError, Words
from paminsa_viz.cli.flags import DesignFlags, JsonFlags, Point, check_output, check_range
from paminsa_viz.cli.output import (
    print_blocks,
    print_heading,
    print_json,
    print_written,
    progress_line,
)
from paminsa_viz.files.atomic import write_bytes
from paminsa_viz.files.design_file import load_content
from paminsa_viz.model.design import Design
from paminsa_viz.quantities.requirement_text import EXAMPLE, parse_requirement, requirement_text
from paminsa_viz.quantities.requirements import Requirements, Workspace, WorkspaceShape
from paminsa_viz.synthesis.proof.certificate import prove
from paminsa_viz.synthesis.proof.evidence import Verdict
from paminsa_viz.synthesis.proof.largest import largest_workspace
from paminsa_viz.synthesis.proof.regions import Growth
from paminsa_viz.synthesis.volume.check import check_requirements
from paminsa_viz.synthesis.volume.conflict import smallest_conflict
from paminsa_viz.synthesis.volume.grid import COARSE, FINE
from paminsa_viz.synthesis.volume.solve import solve_volume
from paminsa_viz.synthesis.volume.surface import VOLUME_FORMATS, volume_bytes
from paminsa_viz.units import MM

DESCRIPTION = """\
Requirements: bounds on quantities, headings and a workspace, of a design file or as text.

  paminsa-viz requirements check robot.toml             those of the file
  paminsa-viz requirements check --require "condition <= 10" --require "|tau_1| <= 15 N m" \\
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
class RequirementFlags(DesignFlags):
    """The robot and what it is needed for."""

    file: Annotated[OrNone[Path], tyro.conf.Positional, tyro.conf.arg(metavar="FILE")] = None
    """Design file with its requirements; Appendix 4 if left out."""
    require: Annotated[Words, tyro.conf.arg(metavar="TEXT")] = ()
    """A requirement on top of the file's; can be repeated."""
    theta: Annotated[OrNone[tuple[float, float]], tyro.conf.arg(metavar="LOW HIGH")] = None
    """Headings that count [°], instead of the file's."""
    cylinder: Annotated[OrNone[tuple[float, float]], tyro.conf.arg(metavar="DIAMETER HEIGHT")] = (
        None
    )
    """A cylinder that has to fit [mm], instead of the file's workspace."""
    box: Annotated[OrNone[Point], tyro.conf.arg(metavar="X Y Z")] = None
    """A box that has to fit [mm], instead of the file's workspace."""
    center: Annotated[OrNone[tuple[str, str, str]], tyro.conf.arg(metavar="X Y Z")] = None
    """Center of the workspace [mm]; 'free' for a coordinate that is to be found. 0 0 free if left
    out."""

    def given(self) -> tuple[Design, Requirements]:
        """Return the design and its requirements.

        Raises:
            UsageError: If flags exclude each other or a number is none.
            DesignFileError: If the file cannot be read or is refused.
        """
        if self.file is not None and self.design is not None:
            raise UsageError("FILE and --design exclude each other")
        path = self.file or self.design
        design = replace(self, design=path).given_design()
        given = None if path is None else load_content(path).requirements
        return design, self._requirements(given or Requirements())

    def _requirements(self, given: Requirements) -> Requirements:
        bounds = (*given.bounds, *map(parse_requirement, self.require))
        low, high = given.theta
        if self.theta is not None:
            check_range("--theta", "degrees", self.theta)
            low, high = map(math.radians, self.theta)
        return Requirements(bounds, (low, high), self._workspace(given.workspace))

    def _workspace(self, given: Workspace | None) -> Workspace | None:
        flags = {shape: f"--{shape.value}" for shape in WorkspaceShape}
        sizes = {shape: getattr(self, shape.value) for shape in WorkspaceShape}
        shapes = [shape for shape, extents in sizes.items() if extents is not None]
        if len(shapes) > 1:
            raise UsageError(f"{' and '.join(flags[shape] for shape in shapes)} exclude each other")
        if not shapes:
            if self.center is None:
                return given
            if given is None:
                raise UsageError(f"--center needs {' or '.join(flags.values())}")
            return replace(given, center=self._center())
        (shape,) = shapes
        if not all(0 < extent < math.inf for extent in sizes[shape]):
            words = " ".join(f"{extent:g}" for extent in sizes[shape])
            raise UsageError(f"{flags[shape]}: lengths above 0 mm are needed, not {words}")
        size = shape.section.size(*(extent / MM for extent in sizes[shape]))
        return Workspace(shape, size, self._center())

    def _center(self) -> tuple[float | None, float | None, float | None]:
        if self.center is None:
            return 0.0, 0.0, None
        found = []
        for word in self.center:
            try:
                found.append(None if word == "free" else float(word) / MM)
            except ValueError:
                raise UsageError(f"--center: a number or 'free' is needed, not {word!r}") from None
        x, y, z = found
        return x, y, z


@dataclass(frozen=True, kw_only=True)
class Prove(JsonFlags, RequirementFlags):
    """Prove that all requirements hold over the workspace, or find a pose where one does not.

    Its center has to be given. Exit code 1 if one is broken or undecided; one that can only be
    sampled, see docs/largest-workspace.md, is named and does not change it."""

    time: Annotated[float, tyro.conf.arg(metavar="S")] = 15.0
    """Time after which to answer that it is undecided [s]."""

    def run(self) -> int:
        """Prove and print."""
        design, requirements = self.given()
        _check_time(self.time)
        if requirements.workspace is None:
            raise UsageError("a workspace is needed: --cylinder or --box, or that of a design file")
        if None in requirements.workspace.center:
            raise UsageError("--center: a proof needs three numbers; 'largest' finds a center")
        with progress_line("proving", _of_time(self.time)) as show:
            proof = prove(design, requirements, time_limit=self.time, progress=show)
        if self.json:
            print_json({**robot(design), **proof_data(proof)})
        else:
            advice = "a longer --time may decide it"
            print_heading(design)
            print_blocks(proof_blocks(requirements, proof, requirement_text, advice=advice))
        return 0 if proof.verdict is Verdict.PROVEN else 1


@dataclass(frozen=True, kw_only=True)
class Largest(JsonFlags, RequirementFlags):
    """Find the largest workspace of a shape over which all requirements are proven.

    What cannot be proven is sampled, and the answer says so.
    The sizes of --cylinder or --box are its proportions. Exit code 1 if there is none."""

    grow: Literal["all", "horizontal", "vertical"] = "all"
    """Which extents grow; the others are kept."""
    tolerance: Annotated[OrNone[float], tyro.conf.arg(metavar="MM")] = None
    """Gap between what is proven, or holds at samples, and a pose that breaks a requirement, at
    which to stop [mm]. 1 mm at Appendix 4's l_B3 + l_B4 if left out, in proportion to the
    robot's."""
    time: Annotated[float, tyro.conf.arg(metavar="S")] = 15.0
    """Time after which to stop [s]; the gap is then what it is."""
    both_sides: bool = False
    """A free height may be on the other side of the guides than home."""

    def run(self) -> int:
        """Search and print."""
        design, requirements = self.given()
        _check_time(self.time)
        if self.tolerance is not None and not 0.0 < self.tolerance < math.inf:
            raise UsageError(f"--tolerance: a number above 0 is needed, not {self.tolerance}")
        if requirements.workspace is None:
            raise UsageError("a shape is needed: --cylinder or --box, or that of a design file")
        with progress_line("proving", _of_time(self.time)) as show:
            found = largest_workspace(
                design,
                requirements,
                growth=Growth[self.grow.upper()],
                tolerance=None if self.tolerance is None else self.tolerance / MM,
                time_limit=self.time,
                both_sides=self.both_sides,
                progress=show,
            )
        if self.json:
            print_json(largest_data(design, found))
        else:
            advice = "a longer --time or a smaller --tolerance may decide it"
            print_heading(design)
            print_blocks(largest_blocks(requirements, found, requirement_text, advice=advice))
            if found.cause == "volume":
                print_blocks([Note("'paminsa-viz requirements check' names those that contradict")])
        return 1 if found.workspace is None else 0


def _of_time(time: float) -> str:
    return f" of at most {time:g} s"


def _check_time(time: float) -> None:
    if not (math.isfinite(time) and time > 0.0):
        raise UsageError(f"--time: a number of seconds above 0 is needed, not {time}")


@dataclass(frozen=True, kw_only=True)
class CheckRequirements(JsonFlags, RequirementFlags):
    """Say which requirements hold, with margins and the worst poses; exit code 1 if one does not.

    Over the required workspace; without one, over the volume where all hold."""

    volume: bool = False
    """Solve the volume where all requirements hold: dm³, share of what can be reached, what cuts
    it."""
    both_sides: bool = False
    """Heights on the other side of the guides count as well."""
    coarse: bool = False
    """Sample coarsely: some ten milliseconds instead of a second."""
    out: Annotated[tuple[Path, ...], tyro.conf.arg(metavar="FILE")] = ()
    """File for the volume: its surface as .stl [mm] or .glb, its nodes as .csv or .npz; can be
    repeated. One that exists is replaced."""

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
        if volume is not None:
            files = [(path, volume_bytes(volume, path.suffix.lower()[1:])) for path in self.out]
            for path, content in files:
                write_bytes(path, content)
        if self.json:
            data = check_data(design, requirements, found, conflict)
            print_json(data | {"files": self.out})
        else:
            print_heading(design)
            print_blocks(check_blocks(requirements, found, conflict, requirement_text))
            print_written(self.out)
        return 0 if found.holds else 1


@dataclass(frozen=True, kw_only=True)
class Quantities(JsonFlags):
    """List the quantities that can be bounded, and the unit of their bounds."""

    def run(self) -> int:
        """Print them."""
        if self.json:
            print_json(quantities_data(), signed=False)
        else:
            print_blocks([quantities_table()])
        return 0


FLAGS: Any = (
    Annotated[CheckRequirements, tyro.conf.subcommand("check")]
    | Annotated[Largest, tyro.conf.subcommand("largest")]
    | Annotated[Prove, tyro.conf.subcommand("prove")]
    | Annotated[Quantities, tyro.conf.subcommand("quantities")]
)
