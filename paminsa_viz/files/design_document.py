"""The content of a design file as msgspec types, and what is wrong where it does not fit."""

from __future__ import annotations

import re
import sys
from typing import Annotated, Any, Literal

from msgspec import UNSET, Meta, Struct, UnsetType, ValidationError, convert, defstruct, to_builtins

from paminsa_viz import old_names
from paminsa_viz.errors import name_hint
from paminsa_viz.files.design_schema import (
    CHOICES,
    COUNTERWEIGHT_KEYS,
    COUNTERWEIGHTS,
    DRIVE_KEYS,
    DRIVES,
    KNEE,
    REQUIREMENTS,
    SCHEMA_VERSION,
    TABLES,
    WORKSPACE,
    WORKSPACE_KEYS,
    key_hint,
    table_hint,
)
from paminsa_viz.model.drive import ACTUATORS, TRANSMISSIONS
from paminsa_viz.model.parameters import BAR_ENDS
from paminsa_viz.model.workspace_shapes import WorkspaceShape

_BARS = tuple(bar.upper() for bar in BAR_ENDS)
_LARGEST = sys.float_info.max
_Number = Annotated[float, Meta(ge=-_LARGEST, le=_LARGEST)]
"""A finite number."""


def _table(name: str, kinds: dict[str, Any]) -> Any:
    """Return the type of a table whose keys may all be left out, and which has no others."""
    items = [(key, kind | UnsetType, UNSET) for key, kind in kinds.items()]
    return defstruct(name, items, forbid_unknown_fields=True)


class CounterweightEntry(Struct, forbid_unknown_fields=True):
    """One table ``[[counterweights]]``."""

    bar: Literal[tuple(_BARS) + tuple(BAR_ENDS)]  # type: ignore[valid-type]
    joint: int
    beyond_m: _Number
    mass_kg: _Number


class RequirementEntry(Struct):
    """One table ``[[requirements]]``; which other keys it may have depends on the quantity."""

    quantity: str


_SHAPES = tuple(shape.value for shape in WorkspaceShape)
WorkspaceTable = _table(
    "WorkspaceTable", dict.fromkeys(WORKSPACE_KEYS, _Number) | {"shape": Literal[_SHAPES]}
)

_DRIVE_KINDS: dict[str, Any] = {
    "name": str,
    "envelope": list[Annotated[list[_Number], Meta(min_length=2, max_length=2)]],
    "transmission": Literal[TRANSMISSIONS],
    "brake": bool,
}
DriveEntry = _table(
    "DriveEntry", {key: _DRIVE_KINDS.get(name, _Number) for name, key in DRIVE_KEYS.items()}
)
DriveTables = _table("DriveTables", dict.fromkeys(ACTUATORS, DriveEntry))


def _words(name: str) -> tuple[str, ...]:
    """Return what a key of `CHOICES` can be."""
    return tuple(word.value for (_, key), kind in CHOICES.items() if key == name for word in kind)


def _old_words(name: str) -> tuple[str, ...]:
    return tuple(old_names.KNEES) if name == KNEE else ()


def _values(table: str) -> dict[str, Any]:
    values: dict[str, Any] = dict.fromkeys(TABLES[table], _Number)
    for place, name in CHOICES:
        if place == table:
            values[name] = Literal[_words(name) + _old_words(name)]
    return values


class Version(Struct):
    """What a file says first, whatever else it has."""

    schema_version: Annotated[int, Meta(ge=1, le=SCHEMA_VERSION)]


DesignDocument = _table(
    "DesignDocument",
    {
        "schema_version": int,
        "name": object,
        "value_count": Annotated[int, Meta(ge=0)],
        **_values(""),
        **{table: _table(table, _values(table)) for table in TABLES if table},
        COUNTERWEIGHTS: list[CounterweightEntry],
        DRIVES: DriveTables,
        REQUIREMENTS: list[RequirementEntry],
        WORKSPACE: WorkspaceTable,
    },
)
"""A whole file; what it leaves out is unset."""


class WrongDocument(Exception):
    """What is wrong with a document: the path, the value and the problem.

    The path is dotted, ``counterweights.1.bar`` in the second counterweight, and empty for a file
    that is no design file. The value is None where it would not help.
    """

    def __init__(self, path: str, value: object, problem: str) -> None:
        super().__init__(problem)
        self.path, self.value, self.problem = path, value, problem


def checked_content(document: dict[str, Any]) -> dict[str, Any]:
    """Return what a document sets, with all numbers as floats.

    Raises:
        WrongDocument: If it does not fit.
    """
    try:
        convert(document, Version)
        content = to_builtins(convert(document, DesignDocument))
    except ValidationError as error:
        raise _problem(str(error), document) from error
    for index, entry in enumerate(document.get(REQUIREMENTS, ())):
        for key, value in entry.items():
            try:
                content[REQUIREMENTS][index][key] = convert(
                    value, str if key == "quantity" else _Number
                )
            except ValidationError as error:
                path = f"{REQUIREMENTS}.{index}.{key}"
                raise WrongDocument(path, value, _wrong_value(key, value)) from error
    return content


