"""The elastic robot: its data, its stiffness at the report's pose and over the workspace."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from paminsa_viz.blocks.kinds import Block, Note, Row, Table
from paminsa_viz.elastostatics.beams import TubeFit
from paminsa_viz.elastostatics.drive_stiffness import drive_modes, drive_stiffness
from paminsa_viz.elastostatics.leg_frame import contacts
from paminsa_viz.elastostatics.stiffness import (
    SHARE_LABELS,
    SHARES,
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
from paminsa_viz.units import MM, NONE, format_value, number

MODES = 6
"""Natural frequencies of the table."""

AXES = ("x", "y", "z", "about x", "about y", "about z")
ACTUATED = (0, 1, 5, 2)
"""Places of x, y, theta, z among them."""

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
    return [
        *_directions(design, found),
        *_loaded(design, found.pose, shear=shear),
        *_vibration(design, found.pose, shear=shear),
    ]


def sections_table(design: Design, fits: Sequence[TubeFit]) -> Table:
    """Return the bars' tubes beside the design's masses and inertias."""
    rows = []
    for fit in fits:
        ends = (design.value(f"elastic.{fit.bar.lower()}_{side}") for side in ("outer", "inner"))
        outer, inner = (number(MM * end) for end in ends)
        ratios = (fit.mass_ratio, fit.slender_ratio, fit.transverse_ratio, fit.axial_ratio)
        texts = (number(ratio, 3) for ratio in ratios)
        rows.append(Row((fit.bar, f"{outer}/{inner} mm", f"{fit.mass:.3f} kg", *texts)))
    head = ("", "Tube", "Mass", "Link/tube", "I_YY/(m l²/12)", "I_YY/tube", "I_XX/tube")
    caption = "Tubes of [elastic], and the links' masses and inertias over theirs."
    return Table(head, tuple(rows), caption)


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
        Row(("E", "Young's modulus", format_value(elastic.young_modulus, "Pa"))),
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
        "Elastic data. The defaults are tubes of an aluminum alloy with the links' masses; they "
        "are chosen, not measured."
    )
    return Table(("Part", "What", "Value"), tuple(rows), caption, words=2)


def _directions(design: Design, found: PlatformStiffness) -> list[Block]:
    """Return the stiffness along and about the axes, and the ellipsoid of compliance."""
    alone = np.linalg.inv(drive_stiffness(design, found.pose))
    rows = []
    for axis, name in enumerate(AXES):
        unit, rigid = "N/m" if axis < 3 else "N m/rad", "rigid"
        if axis in ACTUATED:
            place = ACTUATED.index(axis)
            rigid = format_value(float(1 / alone[place, place]), unit)
        rows.append(Row((name, format_value(float(found.along(axis)), unit), rigid)))
    rows.append(Row(("softest horizontal", format_value(float(found.horizontal), "N/m"))))
    rows.append(Row(("softest tilt", format_value(float(found.tilt), "N m/rad"))))
    axes, directions = found.ellipsoid()
    softest = ", ".join(f"{value:.2f}" for value in directions[:, -1])
    text = (
        f"Compliance ellipsoid: {', '.join(f'{MM * axis:.3g}' for axis in axes)} mm/N, softest "
        f"along ({softest})."
    )
    if touching := contacts(design, found.pose).touching():
        text += (
            f" Center lines in one plane: {', '.join(touching)} would touch and are let through."
        )
    caption = "Stiffness at the pose, motors locked: of the whole robot, and with rigid bars."
    head = ("Direction", "Whole robot", "Drives alone")
    return [Table(head, tuple(rows), caption), Note(text)]


def _vibration(design: Design, pose: Array, *, shear: bool) -> list[Block]:
    """Return the natural frequencies of the whole robot and with elastic drives alone."""
    try:
        modes = robot_modes(design, pose, MODES, shear=shear)
    except InvalidInput as error:  # of a bar, which stiffness at rest does without
        return [Note(f"There are no natural frequencies: {error}.", "warn")]
    if not modes.ok:
        text = "Weight and load push the platform away harder than drives and bars hold it"
        return [Note(f"{text}: there are no natural frequencies.", "warn")]
    alone = drive_modes(design, pose).frequencies
    rows = []
    for place, frequency in enumerate(modes.frequencies):
        rigid = format_value(float(alone[place]), "Hz") if place < alone.size else NONE
        rows.append(Row((f"{place + 1}", format_value(float(frequency), "Hz"), rigid)))
    caption = (
        "Natural frequencies at the pose, motors locked: of the whole robot, and with rigid bars "
        "and elastic drives."
    )
    return [Table(("Mode", "Whole robot", "Drives alone"), tuple(rows), caption)]


def _loaded(design: Design, pose: Array, *, shear: bool) -> list[Block]:
    """Return deflection, compensation and shares under payload and load, or under unit forces."""
    shares = strain_cases(design, pose, shear=shear)
    order = np.argsort(-np.max(list(shares.values()), axis=0))
    rows = tuple(
        Row((SHARE_LABELS[i], *(f"{100 * share[i]:.1f} %" for share in shares.values())))
        for i in order
        if any(share[i] > 0 for share in shares.values())
    )
    caption = "Shares of the parts in the strain energy: the largest is what to stiffen first."
    table = Table(("Part", *shares), rows, caption)
    wrench = load_wrench(design, pose)
    if not np.any(wrench):
        return [Note("There is no payload and no load, so nothing is deflected."), table]
    moved = compensate(design, pose, shear=shear)
    twist, back = _rounded(moved.deflection), _rounded(moved.actuators)
    units = (("N", "m"),) * 3 + (("N m", "rad"),) * 3
    deflections = tuple(
        Row((name, format_value(float(load), of), format_value(float(value), unit, 3)))
        for name, load, value, (of, unit) in zip(AXES, wrench, twist, units, strict=True)
    )
    motors = ", ".join(
        f"{name} {format_value(value, 'm' if name == 'M4' else 'rad', 3)}"
        for name, value in zip(ACTUATORS, back, strict=True)
    )
    text = (
        f"The motors bring x, y, θ and z back with {motors}; a tilt of "
        f"{format_value(float(np.hypot(*twist[3:5])), 'rad', 3)} remains."
    )
    caption = "Deflection of the platform's center under payload and load."
    return [Table(("", "Load", "Deflection"), deflections, caption), Note(text), table]


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
        "design": design.name,
        "pose": found.pose,
        "shear": shear,
        "stiffness": {key: found.along(i) for i, key in enumerate(DATA_KEYS)}
        | {"horizontal_N_per_m": found.horizontal, "tilt_Nm_per_rad": found.tilt},
        "matrix": found.matrix,
        "drives_alone": alone,
        "ellipsoid": {"axes_m_per_N": axes, "directions": directions.T},
        "wrench": load_wrench(design, found.pose),
        "deflection": moved.deflection,
        "compensation": dict(zip(ACTUATORS, moved.actuators, strict=True)),
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
