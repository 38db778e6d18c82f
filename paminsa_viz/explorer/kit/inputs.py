"""Inputs of a panel, as plain tables.

An input names its place in the state by two functions: ``read`` takes its value out of a state in
SI, ``apply`` makes the state with another value; `attribute` returns both for a plain attribute.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import KW_ONLY, dataclass
from decimal import Decimal
from operator import attrgetter
from typing import Any, ClassVar

from paminsa_viz.explorer.browser.bridge import finite
from paminsa_viz.explorer.kit.entries import Entry, Given, given
from paminsa_viz.explorer.state.settings import PLAIN, Range
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model import InvalidInput
from paminsa_viz.units import DisplayUnit

SPARE_DECIMALS, LEAST_DECIMALS = 2, 3
"""Decimals that a number box shows beyond those of its step, and the fewest it shows."""

FEWEST_DIGITS, DIGITS = 3, 6
"""A number of which fewer significant digits would be seen is shown with so many instead."""


def decimals(step: float, value: float = 0.0) -> int:
    """Return how many decimals a number box with a step shows; it takes any number of them.

    Args:
        step: The step.
        value: The number, if one far below the step is meant as it is, and is no rounding of 0;
            may be infinite.
    """
    exact = Decimal(repr(float(step))).normalize().as_tuple().exponent
    places = max(SPARE_DECIMALS - int(exact), LEAST_DECIMALS)
    first = -math.floor(math.log10(abs(value))) if value and math.isfinite(value) else 0
    return places if first + FEWEST_DIGITS - 1 <= places else first + DIGITS - 1


def same_digits(a: Any, b: Any, places: int) -> bool:
    """Whether two numbers are the same in a box with so many decimals."""
    first, second = finite(a), finite(b)
    return (
        first is not None and second is not None and round(first, places) == round(second, places)
    )


def holding(ends: Range, value: float) -> Range:
    """Return ends that hold a value too: viser builds no input with a value beyond its ends.

    What a file brings may be there; another number beyond the ends is refused as ever.
    """
    low, high = ends
    return None if low is None else min(low, value), None if high is None else max(high, value)


def in_unit(ends: Range, unit: DisplayUnit) -> Range:
    """Return ends in SI in the unit shown."""
    low, high = (None if end is None else unit.from_si(end) for end in ends)
    return low, high


def attribute(path: str, change: Callable[..., State] | None = None) -> dict[str, Any]:
    """Return ``read`` and ``apply`` of an input for an attribute of the state.

    Args:
        path: The attribute, such as ``plots.color``.
        change: Makes the state with its new value, which is given by its name; without it, nothing
            else changes.
    """
    part, _, name = path.rpartition(".")

    def apply(state: State, value: Any) -> State:
        changes = {name: value}
        return state.updated(part, **changes) if change is None else change(state, **changes)

    return {"read": attrgetter(path), "apply": apply}


@dataclass(frozen=True)
class Input(Entry, ABC):
    """An input that shows a value of the state.

    Attributes:
        read: Its value in a state; in SI if it is a number.
        apply: The state with another value; may raise `PaminsaError`.
        undo: Whether setting it can be undone.
        idle: Whether it follows the state only when nothing is dragged.
        typed: Whether its value is typed character by character or dragged: it may be impossible on
            the way, and a newer one overtakes one that waits.
    """

    _: KW_ONLY
    read: Callable[[State], Any]
    apply: Callable[[State, Any], State]
    undo: bool = True
    idle: bool = False
    typed: ClassVar[bool] = True

    def shown(self, state: State) -> Any:
        """Return the value as the page has it."""
        return self.read(state)

    def is_shown(self, state: State, value: Any) -> bool:
        """Whether a number from the page is the one that its box shows already."""
        del state, value
        return False

    @abstractmethod
    def parse(self, state: State, value: Any) -> Any:
        """Return a value from the page as ``apply`` takes it.

        Raises:
            InvalidInput: If it is not possible.
        """

    @abstractmethod
    def add(self, gui: Any, state: State, label: str, **properties: Any) -> Any:
        """Build it in viser's GUI with the properties that all inputs share; return its handle."""

    def refusal(self, state: State, needed: str) -> InvalidInput:
        """Return the error that says what is needed."""
        return InvalidInput(given(self.label, state) or self.key, needed)

    def number(self, state: State, value: Any, ends: Range, unit: DisplayUnit) -> float:
        """Return a number from the page in SI, which is finite and in a range.

        Raises:
            InvalidInput: If it is not.
        """
        number, (low, high) = finite(value), in_unit(ends, unit)
        if number is None:
            raise self.refusal(state, "a finite number is needed")
        if low is not None and high is not None and not low <= number <= high:
            raise self.refusal(state, f"{low:g} to {high:g} is possible, not {number:g}")
        if low is not None and number < low:
            raise self.refusal(state, f"at least {low:g} is needed, not {number:g}")
        if high is not None and number > high:
            raise self.refusal(state, f"at most {high:g} is possible, not {number:g}")
        return unit.to_si(number)


