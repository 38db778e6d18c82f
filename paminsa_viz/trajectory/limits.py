"""Limits that a motion shall keep."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from paminsa_viz.checks import require_positive
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.drive import ACTUATORS, TORQUE_UNITS


@dataclass(frozen=True)
class MotionLimits:
    """Largest values that a motion may take; None where there is no limit.

    Speeds, accelerations and jerks of the platform's position are lengths of their vectors.

    Attributes:
        speed: [m/s].
        turn_speed: [rad/s].
        acceleration: [m/s^2].
        turn_acceleration: [rad/s^2].
        jerk: [m/s^3].
        turn_jerk: [rad/s^3].
        torque: Of M1, M2, M3 each, to both sides [N m].
        force: Of M4, to both sides [N].

    Raises:
        InvalidInput: If a limit is not a positive number.
    """

    speed: float | None = None
    turn_speed: float | None = None
    acceleration: float | None = None
    turn_acceleration: float | None = None
    jerk: float | None = None
    turn_jerk: float | None = None
    torque: float | None = None
    force: float | None = None

    def __post_init__(self) -> None:
        for item in fields(self):
            value = getattr(self, item.name)
            if value is not None:
                require_positive(value, item.name, "a finite limit above 0")

    @property
    def rates(self) -> Array:
        """Limits of position and turn, (3 orders, 2); infinite where there is none."""
        return self._values()[:6].reshape(3, 2)

    @property
    def actuators(self) -> Array:
        """Limits of the actuators, (4,) [N m, N]; infinite where there is none."""
        return self._values()[[6, 6, 6, 7]]

    @property
    def needs_torques(self) -> bool:
        """Whether a limit of an actuator is among them."""
        return self.torque is not None or self.force is not None

    def _values(self) -> Array:
        return np.array([np.inf if value is None else value for value in vars(self).values()])


MOTOR_SPEEDS = tuple(f"motor speed of {name}" for name in ACTUATORS)

LIMITED = (
    "speed", "turning speed", "acceleration", "turning acceleration", "jerk", "turning jerk",
    "torque of M1", "torque of M2", "torque of M3", "force of M4",
    *(f"torque-speed envelope of {name}" for name in ACTUATORS),
    *MOTOR_SPEEDS,
    *(f"load of the gear of {name}" for name in ACTUATORS),
)  # fmt: skip
"""What can be limited, in the order in which `timing` looks at it."""

UNITS = (
    "m/s", "rad/s", "m/s^2", "rad/s^2", "m/s^3", "rad/s^3", *TORQUE_UNITS,
    *("",) * 4, *("rad/s",) * 4, *TORQUE_UNITS,
)  # fmt: skip
"""Units of that."""
