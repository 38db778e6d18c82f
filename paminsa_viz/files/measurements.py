"""Measured poses with the actuators' readings as tables, for calibration."""

from __future__ import annotations

import os
from typing import NamedTuple, TextIO

import numpy as np

from paminsa_viz.checks import kinds_checked
from paminsa_viz.errors import TableFileError
from paminsa_viz.files.columns import ACTUATORS, POSE, TILT
from paminsa_viz.files.columns import MEASUREMENTS as KIND
from paminsa_viz.files.table_reader import TableReader, open_table
from paminsa_viz.files.tables import DataTable, named, provenance
from paminsa_viz.model.accuracy import LEG_NAMES
from paminsa_viz.precision.calibration import Calibration
from paminsa_viz.precision.leg_lengths import LENGTHS, deviation_array
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
    columns = named(names, measurements.poses) | named(ACTUATORS, measurements.actuators)
    return DataTable(columns, provenance(FORMAT, facts))


# --------------------------------------------------------------------------- calibrations as tables

CALIBRATION_FORMAT = "paminsa_viz calibration 1"
"""Name and version of the layout of the lengths."""

RESIDUALS_FORMAT = "paminsa_viz calibration residuals 1"


def lengths_table(found: Calibration, source: str) -> DataTable:
    """Return each length's deviation from its nominal value, and its standard deviation.

    A length that shows in combinations alone has none, and its deviation is one of many that
    predict the same poses.
    """
    places = [(leg, length) for leg in LEG_NAMES for length in LENGTHS]
    return DataTable(
        {
            "length": np.array([f"{leg}.{length.name}" for leg, length in places]),
            "unit": np.array([length.unit for _, length in places]),
            "deviation": deviation_array(found.design).ravel(),
            "standard_deviation": found.standard_deviations.ravel(),
            "known": np.array(["yes" if known else "no" for known in found.determined.ravel()]),
        },
        provenance(CALIBRATION_FORMAT, _facts(found, source)),
    )


def residual_table(found: Calibration, measured: Measurements, source: str) -> DataTable:
    """Return the measured poses, and by how much the lengths before and after miss them."""
    names = (*POSE, *TILT)[: measured.poses.shape[1]]
    columns = named(names, measured.poses)
    for kind, values in (("before", found.residuals_before), ("after", found.residuals_after)):
        columns |= {f"{kind}_{name}": values[:, j] for j, name in enumerate(names)}
    held = np.array(["yes" if one else "no" for one in found.held])
    return DataTable(
        {**columns, "held_back": held}, provenance(RESIDUALS_FORMAT, _facts(found, source))
    )


def _facts(found: Calibration, source: str) -> dict[str, str]:
    return {
        "measured poses": source,
        "held back": str(int(found.held.sum())),
        "combinations fitted": str(len(found.combinations)),
        "noise [m]": f"{found.noise:.6g}",
    }
