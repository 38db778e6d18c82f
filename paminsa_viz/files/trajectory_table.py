"""Trajectories and simulations as tables in SI units; trajectories can be read again.

A table to read has a column of time, the pose, and optionally its rates and a load on the platform
that varies with time, with units in the header. Of the load any columns may be left out, which are
zero then; it comes on top of the design's load, at its point and in its directions.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import TextIO

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.checks import kinds_checked
from paminsa_viz.errors import InvalidInput, TableFileError, printable
from paminsa_viz.files.columns import (
    ACCELERATION,
    ACTUATORS,
    ENERGIES,
    LOAD,
    PARTS,
    POSE,
    POWERS,
    SPEEDS,
    STATUS,
    TIME,
    TORQUES,
    TRAJECTORY,
    VELOCITY,
    WANTED,
    WAYPOINTS,
    part_columns,
)
from paminsa_viz.files.design_schema import DRIVE_KEYS
from paminsa_viz.files.errors import shown
from paminsa_viz.files.table_reader import TableReader, open_table
from paminsa_viz.files.tables import DataTable, named, provenance
from paminsa_viz.model.accuracy import equal_legs_note
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design, stated_parameters
from paminsa_viz.model.drive import ACTUATORS as ACTUATOR_NAMES
from paminsa_viz.model.drive import Drive
from paminsa_viz.model.load import LoadFrame
from paminsa_viz.model.lumped import Misprint
from paminsa_viz.trajectory.analysis import TrajectoryAnalysis
from paminsa_viz.trajectory.imported import from_samples
from paminsa_viz.trajectory.sampled import MOST_SAMPLES, Locus, Passage, Trajectory
from paminsa_viz.trajectory.simulation import Simulation

FORMAT = "paminsa_viz trajectory 1"
"""Name and version of the layout."""

SIMULATION_FORMAT = "paminsa_viz simulation 1"

_CROSSING = "planned crossing"
"""What the header calls each passage of a singularity: ``# planned crossing 1: 0.2 s, ...``."""


@kinds_checked
def analysis_table(analysis: TrajectoryAnalysis) -> DataTable:
    """Return a trajectory and the actuator torques that it requires as a table."""
    t, solved, parts = analysis.trajectory, analysis.solved, analysis.breakdown
    columns = {TIME: t.t}
    columns |= named(POSE, t.pose) | named(VELOCITY, t.velocity)
    columns |= named(ACCELERATION, t.acceleration)
    columns |= {} if t.load is None else named(LOAD, t.load)
    columns |= named(ACTUATORS, solved.actuators) | named(SPEEDS, solved.speed)
    columns |= named(TORQUES, analysis.torque)
    loaded = solved.loaded(analysis.design)
    for part in PARTS:
        if part != "load" or loaded:
            columns |= named(part_columns(part), getattr(parts, part))
    columns |= named(POWERS, analysis.power)
    failure = analysis.failure
    published = [item.name for item in Misprint if item in solved.misprints and item.name]
    facts = {
        "trajectory": t.name,
        "kind": t.kind,
        **{f"note {number}": note for number, note in enumerate(t.notes, 1)},
        "samples": str(t.size),
        "duration [s]": repr(t.duration),
        **{
            f"{_CROSSING} {number}": f"{passage.t!r} s, {passage.locus.label}"
            for number, passage in enumerate(t.passages, 1)
        },
        "first failure": failure.explanation if failure else "none",
        **robot_facts(analysis.design),
        "formulas": f"as published: {', '.join(published)}" if published else "corrected",
        **parameter_facts(analysis.design),
    }
    return DataTable(columns | {STATUS: analysis.check.words()}, provenance(FORMAT, facts))


@kinds_checked
def simulation_table(simulation: Simulation) -> DataTable:
    """Return a simulated motion as a table."""
    s = simulation
    columns = {TIME: s.t}
    columns |= named(POSE, s.pose) | named(VELOCITY, s.velocity) | named(WANTED, s.wanted.pose)
    columns |= named(TORQUES, s.torque)
    columns |= dict(zip(ENERGIES, (s.work, s.loss, s.energy_drift), strict=True))
    return DataTable(columns, provenance(SIMULATION_FORMAT, simulation_facts(s)))


def simulation_facts(simulation: Simulation) -> dict[str, str]:
    """Return the motion, what drove a robot along it, how far, and the robot, for a header."""
    s = simulation
    return {
        "trajectory": s.trajectory.name,
        "kind": s.trajectory.kind,
        "controller": s.controller.control.value,
        "bandwidth [Hz]": repr(float(s.controller.bandwidth)),
        "damping": repr(float(s.controller.damping)),
        "stopped": s.stopped.explanation if s.stopped else "at the end",
        **robot_facts(s.design),
        **parameter_facts(s.design),
    }


