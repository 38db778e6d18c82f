"""Joint forces and bar loads on the page: what is shown, of which instant, and along the motion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from paminsa_viz.elastostatics.bar_loads import bar_loads, utilization
from paminsa_viz.elastostatics.joint_forces import JointForces, joint_forces
from paminsa_viz.elastostatics.motion_loads import MotionLoads, motion_loads
from paminsa_viz.elastostatics.sideways import sideways_forces
from paminsa_viz.explorer.core.place import Place
from paminsa_viz.explorer.core.planning import planned
from paminsa_viz.explorer.kit.task import Follower
from paminsa_viz.explorer.state.state import State
from paminsa_viz.kept import kept
from paminsa_viz.model import Design, PaminsaError
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.elastic import BARS
from paminsa_viz.trajectory import TrajectoryAnalysis

MOST_SAMPLES = 200_000
"""Most samples of a motion whose loads are computed: some 1 GB."""

Numbers = tuple[float, ...]


def is_current(state: State) -> bool:
    """Whether the last loads are those of the current design along the current motion."""
    document, outcome = state.document, state.loads.outcome
    trajectory = planned(document.motion, document.design).trajectory
    return (
        outcome is not None
        and outcome.job.trajectory is trajectory
        and outcome.job.design == document.design
    )


def found(state: State) -> MotionLoads | None:
    """Return the loads along the current motion, if they are wanted and known."""
    outcome = state.loads.outcome
    wanted = state.loads.settings.along and is_current(state)
    return outcome.result if outcome is not None and wanted else None


def find_loads(analysis: TrajectoryAnalysis, _: object) -> MotionLoads:
    """Compute the loads along a motion.

    Raises:
        PaminsaError: If it has none.
    """
    if analysis.trajectory.size > MOST_SAMPLES:
        raise PaminsaError(f"the motion has more than {MOST_SAMPLES:,} samples")
    loads = motion_loads(analysis)
    if loads is None:
        first = analysis.check.first
        reason = first.explanation if first is not None else "singular everywhere"
        raise PaminsaError(f"the motion has no start: it fails {reason}")
    for name in ("bar_peak", "utilization"):
        getattr(loads, name)  # computed here, on the job's thread
    return loads


ALONG_MOTION = Follower(
    Place(lambda state: state.loads.outcome),
    lambda frame: frame.analysis if frame.state.loads.settings.along else None,
    find_loads,
    idle=True,
)
"""Finds the loads along the current motion while they are wanted."""


@dataclass(frozen=True)
class Instant:
    """What the shown forces belong to.

    Attributes:
        design: The robot.
        pose, velocity, acceleration: (4,) of the platform.
        load: (6,) the motion's own load, or None.
        time: Of the motion that is played [s], or None at rest.
        motion: Name of that motion.
    """

    design: Design
    pose: Numbers
    velocity: Numbers = (0.0,) * 4
    acceleration: Numbers = (0.0,) * 4
    load: Numbers | None = None
    time: float | None = None
    motion: str = ""


def instant(state: State) -> Instant:
    """Return the instant that the robot shows: of the motion that it follows, or at rest."""
    document, here, time = state.document, state.last_reachable, state.playback.time
    design = state.shown_design
    trajectory = planned(document.motion, document.design).trajectory
    if trajectory is None or not state.playback.following:
        return Instant(design, here.pose)
    moved, load = trajectory.at(time), trajectory.load_at(np.array([time]))
    return Instant(
        design,
        here.pose,
        tuple(moved.velocity.tolist()),
        tuple(moved.acceleration.tolist()),
        None if load is None else tuple(load[0].tolist()),
        time,
        trajectory.name,
    )


@kept(8)
def forces_at(at: Instant) -> JointForces:
    """Return the joint forces at an instant."""
    return joint_forces(at.design, at.pose, at.velocity, at.acceleration, load=at.load)


@kept(8)
def bars_at(at: Instant) -> tuple[Array, Array]:
    """Return N, V, M of each bar that are largest in size, and the bars' utilization.

    Returns:
        (3 legs, 7 bars, 3) [N, N, N m] and (3, 7) [1], in the order of `elastic.BARS`.
    """
    forces = forces_at(at)
    inner = np.stack([bar_loads(forces, bar).extremes() for bar in BARS], axis=1)
    return inner, utilization(forces)


@kept(8)
def sideways_at(at: Instant) -> Array | None:
    """Return the sideways forces at the joints, (3 legs, 10) [N], or None for a moving robot.

    The legs' elasticity decides them; with inertia they are not known.
    """
    if at.time is not None:
        return None
    return sideways_forces(at.design, at.pose).force
