"""Two designs on one trajectory: by how much an actuator's load changes."""

from __future__ import annotations

import math
from dataclasses import dataclass

from paminsa_viz.model.errors import InvalidInput
from paminsa_viz.trajectory.analysis import TrajectoryAnalysis


@dataclass(frozen=True)
class ActuatorChange:
    """Load of an actuator over that in the reference; infinite or NaN where the latter is zero.

    Attributes:
        peak: Ratio of the largest torques.
        rms: Ratio of the root mean squares.
        top_power: Ratio of the largest powers.
        driven: Ratio of the energies put in while driving.
    """

    peak: float
    rms: float
    top_power: float
    driven: float


def compare(
    chosen: TrajectoryAnalysis, reference: TrajectoryAnalysis
) -> tuple[ActuatorChange, ...]:
    """Return the change of each actuator's load; empty if either fails at its first sample.

    Raises:
        InvalidInput: If the two are not of the same trajectory.
    """
    if chosen.trajectory is not reference.trajectory:
        raise InvalidInput("reference", "it has to be an analysis of the same trajectory")
    names = ("peak", "rms", "top_power", "driven")
    return tuple(
        ActuatorChange(*(_ratio(getattr(a, name), getattr(b, name)) for name in names))
        for a, b in zip(chosen.summary, reference.summary, strict=False)
    )


def _ratio(value: float, base: float) -> float:
    if base == 0:
        return math.nan if value == 0 else math.inf
    return abs(value / base)
