"""Where the joints of the mechanism stand at a pose, from the geometry alone."""

from __future__ import annotations

import math

import numpy as np

from paminsa_viz.engines.mechanism import LIFT, POSE_JOINTS, leg_name
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.errors import UnreachablePose
from paminsa_viz.model.kinematics import AXIS_ANGLES, Configuration, inverse_kinematics
from paminsa_viz.units import format_ascii


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


def start_pose(design: Design) -> Array:
    """Return the pose (4,) in which an exported model starts: centered, on the natural side.

    Halfway between the least and the greatest distance that its pantographs allow.

    Raises:
        UnreachablePose: If the design has no regular configuration at the center.
    """
    g = design.geometry
    least = max(g.home_span, abs(g.coupler_length - g.crank_length))
    distance = 0.5 * (least + g.coupler_length + g.crank_length)
    height = (
        -design.geometry.knee.sign * math.sqrt(distance**2 - g.home_span**2)
        - g.platform_joint_height
    )
    pose = np.array([0.0, 0.0, 0.0, height])
    if not np.isfinite(posture_of(design, pose).phi).all():
        raise no_posture(pose)
    return pose


def posture_of(design: Design, poses: Array) -> Configuration:
    """Solve poses (..., 4) for a design."""
    return inverse_kinematics(design.geometry, np.asarray(poses, float))


def no_posture(pose: Array) -> UnreachablePose:
    """Return the error for a pose (4,) at which the bars cannot close."""
    x, y, theta, z = (float(value) for value in pose)
    text = (
        f"the bars cannot close at x = {format_ascii(x, 'm', 6)}, y = {format_ascii(y, 'm', 6)}, "
        f"theta = {math.degrees(theta):.6g} deg, z = {format_ascii(z, 'm', 6)}"
    )
    return UnreachablePose((x, y, theta, z), 0, "configuration", 0.0, text)
