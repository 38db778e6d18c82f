"""``paminsa-viz report``: the design report as one HTML file."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated

import tyro

from paminsa_viz.cli.arguments import OrNone, UsageError, check_limits, command_line
from paminsa_viz.cli.flags import ComparedDesignFlags, PoseFlags, check_output
from paminsa_viz.cli.motion_flags import MotionFlags
from paminsa_viz.cli.output import print_written, write_report
from paminsa_viz.files.example_logs import given_log
from paminsa_viz.files.measurements import read_measurements
from paminsa_viz.files.trajectory_table import read_waypoints
from paminsa_viz.trajectory import MotionLimits, spline_path, time_optimal

DESCRIPTION = """\
Write a design report: one HTML file with everything inside, to attach to a design review.

  paminsa-viz report --out report.html
  paminsa-viz report --out report.html --design robot.toml --pose 50 -30 20 -550 --preset arch
  paminsa-viz report --out report.html --design new.toml --reference old.toml

It holds the design and where it differs from Appendix 4 and a reference, geometry and workspace,
requirements in its file with their volume and the largest proven workspace, torque maps, the
trajectory with loads, clearance and figures, the design's drives on it if there are any, the
calibration from measured poses, the verification against MuJoCo, and against Pinocchio if it is
installed (pip install "paminsa-viz[verify]"), the static balance, and where all of it comes from.
For a PDF, open it in a browser and print."""


@dataclass(frozen=True, kw_only=True)
class Report(MotionFlags, PoseFlags, ComparedDesignFlags):
    """Flags of the command."""

    out: Annotated[Path, tyro.conf.arg(metavar="FILE.html")]
    """File to write; one that exists is replaced. Maps are at the angle and height of the pose."""
    cross: bool = False
    """The rows of --file are waypoints of a motion that may pass type-2 singularities, in the
    shortest time within --max-torque."""
    max_torque: Annotated[OrNone[float], tyro.conf.arg(metavar="NM")] = None
    """Limit of the torque of M1, M2 and M3 for --cross [N·m]."""
    log: Annotated[OrNone[str], tyro.conf.arg(metavar="LOG")] = None
    """Log of the built robot to identify it from: a CSV file, or example; see paminsa-viz
    identify."""
    measured: Annotated[OrNone[Path], tyro.conf.arg(metavar="POSES.csv")] = None
    """Table of measured poses and readings to calibrate the robot with; see paminsa-viz
    calibrate."""
    verify: bool = True
    """Check the formulas against the physics engines that are installed."""
    seed: int = 0
    """Seed of random poses."""

    def run(self) -> int:
        """Write the report."""
        check_output("--out", self.out, [".html", ".htm"])
        if self.cross and (self.file is None or self.max_torque is None):
            raise UsageError("--cross needs --file and --max-torque")
        if self.max_torque is not None and not self.cross:
            raise UsageError("--max-torque belongs to --cross")
        check_limits(self, "max_torque")
        design = self.given_design()
        pose = self.given_pose(design.geometry)
        if self.cross and self.file is not None:
            poses, _ = read_waypoints(self.file)
            limits = MotionLimits(torque=self.max_torque)
            path = spline_path(poses, design)
            trajectory = time_optimal(design, path, limits, name=self.file.stem).plan.sample()
        else:
            trajectory = self.given_motion(design.geometry)

        from paminsa_viz.report.request import ReportRequest

        request = ReportRequest(
            design=design,
            pose=pose,
            trajectory=trajectory,
            made=datetime.now(UTC),
            command=command_line.get(),
            verified=self.verify,
            seed=self.seed,
            log=None if self.log is None else given_log(self.log),
            measured=self.measured and read_measurements(self.measured).measurements,
            requirements=self.given_requirements(),
            reference=self.given_reference(design),
        )
        write_report(request, self.out)
        print_written([self.out])
        return 0


FLAGS = Report
