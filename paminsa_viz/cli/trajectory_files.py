"""The files of ``paminsa-viz trajectory``; what they hold follows from their endings."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from paminsa_viz.cli import command_module
from paminsa_viz.cli.output import print_error
from paminsa_viz.cli.trajectory_report import Results
from paminsa_viz.files.atomic import write_bytes
from paminsa_viz.files.errors import FileError
from paminsa_viz.files.tables import table_bytes, table_endings
from paminsa_viz.files.trajectory_table import analysis_table, simulation_table
from paminsa_viz.plots.formats import figure_endings
from paminsa_viz.plots.series import EngineTorques, FigureKind
from paminsa_viz.trajectory import ImpossibleTrajectory, TrajectoryAnalysis

PAGE = ".html"
"""Ending of the file in which the motion is played."""


def write_files(
    results: Results,
    paths: Sequence[Path],
    *,
    kind: FigureKind,
    engine: str | None,
    width_mm: float,
    dpi: float,
    simulated: bool,
) -> list[Path]:
    """Write files, each completely or not at all.

    What cannot be shown, because the motion fails, is left out with a line on stderr.

    Args:
        results: What was worked out.
        paths: Files of tables, figures and pages.
        kind: What figures show.
        engine: ``"mujoco"`` or ``"pinocchio"``, to compare with, or None.
        width_mm: Width of figures [mm].
        dpi: Pixels per inch of PNG.
        simulated: Whether tables and figures of tracking are to show a simulated motion.

    Returns:
        Those that are written.

    Raises:
        FileError: If a file cannot be written.
        EngineMissing: If the engine is not installed.
        InvalidInput: If a figure's width or resolution is not possible.
    """
    analysis, simulation = results.analysis, results.simulation
    other = None if engine is None else engine_torques(analysis, engine)

    def content(ending: str) -> bytes:
        if ending in table_endings():
            table = simulation_table(simulation) if simulation else analysis_table(analysis)
            return table_bytes(table, ending[1:])
        if ending == PAGE:
            return command_module("start").motion_page(analysis.design, analysis.trajectory)
        from paminsa_viz.plots.series_figure import figure_bytes  # late: matplotlib

        return figure_bytes(
            kind, analysis,
            reference=results.reference, published=results.printed, simulation=simulation,
            engine=other, format=ending[1:], width_mm=width_mm, dpi=dpi,
        )  # fmt: skip

    written = []
    for path in paths:
        ending = path.suffix.lower()
        tracking = ending in figure_endings() and kind == "tracking"
        simulated_table = ending in table_endings() and simulated
        if simulation is None and (tracking or simulated_table):
            print_error(_NotWritten(path, "there is no simulated motion"))
            continue
        try:
            write_bytes(path, content(ending))
        except ImpossibleTrajectory:
            print_error(_NotWritten(path, "the motion fails at its start"))
            continue
        written.append(path)
    return written


def engine_torques(analysis: TrajectoryAnalysis, engine: str) -> EngineTorques:
    """Return torques from an engine along an analyzed trajectory; joint friction is ours.

    Raises:
        EngineMissing: If the engine is not installed.
    """
    from paminsa_viz.engines.mujoco_model import MujocoRobot
    from paminsa_viz.engines.pinocchio_model import PinocchioRobot

    name, make = {"mujoco": ("MuJoCo", MujocoRobot), "pinocchio": ("Pinocchio", PinocchioRobot)}[
        engine
    ]
    design, motion = analysis.design, analysis.trajectory
    robot = make(design)
    torque = robot.inverse_dynamics(
        motion.pose, motion.velocity, motion.acceleration, load=motion.load
    )
    torque[~analysis.check.good] = float("nan")
    return EngineTorques(name, torque + analysis.solved.friction(design))


class _NotWritten(FileError):
    """A file that is left out."""

    def __init__(self, path: Path, reason: str) -> None:
        super().__init__(os.fspath(path), f"not written; {reason}")
