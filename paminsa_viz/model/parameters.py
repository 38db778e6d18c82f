"""The numbers of a design: declaration, ranges, and all groups but the lengths.

A number knows its symbol in the paper, its SI unit, a plain name and its range, so that a page, a
file or a table can be built from the field list alone. The ranges hold at every door, because the
groups themselves refuse what is outside: no formula then overflows or loses all its digits.
"""

from __future__ import annotations

import math
from dataclasses import Field, dataclass, field, fields
from functools import cache
from typing import Any, ClassVar, NamedTuple

import numpy as np

from paminsa_viz.errors import InvalidDesign
from paminsa_viz.units import DisplayUnit, display_unit, format_ascii, unit_text

# ----------------------------------------------------------------- ranges of numbers by their units

LARGEST = {
    "": 100.0, "m": 100.0, "kg": 1e4, "kg m^2": 1e7, "m/s^2": 1e3, "N": 1e6, "N m": 1e7,
    "Pa": 1e18, "N/m": 1e18, "N m/rad": 1e18, "kg/m^3": 1e5, "m^2": 1.0, "m^4": 1.0,
}  # fmt: skip
"""Largest number of each unit; any other unit has `LARGEST_OTHER`."""

SMALLEST_OF = {"m^2": 1e-10, "m^4": 1e-18}
"""Smallest number of a unit where zero is refused, if it is not `SMALLEST`."""

LARGEST_OTHER = 1e4

SMALLEST = 1e-6
"""Smallest length, k - 1 or speed where zero is refused."""

SMALLEST_LOAD = 1e-30
"""Smallest mass, inertia and gravity that is not zero: all torques are products of them."""


def possible_range(unit: str, positive: bool) -> tuple[float, float]:
    """Return the smallest number that is not zero, and the largest [SI]."""
    least = SMALLEST_OF.get(unit, SMALLEST) if positive else 0.0
    loads = ("kg", "kg m^2", "m/s^2")
    return (SMALLEST_LOAD if unit in loads else least), LARGEST.get(unit, LARGEST_OTHER)


def range_text(least: float, most: float, unit: str, *, positive: bool, signed: bool) -> str:
    """Return what is needed of a number in a range, in words; ends and unit as they are read."""
    if signed:
        text = f"a finite number of at most {most:g} in size is needed"
    elif positive:
        text = f"a finite number above 0, from {least:g} to {most:g}, is needed"
    else:
        text = f"a finite number of at least 0 and at most {most:g} is needed"
    return f"{text} [{unit_text(unit)}]" if unit else text


def checked_number(
    value: Any,
    path: str,
    limits: tuple[float, float] | None,
    *,
    unit: str,
    positive: bool,
    signed: bool,
    **_: Any,
) -> float:
    """Return a number as a float.

    Raises:
        InvalidDesign: If it is none, or not in its range.
    """
    least, most = limits or possible_range(unit, positive)
    number = math.nan
    if isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(value, bool):
        try:
            number = float(value)
        except OverflowError:
            number = math.inf
    if signed:
        possible = abs(number) <= most
    else:
        possible = (number == 0 and not positive) or least <= number <= most
    if possible:
        return number
    allowed = range_text(least, most, unit, positive=positive, signed=signed)
    if 0 < number < least and not positive:
        allowed += f"; below {least:g} it has to be 0"
    raise InvalidDesign(path, value, allowed)


# ------------------------------------------------------------------------- numbers and their groups

MOST_COUNTERWEIGHTS = 12
"""Most counterweights of a leg: each is a body of the scene and a row of the page."""


def parameter(
    default: float | None,
    symbol: str,
    unit: str,
    label: str,
    *,
    positive: bool = False,
    signed: bool = False,
) -> Any:
    """Declare a design value with its paper symbol, SI unit and plain name.

    It may be zero unless it has to be ``positive``, and negative only if it is ``signed``.
    """
    return field(
        default=default,
        metadata={
            "symbol": symbol,
            "unit": unit,
            "label": label,
            "positive": positive,
            "signed": signed,
        },
    )


