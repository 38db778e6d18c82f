"""Trajectories and simulations as tables: CSV and NPZ, in SI units, with where they come from.

Numbers keep every bit. A written trajectory can be read again by `trajectory_table`.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from io import BytesIO
from typing import Any

import numpy as np
from numpy.typing import NDArray

from paminsa_viz import __version__
from paminsa_viz.files.atomic import written_whole
from paminsa_viz.files.errors import printable
from paminsa_viz.files.pose_columns import ACCELERATION, ACTUATORS, POSE, TORQUES, VELOCITY
from paminsa_viz.files.trajectory_columns import (
    PARTS,
    POWERS,
    SPEEDS,
    STATUS,
    TIME,
    part_columns,
)
from paminsa_viz.model.design import Design
from paminsa_viz.model.lumped import Misprint
from paminsa_viz.model.parameters import PARAMETERS
from paminsa_viz.trajectory.analysis import TrajectoryAnalysis
from paminsa_viz.trajectory.simulation import Simulation

FORMAT = "paminsa_viz trajectory 1"
"""Name and version of the layout of both files."""

SIMULATION_FORMAT = "paminsa_viz simulation 1"

_WANTED = ("wanted_x_m", "wanted_y_m", "wanted_theta_rad", "wanted_z_m")


@dataclass(frozen=True, eq=False)
class Series:
    """A table over time.

    Attributes:
        columns: (n,) numbers by column name, with the unit in the name; NaN where there is none.
        words: (n,) status of each row in words, or None.
        provenance: Where it comes from: key and value, both on one line.
    """

    columns: Mapping[str, NDArray[np.float64]]
    words: NDArray[np.str_] | None
    provenance: Mapping[str, str]


def analysis_series(analysis: TrajectoryAnalysis) -> Series:
    """Return a trajectory and what it asks of a design as a table."""
    t, solved, parts = analysis.trajectory, analysis.solved, analysis.breakdown
    columns = {TIME: t.t}
    columns |= _named(POSE, t.pose) | _named(VELOCITY, t.velocity)
    columns |= _named(ACCELERATION, t.acceleration)
    columns |= _named(ACTUATORS, solved.actuators) | _named(SPEEDS, solved.speed)
    columns |= _named(TORQUES, analysis.torque)
    for part in PARTS:
        columns |= _named(part_columns(part), getattr(parts, part))
    columns |= _named(POWERS, analysis.power)
    first = analysis.check.first
    said = {
        "format": FORMAT,
        "made by": f"paminsa_viz {__version__}",
        "trajectory": t.name,
        "kind": t.kind,
        **{f"note {number}": note for number, note in enumerate(t.notes, 1)},
        "samples": str(t.size),
        "duration [s]": repr(t.duration),
        "first failure": first.explanation if first else "none",
        **_robot(analysis.design),
        "formulae": _formulae(solved.misprints),
        **_parameters(analysis.design),
    }
    return Series(columns, analysis.check.words(), _printable(said))


def simulation_series(simulation: Simulation) -> Series:
    """Return a simulated motion as a table."""
    s = simulation
    columns = {TIME: s.t}
    columns |= _named(POSE, s.pose) | _named(VELOCITY, s.velocity) | _named(_WANTED, s.wanted.pose)
    columns |= _named(TORQUES, s.torque)
    columns |= {"work_J": s.work, "friction_loss_J": s.loss, "energy_drift_J": s.energy_drift}
    said = {
        "format": SIMULATION_FORMAT,
        "made by": f"paminsa_viz {__version__}",
        "controller": s.controller.control.value,
        "bandwidth [Hz]": repr(float(s.controller.bandwidth)),
        "damping": repr(float(s.controller.damping)),
        "stopped": s.stopped.explanation if s.stopped else "at the end",
        **_robot(s.design),
        **_parameters(s.design),
    }
    return Series(columns, None, _printable(said))


def series_csv(series: Series) -> bytes:
    """Return a table as CSV (UTF-8): ``#`` lines of provenance, one header row, one row a time."""
    lines = [f"# {key}: {value}" for key, value in series.provenance.items()]
    lines.append(",".join([*series.columns, *([] if series.words is None else [STATUS])]))
    texts = [
        ["" if value != value else repr(value) for value in column.tolist()]
        for column in series.columns.values()
    ]
    if series.words is not None:
        texts.append(series.words.tolist())
    lines += map(",".join, zip(*texts, strict=True))
    return ("\n".join(lines) + "\n").encode()


def series_npz(series: Series) -> bytes:
    """Return a table as compressed NPZ; ``numpy.load`` reads it without ``allow_pickle``.

    Arrays: one (n,) for each column, ``status`` (n,) texts if there are any, and ``provenance``, a
    JSON text.
    """
    arrays: dict[str, Any] = {name: np.asarray(column) for name, column in series.columns.items()}
    if series.words is not None:
        arrays[STATUS] = series.words
    arrays["provenance"] = np.array(json.dumps(dict(series.provenance), ensure_ascii=False))
    stream = BytesIO()
    np.savez_compressed(stream, **arrays)
    return stream.getvalue()


def write_series(path: str | os.PathLike[str], series: Series) -> None:
    """Write a table as CSV, completely or not at all.

    Raises:
        FileError: If the file cannot be written.
    """
    with written_whole(path) as file:
        file.write(series_csv(series).decode())


def _named(names: tuple[str, ...], values: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
    return dict(zip(names, values.T, strict=True))


def _robot(design: Design) -> dict[str, str]:
    return {"design": design.name, "assembly": design.geometry.knee.value}


def _formulae(misprints: Misprint) -> str:
    printed = [item.name for item in Misprint if item in misprints and item.name]
    return "corrected" if not printed else f"as printed: {', '.join(printed)}"


def _parameters(design: Design) -> dict[str, str]:
    return {
        f"design {p.path}{f' [{p.unit}]' if p.unit else ''}": repr(design.value(p.path))
        for p in PARAMETERS
    }


def _printable(said: Mapping[str, str]) -> dict[str, str]:
    return {printable(key): printable(value) for key, value in said.items()}
