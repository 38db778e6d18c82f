"""What ``paminsa-viz trajectory`` prints and writes: for people, for programs, and as files."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from paminsa_viz.blocks.trajectory import (
    compared_data,
    published_differences,
    published_notes,
    reference_note,
    shortest_data,
    shortest_note,
    simulation_data,
    simulation_notes,
    trajectory_blocks,
    trajectory_data,
)
from paminsa_viz.cli import command_module
from paminsa_viz.cli.output import (
    print_blocks,
    print_error,
    print_heading,
    print_left_out,
    print_written,
)
from paminsa_viz.errors import FileError, PaminsaError
from paminsa_viz.files.atomic import write_bytes
from paminsa_viz.files.logs import simulated_log_table
from paminsa_viz.files.published_table import PublishedTorques
from paminsa_viz.files.tables import save_table, table_bytes, table_endings
from paminsa_viz.files.trajectory_table import analysis_table, simulation_table
from paminsa_viz.identification import InvalidLog
from paminsa_viz.plots.formats import figure_endings
from paminsa_viz.plots.series import EngineTorques, FigureKind
from paminsa_viz.trajectory import (
    ImpossibleTrajectory,
    PathEvent,
    ShortestStretch,
    Simulation,
    TrajectoryAnalysis,
)

PAGE = ".html"
"""Ending of the file in which the motion is played."""


@dataclass(frozen=True, eq=False)
class Results:
    """What the command worked out.

    Attributes:
        analysis: The design on the motion.
        quickest: What the duration follows from, if it is the shortest one.
        reference: Another design on the same motion.
        printed: The design by the formulas as published.
        published: Torques over time from elsewhere.
        simulation: The robot driven along the motion.
        problems: Why the motion, or its simulation, fails.
    """

    analysis: TrajectoryAnalysis
    quickest: ShortestStretch | None = None
    reference: TrajectoryAnalysis | None = None
    printed: TrajectoryAnalysis | None = None
    published: PublishedTorques | None = None
    simulation: Simulation | None = None
    problems: tuple[PaminsaError, ...] = ()


class SimulationStopped(PaminsaError):
    """A simulated robot that came to a limit.

    Attributes:
        event: The limit, and when.
    """

    def __init__(self, event: PathEvent) -> None:
        self.event = event
        super().__init__(f"the simulation stopped {event.explanation}")


def report(results: Results, written: Sequence[Path]) -> dict[str, Any]:
    """Return everything as data for JSON, in SI units."""
    quickest, published = results.quickest, results.published
    return {
        **trajectory_data(results.analysis),
        "ok": not results.problems,
        "problems": [str(problem) for problem in results.problems],
        "shortest": quickest and shortest_data(quickest),
        "reference": results.reference and compared_data(results.reference),
        "printed": results.printed and compared_data(results.printed),
        "published": published and published_differences(results.analysis, published),
        "simulation": results.simulation and simulation_data(results.simulation),
        "files": written,
    }


def print_report(results: Results, written: Sequence[Path]) -> None:
    """Print the same for people, lengths in mm and angles in degrees."""
    analysis = results.analysis
    print_heading(analysis.design, analysis.solved.geometry.knee.label)
    if results.quickest is not None:
        print_blocks([shortest_note(results.quickest)])
    others = {"reference": results.reference, "as published": results.printed}
    blocks = trajectory_blocks(analysis, others)
    if results.reference is not None:
        blocks.append(reference_note(results.reference))
    if results.published is not None:
        blocks += published_notes(analysis, results.published)
    if results.simulation is not None:
        blocks += simulation_notes(results.simulation)
    print_blocks(blocks)
    print_left_out(analysis.design)
    print_written(written)


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
    from paminsa_viz.plots.verified import engine_torques  # late: what engines need

    analysis, simulation = results.analysis, results.simulation
    other = None if engine is None else engine_torques(analysis, engine, most=None)
    if results.published is not None:
        t = analysis.trajectory.t
        other = EngineTorques(results.published.name, results.published.at(t))

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


def write_log(results: Results, path: Path) -> list[Path]:
    """Write the log of the simulated robot; returns the path, or nothing with a line on stderr.

    Raises:
        FileError: If it cannot be written.
    """
    if results.simulation is None:
        print_error(_NotWritten(path, "there is no simulated motion"))
        return []
    try:
        save_table(simulated_log_table(results.simulation), path)
    except InvalidLog as error:
        print_error(_NotWritten(path, str(error)))
        return []
    return [path]


class _NotWritten(FileError):
    """A file that is left out."""

    def __init__(self, path: Path, reason: str) -> None:
        super().__init__(os.fspath(path), f"not written; {reason}")
