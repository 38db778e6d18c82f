"""The load on the platform, and what the actuators' limits let it hold and reach."""

from __future__ import annotations

import numpy as np

from paminsa_viz.actuation.polytope import wrench_polytope
from paminsa_viz.actuation.wrench_capability import actuator_limits, capability
from paminsa_viz.errors import PaminsaError
from paminsa_viz.model.drive import ACTUATORS
from paminsa_viz.model.grids import Grid, solve_field
from paminsa_viz.model.load import center_wrench
from paminsa_viz.model.statics import load_torques
from paminsa_viz.quantities import find
from paminsa_viz.report.blocks import Block, Note, Row, Section, Table
from paminsa_viz.report.request import ReportRequest
from paminsa_viz.studies.metrics import RegionResults, default_region, global_indices
from paminsa_viz.units import format_value

KEYS = (
    "payload", "horizontal_force", "vertical_force", "moment", "speed", "turn_speed",
    "acceleration", "turn_acceleration", "transmission", "selective_x", "selective_y",
    "selective_theta", "selective_z", "conditioning",
)  # fmt: skip
"""Quantities of the table, with their global indices."""

_UNITS = ("N m", "N m", "N m", "N")


def forces_section(request: ReportRequest) -> Section:
    """Return the section."""
    blocks = [*_load(request), _limits(request), *_capability(request)]
    return Section("forces", "Forces and capability", tuple(blocks))


def _load(request: ReportRequest) -> list[Block]:
    design, pose = request.design, np.array(request.pose)
    if not design.load.acts:
        return [Note("No external force or moment acts on the platform.")]
    wrench = center_wrench(design.load, pose[2])
    names = ("F_x", "F_y", "F_z", "M_x", "M_y", "M_z")
    units = ("N",) * 3 + ("N m",) * 3
    rows = [
        Row((name, "bearings alone" if name in ("M_x", "M_y") else "actuators", value))
        for name, value in zip(names, map(format_value, wrench, units), strict=True)
    ]
    against = load_torques(design.geometry, design.load, pose)
    rows += [
        Row((name, "required against the load", format_value(value, unit)))
        for name, value, unit in zip(ACTUATORS, against, _UNITS, strict=True)
    ]
    caption = (
        "The load at the platform's center, in base axes, at the report's pose. M_x, M_y and the "
        "horizontal moments of the offset do no work: no actuator sees them."
    )
    return [Table(("Symbol", "Carried by", "Value"), tuple(rows), caption, words=2)]


def _limits(request: ReportRequest) -> Table:
    limits = actuator_limits(request.design)
    rows = []
    for j, name in enumerate(ACTUATORS):
        own = "default" if request.design.drives[j] is None else "drive"
        speed = format_value(limits.speed[j], "rad/s" if j < 3 else "m/s")
        torques = (format_value(value[j], _UNITS[j]) for value in (limits.rated, limits.peak))
        rows.append(Row((name, own, *torques, speed)))
    head = ("Actuator", "Limits of", "On end", "Peak", "Speed")
    return Table(head, tuple(rows), "Limits that the capability is worked out with.", words=2)


def _capability(request: ReportRequest) -> list[Block]:
    design, pose = request.design, np.array(request.pose)
    try:
        polytope = wrench_polytope(design, pose)
    except PaminsaError as error:
        return [Note(f"The capability has no value at this pose: {error}.", "warn")]
    at, region = capability(design, pose), default_region(design)
    over, here = RegionResults(design, region), solve_field(design.geometry, Grid.over(pose))
    metrics = global_indices(KEYS)
    values = [metric.value(over) for metric in metrics]
    rows = []
    for number, quantity in enumerate(find(KEYS)):
        shown = format_value(float(quantity.over(here, design)), quantity.unit)
        indices = values[3 * number : 3 * number + 3]
        cells = (format_value(value, quantity.unit) for value in indices)
        rows.append(Row((quantity.symbol, quantity.title, shown, *cells)))
    heights = ", ".join(format_value(z, "m") for z in region.z)
    angles = ", ".join(format_value(angle, "rad") for angle in region.theta)
    caption = (
        f"At the report's pose, and mean, least value and standard deviation over the poses that "
        f"can be reached within {format_value(region.radius, 'm')} of the axis at θ {angles} and "
        f"z {heights}."
    )
    index, sign = at.horizontal_limit
    limit = f"{ACTUATORS[int(index)]} at {'+' if sign > 0 else '−'}T"
    nearest = polytope.faces[polytope.limiting_face]
    text = f"The horizontal force at the report's pose is limited by {limit}; the face of the "
    text += f"wrench polytope nearest to zero is {nearest}."
    head = ("Symbol", "Quantity", "Here", "Mean", "Least", "Spread")
    return [Table(head, tuple(rows), caption, words=2), Note(text)]
