"""A number of the design as a row: slider, number entry, a tick at Appendix 4's value."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from paminsa_viz.explorer import actions
from paminsa_viz.explorer.bounds import largest
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.panels.debounced_input import DebouncedInput
from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.state import State
from paminsa_viz.model import APPENDIX_4, PARAMETER, InvalidDesign, InvalidInput
from paminsa_viz.units import number, symbol_text


@dataclass(frozen=True)
class Row:
    """How one number of the design is offered.

    Attributes:
        path: Its dotted path.
        name: A word or two beside the symbol.
        low, high: The slider's range in the unit shown. A larger or smaller number can be typed,
            and the slider grows to it.
        step: The slider's step in the unit shown; as many decimals can be typed.
    """

    path: str
    name: str
    low: float
    high: float
    step: float

    @property
    def label(self) -> str:
        """Text beside the slider."""
        return f"{symbol_text(PARAMETER[self.path].symbol)} {self.name}".strip()

    @property
    def hint(self) -> str:
        """What the number is, and Appendix 4's value."""
        parameter = PARAMETER[self.path]
        default = parameter.display.format(parameter.default, 6)
        if self.path == "geometry.guide_stroke":
            default = "as long as l_B10, and it follows l_B10 until it is set"
        name = parameter.label[:1].upper() + parameter.label[1:]
        return f"{name}. Appendix 4: {default}."


def round_up(value: float) -> float:
    """Return the next number with two significant figures, the second one 0 or 5."""
    if value <= 0:
        return 0.0
    unit = 10.0 ** (math.floor(math.log10(value)) - 1) * 5
    return float(f"{math.ceil(value / unit - 1e-9) * unit:.12g}")


def fitted_range(row: Row, low: float, high: float, value: float) -> tuple[float, float]:
    """Return a slider's range, grown if it has to be to hold ``value`` with room above it."""
    if value > high:
        most = PARAMETER[row.path].display.from_si(largest(row.path))
        high = min(round_up(1.5 * value), max(most, value))
    return min(low, value), high


class NumberRow:
    """The slider of one number, bound to the session.

    Attributes:
        row: What it offers.
        name: The symbol, by which a button names the number.
        slider: viser's handle.
    """

    def __init__(self, session: Session, row: Row, hint: str) -> None:
        self.row = row
        parameter = PARAMETER[row.path]
        self._unit, self.name = parameter.display, symbol_text(parameter.symbol)
        value = self._show(session.state)
        self._low, self._high = fitted_range(row, row.low, row.high, value)
        default = self._unit.from_si(parameter.default)
        tick = ((default, number(default, 6)),)
        self.slider = session.client.gui.add_slider(
            row.label, self._low, self._high, row.step, value, marks=tick, hint=hint
        )
        self._control = DebouncedInput(
            session, self.slider, f"design.{row.path}", self._apply, self._show
        )

    def _show(self, state: State) -> float:
        return self._unit.from_si(state.document.design.value(self.row.path))

    def _apply(self, state: State, value: Any) -> State:
        shown = f"{self.name} = {number(float(value), 6)} {self._unit.text}".rstrip()
        try:
            return actions.vary(state, {self.row.path: self._unit.to_si(float(value))})
        except InvalidDesign as error:
            # The model names the value that it misses; the person has to know which one was set.
            raise InvalidInput(shown, error.allowed) from error

    def changed(self, state: State) -> bool:
        """Whether the number is not Appendix 4's."""
        return is_changed(state.document.design, self.row.path)

    def draw(self, frame: Frame, moving: bool) -> None:
        """Follow the state; the range grows to numbers typed beyond it."""
        before = self.slider.value
        self._control.draw(frame, moving)
        value = self._show(frame.state)
        if self.slider.value != before:
            # Set by something else than this slider, so no hand is on it and it may shrink again.
            self._fit(*fitted_range(self.row, self.row.low, self.row.high, value))
        elif not self._low <= value <= self._high:
            self._fit(*fitted_range(self.row, self._low, self._high, value))

    def _fit(self, low: float, high: float) -> None:
        if low != self._low:
            self._low = self.slider.min = low
        if high != self._high:
            self._high = self.slider.max = high


def is_changed(design: Any, path: str, reference: Any = APPENDIX_4) -> bool:
    """Whether two designs differ in the number at ``path``.

    The guide stroke differs as well where it is set in one and follows l_B10 in the other.
    """
    if path == "geometry.guide_stroke":
        return design.geometry.guide_stroke != reference.geometry.guide_stroke
    return design.value(path) != reference.value(path)
