"""The content of a design file as a pydantic model, and what is wrong where it does not fit.

Imported when the first file is read: pydantic takes 0.1 s to load.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, create_model
from pydantic_core import ErrorDetails

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

_BARS = tuple(bar.upper() for bar in BAR_ENDS)
_CLOSED = ConfigDict(extra="forbid", strict=True)
_Number = Annotated[float, Field(allow_inf_nan=False)]


class CounterweightEntry(BaseModel):
    """One table ``[[counterweights]]``."""

    model_config = _CLOSED
    bar: Literal[tuple(_BARS) + tuple(BAR_ENDS)]  # type: ignore[valid-type]
    joint: int
    beyond_m: _Number
    mass_kg: _Number


class RequirementEntry(BaseModel):
    """One table ``[[requirements]]``; which keys it may have depends on the quantity."""

    model_config = ConfigDict(extra="allow", strict=True)
    __pydantic_extra__: dict[str, _Number]  # pyright: ignore[reportIncompatibleVariableOverride, reportGeneralTypeIssues]
    quantity: str


_SHAPES = ("cylinder", "box")
_workspace_fields: Any = dict.fromkeys(WORKSPACE_KEYS, (_Number, None))
WorkspaceTable = create_model(
    "WorkspaceTable",
    __config__=_CLOSED,
    **_workspace_fields | {"shape": (Literal[_SHAPES], None)},
)


_DRIVE_KINDS: dict[str, Any] = {
    "name": str,
    "envelope": list[Annotated[list[_Number], Field(min_length=2, max_length=2)]],
    "transmission": Literal[TRANSMISSIONS],
    "brake": bool,
}
_drive_fields: Any = {
    key: (_DRIVE_KINDS.get(name, _Number), None) for name, key in DRIVE_KEYS.items()
}
DriveEntry = create_model("DriveEntry", __config__=_CLOSED, **_drive_fields)
DriveTables = create_model(
    "DriveTables", __config__=_CLOSED, **dict.fromkeys(ACTUATORS, (DriveEntry, None))
)


def _words(name: str) -> tuple[str, ...]:
    """Return what a key of `CHOICES` can be."""
    return tuple(word.value for (_, key), kind in CHOICES.items() if key == name for word in kind)


def _old_words(name: str) -> tuple[str, ...]:
    return tuple(old_names.KNEES) if name == KNEE else ()


def _values(table: str) -> dict[str, Any]:
    values: dict[str, Any] = dict.fromkeys(TABLES[table], (_Number, None))
    for place, name in CHOICES:
        if place == table:
            values[name] = (Literal[_words(name) + _old_words(name)], None)
    return values


_FIELDS: dict[str, Any] = {
    "schema_version": (Annotated[int, Field(ge=1, le=SCHEMA_VERSION)], ...),
    "name": (Any, None),
    "value_count": (Annotated[int, Field(ge=0)], 0),
    **_values(""),
    **{
        table: (create_model(table, __config__=_CLOSED, **_values(table)), None)
        for table in TABLES
        if table
    },
    COUNTERWEIGHTS: (list[CounterweightEntry], []),
    DRIVES: (DriveTables, None),
    REQUIREMENTS: (list[RequirementEntry], []),
    WORKSPACE: (WorkspaceTable, None),
}
DesignDocument = create_model("DesignDocument", __config__=_CLOSED, **_FIELDS)
"""A whole file; what it leaves out is unset."""


def first_error(error: ValidationError) -> tuple[str, object, str]:
    """Return the path, the value and the problem of the error to show.

    The path is dotted, ``counterweights.1.bar`` in the second counterweight, and empty for a file
    that is no design file. The value is None where it would not help.
    """
    details = error.errors(include_url=False, include_context=False)
    # A misspelled key comes before the one that is missing because of it.
    chosen = min(details, key=lambda e: (e["loc"][0] != "schema_version", e["type"] == "missing"))
    *tables, name = map(str, chosen["loc"])
    path = ".".join((*tables, name))
    if chosen["type"] == "missing":
        return ".".join(tables), None, _missing(tables, name)
    if chosen["type"] == "extra_forbidden":
        listed = bool(tables) and tables[0] in (COUNTERWEIGHTS, WORKSPACE)
        return path, chosen["input"] if listed else None, _unknown_key(tables, name, chosen)
    if chosen["type"] in ("model_type", "list_type"):
        return path, None, _no_table(tables[0] if tables else name, chosen)
    return path, chosen["input"], _wrong_value(name, chosen)


def _missing(tables: list[str], name: str) -> str:
    if name == "schema_version":
        return f"is not a design file, or lacks the line {name} = {SCHEMA_VERSION} at its top"
    if tables[0] == REQUIREMENTS:
        return f"{name} is missing; each needs one, and its min or max"
    return f"{name} is missing; each needs {', '.join(COUNTERWEIGHT_KEYS.values())}"


def _unknown_key(tables: list[str], name: str, error: ErrorDetails) -> str:
    if not tables and isinstance(error["input"], dict):
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


def _no_table(table: str, error: ErrorDetails) -> str:
    if table in (COUNTERWEIGHTS, REQUIREMENTS):
        return f"a table [[{table}]] in double brackets is needed for each"
    kind = "in single brackets" if isinstance(error["input"], list) else "of values"
    return f"a table [{table}] {kind} is needed"


_NEEDED = {
    "value_count": "a whole number is",
    "bar": f"one of the bars {', '.join(_BARS)} is",
    "quantity": 'the name of a quantity, such as "condition", is',
    "transmission": '"screw" or "belt", or nothing, is',
    "brake": "true or false is",
    "envelope": "pairs of speed [rad/s] and torque [N m], [[0, 1.3], [300, 1.3]], are",
    "joint": "a joint's number is",
}


def _wrong_value(name: str, error: ErrorDetails) -> str:
    kind = error["type"]
    value = error["input"]
    if name == "schema_version" and kind == "less_than_equal":
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
    if kind == "finite_number" or (isinstance(value, int) and not isinstance(value, bool)):
        return "a finite number is needed"
    return "a number is needed" + (", without quotes or unit" if isinstance(value, str) else "")
