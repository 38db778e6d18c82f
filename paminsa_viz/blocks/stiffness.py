"""The elastic robot: its data, its stiffness at the report's pose and over the workspace."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from paminsa_viz.blocks.data import POSITION_KEYS, record, robot
from paminsa_viz.blocks.kinds import Block, Cell, Note, Row, Table, aligned, heading, shown
from paminsa_viz.elastostatics.beams import TubeFit, tube_fits
from paminsa_viz.elastostatics.drive_stiffness import drive_modes, drive_stiffness
from paminsa_viz.elastostatics.leg_frame import contacts
from paminsa_viz.elastostatics.stiffness import (
    ACTUATED,
    ALIKE,
    SHARE_LABELS,
    SHARES,
    Compensation,
    PlatformStiffness,
    compensate,
    load_wrench,
    platform_stiffness,
    strain_shares,
)
from paminsa_viz.elastostatics.vibration import robot_modes
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.drive import ACTUATORS
from paminsa_viz.model.elastic import BARS
from paminsa_viz.units import MM, NONE, fixed, format_value, number, percent

MODES = 6
"""Natural frequencies of the table."""

AXES = ("x", "y", "z", "about x", "about y", "about z")
AXIS_KEYS = ("x", "y", "z", "", "", "theta")
"""Endings of the keys of their stiffness as quantities."""

DIGITS = 4
"""Of stiffness and frequencies."""

OTHER_TUBES = 3.0
"""How many times as heavy or as light as its link a tube is one of another robot."""

LEAST_SHARE = 0.0005
"""Smallest share in the strain energy that is listed."""

KEYS = ("stiffness_x", "stiffness_y", "stiffness_z", "stiffness_theta", "stiffness_tilt",
        "stiffness_horizontal", "frequency_1")  # fmt: skip
"""Quantities of the table, with their global indices."""


def robot_blocks(design: Design, pose: Array) -> list[Block]:
    """Return the elastic data, and the stiffness at a pose (4,) and over the workspace."""
    blocks: list[Block] = [_data(design)]
    found = platform_stiffness(design, pose)
    if reason := found.reason():
        return [*blocks, Note(f"The stiffness has no value at this pose: {reason}.", "warn")]
    # Late: a command does without, and the registry of quantities takes half a second to load.
    from paminsa_viz.blocks.forces import index_table

    about = "Stiffness of the whole robot, motors locked, everything else free. "
    return [*blocks, index_table(design, pose, KEYS, about), *stiffness_blocks(design, found)]


def stiffness_blocks(
    design: Design, found: PlatformStiffness, *, shear: bool = False
) -> list[Block]:
    """Return stiffness, deflection, shares of the parts and natural frequencies at a pose."""
    other = other_tubes(tube_fits(design))
    return [
        *([Note(other, "warn")] if other else []),
        directions_table(design, found),
        Note(
            f"Least horizontal stiffness: {softest_text(found)}. {_ellipsoid_text(design, found)}"
        ),
        *_loaded(design, found.pose, shear=shear),
        *_vibration(design, found.pose, shear=shear),
    ]


def other_tubes(fits: Sequence[TubeFit]) -> str:
    """Return which tubes weigh quite another thing than the design's links; "" if none do.

    The defaults of [elastic] are tubes of Appendix 4's lengths and masses, whatever the design's.
    """
    far = {
        fit.bar: 1.0 / fit.mass_ratio for fit in fits
        if fit.mass_ratio > 0.0 and not 1 / OTHER_TUBES <= fit.mass_ratio <= OTHER_TUBES
    }  # fmt: skip
    if not far:
        return ""
    times = ", ".join(f"{bar} {number(ratio, 2)}" for bar, ratio in far.items())
    return (
        f"The tubes weigh other than the design’s links ({times} times as much): the stiffness is "
        "that of these tubes. Give the robot’s own diameters."
    )


def sections_table(design: Design, fits: Sequence[TubeFit]) -> Table:
    """Return the bars' tubes beside the design's masses and inertias."""
    rows = []
    for fit in fits:
        ends = (design.value(f"elastic.{fit.bar.lower()}_{side}") for side in ("outer", "inner"))
        outer, inner = (number(MM * end) for end in ends)
        ratios = (fit.mass_ratio, fit.slender_ratio, fit.transverse_ratio, fit.axial_ratio)
        texts = (number(ratio, 3) for ratio in ratios)
        mass = f"{fit.mass:.3f} kg" if fit.mass >= 0.1 else format_value(fit.mass, "kg", 3)
        rows.append(Row((fit.bar, f"{outer}/{inner} mm", mass, *texts)))
    head = ("", "Tube", "Mass", "Link/tube", "I_YY/(m l²/12)", "I_YY/tube", "I_XX/tube")
    caption = "Tubes of [elastic], and the links’ masses and inertias over theirs."
    return Table(head, tuple(rows), caption)


def sections_data(design: Design, fits: Sequence[TubeFit]) -> dict[str, Any]:
    """Return the same for JSON, in SI units."""
    keys = (
        "bar", "length_m", "mass_kg", "mass_ratio", "slender_kg_m2", "slender_ratio",
        "transverse_kg_m2", "transverse_ratio", "axial_kg_m2", "axial_ratio",
    )  # fmt: skip
    return {**robot(design), "bars": [record(fit, *keys) for fit in fits]}


def strain_cases(design: Design, pose: Array, *, shear: bool) -> dict[str, Array]:
    """Return the parts' shares under the load, or under unit forces where there is none."""
    if np.any(load_wrench(design, pose)):
        return {"load": strain_shares(design, pose, shear=shear).share}
    units = {"force x": 0, "force y": 1, "force z": 2, "moment z": 5}
    return {
        name: strain_shares(design, pose, np.eye(6)[axis], shear=shear).share
        for name, axis in units.items()
    }


