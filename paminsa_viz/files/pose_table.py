"""Tables of poses as CSV, read and written in pieces so that memory stays bounded on any length.

A table has one header row that names its columns in any order: the pose, optionally the velocity,
optionally the acceleration (each of them whole or not at all), in SI units.
"""

from __future__ import annotations

import csv
import os
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain, islice
from typing import TextIO

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.files.atomic import as_file_error
from paminsa_viz.files.errors import TableFileError, shown
from paminsa_viz.files.pose_columns import GROUPS, POSE, RESULTS, STATUS, check_columns

ROWS_AT_ONCE = 20_000
"""Rows in one piece: enough for array speed, some 40 MB."""

LONGEST_ROW = 100_000
"""Longest line [characters]; a file without line ends must not fill the memory."""

MISSING = "the value is missing"


@dataclass(frozen=True)
class PoseRows:
    """A piece of a table.

    Attributes:
        cells: The rows' texts, in the file's column order.
        pose: (n, 4) [m, m, rad, m].
        velocity: (n, 4) [m/s, m/s, rad/s, m/s]; zero if the table has none.
        acceleration: (n, 4) [m/s^2, m/s^2, rad/s^2, m/s^2]; zero if the table has none.
    """

    cells: list[list[str]]
    pose: NDArray[np.float64]
    velocity: NDArray[np.float64]
    acceleration: NDArray[np.float64]


class PoseTable:
    """An open table of poses: its columns are known, its rows are read as they are asked for.

    Attributes:
        columns: Names of its columns, in its order.
    """

    def __init__(self, lines: TextIO, source: str) -> None:
        """Read and check the header.

        Args:
            lines: The text, opened with ``newline=""``.
            source: Its name, for messages.

        Raises:
            TableFileError: If the header is not one of a table of poses.
        """
        self._source = source
        self._records = csv.reader(_bounded(lines), strict=True)
        header = self._read(1, 1)
        if not header:
            problem = f"is empty; a header row with {','.join(POSE)} is needed"
            raise TableFileError(source, problem)
        self.columns = tuple(name.strip() for name in header[0])
        check_columns(self.columns, source)

    def pieces(self, rows_at_once: int = ROWS_AT_ONCE) -> Iterator[PoseRows]:
        """Yield the rows in their order, at most ``rows_at_once`` in a piece.

        Blank rows at the end of the table are left out.

        Raises:
            TableFileError: At a row that is blank or a cell that is missing or no finite number.
        """
        for cells, first_row in self._pieces(rows_at_once, 2):
            yield self._rows(cells, first_row)

    def _pieces(self, rows_at_once: int, first_row: int) -> Iterator[tuple[list[list[str]], int]]:
        """Yield the records without blank ones at the end, each piece with the row it begins at."""
        blank_row = 0
        while cells := self._read(rows_at_once, first_row):
            next_row = first_row + len(cells)
            while cells and _is_blank(cells[-1]):
                cells.pop()
            if cells and blank_row:
                raise self._blank(blank_row)
            if cells:
                yield cells, first_row
            if first_row + len(cells) < next_row:
                blank_row = blank_row or first_row + len(cells)
            first_row = next_row

    def _read(self, count: int, first_row: int) -> list[list[str]]:
        """Return up to ``count`` records; a line end inside quotes does not count as a row."""
        records: list[list[str]] = []
        try:
            # Keeps what it has read when the reader raises, so that the row is known.
            records.extend(islice(self._records, count))
        except csv.Error as error:
            row = first_row + len(records)
            raise TableFileError(self._source, f"is not valid CSV: {error}", row=row) from error
        except OSError as error:
            problem = as_file_error(self._source, error, "read").problem
            raise TableFileError(self._source, problem) from error
        return records

    def _rows(self, cells: list[list[str]], first_row: int) -> PoseRows:
        numbers = self._fast_numbers(cells)
        if numbers is None:
            raise self._refusal(cells, first_row)
        groups = {
            group: numbers[:, [self.columns.index(name) for name in names]]
            if names[0] in self.columns
            else np.zeros((len(cells), 4))
            for group, names in GROUPS.items()
        }
        return PoseRows(cells, **groups)

    def _fast_numbers(self, cells: list[list[str]]) -> NDArray[np.float64] | None:
        """Return the rows as (n, columns), or None if something is wrong with any of them."""
        width = len(self.columns)
        if any(length != width for length in set(map(len, cells))):
            return None
        text = "".join(chain.from_iterable(cells))
        # Python's float() also takes 1_000 and the digits of other scripts; a table must not.
        if not text.isascii() or "_" in text:
            return None
        try:
            numbers = map(float, chain.from_iterable(cells))
            flat = np.fromiter(numbers, np.float64, len(cells) * width)
        except ValueError:
            return None
        return flat.reshape(len(cells), width) if np.isfinite(flat).all() else None

    def _refusal(self, cells: list[list[str]], first_row: int) -> TableFileError:
        """Return the error of the first row that `_fast_numbers` would not take."""
        for row, record in enumerate(cells, first_row):
            if _is_blank(record):
                return self._blank(row)
            for column, cell in zip(self.columns, record, strict=False):
                if problem := _cell_problem(cell):
                    return TableFileError(self._source, problem, row=row, column=column, value=cell)
            if len(record) != len(self.columns):
                return self._wrong_length(record, row, self.columns)
        raise AssertionError("every cell is a finite number")

    def _wrong_length(
        self, record: list[str], row: int, columns: tuple[str, ...]
    ) -> TableFileError:
        if len(record) < len(columns):
            column = columns[len(record)]
            return TableFileError(self._source, MISSING, row=row, column=column)
        problem = f"there are {len(record)} values for {len(columns)} columns"
        return TableFileError(self._source, problem, row=row)

    def _blank(self, row: int) -> TableFileError:
        return TableFileError(self._source, "the row is empty, but others follow it", row=row)


