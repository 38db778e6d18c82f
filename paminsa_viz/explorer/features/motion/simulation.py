"""The simulation of a motion: what is simulated, and what the scene does with it."""

from __future__ import annotations

from dataclasses import replace

from paminsa_viz.explorer.core.actions import with_document
from paminsa_viz.explorer.core.motion import planned, play
from paminsa_viz.explorer.core.place import Place
from paminsa_viz.explorer.core.simulated import shown_simulation
from paminsa_viz.explorer.kit.task import Task
from paminsa_viz.explorer.state.motion import SIMULATED
from paminsa_viz.explorer.state.outcome import Outcome
from paminsa_viz.explorer.state.simulation import SimulationJob
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model import InvalidInput
from paminsa_viz.progress import Progress
from paminsa_viz.trajectory import Simulation
from paminsa_viz.trajectory import simulate as simulate_motion
from paminsa_viz.units import format_value

LONGEST = 60.0
"""Longest motion that is simulated on the page [s]."""


def wanted_job(state: State) -> SimulationJob:
    """Return the simulation of the current state.

    Raises:
        InvalidInput: If there is no motion, or it is too long.
    """
    trajectory = planned(state).trajectory
    if trajectory is None:
        raise InvalidInput("motion", "there is none to simulate yet")
    if trajectory.duration > LONGEST:
        raise InvalidInput("motion", f"at most {LONGEST:g} s can be simulated here")
    return SimulationJob(state.document.design, trajectory, state.simulation.settings)


def run(job: SimulationJob, progress: Progress) -> Simulation:
    """Simulate.

    Raises:
        PaminsaError: If the robot cannot start, or its payload is not possible.
    """
    settings, model = job.settings, job.design
    if not settings.knows_friction:
        model = model.without_friction()
    known = model.payload.mass
    if known + settings.payload_mismatch < 0:
        least = format_value(-known, "kg", up=True)
        raise InvalidInput(
            "payload mismatch", f"at least {least} is needed: no payload is left then"
        )
    payload = replace(model.payload, mass=known + settings.payload_mismatch)
    return simulate_motion(
        replace(job.design, payload=payload), job.trajectory, model=model,
        controller=settings.controller(), offset=(settings.initial_error, 0.0, 0.0, 0.0),
        progress=progress,
    )  # fmt: skip


def receive(state: State, outcome: Outcome[SimulationJob, Simulation]) -> State:
    """Take over an outcome, and play it if it is of what is shown."""
    received = state.updated("simulation", outcome=outcome)
    if shown_simulation(received.document, received.simulation) is None:
        return with_document(received, received.document)
    return play(received.updated("playback", time=0.0))


SIMULATION = Task(
    Place(lambda state: state.simulation), wanted_job, run, receive=receive, undo=True
)
"""Simulates the robot on the current motion."""


def simulate(state: State) -> State:
    """Start a simulation of the current state, and show its curves.

    Raises:
        InvalidInput: If there is nothing to simulate, or one runs already.
    """
    if SIMULATION.runs(state):
        raise InvalidInput("simulation", "the last one still runs")
    if state.plots.plot not in SIMULATED:
        state = state.updated("plots", plot="errors")
    return SIMULATION.start(state)


def show_simulation(state: State, shown: bool) -> State:
    """Let the robot in the scene move as simulated, or as planned."""
    changed = state.updated("simulation", shown=shown)
    return with_document(changed, changed.document)
