"""The controller kit: the robot as a C header, a design's numbers, test vectors, a test program."""

from __future__ import annotations

import re
from contextlib import suppress
from functools import cache
from importlib.resources import files
from typing import Any

import numpy as np
from numpy.typing import NDArray

from paminsa_viz import __version__
from paminsa_viz.actuation.wrench_capability import transmission_indices
from paminsa_viz.codegen.c99 import C99
from paminsa_viz.codegen.printer import FUNCTIONS, Printer, commented
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model import kinematic_formulas, measures, robot
from paminsa_viz.model.accuracy import noting_equal_legs
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.backend import use_numpy
from paminsa_viz.model.design import Design
from paminsa_viz.model.dynamics import (
    forward_dynamics,
    friction_torque,
    inverse_dynamics,
    mass_matrix,
)
from paminsa_viz.model.jacobians import inverse_jacobian, jacobian
from paminsa_viz.model.kinematics import inverse_kinematics
from paminsa_viz.model.leg import leg_position, mechanism, mechanism_of_lengths
from paminsa_viz.model.leg_points import counterweight_point
from paminsa_viz.model.load import wrench_at_center
from paminsa_viz.model.lumped import (
    MASS_PATHS,
    EnergyTerms,
    lumped_matrix,
    mass_vector,
    point_mass_column,
    term_factors,
    term_matrix,
)
from paminsa_viz.model.reach import check_reach, workspace_height, workspace_radius
from paminsa_viz.model.resizing import radius_ratio
from paminsa_viz.model.singularity import measure_singularity
from paminsa_viz.model.statics import static_torques, unit_torques

# --------------------------------------------------------------------------------- single precision

TOLERANCES = {"ROUNDING": 2.0**-19, "SINGULAR": 2.0**-11}
"""`model.leg.ROUNDING` and `SINGULAR`, by as much larger as the last place of a float is."""

_LITERAL = re.compile(r"(?<![\w.])((?:\d+\.\d*|\.\d+)(?:[eE][+-]?\d+)?|\d+[eE][+-]?\d+)(?![\w.])")
_CALLS = re.compile(rf"\b({'|'.join(sorted(set(FUNCTIONS.values()) | {'fmod'}))})\(")
_KEPT = re.compile(r"(/\*.*?\*/|\"[^\"\n]*\"|#include[^\n]*|strtod|\(double\))", re.DOTALL)


def single_precision(text: str) -> str:
    """Return C source with float for double, in types, functions and literals; comments stay."""
    parts = _KEPT.split(text)
    for index in range(0, len(parts), 2):
        part = parts[index]
        for name, value in TOLERANCES.items():
            part = re.sub(rf"(#define PAMINSA_{name}) \S+", rf"\1 {value!r}", part)
        part = re.sub(r"\bdouble\b", "float", part)
        parts[index] = _LITERAL.sub(r"\1f", _CALLS.sub(r"\1f(", part))
    return "".join(parts)


# ------------------------------------------------------------------------------------------ the kit

FORMULAS = (
    mechanism_of_lengths,
    leg_position,
    kinematic_formulas.leg_angles,
    kinematic_formulas.lift_position,
    kinematic_formulas.speed_rows,
    kinematic_formulas.speed_row_rates,
    kinematic_formulas.wrench_torques,
    kinematic_formulas.assembly_mode,
    kinematic_formulas.platform_height,
    kinematic_formulas.friction,
    wrench_at_center,
    robot.unit_torques,
    robot.inverse_dynamics_kernel,
    robot.mass_matrix,
    robot.acceleration_of_force,
    measures.least_margin,
    measures.dexterity,
    measures.singular_distances,
    transmission_indices,
)
"""What the header is made of, with all that these call."""

MOD = """\
/* Helper, not in the paper, units as of the values: the remainder with the sign of the divisor. */
static inline double paminsa_mod(double a, double b)
{
    const double rest = fmod(a, b);
    return rest != 0.0 && (b < 0.0) != (rest < 0.0) ? rest + b : rest;
}
"""

