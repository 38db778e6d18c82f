"""Reading CSV tables, in blocks of bounded memory and in bounded time.

Whatever a file holds, it is read or refused with its row and column.
"""

from __future__ import annotations

import csv
import io
import os
import time
from collections.abc import Iterator, Mapping, Set
from dataclasses import dataclass
from itertools import chain, islice
from typing import TextIO

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.errors import TableFileError
from paminsa_viz.files.atomic import as_file_error
from paminsa_viz.files.columns import Column, TableKind, match_columns
from paminsa_viz.files.errors import shown
from paminsa_viz.files.tables import ROWS_AT_ONCE
from paminsa_viz.units import read_number

MOST_BLANK_ROWS = 20_000
"""Blank rows that may end a table."""

LONGEST_ROW = 100_000
"""Longest line [characters]; a file without line ends must not fill the memory."""

_UTF_16 = "is UTF-16; save it as CSV in UTF-8"

_OTHER_FILES = {
    b"\xff\xfe": _UTF_16, b"\xfe\xff": _UTF_16,
    b"PK\x03\x04": "is a zip file, as workbooks (.xlsx) and .npz are; save it as CSV in UTF-8",
}  # fmt: skip
"""What files begin with that are no text, and what they are."""

MISSING = "the value is missing"

_SIGNS = {",": "comma", ".": "point"}

_SEPARATORS = (",", ";", "\t")
"""What may be between columns; where it is no comma, a comma may be the decimal sign."""


@dataclass(frozen=True, eq=False)
class TableBlock:
    """Some rows of a table.

    Attributes:
        first_row: Row of the first of them, as a spreadsheet counts.
        cells: Their texts, in the file's column order; decimals have a point.
        values: (n,) numbers in SI units by column name, of the columns that are read.
    """

    first_row: int
    cells: list[list[str]]
    values: Mapping[str, NDArray[np.float64]]

    def group(self, names: tuple[str, ...]) -> NDArray[np.float64]:
        """Return columns that come together as (n, columns); they are zero if not there."""
        missing = np.zeros(len(self.cells))
        return np.stack([self.values.get(name, missing) for name in names], axis=1)


class TableRows:
    """An open CSV table: its header is read, its rows are read on demand, as texts.

    Lines that begin with ``#`` may come before the header. Columns are between commas, or between
    semicolons or tabs: numbers may then have a decimal comma, all of them.

    Attributes:
        empty: Whether there is no header.
        header: Names of all columns.
        head_row: Row of the header, as a spreadsheet counts.
        row: Row of the next record.
        facts: What lines ``# key: value`` of them say.
        error: The type of errors.
    """

    error: type[TableFileError] = TableFileError

    def __init__(self, lines: TextIO, source: str, timeout: float | None = None) -> None:
        """Read the header.

        Args:
            lines: The text, opened with ``newline=""``.
            source: Its name, for messages.
            timeout: How long the table may take to read [s]; None for as long as it takes.

        Raises:
            TableFileError: If it is no CSV.
        """
        self._source = source
        self.row = 1
        self._comments: list[str] = []
        self.facts: dict[str, str] = {}
        text = self._lines(lines, timeout)
        head = self._after_comments(text)
        self._separator = next((sign for sign in _SEPARATORS if sign in "".join(head)), ",")
        self._decimal = "." if self._separator == "," else ""
        self._records = csv.reader(chain(head, text), delimiter=self._separator, strict=True)
        self.head_row = self.row
        header = self.read(1)
        self.empty = not header
        self.header = tuple(name.strip() for names in header for name in names)

    @property
    def comments(self) -> list[str]:
        """The lines before the header, without their ends, as text that can be written."""
        # bytes that are no UTF-8 came as surrogates, which no file takes
        lines = (line.rstrip("\r\n") for line in self._comments)
        return [line.encode(errors="replace").decode() for line in lines]

    def _lines(self, lines: TextIO, timeout: float | None) -> Iterator[str]:
        """Yield the lines; raises at one that is too long before it is read to its end."""
        end = None if timeout is None else time.monotonic() + timeout
        while line := lines.readline(LONGEST_ROW + 1):
            if len(line) > LONGEST_ROW:
                raise csv.Error(f"the row is longer than {LONGEST_ROW:,} characters")
            if end is not None and time.monotonic() > end:
                raise self.refused(f"takes longer than {timeout:g} s to read; thin it out")
            yield line

    def _after_comments(self, text: Iterator[str]) -> list[str]:
        """Note the lines that begin with ``#``; return the line after them, if there is one."""
        try:
            for line in text:
                if not line.startswith("#"):
                    return [line]
                self._comments.append(line)
                key, _, value = line[1:].partition(":")
                self.facts[key.strip()] = value.strip()
                self.row += 1
        except csv.Error as error:
            raise self.refused(f"is not valid CSV: {error}", self.row) from error
        return []

    def read(self, count: int) -> list[list[str]]:
        """Return up to ``count`` records; a line end inside quotes does not count as a row."""
        records: list[list[str]] = []
        try:
            # Keeps what it has read when the reader raises, so that the row is known.
            records.extend(islice(self._records, count))
        except csv.Error as error:
            row = self.row + len(records)
            raise self.refused(f"is not valid CSV: {error}", row) from error
        except OSError as error:
            raise as_file_error(self._source, error, "read", self.error) from error
        self.row += len(records)
        return records

    def with_points(
        self, cells: list[list[str]], first_row: int, texts: Set[int] = frozenset()
    ) -> list[list[str]]:
        """Return the texts of rows with a point for a decimal comma.

        Args:
            cells: The texts.
            first_row: Row of the first of them.
            texts: Places of the columns that are no numbers, which stay as they are.

        Raises:
            TableFileError: Where the file has both, as one of them then groups thousands.
        """
        if self._separator == ",":
            return cells
        if texts:
            numbers = [["" if i in texts else c for i, c in enumerate(row)] for row in cells]
        else:
            numbers = cells
        text = "".join(chain.from_iterable(numbers))
        signs = {sign for sign in _SIGNS if sign in text} | {self._decimal} - {""}
        if len(signs) > 1:
            raise self._mixed_signs(numbers, first_row)
        self._decimal = "".join(signs)
        if "," not in text:
            return cells
        return [
            [cell if i in texts else cell.replace(",", ".") for i, cell in enumerate(record)]
            for record in cells
        ]

    def _mixed_signs(self, cells: list[list[str]], first_row: int) -> TableFileError:
        """Return the error of the first cell with another decimal sign than those before it."""
        known = self._decimal
        for row, record in enumerate(cells, first_row):
            for place, cell in enumerate(record):
                for sign in (sign for sign in cell if sign in _SIGNS):
                    known = known or sign
                    if sign != known:
                        here, before = _SIGNS[sign], _SIGNS[known]
                        column = self.header[place] if place < len(self.header) else ""
                        problem = f"{shown(cell)} has a {here}, where decimals before it have a"
                        return self.refused(f"{problem} {before}", row, column)
        raise AssertionError("decimals have one sign")

    def refused(self, problem: str, row: int | None = None, column: str = "") -> TableFileError:
        """Return the error of a table, of one of its rows, or of a cell."""
        return self.error(self._source, problem, row=row, column=column)


