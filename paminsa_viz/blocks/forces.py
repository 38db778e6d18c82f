"""The load on the platform, and what the actuators' limits let it hold and reach."""

from __future__ import annotations

import math
from collections.abc import Sequence

from paminsa_viz.actuation.polytope import wrench_polytope
from paminsa_viz.actuation.wrench_capability import actuator_limits, capability
from paminsa_viz.blocks.external_load import load_notes
from paminsa_viz.blocks.kinds import Block, Note, Row, Table
from paminsa_viz.errors import InvalidInput, PaminsaError
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.drive import ACTUATORS, SPEED_UNITS, TORQUE_UNITS
from paminsa_viz.model.grids import Grid, solve_field
from paminsa_viz.quantities import find
from paminsa_viz.studies.metrics import global_indices
from paminsa_viz.studies.region import RegionResults, default_region
from paminsa_viz.units import format_value

KEYS = (
    "payload", "horizontal_force", "vertical_force", "moment", "speed", "turn_speed",
    "acceleration", "turn_acceleration", "transmission", "selective_x", "selective_y",
    "selective_theta", "selective_z", "conditioning",
)  # fmt: skip
"""Quantities of the table, with their global indices."""


def forces_blocks(design: Design, pose: Array) -> list[Block]:
    """Return the load, the actuators' limits and the capability at a pose (4,)."""
    return [*load_notes(design, pose), _limits(design), *_capability(design, pose)]


def _limits(design: Design) -> Table:
    limits = actuator_limits(design)
    rows = []
    for j, name in enumerate(ACTUATORS):
        own = "default" if design.drives[j] is None else "drive"
        speed = format_value(limits.speed[j], SPEED_UNITS[j])
        torques = (format_value(value[j], TORQUE_UNITS[j]) for value in (limits.rated, limits.peak))
        rows.append(Row((name, own, *torques, speed)))
    head = ("Actuator", "Limits of", "Continuous", "Peak", "Speed")
    return Table(head, tuple(rows), "Limits that the capability is worked out with.", words=2)


def _capability(design: Design, pose: Array) -> list[Block]:
    try:
        polytope = wrench_polytope(design, pose)
    except PaminsaError as error:
        return [Note(f"The capability has no value at this pose: {error}.", "warn")]
    at = capability(design, pose)
    index, sign = at.horizontal_limit
    limit = f"{ACTUATORS[int(index)]} at {'+' if sign > 0 else '−'}T"
    nearest = polytope.faces[polytope.limiting_face]
    text = f"The horizontal force at the report’s pose is limited by {limit}; the face of the "
    text += f"wrench polytope nearest to zero is {nearest}."
    return [index_table(design, pose, KEYS), Note(text)]


def index_table(design: Design, pose: Array, keys: Sequence[str], about: str = "") -> Table:
    """Return quantities at a pose (4,) and their global indices over the default region."""
    region = default_region(design)
    over, here = RegionResults(design, region), solve_field(design.geometry, Grid.over(pose))
    rows: list[Row] = []
    without: dict[str, str] = {}
    for quantity in find(keys):
        try:
            indices = [metric.value(over) for metric in global_indices([quantity.key])]
            values = [float(quantity.over(here, design)), *indices]
        except InvalidInput as error:  # a design that is none for this quantity
            values = [math.nan] * 4
            without[quantity.symbol] = str(error)
        cells = (format_value(value, quantity.unit) for value in values)
        rows.append(Row((quantity.symbol, quantity.title, *cells)))
    caption = (
        f"{about}At the report’s pose, and mean, least value and standard deviation over the poses "
        f"that can be reached {region.words}."
    )
    for reason in dict.fromkeys(without.values()):
        symbols = [symbol for symbol in without if without[symbol] == reason]
        caption += f" {', '.join(symbols)}: no value, {reason}."
    head = ("Symbol", "Quantity", "Here", "Mean", "Least", "Spread")
    return Table(head, tuple(rows), caption, words=2)
