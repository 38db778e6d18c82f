"""Design files: a robot's numbers as readable TOML, with units in the key names.

A file looks like this (`write_design` adds the paper's symbol to each value):

    schema_version = 1
    name = "light arms"

    [geometry]
    base_radius_m = 0.35

    [links]
    b3_kg = 0.25

Counterweights, if there are any, stand in tables ``[[counterweights]]``. What a file leaves out is
Appendix 4's. A file is read as a whole or refused as a whole, with one line that names the file,
the line, the key, its value and what is allowed.
"""

from __future__ import annotations

import math
import os
import re
import tomllib
from dataclasses import replace
from pathlib import Path, PurePath
from typing import Any

from paminsa_viz.files.atomic import as_file_error, written_whole
from paminsa_viz.files.design_counterweights import KEYS as WEIGHT_KEYS
from paminsa_viz.files.design_counterweights import (
    TABLE,
    counterweight_line,
    read_counterweights,
)
from paminsa_viz.files.design_schema import (
    FILE_KEYS,
    KEY_OF,
    KNEE,
    SCHEMA_VERSION,
    TABLES,
    key_hint,
    table_hint,
)
from paminsa_viz.files.design_writer import name_problem, write_design
from paminsa_viz.files.errors import DesignFileError, printable
from paminsa_viz.model.counterweight import Counterweight
from paminsa_viz.model.design import APPENDIX_4, Design, KneeBranch
from paminsa_viz.model.errors import InvalidDesign

LARGEST_FILE = 200_000
"""Largest design file [bytes], thirty times a complete one. Bounds what an upload can cost."""

LONGEST_LINE = 1_000
"""Longest line [characters]; the work on a dotted key grows with the square of its length."""


def load_design(path: str | os.PathLike[str]) -> Design:
    """Read a design file.

    Raises:
        DesignFileError: If the file cannot be read or is no valid design file.
    """
    try:
        with open(path, "rb") as file:
            data = file.read(LARGEST_FILE + 1)
    except (OSError, ValueError) as error:
        problem = as_file_error(os.fspath(path), error, "read").problem
        raise DesignFileError(os.fspath(path), problem) from error
    return read_design(data, os.fspath(path))


def save_design(design: Design, path: str | os.PathLike[str], *, comment: str = "") -> Path:
    """Write a design file, completely or not at all, and return its path.

    Args:
        design: The design.
        path: The file; one that exists is replaced.
        comment: Where the design comes from, for the file's head.

    Raises:
        FileError: If the file cannot be written.
    """
    text = write_design(design, comment=comment)
    with written_whole(path) as file:
        file.write(text)
    return Path(path)


def read_design(content: str | bytes, source_name: str) -> Design:
    """Return the design that a file's content describes.

    Args:
        content: The file's text or bytes (UTF-8; UTF-16 with its mark is taken as well). It may
            come from anywhere.
        source_name: The file's name, for messages.

    Raises:
        DesignFileError: If it is no valid design file.
    """
    text = _text(content, source_name)
    document = _parsed(text, source_name)
    return _Reader(text, source_name).design(document)


def _text(content: str | bytes, source: str) -> str:
    if len(content) > LARGEST_FILE:
        raise DesignFileError(
            source, f"is too large for a design file (at most {LARGEST_FILE // 1000} kB)"
        )
    if isinstance(content, bytes):
        # Windows PowerShell writes UTF-16 when a command's output is sent into a file.
        utf16 = content[:2] in (b"\xff\xfe", b"\xfe\xff")
        try:
            content = content.decode("utf-16" if utf16 else "utf-8")
        except UnicodeDecodeError as error:
            line = None if utf16 else content.count(b"\n", 0, error.start) + 1
            raise DesignFileError(source, "is not a text file (UTF-8)", line=line) from error
    return content.removeprefix("\ufeff").replace("\r\n", "\n")


def _parsed(text: str, source: str) -> dict[str, Any]:
    for number, line in enumerate(text.split("\n"), 1):
        if len(line) > LONGEST_LINE:
            problem = f"the line is too long (at most {LONGEST_LINE} characters)"
            raise DesignFileError(source, problem, line=number)
    try:
        return tomllib.loads(text)
    except RecursionError as error:
        raise DesignFileError(source, "is nested too deeply for a design file") from error
    except ValueError as error:  # TOMLDecodeError, and Python's own limit on very long integers
        message = str(error)
        found = re.search(r" \(at line (\d+), column \d+\)$", message)
        line = int(found[1]) if found else None
        if "at end of document" in message:
            line = text.rstrip().count("\n") + 1
        if "Cannot overwrite" in message or "Cannot declare" in message:
            problem = "this key or table stands in the file twice"
        elif isinstance(error, tomllib.TOMLDecodeError):
            reason = re.sub(r" \(at .*\)$", "", message)
            problem = f"is not valid TOML: {reason[:1].lower()}{reason[1:]}"
            problem += _number_hint(text.split("\n")[line - 1]) if line else ""
        else:
            problem = "holds a number of too many digits"
        raise DesignFileError(source, problem, line=line) from error


def _number_hint(line: str) -> str:
    """Return advice where a line that is no TOML looks like a number written in another way."""
    ways = {
        r"=\s*[+-]?\d+,\d": "decimals are written with a point: 0.35",
        r"=\s*[+-]?\.\d|=\s*[+-]?\d+\.(?!\d)": "a decimal point has digits on both sides: 0.35",
        r"=\s*[+-]?[\d.]+\s*[A-Za-z]": "a value is written without its unit",
    }
    return next((f" ({advice})" for way, advice in ways.items() if re.search(way, line)), "")


