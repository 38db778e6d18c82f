"""Design files: a robot's numbers as readable TOML, with units in the key names.

A file looks like this (`write_design` adds the paper's symbol to each value):

    schema_version = 1
    name = "light arms"

    [geometry]
    base_radius_m = 0.35

    [links]
    b3_kg = 0.25

Counterweights, if there are any, are in tables ``[[counterweights]]``, drives in ``[drives.M1]``
to ``[drives.M4]``, requirements in ``[[requirements]]`` and ``[workspace]``. What a file leaves out
is Appendix 4's. A file is read as a whole or refused as a whole, with one line that names the file,
the line, the key, its value and what is allowed.
"""

from __future__ import annotations

import os
import re
import tomllib
from dataclasses import dataclass, replace
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, Any

from paminsa_viz.checks import kinds_checked
from paminsa_viz.errors import InvalidDesign, printable
from paminsa_viz.files.atomic import as_file_error, open_atomically
from paminsa_viz.files.design_schema import (
    CHOICES,
    COUNTERWEIGHT_KEYS,
    COUNTERWEIGHTS,
    DRIVE_KEYS,
    DRIVES,
    KEY_OF,
    KEYS,
    KNEE,
    REQUIREMENTS,
    WORKSPACE,
    knee_of,
)
from paminsa_viz.files.design_writer import name_problem, write_design
from paminsa_viz.files.errors import DesignFileError
from paminsa_viz.files.plain_data import UnusableData, parse_plain_toml
from paminsa_viz.files.toml_table import nearest_line
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.design import APPENDIX_4, Design, renamed_if_changed
from paminsa_viz.model.drive import ACTUATORS, Drive
from paminsa_viz.model.parameters import Counterweight

if TYPE_CHECKING:
    from paminsa_viz.quantities.requirements import Requirements

LARGEST_FILE = 200_000
"""Largest design file [bytes], thirty times a complete one. Bounds what an upload can cost."""

LONGEST_LINE = 1_000
"""Longest line [characters]; the work on a dotted key grows with the square of its length."""


@dataclass(frozen=True)
class DesignContent:
    """What is in a design file.

    Attributes:
        design: The robot.
        requirements: What it is needed for; None if the file does not say.
    """

    design: Design
    requirements: Requirements | None


@kinds_checked
def load_design(path: str | os.PathLike[str]) -> Design:
    """Read a design file.

    Raises:
        DesignFileError: If the file cannot be read or is no valid design file.
    """
    return load_content(path).design


@kinds_checked
def load_content(path: str | os.PathLike[str]) -> DesignContent:
    """Read a design file with its requirements.

    Raises:
        DesignFileError: If the file cannot be read or is no valid design file.
    """
    return read_content(read_bytes(path), os.fspath(path))


def read_bytes(path: str | os.PathLike[str]) -> bytes:
    """Return the content of a file, of a large one no more than shows that it is too large.

    Raises:
        DesignFileError: If the file cannot be read.
    """
    try:
        with open(path, "rb") as file:
            return file.read(LARGEST_FILE + 1)
    except (OSError, ValueError) as error:
        raise as_file_error(os.fspath(path), error, "read", DesignFileError) from error


@of_design
def save_design(
    design: Design,
    path: str | os.PathLike[str],
    *,
    comment: str = "",
    requirements: Requirements | None = None,
) -> Path:
    """Write a design file, completely or not at all, and return its path.

    Args:
        design: The design.
        path: The file; one that exists is replaced.
        comment: Where the design comes from, for the file's head.
        requirements: What the robot is needed for; nothing is written of none.

    Raises:
        FileError: If the file cannot be written.
    """
    text = write_design(design, comment=comment, requirements=requirements)
    with open_atomically(path) as file:
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
    return read_content(content, source_name).design


def read_content(content: str | bytes, source_name: str) -> DesignContent:
    """Return the design that a file's content describes, and its requirements.

    Args:
        content: As in `read_design`.
        source_name: The file's name, for messages.

    Raises:
        DesignFileError: If it is no valid design file.
    """
    text = decode_text(content, source_name)
    document = parse_toml(text, source_name)
    return content_of(document, text, source_name)


def decode_text(content: str | bytes, source: str) -> str:
    """Return the text of a file's content; refuses what is none, see `read_design`."""
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
    # CR alone ends the lines of old Macintosh programs; tables of other programs are so read too.
    return content.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n")


def parse_toml(text: str, source: str) -> dict[str, Any]:
    """Return a text as TOML; refuses what is none with its line, see `read_design`."""
    for number, line in enumerate(text.split("\n"), 1):
        if len(line) > LONGEST_LINE:
            problem = f"the line is too long (at most {LONGEST_LINE:,} characters)"
            raise DesignFileError(source, problem, line=number)
    try:
        return parse_plain_toml(text)
    except UnusableData as error:
        problem = error.problem if error.path else f"{error.problem} for a design file"
        line = nearest_line(text, error.path)
        raise DesignFileError(
            source, problem, line=line, key=error.path, value=error.value
        ) from error
    except ValueError as error:  # TOMLDecodeError, and Python's own limit on very long integers
        message = str(error)
        found = re.search(r" \(at line (\d+), column \d+\)$", message)
        line = int(found[1]) if found else None
        if "at end of document" in message:
            line = text.rstrip().count("\n") + 1
        if "Cannot overwrite" in message or "Cannot declare" in message:
            problem = "this key or table is in the file twice"
        elif isinstance(error, tomllib.TOMLDecodeError):
            reason = re.sub(r" \(at .*\)$", "", message)
            problem = f"is not valid TOML: {reason[:1].lower()}{reason[1:]}"
            problem += _value_hint(text.split("\n")[line - 1]) if line else ""
        else:
            problem = "holds a number of too many digits"
        raise DesignFileError(source, problem, line=line) from error


