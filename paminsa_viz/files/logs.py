"""Logs of the built robot as tables: measured positions, and torques or motor currents."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TextIO

import numpy as np

from paminsa_viz.checks import kinds_checked
from paminsa_viz.errors import InvalidInput, TableFileError
from paminsa_viz.files.columns import ACTUATORS, CURRENTS, LOG, MEASURED, TIME
from paminsa_viz.files.table_reader import TableReader, open_table
from paminsa_viz.files.tables import DataTable, named, provenance
from paminsa_viz.files.trajectory_table import simulation_facts
from paminsa_viz.identification.log import InvalidLog, Log, log_of_simulation, make_log
from paminsa_viz.trajectory import Simulation
from paminsa_viz.trajectory.sampled import MOST_SAMPLES

FORMAT = "paminsa_viz log 1"
"""Name and version of the layout that is written; what is read needs no such line."""


def parse_log(
    lines: TextIO,
    source: str,
    *,
    gains: Sequence[float] | None = None,
    split: bool = False,
    timeout: float | None = None,
) -> Log:
    """Read a log from an open table.

    Columns are ``t_s, theta1_rad .. theta3_rad, Z_m`` and ``torque1_Nm .. torque3_Nm, force4_N``
    or ``current1_A .. current4_A``, in any order; other units as ``theta1_deg``, ``Z_mm``.

    Args:
        lines: The text, opened with ``newline=""``.
        source: Its name, for messages.
        gains: (4,) torque or force for each ampere [N m/A, N m/A, N m/A, N/A], for currents.
        split: Split the log at gaps instead of refusing it; see `make_log`.
        timeout: How long the table may take to read [s]; None for as long as it takes.

    Raises:
        TableFileError: If the table is refused; row and column say where.
        InvalidInput: If the gains are not four finite numbers other than 0.
    """
    table = TableReader(lines, LOG, source, timeout)
    found = {column.name for column in table.columns}
    torque = _torque_columns(found, source, gains)
    first_row, columns = table.read_all(MOST_SAMPLES)
    values = np.stack([columns[name] for name in (TIME, *ACTUATORS, *torque)], axis=1)
    factors = np.ones(4) if gains is None else np.asarray(gains, np.float64)
    try:
        return make_log(
            values[:, 0], values[:, 1:5], values[:, 5:] * factors,
            split=split, name=Path(source).stem or "log", first_row=first_row,
        )  # fmt: skip
    except InvalidLog as error:
        read = {column.name.partition("_")[0]: column for column in table.columns}
        column, problem = read.get(error.column), error.problem
        if column and error.other_unit:
            # One who has named another unit need not be told how to.
            advice = error.other_unit if column.factor == 1.0 else "check the unit of the column"
            problem = f"{problem}; {advice}"
        header = column.header if column else error.column
        raise TableFileError(source, problem, row=error.row, column=header) from error


@kinds_checked
def read_log(
    path: str | os.PathLike[str],
    *,
    gains: Sequence[float] | None = None,
    split: bool = False,
) -> Log:
    """Read a log from a CSV file; see `parse_log`.

    Raises:
        TableFileError: If the file cannot be opened or is refused.
        InvalidInput: If the gains are not four finite numbers other than 0.
    """
    with open_table(path) as lines:
        return parse_log(lines, os.fspath(path), gains=gains, split=split)


@kinds_checked
def log_table(log: Log) -> DataTable:
    """Return a log as a table that `read_log` reads."""
    return _table(log, {})


def _table(log: Log, further: dict[str, str]) -> DataTable:
    columns = {TIME: log.t} | named(ACTUATORS, log.position) | named(MEASURED, log.torque)
    facts = {"log": log.name, "samples": str(len(log.t)), "rate [1/s]": repr(log.rate)}
    facts |= {f"note {number}": note for number, note in enumerate(log.notes, 1)}
    return DataTable(columns, provenance(FORMAT, facts | further))


def simulated_log_table(simulation: Simulation) -> DataTable:
    """Return the log of a simulated robot as a table; its header names motion, controller, robot.

    Raises:
        InvalidLog: If it has fewer samples than a log needs, see `log_of_simulation`.
    """
    return _table(log_of_simulation(simulation), simulation_facts(simulation))


def _torque_columns(found: set[str], source: str, gains: Sequence[float] | None) -> tuple[str, ...]:
    """Return the columns that torques come from: of the torques, or of the currents with gains."""
    currents = CURRENTS[0] in found
    if currents and MEASURED[0] in found:
        raise TableFileError(source, "there are torques and currents; leave out one of them")
    if not currents and MEASURED[0] not in found:
        needed = ",".join(MEASURED)
        raise TableFileError(source, f"torques are missing: {needed}, or currents with gains")
    if currents and gains is None:
        raise TableFileError(source, "currents need gains [N·m/A, N·m/A, N·m/A, N/A]")
    if not currents and gains is not None:
        raise TableFileError(source, "gains are for currents, and the log has torques")
    if gains is not None:
        numbers = np.asarray(gains, np.float64)
        if numbers.shape != (4,) or not (np.isfinite(numbers).all() and numbers.all()):
            raise InvalidInput("gains", f"four numbers other than 0 are needed, not {gains!r}")
    return CURRENTS if currents else MEASURED
