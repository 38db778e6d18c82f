"""What a person wants of the masses: what may change, within which bounds, to make what small."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum

from paminsa_viz.balancing import Changes, CounterweightRange, MassRange, beyond, paper_changes
from paminsa_viz.balancing.sensitivity import MASSES
from paminsa_viz.model import Design, InvalidInput


class Goal(Enum):
    """What is made small; values are what a person reads."""

    ADDED = "balance, least added mass"
    MOVED = "balance, least mass moved"
    PEAK = "peak torque, present motion"
    RMS = "RMS torque, present motion"
    BOTH = "peaks: in motion, standing"

    @property
    def static(self) -> bool:
        """Whether it is about the balance alone, whatever the motion."""
        return self in (Goal.ADDED, Goal.MOVED)


class FreeMasses(Enum):
    """Which joints and links may change; values are what a person reads."""

    PANTOGRAPH = "all that stand in M_p2"
    ALL = "all joints and links"
    NONE = "none"


@dataclass(frozen=True)
class CounterweightSlot:
    """A place for counterweights: beyond an end joint of a bar.

    Attributes:
        longest: Longest lever [m].
        most: Most mass on each leg [kg]; 0 for none.
    """

    longest: float = 0.1
    most: float = 0.0


ARMS = (("arm_b8", "b8", 8), ("arm_b3", "b3", 7))
"""Fields of `BalanceSettings` for arms, with their bars and joints."""


@dataclass(frozen=True)
class BalanceSettings:
    """What a person set.

    Attributes:
        goal: What is made small.
        share: How much the motion counts beside standing still, 0 to 1, for `Goal.BOTH`.
        movable: Joints and links that may change.
        heavier: By how much each of them may grow [kg].
        lighter: What part of each may be taken away, 0 to 1.
        arm_b8, arm_b3: Counterweights beyond joint 8 on B8, and beyond joint 7 on B3.
        exact: Whether nothing but M_p2 = 0 will do.
        added: Largest added mass of the robot, for goals on the motion [kg]; 0 for no limit.
        change: By what part each value is changed to see what it matters, 0 to 1.
    """

    goal: Goal = Goal.ADDED
    share: float = 0.5
    movable: FreeMasses = FreeMasses.NONE
    heavier: float = 5.0
    lighter: float = 0.0
    arm_b8: CounterweightSlot = CounterweightSlot(most=5.0)
    arm_b3: CounterweightSlot = CounterweightSlot(most=5.0)
    exact: bool = True
    added: float = 0.0
    change: float = 0.05

    @property
    def arms(self) -> tuple[CounterweightRange, ...]:
        """The places for counterweights that are in use."""
        named = [(getattr(self, name), bar, joint) for name, bar, joint in ARMS]
        return tuple(
            beyond(bar, joint, arm.longest, arm.most) for arm, bar, joint in named if arm.most > 0
        )


RANGES = {
    "share": (0.0, 1.0),
    "heavier": (0.0, 100.0),
    "lighter": (0.0, 1.0),
    "added": (0.0, 1e3),
    "change": (0.001, 0.5),
}
"""Smallest and largest values of `BalanceSettings`, in its units."""

LONGEST, MOST = (0.0, 1.0), (0.0, 100.0)
"""Smallest and largest lever [m] and mass [kg] of an arm."""


def require_possible(settings: BalanceSettings) -> None:
    """Check what a person set.

    Raises:
        InvalidInput: If a number is out of its range.
    """
    checked = [(name, getattr(settings, name), ends) for name, ends in RANGES.items()]
    for name, bar, joint in ARMS:
        arm = getattr(settings, name)
        place = f"{bar.upper()} beyond {joint}"
        checked += [(f"{place}, lever", arm.longest, LONGEST), (f"{place}, mass", arm.most, MOST)]
    for name, value, (low, high) in checked:
        if not (math.isfinite(value) and low <= value <= high):
            raise InvalidInput(name, f"{low:g} to {high:g} is possible, not {value:g}")


def changes_of(settings: BalanceSettings, design: Design) -> Changes:
    """Return what may change in a design; counterweights that it has may become lighter.

    Raises:
        InvalidInput: If that is nothing.
    """
    paths: tuple[str, ...] = ()
    if settings.movable is FreeMasses.PANTOGRAPH:
        paths = tuple(mass.path for mass in paper_changes(design).masses)
    elif settings.movable is FreeMasses.ALL:
        paths = tuple(path for path in MASSES if path.startswith(("joints.", "links.")))
    masses = []
    for path in paths:
        held = design.value(path)
        masses.append(MassRange(path, (1 - settings.lighter) * held, held + settings.heavier))
    for number, weight in enumerate(design.counterweights):
        masses.append(MassRange(f"counterweights.{number}.mass", 0.0, weight.mass))
    if not masses and not settings.arms:
        raise InvalidInput(
            "what may change", "choose joints and links, or give counterweights a mass"
        )
    return Changes(tuple(masses), settings.arms)
