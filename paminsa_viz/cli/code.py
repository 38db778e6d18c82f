"""``paminsa-viz code``: the robot as C code for a controller."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from paminsa_viz.cli.arguments import OrNone, UsageError
from paminsa_viz.cli.flags import DesignFlags
from paminsa_viz.cli.output import print_left_out, print_written
from paminsa_viz.codegen.fmu import FmuKind, fmu_folder
from paminsa_viz.codegen.kit import controller_kit
from paminsa_viz.files.atomic import write_folder

DESCRIPTION = """\
Write a robot as C code for its controller: kinematics, statics and dynamics in one header.

  paminsa-viz code --out controller                        Appendix 4's robot
  paminsa-viz code --out controller --design robot.toml    another one
  paminsa-viz code --out controller --float                single precision, for small processors
  paminsa-viz code --out controller --fmu plant --fmu inverse   and FMUs (FMI 2.0)

The folder has paminsa.h (C99 or C++11, no memory, no globals, only math.h), design.h, test vectors,
a test program and a README with conventions, units and limits."""


@dataclass(frozen=True, kw_only=True)
class Code(DesignFlags):
    """Flags of the command."""

    out: Annotated[OrNone[Path], tyro.conf.arg(metavar="FOLDER")] = None
    """Folder to write into; it is made if it is not there."""
    float: bool = False
    """Use float instead of double."""

    fmu: tuple[FmuKind, ...] = ()
    """Add FMI 2.0 units for co-simulation: the robot moved by its actuators, and the torques of a
    motion; can be repeated. It needs a C compiler."""

    def run(self) -> int:
        """Write the folder."""
        if self.out is None:
            raise UsageError("nothing to write; give --out FOLDER")
        if self.fmu and self.float:
            raise UsageError("--fmu has numbers in double precision only; leave --float out")
        design = self.given_design()
        kit: dict[str, str | bytes] = {**controller_kit(design, single=self.float)}
        if self.fmu:
            kit |= fmu_folder(design, self.fmu)
        print_written(write_folder(self.out, kit))
        print_left_out(design)
        return 0


FLAGS = Code
