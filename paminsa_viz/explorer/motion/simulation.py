"""Forward simulation of the motion: what is asked for, and a run of it beside the page."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from paminsa_viz.model import Design, InvalidInput, PaminsaError
from paminsa_viz.trajectory import Controller, ControlMode, Simulation, Trajectory, simulate

BANDWIDTHS = (0.0, 50.0)
"""Lowest and highest bandwidth of the controller [Hz]."""
DAMPINGS = (0.0, 5.0)
PAYLOAD_MISMATCHES = (-10.0, 50.0)
"""How much lighter or heavier the carried payload may be than the controller takes it for [kg]."""

INITIAL_ERRORS = (-0.1, 0.1)
"""Error of x at the start [m]."""

LONGEST = 60.0
"""Longest motion that is simulated on the page [s]."""


@dataclass(frozen=True)
class SimulationSettings:
    """Robot and controller of a simulation.

    Attributes:
        control: How the actuators are commanded.
        bandwidth: Of the error's own motion [Hz].
        damping: Its damping ratio.
        payload_mismatch: Payload that the controller does not know of [kg].
        knows_friction: Whether the controller makes up for the design's friction.
        initial_error: Error of x at the start [m].
    """

    control: ControlMode = ControlMode.PD
    bandwidth: float = 8.0
    damping: float = 1.0
    payload_mismatch: float = 0.0
    knows_friction: bool = True
    initial_error: float = 0.0

    def controller(self) -> Controller:
        """Return the controller."""
        return Controller(self.control, self.bandwidth, self.damping)


@dataclass(frozen=True, eq=False)
class SimulationJob:
    """What was simulated, to tell whether a result is still that of the present state."""

    design: Design
    trajectory: Trajectory
    settings: SimulationSettings

    def same(self, other: SimulationJob) -> bool:
        """Whether another job has the same result."""
        return (
            self.trajectory is other.trajectory
            and self.settings == other.settings
            and self.design == other.design
        )


@dataclass(frozen=True, eq=False)
class SimulationOutcome:
    """What came of a job: a simulation, or why there is none."""

    job: SimulationJob
    simulation: Simulation | None
    problem: str = ""


@dataclass(frozen=True)
class Simulating:
    """The simulation of a session.

    Attributes:
        settings: What a person set.
        running: The job that runs, or None.
        outcome: The last result, or None.
    """

    settings: SimulationSettings = field(default_factory=SimulationSettings)
    running: SimulationJob | None = None
    outcome: SimulationOutcome | None = None


def make_job(
    design: Design, trajectory: Trajectory | None, settings: SimulationSettings
) -> SimulationJob:
    """Return a job.

    Raises:
        InvalidInput: If there is no motion, or it is too long.
    """
    if trajectory is None:
        raise InvalidInput("motion", "there is none to simulate yet")
    if trajectory.duration > LONGEST:
        raise InvalidInput("motion", f"at most {LONGEST:g} s can be simulated here")
    return SimulationJob(design, trajectory, settings)


def run(job: SimulationJob) -> SimulationOutcome:
    """Simulate; raises nothing that is the robot's or the person's fault."""
    settings, model = job.settings, job.design
    if not settings.knows_friction:
        model = model.without_friction()
    try:
        payload = replace(model.payload, mass=model.payload.mass + settings.payload_mismatch)
        simulation = simulate(
            replace(job.design, payload=payload), job.trajectory, model=model,
            controller=settings.controller(), offset=(settings.initial_error, 0.0, 0.0, 0.0),
        )  # fmt: skip
        return SimulationOutcome(job, simulation)
    except PaminsaError as error:
        return SimulationOutcome(job, None, str(error))
