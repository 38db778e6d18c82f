"""``paminsa-viz loads``: forces at the joints and in the bars, at rest or along a motion."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
import tyro

from paminsa_viz.blocks.loads import motion_blocks, motion_data, pose_blocks, pose_data
from paminsa_viz.cli.arguments import OneOf, OrNone, UsageError
from paminsa_viz.cli.flags import DesignFlags, JsonFlags, PoseFlags, check_output
from paminsa_viz.cli.motion_flags import MotionFlags, PresetName
from paminsa_viz.cli.output import (
    print_blocks,
    print_error,
    print_failure,
    print_heading,
    print_json,
    print_left_out,
    print_written,
)
from paminsa_viz.elastostatics.joint_forces import (
    joint_forces,
)
from paminsa_viz.elastostatics.motion_loads import motion_loads
from paminsa_viz.elastostatics.sideways import sideways_forces
from paminsa_viz.errors import PaminsaError
from paminsa_viz.files.loads_table import bar_table, bearing_table, joint_table, motion_loads_table
from paminsa_viz.files.tables import DataTable, save_table, table_endings
from paminsa_viz.model.design import Design
from paminsa_viz.model.elastic import BARS
from paminsa_viz.model.reach import require_reachable, status_words
from paminsa_viz.trajectory import ImpossibleTrajectory, analyze
from paminsa_viz.units import format_pose, number

DESCRIPTION = """\
Forces at the joints in the legs' planes, N, V and M of the bars, bearing loads of a motion.

  paminsa-viz loads                                     at rest in the middle of the workspace
  paminsa-viz loads --pose 50 0 10 -500 --load 0 0 -100 0 0 0
  paminsa-viz loads --bar b4 --out b4.csv               N, V and M along B4
  paminsa-viz loads --preset arch --out arch.csv        every sample of a motion
  paminsa-viz loads --preset arch --bearings --out bearings.csv

With --preset or --file it is along that motion: peak, RMS and equivalent load of every bearing.
Without, at rest. Signs and conventions are those of docs/loads.md. Sideways, joints share forces by
the elasticity of the legs; those shares are given at rest, from the design's elastic data.

Exit code: 0 done; 1 the pose is singular, or the robot cannot run the whole motion; 2 a wrong
argument or file, or a pose out of reach."""


@dataclass(frozen=True, kw_only=True)
class Loads(JsonFlags, MotionFlags, PoseFlags, DesignFlags):
    """Flags of the command."""

    preset: OrNone[PresetName] = None
    """A ready-made motion, sized for the robot, that the loads are along; at rest without one and
    without --file."""
    bar: OrNone[OneOf[str, BARS]] = None
    """Write N, V and M along this bar, at rest."""
    bearings: bool = False
    """Write peak, RMS and equivalent load of every joint instead of the motion's samples."""
    out: Annotated[tuple[Path, ...], tyro.conf.arg(metavar="FILE")] = ()
    """Table to write (.csv, .npz); can be repeated. One that exists is replaced."""

    def run(self) -> int:
        """Compute the loads and report."""
        self._check()
        design = self.given_design()
        if self.preset is not None or self.file is not None:
            return self._motion(design)
        return self._pose(design)

    def _check(self) -> None:
        for path in self.out:
            check_output("--out", path, table_endings())
        moving = self.preset is not None or self.file is not None
        for wrong, problem in (
            (moving and self.pose is not None, "--pose excludes --preset and --file"),
            (moving and self.bar is not None, "--bar is at rest and excludes --preset and --file"),
            (not moving and self.bearings, "--bearings needs --preset or --file"),
            (self.bar is not None and not self.out, "--bar needs --out"),
            (self.bearings and not self.out, "--bearings needs --out"),
        ):
            if wrong:
                raise UsageError(f"{problem}; see paminsa-viz loads --help")

    def _write(self, table: DataTable) -> None:
        for path in self.out:
            save_table(table, path)

    def _pose(self, design: Design) -> int:
        pose = np.array(self.given_pose(design.geometry))
        require_reachable(design.geometry, pose)
        forces = joint_forces(design, pose)
        if not forces.ok:
            word = status_words(forces.status, forces.leg)
            problem = PaminsaError(f"there are no joint forces in this pose: {word}")
            return print_failure(problem, as_json=self.json)
        sideways = sideways_forces(design, pose)
        if self.bar is not None:
            self._write(bar_table(forces, pose, self.bar))
        elif self.out:
            self._write(joint_table(forces, pose, sideways.force))
        if self.json:
            print_json(pose_data(design, pose, forces, sideways) | {"files": self.out})
        else:
            print_heading(design, format_pose(pose))
            print_blocks(pose_blocks(forces, sideways))
            print_left_out(design)
            print_written(self.out)
        return 0

    def _motion(self, design: Design) -> int:
        analysis = analyze(design, self.given_motion(design.geometry))
        found, failure = motion_loads(analysis), analysis.failure
        if found is None:
            few = PaminsaError("fewer than two samples have joint forces; give the motion more")
            error = few if failure is None else ImpossibleTrajectory(failure)
            return print_failure(error, as_json=self.json)
        if self.out:
            self._write(bearing_table(found) if self.bearings else motion_loads_table(found))
        if self.json:
            print_json(motion_data(found) | {"files": self.out})
        else:
            t = found.trajectory
            print_heading(design, f'motion "{t.name}"', f"{number(t.t[-1] - t.t[0], 3)} s")
            print_blocks(motion_blocks(found))
            print_left_out(design)
            print_written(self.out)
        if failure is not None:
            print_error(ImpossibleTrajectory(failure))
        return 0 if failure is None else 1


FLAGS = Loads
