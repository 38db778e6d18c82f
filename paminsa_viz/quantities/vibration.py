"""Natural frequencies of the elastic robot with locked motors."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from paminsa_viz.elastostatics.drive_stiffness import drive_modes
from paminsa_viz.elastostatics.vibration import first_frequencies
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.grids import Field
from paminsa_viz.model.reach import LEAST_MARGIN, Limit
from paminsa_viz.quantities.quantity import Missing, Quantity, in_family, kept_over_poses

COST = 3e-4
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
_DRIVES = kept_over_poses(
    "frequency_drives", lambda design, poses: drive_modes(design, poses).frequencies[..., 0]
)

VIBRATION = in_family(
    "stiffness",
    Quantity(
        "frequency_1", "f₁", "first natural frequency",
        "First natural frequency of the whole robot, motors locked", "Hz", LEAST_MARGIN, _FIRST,
        bounded=True, cost=COST, missing=_not_held(_FIRST),
    ),
    Quantity(
        "frequency_drives", "f₁ drives", "first frequency, drives alone",
        "First natural frequency with rigid bars and elastic drives", "Hz", LEAST_MARGIN, _DRIVES,
        bounded=True, cost=DRIVES_COST, missing=_not_held(_DRIVES),
    ),
)  # fmt: skip
