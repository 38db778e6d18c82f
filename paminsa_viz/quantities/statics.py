"""Quantities of what the actuators hold at rest."""

from __future__ import annotations

import numpy as np

from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.grids import Field
from paminsa_viz.model.statics import UNIT_TORQUES, static_imbalance
from paminsa_viz.palette import LEG_COLORS, LIFT_COLOR
from paminsa_viz.quantities.quantity import Quantity, in_family


def _static(field: Field, design: Design, actuator: int) -> Array:
    """Return the static torque of M1, M2 or M3 over a field (...) [N m]."""
    torque = static_imbalance(design) * field.gamma[actuator]
    return torque + field.load_torques(design)[actuator] if design.load.acts else torque


def _rotary(field: Field, design: Design) -> Array:
    """Return the static torques of M1..M3 over a field, (3, ...) [N m]."""
    return field.torques(design)[:3]


def _rms(field: Field, design: Design) -> Array:
    """Return the root mean square of the static torques of M1..M3 over a field (...) [N m]."""
    if not design.load.acts:  # M_p2 is a factor of all three
        return abs(static_imbalance(design)) * np.sqrt((field.gamma[:3] ** 2).mean(axis=0))
    return np.sqrt((_rotary(field, design) ** 2).mean(axis=0))


def _torque(actuator: int) -> Quantity:
    below = "₁₂₃"[actuator]
    return Quantity(
        f"tau_{actuator + 1}", f"τ{below}", f"τ{below} of M{actuator + 1}",
        f"Static torque of M{actuator + 1}", "N m", UNIT_TORQUES,
        lambda field, design: _static(field, design, actuator),
        signed=True, color=LEG_COLORS[actuator],
    )  # fmt: skip


STATICS = in_family(
    "static torques",
    *(_torque(actuator) for actuator in range(3)),
    Quantity(
        "f_4", "F₄", "F₄ of M4", "Static force of M4", "N", UNIT_TORQUES,
        lambda field, design: field.torques(design)[3],
        color=LIFT_COLOR,
    ),
    Quantity(
        "max_torque", "max |τ|", "max |τ| of M1 to M3", "Largest static torque of M1 to M3",
        "N m", UNIT_TORQUES,
        lambda field, design: np.abs(_rotary(field, design)).max(axis=0),
    ),
    Quantity(
        "rms_torque", "RMS τ", "RMS τ of M1 to M3", "RMS of the static torques of M1 to M3",
        "N m", UNIT_TORQUES,
        _rms,
    ),
)  # fmt: skip
