"""``paminsa-viz page``: the explorer in one HTML file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from paminsa_viz.cli.arguments import OrNone, UsageError
from paminsa_viz.cli.flags import DesignFlags, check_output
from paminsa_viz.cli.output import print_left_out, print_written
from paminsa_viz.files.atomic import write_bytes
from paminsa_viz.webpage import code_design, code_page, design_page

DESCRIPTION = """\
Write the explorer in one HTML file, which opens from a disk, a mail or any static host.

  paminsa-viz page --out explorer.html                        Appendix 4's robot
  paminsa-viz page --out explorer.html --design robot.toml    another one
  paminsa-viz page --out explorer.html --code PMZ1-...        what a share code describes

It has the pose, masses, lengths and load with torques, limits, singularities, balance, the three
torque maps and the preset motions, computed in the browser by the program's own formulas, and asks
no server for anything.
Motions of one's own, optimization and all else are in the served page alone."""


@dataclass(frozen=True, kw_only=True)
class Page(DesignFlags):
    """Flags of the command."""

    out: Annotated[Path, tyro.conf.arg(metavar="FILE.html")]
    """File to write; one that exists is replaced."""
    code: Annotated[OrNone[str], tyro.conf.arg(metavar="PMZ1-...")] = None
    """Share code to open the page with, instead of a design."""

    def run(self) -> int:
        """Write the page."""
        check_output("--out", self.out, [".html", ".htm"])
        others = (self.design, self.knee, self.load, self.load_point, self.load_frame)
        if self.code is not None and any(each is not None for each in others):
            raise UsageError("--code holds a whole design; leave the other flags of the robot out")
        if self.code is None:
            design = self.given_design()
            text = design_page(design, self.given_requirements())
        else:
            design, text = code_design(self.code), code_page(self.code)
        write_bytes(self.out, text.encode())
        print_written([self.out])
        print_left_out(design)
        return 0


FLAGS = Page
