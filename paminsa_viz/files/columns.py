"""Columns of tables: their names, with units, and which of them a kind of table has to have."""

from __future__ import annotations

import difflib
from dataclasses import dataclass, replace

from paminsa_viz.errors import TableFileError, printable
from paminsa_viz.files.errors import shown
from paminsa_viz.units import COLUMN_UNITS, read_number

TIME = "t_s"
POSE = ("x_m", "y_m", "theta_rad", "z_m")
VELOCITY = ("vx_m_s", "vy_m_s", "omega_rad_s", "vz_m_s")
ACCELERATION = ("ax_m_s2", "ay_m_s2", "alpha_rad_s2", "az_m_s2")
LOAD = ("Fx_N", "Fy_N", "Fz_N", "Mx_Nm", "My_Nm", "Mz_Nm")
ACTUATORS = ("theta1_rad", "theta2_rad", "theta3_rad", "Z_m")
SPEEDS = ("theta1_rate_rad_s", "theta2_rate_rad_s", "theta3_rate_rad_s", "Z_rate_m_s")
TORQUES = ("tau1_Nm", "tau2_Nm", "tau3_Nm", "f4_N")
POWERS = ("power1_W", "power2_W", "power3_W", "power4_W")
BAR_LOADS = ("N_N", "V_N", "M_Nm")
PARTS = ("gravity", "inertial", "velocity", "friction", "load")
STATUS = "status"
WANTED = ("wanted_x_m", "wanted_y_m", "wanted_theta_rad", "wanted_z_m")
ENERGIES = ("work_J", "friction_loss_J", "energy_drift_J")


def part_columns(part: str) -> tuple[str, ...]:
    """Return the columns of one part of the torques: ``tau1_gravity_Nm`` and so on."""
    return tuple(f"_{part}_".join(name.split("_")) for name in TORQUES)


RESULTS = frozenset(
    [
        *ACTUATORS, *SPEEDS, *TORQUES, *POWERS, STATUS, *WANTED, *ENERGIES,
        *(c for p in PARTS for c in part_columns(p)),
    ]
)  # fmt: skip
"""Columns that are computed; tables hold them next to those that are read."""


@dataclass(frozen=True)
class TableKind:
    """What a table has to hold to be read.

    Attributes:
        name: What one row is or all of them are, in words.
        needed: Columns that have to be there.
        groups: Columns that come together: name of the group, its columns, and those that have to
            be there if any of them is.
        reads_back: Whether columns of results are left out instead of refused, so that a written
            table can be read again.
        whole: What the table as a whole is and is for, where another kind is expected; empty if
            it is not told apart.
    """

    name: str
    needed: tuple[str, ...]
    groups: tuple[tuple[str, tuple[str, ...], tuple[str, ...]], ...]
    reads_back: bool
    whole: str = ""

    @property
    def columns(self) -> tuple[str, ...]:
        """Every column that is read, in SI units."""
        return self.needed + tuple(name for _, names, _ in self.groups for name in names)


POSES = TableKind(
    "a pose",
    POSE,
    (
        ("velocity", VELOCITY, VELOCITY),
        ("acceleration", ACCELERATION, ACCELERATION),
        ("load", LOAD, ()),
    ),
    reads_back=False,
    whole="a list of poses, to evaluate",
)
TRAJECTORY = TableKind(
    "a trajectory",
    (TIME, *POSE),
    (
        ("velocity", VELOCITY, VELOCITY),
        ("acceleration", ACCELERATION, VELOCITY + ACCELERATION),
        ("load", LOAD, ()),
    ),
    reads_back=True,
    whole="a motion",
)
WAYPOINTS = replace(
    TRAJECTORY, name="a waypoint", needed=POSE, groups=(("time", (TIME,), ()), *TRAJECTORY.groups)
)
PUBLISHED = TableKind(
    "a table of torques over time", (TIME,), (("torque", TORQUES, ()),), reads_back=True
)
PUBLISHED_MAP = TableKind(
    "a table of torques over positions", ("x_m", "y_m"), (("torque", TORQUES, ()),), reads_back=True
)
MEASURED = ("torque1_Nm", "torque2_Nm", "torque3_Nm", "force4_N")
CURRENTS = ("current1_A", "current2_A", "current3_A", "current4_A")
LOG = TableKind(
    "a log",
    (TIME, *ACTUATORS),
    (("torque", MEASURED, MEASURED), ("current", CURRENTS, CURRENTS)),
    reads_back=True,
    whole="a log, to identify a robot from",
)
TILT = ("tiltx_rad", "tilty_rad")
MEASUREMENTS = TableKind(
    "a measured pose",
    (*POSE, *ACTUATORS),
    (("tilt", TILT, TILT),),
    reads_back=True,
    whole="measured poses, to calibrate a robot with",
)
_TOLD_APART = (POSES, TRAJECTORY, LOG, MEASUREMENTS)
"""Kinds of tables that one could take for each other."""


@dataclass(frozen=True)
class Column:
    """A column that is read.

    Attributes:
        place: Its place in the row, from 0.
        header: Its name as the file has it.
        name: Its name in SI units, one of `TableKind.columns`.
        factor: What its numbers are multiplied by.
    """

    place: int
    header: str
    name: str
    factor: float = 1.0


