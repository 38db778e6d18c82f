"""The torques along the motion beside those of a physics engine, which knows no formula of ours."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.engines import EngineMissing
from paminsa_viz.engines.comparison import Comparison, torque_scale
from paminsa_viz.model import PaminsaError
from paminsa_viz.model.arrays import Array
from paminsa_viz.plots.series import EngineTorques
from paminsa_viz.trajectory import Trajectory, TrajectoryAnalysis, analyze

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
class Answer:
    """What came of asking the engine.

    Attributes:
        analysis: The design on the motion that it was asked about.
        found: Its torques, or None.
        problem: Why there are none, in words.
        missing: Whether that is because there is no engine here, whatever the design.
    """

    analysis: TrajectoryAnalysis
    found: EngineAnswer | None
    problem: str = ""
    missing: bool = False

    def serves(self, analysis: TrajectoryAnalysis) -> bool:
        """Whether it holds for a design on a motion, and is not another's."""
        own = self.analysis
        return self.missing or (
            own.trajectory is analysis.trajectory and own.design == analysis.design
        )


def ask_engine(analysis: TrajectoryAnalysis) -> Answer:
    """Ask the engine for the torques of a design on a motion."""
    # Late: what engines need takes half a second to load.
    from paminsa_viz.engines.verification import TOLERANCE
    from paminsa_viz.plots.verified import engine_torques

    try:
        kept, motion = _thinned(analysis.trajectory)
        thinned = analyze(analysis.design, motion)
        if not thinned.check.good.any():
            return Answer(analysis, None, "the robot cannot run any of the motion")
        engine = replace(engine_torques(thinned), samples=kept)
        return Answer(analysis, EngineAnswer(thinned, engine, TOLERANCE))
    except EngineMissing as error:
        return Answer(analysis, None, str(error), missing=True)
    except PaminsaError as error:
        return Answer(analysis, None, str(error))


def _thinned(trajectory: Trajectory) -> tuple[NDArray[np.intp], Trajectory]:
    """Return evenly spread samples, both ends among them, and the motion of these alone."""
    count = min(trajectory.size, MOST_SAMPLES)
    kept = np.linspace(0, trajectory.size - 1, count).round().astype(np.intp)
    return kept, trajectory.take(kept)
