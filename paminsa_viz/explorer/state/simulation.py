"""What is computed of the motion in the background: its simulation, and an engine's torques.

The engine knows no formula of ours.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.engines import EngineMissing
from paminsa_viz.explorer.state.outcome import Outcome, TaskState
from paminsa_viz.explorer.state.settings import MILLIMETERS, Settings, followed, setting
from paminsa_viz.model import Design, Geometry
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.parameters import LARGEST
from paminsa_viz.model.resizing import length_ratio
from paminsa_viz.plots.series import EngineTorques
from paminsa_viz.trajectory import (
    Controller,
    ControlMode,
    Simulation,
    Trajectory,
    TrajectoryAnalysis,
)

if TYPE_CHECKING:
    from paminsa_viz.engines.verification import Comparison


@dataclass(frozen=True)
class SimulationSettings(Settings):
    """Robot and controller of a simulation.

    The default carries 5 kg that the controller does not know of, with gains so low that the robot
    is seen to sink below its path; see `sized_simulation` for robots of other lengths.

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
        3.0, "Bandwidth [Hz]", "Of the error’s own motion; the gains follow from it",
        range=(0.0, 50.0), step=0.5,
    )  # fmt: skip
    damping: float = setting(
        1.0, "Damping ratio", "Of the feedback; below 1 an error swings on",
        range=(0.0, 5.0), step=0.1,
    )  # fmt: skip
    payload_mismatch: float = setting(
        5.0, "Payload mismatch [kg]", "Payload of the robot beyond what the controller assumes",
        range=(-10_000.0, 10_000.0), step=0.1,
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


def sized_simulation(
    settings: SimulationSettings, was: Geometry, now: Geometry
) -> SimulationSettings:
    """Return settings whose payload mismatch follows the robot's lengths, unless it was chosen.

    It sinks in proportion to itself over the robot's mass: to be seen in a robot of other lengths,
    and not to leave its workspace, it is as the lengths to the fourth.
    """
    powers = {"payload_mismatch": (4, (0.0, LARGEST["kg"]))}
    return followed(settings, SimulationSettings(), powers, length_ratio(was), length_ratio(now))


@dataclass(frozen=True)
class SimulationJob:
    """What is simulated."""

    design: Design
    trajectory: Trajectory
    settings: SimulationSettings


@dataclass(frozen=True)
class SimulationState(TaskState[SimulationJob, Simulation]):
    """The simulation of a session.

    Attributes:
        settings: What a person set.
        shown: Whether the scene plays the simulated robot, next to where it should be.
    """

    settings: SimulationSettings = field(default_factory=SimulationSettings)
    shown: bool = True


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
        from paminsa_viz.engines.verification import Comparison  # late: loads much of SciPy

        computed = self.engine.pick(analysis.torque)[self._good]
        return Comparison(computed, self.engine.torque[self._good], self._scale)

    @cached_property
    def _good(self) -> NDArray[np.bool_]:
        return self.thinned.check.ok

    @cached_property
    def _scale(self) -> Array:
        from paminsa_viz.engines.verification import torque_scale

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
