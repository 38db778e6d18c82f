"""Flags of a motion; apart from the others, as motions take a while to load."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, TypeAlias

import tyro

from paminsa_viz.cli.arguments import OneOf, OrNone, UsageError
from paminsa_viz.files.trajectory_table import read_trajectory
from paminsa_viz.model.design import Geometry
from paminsa_viz.trajectory import PRESET, Trajectory

PresetName: TypeAlias = OneOf[str, tuple(PRESET)]


@dataclass(frozen=True, kw_only=True)
class MotionFlags:
    """A motion."""

    preset: OrNone[PresetName] = None
    """A ready-made motion, sized for the robot; paper-like by default. None of them is the paper's
    own."""
    file: Annotated[OrNone[Path], tyro.conf.arg(metavar="FILE.csv")] = None
    """A motion as a table with t_s,x_m,y_m,theta_rad,z_m, instead of a preset."""

    def given_motion(self, geometry: Geometry) -> Trajectory:
        """Return the trajectory of the file, or else of the preset, sized for a robot.

        Raises:
            UsageError: If both are given.
            TableFileError: If the file cannot be read.
        """
        self.exclude_both()
        if self.file is not None:
            return read_trajectory(self.file)
        return PRESET[self.preset or "paper-like"].build(geometry).sample()

    def exclude_both(self) -> None:
        """Refuse a preset together with a file.

        Raises:
            UsageError: If both are given.
        """
        if self.preset is not None and self.file is not None:
            raise UsageError("--preset and --file exclude each other")
