"""``paminsa-viz report``: the design report as one HTML file."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated

import tyro

from paminsa_viz.cli.arguments import command_line
from paminsa_viz.cli.flags import DesignFlags, MotionFlags, PoseFlags, check_ending
from paminsa_viz.cli.output import print_written
from paminsa_viz.files.atomic import open_atomically
from paminsa_viz.trajectory import home

DESCRIPTION = """\
Write a design report: one HTML file with everything inside, to attach to a design review.

  paminsa-viz report --out report.html
  paminsa-viz report --out report.html --design robot.toml --pose 50 -30 20 -550 --preset arch

It holds the design and where it differs from Appendix 4, geometry and workspace, torque maps, the
trajectory with loads and figures, the design's drives on it if there are any, the verification
against physics engines if they are installed (pip install 'paminsa-viz[verify]'), the static
balance, and where all of it comes from. For a PDF, open it in a browser and print."""


@dataclass(frozen=True, kw_only=True)
class Report(MotionFlags, PoseFlags, DesignFlags):
    """Flags of the command."""

    out: Annotated[Path, tyro.conf.arg(metavar="FILE.html")]
    """File to write; one that exists is replaced. Maps are at the angle and height of the pose."""
    verify: bool = True
    """Check the formulas against the physics engines that are installed."""
    seed: int = 0
    """Seed of random poses."""

    def run(self) -> int:
        """Write the report."""
        check_ending("--out", self.out, [".html", ".htm"])
        design = self.given_design()
        pose = self.given_pose or tuple(home(design.geometry).tolist())
        trajectory = self.given_motion(design.geometry)

        from paminsa_viz.report import ReportRequest, report_html  # figures take a second to load

        request = ReportRequest(
            design=design,
            pose=pose,
            trajectory=trajectory,
            made=datetime.now(UTC),
            command=command_line.get(),
            verified=self.verify,
            seed=self.seed,
        )
        # Opened first, so that a place which cannot be written to is known before the work.
        with open_atomically(self.out) as file:
            file.write(report_html(request, lambda part: print(f"{part} ...", file=sys.stderr)))
        print_written([self.out])
        return 0


FLAGS = Report