def _data(design: Design) -> Table:
    elastic = design.elastic
    rows = [
        Row(("E", "Young’s modulus", format_value(elastic.young_modulus, "Pa"))),
        Row(("G", "shear modulus", format_value(elastic.shear_modulus, "Pa"))),
        Row(("k_M", "drives M1 to M3", format_value(elastic.drive_rotary, "N m/rad"))),
        Row(("k_4", "drive M4", format_value(elastic.drive_linear, "N/m"))),
    ]
    for bar in BARS:
        outer, inner = (MM * design.value(f"elastic.{bar}_{side}") for side in ("outer", "inner"))
        section = elastic.section(bar)
        values = (
            f"A {format_value(section.area, 'm^2')}, I {format_value(section.inertia_in, 'm^4')}"
        )
        tube = f"tube {number(outer)}/{number(inner)} mm"
        rows.append(Row((bar.upper(), tube, values)))
    caption = (
        "Elastic data. The defaults are tubes of an aluminum alloy with the links’ masses; they "
        "are chosen, not measured."
    )
    return Table(("Part", "What", "Value"), tuple(rows), caption, words=2)


def directions_table(design: Design, found: PlatformStiffness) -> Table:
    """Return the stiffness along and about the axes."""
    alone = np.linalg.inv(drive_stiffness(design, found.pose))
    rows = []
    for axis, (name, key) in enumerate(zip(AXES, AXIS_KEYS, strict=True)):
        unit, rigid = "N/m" if axis < 3 else "N m/rad", "rigid"
        if axis in ACTUATED:
            place = ACTUATED.index(axis)
            rigid = shown(1 / alone[place, place], unit, DIGITS)
        rows.append(_direction(name, unit, float(found.along(axis)), key, rigid))
    rows.append(_direction("Softest horizontal", "N/m", float(found.horizontal), "horizontal"))
    rows.append(_direction("Softest tilt", "N m/rad", float(found.tilt), "tilt"))
    caption = "Stiffness at the pose, motors locked: of the whole robot, and with rigid bars."
    return Table(("Stiffness", "Whole robot", "Drives alone"), tuple(rows), caption)


