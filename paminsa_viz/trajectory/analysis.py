"""Loads of a robot on a trajectory: required torques, their parts, power, energy, failures."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from paminsa_viz.checks import kinds_checked
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.dynamics import TorqueBreakdown
from paminsa_viz.model.energy import kinetic_energy, potential_energy
from paminsa_viz.model.lumped import Misprint
from paminsa_viz.model.reach import Limit
from paminsa_viz.trajectory.check import ImpossibleTrajectory, PathCheck, PathEvent
from paminsa_viz.trajectory.crossing_measures import CrossingLoad, crossing_loads
from paminsa_viz.trajectory.integrals import rms, running_integral
from paminsa_viz.trajectory.sampled import Trajectory
from paminsa_viz.trajectory.solved import SolvedTrajectory, solve_trajectory

EXCESS = 0.05
"""Share of the largest torque that a crossing's residual may cause next to it, by rounding."""


@dataclass(frozen=True)
class ActuatorSummary:
    """Load of an actuator before the motion ends or first fails.

    Attributes:
        peak: Torque or force that is largest in size, with its sign; at a planned crossing of a
            singularity its limit counts [N m or N].
        peak_t: When [s].
        rms: Root mean square over time [N m or N].
        top_speed: Largest speed [rad/s or m/s].
        top_power: Power that is largest in size, with its sign [W].
        top_power_t: When [s].
        driven: Energy it puts in while driving [J], at least 0.
        braked: Energy it takes up while braking [J], at most 0.
    """

    peak: float
    peak_t: float
    rms: float
    top_speed: float
    top_power: float
    top_power_t: float
    driven: float
    braked: float

    @property
    def work(self) -> float:
        """Energy it puts in on balance [J]."""
        return self.driven + self.braked


@dataclass(frozen=True, eq=False)
class TrajectoryAnalysis:
    """A design on a trajectory of n samples; NaN exactly where ``check.status`` is not OK.

    Attributes:
        design: The robot.
        solved: The motion, solved for its geometry.
        torque: (n, 4) torques of M1..M3 [N m] and force of M4 [N], friction and drives included.
    """

    design: Design
    solved: SolvedTrajectory = field(repr=False)
    torque: Array

    @property
    def trajectory(self) -> Trajectory:
        """The motion."""
        return self.solved.trajectory

    @property
    def check(self) -> PathCheck:
        """Where and why the motion fails, if it does."""
        return self.solved.check

    @cached_property
    def breakdown(self) -> TorqueBreakdown:
        """The torque's parts, each (n, 4); they add up to it."""
        return self.solved.breakdown(self.design)

    @cached_property
    def power(self) -> Array:
        """Power of each actuator, positive where it drives, (n, 4) [W]."""
        return self.torque * self.solved.speed

    @cached_property
    def work(self) -> Array:
        """Energy each actuator has put in since the start, (n, 4) [J]; NaN from a failure on."""
        until = self.check.until
        work = np.full_like(self.torque, np.nan)
        work[:until] = running_integral(self.trajectory.t[:until], self.power[:until])
        return work

    @cached_property
    def summary(self) -> tuple[ActuatorSummary, ...]:
        """The four actuators, up to the first failure; empty if the first sample fails."""
        until = self.check.until
        if until == 0:
            return ()
        t, power = self.trajectory.t[:until], self.power[:until]
        torque, speed = self.torque[:until], self.solved.speed[:until]
        driven = running_integral(t, np.maximum(power, 0.0))[-1]
        braked = running_integral(t, np.minimum(power, 0.0))[-1]
        at_peak, top = np.abs(torque).argmax(axis=0), np.abs(power).argmax(axis=0)
        limits = [
            (item.torque, item.t)
            for item in self.crossings
            if item not in self.unbounded and item.t <= t[-1]
        ]
        peaks = [
            max(
                [(torque[i, j], t[i]), *((tau[j], at) for tau, at in limits)],
                key=lambda found: abs(found[0]),
            )
            for j, i in enumerate(at_peak)
        ]
        mean = rms(t, torque)
        return tuple(
            ActuatorSummary(
                peak=float(peaks[j][0]),
                peak_t=float(peaks[j][1]),
                rms=float(mean[j]),
                top_speed=float(np.abs(speed[:, j]).max()),
                top_power=float(power[top[j], j]),
                top_power_t=float(t[top[j]]),
                driven=float(driven[j]),
                braked=float(braked[j]),
            )
            for j in range(4)
        )

    @cached_property
    def crossings(self) -> tuple[CrossingLoad, ...]:
        """Planned crossings of singularities; torques in the limit, with friction.

        They are not those of the sampled torques if the robot is another one than it was planned
        for, see `unbounded`. Empty with misprints.
        """
        if self.solved.misprints:
            return ()
        t, friction = self.trajectory.t, self.solved.friction(self.design)
        return tuple(
            replace(item, torque=tuple(
                torque + float(np.interp(item.t, t, column))
                for torque, column in zip(item.torque, friction.T, strict=True)
            ))
            for item in crossing_loads(self.design, self.trajectory)
        )  # fmt: skip

    @cached_property
    def unbounded(self) -> tuple[CrossingLoad, ...]:
        """Planned crossings at which this robot's torques have no bound."""
        if not self.crossings:
            return ()
        largest = float(np.nanmax(np.abs(self.torque[:, :3]), initial=0.0))
        return tuple(item for item in self.crossings if item.excess > EXCESS * largest)

    @cached_property
    def failure(self) -> PathEvent | None:
        """Why the robot cannot run the motion, None if it can.

        The first failure of the path, or else the first crossing at which its torques have no
        bound.
        """
        if self.check.first is not None or not self.unbounded:
            return self.check.first
        item = self.unbounded[0]
        return PathEvent(
            item.t, Limit.SINGULAR, -1, 0.0, tuple(self.trajectory.at(item.t).pose.tolist()),
            f"torques have no bound: the motion crosses the {item.locus.label}, planned for "
            "another robot or sampled too coarsely",
        )  # fmt: skip

    def require(self) -> None:
        """Raise `ImpossibleTrajectory` if the robot cannot run the motion."""
        if self.failure is not None:
            raise ImpossibleTrajectory(self.failure)

    @cached_property
    def energy(self) -> Array:
        """Kinetic plus potential energy, (n,) [J]."""
        t, solved = self.trajectory, self.solved
        total = kinetic_energy(
            self.design, t.pose, t.velocity, solved.misprints
        ) + potential_energy(self.design, t.pose)
        total[~self.check.ok] = np.nan
        return total

    @cached_property
    def energy_residual(self) -> Array:
        """Work of all actuators and the load minus growth of energy and friction losses, (n,) [J].

        Zero but for the integration over samples: the energy balance of the formulas. With
        `misprints` it does not balance.
        """
        until = self.check.until
        t, solved = self.trajectory, self.solved
        friction = solved.friction(self.design)[:until]
        power = -(friction * solved.speed[:until]).sum(axis=1)
        if solved.loaded(self.design):
            power += (solved.load_force(self.design) * t.velocity)[:until].sum(axis=1)
        given = np.full(t.size, np.nan)
        given[:until] = running_integral(t.t[:until], power)
        return self.work.sum(axis=1) + given - (self.energy - self.energy[0])


