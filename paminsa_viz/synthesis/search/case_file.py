"""Case files: a design file with requirements and a table ``[synthesis]``.

    [workspace]
    theta_min_rad = -0.5236
    theta_max_rad = 0.5236
    shape = "cylinder"
    diameter_m = 0.3
    height_m = 0.4

    [[requirements]]
    quantity = "condition"
    max = 10.0

    [synthesis]
    objective = "footprint"

    [synthesis.ranges]
    base_radius_m = [0.1, 0.6]
    magnification = [1.5, 5.0]

    [synthesis.limits]
    footprint_m = 0.58

The design of the file is the reference, Appendix 4 where it says nothing. Motions, masses,
counterweights and springs that are chosen for each set of lengths are described in `inner_file`.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any, NoReturn

from paminsa_viz.errors import InvalidInput, name_hint
from paminsa_viz.files.atomic import as_file_error
from paminsa_viz.files.design_file import LARGEST_FILE, content_of, decode_text, parse_toml
from paminsa_viz.files.design_schema import KEYS, unit_suffix
from paminsa_viz.files.errors import DesignFileError
from paminsa_viz.files.toml_lines import find_line
from paminsa_viz.synthesis.search.case import (
    DIMENSIONS,
    Effort,
    Guide,
    ObjectiveLimit,
    Regime,
    SearchRange,
    SynthesisCase,
)
from paminsa_viz.synthesis.search.mass_tables import INNER_KEYS, read_inner
from paminsa_viz.synthesis.search.objectives import OBJECTIVES
from paminsa_viz.units import si_unit

TABLE = "synthesis"

EXAMPLES: dict[str, Path] = {
    path.stem: path for path in sorted((Path(__file__).parent / "cases").glob("*.toml"))
}
"""Worked cases by name."""

RANGE_KEYS: dict[str, str] = {
    **{key.name: key.parameter.path for key in KEYS if key.table == "geometry"},
    **{path.replace(".", "_") + "_m": path for path in DIMENSIONS},
}
"""Keys of ``[synthesis.ranges]`` and the paths that they are."""

LIMIT_KEYS: dict[str, str] = {
    item.key + unit_suffix(si_unit(item.unit)): item.key for item in OBJECTIVES.values()
}
"""Keys of ``[synthesis.limits]`` and the objectives that they are."""

REGIMES: dict[str, Regime] = {"smaller": Regime.SMALLER, "larger": Regime.LARGER}
"""Words for R_pl < R_b and for R_pl > R_b."""

_KINDS: dict[str, tuple[type, ...]] = {
    "objective": (str,), "margin_m": (int, float), "guide": (str,), "scale_bars": (bool,),
    "arm_follows": (bool,), "above_guides": (bool,), "regimes": (list,), "seed": (int,),
    "generations": (int,), "population": (int,), "ranges": (dict,), "limits": (dict,),
}  # fmt: skip
_PLAIN = ("objective", "scale_bars", "arm_follows", "above_guides", "seed")
_NEEDED = {str: "a word", bool: "true or false", list: "a list", dict: "a table", int: "a number"}

_KEY_OF_FIELD = {
    "effort.generations": "generations", "effort.population": "population", "margin": "margin_m",
}  # fmt: skip


def load_case(path: str | os.PathLike[str]) -> SynthesisCase:
    """Read a case file.

    Raises:
        DesignFileError: If the file cannot be read or is no valid case file.
    """
    try:
        with open(path, "rb") as file:
            data = file.read(LARGEST_FILE + 1)
    except (OSError, ValueError) as error:
        raise as_file_error(os.fspath(path), error, "read", DesignFileError) from error
    return read_case(data, os.fspath(path))


def read_case(content: str | bytes, source: str) -> SynthesisCase:
    """Return the case that a file's content describes.

    Args:
        content: The file's text or bytes.
        source: The file's name, for messages.

    Raises:
        DesignFileError: If it is no valid case file.
    """
    text = decode_text(content, source)
    document = parse_toml(text, source)
    table = document.pop(TABLE, None)
    design = content_of(document, text, source)
    reader = _Reader(text, source)
    if not isinstance(table, dict):
        reader.refuse("", None, f"a table [{TABLE}] is needed, which says what to search")
    if design.requirements is None:
        reader.refuse("", None, "a table [workspace] is needed, over which requirements hold")
    reader.check(table)
    ranges = table.get("ranges", {})
    limits = table.get("limits", {})
    counts = {name: table[name] for name in ("generations", "population") if name in table}
    name = document.get("name", Path(source).stem)
    try:
        given: dict[str, Any] = {
            key: table[key] for key in _PLAIN
            if key in table
        }  # fmt: skip
        if "margin_m" in table:
            given["margin"] = float(table["margin_m"])
        if "guide" in table:
            given["guide"] = reader.word("guide", table["guide"], {g.value: g for g in Guide})
        if "regimes" in table:
            given["regimes"] = tuple(reader.word("regimes", w, REGIMES) for w in table["regimes"])
        return SynthesisCase(
            design.requirements,
            tuple(reader.range(key, value) for key, value in ranges.items()),
            design.design,
            limits=tuple(reader.limit(key, value) for key, value in limits.items()),
            effort=Effort(**counts),
            inner=read_inner(table, design.design, reader.refuse),
            name=name,
            **given,
        )
    except InvalidInput as error:
        paths = {path: f"ranges.{key}" for key, path in RANGE_KEYS.items()}
        key = (paths | _KEY_OF_FIELD).get(error.argument, error.argument)
        reader.refuse(key, None, error.problem, cause=error)


class _Reader:
    """Checks the table, and refuses it with the line."""

    def __init__(self, text: str, source: str) -> None:
        self.text, self.source = text, source

    def refuse(
        self, key: str, value: object, problem: str, cause: Exception | None = None
    ) -> NoReturn:
        path = f"{TABLE}.{key}" if key else ""
        line = find_line(self.text, path) or find_line(self.text, TABLE)
        raise DesignFileError(self.source, problem, line=line, key=path, value=value) from cause

    def unknown(self, table: str, key: str, known: Iterable[str]) -> NoReturn:
        self.refuse(f"{table}{key}", None, f"there is no such key; {name_hint(key, known, 0.5)}")

    def check(self, table: dict[str, Any]) -> None:
        for key, value in table.items():
            if key in INNER_KEYS:
                continue
            kinds = _KINDS.get(key)
            if kinds is None:
                self.unknown("", key, (*_KINDS, *INNER_KEYS))
            whole = isinstance(value, bool) and bool not in kinds
            if whole or not isinstance(value, kinds):
                self.refuse(key, value, f"{_NEEDED[kinds[0]]} is needed")

    def word(self, key: str, value: object, known: dict[str, Any]) -> Any:
        if not isinstance(value, str) or value not in known:
            self.refuse(key, value, " or ".join(f'"{word}"' for word in known) + " is needed")
        return known[value]

    def number(self, key: str, value: object) -> float:
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            self.refuse(key, value, "a number is needed")
        return float(value)

    def range(self, key: str, value: object) -> SearchRange:
        if key not in RANGE_KEYS:
            self.unknown("ranges.", key, RANGE_KEYS)
        if not isinstance(value, list) or len(value) != 2:
            self.refuse(f"ranges.{key}", value, "two numbers are needed: [least, largest]")
        low, high = (self.number(f"ranges.{key}", end) for end in value)
        return SearchRange(RANGE_KEYS[key], low, high)

    def limit(self, key: str, value: object) -> ObjectiveLimit:
        if key not in LIMIT_KEYS:
            self.unknown("limits.", key, LIMIT_KEYS)
        return ObjectiveLimit(LIMIT_KEYS[key], self.number(f"limits.{key}", value))
