"""Measured poses with the actuators' readings as tables, for calibration."""

from __future__ import annotations

import os
from typing import Any, NamedTuple, TextIO

import numpy as np

from paminsa_viz.checks import kinds_checked
from paminsa_viz.files.columns import ACTUATORS, POSE, TILT
from paminsa_viz.files.columns import MEASUREMENTS as KIND
from paminsa_viz.files.errors import TableFileError
from paminsa_viz.files.table_reader import TableReader, open_table
from paminsa_viz.files.tables import DataTable, provenance
from paminsa_viz.precision.measurements import Measurements

FORMAT = "paminsa_viz measurements 1"
"""Name and version of the layout that is written; what is read needs no such line."""

MOST_ROWS = 10_000
"""Most poses: a fit works with 6 x 42 numbers for each."""


class MeasurementTable(NamedTuple):
    """Measurements, and the row of the first of them as a spreadsheet counts."""

    measurements: Measurements
    first_row: int


def parse_measurements(lines: TextIO, source: str) -> MeasurementTable:
    """Read measured poses from an open table.

    Columns are ``x_m, y_m, theta_rad, z_m`` and ``theta1_rad .. theta3_rad, Z_m``, with
    ``tiltx_rad, tilty_rad`` if the tilt was measured too, in any order; other units as ``x_mm``,
    ``theta_deg``.

    Args:
        lines: The text, opened with ``newline=""``.
        source: Its name, for messages.

    Raises:
        TableFileError: If the table is refused; row and column say where.
    """
    table = TableReader(lines, KIND, source)
    tilted = any(column.name in TILT for column in table.columns)
    names = (*POSE, *TILT) if tilted else POSE
    first_row, columns = table.read_all(MOST_ROWS, "measured poses")
    if not first_row:
        raise TableFileError(source, "there is no measured pose in it")
    actuators, poses = (
        np.stack([columns[name] for name in group], axis=1) for group in (ACTUATORS, names)
    )
    return MeasurementTable(Measurements(actuators, poses), first_row)


@kinds_checked
def read_measurements(path: str | os.PathLike[str]) -> MeasurementTable:
    """Read measured poses from a CSV file; see `parse_measurements`.

    Raises:
        TableFileError: If the file cannot be opened or is refused.
    """
    with open_table(path) as lines:
        return parse_measurements(lines, os.fspath(path))


@kinds_checked
def measurement_table(measurements: Measurements, **facts: str) -> DataTable:
    """Return measurements as a table that `read_measurements` reads."""
    names = (*POSE, *TILT)[: measurements.poses.shape[1]]
    columns: dict[str, Any] = dict(zip(names, measurements.poses.T, strict=True))
    columns |= dict(zip(ACTUATORS, measurements.actuators.T, strict=True))
    return DataTable(columns, provenance(FORMAT, facts))
