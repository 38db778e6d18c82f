"""``paminsa-viz accuracy``: errors of the pose that the drives leave."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Annotated

import tyro

from paminsa_viz.blocks.accuracy import (
    accuracy_data,
    drive_blocks,
    manufacture_blocks,
    manufacture_data,
)
from paminsa_viz.cli.arguments import OrNone, UsageError, check_needs
from paminsa_viz.cli.flags import DesignFlags, JsonFlags, PoseFlags, RegionFlags
from paminsa_viz.cli.output import print_blocks, print_heading, print_json, progress_line
from paminsa_viz.model.design import PARAMETER, Design
from paminsa_viz.model.reach import require_reachable
from paminsa_viz.precision.drive_errors import drive_errors
from paminsa_viz.precision.error_rows import region_errors
from paminsa_viz.precision.manufacture import (
    monte_carlo,
)
from paminsa_viz.studies.region import RegionResults
from paminsa_viz.units import UM, format_pose, rounded_to_side

DESCRIPTION = """\
Errors of the platform's pose that the drives leave, at a pose and over the workspace; and those by
tolerances, clearances and known deviations of the legs, at the pose.

  paminsa-viz accuracy                                    half a count of 0.01 degrees and 10 um
  paminsa-viz accuracy --pose 50 0 40 -500 --backlash 0.02 5
  paminsa-viz accuracy --resolution 0.005 2 --control 0.002 1 --json
  paminsa-viz accuracy --manufacture --robots 2000        tolerances too, and 2000 random robots
  paminsa-viz accuracy --design driven.toml --encoders    counts of the design's own drives

Half a count of the encoder, half the backlash and the controller's error add. Worst is the largest
error in the box of M1 to M4, by exact forward kinematics in its corners and along its edges; linear
is the estimate |J| dq; RMS is to first order, for independent uniform errors. Near a singularity,
or a limit of reach, the errors have no bound though the linear estimate has a number: the reason is
printed. See docs/accuracy.md.

Exit code: 0 done; 1 the errors at the pose have no bound; 2 a wrong argument or file, or a pose out
of reach."""

ROTARY_LINEAR = tyro.conf.arg(metavar="DEG UM")
Pair = Annotated[OrNone[tuple[float, float]], ROTARY_LINEAR]


@dataclass(frozen=True, kw_only=True)
class Accuracy(JsonFlags, RegionFlags, PoseFlags, DesignFlags):
    """Flags of the command."""

    resolution: Pair = None
    """One count of the encoders at the actuators: M1 to M3 [°], M4 [µm]; by default the design's
    own."""
    backlash: Pair = None
    """Backlash at the actuators, full width: M1 to M3 [°], M4 [µm]; by default the
    design's own."""
    control: Pair = None
    """Error of the controllers to either side: M1 to M3 [°], M4 [µm]; by default the
    design's own."""
    encoders: bool = False
    """Take the resolution from the encoders of the design's drives."""

    manufacture: bool = False
    """Print the errors by the design's tolerances, clearances and deviations too."""
    robots: int = 0
    """Robots to draw at random within the tolerances, with --manufacture."""
    seed: int = 0
    """Seed of that draw."""

    def run(self) -> int:
        """Compute the errors and report."""
        design = self._design()
        geometry = design.geometry
        pose = self.given_pose(geometry)
        require_reachable(geometry, pose)
        region = self.given_region(design)
        here = drive_errors(geometry, design.accuracy, pose)
        over = RegionResults(design, region)
        drawn = None
        if self.robots:
            with progress_line("drawing robots") as show:
                drawn = monte_carlo(design, pose, robots=self.robots, seed=self.seed, progress=show)
        if self.json:
            errors = region_errors(over.field, design.accuracy, over.reached)
            data = accuracy_data(design, here, region, errors)
            more = {"manufacture": manufacture_data(design, pose, drawn)}
            print_json(data | more if self.manufacture else data)
        else:
            print_heading(design, format_pose(pose))
            made = manufacture_blocks(design, pose, drawn) if self.manufacture else []
            print_blocks([*drive_blocks(here, over), *made])
        return 0 if here.ok else 1

    def _design(self) -> Design:
        """Return the design with the accuracies that are given."""
        design = self.given_design()
        if self.robots and not self.manufacture:
            raise UsageError("--robots is for --manufacture")
        check_needs(self, self.robots, "--robots", "seed")
        for flag, number in (("--robots", self.robots), ("--seed", self.seed)):
            if number < 0:
                raise UsageError(f"{flag}: a whole number of at least 0 is needed, not {number}")
        if self.encoders and self.resolution is not None:
            raise UsageError("--encoders and --resolution exclude each other")
        accuracy = design.accuracy
        if self.encoders:
            if not any(drive and drive.resolution for drive in design.drives):
                raise UsageError("--encoders: no drive of the design has encoder_counts")
            accuracy = accuracy.with_encoders(design.drives)
        changes = {}
        for name in ("resolution", "backlash", "control"):
            if (given := getattr(self, name)) is not None:
                rotary, linear = f"{name}_rotary", f"{name}_linear"
                most = (
                    math.degrees(PARAMETER[f"accuracy.{rotary}"].largest),
                    UM * PARAMETER[f"accuracy.{linear}"].largest,
                )
                if not all(0 <= value <= end for value, end in zip(given, most, strict=True)):
                    degrees = rounded_to_side(most[0], 3, up=False)
                    raise UsageError(
                        f"--{name}: 0 to {degrees:.3g} degrees and 0 to {most[1]:g} um are "
                        f"possible, not {given[0]:g} {given[1]:g}"
                    )
                changes |= {rotary: math.radians(given[0]), linear: given[1] / UM}
        return replace(design, accuracy=replace(accuracy, **changes))


FLAGS = Accuracy
