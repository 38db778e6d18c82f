"""Deviations of each leg's lengths from the geometry: what manufacture leaves, calibration finds.

A leg has 14 lengths of its own. The geometry gives their nominal values, the same for all legs, and
the magnification factor k does no more than that: with deviations 8-9-4-7 is no parallelogram any
longer. The length of B1 has no effect. `LegDeviations` is the one list of these lengths; errors,
tolerances, calibration and design files take names, symbols and units from it.
"""

from __future__ import annotations

from dataclasses import astuple, dataclass, fields

from paminsa_viz.model.parameters import Group, parameter


def _deviation(symbol: str, unit: str, label: str) -> float:
    return parameter(0.0, symbol, unit, label, signed=True)


@dataclass(frozen=True)
class LegDeviations(Group, path="deviations"):
    """Deviations of one leg's lengths, actual minus nominal.

    Bars are measured between the axes of their joints. B4 is 9-4-5 and B3 is 4-3-7, each in a line.
    Angles are about the vertical: those of the leg axis and of joint 5 as seen from the center of
    base and platform. The heading of the leg's plane is that of the paper plus theta_k plus the
    zero of M_k, in base axes: a leg axis that is out of place does not turn it.
    """

    bar_94: float = _deviation("l_94", "m", "bar B4, 9 to 4")
    bar_45: float = _deviation("l_45", "m", "bar B4, 4 to 5")
    bar_43: float = _deviation("l_43", "m", "bar B3, 4 to 3")
    bar_37: float = _deviation("l_37", "m", "bar B3, 3 to 7")
    bar_87: float = _deviation("l_87", "m", "bar B7, 8 to 7")
    bar_89: float = _deviation("l_89", "m", "bar B8, 8 to 9")
    shaft: float = _deviation("l_B2", "m", "shaft B2, 3 to 2")
    joint_height: float = _deviation("l_B5", "m", "joint 5 above the platform")
    guide_height: float = _deviation("h_8", "m", "guide above the base plane")
    axis_radius: float = _deviation("R_b", "m", "leg axis from the base center")
    axis_angle: float = _deviation("a_b", "rad", "direction of the leg axis")
    joint_radius: float = _deviation("R_pl", "m", "joint 5 from the platform center")
    joint_angle: float = _deviation("a_pl", "rad", "direction of joint 5")
    actuator_zero: float = _deviation("z_M", "rad", "zero of actuator M_k")

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


Deviations = tuple[Leg1Deviations, Leg2Deviations, Leg3Deviations]
"""Deviations of all legs."""

NO_DEVIATIONS: Deviations = (Leg1Deviations(), Leg2Deviations(), Leg3Deviations())
"""Deviations of a robot as it was drawn."""

LEG_NAMES = ("leg1", "leg2", "leg3")
"""Names of the legs in paths and files, `Design.leg1` and so on."""

LENGTH_NAMES = tuple(item.name for item in fields(LegDeviations))
"""Names of a leg's 14 lengths, in the order of arrays (..., 3, 14)."""