@dataclass(frozen=True)
class Parameter:
    """One number of a design.

    Attributes:
        path: Dotted path for `Design.value` and `Design.vary`.
        symbol: Symbol in the paper.
        unit: SI unit, empty for pure numbers.
        label: Plain name.
        default: Appendix 4's value.
        positive: Whether zero is refused.
        signed: Whether it may be negative.
        limits: Smallest number that is not zero, and the largest [SI], where those of its unit
            do not hold.
    """

    path: str
    symbol: str
    unit: str
    label: str
    default: float
    positive: bool
    signed: bool
    limits: tuple[float, float] | None

    @property
    def display(self) -> DisplayUnit:
        """The unit that people read the number in."""
        return display_unit(self.unit)

    @property
    def group(self) -> str:
        """First part of the path, or ``"design"`` for a number that is in no group."""
        return self.path.rpartition(".")[0] or "design"

    @property
    def largest(self) -> float:
        """Largest possible number [SI]."""
        return self._range[1]

    @property
    def _range(self) -> tuple[float, float]:
        return self.limits or possible_range(self.unit, self.positive)

    def refusal(self, value: float, unit: DisplayUnit) -> str | None:
        """Return what is possible, in the unit shown, if a number [SI] is not."""
        least, most = self._range
        if abs(value) <= most and (self.signed or value >= least * self.positive):
            return None
        ends = least * unit.factor, most * unit.factor
        return range_text(*ends, unit.text, positive=self.positive, signed=self.signed)


class Group:
    """Base of what holds numbers of a design: checks them when it is made.

    Raises:
        InvalidDesign: If a number is not finite or outside its range.
    """

    _path: ClassVar[str]
    _limits: ClassVar[tuple[float, float] | None]

    def __init_subclass__(
        cls, path: str | None = None, limits: tuple[float, float] | None = None
    ) -> None:
        """Name the group in error messages, and give it a range of its own for any number."""
        cls.__repr__ = Group.__repr__  # a dataclass keeps one that is there
        if path is not None:
            cls._path, cls._limits = path, limits

    def __repr__(self) -> str:
        """Return what makes it: of its values, those that are not the default."""
        values = ((item, getattr(self, item.name)) for item in fields(self))  # type: ignore[arg-type]
        chosen = (f"{item.name}={value!r}" for item, value in values if value != item.default)
        return f"{type(self).__name__}({', '.join(chosen)})"

    def __post_init__(self) -> None:
        # Whole numbers become floats, or each of them would have the formulas compiled again.
        for item, least, most in _numbers(type(self)):
            value = getattr(self, item.name)
            if type(value) is float and least <= value <= most:  # a search makes many thousands
                continue
            if not (value is None and item.default is None):
                path = f"{self._path}.{item.name}"
                number = checked_number(value, path, self._limits, **item.metadata)
                object.__setattr__(self, item.name, number)

    def in_force(self, name: str) -> float:
        """Return a number as it counts, also where it is left to follow from others."""
        return float(getattr(self, name))


@cache
def _numbers(group: type[Group]) -> tuple[tuple[Field[Any], float, float], ...]:
    """Return the numbers of a group, each with the ends of a range in which all are possible."""
    found = []
    for item in fields(group):  # type: ignore[arg-type]
        if "unit" in item.metadata:
            unit, positive = item.metadata["unit"], item.metadata["positive"]
            least, most = group._limits or possible_range(unit, positive)
            found.append((item, -most if item.metadata["signed"] else least, most))
    return tuple(found)


LEG_JOINTS = (2, 3, 4, 5, 7, 8, 9)
"""The paper's numbers of the joints of a leg, whose masses are ``j2`` to ``j9``."""

