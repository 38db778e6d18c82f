"""The same torques from two sources, and by how much they differ."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.drive import TORQUE_UNITS
from paminsa_viz.model.statics import static_breakdown

LEAST_SCALE = 1e-6
"""What differences are measured by where no body has weight and nothing moves [N m, N]."""

SYMBOLS = ("tau_1", "tau_2", "tau_3", "F_4")


@dataclass(frozen=True, eq=False)
class Comparison:
    """Actuator torques of the formulas and of an engine, at the same n states.

    Attributes:
        computed: (n, 4) those of the formulas [N m, N].
        reference: (n, 4) those of the engine.
        scale: (4,) what differences of each actuator are measured by, see `torque_scale`.
    """

    computed: Array
    reference: Array
    scale: Array

    @cached_property
    def difference(self) -> Array:
        """Computed minus reference, (n, 4) [N m, N]."""
        return self.computed - self.reference

    @cached_property
    def largest(self) -> Array:
        """Largest difference of each actuator, (4,) [N m, N]; NaN if a torque is missing."""
        return np.abs(self.difference).max(axis=0)

    @cached_property
    def rms(self) -> Array:
        """Root mean square of the difference, (4,) [N m, N]."""
        return np.sqrt((self.difference**2).mean(axis=0))

    @property
    def relative(self) -> Array:
        """Largest difference over the scale, (4,)."""
        return self.largest / self.scale

    @property
    def relative_rms(self) -> Array:
        """Root mean square of the difference over the scale, (4,)."""
        return self.rms / self.scale

    def agrees(self, tolerance: float) -> bool:
        """Whether no difference of any actuator exceeds ``tolerance`` times its scale."""
        return bool((self.relative <= tolerance).all())

    def summary(self) -> list[dict[str, Any]]:
        """Return the figures of each actuator, ready for JSON."""
        rows = zip(
            SYMBOLS, TORQUE_UNITS, self.scale.tolist(), self.largest.tolist(), self.rms.tolist(),
            self.relative.tolist(), self.relative_rms.tolist(), strict=True,
        )  # fmt: skip
        names = (
            "actuator", "unit", "largest_torque", "max_difference", "rms_difference",
            "max_relative", "rms_relative",
        )  # fmt: skip
        return [dict(zip(names, row, strict=True)) for row in rows]


def torque_scale(design: Design, poses: Array, torques: Array) -> Array:
    """Return what differences of each actuator's torque are measured by, (4,) [N m, N].

    It is the largest torque. Where the bodies balance each other, so that nothing but rounding is
    left of it, it is the largest torque of a single body's weight.

    Args:
        design: The robot.
        poses: (n, 4) where the torques belong to [m, m, rad, m].
        torques: (n, 4) [N m, N].
    """
    shares = np.abs(static_breakdown(design, poses).per_leg)
    # Where a reference misses a torque, the comparison fails by its difference, not by its scale.
    whole = np.nan_to_num(np.abs(torques)).max(axis=0)
    single = np.nan_to_num(shares).max(axis=(0, 2, 3))
    return np.maximum(np.maximum(whole, single), LEAST_SCALE)
