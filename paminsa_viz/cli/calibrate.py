"""``paminsa-viz calibrate``: the legs' own lengths from measured poses."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from paminsa_viz.blocks.calibration import MOST_COMBINATIONS, calibration_blocks, calibration_data
from paminsa_viz.blocks.data import robot
from paminsa_viz.cli.arguments import OrNone, UsageError, check_needs
from paminsa_viz.cli.flags import DesignFlags, JsonFlags, check_output
from paminsa_viz.cli.output import (
    print_blocks,
    print_heading,
    print_json,
    print_left_out,
    print_written,
    save_changed,
)
from paminsa_viz.errors import InvalidInput, TableFileError
from paminsa_viz.files.measurements import measurement_table, read_measurements
from paminsa_viz.files.tables import save_table, table_endings
from paminsa_viz.model.kinematics import inverse_kinematics
from paminsa_viz.precision.calibration import calibrate
from paminsa_viz.precision.calibration_problem import measuring_poses
from paminsa_viz.precision.measurements import InvalidMeasurement, Measurements
from paminsa_viz.version import MADE_BY

DESCRIPTION = """\
Identify the lengths of each leg from measured poses, and write the corrected design.

  paminsa-viz calibrate --propose 40 --out poses.csv      poses to measure, and their actuators
  paminsa-viz calibrate measured.csv --validate 0.3       30 % of the poses are held back
  paminsa-viz calibrate measured.csv --design robot.toml --out calibrated.toml

POSES.csv is a table with x_m,y_m,theta_rad,z_m, if measured tiltx_rad,tilty_rad, and the readings
theta1_rad,theta2_rad,theta3_rad,Z_m; other units as x_mm, theta_deg. Poses are those of the
platform's center in the robot's base frame. Combinations of lengths that the poses show are fitted,
the rest keeps its value; see docs/calibration.md. The design file gets them as tables [leg1],
[leg2], [leg3].

Exit code: 0 done; 1 held-back poses are not predicted better than before; 2 a wrong argument or
file."""


@dataclass(frozen=True, kw_only=True)
class Calibrate(JsonFlags, DesignFlags):
    """Flags of the command."""

    measured: Annotated[OrNone[Path], tyro.conf.Positional, tyro.conf.arg(metavar="POSES.csv")] = (
        None
    )
    """Table of measured poses and readings, .csv."""
    propose: Annotated[OrNone[int], tyro.conf.arg(metavar="N")] = None
    """Instead of calibrating, choose so many poses to measure, and write them with --out, .csv or
    .npz."""
    validate: Annotated[float, tyro.conf.arg(metavar="SHARE")] = 0.0
    """Share of the poses that are held back, drawn at random, to check the result with; 0 to
    0.9."""
    seed: int = 0
    """Seed of that draw."""
    out: Annotated[OrNone[Path], tyro.conf.arg(metavar="FILE")] = None
    """Design file to write, .toml, or the table of --propose; one that exists is replaced. The
    design is not written where held-back poses are not predicted better than before."""
    all: bool = False
    """Print every combination of lengths, not only the best and worst known ones."""

    def run(self) -> int:
        """Calibrate and report, or propose poses."""
        if (self.measured is None) == (self.propose is None):
            raise UsageError(
                "either POSES.csv or --propose is needed; see paminsa-viz calibrate --help"
            )
        check_needs(self, self.measured, "POSES.csv", "validate", "all")
        if self.propose is not None:
            return self._propose(self.propose)
        check_needs(self, self.validate, "--validate or --propose", "seed")
        check_output("--out", self.out, [".toml"])
        if not 0 <= self.validate <= 0.9:
            raise UsageError(f"--validate {self.validate:g}: a share from 0 to 0.9 is needed")
        if self.seed < 0:
            raise UsageError(f"--seed {self.seed}: a whole number of at least 0 is needed")
        design = self.given_design()
        assert self.measured is not None
        table = read_measurements(self.measured)
        try:
            found = calibrate(design, table.measurements, validate=self.validate, seed=self.seed)
        except InvalidMeasurement as error:
            row = table.first_row + error.index
            raise TableFileError(str(self.measured), error.problem, row=row) from error
        except InvalidInput as error:
            if error.argument == "measured":  # too few poses
                raise TableFileError(str(self.measured), error.problem) from error
            raise
        written = []
        if self.out is not None and found.improved:
            comment = f"Calibrated by {MADE_BY} with {self.measured.name}."
            requirements = self.given_requirements()
            written = [save_changed(found.design, self.out, requirements, comment=comment)]
        if self.json:
            print_json(calibration_data(found, str(self.measured)) | {"files": written})
        else:
            print_heading(found.start)
            print_blocks(calibration_blocks(found, None if self.all else MOST_COMBINATIONS))
            print_written(written)
        return 0 if found.improved else 1

    def _propose(self, poses: int) -> int:
        check_output("--out", self.out, table_endings())
        if self.out is None:
            raise UsageError("--propose writes a table: --out FILE.csv is needed")
        design = self.given_design()
        try:
            chosen = measuring_poses(design, poses, seed=self.seed)
        except InvalidInput as error:
            if error.argument == "poses":
                raise UsageError(f"--propose: {error.problem}") from error
            raise
        actuators = inverse_kinematics(design.geometry, chosen).actuators
        table = measurement_table(
            Measurements(actuators, chosen), design=design.name, seed=str(self.seed)
        )
        save_table(table, self.out)
        if self.json:
            facts = {**robot(design), "poses": chosen, "actuators": actuators}
            print_json(facts | {"files": [self.out]})
        else:
            print_left_out(design)
            print_written([self.out])
        return 0


FLAGS = Calibrate
