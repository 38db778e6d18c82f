"""The motion that a command line names: a ready-made one, or a table."""

from __future__ import annotations

from pathlib import Path
from typing import Literal, TypeAlias

from paminsa_viz.files.trajectory_table import read_trajectory
from paminsa_viz.model.design import Geometry
from paminsa_viz.trajectory import PRESET, Trajectory

PresetName: TypeAlias = Literal[
    "paper-like", "quintic", "trapezoid", "s-curve", "waypoints", "line", "circle", "arch"
]
"""Keys of `PRESET`, for flags."""


def motion_of(preset: PresetName, file: Path | None, geometry: Geometry) -> Trajectory:
    """Return the trajectory of a CSV file, or else a preset, sized for a robot.

    Raises:
        TableFileError: If the file cannot be read.
    """
    if file is not None:
        return read_trajectory(file)
    return PRESET[preset].build(geometry).sample()
