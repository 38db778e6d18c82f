"""Which poses are too close to a singularity for their torques to count: one definition for all.

Toward a singularity torques grow without bound, so the largest torque over a workspace would be
that of whichever pose happens to come nearest, and no machine works there. A pose is too close
where the condition number of the Jacobian is above a limit that can be set (type 2, and joint 5 on
its leg axis), or where a pantograph is within `serial_clearance` of being stretched or folded, or
joint 5 of its leg axis (type 1). Status, statistics of maps, sweeps, balance and reports use this.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from paminsa_viz.checks import require_at_least
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.backend import Formula
from paminsa_viz.model.geometry import Geometry
from paminsa_viz.model.grids import Field
from paminsa_viz.model.measures import serial_margin
from paminsa_viz.model.reach import MARGINS, Limit, Reach
from paminsa_viz.model.resizing import length_ratio

CONDITION_LIMIT: Final = 10.0
"""Largest condition number of a pose that counts, unless another is set: a local conditioning index
of 0.1."""

SERIAL_CLEARANCE: Final = 0.01
"""Least distance to a stretched or folded pantograph, and to the leg axis, of a pose that counts
[m]; at Appendix 4's lengths, see `serial_clearance` for others."""

SERIAL_MARGIN: Final = Formula(serial_margin, 1)

_SERIAL: Final = [index for index, limit in enumerate(MARGINS) if limit is not Limit.GUIDE]


def serial_clearance(geometry: Geometry) -> float:
    """Return `SERIAL_CLEARANCE` in proportion to crank plus coupler [m].

    So the same poses count of two robots of one shape, whatever their size.
    """
    return SERIAL_CLEARANCE * length_ratio(geometry)


def require_condition(limit: float) -> None:
    """Raise `InvalidInput` unless this can be the largest condition number that counts."""
    require_at_least(
        limit, "max_condition", 1.0, "a number of at least 1, the least there is", finite=False
    )


def near_singularity(
    geometry: Geometry, condition: ArrayLike, margin: ArrayLike, limit: float = CONDITION_LIMIT
) -> NDArray[np.bool_]:
    """Return which poses are too close to a singularity, True where a number is missing.

    Args:
        geometry: Lengths of the mechanism.
        condition: (...) condition numbers as in `Singularity`.
        margin: (...) least margins to a limit of reach that is a singularity [m], see
            `measures.serial_margin`; the end of a guide is none.
        limit: Largest condition number that counts.
    """
    with np.errstate(invalid="ignore"):
        clear = np.asarray(margin) >= serial_clearance(geometry)
        return ~((np.asarray(condition) <= limit) & clear)


def serial_margins(reach: Reach) -> Array:
    """Return the least margins to a limit of reach that is a singularity (...) [m]."""
    return reach.margins[..., _SERIAL].min(axis=(-1, -2))


def near_by_reach(
    geometry: Geometry, condition: ArrayLike, reach: Reach, limit: float = CONDITION_LIMIT
) -> NDArray[np.bool_]:
    """Return the same for poses with their condition numbers and their reach, (...)."""
    return near_singularity(geometry, condition, serial_margins(reach), limit)


def counting(field: Field, limit: float = CONDITION_LIMIT) -> NDArray[np.bool_]:
    """Return which poses of a field can be taken and are not too close to a singularity, (...)."""
    margin = field.solve(SERIAL_MARGIN)[0]
    near = near_singularity(field.geometry, field.condition, margin, limit)
    return (field.status == Limit.OK) & ~near
