"""Ranges of the joints: of each theta_k over the poses that count, and the travel of joint 8."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.core.maps import half_width
from paminsa_viz.explorer.scene.context import SceneContext
from paminsa_viz.explorer.scene.curves import linear_colors
from paminsa_viz.explorer.scene.mechanism import plane_directions
from paminsa_viz.explorer.scene.nodes import Node, Nodes, lines, mesh
from paminsa_viz.kept import kept
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Geometry
from paminsa_viz.model.kinematics import AXIS_ANGLES, LEG_AXES, Configuration, inverse_kinematics
from paminsa_viz.model.reach import check_reach, home_pose
from paminsa_viz.model.singular_limit import CONDITION_LIMIT, near_singularity, serial_margins
from paminsa_viz.model.singularity import measure_singularity
from paminsa_viz.palette import BAD, LEG_COLORS
from paminsa_viz.trajectory.crossing import locus_distances

CELLS: Final = 41
"""Positions along a side of the map by which the range of theta_k is found."""

INNER, OUTER = 0.125, 0.185
"""Radii of a sector beside the prototype's bodies [m]; arrows of the torques turn inside it."""

ABOVE: Final = 0.034
"""Height of what is drawn over the guides' plane, clear of their bodies [m]."""

STEPS: Final = 48
"""Pieces of a sector."""

TICK: Final = 0.022
"""Half the length of the tick at an end of joint 8's travel [m]."""


@kept(16)
def turning_ranges(
    geometry: Geometry, theta: float, z: float, limit: float = CONDITION_LIMIT
) -> tuple[tuple[float, float], ...]:
    """Return from where to where theta_1..theta_3 turn over the workspace at theta and z [rad].

    The range is that of the positions of a grid that count, see `model.singular_limit`, on home's
    side of the singularities. Where there is none it is (0, 0).
    """
    side = np.linspace(-1.0, 1.0, CELLS) * half_width(geometry)
    x, y = (each.ravel() for each in np.meshgrid(side, side))
    poses = np.stack([x, y, np.full_like(x, theta), np.full_like(x, z)], axis=1)
    reach = check_reach(geometry, poses)
    poses = poses[reach.ok]
    if len(poses):
        condition = measure_singularity(geometry, poses).condition
        near = near_singularity(geometry, condition, serial_margins(reach)[reach.ok], limit)
        poses = poses[~near]
        sides = np.sign(locus_distances(geometry, np.vstack([home_pose(geometry), poses])))
        poses = poses[(sides[1:] == sides[0]).all(axis=-1)]
    if not len(poses):
        return ((0.0, 0.0),) * 3
    angles = inverse_kinematics(geometry, poses).actuators[:, :3]
    return tuple(around(angles[:, leg]) for leg in range(3))


def around(angles: Array) -> tuple[float, float]:
    """Return the shortest arc that holds angles (n,), from where to where [rad]."""
    found = np.sort(np.mod(angles[np.isfinite(angles)], 2 * np.pi))
    if not len(found):
        return 0.0, 0.0
    gaps = np.diff(found, append=found[0] + 2 * np.pi)
    widest = int(gaps.argmax())
    start = float(found[(widest + 1) % len(found)])
    width = max(2 * np.pi - float(gaps[widest]), 0.0)
    start -= 2 * np.pi * np.round((start + width / 2) / (2 * np.pi))
    return start, start + width


def sector(start: float, end: float, size: float = 1.0) -> tuple[Array, NDArray[np.uint32]]:
    """Return a flat sector about z as points (n, 3) [m] and faces (m, 3).

    Args:
        start, end: Its angles [rad].
        size: Size of the bodies over the prototype's.
    """
    angle = np.linspace(start, end, STEPS + 1)
    ring = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    i = np.arange(STEPS)
    inner, outer = i, i + STEPS + 1
    faces = np.concatenate(
        [np.stack([inner, outer, outer + 1], 1), np.stack([inner, outer + 1, inner + 1], 1)]
    )
    points = np.concatenate([INNER * ring, OUTER * ring])
    return size * points, faces.astype(np.uint32)


def marks(configuration: Configuration) -> Array:
    """Return the lines of every leg, (3, 5, 2, 3) [m].

    In this order: where theta_k is in its sector, the travel of joint 8, a tick at each of its
    ends, and a tick where joint 8 is.
    """
    geometry = configuration.geometry
    size = geometry.body_scale
    axis = configuration.points[2] * [1.0, 1.0, 0.0]
    axis[:, 2] = size * ABOVE * geometry.knee.sign
    heading, across = plane_directions(configuration)
    place8 = np.einsum("li,li->l", configuration.points[8] - axis, heading)[:, None]
    stroke = geometry.stroke
    low, high, here = (axis + end * heading for end in (-stroke, stroke, place8))
    across *= size * TICK
    pairs = [(axis + size * INNER * heading, axis + size * OUTER * heading), (low, high)]
    pairs += [(place - across, place + across) for place in (low, high, here)]
    return np.stack([np.stack(pair, axis=1) for pair in pairs], axis=1)


class JointLimits:
    """The layer ``joint_limits``."""

    def __init__(self, context: SceneContext) -> None:
        self._nodes = Nodes(context.scene)
        self._sectors: tuple[Node, ...] = ()
        self._key: tuple[object, ...] = ()

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Follow the pose; sectors follow theta and z when nothing is dragged."""
        if "joint_limits" not in frame.state.layers or not frame.drawable:
            self._nodes.show(())
            return
        configuration = frame.configuration
        geometry, pose = configuration.geometry, configuration.pose
        key = (geometry, float(pose[2]), float(pose[3]), frame.state.condition_limit)
        if key != self._key and (not dragging or not self._sectors):
            self._key = key
            self._sectors = tuple(_sector_nodes(geometry, turning_ranges(*key)))
        found = marks(configuration).reshape(-1, 2, 3)
        self._nodes.show((*self._sectors, lines("/joint_limits/lines", found, mark_colors(), 3.5)))


def _sector_nodes(geometry: Geometry, ranges: tuple[tuple[float, float], ...]) -> Iterator[Node]:
    size = geometry.body_scale
    height = size * ABOVE * geometry.knee.sign
    for leg, (start, end) in enumerate(ranges):
        # theta_k is counted from the direction toward the robot's axis
        zero = AXIS_ANGLES[leg] + np.pi
        yield mesh(
            f"/joint_limits/theta_{leg + 1}", *sector(start + zero, end + zero, size),
            LEG_COLORS[leg], place=(*geometry.base_radius * LEG_AXES[leg], height),
            opacity=0.35, flat_shading=True,
        )  # fmt: skip


def mark_colors() -> NDArray[np.uint8]:
    """Return the colors of `marks`, (15, 2, 3)."""
    colors = linear_colors(*LEG_COLORS)[:, None, None].repeat(5, 1).repeat(2, 2)
    colors[:, 2:4] = linear_colors(BAD)
    return colors.reshape(-1, 2, 3)
