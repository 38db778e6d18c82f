"""What is computed of the motion in the background: its simulation, and an engine's torques.

The engine knows no formula of ours.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.engines import EngineMissing
from paminsa_viz.engines.comparison import Comparison, torque_scale
from paminsa_viz.model import Design, InvalidInput, PaminsaError
from paminsa_viz.model.arrays import Array
from paminsa_viz.plots.series import EngineTorques
from paminsa_viz.trajectory import (
    Controller,
    ControlMode,
    Simulation,
    Trajectory,
    TrajectoryAnalysis,
    analyze,
    simulate,
)

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

    The default carries 5 kg that the controller does not know of, with gains so low that the robot
    is seen to sink below its path.

    Attributes:
        control: How the actuators are commanded.
        bandwidth: Of the error's own motion [Hz].
        damping: Its damping ratio.
        payload_mismatch: Payload that the controller does not know of [kg].
        knows_friction: Whether the controller makes up for the design's friction.
        initial_error: Error of x at the start [m].
    """

    control: ControlMode = ControlMode.PD
    bandwidth: float = 3.0
    damping: float = 1.0
    payload_mismatch: float = 5.0
    knows_friction: bool = True
    initial_error: float = 0.0

    def controller(self) -> Controller:
        """Return the controller."""
        return Controller(self.control, self.bandwidth, self.damping)


@dataclass(frozen=True, eq=False)
class SimulationJob:
    """What was simulated, to compare a result with the current state."""

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
        shown: Whether the scene plays the simulated robot, next to where it should be.
    """

    settings: SimulationSettings = field(default_factory=SimulationSettings)
    running: SimulationJob | None = None
    outcome: SimulationOutcome | None = None
    shown: bool = True


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


MOST_SAMPLES = 250
"""Samples of a motion that the engine computes, in equal distance; it takes a tenth of a second."""


@dataclass(frozen=True, eq=False)
class EngineAnswer:
    """An engine's torques along a motion.

    Attributes:
        thinned: The formulas' torques at the k samples that were computed.
        engine: The engine's torques there, joint friction added; NaN where the motion fails.
        tolerance: Largest difference over an actuator's largest torque that passes.
    """

    thinned: TrajectoryAnalysis
    engine: EngineTorques
    tolerance: float

    def comparison(self, analysis: TrajectoryAnalysis) -> Comparison:
        """Return the comparison at the samples where the motion does not fail.

        Args:
            analysis: The same design on the whole motion, some formulas perhaps as published.
        """
        computed = self.engine.pick(analysis.torque)[self._good]
        return Comparison(computed, self.engine.torque[self._good], self._scale)

    @cached_property
    def _good(self) -> NDArray[np.bool_]:
        return self.thinned.check.good

    @cached_property
    def _scale(self) -> Array:
        thinned, good = self.thinned, self._good
        poses = thinned.trajectory.pose[good]
        return torque_scale(thinned.design, poses, self.engine.torque[good])


@dataclass(frozen=True, eq=False)
class EngineRequest:
    """What an engine is asked: its torques along an analyzed motion."""

    analysis: TrajectoryAnalysis
    engine: str = "MuJoCo"


@dataclass(frozen=True, eq=False)
class Answer:
    """What came of asking an engine.

    Attributes:
        request: What it was asked.
        found: Its torques, or None.
        problem: Why there are none.
        missing: Whether that is because there is no engine here, whatever the design.
    """

    request: EngineRequest
    found: EngineAnswer | None
    problem: str = ""
    missing: bool = False

    def serves(self, analysis: TrajectoryAnalysis, engine: str = "MuJoCo") -> bool:
        """Whether it holds for a design on a motion, of this engine, and is not another's."""
        own = self.request.analysis
        return self.request.engine == engine and (
            self.missing
            or (own.trajectory is analysis.trajectory and own.design == analysis.design)
        )


def ask_engine(request: EngineRequest) -> Answer:
    """Ask an engine for the torques of a design on a motion."""
    # Late: what engines need takes half a second to load.
    from paminsa_viz.engines.verification import TOLERANCE
    from paminsa_viz.plots.verified import engine_torques

    analysis = request.analysis
    try:
        trajectory = analysis.trajectory
        count = min(trajectory.size, MOST_SAMPLES)
        kept = np.linspace(0, trajectory.size - 1, count).round().astype(np.intp)
        thinned = analyze(analysis.design, trajectory.take(kept))
        if not thinned.check.good.any():
            return Answer(request, None, "the robot cannot run any of the motion")
        engine = replace(engine_torques(thinned, request.engine), samples=kept)
        return Answer(request, EngineAnswer(thinned, engine, TOLERANCE))
    except EngineMissing as error:
        return Answer(request, None, str(error), missing=True)
    except PaminsaError as error:
        return Answer(request, None, str(error))
