"""The poses that a motion is built from, as a list that can be edited."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

from paminsa_viz.explorer.motion.description import Kind, Motion, Pose
from paminsa_viz.explorer.motion.planning import center, ends
from paminsa_viz.model import Geometry

THETA = 2
"""Place of theta in a pose."""


@dataclass(frozen=True)
class PointEditing:
    """Which pose of a motion is edited, and how.

    Attributes:
        selected: Its place in the list of `points`; beyond the end, the last one.
        drawing: Whether a click on a map adds a waypoint, where it otherwise moves the robot.
    """

    selected: int = 0
    drawing: bool = False


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
