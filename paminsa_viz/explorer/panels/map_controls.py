"""Inputs for what maps show and for what their colors mean."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from paminsa_viz.explorer import actions
from paminsa_viz.explorer.controls import Control
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.panels.map_picture import MapPicture
from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.state import RangeMode, State
from paminsa_viz.model import InvalidInput
from paminsa_viz.plots import ticks
from paminsa_viz.plots.ranges import LARGEST_END
from paminsa_viz.quantities import QUANTITIES
from paminsa_viz.units import display_unit

FIG_3_ANGLE = np.pi / 3
"""Angle of the platform in the paper's Fig. 3 [rad]; it does not say the height."""

RANGE_LABELS = {
    RangeMode.AUTO: "robust",
    RangeMode.FULL: "full",
    RangeMode.MANUAL: "manual",
}


def _key(labels: dict[Any, str], label: object) -> Any:
    for key, name in labels.items():
        if name == label:
            return key
    raise InvalidInput("choice", f"one of {', '.join(labels.values())} is needed")


def choose_quantity(state: State, quantity: str) -> State:
    """Show another quantity; a manual range in another unit is given up."""
    view = state.map_view
    mode = view.range_mode
    if mode is RangeMode.MANUAL and QUANTITIES[quantity].unit != QUANTITIES[view.quantity].unit:
        mode = RangeMode.AUTO
    return actions.set_map_view(state, quantity=quantity, range_mode=mode)


def show_figure_3(state: State) -> State:
    """Turn the platform to the angle of Fig. 3 and show the torques as it does.

    The position stays if the robot can take it at that angle, else the platform goes to the
    middle.
    """
    view = replace(state.map_view, range_mode=RangeMode.AUTO, shared=True, difference=False)
    shown = replace(state, map_view=view)
    turned = actions.move(shown, theta=FIG_3_ANGLE)
    if turned.standing.pose != turned.document.pose:
        turned = actions.move(shown, x=0.0, y=0.0, theta=FIG_3_ANGLE)
    return turned


