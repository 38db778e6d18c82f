"""The counterweights of the design as a list: each can be changed, moved and taken off."""

from __future__ import annotations

from html import escape
from typing import Any

from paminsa_viz.explorer.balancing import requests
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.panels.debounced_input import DebouncedInput
from paminsa_viz.explorer.panels.tables import note
from paminsa_viz.explorer.panels.validation import pair
from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.state import State
from paminsa_viz.meshes.weights import room_words
from paminsa_viz.model.counterweight import BAR_ENDS, Counterweight

PLACES = {
    f"{bar.upper()} past {joint}": (bar, joint) for bar, ends in BAR_ENDS.items() for joint in ends
}
"""Where a counterweight can be added."""

OFF = "all"
"""What the button says that takes all of them off."""

_ADD = "Add on"
_CHOOSE = "choose …"


class WeightList:
    """Rows for the counterweights, a place to add one, buttons to take them off.

    Made in the current container; it has as many rows as there ever were counterweights at once.
    """

    def __init__(self, session: Session) -> None:
        gui = session.client.gui
        self._session = session
        self._words = gui.add_html("")
        self._rows_place = gui.add_folder(None)
        self.rows: list[Any] = []
        self._controls: list[DebouncedInput] = []
        self.add = gui.add_dropdown(
            _ADD, (_CHOOSE, *PLACES), initial_value=_CHOOSE,
            hint="1 kg on each leg, 100 mm beyond that joint; then change it as you like",
        )  # fmt: skip
        self.off = gui.add_button_group(
            "Take off", (OFF,), visible=False, hint="One of them, or all: counterweights off"
        )
        self.add.on_update(self._on_add)
        self.off.on_click(self._on_off)

    def _on_add(self, event: Any) -> None:
        place = PLACES.get(self.add.value)
        if event.client is None or place is None:
            return
        self._session.dispatch("weights.add", lambda state: requests.add_weight(state, *place))

    def _on_off(self, event: Any) -> None:
        chosen = event.target.value
        if chosen == OFF:
            self._session.dispatch("weights.off", lambda state: requests.hang(state, ()))
        elif chosen in self.off.options:
            number = int(chosen) - 1
            self._session.dispatch("weights.off", lambda state: requests.drop_weight(state, number))

    def draw(self, frame: Frame, moving: bool) -> None:
        """Follow the state."""
        weights = frame.state.document.design.counterweights
        while len(self.rows) < len(weights):
            self._add_row(frame.state)
        for number, row in enumerate(self.rows):
            visible = number < len(weights)
            if visible:
                label = row_label(number, weights[number])
                if row.label != label:
                    row.label = label
            if row.visible != visible:
                row.visible = visible
        for control in self._controls:
            control.draw(frame, moving)
        if self.add.value != _CHOOSE:
            self.add.value = _CHOOSE
        numbers = [str(number + 1) for number in range(len(weights))] if len(weights) > 1 else []
        options = (*numbers, OFF)
        if tuple(self.off.options) != options:
            self.off.options = options
        for handle, visible in ((self.off, bool(weights)), (self._rows_place, bool(weights))):
            if handle.visible != visible:
                handle.visible = visible
        if moving:
            return  # the room takes some 10 ms for each of them
        text = _words(frame.state)
        if self._words.content != text:
            self._words.content = text

    def _add_row(self, state: State) -> None:
        number = len(self.rows)
        weight = state.document.design.counterweights[number]
        with self._rows_place:
            row = self._session.client.gui.add_vector2(
                row_label(number, weight), _shown(weight), step=0.001,
                hint="Distance beyond the joint [mm]; before it, on the bar itself, where negative."
                " Mass on each leg [kg]",
            )  # fmt: skip

        def apply(state: State, value: Any) -> State:
            beyond, mass = pair(value)
            return requests.set_weight(state, number, mass, beyond / 1e3)

        def show(state: State) -> Any:
            weights = state.document.design.counterweights
            return _shown(weights[number]) if number < len(weights) else row.value

        self.rows.append(row)
        self._controls.append(DebouncedInput(self._session, row, f"weights.{number}", apply, show))


def _words(state: State) -> str:
    """Return what stands above the rows: what they hold, and the room that the discs need."""
    document = state.document
    weights = document.design.counterweights
    if not weights:
        return note("The design has no counterweights.", muted=True)
    said = ["Distance past the joint [mm], mass on each leg [kg]"]
    for number, weight in enumerate(weights, 1):
        words = room_words(document.design.geometry, weight)
        said.append(f"<b>{number}</b> {escape(words)}")
    return note("<br>".join(said), "weights-room", muted=True)


def row_label(number: int, weight: Counterweight) -> str:
    """Return the text beside a row."""
    return f"{number + 1}: {weight.bar.upper()} past {weight.joint}"


def _shown(weight: Counterweight) -> tuple[float, float]:
    return round(1e3 * weight.beyond, 6), round(weight.mass, 9)
