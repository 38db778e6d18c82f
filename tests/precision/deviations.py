"""Robots with unequal legs."""

from __future__ import annotations

from typing import Any

import numpy as np

from paminsa_viz.precision.leg_lengths import (
    LENGTHS,
    nominal_lengths,
)
from paminsa_viz.precision.unequal_legs import (
    Closure,
    UnequalPose,
    nominal_pose,
    sensitivities,
)


def random_deviations(seed: int, size: float, *batch: int) -> Any:
    return np.random.default_rng(seed).uniform(-size, size, (*batch, 3, len(LENGTHS)))


def nominal_slopes(geometry: Any, poses: Any) -> Any:
    return sensitivities(geometry, nominal_lengths(geometry), nominal_pose(geometry, poses))


def reasons(found: UnequalPose) -> list[Closure]:
    return [Closure(int(value)) for value in np.ravel(found.status)]
