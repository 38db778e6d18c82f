"""The dock: torque maps, the map of one quantity, the motion's curves, the export."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core.maps import choose_quantity
from paminsa_viz.explorer.features.maps.pictures import MapPicture
from paminsa_viz.explorer.features.pins.tab import pin
from paminsa_viz.explorer.kit.entries import Button, ButtonGroup, Entry
from paminsa_viz.explorer.kit.inputs import Checkbox, Dropdown, Pair, attribute
from paminsa_viz.explorer.kit.setting_inputs import quantity_inputs
from paminsa_viz.explorer.state.maps import RangeMode
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model import InvalidInput
from paminsa_viz.plots import ticks
from paminsa_viz.plots.ranges import LARGEST_END
from paminsa_viz.quantities import QUANTITIES
from paminsa_viz.units import display_unit

FIG_3_ANGLE = np.pi / 3
"""Angle of the platform in the paper's Fig. 3 [rad]; it does not say the height."""

Ends = tuple[float, float]


def show_figure_3(state: State) -> State:
    """Turn the platform to the angle of Fig. 3 and show the torques as it does.

    The position stays if the robot can take it at that angle, else the platform goes to the
    middle.
    """
    shown = state.updated("map_view", range_mode=RangeMode.AUTO, shared=True, difference=False)
    turned = actions.move(shown, theta=FIG_3_ANGLE)
    if turned.last_reachable.pose != turned.document.pose:
        turned = actions.move(shown, x=0.0, y=0.0, theta=FIG_3_ANGLE)
    return turned


def set_difference(state: State, value: bool) -> State:
    """Show the difference from the reference or not.

    Raises:
        InvalidInput: If no reference is pinned.
    """
    if value and state.document.reference is None:
        raise InvalidInput("difference", "pin a reference design first")
    return state.updated("map_view", difference=value)


def range_entries(
    name: str, picture: MapPicture, unit: Callable[[State], str]
) -> tuple[Entry, Entry]:
    """Return the color range of a picture: how it is found, and its ends.

    Args:
        name: Name of the picture, for the entries' keys.
        picture: The picture; the ends show the range that it shows.
        unit: SI unit of what it shows.
    """

    def another_unit(state: State) -> bool:
        return QUANTITIES[state.map_view.quantity].unit != unit(state)

    def mode(state: State) -> RangeMode:
        """Return how the range is found; a manual one may be in another unit."""
        chosen = state.map_view.range_mode
        return RangeMode.AUTO if chosen is RangeMode.MANUAL and another_unit(state) else chosen

    def shown_range(state: State) -> Ends:
        """Return the range of the first panel as drawn last, in SI."""
        if mode(state) is RangeMode.MANUAL:
            return state.map_view.low, state.map_view.high
        scale = picture.scales[0] if picture.scales else None
        return (scale.low, scale.high) if scale else (0.0, 1.0)

    def set_manual(state: State, ends: Ends) -> State:
        """Use these ends; the state's range is in the unit of its quantity."""
        quantity = "max_torque" if another_unit(state) else state.map_view.quantity
        return state.updated(
            "map_view", range_mode=RangeMode.MANUAL, low=ends[0], high=ends[1], quantity=quantity
        )

    def choose_mode(state: State, chosen: RangeMode) -> State:
        if chosen is RangeMode.MANUAL:
            return set_manual(state, shown_range(state))
        return state.updated("map_view", range_mode=chosen)

    def displayed(state: State) -> Ends:
        factor = display_unit(unit(state)).factor
        low, high = (float(f"{end * factor:.9g}") for end in shown_range(state))
        return low, high

    def set_displayed(state: State, ends: Ends) -> State:
        factor = display_unit(unit(state)).factor
        low, high = (end / factor for end in ends)
        if max(abs(low), abs(high)) > LARGEST_END:
            raise InvalidInput("color range", f"numbers up to {LARGEST_END:.0e} are possible")
        return set_manual(state, (low, high))

    def step(state: State) -> float:
        low, high = displayed(state)
        return ticks.nice_step(abs(high - low), 100) if low != high else 0.001

    return (
        Dropdown(
            f"{name}.range", "Color range",
            options={
                "robust": RangeMode.AUTO, "full": RangeMode.FULL, "held": RangeMode.MANUAL
            },
            hint="robust: the ordinary values, of the reference too where there is one; what grows "
            "without bound near a singularity is darker; full: from the smallest to the largest "
            "value; held: stays as it is, whatever is changed, and its ends can be typed",
            read=mode, apply=choose_mode,
        ),
        Pair(
            f"{name}.ends", "Ends",
            hint="Ends of the color range, in the unit of the color bar; editing them holds "
            "the range",
            step=step,
            precision=lambda state: int(np.clip(1 - np.floor(np.log10(step(state))), 0, 9)),
            read=displayed, apply=set_displayed,
        ),
    )  # fmt: skip


def switch_entries(name: str) -> tuple[Entry, Entry]:
    """Return the switches for a logarithmic scale and for the difference."""
    return (
        Checkbox(
            f"{name}.log", "Log scale",
            hint="Symmetric logarithm: linear around zero, logarithmic beyond, on both sides",
            **attribute("map_view.logarithmic"),
        ),
        Checkbox(
            f"{name}.difference", "Difference",
            hint="Show the difference from the pinned reference (pin one to use this)",
            disabled=lambda state: state.document.reference is None,
            read=lambda state: state.map_view.difference, apply=set_difference,
        ),
    )  # fmt: skip


def torque_entries(name: str, picture: MapPicture) -> tuple[Entry, ...]:
    """Return the entries below the three torque maps."""
    return (
        *range_entries(name, picture, lambda _: QUANTITIES["tau_1"].unit),
        Checkbox(
            f"{name}.shared", "Shared",
            hint="One color range for all three maps, or one for each",
            **attribute("map_view.shared"),
        ),
        *switch_entries(name),
        Button(
            f"{name}.figure_3", "Fig. 3", effect=show_figure_3,
            hint="As the paper’s Fig. 3: θ = 60°, three torques on one range",
        ),
    )  # fmt: skip


def single_entries(name: str, picture: MapPicture) -> tuple[Entry, ...]:
    """Return the entries next to the map of one quantity."""
    return (
        *quantity_inputs(
            name, ("Family", "Show"), lambda state: state.map_view.quantity, choose_quantity,
            "What this map and the floor map below the robot show",
        ),
        *range_entries(
            name, picture, lambda state: QUANTITIES[state.map_view.quantity].unit
        ),
        *switch_entries(name),
        ButtonGroup(
            f"{name}.pin", "Strip",
            choices={"Pin": lambda state: pin(state, state.map_view.quantity)},
            hint="Its value at the pose, above all tabs; so does a click on a dotted number",
        ),
    )  # fmt: skip
