"""From a described motion to a trajectory, and where the robot is on it at an instant.

Everything here is a pure function. Results are kept, since many views ask for the same one.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from paminsa_viz.explorer.state.motion import MOST_SAMPLES, Kind, Motion, Timing
from paminsa_viz.kept import kept
from paminsa_viz.model import Design, Geometry, InvalidInput, PaminsaError, check_reach
from paminsa_viz.model.arrays import Pose
from paminsa_viz.trajectory import (
    PRESET,
    CrossingRefused,
    DeformedPlan,
    ImpossibleTrajectory,
    InfeasibleMotion,
    MotionLimits,
    PathCheck,
    Plan,
    TimeLaw,
    TimeOptimalPlan,
    Trajectory,
    arch,
    check_path,
    circle,
    line,
    plan_deformed,
    point_to_point,
    round_trip,
    shortest_motion,
    shortest_stretch,
    spline_path,
    straight_path,
    time_optimal,
    via_points,
)
from paminsa_viz.trajectory.presets import PresetFrame
from paminsa_viz.trajectory.timing import UNBOUNDED_JERK

_KEPT = 12
"""Trajectories that are kept, of all tabs together; one has at most 2 MB."""


THETA = 2
"""Place of theta in a pose."""


@dataclass(frozen=True, eq=False)
class Planned:
    """What became of a description.

    Attributes:
        trajectory: The motion, or None if its numbers make none.
        problem: Why there is none, or none that keeps its limits.
        argument: Name of what is wrong, where there is none.
        bound: What keeps it from being shorter; empty if the duration was given.
        crossing: The way there, if it was planned through type-2 singularities.
        deviation: How far its path was changed for that [m].
        to_change: The field of `MotionLimits` without which there is no problem; empty if none
            helps.
    """

    trajectory: Trajectory | None
    problem: str = ""
    argument: str = "motion"
    bound: str = ""
    crossing: TimeOptimalPlan | None = None
    deviation: float = 0.0
    to_change: str = ""


def planned(motion: Motion, design: Design) -> Planned:
    """Return the trajectory of a described motion for a robot; raises nothing."""
    # Masses matter only where torques bound the duration: other trajectories stay while a mass
    # changes, and with them all that was solved along them.
    bounded = motion.limits.needs_torques or any(design.drives)
    shown = motion.crosses or (motion.timing.keeps_limits and bounded)
    return _planned(motion, design.geometry, design if shown else None)


@kept(_KEPT)
def _planned(motion: Motion, geometry: Geometry, design: Design | None) -> Planned:
    try:
        if motion.kind is Kind.TABLE:
            return _from_table(motion)
        plan = make_plan(motion, geometry)
    except InvalidInput as error:
        return Planned(None, str(error), error.argument)
    except PaminsaError as error:
        return Planned(None, str(error))
    problem = bound = to_change = ""
    crossing, deviation = None, 0.0
    if motion.crosses and design is not None:
        try:
            found = plan_through(motion, design)
            crossing, deviation = found.found, found.deviation
            plan = crossing.plan
        except PaminsaError as error:
            problem, to_change = str(error), _to_change(error, motion.limits)
    elif motion.timing.keeps_limits:
        shortest = shortest_motion if motion.timing is Timing.SHORTEST else shortest_stretch
        try:
            found = shortest(plan, motion.limits, design)
            plan, bound = found.plan, found.explanation
        except ImpossibleTrajectory:
            bound = "no shortest duration, since the robot cannot run the path"
        except PaminsaError as error:
            problem, to_change = str(error), _to_change(error, motion.limits)
    if motion.back:
        plan = round_trip(plan)
    samples = plan.sample(_rate(motion.rate, plan.duration))
    return Planned(
        samples, problem, bound=bound, crossing=crossing, deviation=deviation, to_change=to_change
    )


def _to_change(error: PaminsaError, limits: MotionLimits) -> str:
    """Return which limit has to be another one for a refused motion; empty if none helps."""
    if isinstance(error, (CrossingRefused, InfeasibleMotion)):
        return error.to_raise
    if not isinstance(error, InvalidInput) or error.argument != "limits":
        return ""
    if error.problem == UNBOUNDED_JERK:
        return "turn_jerk" if limits.jerk is None else "jerk"
    return "torque"


def _from_table(motion: Motion) -> Planned:
    if motion.table is None:
        return Planned(None, "choose a CSV file with the columns t_s, x_m, y_m, theta_rad, z_m")
    rate = _rate(motion.rate, motion.table.duration)
    return Planned(motion.table.resampled(rate))


def _rate(rate: float, duration: float) -> float:
    return min(rate, (MOST_SAMPLES - 1) / duration)


def make_plan(motion: Motion, geometry: Geometry) -> Plan:
    """Return the plan of a described motion, before a shortest duration is looked for.

    Raises:
        PaminsaError: If its numbers make no motion.
    """
    law, duration = TimeLaw(motion.profile), motion.duration
    start, goal = ends(motion, geometry)
    if motion.kind is Kind.MOVE:
        return point_to_point(start, goal, duration, law)
    if motion.kind is Kind.LINE:
        return line(start, [goal[0], goal[1], goal[3]], duration, law)
    if motion.kind is Kind.ARCH:
        return arch(start, goal, motion.height, duration, law)
    if motion.kind is Kind.CIRCLE:
        return circle(center(motion, geometry), motion.radius, duration, law)
    if motion.kind is Kind.WAYPOINTS:
        if len(motion.waypoints) < 2:
            raise InvalidInput("waypoints", "two or more are needed; move the robot and add them")
        return via_points(np.reshape(motion.waypoints, (-1, 4)), duration, geometry=geometry)
    plan = PRESET[motion.preset].build(geometry)
    return plan.lasting(duration) if motion.timing is Timing.GIVEN else plan


def plan_through(motion: Motion, design: Design) -> DeformedPlan:
    """Return the plan of a motion that may cross singularities, within its limits.

    Raises:
        PaminsaError: If there is none.
    """
    start, goal = (np.array(pose) for pose in ends(motion, design.geometry))
    if motion.kind is Kind.WAYPOINTS:
        path = spline_path(np.reshape(motion.waypoints, (-1, 4)), design.geometry)
    else:
        if motion.kind is Kind.LINE:
            goal[2] = start[2]
        path = straight_path(start, goal)
    limits = replace(
        motion.limits, acceleration=None, turn_acceleration=None, jerk=None, turn_jerk=None
    )
    duration = None if motion.timing.keeps_limits else motion.duration
    if motion.deviation:
        return plan_deformed(
            design, path, limits, duration, most=motion.deviation, name=motion.kind.value
        )
    return DeformedPlan(time_optimal(design, path, limits, duration, name=motion.kind.value), 0.0)


def ends(motion: Motion, geometry: Geometry) -> tuple[Pose, Pose]:
    """Return start and goal of a motion from pose to pose, also where they were not chosen."""
    room = PresetFrame(geometry)
    start = motion.start or _pose(room.pose(-0.1, 0.0, 0.0, 0.0))
    goal = motion.goal or _pose(room.pose(0.1, 0.0, 0.0, 0.0))
    return start, goal


def center(motion: Motion, geometry: Geometry) -> Pose:
    """Return the center of a circle, also where it was not chosen."""
    return motion.center or _pose(PresetFrame(geometry).center)


def _pose(values: np.ndarray) -> Pose:
    x, y, theta, z = (round(float(value), 6) for value in values)
    return (x, y, theta, z)


class Point(NamedTuple):
    """A pose that a motion is built from.

    Attributes:
        name: What it is: ``From``, ``To``, ``Center``, or the number of a waypoint.
        pose: (x, y, theta, z) [m, m, rad, m].
    """

    name: str
    pose: Pose


def points(motion: Motion, geometry: Geometry) -> tuple[Point, ...]:
    """Return the poses that a motion is built from; none of a preset's or a file's.

    Args:
        motion: The motion.
        geometry: Lengths of the robot, which decide on poses that were not chosen.
    """
    if motion.kind.has_ends:
        start, goal = ends(motion, geometry)
        if motion.kind is Kind.LINE:
            goal = (*goal[:THETA], start[THETA], goal[3])
        return Point("From", start), Point("To", goal)
    if motion.kind is Kind.CIRCLE:
        return (Point("Center", center(motion, geometry)),)
    if motion.kind is Kind.WAYPOINTS:
        return tuple(Point(f"{i}", pose) for i, pose in enumerate(motion.waypoints, 1))
    return ()


def with_point(motion: Motion, geometry: Geometry, index: int, pose: Pose) -> dict[str, Any]:
    """Return what of a motion changes if one of its points becomes another pose.

    Args:
        motion: The motion; it has a point of this index.
        geometry: Lengths of the robot.
        index: Place in `points`.
        pose: The new pose.
    """
    if motion.kind.has_ends:
        start, goal = ends(motion, geometry)
        return {"start": pose, "goal": goal} if index == 0 else {"start": start, "goal": pose}
    if motion.kind is Kind.CIRCLE:
        return {"center": pose}
    way = motion.waypoints
    return {"waypoints": (*way[:index], pose, *way[index + 1 :])}


@kept(_KEPT)
def checked(trajectory: Trajectory, geometry: Geometry) -> PathCheck:
    """Return where and why a robot fails on a trajectory."""
    return check_path(geometry, trajectory)


@kept(_KEPT)
def checked_poses(geometry: Geometry, poses: tuple[Pose, ...]) -> tuple[bool, ...]:
    """Return whether a robot can be at each of some poses."""
    if not poses:
        return ()
    return tuple(check_reach(geometry, np.array(poses)).ok.tolist())


def pose_at(trajectory: Trajectory, geometry: Geometry, time: float) -> Pose | None:
    """Return the pose at a time [s], or None where the robot cannot be.

    Args:
        trajectory: The motion.
        geometry: Lengths and limits of the robot.
        time: [s].
    """
    good = checked(trajectory, geometry).ok
    right = int(np.clip(np.searchsorted(trajectory.t, time), 0, trajectory.size - 1))
    left = right if trajectory.t[right] <= time else max(right - 1, 0)
    if not (good[left] and good[right]):
        return None
    x, y, theta, z = (float(value) for value in trajectory.at(time).pose)
    return (x, y, theta, z)
