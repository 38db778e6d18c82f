"""Joint forces and bar loads on the page: what is shown, of which instant, and along the motion."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from paminsa_viz.elastostatics.bar_loads import BAR_NAMES, bar_loads, utilization
from paminsa_viz.elastostatics.joint_forces import JOINTS, JointForces, joint_forces
from paminsa_viz.elastostatics.motion_loads import MotionLoads, motion_loads
from paminsa_viz.elastostatics.sideways import sideways_forces
from paminsa_viz.explorer.settings import setting
from paminsa_viz.explorer.tasks import Outcome
from paminsa_viz.model import Design, PaminsaError
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.elastic import BARS
from paminsa_viz.trajectory import TrajectoryAnalysis

MOST_SAMPLES = 200_000
"""Most samples of a motion whose loads are computed: some 1 GB."""

Numbers = tuple[float, ...]


LoadsOutcome = Outcome[TrajectoryAnalysis, MotionLoads]


@dataclass(frozen=True)
class LoadsState:
    """What the tab *Loads* shows.

    Attributes:
        leg: Index of the leg, 0 to 2.
        outcome: The last loads along a motion, or None.
    """

    leg: int = setting(
        0, "Leg", "Whose joints and bars are listed", options={f"leg {i + 1}": i for i in range(3)}
    )
    bar: str = setting(
        "b4", "Bar", "Axial force, shear force and bending moment along it",
        options={name: bar for bar, name in BAR_NAMES.items()},
    )  # fmt: skip
    joint: str = setting(
        "2", "Joint", "Whose force is plotted, of all legs",
        options={f"joint {j.label}" if j.key[0].isdigit() else j.label: j.key for j in JOINTS},
    )  # fmt: skip
    along: bool = setting(
        False, "Along the motion",
        "Peak, RMS and equivalent load of every joint on the current motion",
    )  # fmt: skip
    outcome: LoadsOutcome | None = None


def find_loads(analysis: TrajectoryAnalysis, _: object) -> MotionLoads:
    """Compute the loads along a motion.

    Raises:
        PaminsaError: If it has none.
    """
    if analysis.trajectory.size > MOST_SAMPLES:
        raise PaminsaError(f"the motion has more than {MOST_SAMPLES:,} samples")
    found = motion_loads(analysis)
    if found is None:
        first = analysis.check.first
        reason = first.explanation if first is not None else "singular everywhere"
        raise PaminsaError(f"the motion has no start: it fails {reason}")
    for name in ("bar_peak", "utilization"):
        getattr(found, name)  # computed here, on the job's thread
    return found


@dataclass(frozen=True)
class Instant:
    """What the shown forces belong to.

    Attributes:
        design: The robot.
        pose, velocity, acceleration: (4,) of the platform.
        load: (6,) the motion's own load, or None.
        time: Of the motion that is played [s], or None at rest.
    """

    design: Design
    pose: Numbers
    velocity: Numbers = (0.0,) * 4
    acceleration: Numbers = (0.0,) * 4
    load: Numbers | None = None
    time: float | None = None


def instant(
    design: Design, pose: Array, analysis: TrajectoryAnalysis | None, time: float
) -> Instant:
    """Return the state of the robot: that of a motion at a time [s], or at rest without one."""
    here = tuple(map(float, pose))
    if analysis is None or len(here) != 4:
        return Instant(design, here)
    trajectory = analysis.trajectory
    state, load = trajectory.at(time), trajectory.load_at(np.array([time]))
    return Instant(
        design,
        here,
        tuple(state.velocity.tolist()),
        tuple(state.acceleration.tolist()),
        None if load is None else tuple(load[0].tolist()),
        time,
    )


@lru_cache(maxsize=8)
def forces_at(found: Instant) -> JointForces:
    """Return the joint forces at an instant."""
    return joint_forces(
        found.design, found.pose, found.velocity, found.acceleration, load=found.load
    )


@lru_cache(maxsize=8)
def bars_at(found: Instant) -> tuple[Array, Array]:
    """Return N, V, M of each bar that are largest in size, and the bars' utilization.

    Returns:
        (3 legs, 7 bars, 3) [N, N, N m] and (3, 7) [1], in the order of `elastic.BARS`.
    """
    forces = forces_at(found)
    inner = np.stack([bar_loads(forces, bar).extremes() for bar in BARS], axis=1)
    return inner, utilization(forces)


@lru_cache(maxsize=8)
def sideways_at(found: Instant) -> Array | None:
    """Return the sideways forces at the joints, (3 legs, 10) [N], or None for a moving robot.

    The legs' elasticity decides them; with inertia they are not known.
    """
    if found.time is not None:
        return None
    return sideways_forces(found.design, found.pose).force
