"""Settings of a feature: a dataclass whose fields also say what their inputs on the page need."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Any

import msgspec

from paminsa_viz.model import InvalidInput
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
    """Base of settings, whose numbers are in their ranges.

    Raises:
        InvalidInput: If one is not.
    """

    def __post_init__(self) -> None:
        for name, one in setting_fields(self).items():
            low, high = one.range
            value = getattr(self, name)
            if low is None or high is None or low <= value <= high:
                continue
            ends = f"{one.unit.from_si(low):g} to {one.unit.from_si(high):g}"
            raise InvalidInput(one.label, f"{ends} is possible, not {one.unit.from_si(value):g}")

    @property
    def possible(self) -> bool:
        """Whether a tab's store may give them back, as far as their type does not say so."""
        return True

    @property
    def saved(self) -> Settings:
        """What of them is kept across a reload."""
        return self


def changed_data(value: Any, start: Any) -> dict[str, Any]:
    """Return the fields of a dataclass that differ from another of its kind, as plain data."""
    data, default = (msgspec.to_builtins(each) for each in (value, start))
    return {name: each for name, each in data.items() if each != default[name]}
