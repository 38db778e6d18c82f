"""What ``paminsa-viz trajectory`` prints and writes: for people, for programs, and as files."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from paminsa_viz.blocks.trajectory import LOADS, trajectory_blocks
from paminsa_viz.cli import command_module
from paminsa_viz.cli.output import print_blocks, print_error, print_written, record
from paminsa_viz.errors import PaminsaError
from paminsa_viz.files.atomic import write_bytes
from paminsa_viz.files.errors import FileError
from paminsa_viz.files.published_table import PublishedTorques
from paminsa_viz.files.tables import table_bytes, table_endings
from paminsa_viz.files.trajectory_table import analysis_table, simulation_table
from paminsa_viz.model.drive import ACTUATORS, SPEED_UNITS, TORQUE_UNITS
from paminsa_viz.plots.formats import figure_endings
from paminsa_viz.plots.series import EngineTorques, FigureKind
from paminsa_viz.trajectory import (
    ImpossibleTrajectory,
    PathEvent,
    ShortestMotion,
    ShortestStretch,
    Simulation,
    TrajectoryAnalysis,
)
from paminsa_viz.units import format_ascii

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


def _law(quickest: ShortestStretch) -> dict[str, Any]:
    """Return what a motion with the best law says beyond that."""
    if not isinstance(quickest, ShortestMotion):
        return {}
    return {"stretched_s": quickest.stretched, "note": quickest.note}


def report(results: Results, written: Sequence[Path]) -> dict[str, Any]:
    """Return everything as data for JSON, in SI units."""
    analysis, check = results.analysis, results.analysis.check
    t = analysis.trajectory
    quickest = results.quickest
    return {
        "design": analysis.design.name,
        "knee": analysis.solved.geometry.knee.value,
        "trajectory": {
            "samples": t.size,
            **record(t, "name", "kind", "duration_s", "notes"),
        },
        "ok": not results.problems,
        "problems": [str(problem) for problem in results.problems],
        "failure": _failure(check.first),
        "closest": _event(check.closest),
        "shortest": quickest
        and {
            **record(quickest, "quantity", "limit", "unit", "t_s"),
            **_law(quickest),
        },
        "actuators": _actuators(analysis),
        "reference": results.reference and _other(results.reference),
        "printed": results.printed and _other(results.printed),
        "published": results.published and _published(results, results.published),
        "simulation": results.simulation and _simulation(results.simulation),
        "files": written,
    }


def print_report(results: Results, written: Sequence[Path]) -> None:
    """Print the same for people, lengths in mm and angles in degrees."""
    analysis = results.analysis
    print(f'design "{analysis.design.name}", {analysis.solved.geometry.knee.label}')
    if results.quickest is not None:
        print(f"shortest duration, {results.quickest.explanation}")
    others = {"reference": results.reference, "as published": results.printed}
    print_blocks(trajectory_blocks(analysis, others))
    if results.reference is not None:
        first = results.reference.check.first
        verdict = "can run it too" if first is None else f"fails {first.explanation}"
        print(f'reference "{results.reference.design.name}": {verdict}')
    if results.published is not None:
        _print_published(results, results.published)
    if results.simulation is not None:
        _print_simulation(results.simulation)
    print_written(written)


def _event(event: PathEvent) -> dict[str, Any]:
    return {
        "t_s": event.t,
        "limit": event.limit.word,
        "leg": event.leg + 1 if event.leg >= 0 else None,
        "margin_m": event.margin,
        "pose": event.pose,
    }


def _failure(event: PathEvent | None) -> dict[str, Any] | None:
    return None if event is None else {**_event(event), "explanation": event.explanation}


def _actuators(analysis: TrajectoryAnalysis) -> list[dict[str, Any]]:
    names = zip(ACTUATORS, TORQUE_UNITS, SPEED_UNITS, strict=True)
    return [
        {"name": name, "unit": unit, "speed_unit": speed_unit}
        | {key: getattr(summary, load) for load, key, *_ in LOADS}
        for (name, unit, speed_unit), summary in zip(names, analysis.summary, strict=False)
    ]


def _other(analysis: TrajectoryAnalysis) -> dict[str, Any]:
    return {
        "design": analysis.design.name,
        "failure": _failure(analysis.check.first),
        "actuators": _actuators(analysis),
    }


def _simulation(simulation: Simulation) -> dict[str, Any]:
    return {
        "controller": simulation.controller.control.value,
        "bandwidth_Hz": simulation.controller.bandwidth,
        "payload_kg": simulation.design.payload.mass,
        "end_t_s": simulation.t[-1],
        "stopped": _failure(simulation.stopped),
        "largest_distance_m": simulation.distance.max(),
        "end_distance_m": simulation.distance[-1],
        "largest_error": np.abs(simulation.error).max(axis=0),
        "energy_drift_J": np.abs(simulation.energy_drift).max(),
    }


def _published(results: Results, table: PublishedTorques) -> list[dict[str, Any] | None]:
    """Return how far the computed torques are from a table's, for each actuator it has."""
    off = table.differences(results.analysis.trajectory.t, results.analysis.torque)
    found: list[dict[str, Any] | None] = []
    for j in range(4):
        known = np.isfinite(off[:, j])
        if not known.any():
            found.append(None)
            continue
        part = off[known, j]
        found.append(
            {
                "rows": int(known.sum()),
                "largest_difference": float(np.abs(part).max()),
                "rms_difference": float(np.sqrt(np.mean(part**2))),
                "largest_published": float(np.abs(table.torque[known, j]).max()),
            }
        )
    return found


def _print_published(results: Results, table: PublishedTorques) -> None:
    for j, row in enumerate(_published(results, table)):
        if row is None:
            print(f"published {table.name}, {ACTUATORS[j]}: no value at a time of this motion")
            continue
        largest, rms, size = (
            format_ascii(row[key], TORQUE_UNITS[j], 3)
            for key in ("largest_difference", "rms_difference", "largest_published")
        )
        print(
            f"published {table.name}, {ACTUATORS[j]}: computed off by at most {largest}, RMS "
            f"{rms}, of {size} at {row['rows']} times"
        )


def _print_simulation(simulation: Simulation) -> None:
    x, y, theta, z = (
        format_ascii(float(value), unit, 3)
        for value, unit in zip(
            np.abs(simulation.error).max(axis=0), ("m", "m", "rad", "m"), strict=True
        )
    )
    print(
        f"simulated with {simulation.controller.control.value}, payload "
        f"{simulation.design.payload.mass:.4g} kg: largest errors x {x}, "
        f"y {y}, theta {theta}, z {z}; at the end "
        f"{format_ascii(simulation.distance[-1], 'm', 3)} from its place"
    )
    if simulation.stopped is not None:
        print(f"it stopped {simulation.stopped.explanation}")
    drift = float(np.abs(simulation.energy_drift).max())
    print(f"energy drift of the solution: {format_ascii(drift, 'J', 3)}")


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


class _NotWritten(FileError):
    """A file that is left out."""

    def __init__(self, path: Path, reason: str) -> None:
        super().__init__(os.fspath(path), f"not written; {reason}")
