"""Forward simulation of the motion: robot, controller, and what came of it."""

from __future__ import annotations

from html import escape
from typing import Any

import numpy as np
from viser import Icon

from paminsa_viz.explorer.background import BackgroundJob
from paminsa_viz.explorer.controls import Control
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.motion import actions as motions
from paminsa_viz.explorer.motion.simulation import SimulationJob, SimulationOutcome, run
from paminsa_viz.explorer.panels.debounced_input import DebouncedInput
from paminsa_viz.explorer.panels.tables import note
from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.state import State
from paminsa_viz.palette import BAD, MUTED, OK, WARN
from paminsa_viz.trajectory import ControlMode
from paminsa_viz.units import number

CONTROLS = {
    "computed torque": ControlMode.COMPUTED_TORQUE,
    "feed-forward + PD": ControlMode.PD,
    "feed-forward alone": ControlMode.FEED_FORWARD,
}


def _label(control: ControlMode) -> str:
    return next(label for label, known in CONTROLS.items() if known is control)


class SimulationInputs:
    """Settings, the button, and the outcome, in the current container."""

    def __init__(self, session: Session) -> None:
        gui = session.client.gui
        self._session = session
        self._job: BackgroundJob[SimulationJob, SimulationOutcome] = BackgroundJob(
            session, "simulation", lambda job, _: run(job), motions.receive_simulation,
            failed=lambda job, problem: SimulationOutcome(job, None, problem),
        )  # fmt: skip
        settings = session.state.simulating.settings
        control = gui.add_dropdown(
            "Control", tuple(CONTROLS), initial_value=_label(settings.control),
            hint="Feed-forward alone has no feedback: the robot is unstable without it",
        )  # fmt: skip
        self._feedback = [
            gui.add_number(
                "Bandwidth [Hz]", settings.bandwidth, min=0.0, max=50.0, step=0.5,
                hint="Of the error's own motion; the gains follow from it",
            ),
            gui.add_number("Damping ratio", settings.damping, min=0.0, max=5.0, step=0.1),
        ]  # fmt: skip
        load = gui.add_number(
            "Unknown load [kg]", settings.payload_mismatch, min=-10.0, max=50.0, step=0.1,
            hint="Payload of the robot that the controller does not know of",
        )  # fmt: skip
        offset = gui.add_number(
            "Start off by [mm]", 1e3 * settings.initial_error, min=-100.0, max=100.0, step=1.0,
            hint="Error of x at the start",
        )  # fmt: skip
        friction = gui.add_checkbox(
            "Controller knows the friction", settings.knows_friction,
            hint="The friction itself is a number of the design, zero in the paper",
        )  # fmt: skip
        self.run = gui.add_button("Simulate", icon=Icon.PLAYER_TRACK_NEXT)
        self.run.on_click(lambda _: session.dispatch("simulation", motions.simulate))
        self._outcome = gui.add_html("")
        self._controls = [
            Control(
                session, control, "simulation.control",
                lambda s, label: motions.set_simulation(s, control=CONTROLS[label]),
                lambda s: _label(s.simulating.settings.control),
            ),
            Control(
                session, friction, "simulation.friction",
                lambda s, value: motions.set_simulation(s, knows_friction=bool(value)),
                lambda s: s.simulating.settings.knows_friction,
            ),
            self._number(self._feedback[0], "bandwidth"),
            self._number(self._feedback[1], "damping"),
            self._number(load, "payload_mismatch"),
            self._number(offset, "initial_error", 1e3),
        ]  # fmt: skip

    def _number(self, handle: Any, name: str, factor: float = 1.0) -> Control:
        return DebouncedInput(
            self._session, handle, f"simulation.{name}",
            lambda s, value: motions.set_simulation(s, **{name: float(value) / factor}),
            lambda s: round(factor * getattr(s.simulating.settings, name), 9),
        )  # fmt: skip

    def draw(self, frame: Frame, moving: bool) -> None:
        """Follow the state, and begin what is asked for."""
        state = frame.state
        self._job.request(state.simulating.running)
        for control in self._controls:
            control.draw(frame, moving)
        feedback = state.simulating.settings.control is not ControlMode.FEED_FORWARD
        for handle in self._feedback:
            if handle.visible != feedback:
                handle.visible = feedback
        busy = state.simulating.running is not None
        if self.run.disabled != busy:
            self.run.disabled = busy
        html = outcome_html(state)
        if self._outcome.content != html:
            self._outcome.content = html


def outcome_html(state: State) -> str:
    """Say what came of the last simulation."""
    simulating = state.simulating
    if simulating.running is not None:
        return _block(MUTED, "Simulating …")
    outcome = simulating.outcome
    if outcome is None:
        return note("Errors and torques are plotted in “Motion plots”.", "simulation", muted=True)
    if outcome.simulation is None:
        return _block(BAD, f"<b>Not simulated</b><br>{escape(outcome.problem)}")
    simulation = outcome.simulation
    drift = float(np.abs(simulation.energy_drift).max())
    lines = [
        f"largest distance {number(1e3 * float(simulation.distance.max()), 3)} mm, "
        f"at the end {number(1e3 * float(simulation.distance[-1]), 3)} mm",
        f"energy drift of the solution {number(drift, 2)} J",
    ]
    color, head = OK, f"Ran to the end, {simulation.t[-1]:.3f} s"
    if simulation.stopped is not None:
        color, head = BAD, f"Stopped {escape(simulation.stopped.explanation)}"
    if not motions.simulation_is_current(state):
        color = WARN if simulation.stopped is None else color
        lines.append("<b>of an earlier design, motion or setting: simulate again</b>")
    return _block(color, f"<b>{head}</b><br>" + "<br>".join(lines))


def _block(color: str, html: str) -> str:
    return (
        f'<div data-testid="simulation" style="border-left:5px solid {color};padding:4px 9px;'
        f"margin:2px 10px 6px 10px;background:{color}18;border-radius:4px;font-size:12.5px;"
        f'line-height:1.35">{html}</div>'
    )
