"""Loads and drives of tests."""

from __future__ import annotations

import numpy as np

from paminsa_viz.actuation.duty import ActuatorLoad
from paminsa_viz.model import Drive
from paminsa_viz.model.arrays import Array

SERVO = Drive(
    "servo", 4e-6, rated_torque=0.3, peak_torque=0.9, rated_speed=300.0, top_speed=600.0, mass=0.5
)
GEAR = Drive("gear", gear_inertia=1e-6, gear_ratio=80.0, efficiency=0.8, mass=0.4)


def motor_torque(load: ActuatorLoad, drive: Drive, ratios: Array) -> Array:
    """The definition, sample by sample: (ratios, samples) [N m]."""
    torque, speed, growth = load.torque, load.signals[4], load.signals[3]
    power, eta = torque * speed, drive.total_efficiency
    driven = np.where(power > 0, torque / eta, np.where(power < 0, torque * eta, torque))
    n = ratios[:, None]
    own = n * (drive.inertia * growth + drive.viscous * speed)
    return driven / n + own + drive.coulomb * np.sign(speed)
