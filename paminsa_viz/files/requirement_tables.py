"""Requirements in a design file: tables ``[[requirements]]``, one for each, and ``[workspace]``.

    [workspace]
    theta_min_rad = -0.5
    theta_max_rad = 0.5
    shape = "cylinder"
    diameter_m = 0.3
    height_m = 0.4

    [[requirements]]
    quantity = "condition"
    max = 10.0

Bounds are in SI units, named at the end of their keys as everywhere in the file: ``max_Nm``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from paminsa_viz.errors import InvalidInput, name_hint
from paminsa_viz.files.design_schema import REQUIREMENTS, WORKSPACE, WORKSPACE_SIZES, unit_suffix
from paminsa_viz.files.errors import DesignFileError
from paminsa_viz.quantities import QUANTITIES
from paminsa_viz.quantities.quantity import Quantity
from paminsa_viz.quantities.requirement_text import requirement_label
from paminsa_viz.quantities.requirements import (
    Range,
    Requirement,
    Requirements,
    Workspace,
    WorkspaceShape,
)
from paminsa_viz.units import si_unit

Refuse = Callable[[str, object, str], DesignFileError]
"""Takes a dotted key, its value and the problem, and returns the error."""

_THETA = ("theta_min_rad", "theta_max_rad")
_Z = ("z_min_m", "z_max_m")
_CENTER = ("center_x_m", "center_y_m", "center_z_m")


def bound_keys(entry: Quantity) -> tuple[str, str]:
    """Return the keys of the least and the largest value of a quantity, such as ``max_Nm``."""
    unit = si_unit(entry.unit)
    suffix = unit_suffix("" if unit == "1" else unit)
    return f"min{suffix}", f"max{suffix}"


def read_requirements_tables(content: Mapping[str, Any], refuse: Refuse) -> Requirements | None:
    """Return the requirements of a file's content, None if it has none.

    Raises:
        DesignFileError: As ``refuse`` makes it, if they are not possible.
    """
    if REQUIREMENTS not in content and WORKSPACE not in content:
        return None
    table = content.get(WORKSPACE, {})
    bounds = tuple(
        _requirement(entry, f"{REQUIREMENTS}.{index}", refuse)
        for index, entry in enumerate(content.get(REQUIREMENTS, []))
    )
    theta = _range(table, _THETA, WORKSPACE, refuse) or (0.0, 0.0)
    return Requirements(bounds, theta, _workspace(table, refuse))


def _requirement(table: Mapping[str, Any], path: str, refuse: Refuse) -> Requirement:
    key = table["quantity"]
    if key not in QUANTITIES:
        problem = f"there is no such quantity; {name_hint(key, QUANTITIES)}"
        raise refuse(f"{path}.quantity", key, problem)
    least, largest = bound_keys(QUANTITIES[key])
    known = ("quantity", least, largest, *_THETA, *_Z)
    for name, value in table.items():
        if name not in known:
            problem = f"there is no such key for {key}; {name_hint(name, known, 0.4)}"
            raise refuse(f"{path}.{name}", value, problem)
    if least not in table and largest not in table:
        raise refuse(f"{path}.quantity", key, f"{least} or {largest} is needed with it")
    theta, z = (_range(table, names, path, refuse) for names in (_THETA, _Z))
    try:
        return Requirement(key, table.get(least), table.get(largest), theta, z)
    except InvalidInput as error:
        raise refuse(f"{path}.{largest}", table.get(largest), error.problem) from error


def _range(
    table: Mapping[str, Any], names: tuple[str, str], path: str, refuse: Refuse
) -> Range | None:
    given = [name for name in names if name in table]
    if not given:
        return None
    if len(given) == 1:
        other = next(name for name in names if name not in table)
        raise refuse(f"{path}.{given[0]}", table[given[0]], f"{other} is needed with it")
    low, high = (float(table[name]) for name in names)
    if low > high:
        raise refuse(f"{path}.{names[1]}", high, f"it must not be below {names[0]}")
    return low, high


def _workspace(table: Mapping[str, Any], refuse: Refuse) -> Workspace | None:
    if "shape" not in table:
        alone = [name for name in table if name not in _THETA]
        if alone:
            raise refuse(f"{WORKSPACE}.{alone[0]}", table[alone[0]], "shape is needed with it")
        return None
    shape = WorkspaceShape(table["shape"])
    needed = shape.section.sizes
    for name in WORKSPACE_SIZES:
        if (name in table) is not (name in needed):
            problem = f"a {shape.value} has {', '.join(needed)}"
            raise refuse(f"{WORKSPACE}.shape", table["shape"], problem)
    for name in needed:
        if not table[name] > 0.0:
            raise refuse(f"{WORKSPACE}.{name}", table[name], "a number above 0 is needed")
    size = shape.section.size(*(float(table[name]) for name in needed))
    first, second, third = (table.get(name) for name in _CENTER)
    return Workspace(shape, size, (first, second, third))


def requirements_rows(requirements: Requirements) -> list[tuple[str, list[tuple[str, str]]]]:
    """Return headings of tables, and below each its assignments with their comments."""
    if requirements == Requirements():
        return []
    low, high = requirements.theta
    rows = [
        (f"{_THETA[0]} = {low!r}", "theta, least heading that counts"),
        (f"{_THETA[1]} = {high!r}", "theta, largest heading that counts"),
    ]
    if (workspace := requirements.workspace) is not None:
        rows.append((f'shape = "{workspace.shape.value}"', "of the required workspace"))
        section = workspace.shape.section
        rows += [
            (f"{name} = {extent!r}", "extent of the workspace")
            for name, extent in zip(section.sizes, section.given(workspace.size), strict=True)
        ]
        rows += [
            (f"{name} = {place!r}", "its center; left out, it is free")
            for name, place in zip(_CENTER, workspace.center, strict=True)
            if place is not None
        ]
    found = [(f"[{WORKSPACE}]  # What the platform's center has to reach, and how turned", rows)]
    for bound in requirements.bounds:
        found.append((f"[[{REQUIREMENTS}]]", _bound_rows(bound)))
    return found


def _bound_rows(bound: Requirement) -> list[tuple[str, str]]:
    rows = [(f'quantity = "{bound.quantity}"', requirement_label(bound))]
    limits = zip(bound_keys(bound.entry), (bound.low, bound.high), strict=True)
    rows += [
        (f"{key} = {value!r}", bound.entry.title) for key, value in limits if value is not None
    ]
    for names, limits_of, what in ((_THETA, bound.theta, "headings"), (_Z, bound.z, "heights")):
        if limits_of is not None:
            pairs = zip(names, limits_of, strict=True)
            rows += [(f"{name} = {end!r}", f"{what} over which it holds") for name, end in pairs]
    return rows
