"""Quantities of the elastic robot, motors locked: stiffness, deflection, natural frequencies."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from paminsa_viz.elastostatics.drive_stiffness import drive_modes
from paminsa_viz.elastostatics.stiffness import PlatformStiffness, field_stiffness
from paminsa_viz.elastostatics.vibration import first_frequencies
from paminsa_viz.model.arrays import Array, in_blocks
from paminsa_viz.model.design import Design
from paminsa_viz.model.grids import Field
from paminsa_viz.model.reach import LEAST_MARGIN, Limit
from paminsa_viz.quantities.quantity import Missing, Quantity, in_family, kept_over_poses

COST = 2.5e-5
"""Time for the stiffness of a pose [s]."""


def _stiffness(
    key: str, symbol: str, label: str, title: str, unit: str,
    of: Callable[[PlatformStiffness], Array], *, bounded: bool = True,
) -> Quantity:  # fmt: skip
    """Return a value of the platform's stiffness as a quantity."""

    def value(field: Field, design: Design) -> Array:
        return np.where(field.status == Limit.OK, of(field_stiffness(field, design)), np.nan)

    return Quantity(
        key, symbol, label, title, unit, LEAST_MARGIN, value, bounded=bounded, cost=COST
    )


FREQUENCY_COST = 3e-4
"""Time for the first frequency of a pose of the whole robot [s]."""

DRIVES_COST = 2e-5
"""The same with elastic drives alone [s]."""


_TEXTS = ("", "not held: weight and load push the platform away harder than it is held")
_WORDS = ("", "not-held")


def _not_held(over: Callable[[Field, Design], Array]) -> Callable[[Field, Design], Missing]:
    """Return where poses that can be taken have no frequency."""

    def missing(field: Field, design: Design) -> Missing:
        empty = (field.status == Limit.OK) & np.isnan(over(field, design))
        return Missing(empty.astype(np.uint8), _TEXTS, _WORDS)

    return missing


_FIRST = kept_over_poses("frequency_1", first_frequencies)
BLOCK = 4096
"""Poses worked on at a time with elastic drives alone."""


def _first_of_drives(design: Design, poses: Array) -> Array:
    """Return the first frequency with elastic drives alone at poses (..., 4), (...) [Hz]."""

    def found(some: Array) -> list[Array]:
        return [drive_modes(design, some).frequencies[:, 0]]

    return in_blocks(found, poses, BLOCK)[0]


_DRIVES = kept_over_poses("frequency_drives", _first_of_drives)

STIFFNESS = in_family(
    "stiffness",
    _stiffness("stiffness_x", "K_x", "stiffness in x", "Stiffness in x: force over displacement",
               "N/m", lambda found: found.along(0)),
    _stiffness("stiffness_y", "K_y", "stiffness in y", "Stiffness in y: force over displacement",
               "N/m", lambda found: found.along(1)),
    _stiffness("stiffness_z", "K_z", "stiffness in z", "Stiffness in z: force over displacement",
               "N/m", lambda found: found.along(2)),
    _stiffness("stiffness_theta", "K_θ", "stiffness in θ", "Stiffness in θ: moment over rotation",
               "N m/rad", lambda found: found.along(5)),
    _stiffness("stiffness_tilt", "K_tilt", "tilt stiffness",
               "Tilt stiffness about the softest axis", "N m/rad", lambda found: found.tilt),
    _stiffness("stiffness_horizontal", "K_h", "smallest horizontal stiffness",
               "Smallest horizontal stiffness", "N/m", lambda found: found.horizontal),
    _stiffness("deflection", "δ", "deflection", "Deflection under payload and load", "m",
               lambda found: np.linalg.norm(found.deflection()[..., :3], axis=-1), bounded=False),
    _stiffness("deflection_tilt", "δ_tilt", "tilt under load", "Tilt under payload and load",
               "rad", lambda found: np.linalg.norm(found.deflection()[..., 3:5], axis=-1),
               bounded=False),
    Quantity(
        "frequency_1", "f₁", "first natural frequency",
        "First natural frequency of the whole robot, motors locked", "Hz", LEAST_MARGIN, _FIRST,
        bounded=True, cost=FREQUENCY_COST, missing=_not_held(_FIRST),
    ),
    Quantity(
        "frequency_drives", "f₁ drives", "first frequency, drives alone",
        "First natural frequency with rigid bars and elastic drives", "Hz", LEAST_MARGIN, _DRIVES,
        bounded=True, cost=DRIVES_COST, missing=_not_held(_DRIVES),
    ),
)  # fmt: skip