_FIELD = re.compile(
    r"Object (missing required|contains unknown) field `(.*?)`(?: - at `\$([^`]*)`)?", re.S
)
"""msgspec's message of a key that is missing or unknown, and its table."""


def _problem(message: str, document: dict[str, Any]) -> WrongDocument:
    """Return what msgspec's message of a document says, in the words of a file."""
    field = _FIELD.fullmatch(message)
    if field and field[3] and f"{field[2]}` - at `${field[3]}" in document:
        return _problem_of_key([], f"{field[2]}` - at `${field[3]}", document)  # such a key
    place = field[3] or "" if field else message.rpartition(" - at `$")[2]
    tables = re.findall(r"\w+", place)
    value: Any = document
    for part in tables:
        value = value[int(part) if isinstance(value, list) else part]
    if field and field[1] == "missing required":
        return WrongDocument(".".join(tables), None, _missing(tables, field[2]))
    if field:
        return _problem_of_key(tables, field[2], value)
    path = ".".join(tables)
    if message.startswith(("Expected `object`", "Expected `array`, ")) and "envelope" not in tables:
        return WrongDocument(path, None, _no_table(tables[0], value))
    return WrongDocument(path, value, _wrong_value(tables[-1], value))


def _problem_of_key(tables: list[str], name: str, table: dict[str, Any]) -> WrongDocument:
    shown = table[name] if tables and tables[0] in (COUNTERWEIGHTS, WORKSPACE) else None
    path = ".".join((*tables, name))
    return WrongDocument(path, shown, _unknown_key(tables, name, table[name]))


def _missing(tables: list[str], name: str) -> str:
    if name == "schema_version":
        return f"is not a design file, or lacks the line {name} = {SCHEMA_VERSION} at its top"
    if tables[0] == REQUIREMENTS:
        return f"{name} is missing; each needs one, and its min or max"
    return f"{name} is missing; each needs {', '.join(COUNTERWEIGHT_KEYS.values())}"


def _unknown_key(tables: list[str], name: str, value: object) -> str:
    if not tables and isinstance(value, dict):
        return f"there is no table of this name; {table_hint(name)}"
    table = tables[0] if tables else ""
    if table == DRIVES:
        if len(tables) == 1:
            return f"there are the tables {', '.join(f'[{DRIVES}.{a}]' for a in ACTUATORS)}"
        return f"there is no such key; {name_hint(name, DRIVE_KEYS.values())}"
    if table == WORKSPACE:
        return f"there is no such key; {name_hint(name, WORKSPACE_KEYS)}"
    if table == COUNTERWEIGHTS:
        keys = ", ".join(COUNTERWEIGHT_KEYS.values())
        return f"there is no such key; [[{COUNTERWEIGHTS}]] has {keys}"
    return f"there is no such key; {key_hint(table, name)}"


def _no_table(table: str, value: object) -> str:
    if table in (COUNTERWEIGHTS, REQUIREMENTS):
        return f"a table [[{table}]] in double brackets is needed for each"
    kind = "in single brackets" if isinstance(value, list) else "of values"
    return f"a table [{table}] {kind} is needed"


_NEEDED = {
    "name": "a text is",
    "value_count": "a whole number is",
    "bar": f"one of the bars {', '.join(_BARS)} is",
    "quantity": 'the name of a quantity, such as "condition", is',
    "transmission": '"screw" or "belt", or nothing, is',
    "brake": "true or false is",
    "envelope": "pairs of speed [rad/s] and torque [N·m], [[0, 1.3], [300, 1.3]], are",
    "joint": "a joint's number is",
}


def _wrong_value(name: str, value: object) -> str:
    whole = isinstance(value, int) and not isinstance(value, bool)
    if name == "schema_version" and isinstance(value, int) and value > SCHEMA_VERSION:
        return (
            f"the file is from a newer paminsa_viz than this one, which reads versions up to "
            f"{SCHEMA_VERSION}; update paminsa_viz"
        )
    if name == "schema_version":
        return f"a whole number is needed; {SCHEMA_VERSION} is the current one"
    if words := _SHAPES if name == "shape" else _words(name):
        return " or ".join(f'"{word}"' for word in words) + " is needed"
    if name.isdecimal():  # a place in an envelope
        name = "envelope"
    if name in _NEEDED:
        return f"{_NEEDED[name]} needed"
    if whole or isinstance(value, float):
        return "a finite number is needed"
    return "a number is needed" + (", without quotes or unit" if isinstance(value, str) else "")