def _direction(name: str, unit: str, value: float, key: str, rigid: str = "") -> Row:
    """Return a row of the stiffness; ``key`` ends that of the quantity, empty for none."""
    text = Cell(shown(value, unit, DIGITS), quantity=f"stiffness_{key}" if key else "")
    return Row((heading(name, unit), text, rigid))


def softest_text(found: PlatformStiffness) -> str:
    """Return the direction in which the robot is softest in the plane."""
    if math.isnan(found.softest_direction):
        return "the same in all directions"
    return f"{format_value(float(found.softest_direction), 'rad', 3)} from x"


def _ellipsoid_text(design: Design, found: PlatformStiffness) -> str:
    """Return the ellipsoid of compliance, and which bars would touch."""
    axes, directions = found.ellipsoid()
    text = f"Compliance ellipsoid: {', '.join(number(MM * axis, 3) for axis in axes)} mm/N"
    if axes[-1] - axes[-2] > ALIKE * axes[-1]:  # else rounding would choose the direction
        text += f", softest along ({', '.join(fixed(value, 2) for value in directions[:, -1])})"
    text += "."
    if touching := contacts(design, found.pose).touching():
        text += (
            f" Center lines in one plane: {', '.join(touching)} would touch and are let through."
        )
    return text


NO_FREQUENCIES = (
    "There are no natural frequencies: weight and load push the platform away harder than drives "
    "and bars hold it."
)


def _vibration(design: Design, pose: Array, *, shear: bool) -> list[Block]:
    """Return the natural frequencies of the whole robot and with elastic drives alone."""
    try:
        modes = robot_modes(design, pose, MODES, shear=shear)
    except InvalidInput as error:  # of a bar, which stiffness at rest does without
        return [Note(f"There are no natural frequencies: {error}.", "warn")]
    if not modes.ok:
        return [Note(NO_FREQUENCIES, "warn")]
    return [modes_table(modes.frequencies, drive_modes(design, pose).frequencies)]


def modes_table(frequencies: Sequence[float] | Array, alone: Sequence[float] | Array) -> Table:
    """Return the natural frequencies of the whole robot, and of its drives alone [Hz]."""
    rows = []
    for place, frequency in enumerate(frequencies):
        key = "" if place else "frequency_1"
        text = Cell(shown(frequency, "Hz", DIGITS), quantity=key)
        rigid = shown(alone[place], "Hz", DIGITS) if place < len(alone) else NONE
        rows.append(Row((f"{place + 1}", text, rigid)))
    caption = (
        "Natural frequencies at the pose, motors locked: of the whole robot, and with rigid bars "
        "and elastic drives."
    )
    head = (heading("Mode", "Hz"), "Whole robot", "Drives alone")
    return Table(head, tuple(rows), caption)


NOTHING_DEFLECTED = "There is no payload and no load, so nothing is deflected."


def _loaded(design: Design, pose: Array, *, shear: bool) -> list[Block]:
    """Return deflection, compensation and shares under payload and load, or under unit forces."""
    table = shares_table(strain_cases(design, pose, shear=shear))
    wrench = load_wrench(design, pose)
    if not np.any(wrench):
        return [Note(NOTHING_DEFLECTED), table]
    moved = compensate(design, pose, shear=shear)
    deflected = deflection_table("payload and load", wrench, moved.deflection)
    return [deflected, Note(compensation_text(moved)), table]


def shares_table(cases: Mapping[str, Array]) -> Table:
    """Return the shares of the parts in the strain energy of load cases, the largest first."""
    most = np.max(list(cases.values()), axis=0)
    rows = tuple(
        Row((SHARE_LABELS[i], *(_share(float(share[i])) for share in cases.values())))
        for i in np.argsort(-most, kind="stable")
        if most[i] >= LEAST_SHARE
    )
    caption = "Shares of the parts in the strain energy: the largest is what to stiffen first."
    return Table(("Part", *cases), rows, caption)


