"""What a change of masses does: to M_p2, to the robot's mass, to what actuators have to give."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.balancing.changes import whole_mass
from paminsa_viz.model.design import Design
from paminsa_viz.model.drive import ACTUATORS, TORQUE_UNITS
from paminsa_viz.model.statics import static_imbalance

if TYPE_CHECKING:
    from paminsa_viz.model.arrays import Array
    from paminsa_viz.trajectory import TrajectoryAnalysis

AT_REST = "largest at rest"
IN_MOTION = ("largest in motion", "RMS in motion", "largest power")
UNITS = {AT_REST: TORQUE_UNITS, **dict.fromkeys(IN_MOTION[:2], TORQUE_UNITS), IN_MOTION[2]: "WWWW"}
"""What is compared of each actuator, and the units of M1 to M4."""


@dataclass(frozen=True)
class Effect:
    """A size before and after; NaN where it has no value.

    Attributes:
        label: What it is, or whose.
        unit: SI unit.
        before, after: The size.
        group: Which of `UNITS` it is of an actuator; empty for others.
    """

    label: str
    unit: str
    before: float
    after: float
    group: str = ""


def effects(
    before: Design, after: Design, sizes: Mapping[str, tuple[ArrayLike, ArrayLike]]
) -> tuple[Effect, ...]:
    """Return what the step from one design to another does.

    Args:
        before, after: The designs.
        sizes: Of M1 to M4, (4,) before and after, by which of `UNITS` they are.
    """
    found = [
        Effect("M_p2", "N", static_imbalance(before), static_imbalance(after)),
        Effect("mass with payload", "kg", whole_mass(before), whole_mass(after)),
    ]
    for group, (old, new) in sizes.items():
        each = zip(ACTUATORS, UNITS[group], np.asarray(old), np.asarray(new), strict=True)
        found += [Effect(name, unit, float(a), float(b), group) for name, unit, a, b in each]
    return tuple(found)


def sizes_in_motion(analysis: TrajectoryAnalysis) -> Array:
    """Return `IN_MOTION` of M1 to M4, (3, 4); NaN for a motion that cannot begin."""
    if not analysis.summary:
        return np.full((3, 4), np.nan)
    return np.abs([[load.peak, load.rms, load.top_power] for load in analysis.summary]).T
