"""From a solved grid of the model to the data of a map: names, units, colors, provenance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

import paminsa_viz
from paminsa_viz.model.design import Design
from paminsa_viz.model.errors import InvalidInput
from paminsa_viz.model.grids import Field, Quantity
from paminsa_viz.model.parameters import PARAMETERS
from paminsa_viz.model.singularity import singular_radius
from paminsa_viz.model.statics import static_imbalance
from paminsa_viz.palette import INK, LEG_COLORS, LIFT_COLOR
from paminsa_viz.plots.maps import MapData, Provenance

TORQUES: tuple[Quantity, ...] = (Quantity.TAU_1, Quantity.TAU_2, Quantity.TAU_3)
"""The three panels of Fig. 3."""


@dataclass(frozen=True)
class Legend:
    """How a quantity is presented.

    Attributes:
        name: Short name for the heading of a panel.
        title: What it is, in words.
        color: Color of the heading.
        signed: Whether zero is its natural center.
    """

    name: str
    title: str
    color: str
    signed: bool


LEGENDS: dict[Quantity, Legend] = {
    Quantity.TAU_1: Legend("τ₁", "Static torque of actuator 1", LEG_COLORS[0], True),
    Quantity.TAU_2: Legend("τ₂", "Static torque of actuator 2", LEG_COLORS[1], True),
    Quantity.TAU_3: Legend("τ₃", "Static torque of actuator 3", LEG_COLORS[2], True),
    Quantity.F_4: Legend("F₄", "Static force of actuator 4", LIFT_COLOR, False),
    Quantity.MAX_TORQUE: Legend("max |τ|", "Largest static torque of M1 to M3", INK, False),
    Quantity.RMS_TORQUE: Legend("RMS τ", "RMS of the static torques of M1 to M3", INK, False),
    Quantity.CONDITION: Legend("κ", "Condition number", INK, False),
    Quantity.DETERMINANT: Legend("det", "Determinant, zero at a singularity", INK, True),
    Quantity.REACH_MARGIN: Legend("margin", "Distance to the nearest limit of reach", INK, False),
}


def provenance(design: Design) -> Provenance:
    """Return what captions and file headers say of a design."""
    numbers = [("Mₚ₂", static_imbalance(design), "N")]
    if design.payload.mass:
        numbers.append(("payload", design.payload.mass, "kg"))
    return Provenance(
        design=design.name,
        knee=design.geometry.knee,
        version=paminsa_viz.__version__,
        numbers=tuple(numbers),
        parameters=tuple(
            (f"{p.path} [{p.unit}]" if p.unit else p.path, design.value(p.path)) for p in PARAMETERS
        ),
    )


def map_data(
    field: Field, design: Design, pose: ArrayLike, quantities: Sequence[Quantity] = TORQUES
) -> MapData:
    """Return maps of some quantities over a solved x-y grid, for the masses of a design.

    Args:
        field: A solved grid made by `paminsa_viz.model.grids.xy_grid`.
        design: The design; its geometry has to be that of the field.
        pose: Present pose (4,) [m, m, rad, m], at the grid's theta and z.
        quantities: What to show, one a panel, all in one unit.

    Raises:
        InvalidInput: If the grid is not over x and y, the geometry, theta or z of design and pose
            are not the field's, or the quantities differ in unit.
    """
    names = tuple(name for name, _ in field.grid.axes)
    if names != ("y", "x"):
        raise InvalidInput("field", f"a grid over y and x is needed, not {' and '.join(names)}")
    if field.geometry != design.geometry:
        raise InvalidInput("design", "its geometry is not the one that the field was solved for")
    present = np.asarray(pose, dtype=np.float64)
    if present.shape != (4,) or not np.array_equal(present[2:], field.grid.fixed[2:]):
        raise InvalidInput("pose", "a pose (4,) at the theta and z of the field is needed")
    units = {quantity.unit for quantity in quantities}
    if len(units) != 1:
        raise InvalidInput("quantities", "one or several of one unit are needed")
    legends = [LEGENDS[quantity] for quantity in quantities]
    values = np.stack([field.values(design, quantity) for quantity in quantities])
    return MapData(
        x=field.grid.axes[1][1],
        y=field.grid.axes[0][1],
        values=np.where(field.status != 0, np.nan, values),
        status=field.status,
        names=tuple(legend.name for legend in legends),
        unit=units.pop(),
        colors=tuple(legend.color for legend in legends),
        pose=present,
        singular_radius=float(singular_radius(design.geometry, present[2])),
        provenance=provenance(design),
        title=legends[0].title if len(legends) == 1 else "Static torques of the rotary actuators",
        signed=any(legend.signed for legend in legends),
        margin=field.margin,
        leg=field.leg,
    )
