"""Quantities of the elastic robot: stiffness of the platform, motors locked, and deflection."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from paminsa_viz.elastostatics.stiffness import PlatformStiffness, field_stiffness
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.grids import Field
from paminsa_viz.model.reach import LEAST_MARGIN, Limit
from paminsa_viz.quantities.quantity import Quantity, in_family

COST = 2.5e-5
"""Time for the stiffness of a pose [s]."""


Value = Callable[[Field, Design], Array]
"""Value of a quantity over a field."""


def _of(value: Callable[[PlatformStiffness], Array]) -> Value:
    """Return a value of the stiffness over a field; NaN where a pose cannot be taken."""

    def over(field: Field, design: Design) -> Array:
        return np.where(field.status == Limit.OK, value(field_stiffness(field, design)), np.nan)

    return over


def _along(axis: int) -> Value:
    return _of(lambda found: found.along(axis))


def _quantity(
    key: str,
    symbol: str,
    label: str,
    title: str,
    unit: str,
    value: Callable[[Field, Design], Array],
) -> Quantity:
    bounded = not key.startswith("deflection")
    return Quantity(
        key, symbol, label, title, unit, LEAST_MARGIN, value, bounded=bounded, cost=COST
    )


STIFFNESS = in_family(
    "stiffness",
    _quantity(
        "stiffness_x", "K_x", "stiffness in x", "Stiffness in x: force over displacement",
        "N/m", _along(0),
    ),
    _quantity(
        "stiffness_y", "K_y", "stiffness in y", "Stiffness in y: force over displacement",
        "N/m", _along(1),
    ),
    _quantity(
        "stiffness_z", "K_z", "stiffness in z", "Stiffness in z: force over displacement",
        "N/m", _along(2),
    ),
    _quantity(
        "stiffness_theta", "K_θ", "stiffness in θ", "Stiffness in θ: moment over rotation",
        "N m/rad", _along(5),
    ),
    _quantity(
        "stiffness_tilt", "K_tilt", "tilt stiffness",
        "Tilt stiffness about the softest axis", "N m/rad",
        _of(lambda found: found.tilt),
    ),
    _quantity(
        "stiffness_horizontal", "K_h", "smallest horizontal stiffness",
        "Smallest horizontal stiffness", "N/m",
        _of(lambda found: found.horizontal),
    ),
    _quantity(
        "deflection", "δ", "deflection",
        "Deflection under payload and load", "m",
        _of(lambda found: np.linalg.norm(found.deflection()[..., :3], axis=-1)),
    ),
    _quantity(
        "deflection_tilt", "δ_tilt", "tilt under load",
        "Tilt under payload and load", "rad",
        _of(lambda found: np.linalg.norm(found.deflection()[..., 3:5], axis=-1)),
    ),
)  # fmt: skip
