"""The motion that a command line names: a ready-made one, or a table."""

from __future__ import annotations

import difflib
from pathlib import Path

from paminsa_viz.cli.arguments import UsageError
from paminsa_viz.files.trajectory_table import read_trajectory
from paminsa_viz.model.design import Assembly, Geometry
from paminsa_viz.model.trajectory import PRESET, Trajectory

DEFAULT_MOTION = "paper-like"


def motion_of(name: str, geometry: Geometry, assembly: Assembly) -> Trajectory:
    """Return a preset, sized for a robot, or the trajectory of a CSV file.

    Args:
        name: A key of `PRESET`, or a path.
        geometry: The robot's lengths.
        assembly: How its pantographs are put together.

    Raises:
        TableFileError: If there is such a file, but it can not be read.
        UsageError: If it is neither.
    """
    if name in PRESET:
        return PRESET[name].build(geometry, assembly).sample()
    if Path(name).exists() or name.lower().endswith(".csv"):
        return read_trajectory(name)
    near = difflib.get_close_matches(name, PRESET, 1)
    hint = f"did you mean {near[0]}?" if near else f"there are {', '.join(PRESET)}"
    raise UsageError(f"{name[:60]!r} is no ready-made trajectory and no CSV file; {hint}")
