"""Names of a design file's tables and keys, made from the model's own list of parameters.

A key is the field's name followed by its unit, so ``Geometry.base_radius`` [m] is ``base_radius_m``
in the table ``[geometry]``. A new field of the design gets its key without a change here.
"""

from __future__ import annotations

import difflib
import re
from dataclasses import dataclass, fields
from enum import Enum

from paminsa_viz import old_names
from paminsa_viz.errors import name_hint
from paminsa_viz.model.design import OPTIONAL_GROUPS, PARAMETER, Design, KneeBranch
from paminsa_viz.model.drive import Drive
from paminsa_viz.model.load import LoadFrame
from paminsa_viz.model.parameters import Parameter
from paminsa_viz.model.workspace_shapes import WorkspaceShape

SCHEMA_VERSION = 1
"""Version of the layout; raised when a key changes its name, place or meaning, not when one is
added."""

FILE_KEYS = ("schema_version", "name", "value_count")
"""Keys that describe the file and not the robot."""

COUNTERWEIGHTS = "counterweights"
"""Name of the tables ``[[counterweights]]``, one for each."""

COUNTERWEIGHT_KEYS = {"bar": "bar", "joint": "joint", "beyond": "beyond_m", "mass": "mass_kg"}
"""Keys of a counterweight by the names of its fields; each of them has to be there."""

KNEE = "knee"
"""Key of the knee's branch in ``[geometry]``; written where it is not the default."""

DRIVES = "drives"
"""Name of the tables ``[drives.M1]`` .. ``[drives.M4]``; only those that are there are written."""

REQUIREMENTS = "requirements"
"""Name of the tables ``[[requirements]]``, one for each, see `requirement_tables`."""

WORKSPACE = "workspace"
"""Name of the table of the headings and the workspace that are required."""

WORKSPACE_SIZES = tuple(key for shape in WorkspaceShape for key in shape.section.sizes)
"""Keys of the sizes of all shapes of a workspace in that table."""

WORKSPACE_KEYS = (
    "theta_min_rad", "theta_max_rad", "shape", *WORKSPACE_SIZES,
    "center_x_m", "center_y_m", "center_z_m",
)  # fmt: skip
"""Keys of that table."""

FRAME = "frame"
"""Key in ``[load]`` of what the load's direction is fixed in; written where it is not the world."""

CHOICES: dict[tuple[str, str], type[Enum]] = {
    ("geometry", KNEE): KneeBranch,
    ("load", FRAME): LoadFrame,
}
"""Keys whose values are words, by table and name."""

CHOICE_MEANINGS = {
    KNEE: "branch of the knee 9: lower as Appendix 1 prints it, or upper, its mirror image",
    FRAME: "what the load’s direction is fixed in: the world, or the platform",
}


def knee_of(word: str) -> KneeBranch:
    """Return the branch of the knee that a file names, by its word of today or an old one.

    Raises:
        ValueError: If the word is none of them.
    """
    return KneeBranch(old_names.KNEES.get(word, word))


def choice(design: Design, table: str, name: str) -> Enum:
    """Return a value of `CHOICES`."""
    return getattr(getattr(design, table), name)


def unit_suffix(unit: str) -> str:
    """Return a unit as it ends a key: ``"kg m^2"`` gives ``"_kg_m2"``, ``""`` gives ``""``."""
    text = unit.replace(", ", " or ").replace("/", " per ").replace("N m", "Nm").replace("^", "")
    text = re.sub(r"[^A-Za-z0-9]+", "_", text).strip("_")
    return f"_{text}" if text else ""


@dataclass(frozen=True)
class DesignKey:
    """One number of a design file.

    Attributes:
        table: Name of its table, empty for a number at the top of the file.
        name: Name of the key, with its unit.
        parameter: The design's number.
    """

    table: str
    name: str
    parameter: Parameter

    @property
    def path(self) -> str:
        """Dotted name in the file, for example ``"links.b3_kg"``."""
        return f"{self.table}.{self.name}" if self.table else self.name


def _key(parameter: Parameter) -> DesignKey:
    table, _, field = parameter.path.rpartition(".")
    return DesignKey(table, field + unit_suffix(parameter.unit), parameter)


DRIVE_KEYS: dict[str, str] = {
    item.name: item.name + unit_suffix(item.metadata.get("unit", "")) for item in fields(Drive)
}
"""Keys of a drive by the names of its fields; all may be left out but the lead of M4's."""

_MEANINGS = {
    "name": "motor and gear",
    "envelope": "corners of the torque over the speed [rad/s, N·m], at the motor shaft",
    "transmission": "what turns the gear’s output into a straight motion",
    "brake": "holds the load while the robot waits",
}

DRIVE_MEANINGS: dict[str, str] = {
    item.name: _MEANINGS.get(item.name) or f"{item.metadata['symbol']}, {item.metadata['label']}"
    for item in fields(Drive)
}
"""What a drive's values mean, by the names of its fields."""

KEYS: tuple[DesignKey, ...] = tuple(_key(parameter) for parameter in PARAMETER.values())
"""Every number that a design file can hold, in the design's order."""

KEY_OF: dict[str, DesignKey] = {key.parameter.path: key for key in KEYS}
"""Keys by the dotted path of the design's number."""

OPTIONAL_TABLES = OPTIONAL_GROUPS
"""Tables of which only the values are written that are not the default."""

TABLES: dict[str, dict[str, DesignKey]] = {
    table: {key.name: key for key in KEYS if key.table == table}
    for table in dict.fromkeys(["", *(key.table for key in KEYS)])
}
"""Keys by table and name. Numbers outside any table, under ``""``, come first: below a table's
heading they would belong to it."""


def table_hint(name: str) -> str:
    """Return advice for an unknown table: the nearest one, or all there are."""
    tables = [*(table for table in TABLES if table), WORKSPACE, REQUIREMENTS]
    return name_hint(f"[{name[:100].lower()}]", [f"[{table}]" for table in tables])


def key_hint(table: str, name: str) -> str:
    """Return advice for an unknown key: the nearest key, here or in another table."""
    name = name[:100]
    by_symbol = [key for key in KEYS if _names_symbol(name, key.parameter.symbol)]
    elsewhere = [key for key in KEYS if key.name == name]
    if by_symbol or elsewhere:
        return _did_you_mean(table, (by_symbol or elsewhere)[0])
    chosen = [key for of_table, key in CHOICES if of_table == table]
    here = [*TABLES[table], *chosen, *(() if table else FILE_KEYS)]
    near = difflib.get_close_matches(name, here, 1, 0.6)
    if near:
        key = TABLES[table].get(near[0])
        return _did_you_mean(table, key) if key else f"did you mean {near[0]}?"
    near = difflib.get_close_matches(name, [key.name for key in KEYS], 1, 0.7)
    if near:
        return _did_you_mean(table, next(key for key in KEYS if key.name == near[0]))
    return name_hint(name, here, there=f"[{table}] has" if table else "there are")


def _names_symbol(name: str, symbol: str) -> bool:
    """Whether an unknown key is the paper's symbol, with or without a unit: l_B7, R_b_m."""
    words = [word for word in re.findall(r"[A-Za-z_0-9]+", symbol) if len(word) > 2]
    return any(name == word or name.startswith(f"{word}_") for word in words)


def _did_you_mean(table: str, key: DesignKey) -> str:
    where = "" if key.table == table else f" in [{key.table}]" if key.table else " at the top"
    return f"did you mean {key.name}{where} ({key.parameter.symbol}, {key.parameter.label})?"
