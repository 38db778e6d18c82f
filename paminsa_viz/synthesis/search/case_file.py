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

The design of the file is the reference, Appendix 4 where it says nothing. What is chosen for each
set of lengths, and for which motions:

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
    torque_Nm = 10.0
    force_N = 300.0
"""

from __future__ import annotations

import os
from pathlib import Path

from paminsa_viz.balancing import Anchor, CounterweightRange, MassRange, SpringPlace
from paminsa_viz.checks import kinds_checked
from paminsa_viz.files.design_file import content_of, decode_text, parse_toml, read_bytes
from paminsa_viz.files.design_schema import KEYS, unit_suffix
from paminsa_viz.files.errors import DesignFileError
from paminsa_viz.files.toml_table import TomlTable, find_line
from paminsa_viz.model.design import MECHANISM_PATHS, PARAMETER, Design
from paminsa_viz.model.lumped import MASS_PATHS
from paminsa_viz.model.resizing import BarLaw
from paminsa_viz.synthesis.masses.case import InnerCase, MassFactor
from paminsa_viz.synthesis.search.case import (
    DIMENSIONS,
    Effort,
    Guide,
    ObjectiveLimit,
    Regime,
    SearchRange,
    SynthesisCase,
)
from paminsa_viz.synthesis.search.objectives import OBJECTIVES
from paminsa_viz.trajectory import Trajectory
from paminsa_viz.trajectory.planners import arch, point_to_point, round_trip
from paminsa_viz.units import si_unit

TABLE = "synthesis"

RATE = 100.0
"""Samples a second of a motion unless the file says another."""

EXAMPLES: dict[str, Path] = {
    path.stem: path for path in sorted((Path(__file__).parent / "cases").glob("*.toml"))
}
"""Worked cases by name."""

RANGE_KEYS: dict[str, str] = {
    **{key.name: key.parameter.path for key in KEYS if key.parameter.path in MECHANISM_PATHS},
    **{path.replace(".", "_") + "_m": path for path in DIMENSIONS},
}
"""Keys of ``[synthesis.ranges]`` and the paths that they are."""

LIMIT_KEYS: dict[str, str] = {
    item.key + unit_suffix(si_unit(item.unit)): item.key for item in OBJECTIVES.values()
}
"""Keys of ``[synthesis.limits]`` and the objectives that they are."""

REGIMES: dict[str, Regime] = {"smaller": Regime.SMALLER, "larger": Regime.LARGER}
"""Words for R_pl < R_b and for R_pl > R_b."""

_KEY_OF = {
    **{path: f"ranges.{key}" for key, path in RANGE_KEYS.items()},
    **dict.fromkeys(MASS_PATHS, "masses"),
    "effort.generations": "generations", "effort.population": "population", "margin": "margin_m",
    "clearance": "clearance_m",
    "goal": "masses_for", "motion_torque": "motion_limits", "motion_force": "motion_limits",
}  # fmt: skip
"""Keys of the arguments that a case refuses, where they have other names."""


@kinds_checked
def load_case(path: str | os.PathLike[str], *, allow_overlap: bool = False) -> SynthesisCase:
    """Read a case file.

    Args:
        path: The file.
        allow_overlap: Whether bodies may overlap, whatever the file says of it.

    Raises:
        DesignFileError: If the file cannot be read or is no valid case file.
    """
    return read_case(read_bytes(path), os.fspath(path), allow_overlap=allow_overlap)


def read_case(content: str | bytes, source: str, *, allow_overlap: bool = False) -> SynthesisCase:
    """Return the case that a file's content describes.

    Args:
        content: The file's text or bytes.
        source: The file's name, for messages.
        allow_overlap: Whether bodies may overlap, whatever the file says of it.

    Raises:
        DesignFileError: If it is no valid case file.
    """
    text = decode_text(content, source)
    document = parse_toml(text, source)
    given = document.pop(TABLE, None)
    design = content_of(document, text, source)
    if not isinstance(given, dict):
        problem = f"a table [{TABLE}] is needed, which says what to search"
        raise DesignFileError(source, problem)
    if design.requirements is None:
        problem = "a table [workspace] is needed, over which requirements hold"
        raise DesignFileError(source, problem, line=find_line(text, TABLE))
    table = TomlTable(text, source, TABLE, given, _KEY_OF)
    # what the file leaves out is the case's own default
    switches = ("arm_follows", "shaft_follows", "above_guides", "allow_overlap")
    with table.errors_at("scale_bars"):
        bars = BarLaw(
            *(
                table.take(name, bool, default)
                for name, default in (
                    ("scale_bars", True), ("tubes_grow", False), ("tube_masses", False)
                )
            )
        )  # fmt: skip
    guide = table.words("guide", str, {item.value: item for item in Guide})
    values = {
        "objective": table.take("objective", str, None),
        "margin": table.take("margin_m", float, None),
        "clearance": table.take("clearance_m", float, None),
        "guide": guide and guide[0],
        **{name: table.take(name, bool, None) for name in switches},
        "regimes": table.words("regimes", list, REGIMES),
        "seed": table.take("seed", int, None),
    }
    if allow_overlap:
        values["allow_overlap"] = True
    effort = {name: table.take(name, int, None) for name in ("generations", "population")}
    with table.errors_at(""):
        ranges = table.each_key("ranges", RANGE_KEYS, _range)
        limits = table.each_key("limits", LIMIT_KEYS, _limit)
        inner = _inner(table, design.design)
        return SynthesisCase(
            design.requirements, ranges, design.design, limits=limits, inner=inner, bars=bars,
            effort=Effort(**{name: count for name, count in effort.items() if count is not None}),
            name=document.get("name", Path(source).stem),
            **{name: value for name, value in values.items() if value is not None},
        )  # fmt: skip


def _range(table: TomlTable, key: str, path: str) -> SearchRange:
    return SearchRange(
        path, *table.numbers(key, 2, needed="two numbers are needed: [least, largest]")
    )


def _limit(table: TomlTable, key: str, objective: str) -> ObjectiveLimit:
    return ObjectiveLimit(objective, table.take(key, float))


def _inner(table: TomlTable, design: Design) -> InnerCase | None:
    """Return what the rest of the table says of motions, masses and springs; None if nothing."""
    before = len(table.left)
    motions = table.rows("motions", _motion)
    masses = table.rows("masses", lambda row: _mass(row, design))
    weights = table.rows("counterweights", _counterweight)
    springs = table.rows("springs", _spring)
    limits = table.table("motion_limits", table.take("motion_limits", object, {}))
    torque, force = (limits.take(name, float, None) for name in ("torque_Nm", "force_N"))
    limits.end()
    goal = table.take("masses_for", str, "peak_torque" if motions else "moving_mass")
    nothing = len(table.left) == before
    table.end()
    if nothing:
        return None
    return InnerCase(
        goal, motions, masses, weights, springs, motion_torque=torque, motion_force=force,
        from_center=True,
    )  # fmt: skip


def _motion(row: TomlTable) -> Trajectory:
    start, goal = row.numbers("from", 4), row.numbers("to", 4)
    height, duration = row.take("arch_m", float, None), row.take("duration_s", float)
    if height is None:
        plan = point_to_point(start, goal, duration)
    else:
        plan = arch(start, goal, height, duration)
    if row.take("round_trip", bool, False):
        plan = round_trip(plan)
    return plan.sample(row.take("rate_Hz", float, RATE))


def _mass(row: TomlTable, design: Design) -> MassRange | MassFactor:
    path = row.take("mass", str)
    with row.errors_at("mass"):
        design.value(path)
    weight = path.startswith("counterweights.") and path.endswith(".mass")
    if not weight and (path not in MASS_PATHS or PARAMETER[path].unit != "kg"):
        row.refuse("mass", path, "this is no mass of the design")
    follows = row.take("inertia_follows", bool, True)
    kilograms = row.numbers("range_kg", 2, None)
    if kilograms is not None:
        return MassRange(path, *kilograms, inertia_follows=follows)
    return MassFactor(path, *row.numbers("factor", 2), inertia_follows=follows)


def _counterweight(row: TomlTable) -> CounterweightRange:
    bar, joint = row.take("bar", str), row.take("joint", int)
    span = row.numbers("beyond_m", 2)
    most = row.take("max_kg", float)
    return CounterweightRange(bar, joint, *span, high=most, low=row.take("min_kg", float, 0.0))


def _spring(row: TomlTable) -> SpringPlace:
    ends = []
    for name in ("first", "second"):
        end = row.table(name, row.take(name, dict))
        ends.append(
            Anchor(
                end.take("kind", str), end.take("joint", int, 0), end.take("bar", str, ""),
                *(end.take(key, float, 0.0) for key in ("beyond_m", "radius_m", "height_m")),
            )
        )  # fmt: skip
        end.end()
    stiffness = row.take("max_stiffness_N_per_m", float)
    least, most = row.numbers("free_length_m", 2, (0.0, 0.0))
    return SpringPlace(ends[0], ends[1], stiffness, least, most)
