"""Catalogs of motors, gears, screws and belts: CSV files with a row each, read as other tables are.

The column ``kind`` says what a row is, ``motor``, ``gear``, ``screw`` or ``belt``, and ``source``
where its values are from. All other columns are fields of `Drive`, with their unit at the end of
the name as in design files (``rotor_inertia_kg_m2``) or another one of `units.COLUMN_UNITS`
(``rotor_inertia_g_cm2``, ``rated_speed_rpm``). A cell may be empty where the kind does not need it.
An envelope is a cell of pairs, speed and torque, such as ``0 0.95; 3000 0.95; 5000 0.4``, with both
units in the column's name: ``envelope_rpm_Nm``.
"""

from __future__ import annotations

import difflib
import io
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any, TextIO

from paminsa_viz.actuation.catalog import Catalog, CatalogError
from paminsa_viz.checks import kinds_checked
from paminsa_viz.errors import InvalidDesign, name_hint
from paminsa_viz.files.atomic import as_file_error
from paminsa_viz.files.table_reader import TableRows, other_file
from paminsa_viz.model.drive import Drive
from paminsa_viz.units import COLUMN_UNITS, read_number

KINDS = ("motor", "gear", "screw", "belt")
"""What a row can be."""

NEEDED = {
    "motor": ("rotor_inertia", "rated_torque", "peak_torque", "rated_speed", "top_speed"),
    "gear": ("gear_ratio", "efficiency"),
    "screw": ("lead", "lead_efficiency"),
    "belt": ("lead", "lead_efficiency"),
}
"""Fields that a row of each kind has to have."""

LARGEST_CATALOG = 5_000_000
"""Largest catalog that is read [bytes]."""

MOST_ROWS = 20_000
"""Most rows of a catalog."""

LONGEST_NAME = 200
"""Longest name and source of a part [characters]."""

_FIELDS = {item.name: item for item in fields(Drive)}
_TEXTS = ("name", "source", "kind")


@cache
def generic_catalog() -> Catalog:
    """Return the catalog that comes with the program: generic sizes, no products."""
    text = files("paminsa_viz.files").joinpath("generic_drives.csv").read_text("utf-8")
    return read_catalog(text, "generic sizes")


@kinds_checked
def load_catalog(path: str | os.PathLike[str]) -> Catalog:
    """Read a catalog file.

    Raises:
        CatalogError: If it cannot be read, or a row or a column is not possible.
    """
    name = os.fspath(path)
    try:
        with open(path, "rb") as file:
            data = file.read(LARGEST_CATALOG + 1)
    except OSError as error:
        raise as_file_error(name, error, "read", CatalogError) from error
    return read_catalog(data, Path(name).name)


@kinds_checked
def read_catalog(content: str | bytes, source: str) -> Catalog:
    """Return the catalog of a CSV text; lines that begin with ``#`` are comments.

    Args:
        content: The file's text or bytes (UTF-8).
        source: The file's name, for messages.

    Raises:
        CatalogError: If a row or a column is not possible.
    """
    if len(content) > LARGEST_CATALOG:
        raise CatalogError(source, f"is larger than {LARGEST_CATALOG // 1_000_000} MB")
    if isinstance(content, bytes):
        if kind := other_file(content):
            raise CatalogError(source, kind)
        try:
            content = content.decode("utf-8-sig")
        except UnicodeDecodeError as error:
            raise CatalogError(source, "is not a text file (UTF-8)") from error
    table = CatalogRows(io.StringIO(content, newline=""), source)
    if table.empty:
        raise CatalogError(source, "has no rows; its first line names the columns")
    rows = table.filled(MOST_ROWS - 1)
    columns = [_Column.named(name, source, table.head_row) for name in table.header]
    _check_columns(columns, source, table.head_row)
    texts = {place for place, column in enumerate(columns) if not column.factors}
    parts: dict[str, list[Drive]] = {kind: [] for kind in KINDS}
    sources: dict[str, str] = {}
    for number, cells in rows:
        (record,) = table.with_points([cells], number, texts)
        kind, part, origin = _part(columns, record, source, number)
        parts[kind].append(part)
        sources[part.name] = origin
    return Catalog(
        source, tuple(parts["motor"]), tuple(parts["gear"]),
        tuple(parts["screw"] + parts["belt"]), sources,
    )  # fmt: skip


class CatalogRows(TableRows):
    """The rows of a catalog: comments and blank lines may be anywhere."""

    error = CatalogError

    def filled(self, most: int) -> list[tuple[int, list[str]]]:
        """Return the rows that are not blank, each with its number as a spreadsheet counts.

        Raises:
            CatalogError: If there are more than ``most``, or they are no CSV.
        """
        found = []
        while cells := self.read(1):
            if any(map(str.strip, cells[0])):
                found.append((self.row - 1, cells[0]))
            if len(found) > most:
                raise self.refused(f"has more than {MOST_ROWS:,} rows")
        return found

    def _lines(self, lines: TextIO, timeout: float | None) -> Iterator[str]:
        text = super()._lines(lines, timeout)
        return ("\n" if line.startswith("#") else line for line in text)

    def _after_comments(self, text: Iterator[str]) -> list[str]:
        for line in text:
            if line.strip():
                return [line]
            self.row += 1
        return []


