"""A planned motion: a curve in unit time and its duration."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.model.arrays import Array, as_numbers
from paminsa_viz.model.errors import InvalidInput
from paminsa_viz.trajectory.curves import UnitCurve
from paminsa_viz.trajectory.sampled import RATE, States, Trajectory, sample_times


@dataclass(frozen=True, eq=False)
class Plan:
    """A motion of the platform that starts and ends at rest, known at every instant.

    Attributes:
        curve: The motion in unit time.
        duration: Its duration [s].
        name: What a person calls it.
        kind: How it was made.
        notes: What a person should know about it, a sentence each.

    Raises:
        InvalidInput: If the duration is not a positive, finite number.
    """

    curve: UnitCurve
    duration: float
    name: str = "trajectory"
    kind: str = ""
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if not (np.isfinite(self.duration) and self.duration > 0):
            raise InvalidInput(
                "duration", f"a finite time above 0 s is needed, not {self.duration!r}"
            )

    def lasting(self, duration: float) -> Plan:
        """Return the same motion with another duration [s]."""
        return replace(self, duration=float(duration))

    def at(self, t: ArrayLike) -> States:
        """Return the state at times (...) from 0 to the duration [s]; outside it is at rest."""
        t = as_numbers(t, "t")
        u = t / self.duration
        outside = ((u < 0.0) | (u > 1.0))[..., None]
        u = np.clip(u, 0.0, 1.0)
        rates = (self.curve(u, order) / self.duration**order for order in (1, 2))
        return States(self.curve(u), *(np.where(outside, 0.0, rate) for rate in rates))

    def jerk(self, t: ArrayLike) -> Array:
        """Return the third derivative at times (...), (..., 4) [m/s^3, m/s^3, rad/s^3, m/s^3]."""
        return self.curve(as_numbers(t, "t") / self.duration, 3) / self.duration**3

    def sample(self, rate: float = RATE) -> Trajectory:
        """Return samples in equal steps, both ends among them.

        Args:
            rate: Samples a second; the step is made to fit the duration [1/s].

        Raises:
            InvalidInput: If the rate is not positive or the list would be longer than
                `MOST_SAMPLES`.
        """
        t = sample_times(0.0, self.duration, rate)
        return Trajectory(t, *self.at(t), self.name, self.kind, self.notes)
