"""``paminsa-viz stiffness``: stiffness, deflection and what to stiffen first, at a pose."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
import tyro

from paminsa_viz.blocks.stiffness import (
    sections_data,
    sections_table,
    stiffness_blocks,
    stiffness_data,
)
from paminsa_viz.cli.arguments import OrNone, UsageError
from paminsa_viz.cli.flags import DesignFlags, JsonFlags, PoseFlags
from paminsa_viz.cli.output import print_blocks, print_heading, print_json, print_left_out
from paminsa_viz.elastostatics.beams import tube_fits
from paminsa_viz.elastostatics.stiffness import (
    platform_stiffness,
)
from paminsa_viz.model.design import Design
from paminsa_viz.model.reach import require_reachable
from paminsa_viz.units import format_pose

DESCRIPTION = """\
Stiffness of the robot at a pose, motors locked: 6x6 at the platform's center, deflection under
payload and load, the share of each part, what the motors can bring back, natural frequencies.

  paminsa-viz stiffness --payload 10                    half a millimeter under 10 kg
  paminsa-viz stiffness --pose 50 20 30 -600 --load 20 0 0 0 0 0
  paminsa-viz stiffness --design stiff.toml --shear --json
  paminsa-viz stiffness --sections                      tubes beside the masses and inertias

Bars bend, stretch, twist and, with --shear, shear; drives are springs; joints and guides are rigid
unless the design file's [elastic] table says otherwise. The defaults of that table are chosen and
not measured: give the sections of your own bars. See docs/stiffness.md.

Exit code: 0 done; 1 the pose is singular, where nothing has a compliance; 2 a wrong argument or
file, or a pose out of reach."""


@dataclass(frozen=True, kw_only=True)
class Stiffness(JsonFlags, PoseFlags, DesignFlags):
    """Flags of the command."""

    payload: Annotated[OrNone[float], tyro.conf.arg(metavar="KG")] = None
    """Payload [kg] with its center at the platform's, instead of the design's own."""
    shear: bool = False
    """Bars deform by shear as well (Timoshenko)."""
    sections: bool = False
    """Print the tubes of the bars beside the design's masses and inertias instead."""

    def run(self) -> int:
        """Compute and report."""
        design = self.given_design()
        if self.payload is not None:
            design = replace(design, payload=replace(design.payload, mass=self.payload))
        if self.sections:
            if self.pose is not None:
                raise UsageError("--sections excludes --pose: the tubes are the same everywhere")
            return self._print_sections(design)
        pose = np.array(self.given_pose(design.geometry))
        require_reachable(design.geometry, pose)
        found = platform_stiffness(design, pose, shear=self.shear)
        if reason := found.reason():
            if self.json:
                print_json({"pose": pose, "reason": reason})
            else:
                print_heading(design, f"{format_pose(pose)}: no compliance; {reason}")
            return 1
        if self.json:
            print_json(stiffness_data(design, found, shear=self.shear))
        else:
            print_heading(design, format_pose(pose))
            print_blocks(stiffness_blocks(design, found, shear=self.shear))
            print_left_out(design)
        return 0

    def _print_sections(self, design: Design) -> int:
        fits = tube_fits(design)
        if self.json:
            print_json(sections_data(design, fits))
            return 0
        print_heading(design)
        print_blocks([sections_table(design, fits)])
        return 0


FLAGS = Stiffness