class TableReader(TableRows):
    """An open CSV table of numbers: its header is checked, its rows are read on demand.

    Columns are in any order.

    Attributes:
        columns: The columns that are read.
    """

    def __init__(
        self, lines: TextIO, kind: TableKind, source: str, timeout: float | None = None
    ) -> None:
        """Read and check the header.

        Args:
            lines: The text, opened with ``newline=""``.
            kind: What the table has to hold.
            source: Its name, for messages.
            timeout: How long the table may take to read [s]; None for as long as it takes.

        Raises:
            TableFileError: If the header is not one of such a table.
        """
        super().__init__(lines, source, timeout)
        if self.empty:
            needed = ",".join(kind.needed)
            raise TableFileError(source, f"is empty; a header row with {needed} is needed")
        self.columns: tuple[Column, ...] = match_columns(self.header, kind, source, self.head_row)

    def blocks(self, rows_at_once: int = ROWS_AT_ONCE) -> Iterator[TableBlock]:
        """Yield the rows in their order, at most ``rows_at_once`` in a block.

        Blank rows at the end of the table are left out.

        Raises:
            TableFileError: At a row that is blank or of another length, or a cell that is missing
                or no finite number; if more than `MOST_BLANK_ROWS` blank rows end the table; and
                when the time is up.
        """
        blank_row = 0
        while True:
            first_row, cells = self.row, self.read(rows_at_once)
            if not cells:
                return
            while cells and _is_blank(cells[-1]):
                cells.pop()
            if cells and blank_row:
                raise self.refused("the row is empty, but others follow it", blank_row)
            if blank_row and self.row - blank_row > MOST_BLANK_ROWS:
                raise self.refused(f"over {MOST_BLANK_ROWS:,} blank rows end the table", blank_row)
            if cells:
                cells = self.with_points(cells, first_row)
                yield TableBlock(first_row, cells, self._values(cells, first_row))
            if first_row + len(cells) < self.row:
                blank_row = blank_row or first_row + len(cells)

    def read_all(self, most: int, what: str = "rows") -> tuple[int, dict[str, NDArray[np.float64]]]:
        """Return the row of the first record, as a spreadsheet counts, and all columns (n,).

        Args:
            most: Most records.
            what: What they are, for messages.

        Raises:
            TableFileError: As `blocks` does, and if there are more.
        """
        parts = [{column.name: np.empty(0) for column in self.columns}]
        first_row, count = 0, 0
        for block in self.blocks():
            first_row = first_row or block.first_row
            parts.append(dict(block.values))
            count += len(block.cells)
            if count > most:
                raise self.refused(f"there are more than {most:,} {what}; thin them out")
        return first_row, {name: np.concatenate([p[name] for p in parts]) for name in parts[0]}

    def require_increasing(self, name: str, values: NDArray[np.float64], first_row: int) -> None:
        """Refuse a column of times that do not increase.

        Args:
            name: The column's name in SI units.
            values: Its numbers (n,), in the first of which is ``first_row``, see `read_all`.

        Raises:
            TableFileError: At the first time that is not after the one before it.
        """
        late = np.flatnonzero(np.diff(values) <= 0)
        if late.size:
            row = int(late[0])
            column = next(column for column in self.columns if column.name == name)
            before, after = (float(values[at] / column.factor) for at in (row, row + 1))
            problem = f"times have to increase, and {shown(after)} follows {shown(before)}"
            raise self.refused(problem, first_row + row + 1, column.header)

    def _values(self, cells: list[list[str]], first_row: int) -> dict[str, NDArray[np.float64]]:
        places = [column.place for column in self.columns]
        same_length = {len(record) for record in cells} == {len(self.header)}
        kept = [[row[place] for place in places] for row in cells] if same_length else []
        numbers = _numbers(kept) if same_length else None
        if numbers is None:
            raise self._first_fault(cells, first_row)
        return {c.name: numbers[:, i] * c.factor for i, c in enumerate(self.columns)}

    def _first_fault(self, cells: list[list[str]], first_row: int) -> TableFileError:
        """Return the error of the first row that `_values` would not take."""
        for row, record in enumerate(cells, first_row):
            if _is_blank(record):
                return self.refused("the row is empty, but others follow it", row)
            present = [column for column in self.columns if column.place < len(record)]
            for name, cell in ((column.header, record[column.place]) for column in present):
                if problem := _cell_problem(cell):
                    return TableFileError(self._source, problem, row=row, column=name, value=cell)
            if len(record) < len(self.header):
                return self.refused(MISSING, row, self.header[len(record)])
            if len(record) > len(self.header):
                counts = f"{len(record)} values for {len(self.header)} columns"
                return self.refused(f"there are {counts}", row)
        raise AssertionError("every cell is a finite number")