ROWS = 400
"""Rows of the test vectors."""

WORST_CONDITION = 10.0
"""Condition number up to which poses become test vectors."""

SINGLE_BOUNDS = {
    "inverse kinematics": 1e-6,
    "inverse Jacobian": 2e-6,
    "Jacobian": 2e-6,
    "forward kinematics": 2e-5,
    "static torques": 2e-5,
    "inverse dynamics": 2e-4,
    "mass matrix": 1e-4,
    "forward dynamics": 5e-3,
    "friction": 1e-6,
    "margin": 5e-6,
    "singularities": 2e-5,
}
"""Errors of the kit in single precision, over the largest value of a column (see `test.c`), at
poses with condition numbers up to `WORST_CONDITION`, of robots like the prototype, however large:
other proportions may have larger ones. Names are those of the test program."""

TOLERANCE = {False: 1e-9, True: max(SINGLE_BOUNDS.values())}
"""What the test program allows, in double and in single precision."""


@of_design
def controller_kit(design: Design, *, single: bool = False) -> dict[str, str]:
    """Return the controller kit of a design: texts by the names of their files.

    Args:
        design: The robot.
        single: Use float instead of double.
    """
    vectors = test_vectors(design, 0)
    columns = vectors.partition("\n")[0].count(",") + 1
    tolerance = f"{TOLERANCE[single]:g}"
    test = template("test.c", TOLERANCE=tolerance, COLUMNS=str(columns))
    bounds = ", ".join(f"{what} {bound:g}" for what, bound in SINGLE_BOUNDS.items())
    note = (
        "* This kit is in single precision. At condition numbers up to "
        f"{WORST_CONDITION:g} errors over\n  the largest value of a column of the table are, for "
        f"robots like the prototype, at most: {bounds}.\n  `./test` prints those of this design.\n"
    )
    others = (
        "| `paminsakins.comp` | the kinematics of LinuxCNC for this design |\n"
        "| `fmu/` | with `paminsa-viz code --fmu`: FMUs (FMI 2.0), and `add_platform.py`, which "
        "adds the binary of another platform to one |\n"
    )
    readme = template(
        "README.md", NAME=design.name, VERSION=__version__, FLOAT=note if single else "",
        OTHERS="" if single else others,
    )  # fmt: skip
    sources = {"paminsa.h": header(), "design.h": design_header(design), "test.c": test}
    if single:
        sources = {name: single_precision(text) for name, text in sources.items()}
    else:  # LinuxCNC's numbers are double
        sources["paminsakins.comp"] = template("paminsakins.comp")
    return {**sources, "vectors.csv": vectors, "README.md": readme.rstrip() + "\n"}


@cache
def header() -> str:
    """Return the text of paminsa.h."""
    printer = Printer(C99())
    printer.add(*FORMULAS)
    angles = ", ".join(map(repr, kinematic_formulas.HEADING))
    title = commented(
        "paminsa.h: kinematics, statics and dynamics of the PAMINSA.\n\n"
        f"Written by paminsa-viz {__version__} from the formulas of its model; see README.md.\n"
        "Equations are those of Arakelian, Guegan and Briot, DETC2005-84679.\n"
        "Compile with -std=c99 or -ffp-contract=off; never with -ffast-math."
    )
    parts = [
        *title,
        "#ifndef PAMINSA_H\n#define PAMINSA_H\n\n#include <math.h>\n",
        MOD,
        printer.text(),
        template("interface.h", HEADING=angles),
        "#endif\n",
    ]
    return "\n".join(parts)


