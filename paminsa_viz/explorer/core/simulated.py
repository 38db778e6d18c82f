"""The simulated motion in the scene: where the robot is, and where it should be."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from paminsa_viz.explorer.core.planning import planned, pose_at
from paminsa_viz.explorer.state.document import Document
from paminsa_viz.explorer.state.simulation import SimulationState
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model.arrays import Pose
from paminsa_viz.trajectory import Simulation


def shown_simulation(document: Document, own: SimulationState) -> Simulation | None:
    """Return the simulation that is played, or None where the motion itself is.

    An outcome of another design or motion is not shown.
    """
    outcome = own.outcome
    if not own.shown or outcome is None or outcome.result is None:
        return None
    job = outcome.job
    trajectory = planned(document.motion, document.design).trajectory
    if job.trajectory is not trajectory or job.design != document.design:
        return None
    return outcome.result


def simulated_pose(simulation: Simulation, time: float) -> Pose:
    """Return the simulated pose at a time [s]; the last one once it has stopped."""
    x, y, theta, z = (
        float(np.interp(time, simulation.t, simulation.pose[:, axis])) for axis in range(4)
    )
    return (x, y, theta, z)


def at_instant(document: Document, own: SimulationState, time: float) -> Document:
    """Return a document with the pose of its motion at a time [s], or of the simulated one.

    It is the same where there is none, and where the robot cannot be.
    """
    found = planned(document.motion, document.design)
    if found.trajectory is None:
        return document
    simulation = shown_simulation(document, own)
    if simulation is not None:
        return replace(document, pose=simulated_pose(simulation, time))
    pose = pose_at(found.trajectory, document.design.geometry, time)
    return document if pose is None else replace(document, pose=pose)


def wanted_pose(state: State) -> Pose | None:
    """Return where the robot should be while a simulation is shown; None where none is."""
    simulation = shown_simulation(state.document, state.simulation)
    if simulation is None or not state.playback.following:
        return None
    trajectory = planned(state.document.motion, state.document.design).trajectory
    assert trajectory is not None
    x, y, theta, z = (float(value) for value in trajectory.at(state.playback.time).pose)
    return (x, y, theta, z)
