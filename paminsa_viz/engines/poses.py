"""Poses for the engines: joint values at a pose, the start pose, random poses for checks."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from paminsa_viz.checks import kinds_checked, require_seed
from paminsa_viz.engines.mechanism import LIFT, POSE_JOINTS, Link, MechanismTree, leg_name
from paminsa_viz.errors import InvalidInput, UnreachablePose
from paminsa_viz.model.arguments import of_geometry
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design, Geometry
from paminsa_viz.model.kinematics import AXIS_ANGLES, Configuration, inverse_kinematics
from paminsa_viz.model.reach import (
    check_reach,
    home_pose,
    workspace_height,
    workspace_radius,
)
from paminsa_viz.model.singular_limit import CONDITION_LIMIT
from paminsa_viz.model.singularity import measure_singularity, singular_rotation
from paminsa_viz.units import format_pose

if TYPE_CHECKING:
    from scipy.spatial.transform import Rotation

WORST_CONDITION = CONDITION_LIMIT
"""Largest condition number of a drawn pose. Torques grow without bound toward a singularity, and
relative to the largest of them every difference would look small."""

LEAST_CLEARANCE = 0.1
"""Least distance from stretched, folded and on-axis legs, over R_b."""

_DRAWN = 4096
_ROUNDS = 200


@kinds_checked
def joint_values(configuration: Configuration) -> dict[str, Array]:
    """Read the value of every joint from the pose and the joint points of a configuration.

    Returns:
        By joint name, arrays of the batch shape [rad, m]; NaN where it is unreachable.
    """
    values = {name: configuration.pose[..., index] for index, name in enumerate(POSE_JOINTS)}
    level = np.zeros(configuration.pose.shape[:-1])
    values |= {
        "platform_roll": level,
        "platform_pitch": level,
        LIFT: configuration.actuators[..., 3],
    }
    axes = configuration.geometry.base_radius * np.array(
        [[math.cos(a), math.sin(a)] for a in AXIS_ANGLES]
    )
    for leg in range(3):
        theta = np.asarray(configuration.actuators[..., leg])
        heading = AXIS_ANGLES[leg] + math.pi + theta
        ahead = np.stack([np.cos(heading), np.sin(heading)], axis=-1)

        def in_plane(number: int, leg: int = leg, ahead: Array = ahead) -> tuple[Array, Array]:
            point = np.asarray(configuration.points[number])[..., leg, :]
            return np.sum((point[..., :2] - axes[leg]) * ahead, axis=-1), point[..., 2]

        def elevation(start: tuple[Array, Array], end: tuple[Array, Array]) -> Array:
            return np.arctan2(end[1] - start[1], end[0] - start[0])

        p4, p5, p7, p8, p9 = (in_plane(number) for number in (4, 5, 7, 8, 9))
        bar8, bar4 = elevation(p8, p9), elevation(p9, p5)
        values |= {
            leg_name(leg, "theta"): theta,
            leg_name(leg, "shaft"): values[LIFT],
            leg_name(leg, "slide"): p8[0],
            leg_name(leg, "bar8"): bar8,
            leg_name(leg, "bar4"): bar4 - bar8,
            leg_name(leg, "bar3"): elevation(p7, p4) - bar4,
            leg_name(leg, "bar7"): elevation(p8, p7),
        }
    return values


def start_values(design: Design, pose: Array) -> dict[str, float]:
    """Return the value of every joint at one pose (4,), by joint name [rad, m].

    Raises:
        UnreachablePose: If the robot cannot be there.
    """
    found = joint_values(inverse_kinematics(design.geometry, pose))
    values = {name: float(value) for name, value in found.items()}
    if not all(math.isfinite(value) for value in values.values()):
        raise unclosed(pose)
    return values


def link_frame(link: Link, values: Mapping[str, float]) -> tuple[Array, Rotation, list[Array]]:
    """Return where a link is in its parent's frame: origin (3,) [m], turn, and its joints' axes.

    Axes (3,) are in the link's own frame, as the joints move it one after the other.
    """
    from scipy.spatial.transform import Rotation  # slow to load

    place, turn = np.asarray(link.place, float), Rotation.from_euler("z", link.heading)
    fixed = []
    for joint in link.joints:
        axis, value = np.asarray(joint.axis, float), values[joint.name]
        if joint.kind == "slide":
            place = place + value * turn.apply(axis)
        else:
            turn = turn * Rotation.from_rotvec(value * axis)
        fixed.append(turn.apply(axis))
    return place, turn, [turn.apply(axis, inverse=True) for axis in fixed]


def world_frames(
    mechanism: MechanismTree, values: Mapping[str, float]
) -> dict[str, tuple[Array, Rotation]]:
    """Return origin (3,) [m] and turn of every link in the base frame, by link name."""
    found: dict[str, tuple[Array, Rotation]] = {}
    for link in mechanism.links:
        place, turn, _ = link_frame(link, values)
        if link.parent is not None:
            origin, parent = found[link.parent]
            place, turn = origin + parent.apply(place), parent * turn
        found[link.name] = place, turn
    return found


def start_pose(design: Design, pose: Sequence[float] | None = None) -> Array:
    """Return the pose (4,) in which an exported model starts: as given, or centered on home's side.

    Then it is halfway between the least and the greatest distance that its pantographs allow.

    Raises:
        UnreachablePose: If none is given, and the design has no regular configuration at the
            center.
    """
    if pose is not None:
        return np.asarray(pose, float)
    g = design.geometry
    least = max(g.home_span, abs(g.coupler_length - g.crank_length))
    distance = 0.5 * (least + g.coupler_length + g.crank_length)
    height = -g.knee.sign * math.sqrt(distance**2 - g.home_span**2) - g.platform_joint_height
    centered = np.array([0.0, 0.0, 0.0, height])
    if not np.isfinite(inverse_kinematics(g, centered).phi).all():
        raise unclosed(centered)
    return centered


def unclosed(pose: Array) -> UnreachablePose:
    """Return the error for a pose (4,) at which the bars cannot close."""
    x, y, theta, z = (float(value) for value in pose)
    text = f"the bars cannot close at {format_pose(pose, 6, ascii_only=True)}"
    return UnreachablePose((x, y, theta, z), 0, "configuration", 0.0, text)


@of_geometry
def workspace_poses(geometry: Geometry, count: int, seed: int = 0) -> Array:
    """Draw poses from all of the workspace that the robot reaches without crossing a singularity.

    Uniform in x, y, theta and z, above and below the guides; clear of singularities, see
    `WORST_CONDITION` and `LEAST_CLEARANCE`. The same arguments give the same poses for both
    branches of the knee.

    Args:
        geometry: Lengths of the mechanism.
        count: How many.
        seed: Of the random numbers.

    Returns:
        (count, 4) [m, m, rad, m].

    Raises:
        InvalidInput: If count or seed is not possible, or the workspace is too small to find so
            many.
    """
    if count < 1:
        raise InvalidInput("poses", f"at least 1 is needed, not {count}")
    require_seed(seed)
    rng = np.random.default_rng(seed)
    across, up = workspace_radius(geometry), workspace_height(geometry)
    turn = np.nan_to_num(singular_rotation(geometry), nan=np.pi)
    side = np.sign(measure_singularity(geometry, home_pose(geometry)).determinant)
    found = np.empty((0, 4))
    for _ in range(_ROUNDS):
        poses = rng.uniform(-1.0, 1.0, (_DRAWN, 4)) * [across, across, turn, up]
        poses[:, 3] -= geometry.platform_joint_height
        measured = measure_singularity(geometry, poses)
        good = check_reach(geometry, poses).ok & (measured.condition <= WORST_CONDITION)
        good &= measured.serial_distance >= LEAST_CLEARANCE * geometry.base_radius
        good &= np.sign(measured.determinant) == side
        found = np.concatenate([found, poses[good]])
        if len(found) >= count:
            return found[:count]
    raise InvalidInput(
        "poses",
        f"only {len(found)} of {count} found in a workspace this small; request fewer, or check "
        "the design's lengths",
    )
