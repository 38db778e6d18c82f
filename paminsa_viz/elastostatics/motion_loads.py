"""Joint forces and bar loads along a motion: peak, RMS, and the bearings' equivalent load.

The equivalent load is the constant force that wears a bearing as much,

    F_eq = (integral F^3 |w| dt / integral |w| dt)^(1/3),

with w the angular velocity of one body against the other, as rolling bearings' life goes with the
third power of the load and with the turns under it (ISO 281; for the guide ISO 14728: its sliding
speed takes the place of w).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from paminsa_viz.checks import kinds_checked
from paminsa_viz.elastostatics.bar_loads import bar_loads, utilization
from paminsa_viz.elastostatics.joint_forces import JOINTS, JointForces, joint_forces
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.elastic import BARS
from paminsa_viz.trajectory.analysis import TrajectoryAnalysis
from paminsa_viz.trajectory.integrals import rms, running_integral
from paminsa_viz.trajectory.sampled import Trajectory

EXPONENT = 3
"""Of the load in the life of a ball bearing, or of a guide with balls."""


def relative_speed(forces: JointForces, turn_rate: Array) -> Array:
    """Return how fast each joint turns, or the guide slides, (n, 3 legs, 10) [rad/s, m/s].

    Args:
        forces: Joint forces of a list of n states.
        turn_rate: (n,) theta' of the platform [rad/s].
    """
    q, k = forces.bodies.motion, forces.design.geometry.magnification
    knee = q.psi_rate - q.phi_rate
    speeds = {
        "m": q.beta_rate, "guide": q.rho_rate / (k - 1),
        "8_b8": q.phi_rate, "8_b7": q.psi_rate,
        "9": knee, "4": knee, "7": knee, "3": q.phi_rate, "2": q.beta_rate,
        # B4 turns about w by -psi' and about z by theta_k', the platform about z by theta'
        "5": np.hypot(q.psi_rate, q.beta_rate - turn_rate[:, None]),
    }  # fmt: skip
    return np.stack([np.abs(speeds[joint.key]) for joint in JOINTS], axis=-1)


@dataclass(frozen=True, eq=False)
class MotionLoads:
    """Forces along a motion up to its first failure; n samples.

    Attributes:
        design: The robot.
        trajectory: The motion, up to where it first fails.
        forces: Joint forces at the samples, batch shape (n,).
    """

    design: Design
    trajectory: Trajectory
    forces: JointForces

    @cached_property
    def magnitude(self) -> Array:
        """Forces at the joints in the leg's plane, at joint 5 in space, (n, 3 legs, 10) [N]."""
        return self.forces.magnitude

    @cached_property
    def peak(self) -> Array:
        """Largest force at each joint, (3 legs, 10) [N]."""
        return self.magnitude.max(axis=0)

    @cached_property
    def peak_time(self) -> Array:
        """When it is largest, (3 legs, 10) [s]."""
        return self.trajectory.t[self.magnitude.argmax(axis=0)]

    @cached_property
    def rms(self) -> Array:
        """Root mean square over time, (3 legs, 10) [N]."""
        return rms(self.trajectory.t, self.magnitude)

    @cached_property
    def speed(self) -> Array:
        """Relative speeds, see `relative_speed`, (n, 3 legs, 10) [rad/s, m/s]."""
        return relative_speed(self.forces, self.trajectory.velocity[:, 2])

    @cached_property
    def travel(self) -> Array:
        """How far each joint turns or slides in all, (3 legs, 10) [rad, m]."""
        return running_integral(self.trajectory.t, self.speed)[-1]

    @cached_property
    def equivalent(self) -> Array:
        """Equivalent loads, (3 legs, 10) [N]; NaN at a joint that does not turn."""
        t, still = self.trajectory.t, np.isclose(self.speed.max(axis=0), 0.0, atol=1e-12)
        worn = running_integral(t, self.magnitude**EXPONENT * self.speed)[-1]
        with np.errstate(all="ignore"):
            mean = np.maximum(worn, 0.0) / self.travel
        return np.where(still, np.nan, mean ** (1 / EXPONENT))

    @cached_property
    def bars(self) -> Array:
        """N, V and M of each bar that are largest in size, (n, 3 legs, 7, 3) [N, N, N m]."""
        return np.stack([bar_loads(self.forces, bar).extremes() for bar in BARS], axis=-2)

    @cached_property
    def bar_peak(self) -> Array:
        """N, V and M of each bar that are largest in size on the motion, (3 legs, 7, 3)."""
        best = np.abs(self.bars).argmax(axis=0)[None]
        return np.take_along_axis(self.bars, best, axis=0)[0]

    @cached_property
    def utilization(self) -> Array:
        """Stress over yield stress in the leg's plane, (n, 3 legs, 7) [1]."""
        return utilization(self.forces)


@kinds_checked
def motion_loads(analysis: TrajectoryAnalysis) -> MotionLoads | None:
    """Return the loads of an analyzed motion up to its first failure; None if it has no start.

    The motion's own load acts on top of the design's. Where the motion crosses a singularity as
    planned, samples too near to it for a number are left out. A single sample is no motion.
    """
    until = analysis.check.until
    if until < 2:
        return None
    part = analysis.trajectory.take(np.arange(until))
    forces = joint_forces(
        analysis.design, part.pose, part.velocity, part.acceleration, load=part.load
    )
    good = np.flatnonzero(forces.status == 0)
    if len(good) < 2:
        return None
    if len(good) < until:
        part = part.take(good)
        forces = joint_forces(
            analysis.design, part.pose, part.velocity, part.acceleration, load=part.load
        )
    return MotionLoads(analysis.design, part, forces)