def match_columns(
    header: tuple[str, ...], kind: TableKind, source: str, row: int
) -> tuple[Column, ...]:
    """Return the columns of a header that are read.

    A name has the unit that the file has the numbers in: ``x_m``, ``x_mm``, ``vx [mm/s]``.

    Raises:
        TableFileError: If a column is unknown, without a name or unit, there twice, or missing.
    """

    def refused(problem: str, column: str = "") -> TableFileError:
        return TableFileError(source, problem, row=row, column=column)

    if not any(header):
        needed = ",".join(kind.needed)
        raise refused(f"the row is empty, but has to name the columns: {needed}")
    found: dict[str, Column] = {}
    for place, text in enumerate(header):
        if not text:
            raise refused(f"column {place + 1} has no name")
        if text in RESULTS and kind.reads_back and text not in kind.columns:
            continue
        column = _column(place, text, kind)
        if isinstance(column, str):
            raise refused(column or f"there is no such column; {_hint(text, header, kind)}", text)
        if column.name in found:
            raise refused("the column is there twice", text)
        found[column.name] = column
    groups = [(f"{kind.name} needs", kind.needed, kind.needed)]
    groups += [(f"with {group} columns come", *names) for group, *names in kind.groups]
    for words, names, needed in groups:
        absent = [name for name in needed if name not in found]
        if absent and (names is kind.needed or any(name in found for name in names)):
            written = _in_their_units(needed, tuple(found.values()))
            missing = written[needed.index(absent[0])]
            raise refused(f"the column is missing; {words} {','.join(written)}", missing)
    return tuple(found.values())


def _column(place: int, text: str, kind: TableKind) -> Column | str:
    """Return the column of a header cell, or what is wrong with its unit, empty if unknown."""
    name, unit = _split(text)
    for column in kind.columns:
        if column.partition("_")[0] == name:
            units = _units(column)
            if unit in units:
                return Column(place, text, column, units[unit])
            names = " or ".join(_spellings(column))
            wrong = f"{shown(unit)} is no unit of it" if unit else "its unit is missing"
            return f"{wrong}; write {names}"
    return ""


def _units(column: str) -> dict[str, float]:
    """Return the units that a column may be in, its own first, with the factor to that one."""
    base, slash, per = column.partition("_")[2].partition("_")
    written = next(each for each in COLUMN_UNITS.values() if each.get(base) == 1.0)
    return {known + slash + per: factor for known, factor in written.items()}


def _spellings(column: str) -> list[str]:
    """Return the names of a column in all of its units: ``x_m`` and ``x_mm``."""
    return [f"{column.partition('_')[0]}_{unit}" for unit in _units(column)]


def _in_their_units(names: tuple[str, ...], found: tuple[Column, ...]) -> list[str]:
    """Return names of columns in the units in which a file has others of their kind."""
    units = {column.name.partition("_")[2]: _split(column.header)[1] for column in found}
    parts = [name.partition("_") for name in names]
    return [f"{start}_{units.get(unit, unit)}" for start, _, unit in parts]


def _split(text: str) -> tuple[str, str]:
    """Return the name and the unit of a header cell, the latter in the spelling of a column."""
    name, unit = text.partition("_")[::2]
    opening = min((place for place in map(text.find, "[(") if place > 0), default=0)
    if opening and text[-1] in ")]":
        name, unit = text[:opening].rstrip(), text[opening + 1 : -1]
        for old, new in (("°", "deg"), ("²", "2"), ("^", ""), ("/", "_"), (" ", "")):
            unit = unit.replace(old, new)
    return {"time": "t", "θ": "theta"}.get(name, name), unit


def _hint(name: str, header: tuple[str, ...], kind: TableKind) -> str:
    """Return advice for an unknown column."""
    if read_number(name) is not None:
        return f"the first row has to name the columns: {','.join(kind.needed)}"
    if other := _other_kind(name, header, kind):
        needed = ",".join(kind.needed)
        return f"the table looks like {other.whole}; {kind.name} needs {needed}"
    spellings = [spelling for column in kind.columns for spelling in _spellings(column)]
    near = [known for known in spellings if known.lower() == name.lower()]
    if name in RESULTS and not (near and near[0] not in header):
        return "it is a result, which is computed and not read; remove it"
    near = near or difflib.get_close_matches(printable(name[:50]), spellings, 1, 0.6)
    return f"did you mean {near[0]}?" if near else f"there are {','.join(kind.columns)}"


def _other_kind(name: str, header: tuple[str, ...], kind: TableKind) -> TableKind | None:
    """Return the other kind of table that a header with an unknown column is one of, if any."""
    if name in RESULTS:
        return None

    def known(text: str, other: TableKind) -> str:
        column = _column(0, text, other)
        return column.name if isinstance(column, Column) else ""

    fits: list[tuple[int, TableKind]] = []
    for other in _TOLD_APART:
        if other is not kind and known(name, other):
            there = {known(text, other) for text in header} - {""}
            if there.issuperset(other.needed):
                fits.append((len(there), other))
    return max(fits, key=lambda fit: fit[0])[1] if fits else None
