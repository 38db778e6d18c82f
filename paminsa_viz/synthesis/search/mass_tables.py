"""Motions, masses, counterweights and springs of a case file.

[[synthesis.motions]]         # x, y [m], theta [rad], z [m] from the workspace's center
from = [-0.15, 0.0, -0.5236, -0.05]
to = [0.15, 0.0, 0.5236, -0.05]
arch_m = 0.1                  # left out: straight
duration_s = 1.0
round_trip = true

[[synthesis.masses]]
mass = "links.b8"
factor = [0.5, 2.0]           # or range_kg

[[synthesis.counterweights]]
bar = "b8"
joint = 8
beyond_m = [0.2, 0.2]
max_kg = 4.0

[[synthesis.springs]]
first = { kind = "slider", height_m = 0.3 }
second = { kind = "joint", joint = 9 }
max_stiffness_N_per_m = 2000.0
free_length_m = [0.0, 0.2]

[synthesis.motion_limits]
torque_Nm = 5.0
force_N = 300.0
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NoReturn

from paminsa_viz.balancing import Anchor, CounterweightRange, MassRange, SpringPlace
from paminsa_viz.errors import InvalidInput, PaminsaError
from paminsa_viz.model.design import PARAMETER, Design
from paminsa_viz.model.lumped import MASS_PATHS
from paminsa_viz.synthesis.masses.case import InnerCase, MassFactor
from paminsa_viz.trajectory import Trajectory
from paminsa_viz.trajectory.planners import arch, point_to_point, round_trip

RATE = 100.0
"""Samples a second of a motion unless the file says another."""

INNER_KEYS = ("motions", "masses", "counterweights", "springs", "motion_limits", "masses_for")
"""Keys of ``[synthesis]`` that are read here."""

Refuse = Callable[[str, object, str], NoReturn]
"""``refuse(key, value, problem)`` raises the file's error; the key is one below ``synthesis``."""


class _Table:
    """One table of the file, whose keys are taken one by one."""

    def __init__(self, key: str, table: object, refuse: Refuse) -> None:
        self.key, self.refuse_whole = key, refuse
        if not isinstance(table, dict):
            refuse(key, table, "a table is needed")
        self._left = dict(table)

    def refuse(self, name: str, value: object, problem: str) -> NoReturn:
        self.refuse_whole(f"{self.key}.{name}", value, problem)

    def take(self, name: str, kind: type, default: Any = ...) -> Any:
        """Return a value of a kind: a number, a word, true or false, or a table."""
        if name not in self._left:
            if default is ...:
                self.refuse(name, None, "this key is needed")
            return default
        value = self._left.pop(name)
        words = {float: "a number", int: "a whole number", str: "a word", bool: "true or false"}
        if kind is float and isinstance(value, int) and not isinstance(value, bool):
            value = float(value)
        if not isinstance(value, kind) or (isinstance(value, bool) and kind is not bool):
            self.refuse(name, value, f"{words.get(kind, 'a table')} is needed")
        return value

    def numbers(self, name: str, count: int, default: Any = ...) -> tuple[float, ...]:
        """Return a list of so many numbers."""
        if name not in self._left and default is not ...:
            return default
        value = self._left.pop(name, None)
        right = isinstance(value, list) and len(value) == count
        if not right or any(isinstance(v, bool) or not isinstance(v, (int, float)) for v in value):
            self.refuse(name, value, f"a list of {count} numbers is needed")
        return tuple(map(float, value))

    def end(self) -> None:
        """Refuse what is left."""
        for name, value in self._left.items():
            self.refuse(name, value, "there is no such key")


def read_inner(table: dict[str, Any], design: Design, refuse: Refuse) -> InnerCase | None:
    """Return what the table ``[synthesis]`` says of motions, masses and springs; None if nothing.

    Args:
        table: The table; other keys than `INNER_KEYS` are left alone.
        design: The reference, whose masses the paths have to be.
        refuse: Raises the file's error.
    """
    if not any(key in table for key in INNER_KEYS):
        return None

    def each(key: str, make: Callable[[_Table], Any]) -> tuple[Any, ...]:
        rows = table.get(key, [])
        if not isinstance(rows, list):
            refuse(key, rows, f"tables [[synthesis.{key}]] are needed")
        found = []
        for number, row in enumerate(rows):
            item = _Table(f"{key}.{number}", row, refuse)
            try:
                found.append(make(item))
            except InvalidInput as error:
                refuse(key, None, error.problem)
            except PaminsaError as error:
                refuse(key, None, str(error))
            item.end()
        return tuple(found)

    motions = each("motions", _motion)
    masses = each("masses", lambda row: _mass(row, design))
    limits = _Table("motion_limits", table.get("motion_limits", {}), refuse)
    torque, force = (limits.take(name, float, None) for name in ("torque_Nm", "force_N"))
    limits.end()
    goal = table.get("masses_for", "peak_torque" if motions else "moving_mass")
    try:
        return InnerCase(
            str(goal), motions, masses, each("counterweights", _counterweight),
            each("springs", _spring), motion_torque=torque, motion_force=force, from_center=True,
        )  # fmt: skip
    except InvalidInput as error:
        key = {"goal": "masses_for", "motion_torque": "motion_limits"}.get(error.argument)
        refuse(key or error.argument, None, error.problem)


def _motion(row: _Table) -> Trajectory:
    start, goal = row.numbers("from", 4), row.numbers("to", 4)
    height, duration = row.take("arch_m", float, None), row.take("duration_s", float)
    if height is None:
        plan = point_to_point(start, goal, duration)
    else:
        plan = arch(start, goal, height, duration)
    if row.take("round_trip", bool, False):
        plan = round_trip(plan)
    return plan.sample(row.take("rate_Hz", float, RATE))


def _mass(row: _Table, design: Design) -> MassRange | MassFactor:
    path = row.take("mass", str)
    try:
        design.value(path)
    except InvalidInput as error:
        row.refuse("mass", path, error.problem)
    weight = path.startswith("counterweights.") and path.endswith(".mass")
    if not weight and (path not in MASS_PATHS or PARAMETER[path].unit != "kg"):
        row.refuse("mass", path, "this is no mass of the design")
    follows = row.take("inertia_follows", bool, True)
    kilograms = row.numbers("range_kg", 2, None)
    if kilograms is not None:
        return MassRange(path, *kilograms, inertia_follows=follows)
    return MassFactor(path, *row.numbers("factor", 2), inertia_follows=follows)


def _counterweight(row: _Table) -> CounterweightRange:
    bar, joint = row.take("bar", str), row.take("joint", int)
    span = row.numbers("beyond_m", 2)
    most = row.take("max_kg", float)
    return CounterweightRange(bar, joint, *span, high=most, low=row.take("min_kg", float, 0.0))


def _spring(row: _Table) -> SpringPlace:
    ends = []
    for name in ("first", "second"):
        end = _Table(f"{row.key}.{name}", row.take(name, dict), row.refuse_whole)
        ends.append(
            Anchor(
                end.take("kind", str), end.take("joint", int, 0), end.take("bar", str, ""),
                *(end.take(key, float, 0.0) for key in ("beyond_m", "radius_m", "height_m")),
            )
        )  # fmt: skip
        end.end()
    stiffness = row.take("max_stiffness_N_per_m", float)
    first, second = ends
    return SpringPlace(first, second, stiffness, *row.numbers("free_length_m", 2, (0.0, 0.0)))
