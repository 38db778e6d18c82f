"""Asks an independent physics engine for the torques along a motion."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from paminsa_viz.explorer.state.simulation import EngineAnswer, EngineRequest
from paminsa_viz.model import PaminsaError
from paminsa_viz.trajectory import (
    analyze,
)

MOST_SAMPLES = 250
"""Samples of a motion that the engine computes, in equal distance; it takes a tenth of a second."""


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
    if not thinned.check.ok.any():
        raise PaminsaError("the robot cannot run any of the motion")
    engine = replace(engine_torques(thinned, request.engine), samples=kept)
    return EngineAnswer(thinned, engine, TOLERANCE)
