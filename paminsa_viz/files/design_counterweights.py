"""Counterweights in a design file: one ``[[counterweights]]`` for each.

[[counterweights]]
bar = "B8"
joint = 8
beyond_m = 0.12
mass_kg = 1.5
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

from paminsa_viz.files.errors import DesignFileError
from paminsa_viz.model.counterweight import BAR_ENDS, Counterweight
from paminsa_viz.model.design import Design
from paminsa_viz.model.errors import InvalidDesign

TABLE = "counterweights"

KEYS = ("bar", "joint", "beyond_m", "mass_kg")
"""Keys of a counterweight; each of them has to be there."""

_KEY_OF = {"bar": "bar", "joint": "joint", "beyond": "beyond_m", "mass": "mass_kg"}
"""Keys by the counterweight's own fields."""

_COMMENTS = (
    "bar of each leg, B3, B4, B7 or B8",
    "end of the bar that its place is measured from",
    "beyond that joint, away from the bar's other end; negative: on the bar",
    "on each of the three legs",
)

Fail = Callable[[str, object, str, int], Exception]
"""Makes the error for a key, its value, a problem, and the number of the counterweight."""


def counterweight_lines(design: Design) -> list[str]:
    """Return the lines of a design's counterweights, none if it has none."""
    lines: list[str] = []
    for weight in design.counterweights:
        values = (f'"{weight.bar.upper()}"', weight.joint, weight.beyond, weight.mass)
        rows = [f"{key} = {value}" for key, value in zip(KEYS, values, strict=True)]
        width = max(map(len, rows))
        lines += ["", f"[[{TABLE}]]"]
        lines += [f"{row:<{width}}  # {text}" for row, text in zip(rows, _COMMENTS, strict=True)]
    return lines


def read_counterweights(
    content: object, number: Callable[[str, object], float], fail: Fail
) -> tuple[Counterweight, ...]:
    """Return the counterweights of a parsed document.

    Args:
        content: What the document has under `TABLE`.
        number: Checks that a key's value is a number, and returns it.
        fail: Makes the error to raise.
    """
    if not isinstance(content, list) or not all(isinstance(item, dict) for item in content):
        raise fail(TABLE, None, f"a table [[{TABLE}]] in double brackets is needed for each", 0)
    return tuple(_counterweight(item, index, number, fail) for index, item in enumerate(content))


def _counterweight(
    item: dict[str, Any], index: int, number: Callable[[str, object], float], fail: Fail
) -> Counterweight:
    for key, value in item.items():
        if key not in KEYS:
            raise fail(
                key, value, f"there is no such key; [[{TABLE}]] has {', '.join(KEYS)}", index
            )
    for key in KEYS:
        if key not in item:
            raise fail(TABLE, None, f"{key} is missing; each needs {', '.join(KEYS)}", index)
    bar, joint = item["bar"], item["joint"]
    if not isinstance(bar, str) or bar.lower() not in BAR_ENDS:
        known = ", ".join(name.upper() for name in BAR_ENDS)
        raise fail("bar", bar, f"a counterweight is on one of the bars {known}", index)
    if isinstance(joint, bool) or not isinstance(joint, int):
        raise fail("joint", joint, "a joint's number is needed", index)
    numbers = []
    for key in ("beyond_m", "mass_kg"):
        try:
            numbers.append(number(f"{TABLE}.{key}", item[key]))
        except DesignFileError as error:
            raise fail(key, error.value, error.problem, index) from None
    try:
        return Counterweight(bar.lower(), joint, *numbers)
    except InvalidDesign as error:
        key = _KEY_OF[error.field.rpartition(".")[2]]
        raise fail(key, error.value, error.allowed, index) from error


def counterweight_line(text: str, index: int, key: str) -> int | None:
    """Return the line, counted from 1, of a key of one counterweight, or of its heading."""
    lines = text.split("\n")
    heading = rf"\s*\[\[\s*{TABLE}\s*\]\]"
    starts = [number for number, line in enumerate(lines, 1) if re.match(heading, line)]
    if index >= len(starts):
        return None
    for number in range(starts[index], len(lines)):
        if re.match(r"\s*\[", lines[number]):
            break
        if re.match(rf"\s*[\"']?{re.escape(key)}[\"']?\s*=", lines[number]):
            return number + 1
    return starts[index]