BAR_ENDS: dict[str, tuple[int, int]] = {"b3": (4, 7), "b4": (9, 5), "b7": (8, 7), "b8": (8, 9)}
"""Bars of the pantograph and the joints at their two ends."""

PANTOGRAPH = tuple(BAR_ENDS)
"""Bars of the pantograph, by the first part of their paths in a design."""


@dataclass(frozen=True)
class Counterweight(Group, path="counterweight"):
    """A point mass on one bar; every leg carries the same.

    Attributes:
        bar: ``"b3"``, ``"b4"``, ``"b7"`` or ``"b8"``.
        joint: The end of the bar, by the paper's number, that its place is measured from.
        beyond: Distance from that joint along the bar, away from its other end [m]. Negative
            values lie on the bar, between its two ends.
        mass: Mass [kg] on each leg.
    """

    bar: str
    joint: int
    beyond: float = parameter(0.0, "l_c", "m", "place, beyond the joint", signed=True)
    mass: float = parameter(0.0, "m_c", "kg", "counterweight")

    def __post_init__(self) -> None:
        ends = BAR_ENDS.get(self.bar) if isinstance(self.bar, str) else None
        if ends is None:
            allowed = f"a counterweight is on one of the bars {', '.join(BAR_ENDS)}"
            raise InvalidDesign("counterweight.bar", self.bar, allowed)
        if self.joint not in ends or isinstance(self.joint, bool):
            allowed = f"the ends of {self.bar.upper()} are joints {ends[0]} and {ends[1]}"
            raise InvalidDesign("counterweight.joint", self.joint, allowed)
        object.__setattr__(self, "joint", int(self.joint))
        super().__post_init__()

    @property
    def other(self) -> int:
        """The bar's other end."""
        first, second = BAR_ENDS[self.bar]
        return second if self.joint == first else first

    @property
    def place(self) -> str:
        """Where it is, in words, lengths in mm."""
        side = "beyond" if self.beyond >= 0 else "before"
        distance = format_ascii(abs(self.beyond), "m")
        return f"{self.bar.upper()}, {distance} {side} joint {self.joint}"


@dataclass(frozen=True)
class JointMasses(Group, path="joints"):
    """Masses of the joints of one leg, m_i (Appendix 4)."""

    j2: float = parameter(0.214, "m_2", "kg", "joint 2, shaft to arm")
    j3: float = parameter(0.338, "m_3", "kg", "joint 3, pantograph to shaft")
    j4: float = parameter(0.262, "m_4", "kg", "joint 4, B3 to B4")
    j5: float = parameter(0.233, "m_5", "kg", "joint 5, B4 to platform")
    j7: float = parameter(0.28, "m_7", "kg", "joint 7, B3 to B7")
    j8: float = parameter(0.305, "m_8", "kg", "joint 8, slider on the guide")
    j9: float = parameter(0.259, "m_9", "kg", "joint 9, B8 to B4 (knee)")


@dataclass(frozen=True)
class LinkMasses(Group, path="links"):
    """Masses of the links of one leg, m_Bi (Appendix 4)."""

    b1: float = parameter(1.221, "m_B1", "kg", "B1, horizontal arm")
    b2: float = parameter(0.921, "m_B2", "kg", "B2, vertical shaft")
    b3: float = parameter(0.406, "m_B3", "kg", "B3, bar 4-3-7")
    b4: float = parameter(0.672, "m_B4", "kg", "B4, bar 9-4-5")
    b7: float = parameter(0.107, "m_B7", "kg", "B7, bar 7-8")
    b8: float = parameter(0.403, "m_B8", "kg", "B8, bar 8-9")
    b10: float = parameter(0.436, "m_B10", "kg", "B10, guide link")


