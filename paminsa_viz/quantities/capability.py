"""Quantities of what the actuators' limits let the platform hold, and how fast it can go."""

from __future__ import annotations

from paminsa_viz.actuation.wrench_capability import SPEED_ROWS, field_capability
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.backend import Formula
from paminsa_viz.model.design import Design
from paminsa_viz.model.grids import WRENCH_TORQUES, Field
from paminsa_viz.model.statics import UNIT_TORQUES
from paminsa_viz.quantities.quantity import Quantity, in_family


def _capability(
    key: str, symbol: str, label: str, title: str, unit: str, formula: Formula,
    *, bounded: bool = False, cost: float = 1e-6,
) -> Quantity:  # fmt: skip
    """Return the value of `Capability` of the same name as a quantity."""

    def value(field: Field, design: Design) -> Array:
        return getattr(field_capability(field, design), key)

    return Quantity(key, symbol, label, title, unit, formula, value, bounded=bounded, cost=cost)


CAPABILITY = in_family(
    "capability",
    _capability("payload", "m max", "payload capacity",
                "Largest payload held at rest within the actuators’ limits", "kg", UNIT_TORQUES),
    _capability("horizontal_force", "F_h", "guaranteed horizontal force",
                "Horizontal force held in every direction with no moment", "N", WRENCH_TORQUES,
                bounded=True),
    _capability("vertical_force", "F_v", "guaranteed vertical force",
                "Largest vertical force held both upward and downward", "N", UNIT_TORQUES),
    _capability("moment", "M_z", "guaranteed moment",
                "Largest vertical moment held in both directions with no force", "N m",
                WRENCH_TORQUES, bounded=True),
    _capability("speed", "v", "guaranteed speed",
                "Speed within the actuators’ limits in every direction of space", "m/s",
                SPEED_ROWS),
    _capability("turn_speed", "ω", "angular speed",
                "Largest angular speed about the platform’s center", "rad/s", SPEED_ROWS),
    _capability("acceleration", "a", "guaranteed acceleration",
                "Acceleration from rest within the peak torques in every direction of space",
                "m/s^2", WRENCH_TORQUES, bounded=True, cost=5e-6),
    _capability("turn_acceleration", "α", "angular acceleration",
                "Largest angular acceleration from rest within the peak torques", "rad/s^2",
                WRENCH_TORQUES, bounded=True, cost=5e-6),
)  # fmt: skip
