"""Trajectories from CSV: a column of time, the pose, optionally its rates, units in the header.

Lines that begin with ``#`` may stand before the header; the tables that this package writes have
their provenance there, and can be read again.
"""

from __future__ import annotations

import csv
import os
from collections.abc import Iterator
from itertools import chain
from pathlib import Path
from typing import TextIO

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.files.errors import TableFileError, shown
from paminsa_viz.files.pose_columns import ACCELERATION, POSE, VELOCITY
from paminsa_viz.files.pose_table import (
    ROWS_AT_ONCE,
    PoseTable,
    _bounded,
    _cell_problem,
    _is_blank,
    open_lines,
)
from paminsa_viz.files.trajectory_columns import TIME, Column, match_columns
from paminsa_viz.model.errors import InvalidInput
from paminsa_viz.trajectory.imported import from_samples
from paminsa_viz.trajectory.sampled import MOST_SAMPLES, Trajectory


class TrajectoryTable(PoseTable):
    """An open table of a trajectory: its header is checked, its rows are read when asked for.

    Attributes:
        header: Texts of the header.
        read_columns: The columns that are read.
    """

    def __init__(self, lines: TextIO, source: str) -> None:
        """Read and check the header.

        Args:
            lines: The text, opened with ``newline=""``.
            source: Its name, for messages.

        Raises:
            TableFileError: If the header is not one of a table of a trajectory.
        """
        self._source = source
        text = _bounded(lines)
        skipped, first = _skip_comments(text, source)
        self._records = csv.reader(chain(first, text), strict=True)
        header = self._read(1, skipped + 1)
        if not header:
            problem = f"is empty; a header row with {','.join((TIME, *POSE))} is needed"
            raise TableFileError(source, problem)
        self._first_row = skipped + 2
        self.header = tuple(name.strip() for name in header[0])
        self.read_columns: tuple[Column, ...] = match_columns(self.header, source, skipped + 1)
        self.columns = tuple(self.header[column.place] for column in self.read_columns)

    def numbers(self) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """Return all rows, (n, columns read) in SI units, and each one's row in the file (n,).

        Raises:
            TableFileError: At a row that is blank or of another length, or a cell that is missing
                or no finite number; or if there are more rows than `MOST_SAMPLES`.
        """
        found: list[NDArray[np.float64]] = []
        count = 0
        for cells, first_row in self._pieces(ROWS_AT_ONCE, self._first_row):
            found.append(self._numbers(cells, first_row))
            count += len(cells)
            if count > MOST_SAMPLES:
                problem = f"there are more than {MOST_SAMPLES:,} rows; thin them out"
                raise TableFileError(self._source, problem)
        factors = np.array([column.factor for column in self.read_columns])
        none = np.empty((0, len(self.columns)))
        rows = np.arange(self._first_row, self._first_row + count)
        return np.concatenate([none, *found]) * factors, rows

    def _numbers(self, cells: list[list[str]], first_row: int) -> NDArray[np.float64]:
        """Return the columns that are read of some rows."""
        for row, record in enumerate(cells, first_row):
            if len(record) != len(self.header):
                blank = _is_blank(record)
                raise self._blank(row) if blank else self._wrong_length(record, row, self.header)
        places = [column.place for column in self.read_columns]
        kept = [[record[place] for place in places] for record in cells]
        numbers = self._fast_numbers(kept)
        if numbers is not None:
            return numbers
        for row, (record, texts) in enumerate(zip(cells, kept, strict=True), first_row):
            if _is_blank(record):
                raise self._blank(row)
            for name, cell in zip(self.columns, texts, strict=True):
                if problem := _cell_problem(cell):
                    raise TableFileError(self._source, problem, row=row, column=name, value=cell)
        raise AssertionError("every cell is a finite number")


def parse_trajectory(
    lines: TextIO, source: str, *, rest: bool = False, name: str = ""
) -> Trajectory:
    """Read a trajectory from an open table.

    Args:
        lines: The text, opened with ``newline=""``.
        source: Its name, for messages.
        rest: See `from_samples`: whether it starts and ends at rest; for waypoints.
        name: The trajectory's name; that of the file by default.

    Raises:
        TableFileError: If the table is refused; row and column say where.
    """
    table = TrajectoryTable(lines, source)
    numbers, rows = table.numbers()
    by_name = dict(zip((column.name for column in table.read_columns), numbers.T, strict=True))
    t = by_name[TIME]
    time_name = next(c for c in table.read_columns if c.name == TIME)
    column = table.header[time_name.place]
    late = np.flatnonzero(np.diff(t) <= 0)
    if late.size:
        before, after = (float(t[late[0] + i] / time_name.factor) for i in (0, 1))
        problem = f"times have to increase, and {shown(after)} follows {shown(before)}"
        raise TableFileError(source, problem, row=int(rows[late[0] + 1]), column=column)
    if len(t) < 2:
        raise TableFileError(source, f"a trajectory needs at least two rows; there are {len(t)}")

    def group(names: tuple[str, ...]) -> NDArray[np.float64] | None:
        if names[0] not in by_name:
            return None
        return np.stack([by_name[item] for item in names], axis=1)

    pose = np.stack([by_name[item] for item in POSE], axis=1)
    try:
        return from_samples(
            t, pose, group(VELOCITY), group(ACCELERATION), rest=rest,
            name=name or Path(source).stem or "imported",
        )  # fmt: skip
    except InvalidInput as error:
        raise TableFileError(source, str(error)) from error


def read_trajectory(
    path: str | os.PathLike[str], *, rest: bool = False, name: str = ""
) -> Trajectory:
    """Read a trajectory from a CSV file; see `parse_trajectory`.

    Raises:
        TableFileError: If the file cannot be opened or is refused.
    """
    with open_lines(path) as lines:
        return parse_trajectory(lines, os.fspath(path), rest=rest, name=name)


def _skip_comments(text: Iterator[str], source: str) -> tuple[int, list[str]]:
    """Leave out the lines that begin with ``#``; return their number, and the first other line."""
    skipped = 0
    try:
        for line in text:
            if not line.startswith("#"):
                return skipped, [line]
            skipped += 1
    except csv.Error as error:
        raise TableFileError(source, f"is not valid CSV: {error}", row=skipped + 1) from error
    return skipped, []
