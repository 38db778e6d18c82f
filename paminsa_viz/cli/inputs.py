"""The design and the motion that a command line names: those of a file, or ready-made ones."""

from __future__ import annotations

from pathlib import Path
from typing import Literal, TypeAlias

from paminsa_viz.files.design_file import load_design
from paminsa_viz.files.trajectory_table import read_trajectory
from paminsa_viz.model.design import APPENDIX_4, Design, Geometry, KneeBranch
from paminsa_viz.trajectory import PRESET, Trajectory

Assembly: TypeAlias = Literal["printed", "mirror"]
"""Values of `KneeBranch`, for flags."""


def design_of(file: Path | None, assembly: Assembly | None = None) -> Design:
    """Return a file's design, or Appendix 4's without one.

    Args:
        file: Design file.
        assembly: Branch of the knee, instead of the file's own.

    Raises:
        DesignFileError: If the file cannot be read or is refused.
    """
    design = APPENDIX_4 if file is None else load_design(file)
    return design if assembly is None else design.with_knee(KneeBranch(assembly))


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
