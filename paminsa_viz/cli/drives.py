"""``paminsa-viz drives``: motors, gears, screws and belts for a motion."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
import tyro

from paminsa_viz.actuation.catalog import Catalog
from paminsa_viz.actuation.duty import Duty, DutyCycle, duty_cycle
from paminsa_viz.actuation.ratios import catalog_ratios
from paminsa_viz.actuation.selection import select_drives
from paminsa_viz.actuation.sizing import Order
from paminsa_viz.blocks.data import robot
from paminsa_viz.blocks.drives import cycle_text, ratio_table, selection_blocks, selection_data
from paminsa_viz.cli.arguments import OrNone, UsageError
from paminsa_viz.cli.flags import DesignFlags, JsonFlags, check_output
from paminsa_viz.cli.motion_flags import MotionFlags
from paminsa_viz.cli.output import (
    print_blocks,
    print_failure,
    print_heading,
    print_json,
    print_left_out,
    print_written,
    save_changed,
)
from paminsa_viz.files.drive_catalog import generic_catalog, load_catalog
from paminsa_viz.files.trajectory_table import read_trajectory
from paminsa_viz.model.design import Design, Geometry
from paminsa_viz.trajectory import PRESET, ImpossibleTrajectory, Trajectory
from paminsa_viz.version import MADE_BY

DESCRIPTION = """\
Find motors and gears for M1 to M3, and motors, gears and screws or belts for M4.

  paminsa-viz drives                                        generic sizes, for the default motion
  paminsa-viz drives --preset arch --dwell 0.5 --catalog my.csv --order margin
  paminsa-viz drives --cycle arch 10 0.2 --cycle home.csv 1 30
  paminsa-viz drives --ratios                               the gear ratios each motor can have
  paminsa-viz drives --same --out driven.toml               the design with the first of each list

A drive is feasible if it keeps RMS torque, torque-speed envelope, top and mean speed, the winding's
temperature and the gear's torques; see docs/drives.md. The catalog that comes with the program
holds generic sizes and no products; --catalog reads a CSV file of your own.

Exit code: 0 every actuator has a feasible drive; 1 one has none, with what would make it feasible,
or the robot cannot run a motion; 2 a wrong argument or file."""


@dataclass(frozen=True, kw_only=True)
class Drives(JsonFlags, MotionFlags, DesignFlags):
    """Flags of the command."""

    cycle: Annotated[
        tuple[tuple[str, float, float], ...], tyro.conf.arg(metavar="MOTION COUNT DWELL")
    ] = ()
    """A motion of the duty cycle, a preset or a table, how often it is made, and how long the robot
    waits after each [s]; can be repeated."""
    dwell: Annotated[float, tyro.conf.arg(metavar="S")] = 0.0
    """How long the robot waits after the one motion of --preset or --file [s]."""
    catalog: Annotated[OrNone[Path], tyro.conf.arg(metavar="FILE.csv")] = None
    """Catalog of motors, gears, screws and belts; generic sizes if left out."""
    order: Order = "mass"
    """What comes first: the lightest, the cheapest, or the one with most margin."""
    inertia_ratio: Annotated[OrNone[float], tyro.conf.arg(metavar="RATIO")] = None
    """Largest inertia of the robot over that of the motor, at the motor's shaft; any if left
    out."""
    same: bool = False
    """M1, M2 and M3 have the same drive."""
    rows: int = 5
    """How many drives to list for each actuator."""
    ratios: bool = False
    """List the feasible gear ratios of every motor instead, for a gear without inertia and losses;
    for M4 with each screw and belt, whose inertia and friction count."""
    out: Annotated[OrNone[Path], tyro.conf.arg(metavar="FILE.toml")] = None
    """Design file to write, with the first drive of each list; one that exists is replaced."""

    def run(self) -> int:
        """Find the drives and report."""
        self._check()
        design = self.given_design()
        catalog = generic_catalog() if self.catalog is None else load_catalog(self.catalog)
        try:
            cycle = duty_cycle(design, self._duties(design.geometry))
        except ImpossibleTrajectory as error:
            return print_failure(error, as_json=self.json)
        if self.ratios:
            return self._print_ratios(design, cycle, catalog)
        found = select_drives(
            cycle, catalog, order=self.order, inertia_ratio=self._inertia_ratio, same=self.same
        )
        advice = tuple(found.advice(j) for j in range(4))
        written = []
        if self.out is not None and found.feasible:
            comment = f"Drives by {MADE_BY} from {catalog.name}."
            driven, requirements = found.design(design), self.given_requirements()
            written = [save_changed(driven, self.out, requirements, comment=comment)]
        if self.json:
            data = selection_data(design, catalog, found, self.rows, advice)
            print_json(data | {"order": self.order, "files": written})
        else:
            _print_heading(design, cycle, catalog)
            print_blocks(selection_blocks(design, found, self.rows, advice))
            print_left_out(design)
            print_written(written)
        return 0 if found.feasible else 1

    def _check(self) -> None:
        check_output("--out", self.out, [".toml"])
        one = self.preset is not None or self.file is not None or self.dwell != 0
        for wrong, problem in (
            (self.cycle and one, "--cycle excludes --preset, --file and --dwell"),
            (not 1 <= self.rows <= 1000, f"--rows: 1 to 1000 are possible, not {self.rows}"),
            (self.ratios and self.out is not None, "--out excludes --ratios"),
        ):
            if wrong:
                raise UsageError(f"{problem}; see paminsa-viz drives --help")
        for name, count, dwell in self.cycle:
            if not (1 <= count < math.inf and 0 <= dwell < math.inf):
                problem = "a count of at least 1 and a time of at least 0 s are needed"
                raise UsageError(f"--cycle {name} {count:g} {dwell:g}: {problem}")

    def _duties(self, geometry: Geometry) -> list[Duty]:
        if not self.cycle:
            return [Duty(self.given_motion(geometry), 1.0, self.dwell)]
        return [Duty(_motion(name, geometry), count, dwell) for name, count, dwell in self.cycle]

    def _print_ratios(self, design: Design, cycle: DutyCycle, catalog: Catalog) -> int:
        found = catalog_ratios(cycle, catalog, inertia_ratio=self._inertia_ratio)
        if self.json:
            print_json({**robot(design), "catalog": catalog.name, "ratios": found})
        else:
            _print_heading(design, cycle, catalog)
            print_blocks([ratio_table(found)])
            print_left_out(design)
        fits = {one.actuator for one in found if one.low is not None}
        return 0 if len(fits) == 4 else 1

    @property
    def _inertia_ratio(self) -> float:
        return np.inf if self.inertia_ratio is None else self.inertia_ratio


FLAGS = Drives


def _print_heading(design: Design, cycle: DutyCycle, catalog: Catalog) -> None:
    print_heading(design, f"catalog {catalog.name}: {cycle_text(cycle)}\n")


def _motion(name: str, geometry: Geometry) -> Trajectory:
    if name in PRESET:
        return PRESET[name].build(geometry).sample()
    if not name.lower().endswith((".csv", ".npz")):
        raise UsageError(f"--cycle {name}: a table, or one of {', '.join(PRESET)}, is needed")
    return read_trajectory(Path(name))
