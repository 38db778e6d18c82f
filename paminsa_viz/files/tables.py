"""Tables: one writer for every format; `table_reader` reads CSV.

Numbers keep every bit: text has each in the shortest form that reads back as the same number. A
format is one entry in `TABLE_FORMATS`; the page, the command line and the exports offer what is
there.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.checks import kinds_checked
from paminsa_viz.errors import InvalidInput, printable
from paminsa_viz.files.atomic import write_bytes
from paminsa_viz.version import MADE_BY

ROWS_AT_ONCE = 20_000
"""Rows in one block: enough for array speed, some 40 MB."""


@dataclass(frozen=True, eq=False)
class DataTable:
    """Columns to be written, with where they come from.

    Attributes:
        columns: Numbers, NaN where there is none, or texts, by column name with the unit in it.
            Arrays of more than one dimension are rows in C order; all have as many elements.
        provenance: Key and value of the header, see `provenance`.
        arrays: What a binary file holds instead of the columns, or None.

    Raises:
        InvalidInput: If there are no columns, or they are not of one length.
    """

    columns: Mapping[str, NDArray[Any]]
    provenance: Mapping[str, str]
    arrays: Mapping[str, NDArray[Any]] | None = None

    def __post_init__(self) -> None:
        sizes = {np.size(column): name for name, column in self.columns.items()}
        if len(sizes) != 1:
            found = ", ".join(f"{name} has {size}" for size, name in sizes.items()) or "none"
            raise InvalidInput("columns", f"columns of one length are needed, not {found}")


def named(names: Sequence[str], values: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
    """Return values (n, columns) as columns by their names."""
    return dict(zip(names, values.T, strict=True))


@kinds_checked
def provenance(layout: str, facts: Mapping[str, str]) -> dict[str, str]:
    """Return a header: name and version of the layout, the program, and facts, each on one line."""
    head = {"format": layout, "made by": MADE_BY, **facts}
    return {printable(key): printable(value) for key, value in head.items()}


def header_lines(head: Mapping[str, str], columns: Iterable[str]) -> str:
    """Return what a CSV begins with: ``# key: value`` lines and the row that names the columns."""
    lines = [*(f"# {key}: {value}" for key, value in head.items()), ",".join(columns)]
    return "\n".join(lines) + "\n"


def csv_rows(columns: Sequence[NDArray[Any]]) -> str:
    """Return the rows of a CSV. Texts stay as they are; a number that is NaN is left empty."""
    texts = [
        ["" if value != value else repr(value) for value in column.tolist()]
        if column.dtype.kind in "fiub"
        else column.tolist()
        for column in columns
    ]
    return "".join([",".join(cells) + "\n" for cells in zip(*texts, strict=True)])


@kinds_checked
def table_csv(table: DataTable) -> bytes:
    """Return a table as CSV (UTF-8): ``#`` lines of provenance, one header row, then the rows."""
    stream = BytesIO(header_lines(table.provenance, table.columns).encode())
    stream.seek(0, os.SEEK_END)
    columns = [np.asarray(column) for column in table.columns.values()]
    for start in range(0, columns[0].size, ROWS_AT_ONCE):
        block = [column.flat[start : start + ROWS_AT_ONCE] for column in columns]
        stream.write(csv_rows(block).encode())
    return stream.getvalue()


def table_text(table: DataTable) -> str:
    """Return a table as lines with tabs, which a spreadsheet takes from the clipboard.

    The ``#`` lines of provenance first, then the header row, then the rows.
    """
    head, _, names = header_lines(table.provenance, table.columns).rstrip().rpartition("\n")
    columns = [np.asarray(column).ravel() for column in table.columns.values()]
    rows = "\n".join([names, csv_rows(columns).rstrip()]).replace(",", "\t")
    return f"{head}\n{rows}\n"


def table_npz(table: DataTable) -> bytes:
    """Return a table as compressed NPZ; ``numpy.load`` reads it without ``allow_pickle``.

    One array for each column, or those that the table has for binary files, and ``provenance``, a
    JSON text.
    """
    arrays: dict[str, Any] = dict(table.columns if table.arrays is None else table.arrays)
    arrays["provenance"] = np.array(json.dumps(dict(table.provenance), ensure_ascii=False))
    stream = BytesIO()
    np.savez_compressed(stream, **arrays)
    return stream.getvalue()


TABLE_FORMATS: dict[str, Callable[[DataTable], bytes]] = {"csv": table_csv, "npz": table_npz}
"""What writes a table, by the ending of the file."""


def table_endings() -> tuple[str, ...]:
    """Return the endings of table files, with their dots."""
    return tuple(f".{kind}" for kind in TABLE_FORMATS)


@kinds_checked
def table_bytes(table: DataTable, kind: str) -> bytes:
    """Return a table in one of `TABLE_FORMATS`.

    Raises:
        InvalidInput: If there is no such format.
    """
    if kind not in TABLE_FORMATS:
        raise InvalidInput("kind", f"{' or '.join(TABLE_FORMATS)} is needed, not {kind!r:.60}")
    return TABLE_FORMATS[kind](table)


@kinds_checked
def save_table(table: DataTable, path: str | os.PathLike[str]) -> None:
    """Write a table in the format of the file's ending, completely or not at all.

    Raises:
        InvalidInput: If there is no such format.
        FileError: If the file cannot be written.
    """
    write_bytes(path, table_bytes(table, Path(path).suffix.lower()[1:]))
