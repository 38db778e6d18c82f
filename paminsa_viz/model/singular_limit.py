"""Which poses are too close to a singularity for their torques to count: one definition for all.

Toward a singularity torques grow without bound, so the largest torque over a workspace would be
that of whichever pose happens to come nearest, and no machine works there. A pose is too close
where the condition number of the Jacobian is above a limit that can be set (type 2, and joint 5 on
its leg axis), or where a pantograph is stretched, folded or over its axis but for
`SERIAL_CLEARANCE` (type 1). Status, statistics of maps, sweeps, balance and reports use this.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from paminsa_viz.model.grids import Field
from paminsa_viz.model.reach import LEAST_MARGIN, MARGINS, Limit, Reach

CONDITION_LIMIT: Final = 10.0
"""Largest condition number of a pose that counts, unless another is set: a local conditioning index
of 0.1."""

SERIAL_CLEARANCE: Final = 0.01
"""Least distance to a stretched or folded pantograph, and to the leg axis, of a pose that counts
[m]."""

_GUIDE: Final = MARGINS.index(Limit.GUIDE)


def near_singularity(
    condition: ArrayLike, margin: ArrayLike, which: ArrayLike, limit: float = CONDITION_LIMIT
) -> NDArray[np.bool_]:
    """Return which poses are too close to a singularity, True where a number is missing.

    Args:
        condition: (...) condition numbers as in `Singularity`.
        margin: (...) least margins to a limit of reach [m].
        which: (...) which margin that is, see `measures.least_margin`; the end of a guide is no
            singularity.
        limit: Largest condition number that counts.
    """
    clear = (np.asarray(margin) >= SERIAL_CLEARANCE) | (np.asarray(which) % len(MARGINS) == _GUIDE)
    with np.errstate(invalid="ignore"):
        return ~((np.asarray(condition) <= limit) & clear)


def near_by_reach(
    condition: ArrayLike, reach: Reach, limit: float = CONDITION_LIMIT
) -> NDArray[np.bool_]:
    """Return the same for poses with their condition numbers and their reach, (...)."""
    margins = reach.margins.reshape(*reach.margins.shape[:-2], -1)
    return near_singularity(condition, margins.min(axis=-1), margins.argmin(axis=-1), limit)


def counting(field: Field, limit: float = CONDITION_LIMIT) -> NDArray[np.bool_]:
    """Return which poses of a field can be taken and are not too close to a singularity, (...)."""
    margin, which = field.solve(LEAST_MARGIN)
    near = near_singularity(field.condition, margin, which, limit)
    return (field.status == Limit.OK) & ~near