def design_header(design: Design) -> str:
    """Return the text of design.h."""
    m, e = mechanism(design.geometry), term_factors(design)
    friction, load = design.actuator_friction, design.load

    def numbers(values: object) -> str:
        return "{" + ", ".join(repr(float(value)) for value in values) + "}"  # type: ignore[attr-defined]

    def members(record: object) -> str:
        pairs = record._asdict().items()  # type: ignore[attr-defined]
        return "\n".join(f"        {float(value)!r},  /* {name} */" for name, value in pairs)

    about = f'the numbers of the design "{_plain(design.name)}"'
    return f"""/* design.h: {noting_equal_legs(about, design.deviations)}. */
#ifndef PAMINSA_DESIGN_H
#define PAMINSA_DESIGN_H

#include "paminsa.h"

static const PaminsaDesign PAMINSA_DESIGN = {{
    {{  /* mechanism */
{members(m)}
    }},
    {{  /* energy */
{members(e)}
    }},
    {design.platform.mass!r},  /* platform_mass */
    {design.platform.inertia!r},  /* platform_inertia */
    {design.gravity!r},  /* gravity */
    {numbers(friction.viscous)},  /* viscous */
    {numbers(friction.coulomb)},  /* coulomb */
    {friction.transition_speed!r},  /* transition_speed */
    {numbers(design.drive_inertia)},  /* drive_inertia */
    {numbers(load.wrench[:3])},  /* force */
    {numbers(load.wrench[3:])},  /* moment */
    {numbers(load.point)},  /* point */
    {load.turns!r}  /* load_turns */
}};

{_mass_setter(design)}
#endif
"""


def _mass_setter(design: Design) -> str:
    """Return C that changes a design's masses: each factor of the energies as a sum of them."""
    geometry, gravity, weights = design.geometry, design.gravity, design.counterweights
    columns = [lumped_matrix(geometry, gravity)]
    columns += [
        point_mass_column(counterweight_point(geometry, weight), gravity)[:, None]
        for weight in weights
    ]
    table = term_matrix() @ np.hstack(columns)
    names = [path.replace(".", "_").upper() for path in MASS_PATHS]
    names += [f"COUNTERWEIGHT_{number}" for number in range(1, len(weights) + 1)]
    values = [*mass_vector(design).tolist(), *(weight.mass for weight in weights)]
    listed = "\n".join(f"    PAMINSA_{name}," for name in names)
    numbers = "\n".join(
        f"    {float(value)!r},  /* PAMINSA_{name} */"
        for name, value in zip(names, values, strict=True)
    )
    sums = []
    for term, row in zip(EnergyTerms._fields, table.tolist(), strict=True):
        parts = [
            f"{factor!r} * m[PAMINSA_{name}]"
            for name, factor in zip(names, row, strict=True)
            if factor != 0.0
        ]
        sums.append(f"    e->{term} =\n        " + "\n        + ".join(parts or ["0.0"]) + ";")
    about = commented(
        "Change the masses [kg, kg m^2] of a robot of this design's lengths and gravity.\n\n"
        "The factors of the energies are linear in them (Appendices 2 and 3, Eqs. 11-14)."
    )
    platform = ("mass", "inertia")
    parts = "\n".join(
        f"    design->platform_{name} = m[PAMINSA_PLATFORM_{name.upper()}];" for name in platform
    )
    return f"""/* Masses [kg] and inertias [kg m^2] by their names in design files. */
enum {{
{listed}
    PAMINSA_MASS_COUNT
}};

static const double PAMINSA_MASSES[PAMINSA_MASS_COUNT] = {{
{numbers}
}};

{chr(10).join(about)}
static inline void paminsa_set_masses(PaminsaDesign *design, const double m[PAMINSA_MASS_COUNT])
{{
    PaminsaEnergyTerms *e = &design->energy;

{parts}
{chr(10).join(sums)}
}}
"""