def _share(share: float) -> Cell:
    return Cell(percent(share, 1), share=share)


def deflection_table(case: str, wrench: Array, twist: Array) -> Table:
    """Return the deflection (6,) of the platform's center under a wrench (6,)."""
    moved, loads = _rounded(twist), [float(load) for load in wrench]
    length, angle = _unit("m", moved[:3]), _unit("rad:mrad", moved[3:])
    found = (*aligned(moved[:3], length), *aligned(moved[3:], angle))
    units = (("N", length),) * 3 + (("N m", angle),) * 3
    rows = [
        Row((heading(name, unit), format_value(load, of), text))
        for name, load, text, (of, unit) in zip(AXES, loads, found, units, strict=True)
    ]
    tilt = float(np.hypot(*moved[3:5]))
    rows.append(Row((heading("tilt", angle), "", aligned([*moved[3:], tilt], angle)[-1])))
    caption = f"Deflection of the platform’s center under {case}."
    return Table(("", "Load", "Deflection"), tuple(rows), caption)


def compensation_text(moved: Compensation) -> str:
    """Return how the motors bring the platform back, and the tilt that remains."""
    *turns, lift, tilt = _rounded(np.array([*moved.actuators, moved.tilt]))
    angle, length = _unit("rad:mrad", [*turns, tilt]), _unit("m", [lift])
    motors = ", ".join(
        f"{name} {format_value(value, length if name == 'M4' else angle, 3)}"
        for name, value in zip(ACTUATORS, (*turns, lift), strict=True)
    )
    return (
        f"The motors bring x, y, θ and z back with {motors}; a tilt of "
        f"{format_value(tilt, angle, 3)} remains."
    )


SMALL_UNITS = {"m": "m:um", "rad:mrad": "rad:arcsec"}
"""Units for less than `SMALL`."""

SMALL = 1e-5
"""Lengths and angles below this are in a smaller unit [m, rad]."""


def _unit(unit: str, values: Sequence[float] | Array) -> str:
    """Return the unit that shows the largest of some lengths or angles without many zeros."""
    return SMALL_UNITS[unit] if 0 < np.abs(values).max() < SMALL else unit


def _rounded(values: Array) -> Array:
    """Return values with zeros for what is rounding beside the largest."""
    return np.where(np.abs(values) < 1e-9 * np.abs(values).max(), 0.0, values)


DATA_KEYS = ("x_N_per_m", "y_N_per_m", "z_N_per_m", "about_x_Nm_per_rad", "about_y_Nm_per_rad",
        "about_z_Nm_per_rad")  # fmt: skip


def stiffness_data(design: Design, found: PlatformStiffness, *, shear: bool) -> dict[str, Any]:
    """Return the stiffness at a pose, for JSON, in SI units."""
    moved = compensate(design, found.pose, shear=shear)
    axes, directions = found.ellipsoid()
    alone = drive_stiffness(design, found.pose)
    return {
        **robot(design),
        "pose": found.pose,
        "shear": shear,
        "stiffness": {key: found.along(i) for i, key in enumerate(DATA_KEYS)}
        | {"horizontal_N_per_m": found.horizontal, "tilt_Nm_per_rad": found.tilt},
        "matrix": found.matrix,
        "drives_alone": alone,
        "ellipsoid": {"axes_m_per_N": axes, "directions": directions.T},
        "wrench": load_wrench(design, found.pose),
        "deflection": moved.deflection,
        "compensation": dict(zip(POSITION_KEYS, moved.actuators, strict=True)),
        "residual_tilt_rad": moved.tilt,
        "contacts": contacts(design, found.pose).touching(),
        "natural_frequencies_Hz": {
            "whole robot": robot_modes(design, found.pose, shear=shear).frequencies,
            "drives alone": drive_modes(design, found.pose).frequencies,
        },
        "shares": {
            name: dict(zip(SHARES, share, strict=True))
            for name, share in strain_cases(design, found.pose, shear=shear).items()
        },
    }