def robot_facts(design: Design, *, equal_legs: bool = True) -> dict[str, str]:
    """Return what names a robot in the header of a table.

    Args:
        design: The robot.
        equal_legs: Whether the numbers take its legs as equal.
    """
    note = equal_legs_note(design.deviations) if equal_legs else ""
    names = {"design": design.name, "knee": design.geometry.knee.value}
    return names | ({"legs": note} if note else {})


def parameter_facts(design: Design, what: str = "design") -> dict[str, str]:
    """Return all that numbers follow from for the header of a table.

    The rigid robot's numbers, others that are not the default, counterweights and drives; of these
    by the keys of design files what is not the default.
    """
    facts = {
        f"{what} {p.path}{f' [{p.unit}]' if p.unit else ''}": repr(float(design.value(p.path)))
        for p in stated_parameters(design)
    }
    if design.load.frame is not LoadFrame.WORLD:
        facts[f"{what} load.frame"] = design.load.frame.value
    for number, weight in enumerate(design.counterweights):
        facts[f"{what} counterweights.{number}"] = f"{weight.mass!r} kg on {weight.place}"
    for name, drive in zip(ACTUATOR_NAMES, design.drives, strict=True):
        if drive is not None:
            place = f"{what} drives.{name}"
            facts[place] = drive.summary
            facts |= {
                f"{place}.{DRIVE_KEYS[key]}": str(value)
                for key, value in vars(drive).items()
                if value != getattr(Drive, key) and key != "name"
            }
    return facts


def parse_trajectory(
    lines: TextIO,
    source: str,
    *,
    rest: bool = False,
    name: str = "",
    timeout: float | None = None,
) -> Trajectory:
    """Read a trajectory from an open table.

    Args:
        lines: The text, opened with ``newline=""``.
        source: Its name, for messages.
        rest: See `from_samples`: whether it starts and ends at rest; for waypoints.
        name: The trajectory's name; that of the file by default.
        timeout: How long the table may take to read [s]; None for as long as it takes.

    Raises:
        TableFileError: If the table is refused; row and column say where.
    """
    table = TableReader(lines, TRAJECTORY, source, timeout)
    first_row, values = table.read_all(MOST_SAMPLES)
    t = values[TIME]
    table.require_increasing(TIME, t, first_row)
    if len(t) < 2:
        raise TableFileError(source, f"a trajectory needs at least two rows; there are {len(t)}")

    def group(names: tuple[str, ...]) -> NDArray[np.float64] | None:
        if not any(name in values for name in names):
            return None
        zero = np.zeros(len(t))  # columns of a load that are left out
        return np.stack([values.get(name, zero) for name in names], axis=1)

    pose = np.stack([values[name] for name in POSE], axis=1)
    try:
        return from_samples(
            t, pose, group(VELOCITY), group(ACCELERATION), load=group(LOAD), rest=rest,
            name=name or Path(source).stem or "imported",
            passages=_passages(table.facts, source),
        )  # fmt: skip
    except InvalidInput as error:
        raise TableFileError(source, str(error)) from error


def _passages(facts: Mapping[str, str], source: str) -> tuple[Passage, ...]:
    """Return the planned crossings that a header tells of."""
    loci = {locus.label: locus for locus in Locus}
    found = []
    for key, value in facts.items():
        if key.startswith(f"{_CROSSING} "):
            time, _, label = value.partition(" s, ")
            try:
                found.append(Passage(float(time), loci[label]))
            except (ValueError, KeyError):
                problem = f"“0.2 s, {' or '.join(loci)}” is possible, not {shown(value)}"
                raise TableFileError(source, f"{printable(key)}: {problem}") from None
    return tuple(found)


@kinds_checked
def read_trajectory(
    path: str | os.PathLike[str], *, rest: bool = False, name: str = ""
) -> Trajectory:
    """Read a trajectory from a CSV file; see `parse_trajectory`.

    Raises:
        TableFileError: If the file cannot be opened or is refused.
    """
    with open_table(path) as lines:
        return parse_trajectory(lines, os.fspath(path), rest=rest, name=name)


@kinds_checked
def read_waypoints(path: str | os.PathLike[str]) -> tuple[Array, Array | None]:
    """Return poses (n, 4) and times (n,) of a CSV file of waypoints; None if it has no times.

    Raises:
        TableFileError: If the file cannot be opened or is refused.
    """
    with open_table(path) as lines:
        table = TableReader(lines, WAYPOINTS, os.fspath(path))
        first_row, values = table.read_all(MOST_SAMPLES)
        times = values.get(TIME)
        if times is not None:
            table.require_increasing(TIME, times, first_row)
        if len(values[POSE[0]]) < 2:
            raise TableFileError(os.fspath(path), "at least two waypoints are needed")
        return np.stack([values[name] for name in POSE], axis=1), times