def open_lines(path: str | os.PathLike[str]) -> TextIO:
    """Open a CSV file as text, whatever its bytes are; wrong ones show up in the cell they are in.

    Raises:
        TableFileError: If it cannot be opened.
    """
    try:
        with open(path, "rb") as file:
            mark = file.read(2)
        if mark in (b"\xff\xfe", b"\xfe\xff"):
            raise TableFileError(os.fspath(path), "is UTF-16; save it as CSV in UTF-8")
        return open(path, encoding="utf-8-sig", errors="surrogateescape", newline="")
    except TableFileError:
        raise
    except (OSError, ValueError) as error:
        problem = as_file_error(os.fspath(path), error, "read").problem
        raise TableFileError(os.fspath(path), problem) from error


def write_header(file: TextIO, columns: Sequence[str]) -> None:
    """Write the header row of a result table: the input's columns, the results, the status."""
    file.write(",".join((*columns, *RESULTS, STATUS)) + "\n")


def write_rows(
    file: TextIO, cells: Iterable[Sequence[str]], results: NDArray[np.float64], words: Sequence[str]
) -> None:
    """Write rows of a result table.

    Args:
        file: Where to.
        cells: The input's own texts, which are repeated.
        results: (n, 8) in the order of `RESULTS`, written with all their digits.
        words: (n,) each row's status; the results of a row that is not ``"ok"`` stay empty.
    """
    empty = "," * (len(RESULTS) - 1)
    lines = [
        f"{','.join(map(str.strip, row))},"
        f"{','.join(map(repr, numbers)) if word == 'ok' else empty},{word}\n"
        for row, numbers, word in zip(cells, results.tolist(), words, strict=True)
    ]
    file.write("".join(lines))


def _bounded(lines: TextIO) -> Iterator[str]:
    """Yield the lines; raises at one that is too long before it is read to its end."""
    while line := lines.readline(LONGEST_ROW):
        if len(line) == LONGEST_ROW:
            raise csv.Error(f"the row is longer than {LONGEST_ROW} characters")
        yield line


def _is_blank(record: list[str]) -> bool:
    return not any(map(str.strip, record))


def _cell_problem(cell: str) -> str:
    if not cell.strip():
        return MISSING
    try:
        number = float(cell) if cell.isascii() and "_" not in cell else None
    except ValueError:
        number = None
    if number is None:
        return f"{shown(cell)} is not a number"
    return "" if np.isfinite(number) else f"{shown(cell)} is not a finite number"