class MapControls:
    """The row of inputs below a picture, made in the current container.

    Args:
        session: The tab.
        picture: The picture above; the range that it shows stands in the inputs.
        name: Name of the picture, for the inputs' names.
        unit: SI unit of what the picture shows.
        brief: Whether labels have to be short.
    """

    def __init__(
        self,
        session: Session,
        picture: MapPicture,
        name: str,
        unit: Callable[[State], str],
        brief: bool = False,
    ) -> None:
        self._session, self._picture, self._name, self._unit = session, picture, name, unit
        self._brief = brief
        self._controls: list[Control] = []
        self._ends: Any = None
        self._difference: Any = None

    def _control(self, handle: Any, name: str, apply: Any, show: Any) -> Any:
        self._controls.append(Control(self._session, handle, f"{self._name}.{name}", apply, show))
        return handle

    def quantity(self) -> None:
        """Add the choice of what the single map and the floor show."""
        labels = {key: item.label for key, item in QUANTITIES.items()}
        self._control(
            self._session.client.gui.add_dropdown(
                "show",
                tuple(labels.values()),
                initial_value=labels[self._session.state.map_view.quantity],
                hint="What this map and the floor map below the robot show",
            ),
            "quantity",
            lambda s, label: choose_quantity(s, _key(labels, label)),
            lambda s: labels[s.map_view.quantity],
        )

    def range(self) -> None:
        """Add the color range: how it is found, and its ends."""
        gui = self._session.client.gui
        self._control(
            gui.add_dropdown(
                "colors" if self._brief else "color range",
                tuple(RANGE_LABELS.values()),
                initial_value=RANGE_LABELS[self._session.state.map_view.range_mode],
                hint="robust: shows the ordinary values, what explodes near a singularity is "
                "darker; full: from the smallest to the largest value; manual: as given",
            ),
            "range",
            self._choose_mode,
            lambda s: RANGE_LABELS[self._mode(s)],
        )
        self._ends = self._control(
            gui.add_vector2(
                "from–to" if self._brief else "ends",
                (0.0, 1.0),
                step=0.001,
                hint="Ends of the color range, in the unit of the color bar; editing them makes "
                "the range manual",
            ),
            "ends",
            self._set_ends,
            self._show_ends,
        )

    def shared(self) -> None:
        """Add the switch between one range for all panels and one for each."""
        self._control(
            self._session.client.gui.add_checkbox(
                "shared",
                self._session.state.map_view.shared,
                hint="One color range for all three maps, or one for each",
            ),
            "shared",
            lambda s, value: actions.set_map_view(s, shared=bool(value)),
            lambda s: s.map_view.shared,
        )

    def switches(self) -> None:
        """Add the switches for a logarithmic scale and for the difference."""
        gui, view = self._session.client.gui, self._session.state.map_view
        self._control(
            gui.add_checkbox(
                "log" if self._brief else "log scale",
                view.logarithmic,
                hint="Symmetric logarithm: linear around zero, logarithmic beyond, on both sides",
            ),
            "log",
            lambda s, value: actions.set_map_view(s, logarithmic=bool(value)),
            lambda s: s.map_view.logarithmic,
        )
        self._difference = self._control(
            gui.add_checkbox(
                "Δ ref." if self._brief else "Δ reference",
                view.difference,
                disabled=self._session.state.document.reference is None,
                hint="Show the difference from the pinned reference (pin one to use this)",
            ),
            "difference",
            self._set_difference,
            lambda s: s.map_view.difference,
        )

    def figure_3(self) -> None:
        """Add the preset of Fig. 3."""
        button = self._session.client.gui.add_button(
            "Fig. 3",
            hint="As the paper's Fig. 3: θ = 60°, three torques on one range",
        )
        button.on_click(lambda _: self._session.dispatch("figure 3", show_figure_3))

    def draw(self, frame: Frame, moving: bool) -> None:
        """Follow the state."""
        state = frame.state
        if self._ends is not None:
            self._set_steps(state)
        if self._difference is not None:
            disabled = state.document.reference is None
            if self._difference.disabled != disabled:
                self._difference.disabled = disabled
        for control in self._controls:
            control.draw(frame, moving)

    def _factor(self, state: State) -> float:
        return display_unit(self._unit(state)).factor

    def _mode(self, state: State) -> RangeMode:
        """Return how the range of this picture is found; a manual one may be in another unit."""
        view = state.map_view
        other = QUANTITIES[view.quantity].unit != self._unit(state)
        return RangeMode.AUTO if view.range_mode is RangeMode.MANUAL and other else view.range_mode

    def _shown_range(self, state: State) -> tuple[float, float]:
        """Return the range of the first panel as drawn last, in SI."""
        if self._mode(state) is RangeMode.MANUAL:
            return state.map_view.low, state.map_view.high
        if self._picture.scales:
            scale = self._picture.scales[0]
            return scale.low, scale.high
        return 0.0, 1.0

    def _show_ends(self, state: State) -> tuple[float, float]:
        low, high = self._shown_range(state)
        factor = self._factor(state)
        return float(f"{low * factor:.9g}"), float(f"{high * factor:.9g}")

    def _set_steps(self, state: State) -> None:
        low, high = self._show_ends(state)
        span = abs(high - low)
        step = ticks.nice_step(span, 100) if span > 0 else 0.001
        digits = int(min(max(-np.floor(np.log10(step)) + 1, 0), 9))
        if self._ends.step != step or self._ends.precision != digits:
            self._ends.step, self._ends.precision = step, digits

    def _choose_mode(self, state: State, label: object) -> State:
        mode = _key(RANGE_LABELS, label)
        if mode is not RangeMode.MANUAL:
            return actions.set_map_view(state, range_mode=mode)
        return self._manual(state, *self._shown_range(state))

    def _set_ends(self, state: State, value: tuple[float, float]) -> State:
        factor = self._factor(state)
        low, high = (float(end) / factor for end in value)
        if max(abs(low), abs(high)) > LARGEST_END:
            raise InvalidInput("color range", f"numbers up to {LARGEST_END:.0e} are possible")
        return self._manual(state, low, high)

    def _manual(self, state: State, low: float, high: float) -> State:
        """Use these ends; the state's range is in the unit of its quantity."""
        changes: dict[str, Any] = {"range_mode": RangeMode.MANUAL, "low": low, "high": high}
        if QUANTITIES[state.map_view.quantity].unit != self._unit(state):
            changes["quantity"] = "max_torque"
        return actions.set_map_view(state, **changes)

    def _set_difference(self, state: State, value: bool) -> State:
        if value and state.document.reference is None:
            raise InvalidInput("difference", "pin a reference design first")
        return actions.set_map_view(state, difference=bool(value))
