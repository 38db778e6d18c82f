"""What a motion through a singularity depends on: authority, drift, and torques without a plan.

At the crossing no actuator moves the platform along the escape twist t_s: there it has the inertia
t_s^T M t_s, and whatever force the plan did not know of accelerates it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.checks import kinds_checked
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.dynamics import mass_matrix, platform_wrench
from paminsa_viz.model.jacobians import inverse_jacobian, inverse_jacobian_rate
from paminsa_viz.model.singularity import escape_twist
from paminsa_viz.trajectory.check import singular_clearance
from paminsa_viz.trajectory.crossing import (
    NODES,
    limit_torques,
    locus_distances,
    torque_growth,
)
from paminsa_viz.trajectory.sampled import OFF_CROSSING, RATE, Locus, Trajectory
from paminsa_viz.trajectory.time_laws import Profile, TimeLaw
from paminsa_viz.trajectory.time_optimal import PlannedCrossing, TimeOptimalPlan

UNPLANNED_LAW = TimeLaw(Profile.QUINTIC)
"""What a motion is compared with that does not meet the condition."""


@of_design
def escape_inertia(design: Design, pose: ArrayLike) -> Array:
    """Return t_s^T M t_s at type-2 singular poses (..., 4), (...) [kg m^2].

    NaN where `escape_twist` is.
    """
    twist = escape_twist(design.geometry, pose)
    return np.einsum("...i,...ij,...j->...", twist, mass_matrix(design, pose), twist)


@dataclass(frozen=True)
class CrossingDrift:
    """Where an error of the payload takes the platform while actuators hardly can correct it.

    Attributes:
        inertia: t_s^T M t_s [kg m^2].
        residual: t_s^T F of the robot with the error, on the planned motion [N m].
        time: Time that the motion spends nearer to the locus than the clearance [s].
        shift: (4,) displacement along t_s after that time [m, m, rad, m].
    """

    inertia: float
    residual: float
    time: float
    shift: tuple[float, ...]


@of_design
def payload_drift(
    design: Design, found: TimeOptimalPlan, error: float, clearance: float | None = None
) -> tuple[CrossingDrift, ...]:
    """Return how far an unknown payload takes the platform off at each crossing of a motion.

    The residual accelerates the platform along t_s, as it is at the crossing, for the time near the
    locus, from rest and uncorrected: shift = -t_s residual time^2 / (2 t_s^T M t_s).

    Args:
        design: The robot that the motion was planned for.
        found: The motion.
        error: Payload beyond the design's [kg].
        clearance: Distance from the locus within which corrections are not counted on [m];
            `singular_clearance` if None.

    Raises:
        InvalidDesign: If the payload is negative with the error.
    """
    clearance = singular_clearance(design) if clearance is None else clearance
    payload = replace(design.payload, mass=design.payload.mass + error)
    heavier = replace(design, payload=payload)
    drifts = []
    for item in found.crossings:
        state = found.plan.at(item.t)
        twist = np.array(item.condition.twist)
        residual = float(twist @ platform_wrench(heavier, *state))
        inertia = float(escape_inertia(heavier, item.crossing.pose))
        time = _time_within(design, found, item, clearance)
        shift = -twist * residual * time**2 / (2.0 * inertia)
        drifts.append(CrossingDrift(inertia, residual, time, tuple(shift.tolist())))
    return tuple(drifts)


def _time_within(
    design: Design, found: TimeOptimalPlan, item: PlannedCrossing, clearance: float
) -> float:
    """Return how long a motion is nearer to a locus than the clearance, about a crossing [s]."""
    ends = []
    for end in (0.0, 1.0):
        s = np.linspace(item.crossing.s, end, NODES)
        distance = locus_distances(design.geometry, found.path(s))[:, item.crossing.locus.value]
        off = np.abs(distance)
        out = np.flatnonzero(off[1:] > clearance)[:1] + 1
        near = off[out - 1], off[out]  # none of either where the path ends within the clearance
        share = (clearance - near[0]) / (near[1] - near[0])
        ends += [*(s[out - 1] + share * (s[out] - s[out - 1])), end][:1]
    return found.curve.time_at(ends[1]) - found.curve.time_at(ends[0])


@kinds_checked
def unplanned_torque(item: PlannedCrossing, duration: float, rate: float = RATE) -> float:
    """Return the torque that a usual law needs half a sample before a crossing [N m].

    It is the largest of M1 to M3, by the quintic law on the same path in the same time. It grows in
    proportion to the rate: the law ignores the condition.

    Args:
        item: The crossing.
        duration: Of the motion [s].
        rate: Samples a second [1/s].
    """
    from scipy.optimize import brentq  # slow to load

    law = UNPLANNED_LAW
    u = brentq(lambda at: float(law(np.array([at]))[0]) - item.crossing.s, 0.0, 1.0)
    speed, growth = (float(law(np.array([u]), order)[0]) / duration**order for order in (1, 2))
    residual = item.condition.residual(speed, growth)
    return float(np.abs(item.condition.growth).max() * abs(residual) * 2.0 * rate / speed)


@dataclass(frozen=True)
class CrossingLoad:
    """What a robot needs where a sampled motion crosses a singularity.

    Attributes:
        t: When [s].
        locus: Which locus.
        residual: t_s^T F; unless it is zero, the torques have no bound [N m].
        excess: Largest torque of M1 to M3 that follows from the residual half a sample step from
            the crossing [N m].
        torque: (4,) torques in the limit, as if the residual were zero [N m, N].
    """

    t: float
    locus: Locus
    residual: float
    excess: float
    torque: tuple[float, ...]


@of_design
def crossing_loads(design: Design, trajectory: Trajectory) -> tuple[CrossingLoad, ...]:
    """Return what a robot needs at the planned crossings of a motion, friction left out.

    A crossing at which the samples miss the locus is left out.
    """
    loads = []
    for t, locus, states in trajectory.passages:
        after = int(np.clip(np.searchsorted(trajectory.t, t), 1, trajectory.size - 1))
        step = float(trajectory.t[after] - trajectory.t[after - 1])
        beside = OFF_CROSSING if states else 0.25 * step
        times = t + beside * np.array([-1.0, 0.0, 1.0])
        pose, velocity, acceleration = states or trajectory.at(times)
        load = trajectory.load_at(times)
        force = platform_wrench(design, pose, velocity, acceleration, load=load)
        twist = escape_twist(design.geometry, pose[1])
        if not (np.isfinite(twist).all() and np.isfinite(force).all()):
            continue
        g = inverse_jacobian(design.geometry, pose[1])
        rate = inverse_jacobian_rate(design.geometry, pose[1], velocity[1])
        force_rate = (force[2] - force[0]) / (2.0 * beside)
        torque = limit_torques(twist, g, rate, force[1], force_rate)
        residual = float(twist @ force[1])
        growth = float(np.abs(torque_growth(twist, g, rate)).max())
        excess = abs(residual) * growth / (0.5 * step)
        loads.append(CrossingLoad(t, locus, residual, excess, tuple(torque.tolist())))
    return tuple(loads)
