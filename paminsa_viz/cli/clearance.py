"""``paminsa-viz clearance``: the nearest bodies at a pose and over the workspace."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np
import tyro

from paminsa_viz.blocks.clearance import (
    by_group,
    clearance_data,
    pose_blocks,
    region_blocks,
)
from paminsa_viz.clearance import clearance
from paminsa_viz.cli.arguments import OrNone, UsageError, check_needs
from paminsa_viz.cli.flags import DesignFlags, JsonFlags, PoseFlags, check_range
from paminsa_viz.cli.output import (
    print_blocks,
    print_heading,
    print_json,
    print_left_out,
    progress_line,
)
from paminsa_viz.dimensions.layout import layout
from paminsa_viz.model.design import Design
from paminsa_viz.model.reach import require_reachable
from paminsa_viz.units import MM, format_pose

DESCRIPTION = """\
Least distance of the robot's bodies as they are drawn, and which two are nearest: at a pose, and
over random poses of the workspace.

  paminsa-viz clearance                                   in the middle of the workspace
  paminsa-viz clearance --pose 100 0 30 -500 --least 5
  paminsa-viz clearance --poses 20000 --radius 150 --theta 30
  paminsa-viz clearance --design heavy.toml --json

A negative distance is an overlap. What joints hold together, what slides in each other, and what
lies side by side across a leg's plane in every pose is not checked. See docs/clearance.md; a map is
`paminsa-viz map --quantity clearance`.

Exit code: 0 done; 1 two bodies overlap at the pose, or are nearer than --least; 2 a wrong argument
or file, or a pose out of reach."""

MOST_POSES = 1_000_000
"""Random poses that can be asked for: some minutes."""

LARGEST = 1e5
"""Largest size of their coordinates [mm], as that of a design's lengths."""


@dataclass(frozen=True, kw_only=True)
class ClearanceFlags(JsonFlags, PoseFlags, DesignFlags):
    """Flags of the command."""

    least: Annotated[float, tyro.conf.arg(metavar="MM")] = 0.0
    """Least clearance that is required [mm]."""
    poses: int = 0
    """Random poses of the workspace to check as well; those out of reach do not count."""
    radius: Annotated[OrNone[float], tyro.conf.arg(metavar="MM")] = None
    """Radius of the disc that their positions are in [mm]; half of R_b if left out."""
    theta: Annotated[float, tyro.conf.arg(metavar="DEG")] = 30.0
    """Largest angle of theirs, to either side [°]."""
    z: Annotated[OrNone[tuple[float, float]], tyro.conf.arg(metavar="LOW HIGH")] = None
    """Range of their heights [mm]; what the frame is drawn for if left out."""
    seed: int = 0
    """Seed of the draw."""

    def run(self) -> int:
        """Compute the clearances and report."""
        self._check()
        design = self.given_design()
        pose = self.given_pose(design.geometry)
        require_reachable(design.geometry, pose)
        required = self.least / MM
        groups = by_group(design, np.array(pose))
        here = clearance(design, pose)
        over = None
        if self.poses:
            with progress_line("computing the clearances") as show:
                over = clearance(design, self._drawn(design), progress=show)
        if self.json:
            print_json(clearance_data(design, pose, groups, here, over, required))
        else:
            print_heading(design, format_pose(pose))
            print_blocks(pose_blocks(design, groups, here, required))
            if over is not None:
                print()
                print_blocks(region_blocks(over, required))
            print_left_out(design)
        return 1 if here.reason((), required) else 0

    def _check(self) -> None:
        if not 0 <= self.poses <= MOST_POSES:
            raise UsageError(f"--poses: 0 to {MOST_POSES} are possible, not {self.poses}")
        check_needs(self, self.poses, "--poses", "radius", "theta", "z", "seed")
        if self.seed < 0:
            raise UsageError(f"--seed: a whole number of at least 0 is needed, not {self.seed}")
        if not np.isfinite(self.least):
            raise UsageError(f"--least: a finite number of mm is needed, not {self.least}")
        if self.radius is not None and not 0 < self.radius <= LARGEST:
            raise UsageError(
                f"--radius: above 0, to {LARGEST:g} mm, is possible, not {self.radius}"
            )
        if not 0 <= self.theta <= 180:
            raise UsageError(f"--theta: 0 to 180 degrees are possible, not {self.theta}")
        if self.z is not None:
            check_range("--z", "mm", self.z)
            if max(map(abs, self.z)) > LARGEST:
                raise UsageError(
                    f"--z: {-LARGEST:g} to {LARGEST:g} mm are possible, not "
                    f"{self.z[0]:g} {self.z[1]:g}"
                )

    def _drawn(self, design: Design) -> np.ndarray:
        """Return random poses, uniform in the workspace asked for (n, 4)."""
        rng, g = np.random.default_rng(self.seed), design.geometry
        largest = g.base_radius / 2 if self.radius is None else self.radius / MM
        place = layout(g)
        low, high = (place.platform_low, place.platform_high)
        if self.z is not None:
            low, high = self.z[0] / MM, self.z[1] / MM
        radius, angle = (
            largest * np.sqrt(rng.random(self.poses)),
            rng.uniform(0, 2 * np.pi, self.poses),
        )
        theta = rng.uniform(-1, 1, self.poses) * np.radians(self.theta)
        z = rng.uniform(low, high, self.poses)
        return np.stack([radius * np.cos(angle), radius * np.sin(angle), theta, z], axis=-1)


FLAGS = ClearanceFlags