@use_numpy()
def test_vectors(design: Design, draw: int) -> str:
    """Return the text of vectors.csv: random states, most of them within reach.

    They have the bits of NumPy, as the header does, also where kernels that round otherwise are
    loaded.

    Args:
        design: The robot.
        draw: Which of the random draws; the kit has the first one, 0.
    """
    pose = _poses(design, draw)
    rng = np.random.default_rng(2005 + draw)
    geometry = design.geometry
    # lengths grow with the robot: a small one would else turn so fast that nothing but that counts
    across = 0.3 * radius_ratio(geometry)
    spread = np.array([across, across, 1.0, across])
    velocity, acceleration = rng.normal(size=(2, len(pose), 4)) * spread
    reach = check_reach(geometry, pose)
    ok = reach.ok[:, None]
    torque = inverse_dynamics(design, pose, velocity, acceleration).torque
    far = measure_singularity(geometry, pose)
    cos, sin = np.cos(pose[:, 2]), np.sin(pose[:, 2])

    def flat(matrix: Array) -> Array:
        return np.where(ok, matrix.reshape(len(pose), 16), np.nan)

    columns: dict[str, NDArray[Any]] = {
        "pose": pose,
        "c": cos[:, None],
        "s": sin[:, None],
        "velocity": velocity,
        "acceleration": acceleration,
        "status": reach.status[:, None].astype(float),
        "leg": reach.leg[:, None] + 1.0,
        "actuators": np.where(ok, inverse_kinematics(geometry, pose).actuators, np.nan),
        "G": flat(inverse_jacobian(geometry, pose)),
        "J": flat(jacobian(geometry, pose)),
        "static": static_torques(design, pose),
        "torque": torque,
        "forward": _accelerations(design, pose, velocity, torque),
        "M": flat(mass_matrix(design, pose)),
        "friction": friction_torque(design.actuator_friction, velocity),
        "margin": reach.margins.min(axis=(-1, -2))[:, None],
        "singularity": np.column_stack(
            [
                far.determinant,
                far.condition,
                far.position_distance,
                far.rotation_distance,
                far.serial_distance,
            ]
        ),
        "gamma": unit_torques(geometry, pose),
    }
    names = [
        name if part.shape[1] == 1 else f"{name}_{index}"
        for name, part in columns.items()
        for index in range(part.shape[1])
    ]
    rows = np.concatenate(list(columns.values()), axis=1)
    line = ",".join(["%.17g"] * rows.shape[1])
    lines = [line % tuple(row) for row in rows.tolist()]
    return "\n".join([",".join(names), *lines]) + "\n"


def _accelerations(design: Design, pose: Array, velocity: Array, torque: Array) -> Array:
    """Return accelerations (n, 4); NaN, as in C, where nothing resists the motion."""
    try:
        return forward_dynamics(design, pose, velocity, torque)
    except InvalidInput:
        found = np.full_like(pose, np.nan)
        for row, state in enumerate(zip(pose, velocity, torque, strict=True)):
            with suppress(InvalidInput):
                found[row] = forward_dynamics(design, *state)
        return found


def _poses(design: Design, draw: int) -> Array:
    """Return test poses (n, 4): far from singular ones, and one in ten out of reach."""
    geometry = design.geometry
    rng = np.random.default_rng(84679 + draw)
    radius, height = workspace_radius(geometry), workspace_height(geometry)
    least, most = [-radius, -radius, -1, 0.1 * height], [radius, radius, 1, height]
    pose = rng.uniform(least, most, (40 * ROWS, 4))
    # heights are those of joints 5, on the platform's side of the guides
    pose[:, 3] = -geometry.knee.sign * pose[:, 3] - geometry.platform_joint_height
    margin = check_reach(geometry, pose).margins.min(axis=(-1, -2))
    good = margin > 0.01 * geometry.base_radius
    good &= measure_singularity(geometry, pose).condition < WORST_CONDITION
    out = margin < -1e-3
    return np.concatenate([pose[good][:ROWS], pose[out][: ROWS // 10]])


def _plain(text: str) -> str:
    """Return a name that a C comment can hold: it neither ends there nor seems to begin again."""
    return re.sub(r"(?<=\*)(?=/)|(?<=/)(?=\*)", " ", re.sub(r"[^ -~]", "?", text))


def template(name: str, **values: str) -> str:
    """Return a file of the folder of templates with its places filled in."""
    text = (files("paminsa_viz.codegen") / "templates" / name).read_text(encoding="utf-8")
    for key, value in values.items():
        text = text.replace(f"@{key}@", value)
    return text
