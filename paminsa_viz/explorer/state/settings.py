"""Settings of a feature: a dataclass whose fields also say what their inputs on the page need."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Any

import msgspec

from paminsa_viz.model import InvalidInput
from paminsa_viz.model.resizing import is_comparable
from paminsa_viz.units import DisplayUnit, display_unit

Range = tuple[float | None, float | None]
"""Smallest and largest number in SI; None where there is no limit."""

PLAIN = DisplayUnit(1.0, "")
"""Of a number that is shown as it is."""

PERCENT = DisplayUnit(100.0, "%")

MILLIMETERS = display_unit("m")


@dataclass(frozen=True)
class Setting:
    """What the input of a setting needs next to its value.

    Attributes:
        label: Text next to it.
        hint: Tooltip.
        range: Of a number.
        step: Of a number, in the unit shown.
        unit: The unit that a number is shown in.
        options: Values to choose from by their texts; for an enum its members by their values.
    """

    label: str
    hint: str = ""
    range: Range = (None, None)
    step: float = 1.0
    unit: DisplayUnit = PLAIN
    options: Mapping[str, Any] | None = None


def setting(default: Any, label: str, hint: str = "", **more: Any) -> Any:
    """Return a field of a settings dataclass; arguments as of `Setting`."""
    return field(default=default, metadata={"setting": Setting(label, hint, **more)})


def setting_fields(kind: Any) -> dict[str, Setting]:
    """Return the settings of a dataclass by the names of their fields."""
    found = {item.name: item.metadata.get("setting") for item in fields(kind)}
    return {name: one for name, one in found.items() if one is not None}


@dataclass(frozen=True)
class Settings:
    """Base of settings: numbers are in their ranges, and choices among their options.

    Raises:
        InvalidInput: If one is not.
    """

    def __post_init__(self) -> None:
        for name, one in setting_fields(self).items():
            value = getattr(self, name)
            if one.options is not None:
                if value not in one.options.values():
                    texts = ", ".join(one.options)
                    raise InvalidInput(one.label, f"choose one of: {texts}; not {value!r:.40}")
            elif one.range != (None, None) and not _within(value, one.range):
                shown = one.unit.from_si(value)
                raise InvalidInput(one.label, f"{_ends(one)} is possible, not {shown:g}")

    @property
    def possible(self) -> bool:
        """Whether a tab's store may give them back, as far as their type does not say so."""
        return True

    @property
    def saved(self) -> Settings:
        """What of them is kept across a reload."""
        return self


def _within(value: float, ends: Range) -> bool:
    low, high = ends
    # Not a number is in no range.
    return (-math.inf if low is None else low) <= value <= (math.inf if high is None else high)


def _ends(one: Setting) -> str:
    low, high = (None if end is None else f"{one.unit.from_si(end):g}" for end in one.range)
    if low is None:
        return f"at most {high}"
    return f"at least {low}" if high is None else f"{low} to {high}"


def at_first(value: float, power: int, ratio: float, ends: tuple[float, float]) -> float:
    """Return what a number begins with on a robot, to one digit, from its value for the prototype.

    Args:
        value: The value at about Appendix 4's lengths.
        power: Power of the lengths that it follows.
        ratio: A length of the robot, or the size of its bodies, over Appendix 4's.
        ends: The smallest and the largest that are possible.
    """
    if is_comparable(ratio):
        return value
    return min(max(float(f"{value * ratio**power:.0e}"), ends[0]), ends[1])


def followed(
    owner: Any,
    first: Any,
    powers: Mapping[str, tuple[int, tuple[float, float]]],
    was: float,
    now: float,
) -> Any:
    """Return an owner of numbers with those that nobody has chosen as another robot has them.

    Args:
        owner: Attributes, some of which follow the lengths.
        first: The same for the prototype.
        powers: Powers of the lengths, and ends of what is possible, by attribute.
        was: A length or the size of the bodies of the robot that it was for, over Appendix 4's.
        now: The same of the robot that it is for.
    """
    changes = {}
    for name, (power, ends) in powers.items():
        value = getattr(first, name)
        before, after = (at_first(value, power, one, ends) for one in (was, now))
        if getattr(owner, name) == before != after:
            changes[name] = after
    return replace(owner, **changes) if changes else owner


def changed_data(value: Any, start: Any) -> dict[str, Any]:
    """Return the fields of a dataclass that differ from another of its kind, as plain data."""
    data, default = (msgspec.to_builtins(each) for each in (value, start))
    return {name: each for name, each in data.items() if each != default[name]}
