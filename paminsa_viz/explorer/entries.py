"""What a panel holds, as plain tables: inputs, buttons, texts, and folders of them.

An input names its place in the state by two functions: ``read`` takes its value out of a state in
SI, ``apply`` makes the state with another value. `paminsa_viz.explorer.bindings` builds the entries
on the page, keeps them up to date, and dispatches what a person sets.

``label``, ``hint``, ranges, options and buttons may be constants or follow from the state.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass
from typing import Any, ClassVar

from paminsa_viz.explorer.actions import Action
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.session import Session, View
from paminsa_viz.explorer.state import State
from paminsa_viz.model import InvalidInput
from paminsa_viz.units import DisplayUnit, display_unit

Text = str | Callable[[State], str]
Condition = Callable[[State], bool]
Range = tuple[float | None, float | None]
"""Smallest and largest number in the unit shown; None where there is no limit."""

PLAIN = DisplayUnit(1.0, "")
"""Of a number that is shown as it is."""

PERCENT = DisplayUnit(100.0, "%")

MILLIMETERS = display_unit("m")


def finite(value: Any) -> float | None:
    """Return a finite number as a float, or None for anything else that a page may send."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return None
    try:
        number = float(value)
    except OverflowError:  # JSON knows integers beyond all floats
        return None
    return number if math.isfinite(number) else None


@dataclass(frozen=True)
class Run:
    """What a button does when it does not change the state, such as an export.

    It is called with the session on the thread of the click; `Session.submit` hands work to the
    session's worker.
    """

    call: Callable[[Session], None]


Effect = Action | Run


@dataclass(frozen=True)
class Entry:
    """What all entries share.

    Attributes:
        key: Its name: a newer request of the same key replaces one that waits.
        label: Text next to it.
        hint: Text where the pointer rests.
        visible, disabled: When it is; always and never if None.
        order: Place in the container, where it is not that of the table.
    """

    key: str
    label: Text = ""
    _: KW_ONLY
    hint: Text = ""
    visible: Condition | None = None
    disabled: Condition | None = None
    order: float | None = None