@dataclass(frozen=True)
class OneNumber(Input):
    """An input of one number.

    Attributes:
        step: In the unit shown; any number of decimals can be typed.
        unit: The unit shown.
    """

    _: KW_ONLY
    step: Given[float]
    unit: DisplayUnit = PLAIN

    def shown(self, state: State) -> float:
        return self.unit.from_si(self.read(state))

    def is_shown(self, state: State, value: Any) -> bool:
        return same_digits(value, self.shown(state), self.places(state))

    def places(self, state: State) -> int:
        """Return how many decimals are shown: of a small mass or inertia more than of its step.

        Of lengths and angles, in mm and degrees, what is far below a step is rounding.
        """
        value = self.shown(state) if self.unit.factor <= 1 else 0.0
        return decimals(given(self.step, state), value)


@dataclass(frozen=True)
class Slider(OneNumber):
    """A slider with a number box.

    Attributes:
        range: Its ends, in the unit shown.
        fit: Grows the range to a number beyond it, which can then be typed; without it, numbers
            more than a step beyond the range are refused.
        marks: Values with a tick, which is left out while it is beyond the ends.
    """

    _: KW_ONLY
    range: Given[tuple[float, float]]
    fit: Callable[[tuple[float, float], float], tuple[float, float]] | None = None
    marks: tuple[tuple[float, str], ...] | None = None

    def parse(self, state: State, value: Any) -> float:
        number = self.number(state, value, (None, None), PLAIN)
        if self.fit is None:
            low, high = given(self.range, state)
            step = given(self.step, state)
            # The page may round the ends, and a number at an end that has just moved is near it.
            if not low - step <= number <= high + step:
                raise self.refusal(state, f"{low:g} to {high:g} is possible, not {number:g}")
            number = min(max(number, low), high)
        return self.unit.to_si(number)

    def ends(self, state: State, ends: tuple[float, float]) -> tuple[float, float]:
        """Return ends, grown to hold the state's value."""
        return ends if self.fit is None else self.fit(ends, self.shown(state))

    def add(self, gui: Any, state: State, label: str, **properties: Any) -> Any:
        low, high = self.ends(state, given(self.range, state))
        value, step = self.shown(state), given(self.step, state)
        handle = gui.add_slider(label, low, high, step, value, marks=self.marks, **properties)
        handle.precision = self.places(state)
        return handle


@dataclass(frozen=True)
class Number(OneNumber):
    """A number box.

    Attributes:
        range: Its ends in SI; numbers beyond them are refused.
    """

    _: KW_ONLY
    range: Range = (None, None)

    def parse(self, state: State, value: Any) -> float:
        return self.number(state, value, self.range, self.unit)

    def add(self, gui: Any, state: State, label: str, **properties: Any) -> Any:
        value = self.shown(state)
        low, high = holding(in_unit(self.range, self.unit), value)
        step = given(self.step, state)
        handle = gui.add_number(label, value, min=low, max=high, step=step, **properties)
        handle.precision = self.places(state)
        return handle