@of_design
def analyze(
    design: Design,
    trajectory: Trajectory,
    *,
    misprints: Misprint = Misprint.NONE,
    clearance: float | None = None,
    keep: SolvedTrajectory | None = None,
) -> TrajectoryAnalysis:
    """Return the required actuator torques and what follows from them.

    A path that the robot cannot run raises nothing: the result has where it fails and why, and
    is NaN there.

    Args:
        design: The robot.
        trajectory: The motion.
        misprints: Misprints of the paper to reproduce.
        clearance: See `check_path`.
        keep: The ``solved`` of an earlier result, which is used again if geometry, trajectory,
            misprints and clearance are the same: then only one product is computed.
    """
    if keep is None or not keep.serves(design.geometry, trajectory, misprints, clearance):
        keep = solve_trajectory(
            design.geometry, trajectory,
            gravity=design.gravity, misprints=misprints, clearance=clearance,
        )  # fmt: skip
    return TrajectoryAnalysis(design, keep, keep.torques(design))


@dataclass(frozen=True)
class ActuatorChange:
    """Load of an actuator over that in the reference; infinite or NaN where the latter is zero.

    Attributes:
        peak: Ratio of the largest torques.
        rms: Ratio of the root mean squares.
        top_power: Ratio of the largest powers.
        driven: Ratio of the energies put in while driving.
    """

    peak: float
    rms: float
    top_power: float
    driven: float


@kinds_checked
def compare(
    chosen: TrajectoryAnalysis, reference: TrajectoryAnalysis
) -> tuple[ActuatorChange, ...]:
    """Return the change of each actuator's load; empty if either fails at its first sample.

    Raises:
        InvalidInput: If the two are not of the same trajectory.
    """
    if chosen.trajectory is not reference.trajectory:
        raise InvalidInput("reference", "it has to be an analysis of the same trajectory")
    loads = [
        np.array([[s.peak, s.rms, s.top_power, s.driven] for s in analysis.summary])
        for analysis in (chosen, reference)
    ]
    if not (chosen.summary and reference.summary):
        return ()
    with np.errstate(divide="ignore", invalid="ignore"):
        return tuple(ActuatorChange(*row) for row in np.abs(loads[0] / loads[1]).tolist())
