"""A design as text: TOML with a comment on every value, which `read_design` takes back exactly."""

from __future__ import annotations

import sys
from dataclasses import fields
from typing import TYPE_CHECKING

from paminsa_viz.errors import printable
from paminsa_viz.files.design_schema import (
    CHOICE_MEANINGS,
    CHOICES,
    COUNTERWEIGHT_KEYS,
    COUNTERWEIGHTS,
    DRIVE_KEYS,
    DRIVE_MEANINGS,
    DRIVES,
    OPTIONAL_TABLES,
    SCHEMA_VERSION,
    TABLES,
    DesignKey,
    choice,
)
from paminsa_viz.files.errors import DesignFileError
from paminsa_viz.model.design import APPENDIX_4, Design
from paminsa_viz.model.drive import ACTUATORS, Drive

if TYPE_CHECKING:
    from paminsa_viz.quantities.requirements import Requirements

HEADER = """\
Design of a PAMINSA manipulator. All values are in SI units, named at the end of each key.
A value that is left out is Appendix 4's (delete value_count when you leave some out)."""

_COUNTERWEIGHT_COMMENTS = (
    "bar of each leg, B3, B4, B7 or B8",
    "end of the bar that its place is measured from",
    "beyond that joint, away from the bar's other end; negative: on the bar",
    "on each of the three legs",
)

NAME_CHARACTERS = 200
"""Longest name of a design."""


def name_problem(name: object) -> str:
    """Return why a design's name cannot be written, or an empty string if it can."""
    if not isinstance(name, str) or len(name) > NAME_CHARACTERS or not name.isprintable():
        return f"a name is one line of printable text of at most {NAME_CHARACTERS} characters"
    return ""


def write_design(
    design: Design, *, comment: str = "", requirements: Requirements | None = None
) -> str:
    """Return the text of a design file that reads back as the same design, to the last digit.

    Args:
        design: The design.
        comment: Where the file comes from, for its head; may have several lines.
        requirements: What the robot is needed for; nothing is written of none.

    Raises:
        DesignFileError: If the design's name cannot be written.
    """
    for name in (design.name, *(drive.name for drive in design.drives if drive is not None)):
        if problem := name_problem(name):
            raise DesignFileError("design", problem, key="name", value=name)
    head = [*HEADER.splitlines(), *comment.splitlines()]
    lines = [f"# {printable(line)}".rstrip() for line in head]
    body: list[str] = []
    for table, keys in TABLES.items():
        if table in OPTIONAL_TABLES:
            body += _optional_table(design, table)
            continue
        body += ["", f"[{table}]  {_table_comment(table)}".rstrip()] if table else []
        body += _aligned(
            [(_assignment(design, key), _comment(design, key)) for key in keys.values()]
        )
        for place, name in CHOICES:
            value = choice(design, place, name)
            if place == table and value is not choice(APPENDIX_4, place, name):
                body += _aligned([(f'{name} = "{value.value}"', CHOICE_MEANINGS[name])])
    for weight in design.counterweights:
        values = (f'"{weight.bar.upper()}"', weight.joint, weight.beyond, weight.mass)
        texts = [f"{key} = {v}" for key, v in zip(COUNTERWEIGHT_KEYS.values(), values, strict=True)]
        body += ["", f"[[{COUNTERWEIGHTS}]]"]
        body += _aligned(list(zip(texts, _COUNTERWEIGHT_COMMENTS, strict=True)))
    for actuator, drive in zip(ACTUATORS, design.drives, strict=True):
        if drive is not None:
            body += ["", f"[{DRIVES}.{actuator}]", *_aligned(_drive_rows(drive))]
    if requirements is not None:
        # Late: not needed without, and it brings the registry of quantities.
        from paminsa_viz.files.requirement_tables import requirements_rows

        for heading, rows in requirements_rows(requirements):
            body += ["", heading, *_aligned(rows)]
    count = sum("=" in line and not line.startswith("#") for line in body)
    # The version comes last, as a file without it is no design file: no cut goes unnoticed.
    lines += ["", f"name = {quoted(design.name)}"]
    lines += [f"value_count = {count}  # so that a file that was cut short is noticed"]
    lines += [f"schema_version = {SCHEMA_VERSION}"]
    return "\n".join([*lines, *body]) + "\n"


def _optional_table(design: Design, table: str) -> list[str]:
    """Return a table with the values that are not the default, nothing if all are."""
    rows = []
    for key in TABLES[table].values():
        value = design.stored(key.parameter.path)
        if value != APPENDIX_4.stored(key.parameter.path):
            rows.append(
                (f"{key.name} = {value!r}", f"{key.parameter.symbol}, {key.parameter.label}")
            )
    return ["", f"[{table}]  {_table_comment(table)}".rstrip(), *_aligned(rows)] if rows else []


def _drive_rows(drive: Drive) -> list[tuple[str, str]]:
    """Return the assignments of a drive that are not the default, and their comments."""
    rows = []
    for item in fields(Drive):
        value = getattr(drive, item.name)
        if value == item.default:
            continue
        if isinstance(value, tuple):
            text = f"[{', '.join(f'[{speed!r}, {torque!r}]' for speed, torque in value)}]"
        elif isinstance(value, str):
            text = quoted(value)
        else:
            text = repr(value).lower() if isinstance(value, bool) else repr(value)
        rows.append((f"{DRIVE_KEYS[item.name]} = {text}", DRIVE_MEANINGS[item.name]))
    return rows


def quoted(text: str) -> str:
    """Return a line of text as a TOML string."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


def _aligned(rows: list[tuple[str, str]]) -> list[str]:
    """Return lines of TOML with their comments below each other, in plain letters."""
    width = max((len(text) for text, _ in rows), default=0)
    plain = [comment.replace("’", "'") for _, comment in rows]
    return [f"{text:<{width}}  # {told}" for (text, _), told in zip(rows, plain, strict=True)]


def _assignment(design: Design, key: DesignKey) -> str:
    """Return a key with its value, commented out if the value follows from others (the stroke)."""
    text = f"{key.name} = {design.value(key.parameter.path)!r}"
    unset = design.stored(key.parameter.path) is None
    return f"# {text}" if unset else text


def _comment(design: Design, key: DesignKey) -> str:
    parameter = key.parameter
    text = f"{parameter.symbol}, {parameter.label}"
    if design.value(parameter.path) != parameter.default:
        text += f" (Appendix 4: {parameter.default!r})"
    return text


def _table_comment(table: str) -> str:
    """Return the first sentence of the group's own documentation, which python -OO leaves out."""
    if sys.flags.optimize > 1:
        return ""
    text = (type(getattr(APPENDIX_4, table)).__doc__ or "").strip().splitlines()
    return f"# {text[0].rstrip('.')}" if text else ""