@dataclass(frozen=True)
class Pair(Input):
    """Two numbers in a row; attributes as of `Number`, two of each but for the step.

    Attributes:
        precision: Decimals that are shown; two more than the step has if None.
        ordered: Whether the second number is at least the first one, which goes along with it, as
            it does with the first, where one of them is changed past the other.
    """

    _: KW_ONLY
    range: tuple[Range, Range] = ((None, None), (None, None))
    step: Given[float] = 0.001
    precision: Callable[[State], int] | None = None
    units: tuple[DisplayUnit, DisplayUnit] = (PLAIN, PLAIN)
    ordered: bool = False

    def shown(self, state: State) -> tuple[float, float]:
        first, second = (u.from_si(v) for u, v in zip(self.units, self.read(state), strict=True))
        return first, second

    def is_shown(self, state: State, value: Any) -> bool:
        return all(self._unchanged(state, value))

    def _unchanged(self, state: State, value: Any) -> list[bool]:
        """Return which of two numbers as shown are those of a state."""
        places = decimals(given(self.step, state))
        if self.precision is not None:
            places = self.precision(state)
        pairs = zip(value, self.shown(state), strict=True)
        return [same_digits(a, b, places) for a, b in pairs]

    def parse(self, state: State, value: Any) -> tuple[float, float]:
        if not isinstance(value, (tuple, list)) or len(value) != 2:
            raise self.refusal(state, "two numbers are needed")
        first, second = (
            self.number(state, one, ends, unit)
            for one, ends, unit in zip(value, self.range, self.units, strict=True)
        )
        if self.ordered and first > second:
            # typed from left to right: the end that was not typed goes along
            match self._unchanged(state, value):
                case [False, True]:
                    return first, first
                case [True, False]:
                    return second, second
            needed = f"the least and then the largest is needed, not {value[0]:g} and {value[1]:g}"
            raise self.refusal(state, needed)
        return first, second

    def add(self, gui: Any, state: State, label: str, **properties: Any) -> Any:
        value = self.shown(state)
        ranges = map(holding, map(in_unit, self.range, self.units), value)
        low, high = (None if None in ends else ends for ends in zip(*ranges, strict=True))
        step = given(self.step, state)
        handle = gui.add_vector2(label, value, min=low, max=high, step=step, **properties)
        if self.precision is None:
            handle.precision = decimals(step)
        return handle


@dataclass(frozen=True)
class Checkbox(Input):
    """A switch."""

    typed: ClassVar[bool] = False

    def parse(self, state: State, value: Any) -> bool:
        if not isinstance(value, bool):
            raise self.refusal(state, "on or off is needed")
        return value

    def add(self, gui: Any, state: State, label: str, **properties: Any) -> Any:
        return gui.add_checkbox(label, self.shown(state), **properties)


@dataclass(frozen=True)
class Dropdown(Input):
    """A choice.

    Attributes:
        options: Values by the text that is shown.
    """

    _: KW_ONLY
    options: Given[Mapping[str, Any]]
    typed: ClassVar[bool] = False

    def shown(self, state: State) -> str:
        value = self.read(state)
        return next(text for text, known in given(self.options, state).items() if known == value)

    def parse(self, state: State, value: Any) -> Any:
        options = given(self.options, state)
        if value not in options:
            raise self.refusal(state, f"one of {', '.join(options)} is needed")
        return options[value]

    def add(self, gui: Any, state: State, label: str, **properties: Any) -> Any:
        options = tuple(given(self.options, state))
        return gui.add_dropdown(label, options, initial_value=self.shown(state), **properties)


@dataclass(frozen=True)
class TextBox(Input):
    """A line of text."""

    def parse(self, state: State, value: Any) -> str:
        if not isinstance(value, str):
            raise self.refusal(state, "text is needed")
        return value

    def add(self, gui: Any, state: State, label: str, **properties: Any) -> Any:
        return gui.add_text(label, self.shown(state), **properties)
