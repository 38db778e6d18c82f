"""Accuracy of the drives: by how much an actuator may be off the position that was asked for."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from paminsa_viz.model.drive import Drives
from paminsa_viz.model.parameters import Group, parameter

DEFAULT_RESOLUTION = round(math.radians(0.01), 12)
"""A count of 0.01 degrees [rad], to as many digits as an input of the page has."""


@dataclass(frozen=True)
class DriveAccuracy(Group, path="accuracy", limits=(1e-12, 1.0)):
    """Accuracy of the drives, at the actuators.

    Three parts add: half a count of the encoder, half the backlash, and the controller's error e to
    either side. All are those of the actuator's own motion, behind gear and screw; the three rotary
    actuators have the same. The defaults of the resolutions are no product's.
    """

    resolution_rotary: float = parameter(
        DEFAULT_RESOLUTION, "r_M", "rad", "one count of the encoders of M1..M3"
    )
    resolution_linear: float = parameter(1e-5, "r_4", "m", "one count of the encoder of M4")
    backlash_rotary: float = parameter(0.0, "s_M", "rad", "backlash of M1..M3, full width")
    backlash_linear: float = parameter(0.0, "s_4", "m", "backlash of M4, full width")
    control_rotary: float = parameter(0.0, "e_M", "rad", "controller error of M1..M3, ±")
    control_linear: float = parameter(0.0, "e_4", "m", "controller error of M4, ±")

    @property
    def half_widths(self) -> tuple[float, float, float, float]:
        """Largest error of M1..M4, to either side: r/2 + s/2 + e, (4,) [rad, rad, rad, m]."""
        rotary = (self.resolution_rotary + self.backlash_rotary) / 2 + self.control_rotary
        linear = (self.resolution_linear + self.backlash_linear) / 2 + self.control_linear
        return rotary, rotary, rotary, linear

    @property
    def deviations(self) -> tuple[float, float, float, float]:
        """Standard deviations of the errors of M1..M4, (4,) [rad, rad, rad, m].

        The parts are independent, each of uniform distribution: one of width w has the variance
        w^2/12, and the controller's has the width 2 e.
        """
        rotary = _deviation(self.resolution_rotary, self.backlash_rotary, 2 * self.control_rotary)
        linear = _deviation(self.resolution_linear, self.backlash_linear, 2 * self.control_linear)
        return rotary, rotary, rotary, linear

    def with_encoders(self, drives: Drives) -> DriveAccuracy:
        """Return the accuracy with the resolution of the drives' encoders, where they have one.

        M1..M3 take the coarsest of their three. See `Drive.resolution`.
        """
        found = [None if drive is None else drive.resolution for drive in drives]
        rotary = [value for value in found[:3] if value is not None]
        changes = {"resolution_rotary": max(rotary)} if rotary else {}
        changes |= {"resolution_linear": found[3]} if found[3] is not None else {}
        return replace(self, **changes)


def _deviation(*widths: float) -> float:
    return math.sqrt(sum(width**2 for width in widths) / 12)
