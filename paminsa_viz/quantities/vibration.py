"""Natural frequencies of the elastic robot with locked motors."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from paminsa_viz.elastostatics.drive_modes import drive_modes
from paminsa_viz.elastostatics.vibration import first_frequencies
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.grids import Field
from paminsa_viz.model.reach import LEAST_MARGIN, Limit
from paminsa_viz.quantities.quantity import Quantity, in_family

COST = 3e-4
"""Time for the first frequency of a pose of the whole robot [s]."""

DRIVES_COST = 2e-5
"""The same with elastic drives alone [s]."""


def _frequency(name: str, find: Callable[[Design, Array], Array]) -> Callable[..., Array]:
    """Return frequencies over a field, kept until the design changes."""

    def over(field: Field, design: Design) -> Array:
        def solve() -> Array:
            poses = field.grid.poses()
            poses[field.status != Limit.OK] = np.nan
            return find(replace(design, geometry=field.geometry), poses)

        return field.keep(name, design, solve)

    return over


VIBRATION = in_family(
    "stiffness",
    Quantity(
        "frequency_1", "f₁", "first natural frequency",
        "First natural frequency of the whole robot, motors locked", "Hz", LEAST_MARGIN,
        _frequency("frequency_1", first_frequencies), bounded=True, cost=COST,
    ),
    Quantity(
        "frequency_drives", "f₁ drives", "first frequency, drives alone",
        "First natural frequency with rigid bars and elastic drives", "Hz", LEAST_MARGIN,
        _frequency(
            "frequency_drives", lambda design, poses: drive_modes(design, poses).frequencies[..., 0]
        ),
        bounded=True, cost=DRIVES_COST,
    ),
)  # fmt: skip