class _Reader:
    """Turns one parsed document into a design; knows its text, to name lines."""

    def __init__(self, text: str, source: str) -> None:
        self.text = text
        self.source = source

    def design(self, document: dict[str, Any]) -> Design:
        self._check_version(document)
        name = document.get("name", printable(PurePath(self.source).stem[:100]))
        if "name" in document and (problem := name_problem(name)):
            raise self._error("name", name, problem)
        numbers: dict[str, float | None] = {}
        weights: tuple[Counterweight, ...] = ()
        knee = self._knee(document.get("geometry"))
        for key, value in document.items():
            if key in FILE_KEYS:
                continue
            if key == TABLE:
                weights = read_counterweights(value, self._number, self._weight_error)
                continue
            if key in TABLES and key:
                numbers |= self._table(key, value)
            elif key in TABLES[""]:
                numbers[TABLES[""][key].parameter.path] = self._number(key, value)
            elif isinstance(value, dict):
                raise self._error(key, None, f"there is no table of this name; {table_hint(key)}")
            else:
                raise self._error(key, None, f"there is no such key; {key_hint('', key)}")
        self._check_count(document, len(numbers) + len(WEIGHT_KEYS) * len(weights))
        try:
            design = APPENDIX_4.vary(numbers).with_knee(knee)
            return replace(design, name=name, counterweights=weights)
        except InvalidDesign as error:
            known = KEY_OF.get(error.field.removeprefix("design."))
            path = known.path if known else error.field
            # A length that only contradicts others may be one that the file does not set.
            value = error.value if isinstance(error.value, (int, float)) else None
            raise self._error(path, value, error.allowed) from error

    def _check_version(self, document: dict[str, Any]) -> None:
        key = "schema_version"
        if key not in document:
            problem = f"is not a design file, or lacks the line {key} = {SCHEMA_VERSION} at its top"
            raise DesignFileError(self.source, problem)
        version = document[key]
        if isinstance(version, bool) or not isinstance(version, int) or version < 1:
            problem = f"a whole number is needed; {SCHEMA_VERSION} is the present one"
            raise self._error(key, version, problem)
        if version > SCHEMA_VERSION:
            problem = (
                f"the file is from a newer paminsa_viz than this one, which reads versions up to "
                f"{SCHEMA_VERSION}; update paminsa_viz"
            )
            raise self._error(key, version, problem)

    def _check_count(self, document: dict[str, Any], found: int) -> None:
        key = "value_count"
        count = document.get(key, 0)
        if isinstance(count, bool) or not isinstance(count, int) or count < 0:
            raise self._error(key, count, "a whole number is needed")
        if found < count:
            problem = (
                f"only {found} values are there, so the file was cut short; if you removed some "
                f"to use Appendix 4's, delete this line too"
            )
            raise self._error(key, count, problem)

    def _table(self, table: str, content: object) -> dict[str, float | None]:
        keys = TABLES[table]
        if not isinstance(content, dict):
            kind = "in single brackets" if isinstance(content, list) else "of values"
            raise self._error(table, None, f"a table [{table}] {kind} is needed")
        numbers: dict[str, float | None] = {}
        for name, value in content.items():
            path = f"{table}.{name}"
            if path == f"geometry.{KNEE}":
                continue
            if name not in keys:
                raise self._error(path, None, f"there is no such key; {key_hint(table, name)}")
            numbers[keys[name].parameter.path] = self._number(path, value)
        return numbers

    def _knee(self, geometry: object) -> KneeBranch:
        value = geometry.get(KNEE) if isinstance(geometry, dict) else None
        if value is None:
            return APPENDIX_4.geometry.knee
        branches = {branch.value: branch for branch in KneeBranch}
        if value not in list(branches):
            allowed = " or ".join(f'"{name}"' for name in branches)
            raise self._error(f"geometry.{KNEE}", value, f"{allowed} is needed")
        return branches[value]

    def _number(self, path: str, value: object) -> float:
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            hint = "a number is needed"
            if isinstance(value, str):
                hint += ", without quotes or unit"
            raise self._error(path, value, hint)
        try:
            number = float(value)
        except OverflowError:
            number = math.inf
        if not math.isfinite(number):
            raise self._error(path, value, "a finite number is needed")
        return number

    def _weight_error(self, key: str, value: object, problem: str, number: int) -> DesignFileError:
        line = counterweight_line(self.text, number, key)
        path = key if key == TABLE else f"{TABLE}.{key}"
        return DesignFileError(self.source, problem, line=line, key=path, value=value)

    def _error(self, key: str, value: object, problem: str) -> DesignFileError:
        line = find_line(self.text, key) or find_line(self.text, key.rpartition(".")[0])
        return DesignFileError(self.source, problem, line=line, key=key, value=value)


def find_line(text: str, key: str) -> int | None:
    """Return the line of a TOML text, counted from 1, that sets a dotted key or opens a table.

    Reads headings and plain assignments only, which is what design files consist of; None if the
    key is not found that way.
    """
    table = ""
    for number, line in enumerate(text.split("\n") if key else (), 1):
        heading = re.match(r"\s*\[\[?([^\]]*)\]", line)
        if heading:
            table = _plain(heading[1])
            if table == key:
                return number
            continue
        assigned = re.match(r"""\s*((?:"[^"]*"|'[^']*'|[\w.\- \t])+?)\s*=""", line)
        if assigned:
            name = _plain(assigned[1])
            path = f"{table}.{name}" if table else name
            if path == key or path.startswith(f"{key}."):
                return number
    return None


def _plain(dotted: str) -> str:
    """Return a dotted key without quotes and the blanks around its dots."""
    return ".".join(part.strip().strip("\"'") for part in dotted.split("."))
