"""The lengths of each leg as arrays (..., 3 legs, 14): nominal ones, and those of a design.

Their names, symbols and units are those of `LegDeviations`, in its order.
"""

from __future__ import annotations

from dataclasses import astuple, dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.accuracy import (
    LEG_NAMES,
    LENGTH_NAMES,
    Leg1Deviations,
    Leg2Deviations,
    Leg3Deviations,
    LegDeviations,
)
from paminsa_viz.model.arguments import of_design, of_geometry
from paminsa_viz.model.arrays import Array, as_numbers
from paminsa_viz.model.design import Design, Geometry
from paminsa_viz.model.kinematics import AXIS_ANGLES


@dataclass(frozen=True)
class LegLength:
    """One length of a leg.

    Attributes:
        name: Field of `LegDeviations`.
        symbol: Symbol in plain text, see `units.symbol_text`.
        unit: SI unit, m or rad.
        label: Plain name.
    """

    name: str
    symbol: str
    unit: str
    label: str


LENGTHS: tuple[LegLength, ...] = tuple(
    LegLength(item.name, item.metadata["symbol"], item.metadata["unit"], item.metadata["label"])
    for item in fields(LegDeviations)
)
"""The lengths of a leg, in the order of the last axis."""

INDEX: dict[str, int] = {name: index for index, name in enumerate(LENGTH_NAMES)}
"""Place of a length on the last axis, by its name."""


@of_geometry
def nominal_lengths(geometry: Geometry) -> Array:
    """Return the lengths of a robot as it was drawn, (3, 14) [m, rad]."""
    g, share = geometry, 1 / geometry.magnification
    same = {
        "bar_94": g.short_coupler_length,
        "bar_45": g.coupler_length * (1 - share),
        "bar_43": g.crank_length * (1 - share),
        "bar_37": g.crank_length * share,
        "bar_87": g.short_coupler_length,
        "bar_89": g.crank_length,
        "shaft": g.shaft_length,
        "joint_height": g.platform_joint_height,
        "axis_radius": g.base_radius,
        "joint_radius": g.platform_radius,
    }
    lengths = np.zeros((3, len(LENGTHS)))
    for name, value in same.items():
        lengths[:, INDEX[name]] = value
    for name in ("axis_angle", "joint_angle"):
        lengths[:, INDEX[name]] = AXIS_ANGLES
    return lengths


def deviation_array(design: Design) -> Array:
    """Return the deviations of a design's legs, (3, 14) [m, rad]."""
    return np.array([astuple(leg) for leg in design.deviations])


def lengths_only(design: Design) -> Design:
    """Return a design with nothing of its own but lengths and their deviations."""
    legs: Any = dict(zip(LEG_NAMES, design.deviations, strict=True))
    return Design(geometry=design.geometry, **legs)


@of_design
def design_lengths(design: Design) -> Array:
    """Return the lengths of a design's legs, deviations included, (3, 14) [m, rad]."""
    return nominal_lengths(design.geometry) + deviation_array(design)


@of_design
def with_deviations(design: Design, values: ArrayLike) -> Design:
    """Return a design whose legs have the deviations (3, 14) [m, rad].

    Raises:
        InvalidInput: If the shape is another one.
        InvalidDesign: If a number is not finite or too large.
    """
    array = as_lengths(values, "values")
    if array.ndim != 2:
        raise InvalidInput("values", f"the shape has to be (3, 14), not {array.shape}")
    one, two, three = array.tolist()
    return replace(
        design,
        leg1=Leg1Deviations(*one),
        leg2=Leg2Deviations(*two),
        leg3=Leg3Deviations(*three),
    )


def as_lengths(values: ArrayLike, argument: str = "lengths") -> Array:
    """Return values as float64 (..., 3, 14).

    Raises:
        InvalidInput: If they are no real numbers, or the last two axes are others.
    """
    array = as_numbers(values, argument)
    if array.shape[-2:] != (3, len(LENGTHS)):
        problem = f"the last axes have to be 3 legs and {len(LENGTHS)} lengths"
        raise InvalidInput(argument, f"{problem}; the shape is {array.shape}")
    return array