@dataclass(frozen=True)
class Input(Entry, ABC):
    """An input that shows a value of the state.

    Attributes:
        read: Its value in a state; in SI if it is a number.
        apply: The state with another value; may raise `PaminsaError`.
        undo: Whether setting it can be undone.
        idle: Whether it follows the state only when nothing is dragged.
        typed: Whether its value is typed character by character, and may be impossible on the way.
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

    @abstractmethod
    def parse(self, state: State, value: Any) -> Any:
        """Return a value from the page as ``apply`` takes it.

        Raises:
            InvalidInput: If it is not possible.
        """

    def name(self, state: State) -> str:
        """Return what messages call it."""
        return text_of(self.label, state) or self.key


@dataclass(frozen=True)
class Slider(Input):
    """A slider with a number box.

    Attributes:
        range: Its ends, in the unit shown.
        step: In the unit shown; as many decimals can be typed.
        unit: The unit shown.
        fit: Grows the range to a number beyond it, which can then be typed; without it, numbers
            are limited to the range.
        marks: Values with a tick.
    """

    _: KW_ONLY
    range: tuple[float, float] | Callable[[State], tuple[float, float]]
    step: float
    unit: DisplayUnit = PLAIN
    fit: Callable[[tuple[float, float], float], tuple[float, float]] | None = None
    marks: tuple[tuple[float, str], ...] | None = None

    def base_range(self, state: State) -> tuple[float, float]:
        """Return its ends before they grow."""
        return self.range(state) if callable(self.range) else self.range

    def shown(self, state: State) -> float:
        return self.unit.from_si(self.read(state))

    def parse(self, state: State, value: Any) -> float:
        number = _finite(self.name(state), value)
        if self.fit is None:
            low, high = self.base_range(state)
            number = min(max(number, low), high)
        return self.unit.to_si(number)


@dataclass(frozen=True)
class Number(Input):
    """A number box; attributes as of `Slider`, and numbers beyond the range are refused."""

    _: KW_ONLY
    range: Range = (None, None)
    step: float
    unit: DisplayUnit = PLAIN

    def shown(self, state: State) -> float:
        return self.unit.from_si(self.read(state))

    def parse(self, state: State, value: Any) -> float:
        name = self.name(state)
        return self.unit.to_si(_within(name, _finite(name, value), self.range))


@dataclass(frozen=True)
class Pair(Input):
    """Two numbers in a row; attributes as of `Number`, two of each but for the step.

    Attributes:
        precision: Decimals; as many as the step has if None.
    """

    _: KW_ONLY
    range: tuple[Range, Range] = ((None, None), (None, None))
    step: float | Callable[[State], float] = 0.001
    precision: Callable[[State], int] | None = None
    units: tuple[DisplayUnit, DisplayUnit] = (PLAIN, PLAIN)

    def shown(self, state: State) -> tuple[float, float]:
        first, second = (u.from_si(v) for u, v in zip(self.units, self.read(state), strict=True))
        return first, second

    def parse(self, state: State, value: Any) -> tuple[float, float]:
        name = self.name(state)
        if not isinstance(value, (tuple, list)) or len(value) != 2:
            raise InvalidInput(name, "two numbers are needed")
        first, second = (
            unit.to_si(_within(name, _finite(name, one), ends))
            for one, ends, unit in zip(value, self.range, self.units, strict=True)
        )
        return first, second


@dataclass(frozen=True)
class Checkbox(Input):
    """A switch."""

    typed: ClassVar[bool] = False

    def parse(self, state: State, value: Any) -> bool:
        if not isinstance(value, bool):
            raise InvalidInput(self.name(state), "on or off is needed")
        return value


@dataclass(frozen=True)
class Dropdown(Input):
    """A choice.

    Attributes:
        options: Values by the text that is shown.
    """

    _: KW_ONLY
    options: Mapping[str, Any] | Callable[[State], Mapping[str, Any]]
    typed: ClassVar[bool] = False

    def choices(self, state: State) -> Mapping[str, Any]:
        """Return what can be chosen."""
        return self.options(state) if callable(self.options) else self.options

    def shown(self, state: State) -> str:
        value = self.read(state)
        return next(text for text, known in self.choices(state).items() if known == value)

    def parse(self, state: State, value: Any) -> Any:
        choices = self.choices(state)
        if value not in choices:
            raise InvalidInput(self.name(state), f"one of {', '.join(choices)} is needed")
        return choices[value]


@dataclass(frozen=True)
class TextBox(Input):
    """A line of text."""

    def parse(self, state: State, value: Any) -> str:
        if not isinstance(value, str):
            raise InvalidInput(self.name(state), "text is needed")
        return value


@dataclass(frozen=True)
class Button(Entry):
    """A button.

    Attributes:
        effect: What it does.
        icon: Name of its icon.
        color: Its color, if it is not the page's.
        undo: Whether it can be undone.
    """

    _: KW_ONLY
    effect: Effect
    icon: Any = None
    color: str | None = None
    undo: bool = True


@dataclass(frozen=True)
class ButtonGroup(Entry):
    """Buttons in a row.

    Attributes:
        choices: What each does, by its text; none of them hides the row.
    """

    _: KW_ONLY
    choices: Mapping[str, Effect] | Callable[[State], Mapping[str, Effect]]

    def effects(self, state: State) -> Mapping[str, Effect]:
        """Return what each button does."""
        return self.choices(state) if callable(self.choices) else self.choices


@dataclass(frozen=True)
class Upload(Entry):
    """A button that opens a file.

    Attributes:
        receive: Called on the session's worker with the file's name and content, which is empty if
            the file is too large.
        mime_type: Which files are offered.
    """

    _: KW_ONLY
    receive: Callable[[Session, str, bytes], None]
    mime_type: str
    icon: Any = None
    color: str | None = None


@dataclass(frozen=True)
class Html(Entry):
    """A text, rendered from what is shown.

    Attributes:
        content: Its HTML.
        depends: What it depends on, if it is worth a comparison by identity.
        idle: Whether it follows only when nothing is dragged.
    """

    _: KW_ONLY
    content: Callable[[Frame], str]
    depends: Callable[[Frame], object] | None = None
    idle: bool = False


@dataclass(frozen=True)
class Progress(Entry):
    """A bar.

    Attributes:
        read: What part is done, 0 to 1.
    """

    _: KW_ONLY
    read: Callable[[State], float]


@dataclass(frozen=True)
class Folder(Entry):
    """A folder of entries; without a label, they are only grouped.

    Attributes:
        entries: What it holds.
        open: Whether it is open at first.
    """

    _: KW_ONLY
    entries: Sequence[Entry]
    open: bool = True


@dataclass(frozen=True)
class Tabs(Entry):
    """Tabs of entries.

    Attributes:
        tabs: What they hold, by name.
    """

    _: KW_ONLY
    tabs: Mapping[str, Sequence[Entry]]


@dataclass(frozen=True)
class Custom(Entry):
    """Something that draws itself.

    Attributes:
        make: Builds it in the current container of the page.
    """

    _: KW_ONLY
    make: Callable[[Session], View]


def text_of(text: Text, state: State) -> str:
    """Return a text that may depend on the state."""
    return text(state) if callable(text) else text


def inputs_in(entries: Sequence[Entry]) -> list[Input]:
    """Return all inputs of a table, those in folders and tabs as well."""
    found: list[Input] = []
    for entry in entries:
        if isinstance(entry, Input):
            found.append(entry)
        elif isinstance(entry, Folder):
            found += inputs_in(entry.entries)
        elif isinstance(entry, Tabs):
            for tab in entry.tabs.values():
                found += inputs_in(tab)
    return found


def _finite(name: str, value: Any) -> float:
    number = finite(value)
    if number is None:
        raise InvalidInput(name, "a finite number is needed")
    return number


def _within(name: str, number: float, ends: Range) -> float:
    low, high = ends
    if low is not None and high is not None and not low <= number <= high:
        raise InvalidInput(name, f"{low:g} to {high:g} is possible, not {number:g}")
    if low is not None and number < low:
        raise InvalidInput(name, f"at least {low:g} is needed, not {number:g}")
    if high is not None and number > high:
        raise InvalidInput(name, f"at most {high:g} is possible, not {number:g}")
    return number