@dataclass(frozen=True)
class Inertias(Group, path="inertias"):
    """Moments of inertia of the links about their mass centers (Eq. 10, Appendix 4).

    ``axial`` is I_XX, along the tube; ``transverse`` is I_YY = I_ZZ, across it; ``vertical`` is
    about the leg axis, as the paper gives it for B2 and B10.
    """

    b3_axial: float = parameter(0.0038, "I_XX^(B3)", "kg m^2", "B3, along the bar")
    b3_transverse: float = parameter(0.02, "I_YY^(B3)", "kg m^2", "B3, across the bar")
    b4_axial: float = parameter(0.0012, "I_XX^(B4)", "kg m^2", "B4, along the bar")
    b4_transverse: float = parameter(0.048, "I_YY^(B4)", "kg m^2", "B4, across the bar")
    b7_axial: float = parameter(8e-4, "I_XX^(B7)", "kg m^2", "B7, along the bar")
    b7_transverse: float = parameter(0.003, "I_YY^(B7)", "kg m^2", "B7, across the bar")
    b8_axial: float = parameter(0.0024, "I_XX^(B8)", "kg m^2", "B8, along the bar")
    b8_transverse: float = parameter(0.02, "I_YY^(B8)", "kg m^2", "B8, across the bar")
    b2_vertical: float = parameter(0.003, "I_B2", "kg m^2", "B2, about the leg axis")
    b10_vertical: float = parameter(0.02, "I_B10", "kg m^2", "B10, about the vertical")


@dataclass(frozen=True)
class Platform(Group, path="platform"):
    """The moving platform (Appendix 4, m_p1 and I_pl)."""

    mass: float = parameter(2.301, "m_pl", "kg", "platform", positive=True)
    inertia: float = parameter(0.015, "I_pl", "kg m^2", "platform, about the vertical")


@dataclass(frozen=True)
class Payload(Group, path="payload"):
    """A body carried with its mass center on the platform's vertical axis (none in the paper).

    The center's height over P matters to joint forces and vibration only: the platform does not
    tilt, so that the actuators do not feel it.
    """

    mass: float = parameter(0.0, "m_load", "kg", "payload")
    inertia: float = parameter(0.0, "I_load", "kg m^2", "payload, about the vertical")
    height: float = parameter(0.0, "h_load", "m", "payload’s center above P", signed=True)


@dataclass(frozen=True)
class Friction(Group, path="friction"):
    """Friction at the actuators; zero by default, as in the paper.

    The friction torque at a speed w is ``viscous * w + coulomb * tanh(w / transition_speed)``, the
    same for M1..M3 (rotary), with its own two coefficients for M4 (linear). The smooth step keeps
    simulations integrable and gives no torque at rest.
    """

    viscous_rotary: float = parameter(0.0, "b_M", "N m s/rad", "viscous friction of M1 to M3")
    coulomb_rotary: float = parameter(0.0, "c_M", "N m", "Coulomb friction of M1 to M3")
    viscous_linear: float = parameter(0.0, "b_4", "N s/m", "viscous friction of M4")
    coulomb_linear: float = parameter(0.0, "c_4", "N", "Coulomb friction of M4")
    transition_speed: float = parameter(
        1e-3, "w_s", "rad/s, m/s", "speed scale of the Coulomb step", positive=True
    )

    @property
    def by_actuator(self) -> ActuatorFriction:
        """The coefficients of M1..M4."""
        return ActuatorFriction(
            (self.viscous_rotary,) * 3 + (self.viscous_linear,),
            (self.coulomb_rotary,) * 3 + (self.coulomb_linear,),
            self.transition_speed,
        )


class ActuatorFriction(NamedTuple):
    """Friction of each actuator, that of its joint and of its drive together.

    Attributes:
        viscous: (4,) [N m s/rad, N s/m].
        coulomb: (4,) [N m, N].
        transition_speed: Speed scale of the Coulomb step [rad/s, m/s].
    """

    viscous: tuple[float, ...]
    coulomb: tuple[float, ...]
    transition_speed: float

    @property
    def zero(self) -> bool:
        """Whether there is none."""
        return not (any(self.viscous) or any(self.coulomb))
