"""The mechanism as a stick figure with the paper's joint numbers."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray
from trimesh.creation import icosphere
from viser import BatchedMeshHandle, LabelHandle, LineSegmentsHandle, SceneApi

from paminsa_viz import palette
from paminsa_viz.explorer.scene.tint import drawn
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
    legs = drawn(*palette.LEG_COLORS)
    out = np.broadcast_to(legs[:, None, None, :], (3, 9, 2, 3)).copy()
    out[:, 4:6] = drawn(palette.LIFT_COLOR)
    out[:, 6:] = drawn(palette.MUTED)
    return out


class Skeleton:
    """Stick figure and joint numbers; the nodes are made when first shown."""

    def __init__(self, scene: SceneApi, root: str = "/skeleton") -> None:
        self._scene = scene
        self._root = root
        self._posture: Configuration | None = None
        self._lines: LineSegmentsHandle | None = None
        self._dots: BatchedMeshHandle | None = None
        self._labels: list[LabelHandle] = []
        self._visible = self._numbered = False

    def pose(self, configuration: Configuration) -> None:
        """Follow a configuration of shape (); nothing is sent while hidden."""
        self._posture = configuration
        if self._visible:
            self._draw(configuration)
        if self._numbered:
            self._number(configuration)

    def _draw(self, configuration: Configuration) -> None:
        lines = sticks(configuration).reshape(-1, 2, 3).astype(np.float32)
        dots = _dots(configuration)
        if self._lines is None or self._dots is None:
            self._lines = self._scene.add_line_segments(
                f"{self._root}/lines", lines, stick_colors().reshape(-1, 2, 3),
                thickness=3.5, thickness_units="screen",
            )  # fmt: skip
            ball = icosphere(subdivisions=2, radius=DOT)
            self._dots = self._scene.add_batched_meshes_simple(
                f"{self._root}/dots", ball.vertices, ball.faces,
                np.tile([1.0, 0.0, 0.0, 0.0], (len(dots), 1)), dots,
                batched_colors=np.repeat(drawn(*palette.LEG_COLORS), len(JOINTS), axis=0),
                lod="off", cast_shadow=False, receive_shadow=False,
            )  # fmt: skip
            return
        self._lines.points = lines
        self._dots.batched_positions = dots

    def _number(self, configuration: Configuration) -> None:
        dots = _dots(configuration)
        if not self._labels:
            names = [(leg, joint) for leg in (1, 2, 3) for joint in JOINTS]
            self._labels = [
                self._scene.add_label(
                    f"{self._root}/numbers/{leg}/{joint}",
                    str(joint),
                    position=dot,
                    font_screen_scale=0.95,
                    anchor="bottom-left",
                )
                for (leg, joint), dot in zip(names, dots, strict=True)
            ]
            return
        for label, dot in zip(self._labels, dots, strict=True):
            label.position = dot

    @property
    def visible(self) -> bool:
        """Whether the stick figure is shown."""
        return self._visible

    @visible.setter
    def visible(self, visible: bool) -> None:
        self._visible = visible
        if visible and self._posture is not None:
            self._draw(self._posture)
        for node in (self._lines, self._dots):
            if node is not None:
                node.visible = visible

    @property
    def numbered(self) -> bool:
        """Whether the joints carry the paper's numbers."""
        return self._numbered

    @numbered.setter
    def numbered(self, numbered: bool) -> None:
        self._numbered = numbered
        if numbered and self._posture is not None:
            self._number(self._posture)
        for label in self._labels:
            label.visible = numbered


def _dots(configuration: Configuration) -> NDArray[np.float32]:
    """Return the joints of legs 1, 2, 3 in the order of `JOINTS`, (21, 3) [m]."""
    points = np.stack([configuration.points[joint] for joint in JOINTS], axis=1)
    return points.reshape(-1, 3).astype(np.float32)