def _value_hint(line: str) -> str:
    """Return advice where a line that is no TOML looks like a value written in another way."""
    ways = {
        r"=\s*[+-]?\d+,\d": "decimals are written with a point: 0.35",
        r"=\s*[+-]?\.\d|=\s*[+-]?\d+\.(?!\d)": "a decimal point has digits on both sides: 0.35",
        r"=\s*[+-]?[\d.]+\s*[A-Za-z]": "a value is written without its unit",
        r"^[^#=]*:": "a key and its value have = between them",
        r"^[^#=]*=\s*[A-Za-z]": 'text is written in quotes: name = "robot"',
        # what word processors and web pages make of plain text
        "^[^#]*[\u2012-\u2015\u2212]": "a minus sign is written -",
        "^[^#]*[\u2018-\u201f]": 'quotes are written "',
        "^[^#]*\u00a0": "it has a no-break space; write a plain one",
    }
    return next((f" ({advice})" for way, advice in ways.items() if re.search(way, line)), "")


def content_of(document: dict[str, Any], text: str, source: str) -> DesignContent:
    """Return the content of a parsed document; the text is where lines are looked up."""
    # Late: not needed where no file is read, and its types are built when it is imported.
    from paminsa_viz.files.design_document import WrongDocument, checked_content

    def refused(path: str, value: object, problem: str) -> DesignFileError:
        line = nearest_line(text, path)
        key = re.sub(rf"^({COUNTERWEIGHTS}|{REQUIREMENTS})\.\d+", r"\1", path)
        return DesignFileError(source, problem, line=line, key=key, value=value)

    try:
        content = checked_content(document)
    except WrongDocument as error:
        raise refused(error.path, error.value, error.problem) from error
    name = content.get("name", printable(PurePath(source).stem[:100]))
    if "name" in content and (problem := name_problem(name)):
        raise refused("name", name, problem)
    numbers = {
        key.parameter.path: (content[key.table] if key.table else content)[key.name]
        for key in KEYS
        if key.name in (content.get(key.table, {}) if key.table else content)
    }
    entries = content.get(COUNTERWEIGHTS, [])
    chosen = {
        (table, name): (knee_of if name == KNEE else kind)(content[table][name])
        for (table, name), kind in CHOICES.items()
        if name in content.get(table, {})
    }
    count = content.get("value_count", 0)
    tables = content.get(DRIVES, {})
    needed = (*content.get(REQUIREMENTS, []), content.get(WORKSPACE, {}))
    found = len(numbers) + len(chosen) + sum(map(len, (*entries, *tables.values(), *needed)))
    if found < count:
        problem = (
            f"only {found} values are there, so the file was cut short; if you removed some to use "
            f"Appendix 4's, delete this line too"
        )
        raise refused("value_count", count, problem)
    weights = []
    for index, entry in enumerate(entries):
        values = {field: entry[key] for field, key in COUNTERWEIGHT_KEYS.items()}
        try:
            weights.append(Counterweight(**values | {"bar": entry["bar"].lower()}))
        except InvalidDesign as error:
            key = COUNTERWEIGHT_KEYS[error.field.rpartition(".")[2]]
            path = f"{COUNTERWEIGHTS}.{index}.{key}"
            raise refused(path, error.value, error.allowed) from error
    drives: dict[str, Drive] = {}
    for actuator, table in tables.items():
        values = {field: table[key] for field, key in DRIVE_KEYS.items() if key in table}
        if problem := name_problem(values.get("name", "")):
            raise refused(f"{DRIVES}.{actuator}.name", values["name"], problem)
        try:
            drives[actuator] = Drive(**values)
        except InvalidDesign as error:
            key = DRIVE_KEYS[error.field.rpartition(".")[2]]
            raise refused(f"{DRIVES}.{actuator}.{key}", error.value, error.allowed) from error
    try:
        design = APPENDIX_4.vary(numbers)
        for (group, key), value in chosen.items():
            changed = replace(getattr(design, group), **{key: value})
            design = replace(design, **{group: changed})
        held: Any = tuple(drives.get(actuator) for actuator in ACTUATORS)
        design = replace(design, name=name, counterweights=tuple(weights), drives=held)
        design = renamed_if_changed(design)
    except InvalidDesign as error:
        known = KEY_OF.get(error.field.removeprefix("design."))
        # A length that only contradicts others may be one that the file does not set.
        value = error.value if isinstance(error.value, (int, float)) else None
        path = known.path if known else error.field
        if path.startswith(f"{DRIVES}."):
            table, _, field = path.rpartition(".")
            path = f"{table}.{DRIVE_KEYS.get(field, field)}"
        raise refused(path, value, error.allowed) from error
    if not any(needed):
        return DesignContent(design, None)
    # Late: it brings the registry of quantities.
    from paminsa_viz.files.requirement_tables import read_requirements_tables

    return DesignContent(design, read_requirements_tables(content, refused))
