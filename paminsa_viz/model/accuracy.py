"""What is not exact: deviations of each leg's lengths, tolerances, and the drives.

Deviations are what manufacture leaves and calibration finds. A leg has 14 lengths of its own. The
geometry gives their nominal values, the same for all legs, and the magnification factor k does no
more than that: with deviations 8-9-4-7 is no parallelogram any longer. The length of B1 has no
effect. `LegDeviations` is the one list of these lengths; errors, tolerances, calibration and design
files take names, symbols and units from it.
"""

from __future__ import annotations

import math
from dataclasses import astuple, dataclass, fields, replace

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
        DEFAULT_RESOLUTION, "r_M", "rad", "one count of the encoders of M1 to M3"
    )
    resolution_linear: float = parameter(1e-5, "r_4", "m", "one count of the encoder of M4")
    backlash_rotary: float = parameter(0.0, "s_M", "rad", "backlash of M1 to M3, full width")
    backlash_linear: float = parameter(0.0, "s_4", "m", "backlash of M4, full width")
    control_rotary: float = parameter(0.0, "e_M", "rad", "controller error of M1 to M3, ±")
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


@dataclass(frozen=True)
class Tolerances(Group, path="tolerances"):
    """Tolerances of the lengths, to either side, and clearances; not in the paper.

    The defaults of lengths are those of ISO 2768-1, class f, at the prototype's sizes; of angles,
    the same at their radius, as holes have that are placed by coordinates. A clearance is the
    difference of the diameters; the default is a middling H7/g6 fit of some 10 mm. All three legs
    have the same tolerances.
    """

    bar: float = parameter(2e-4, "t_b", "m", "bars of the pantograph, joint to joint, ±")
    shaft: float = parameter(3e-4, "t_B2", "m", "shaft B2, ±")
    joint_height: float = parameter(1e-4, "t_B5", "m", "joint 5 above the platform, ±")
    guide_height: float = parameter(2e-4, "t_h", "m", "guide above the base plane, ±")
    axis_radius: float = parameter(2e-4, "t_Rb", "m", "leg axis from the base center, ±")
    axis_angle: float = parameter(6e-4, "t_ab", "rad", "direction of the leg axis, ±")
    joint_radius: float = parameter(1.5e-4, "t_Rpl", "m", "joint 5 from the center, ±")
    joint_angle: float = parameter(1.5e-3, "t_apl", "rad", "direction of joint 5, ±")
    actuator_zero: float = parameter(4e-4, "t_M", "rad", "zero of M1 to M3, ±")
    pin_clearance: float = parameter(2e-5, "c_p", "m", "clearance of the pins")
    guide_clearance: float = parameter(2e-5, "c_g", "m", "clearance of the guide")


NO_TOLERANCES = Tolerances(*(0.0,) * 11)
"""Exact lengths without clearance."""


def _length(symbol: str, unit: str, label: str) -> float:
    return parameter(0.0, symbol, unit, label, signed=True)


@dataclass(frozen=True)
class LegDeviations(Group, path="deviations"):
    """Deviations of one leg's lengths, actual minus nominal.

    Bars are measured between the axes of their joints. B4 is 9-4-5 and B3 is 4-3-7, each in a line.
    Angles are about the vertical: those of the leg axis and of joint 5 as seen from the center of
    base and platform. The heading of the leg's plane is that of the paper plus theta_k plus the
    zero of M_k, in base axes: a leg axis that is out of place does not turn it.
    """

    bar_94: float = _length("l_94", "m", "bar B4, 9 to 4")
    bar_45: float = _length("l_45", "m", "bar B4, 4 to 5")
    bar_43: float = _length("l_43", "m", "bar B3, 4 to 3")
    bar_37: float = _length("l_37", "m", "bar B3, 3 to 7")
    bar_87: float = _length("l_87", "m", "bar B7, 8 to 7")
    bar_89: float = _length("l_89", "m", "bar B8, 8 to 9")
    shaft: float = _length("l_B2", "m", "shaft B2, 3 to 2")
    joint_height: float = _length("l_B5", "m", "joint 5 above the platform")
    guide_height: float = _length("h_8", "m", "guide above the base plane")
    axis_radius: float = _length("R_b", "m", "leg axis from the base center")
    axis_angle: float = _length("a_b", "rad", "direction of the leg axis")
    joint_radius: float = _length("R_pl", "m", "joint 5 from the center")
    joint_angle: float = _length("a_pl", "rad", "direction of joint 5")
    actuator_zero: float = _length("z_M", "rad", "zero of actuator M_k")

    @property
    def zero(self) -> bool:
        """Whether the leg has its nominal lengths."""
        return not any(astuple(self))


@dataclass(frozen=True)
class Leg1Deviations(LegDeviations, path="leg1"):
    """Deviations of leg 1 from the lengths above, actual minus nominal."""


@dataclass(frozen=True)
class Leg2Deviations(LegDeviations, path="leg2"):
    """Deviations of leg 2 from the lengths above, actual minus nominal."""


@dataclass(frozen=True)
class Leg3Deviations(LegDeviations, path="leg3"):
    """Deviations of leg 3 from the lengths above, actual minus nominal."""


Deviations = tuple[LegDeviations, LegDeviations, LegDeviations]
"""Deviations of all legs."""

NO_DEVIATIONS: Deviations = (Leg1Deviations(), Leg2Deviations(), Leg3Deviations())
"""Deviations of a robot as it was drawn."""


def equal_legs_note(deviations: Deviations) -> str:
    """Return what a file says that takes all legs as equal; "" of a design whose legs are."""
    if deviations == NO_DEVIATIONS:
        return ""
    return "legs are equal, the design's deviations of single legs are left out"


def noting_equal_legs(about: str, deviations: Deviations) -> str:
    """Return what is said about a file, with `equal_legs_note` after it where there is one."""
    note = equal_legs_note(deviations)
    return f"{about}; {note}" if note else about


LEG_NAMES = ("leg1", "leg2", "leg3")
"""Names of the legs in paths and files, `Design.leg1` and so on."""

LENGTH_NAMES = tuple(item.name for item in fields(LegDeviations))
"""Names of a leg's 14 lengths, in the order of arrays (..., 3, 14)."""