@dataclass(frozen=True)
class _Column:
    """A column: the field of a drive, and the factors to SI of its numbers."""

    name: str
    field: str
    factors: tuple[float, ...]

    @classmethod
    def named(cls, name: str, source: str, row: int) -> _Column:
        """Return the column of a heading."""
        if name in _TEXTS:
            return cls(name, name, ())
        for field, item in _FIELDS.items():
            if not item.metadata and field != "brake":
                continue
            units = COLUMN_UNITS.get(item.metadata.get("unit", ""), {"": 1.0})
            for ending, factor in units.items():
                if name == (f"{field}_{ending}" if ending else field):
                    return cls(name, field, (factor,))
        speeds, torques = COLUMN_UNITS["rad/s"], COLUMN_UNITS["N m"]
        for speed, first in speeds.items():
            for torque, second in torques.items():
                if name == f"envelope_{speed}_{torque}":
                    return cls(name, "envelope", (first, second))
        raise CatalogError(source, _unknown(name), row=row, column=name)


def _unknown(name: str) -> str:
    for field, item in _FIELDS.items():
        unit = item.metadata.get("unit")
        if unit and (name == field or name.startswith(f"{field}_")):
            return f"its unit is missing or not known; there are {_columns_of(field)}"
    if name.startswith("envelope"):
        return "its units are missing or not known; there is for example envelope_rpm_Nm"
    known = list(dict.fromkeys((*_TEXTS, *_FIELDS)))  # a drive has a name of its own
    near = difflib.get_close_matches(name[:100], known, 1, 0.5)
    hint = f"did you mean {_columns_of(near[0])}?" if near else name_hint(name, known)
    return f"there is no such column; {hint}"


def _columns_of(field: str) -> str:
    item = _FIELDS.get(field)
    if field == "envelope":
        return "envelope_rpm_Nm"
    units = COLUMN_UNITS.get(item.metadata.get("unit", ""), {}) if item else {}
    return ", ".join(f"{field}_{ending}" for ending in units) or field


def _check_columns(columns: Sequence[_Column], source: str, row: int) -> None:
    names = [column.field for column in columns]
    twice = next((c.name for c in columns if names.count(c.field) > 1), None)
    if twice is not None:
        raise CatalogError(source, "this value has two columns", row=row, column=twice)
    for name in _TEXTS:
        if name not in names:
            raise CatalogError(source, f"the column {name} is missing", row=row, column=name)


def _part(
    columns: Sequence[_Column], cells: Sequence[str], source: str, row: int
) -> tuple[str, Drive, str]:
    """Return kind, part and origin of a row."""
    if len(cells) != len(columns):
        problem = f"has {len(cells)} cells, and there are {len(columns)} columns"
        raise CatalogError(source, problem, row=row)
    texts = {c.field: cell.strip() for c, cell in zip(columns, cells, strict=True)}
    kind = texts["kind"].lower()
    if kind not in KINDS:
        problem = f"{texts['kind'][:40]!r} is no kind; there are {', '.join(KINDS)}"
        raise CatalogError(source, problem, row=row, column="kind")
    for field in ("name", "source"):
        if not texts[field].isprintable() or len(texts[field]) > LONGEST_NAME:
            problem = f"one line of printable text of at most {LONGEST_NAME} characters is needed"
            raise CatalogError(source, problem, row=row, column=field)
    if not texts["name"]:
        raise CatalogError(source, "a name is needed", row=row, column="name")
    if not texts["source"]:
        problem = 'where the values are from is needed, or "generic"'
        raise CatalogError(source, problem, row=row, column="source")
    held = {c.field: c for c in columns}
    for field in NEEDED[kind]:
        if field not in held:
            problem = f"the column {_columns_of(field)} is missing; each {kind} needs it"
            raise CatalogError(source, problem, row=row, column=field)
        if not texts[field]:
            raise CatalogError(source, f"each {kind} needs it", row=row, column=held[field].name)
    values: dict[str, Any] = {"name": texts["name"]}
    for column in columns:
        if column.field not in _TEXTS and texts[column.field]:
            values[column.field] = _value(column, texts[column.field], source, row)
    if kind in ("screw", "belt"):
        values["transmission"] = kind
    try:
        return kind, Drive(**values), texts["source"]
    except InvalidDesign as error:
        field = error.field.rpartition(".")[2]
        name = held[field].name if field in held else field
        raise CatalogError(source, error.allowed, row=row, column=name) from error


def _value(column: _Column, text: str, source: str, row: int) -> Any:
    def refused(problem: str) -> CatalogError:
        return CatalogError(source, f"{problem}, not {text[:40]!r}", row=row, column=column.name)

    if column.field == "brake":
        if text.lower() not in ("yes", "no"):
            raise refused("yes or no is needed")
        return text.lower() == "yes"
    if column.field == "envelope":
        first, second = column.factors
        pairs = []
        for cells in (pair.split() for pair in text.split(";") if pair.strip()):
            known = [number for number in map(read_number, cells) if number is not None]
            if len(cells) != 2 or len(known) != 2:
                raise refused("pairs are needed, 0 0.9; 3000 0.9; 5000 0.4")
            pairs.append((known[0] * first, known[1] * second))
        return tuple(pairs)
    number = read_number(text)
    if number is None:
        raise refused("a number is needed")
    return number * column.factors[0]
