"""The mechanism as a stick figure with the paper's joint numbers."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray
from trimesh.creation import icosphere
from viser import BatchedMeshHandle, LabelHandle, LineSegmentsHandle

from paminsa_viz import palette
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.scene.curves import linear_colors
from paminsa_viz.explorer.scene.layers import SceneContext
from paminsa_viz.model.kinematics import Configuration

Array = NDArray[np.float64]

JOINTS: Final = (2, 3, 4, 5, 7, 8, 9)
"""The paper's joint numbers, in the order drawn."""

BARS: Final = ((9, 5), (4, 7), (8, 7), (8, 9), (3, 2))
"""B4, B3, B7, B8 and B2 by their end joints."""

DOT: Final = 0.0085
"""Radius of a joint's dot [m]."""


def sticks(configuration: Configuration) -> Array:
    """Return the stick figure's lines, (3 legs, 9, 2 ends, 3) [m].

    In this order: B4, B3, B7, B8, B2; arm B1; guide link B10; joint 5 to the platform's plane (B5);
    an edge of the platform.
    """
    points, geometry = configuration.points, configuration.geometry
    axis = points[2] * [1.0, 1.0, 0.0]
    outward = axis / geometry.base_radius
    heading = np.stack(
        [np.cos(configuration.beta), np.sin(configuration.beta), np.zeros(3)], axis=-1
    )
    arm = points[2] - geometry.arm_length * outward
    guide = axis - geometry.guide_link_length * heading
    below = points[5].copy()
    below[:, 2] = configuration.pose[3]
    lines = [np.stack([points[a], points[b]], axis=1) for a, b in BARS]
    lines += [
        np.stack(pair, axis=1)
        for pair in (
            (arm, points[2]), (axis, guide), (points[5], below), (below, np.roll(below, 1, axis=0)),
        )
    ]  # fmt: skip
    return np.stack(lines, axis=1)


def stick_colors() -> NDArray[np.uint8]:
    """Return the colors of `sticks`, (3, 9, 2, 3)."""
    legs = linear_colors(*palette.LEG_COLORS)
    out = np.broadcast_to(legs[:, None, None, :], (3, 9, 2, 3)).copy()
    out[:, 4:6] = linear_colors(palette.LIFT_COLOR)
    out[:, 6:] = linear_colors(palette.MUTED)
    return out


class Skeleton:
    """The layer ``skeleton``: stick figure and joint numbers; made when first shown."""

    def __init__(self, context: SceneContext) -> None:
        self._scene = context.scene
        self._configuration: Configuration | None = None
        self._lines: LineSegmentsHandle | None = None
        self._dots: BatchedMeshHandle | None = None
        self._numbers: list[LabelHandle] = []

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Follow the configuration; nothing is sent while hidden."""
        del dragging
        visible = "skeleton" in frame.state.layers and frame.drawable
        if visible and frame.configuration is not self._configuration:
            self._configuration = frame.configuration
            self._draw_bars(frame.configuration)
            self._draw_joints(_joints(frame.configuration))
        for node in (self._lines, self._dots, *self._numbers):
            if node is not None:
                node.visible = visible

    def _draw_bars(self, configuration: Configuration) -> None:
        lines = sticks(configuration).reshape(-1, 2, 3).astype(np.float32)
        if self._lines is None:
            self._lines = self._scene.add_line_segments(
                "/skeleton/lines", lines, stick_colors().reshape(-1, 2, 3),
                thickness=3.5, thickness_units="screen",
            )  # fmt: skip
        self._lines.points = lines

    def _draw_joints(self, joints: NDArray[np.float32]) -> None:
        if self._dots is None:
            ball = icosphere(subdivisions=2, radius=DOT)
            self._dots = self._scene.add_batched_meshes_simple(
                "/skeleton/dots", ball.vertices, ball.faces,
                np.tile([1.0, 0.0, 0.0, 0.0], (len(joints), 1)), joints,
                batched_colors=np.repeat(
                    linear_colors(*palette.LEG_COLORS), len(JOINTS), axis=0
                ),
                lod="off", cast_shadow=False, receive_shadow=False,
            )  # fmt: skip
            self._numbers = [
                self._scene.add_label(
                    f"/skeleton/numbers/{leg}/{joint}", str(joint),
                    font_screen_scale=0.95, anchor="bottom-left",
                )
                for leg in (1, 2, 3)
                for joint in JOINTS
            ]  # fmt: skip
        self._dots.batched_positions = joints
        for number, joint in zip(self._numbers, joints, strict=True):
            number.position = joint


def _joints(configuration: Configuration) -> NDArray[np.float32]:
    """Return the joints of legs 1, 2, 3 in the order of `JOINTS`, (21, 3) [m]."""
    points = np.stack([configuration.points[joint] for joint in JOINTS], axis=1)
    return points.reshape(-1, 3).astype(np.float32)
