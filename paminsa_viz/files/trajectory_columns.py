"""Columns of a table of a trajectory: which quantity each one is, and in which unit."""

from __future__ import annotations

import difflib
import math
import re
from dataclasses import dataclass

from paminsa_viz.files.errors import TableFileError, printable, shown
from paminsa_viz.files.pose_columns import ACCELERATION, ACTUATORS, POSE, TORQUES, VELOCITY

TIME = "t_s"
SPEEDS = ("theta1_rate_rad_s", "theta2_rate_rad_s", "theta3_rate_rad_s", "Z_rate_m_s")
POWERS = ("power1_W", "power2_W", "power3_W", "power4_W")
PARTS = ("gravity", "inertial", "velocity", "friction")
STATUS = "status"

WRITTEN = (TIME, *POSE, *VELOCITY, *ACCELERATION)
"""Columns that are read, as they are written: in SI units."""

_LENGTH = {"m": 1.0, "mm": 1e-3}
_ANGLE = {"rad": 1.0, "deg": math.pi / 180}
_TIME = {"s": 1.0, "ms": 1e-3}


def _per(units: dict[str, float], suffix: str) -> dict[str, float]:
    return {f"{unit}_{suffix}": factor for unit, factor in units.items()}


QUANTITIES: dict[str, tuple[str, dict[str, float]]] = {
    "t": (TIME, _TIME),
    "x": (POSE[0], _LENGTH),
    "y": (POSE[1], _LENGTH),
    "theta": (POSE[2], _ANGLE),
    "z": (POSE[3], _LENGTH),
    "vx": (VELOCITY[0], _per(_LENGTH, "s")),
    "vy": (VELOCITY[1], _per(_LENGTH, "s")),
    "omega": (VELOCITY[2], _per(_ANGLE, "s")),
    "vz": (VELOCITY[3], _per(_LENGTH, "s")),
    "ax": (ACCELERATION[0], _per(_LENGTH, "s2")),
    "ay": (ACCELERATION[1], _per(_LENGTH, "s2")),
    "alpha": (ACCELERATION[2], _per(_ANGLE, "s2")),
    "az": (ACCELERATION[3], _per(_LENGTH, "s2")),
}
"""By name: the column in SI units, and the units that may stand behind the name with its factor."""


def part_columns(part: str) -> tuple[str, ...]:
    """Return the names of the columns of one part of the torques, such as ``gravity``."""
    return tuple(re.sub("_(?=[^_]+$)", f"_{part}_", name) for name in TORQUES)


_PART_COLUMNS = [name for part in PARTS for name in part_columns(part)]
RESULTS = frozenset([*ACTUATORS, *SPEEDS, *TORQUES, *POWERS, *_PART_COLUMNS, STATUS])
"""Columns of results, which are left out when a written table is read again."""


@dataclass(frozen=True)
class Column:
    """A column that is read.

    Attributes:
        place: Its place in the row, from 0.
        name: Its name in SI units, one of `WRITTEN`.
        factor: What its numbers are multiplied by.
    """

    place: int
    name: str
    factor: float


def match_columns(header: tuple[str, ...], source: str, row: int = 1) -> tuple[Column, ...]:
    """Say what the columns of a header are.

    A name carries its unit: ``x_mm``, or as people write it ``x [mm]``, ``vx [mm/s]``.

    Raises:
        TableFileError: If a column is unknown, without a name or unit, there twice, or missing.
    """

    def refuse(problem: str, column: str = "") -> TableFileError:
        return TableFileError(source, problem, row=row, column=column)

    if len(header) == 1 and (";" in header[0] or "\t" in header[0]):
        problem = "columns are separated by commas (and decimals written with a point)"
        raise refuse(problem, header[0])
    found: list[Column] = []
    for place, text in enumerate(header):
        if not text:
            raise refuse(f"column {place + 1} has no name")
        if text in RESULTS:
            continue
        name, unit = _split(text)
        if name not in QUANTITIES:
            raise refuse(f"there is no such column; {_hint(text)}", text)
        canonical, units = QUANTITIES[name]
        names = " or ".join(f"{name}_{known}" for known in units)
        if not unit:
            raise refuse(f"its unit is missing; write {names}", text)
        if unit not in units:
            raise refuse(f"{shown(unit)} is no unit of it; write {names}", text)
        if any(column.name == canonical for column in found):
            raise refuse("the column is there twice", text)
        found.append(Column(place, canonical, units[unit]))
    present = {column.name for column in found}
    groups = (
        ("a trajectory needs", (TIME, *POSE)),
        ("with velocity columns come", VELOCITY),
        ("with acceleration columns come", (*VELOCITY, *ACCELERATION)),
    )
    needed = (True, bool(present & set(VELOCITY)), bool(present & set(ACCELERATION)))
    for (words, names), wanted in zip(groups, needed, strict=True):
        absent = [name for name in names if name not in present]
        if wanted and absent:
            raise refuse(f"the column is missing; {words} {','.join(names)}", absent[0])
    return tuple(found)


def _split(text: str) -> tuple[str, str]:
    """Return the name and the unit of a header cell, the latter in the spelling of a column."""
    bracketed = re.fullmatch(r"(\S+)\s*[\[(](.*)[\])]", text)
    if bracketed:
        name, unit = bracketed[1], bracketed[2]
        for old, new in (("°", "deg"), ("²", "2"), ("^", ""), ("/", "_"), (" ", "")):
            unit = unit.replace(old, new)
    else:
        name, _, unit = text.partition("_")
    return {"time": "t", "θ": "theta"}.get(name, name), unit


def _hint(text: str) -> str:
    try:
        float(text)
    except ValueError:
        pass
    else:
        return f"a row has to name the columns first: {','.join((TIME, *POSE))}"
    near = [name for name in WRITTEN if name.lower() == text.lower()]
    near = near or difflib.get_close_matches(printable(text[:50]), WRITTEN, 1, 0.6)
    return f"did you mean {near[0]}?" if near else f"there are {','.join(WRITTEN)}"
