"""The inputs of a simulation, and what came of the last one."""

from __future__ import annotations

from viser import Icon

from paminsa_viz.explorer.entries import Button, Condition, Entry, Html
from paminsa_viz.explorer.inputs import MILLIMETERS, PLAIN, Checkbox, Dropdown, Number, attribute
from paminsa_viz.explorer.motion import actions as motions
from paminsa_viz.explorer.motion.simulation import (
    BANDWIDTHS,
    DAMPINGS,
    INITIAL_ERRORS,
    PAYLOAD_MISMATCHES,
)
from paminsa_viz.explorer.panels import motion_text as text
from paminsa_viz.explorer.state import State
from paminsa_viz.trajectory import ControlMode
from paminsa_viz.units import DisplayUnit


def _setting(
    name: str, label: str, limits: tuple[float, float], step: float, hint: str,
    unit: DisplayUnit = PLAIN, visible: Condition | None = None,
) -> Number:  # fmt: skip
    """Return the input of one number of the simulation, with limits in SI."""
    low, high = (unit.from_si(limit) for limit in limits)
    return Number(
        f"simulation.{name}", label, range=(low, high), step=step, unit=unit, hint=hint,
        visible=visible, read=lambda state: getattr(state.simulating.settings, name),
        apply=lambda state, value: motions.set_simulation(state, **{name: value}),
    )  # fmt: skip


def _has_feedback(state: State) -> bool:
    return state.simulating.settings.control is not ControlMode.FEED_FORWARD


SIMULATION: tuple[Entry, ...] = (
    Dropdown(
        "simulation.control", "Control",
        options={
            "computed torque": ControlMode.COMPUTED_TORQUE,
            "feed-forward + PD": ControlMode.PD,
            "feed-forward alone": ControlMode.FEED_FORWARD,
        },
        hint="Feed-forward alone has no feedback: the robot is unstable without it",
        **attribute("simulating.settings.control", motions.set_simulation),
    ),
    _setting(
        "bandwidth", "Bandwidth [Hz]", BANDWIDTHS, 0.5,
        "Of the error's own motion; the gains follow from it", visible=_has_feedback,
    ),
    _setting("damping", "Damping ratio", DAMPINGS, 0.1, "", visible=_has_feedback),
    _setting(
        "payload_mismatch", "Payload mismatch [kg]", PAYLOAD_MISMATCHES, 0.1,
        "Payload of the robot beyond what the controller assumes",
    ),
    _setting(
        "initial_error", "Initial error [mm]", INITIAL_ERRORS, 1.0, "Error of x at the start",
        unit=MILLIMETERS,
    ),
    Checkbox(
        "simulation.friction", "Controller knows the friction",
        hint="The friction itself is a number of the design, zero in the paper",
        **attribute("simulating.settings.knows_friction", motions.set_simulation),
    ),
    Button(
        "simulation", "Simulate", icon=Icon.PLAYER_TRACK_NEXT, effect=motions.simulate,
        disabled=lambda state: state.simulating.running is not None,
    ),
    Html("simulation.outcome", content=lambda frame: text.simulation_html(frame.state)),
)  # fmt: skip
