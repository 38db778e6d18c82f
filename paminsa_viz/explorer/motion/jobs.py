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
from paminsa_viz.explorer.settings import MILLIMETERS, Settings, setting
from paminsa_viz.explorer.tasks import Outcome, TaskState
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
from paminsa_viz.units import number

LONGEST = 60.0
"""Longest motion that is simulated on the page [s]."""


@dataclass(frozen=True)
class SimulationSettings(Settings):
    """Robot and controller of a simulation.

    The default carries 5 kg that the controller does not know of, with gains so low that the robot
    is seen to sink below its path.

    Attributes:
        bandwidth: [Hz].
        payload_mismatch: [kg].
        initial_error: [m].
    """

    control: ControlMode = setting(
        ControlMode.PD, "Control",
        "Feed-forward alone has no feedback: the robot is unstable without it",
        options={
            "computed torque": ControlMode.COMPUTED_TORQUE,
            "feed-forward + PD": ControlMode.PD,
            "feed-forward alone": ControlMode.FEED_FORWARD,
        },
    )  # fmt: skip
    bandwidth: float = setting(
        3.0, "Bandwidth [Hz]", "Of the error's own motion; the gains follow from it",
        range=(0.0, 50.0), step=0.5,
    )  # fmt: skip
    damping: float = setting(1.0, "Damping ratio", range=(0.0, 5.0), step=0.1)
    payload_mismatch: float = setting(
        5.0, "Payload mismatch [kg]", "Payload of the robot beyond what the controller assumes",
        range=(-10.0, 50.0), step=0.1,
    )  # fmt: skip
    knows_friction: bool = setting(
        True, "Friction is known",
        "The friction itself is a number of the design, zero in the paper",
    )  # fmt: skip
    initial_error: float = setting(
        0.0, "Initial error [mm]", "Error of x at the start", range=(-0.1, 0.1), unit=MILLIMETERS
    )

    def controller(self) -> Controller:
        """Return the controller."""
        return Controller(self.control, self.bandwidth, self.damping)


@dataclass(frozen=True)
class SimulationJob:
    """What is simulated."""

    design: Design
    trajectory: Trajectory
    settings: SimulationSettings


@dataclass(frozen=True)
class Simulating(TaskState[SimulationJob, Simulation]):
    """The simulation of a session.

    Attributes:
        settings: What a person set.
        shown: Whether the scene plays the simulated robot, next to where it should be.
    """

    settings: SimulationSettings = field(default_factory=SimulationSettings)
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


def run(job: SimulationJob, _: object) -> Simulation:
    """Simulate.

    Raises:
        PaminsaError: If the robot cannot start, or its payload is not possible.
    """
    settings, model = job.settings, job.design
    if not settings.knows_friction:
        model = model.without_friction()
    known = model.payload.mass
    if known + settings.payload_mismatch < 0:
        raise InvalidInput(
            "payload mismatch", f"at least {number(-known)} kg is needed: no payload is left then"
        )
    payload = replace(model.payload, mass=known + settings.payload_mismatch)
    return simulate(
        replace(job.design, payload=payload), job.trajectory, model=model,
        controller=settings.controller(), offset=(settings.initial_error, 0.0, 0.0, 0.0),
    )  # fmt: skip


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


@dataclass(frozen=True)
class EngineRequest:
    """What an engine is asked: its torques along an analyzed motion."""

    analysis: TrajectoryAnalysis
    engine: str = "MuJoCo"


Answer = Outcome[EngineRequest, EngineAnswer]


def serves(answer: Answer, analysis: TrajectoryAnalysis, engine: str = "MuJoCo") -> bool:
    """Whether an answer holds for a design on a motion, of this engine.

    Where the engine is missing, it holds for all.
    """
    own = answer.job.analysis
    return answer.job.engine == engine and (
        isinstance(answer.error, EngineMissing)
        or (own.trajectory is analysis.trajectory and own.design == analysis.design)
    )


def ask_engine(request: EngineRequest, _: object) -> EngineAnswer:
    """Ask an engine for the torques of a design on a motion.

    Raises:
        PaminsaError: If there is no engine, or the robot cannot run the motion.
    """
    # Late: what engines need takes half a second to load.
    from paminsa_viz.engines.verification import TOLERANCE
    from paminsa_viz.plots.verified import engine_torques

    analysis, trajectory = request.analysis, request.analysis.trajectory
    count = min(trajectory.size, MOST_SAMPLES)
    kept = np.linspace(0, trajectory.size - 1, count).round().astype(np.intp)
    thinned = analyze(analysis.design, trajectory.take(kept))
    if not thinned.check.good.any():
        raise PaminsaError("the robot cannot run any of the motion")
    engine = replace(engine_torques(thinned, request.engine), samples=kept)
    return EngineAnswer(thinned, engine, TOLERANCE)
