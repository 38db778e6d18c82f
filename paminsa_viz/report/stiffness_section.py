"""The elastic robot: its data, its stiffness at the report's pose and over the workspace."""

from __future__ import annotations

import numpy as np

from paminsa_viz.elastostatics.drive_modes import drive_modes
from paminsa_viz.elastostatics.stiffness import (
    SHARES,
    compensate,
    load_wrench,
    platform_stiffness,
    strain_shares,
)
from paminsa_viz.elastostatics.vibration import robot_modes
from paminsa_viz.model.drive import ACTUATORS
from paminsa_viz.model.elastic import BARS
from paminsa_viz.model.grids import Grid, solve_field
from paminsa_viz.model.reach import Limit
from paminsa_viz.quantities import find
from paminsa_viz.report.blocks import Block, Note, Row, Section, Table
from paminsa_viz.report.request import ReportRequest
from paminsa_viz.studies.metrics import RegionResults, default_region, global_indices
from paminsa_viz.units import MM, NONE, format_value, number

MODES = 6
"""Natural frequencies of the table."""

KEYS = ("stiffness_x", "stiffness_y", "stiffness_z", "stiffness_theta", "stiffness_tilt",
        "stiffness_horizontal", "frequency_1")  # fmt: skip
"""Quantities of the table, with their global indices."""


def stiffness_section(request: ReportRequest) -> Section:
    """Return the section."""
    blocks = [_data(request), *_here(request)]
    return Section("stiffness", "Stiffness", tuple(blocks))


def _data(request: ReportRequest) -> Table:
    design = request.design
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


def _here(request: ReportRequest) -> list[Block]:
    design, pose = request.design, np.array(request.pose)
    found = platform_stiffness(design, pose)
    if found.status != Limit.OK:
        reason = Limit(int(found.status)).reason(int(found.leg))
        return [Note(f"The stiffness has no value at this pose: {reason}.", "warn")]
    region = default_region(design)
    over, here = RegionResults(design, region), solve_field(design.geometry, Grid.over(pose))
    values = [metric.value(over) for metric in global_indices(KEYS)]
    rows = []
    for place, quantity in enumerate(find(KEYS)):
        shown = quantity.display.format(float(quantity.over(here, design)))
        indices = values[3 * place : 3 * place + 3]
        cells = (quantity.display.format(value) for value in indices)
        rows.append(Row((quantity.symbol, quantity.title, shown, *cells)))
    head = ("Symbol", "Quantity", "Here", "Mean", "Least", "Spread")
    caption = (
        f"Stiffness of the whole robot, motors locked, everything else free: at the report's pose, "
        f"and over the poses within {format_value(region.radius, 'm')} of the axis."
    )
    return [Table(head, tuple(rows), caption, words=2), *_loaded(request), *_vibration(request)]


def _vibration(request: ReportRequest) -> list[Block]:
    """Return the natural frequencies of the whole robot and with elastic drives alone."""
    design, pose = request.design, np.array(request.pose)
    modes = robot_modes(design, pose, MODES)
    if not modes.stable:
        text = "Weight and load push the platform away harder than drives and bars hold it"
        return [Note(f"{text}: there are no natural frequencies.", "warn")]
    alone = drive_modes(design, pose).frequencies
    rows = []
    for place, frequency in enumerate(modes.frequencies):
        rigid = format_value(float(alone[place]), "Hz") if place < alone.size else NONE
        rows.append(Row((f"{place + 1}", format_value(float(frequency), "Hz"), rigid)))
    caption = (
        "Natural frequencies at the report's pose, motors locked: of the whole robot, and with "
        "rigid bars and elastic drives."
    )
    return [Table(("Mode", "Whole robot", "Drives alone"), tuple(rows), caption, words=1)]


def _loaded(request: ReportRequest) -> list[Block]:
    """Return deflection, compensation and shares under payload and load, or under unit forces."""
    design, pose = request.design, np.array(request.pose)
    loaded = bool(np.any(load_wrench(design, pose)))
    cases = {"Under the load": None} if loaded else {"1 N along x": 0, "1 N along z": 2}
    shares = {
        name: strain_shares(design, pose, None if axis is None else np.eye(6)[axis]).share
        for name, axis in cases.items()
    }
    order = np.argsort(-np.max(list(shares.values()), axis=0))
    rows = tuple(
        Row((SHARES[i], *(f"{100 * share[i]:.1f} %" for share in shares.values())))
        for i in order
        if any(share[i] > 0 for share in shares.values())
    )
    caption = "Shares of the parts in the strain energy: the largest is what to stiffen first."
    table = Table(("Part", *shares), rows, caption, words=1)
    if not loaded:
        return [Note("There is no payload and no load, so nothing is deflected."), table]
    moved = compensate(design, pose)
    x, y, z = (format_value(value, "m", 3) for value in moved.deflection[:3])
    motors = ", ".join(
        f"{name} {format_value(value, 'm' if name == 'M4' else 'rad', 3)}"
        for name, value in zip(ACTUATORS, moved.actuators, strict=True)
    )
    text = (
        f"Payload and load move the platform's center by {x}, {y}, {z}. The motors bring x, y, θ "
        f"and z back with {motors}; a tilt of {format_value(float(moved.tilt), 'rad', 3)} remains."
    )
    return [Note(text), table]