def open_table(path: str | os.PathLike[str]) -> TextIO:
    """Open a CSV file as text, whatever its bytes are; wrong ones show up in the cell they are in.

    Raises:
        TableFileError: If it cannot be opened.
    """
    try:
        # Opened once: what is read of a pipe is gone.
        file = open(path, "rb")  # noqa: SIM115  the caller closes it
        begin = file.peek(1)
    except (OSError, ValueError) as error:
        raise as_file_error(os.fspath(path), error, "read", TableFileError) from error
    lines = io.TextIOWrapper(file, encoding="utf-8-sig", errors="surrogateescape", newline="")
    if kind := other_file(begin):
        lines.close()
        raise TableFileError(os.fspath(path), kind)
    return lines


UPLOAD_TIMEOUT = 10.0
"""How long an uploaded table may take to read [s]; the largest possible one takes some seconds."""


def uploaded_table(name: str, content: bytes) -> TextIO:
    """Return an uploaded CSV file as text, as `open_table` does one on the disk.

    Args:
        name: Of the file, for messages.
        content: Its bytes.

    Raises:
        TableFileError: If it is no such text.
    """
    if kind := other_file(content):
        raise TableFileError(name, kind)
    return io.StringIO(content.decode("utf-8-sig", errors="surrogateescape"), newline="")


def other_file(begin: bytes) -> str:
    """Return what a file is that begins with some bytes, if it is no text; empty if it may be."""
    known = (kind for mark, kind in _OTHER_FILES.items() if begin.startswith(mark))
    return next(known, "is not a text file (UTF-8)" if b"\0" in begin else "")


def _is_blank(record: list[str]) -> bool:
    return not any(map(str.strip, record))


def _numbers(cells: list[list[str]]) -> NDArray[np.float64] | None:
    """Return rows of equal length as an array, or None if one of them is no finite number."""
    # What `read_number` does, for all of them at once.
    text = "".join(chain.from_iterable(cells))
    if not text.isascii() or "_" in text:
        return None
    try:
        numbers = map(float, chain.from_iterable(cells))
        flat = np.fromiter(numbers, np.float64, len(cells) * len(cells[0]))
    except ValueError:
        return None
    return flat.reshape(len(cells), -1) if np.isfinite(flat).all() else None


def _cell_problem(cell: str) -> str:
    if not cell.strip():
        return MISSING
    number = read_number(cell)
    if number is None:
        # A comma as the decimal sign, or the sign that this program's texts have for minus.
        ways = {",": (".", "decimals are written with a point"), "−": ("-", "minus is written -")}
        hints = [
            f"; {advice}"
            for sign, (plain, advice) in ways.items()
            if read_number(cell.replace(sign, plain)) is not None
        ]
        return f"{shown(cell)} is not a number{''.join(hints)}"
    return "" if np.isfinite(number) else f"{shown(cell)} is not a finite number"
