"""The platform's poses along a log, by forward kinematics and continuity, and which rows to use."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from paminsa_viz.errors import InvalidInput
from paminsa_viz.identification.log import InvalidLog, Log
from paminsa_viz.model import backend
from paminsa_viz.model.arguments import of_geometry
from paminsa_viz.model.arrays import Array, as_pose
from paminsa_viz.model.design import Geometry
from paminsa_viz.model.kinematics import forward_kinematics, wrap
from paminsa_viz.model.leg import mechanism
from paminsa_viz.model.reach import Limit, check_reach, home_pose
from paminsa_viz.model.singularity import DEXTERITY

MOST_CONDITION = 10.0
"""Largest condition number of the Jacobian (`Singularity.condition`): beyond it encoder noise
becomes torque."""

SHORTEST_SEGMENT = 1.0
"""Shortest piece of a split log that is used [s]."""


def follow_pose(geometry: Geometry, position: Array, start: ArrayLike) -> Array:
    """Return the platform's poses along a motion of the actuators, (n, 4).

    Both assembly modes of all rows are solved at once. They meet only in a singularity, so that on
    the way from one row to the next the first stays the first: the one nearest to ``start`` in the
    first row is taken throughout.

    Args:
        geometry: Lengths of the mechanism.
        position: (n, 4) actuator positions without gaps [rad, m].
        start: Pose (4,) near the first one [m, m, rad, m].

    Returns:
        theta without jumps; NaN where the legs do not meet the platform.
    """
    modes = forward_kinematics(geometry, position).pose
    off = modes[0, :, :3] - np.asarray(start, np.float64)[:3]
    off[:, 2] = geometry.platform_radius * wrap(off[:, 2])
    distance = np.vecdot(off, off)
    pose = modes[:, int(np.argmin(np.where(np.isfinite(distance), distance, np.inf)))].copy()
    finite = np.isfinite(pose[:, 2])
    pose[finite, 2] = np.unwrap(pose[finite, 2])
    return pose


@of_geometry
def log_poses(
    geometry: Geometry, log: Log, start: ArrayLike | None = None
) -> tuple[Array, list[slice]]:
    """Return the platform's poses of a log, (n, 4), and the pieces of it that can be used.

    Args:
        geometry: Lengths of the mechanism.
        log: The log.
        start: Pose (4,) near the start of every segment, for the choice of the assembly; the home
            pose by default.

    Raises:
        InvalidLog: At the first row out of reach or with a condition number above
            `MOST_CONDITION`, unless the log is to be split there; and if nothing is left.
        InvalidInput: If the start is not one pose of finite numbers.
    """
    begin = as_pose(home_pose(geometry) if start is None else start, "start")
    if not np.isfinite(begin).all():
        raise InvalidInput("start", f"four finite numbers are needed, not {start}")
    pose = np.concatenate(
        [follow_pose(geometry, log.position[part], begin) for part in log.segments]
    )
    reach = check_reach(geometry, pose)
    _, condition = backend.over_list(DEXTERITY, mechanism(geometry), pose).T
    with np.errstate(invalid="ignore"):
        good = (reach.status == Limit.OK) & (condition <= MOST_CONDITION)
    if good.all():
        return pose, log.segments
    bad = int(np.flatnonzero(~good)[0])
    why = _why(pose[bad], reach.reason(bad), condition[bad])
    if not log.split:
        raise InvalidLog(why, log.row(bad), log=log.name)
    return pose, _usable_pieces(log, good, why)


def _why(pose: Array, reason: str, condition: float) -> str:
    if not np.isfinite(pose).all():
        return (
            "no pose of the platform fits the actuator positions; check their zeros, units and "
            "order, and the geometry"
        )
    if reason:
        return f"{reason}; check zeros, geometry and start pose"
    return (
        f"the condition number is {condition:.3g}, near a singularity, where encoder noise becomes "
        f"torque; at most {MOST_CONDITION:g} is used: leave these rows out, or check zeros, signs "
        "and order of the positions if the robot was not there"
    )


def _usable_pieces(log: Log, good: NDArray[np.bool_], why: str) -> list[slice]:
    edges = np.flatnonzero(np.diff(np.concatenate([[False], good, [False]]).astype(np.int8)))
    cuts = set(log.starts)
    found = []
    for begin, end in edges.reshape(-1, 2).tolist():
        marks = [begin, *sorted(cut for cut in cuts if begin < cut < end), end]
        found += [slice(a, b) for a, b in pairwise(marks)]
    least = SHORTEST_SEGMENT * log.rate
    kept = [piece for piece in found if piece.stop - piece.start >= least]
    if not kept:
        problem = f"no {SHORTEST_SEGMENT:g} s in a row can be used: {why}"
        raise InvalidLog(problem, log=log.name)
    return kept
