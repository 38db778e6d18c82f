"""The mechanism as a stick figure with the paper's joint numbers, and its mass centers."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from trimesh.creation import icosphere
from viser import ArrowsHandle, BatchedMeshHandle, LineSegmentsHandle

from paminsa_viz import palette
from paminsa_viz.dimensions.attached import payload_center
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.scene.curves import linear_colors
from paminsa_viz.explorer.scene.label_places import SpacedLabels
from paminsa_viz.explorer.scene.layers import SceneContext
from paminsa_viz.model.design import Design
from paminsa_viz.model.kinematics import Configuration
from paminsa_viz.model.leg_points import bar_length
from paminsa_viz.model.parameters import Counterweight

Array = NDArray[np.float64]

JOINTS: Final = (2, 3, 4, 5, 7, 8, 9)
"""The paper's joint numbers, in the order drawn."""

BARS: Final = {"b4": (9, 5), "b3": (4, 7), "b7": (8, 7), "b8": (8, 9), "b2": (3, 2)}
"""End joints of the bars, in the order drawn; a bar's mass center is midway between them."""

DOT: Final = 0.0085
"""Radius of a joint's dot [m]."""

NUMBER_SIZE: Final = (16.0, 20.0)
"""Width and height of a joint's number on the screen [px]."""


def _directions(configuration: Configuration) -> tuple[Array, Array, Array]:
    """Return the legs' axes, (3, 3) [m], and the directions of their arms and of their planes."""
    axis = configuration.points[2] * [1.0, 1.0, 0.0]
    beta = configuration.beta
    heading = np.stack([np.cos(beta), np.sin(beta), np.zeros(3)], axis=-1)
    return axis, axis / configuration.geometry.base_radius, heading


def sticks(configuration: Configuration) -> Array:
    """Return the stick figure's lines, (3 legs, 9, 2 ends, 3) [m].

    In this order: B4, B3, B7, B8, B2; arm B1; guide link B10; joint 5 to the platform's plane (B5);
    an edge of the platform.
    """
    points, geometry = configuration.points, configuration.geometry
    axis, outward, heading = _directions(configuration)
    arm = points[2] - geometry.arm_length * outward
    guide = axis - geometry.guide_link_length * heading
    below = points[5].copy()
    below[:, 2] = configuration.pose[3]
    lines = [np.stack([points[a], points[b]], axis=1) for a, b in BARS.values()]
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
        self._scene, self._camera = context.scene, context.camera
        self._configuration: Configuration | None = None
        self._lines: LineSegmentsHandle | None = None
        self._dots: BatchedMeshHandle | None = None
        self._numbers: SpacedLabels | None = None

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Follow the configuration; nothing is sent while hidden."""
        del dragging
        visible = "skeleton" in frame.state.layers and frame.drawable
        if visible and frame.configuration is not self._configuration:
            self._configuration = frame.configuration
            self._draw_bars(frame.configuration)
            self._draw_joints(_joints(frame.configuration))
        for node in (self._lines, self._dots):
            if node is not None:
                node.visible = visible
        if self._numbers is not None:
            self._numbers.show(visible)

    def _draw_bars(self, configuration: Configuration) -> None:
        lines = sticks(configuration).reshape(-1, 2, 3).astype(np.float32)
        if self._lines is None:
            self._lines = self._scene.add_line_segments(
                "/skeleton/lines", lines, stick_colors().reshape(-1, 2, 3),
                thickness=3.5, thickness_units="screen",
            )  # fmt: skip
        self._lines.points = lines

    def _draw_joints(self, joints: NDArray[np.float32]) -> None:
        if self._dots is None or self._numbers is None:
            ball = icosphere(subdivisions=2, radius=DOT)
            self._dots = self._scene.add_batched_meshes_simple(
                "/skeleton/dots", ball.vertices, ball.faces,
                np.tile([1.0, 0.0, 0.0, 0.0], (len(joints), 1)), joints,
                batched_colors=np.repeat(
                    linear_colors(*palette.LEG_COLORS), len(JOINTS), axis=0
                ),
                lod="off", cast_shadow=False, receive_shadow=False,
            )  # fmt: skip
            labels = [
                self._scene.add_label(
                    f"/skeleton/numbers/{leg}/{joint}", str(joint),
                    font_screen_scale=0.95, anchor="bottom-left",
                )
                for leg in (1, 2, 3)
                for joint in JOINTS
            ]  # fmt: skip
            self._numbers = SpacedLabels(labels, NUMBER_SIZE, self._camera)
        self._dots.batched_positions = joints
        self._numbers.place(joints.astype(np.float64))


def _joints(configuration: Configuration) -> NDArray[np.float32]:
    """Return the joints of legs 1, 2, 3 in the order of `JOINTS`, (21, 3) [m]."""
    points = np.stack([configuration.points[joint] for joint in JOINTS], axis=1)
    return points.reshape(-1, 3).astype(np.float32)


Array = NDArray[np.float64]

LINKS: Final = ("b1", "b2", "b3", "b4", "b7", "b8", "b10")

BALL: Final = 0.0225
"""Radius of the sphere of 1 kg [m]."""

ARROW_PER_NEWTON: Final = 0.010
LONGEST_ARROW: Final = 0.30
SHORTEST_ARROW: Final = 0.020
"""Length of a gravity arrow [m/N], and its bounds [m]."""


class PointMasses(NamedTuple):
    """Mass centers (n, 3) [m], masses (n,) [kg] and colors (n, 3)."""

    center: Array
    mass: Array
    color: NDArray[np.uint8]


def mass_centers(design: Design, configuration: Configuration) -> PointMasses:
    """Return every mass that the statics know, where it is in a configuration of shape ().

    Legs 1, 2, 3 in turn (joints 2, 3, 4, 5, 7, 8, 9, then links B1, B2, B3, B4, B7, B8, B10), then
    the platform and the payload, then the counterweights of leg 1, of leg 2, of leg 3.
    """
    geometry, points = configuration.geometry, configuration.points
    axis, outward, heading = _directions(configuration)
    centers = [points[joint] for joint in JOINTS]
    masses = [getattr(design.joints, f"j{joint}") for joint in JOINTS]
    for link in LINKS:
        if link == "b1":
            centers.append(points[2] - geometry.arm_length / 2 * outward)
        elif link == "b10":
            centers.append(axis - geometry.guide_link_length / 2 * heading)
        else:
            a, b = BARS[link]
            centers.append((points[a] + points[b]) / 2)
        masses.append(getattr(design.links, link))
    legs = np.stack(centers, axis=1).reshape(-1, 3)
    x, y, _, z = configuration.pose
    platform = np.array([x, y, z])
    load = platform + payload_center(geometry, design.payload.mass)
    leg_colors = linear_colors(*palette.LEG_COLORS)
    ends = linear_colors(palette.INK, palette.WARN)
    weights = design.counterweights
    attached = [_counterweight_places(configuration, weight) for weight in weights]
    added = np.stack(attached, axis=1).reshape(-1, 3) if attached else np.empty((0, 3))
    return PointMasses(
        np.vstack([legs, platform, load, added]),
        np.array(
            [*masses * 3, design.platform.mass, design.payload.mass, *[w.mass for w in weights] * 3]
        ),
        np.vstack(
            [leg_colors.repeat(len(masses), axis=0), ends, leg_colors.repeat(len(attached), axis=0)]
        ),
    )


def _counterweight_places(configuration: Configuration, weight: Counterweight) -> Array:
    """Return where a counterweight is on the three legs, (3, 3) [m]."""
    near, far = configuration.points[weight.joint], configuration.points[weight.other]
    return near + weight.beyond / bar_length(configuration.geometry, weight.bar) * (near - far)


def newtons_per_bar(points: PointMasses, gravity: float) -> float:
    """Return the weight that 100 mm of an arrow stand for [N]."""
    heaviest = float((points.mass * gravity).max(initial=0.0))
    return 0.1 * max(1 / ARROW_PER_NEWTON, heaviest / LONGEST_ARROW)


def gravity_arrows(points: PointMasses, gravity: float) -> Array:
    """Return arrows from the mass centers downward, (n, 2, 3) [m], their length by the weight."""
    weight = points.mass * gravity
    length = weight * 0.1 / newtons_per_bar(points, gravity)
    length = np.where(weight > 0, np.maximum(length, SHORTEST_ARROW), 0.0)
    tips = points.center.copy()
    tips[:, 2] -= length
    return np.stack([points.center, tips], axis=1)


class PointMassView:
    """The layers ``mass_centers`` and ``gravity``; the nodes are made when first shown."""

    def __init__(self, context: SceneContext) -> None:
        self._scene = context.scene
        self._drawn: tuple[object, ...] = ()
        self._configuration: Configuration | None = None
        self._balls: BatchedMeshHandle | None = None
        self._arrows: ArrowsHandle | None = None

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Follow masses and configuration; nothing is sent while hidden."""
        del dragging
        shown = frame.state.layers & {"mass_centers", "gravity"} if frame.drawable else frozenset()
        design, configuration = frame.shown_design, frame.configuration
        key = (shown, design)
        if shown and (key != self._drawn or configuration is not self._configuration):
            self._drawn, self._configuration = key, configuration
            points = mass_centers(design, configuration)
            if "mass_centers" in shown:
                self._draw_balls(points)
            if "gravity" in shown:
                self._draw_arrows(points, design.gravity)
        if self._balls is not None:
            self._balls.visible = "mass_centers" in shown
        if self._arrows is not None:
            self._arrows.visible = "gravity" in shown
            self._arrows.colors = linear_colors(frame.state.theme.ink)[0]

    def _draw_balls(self, points: PointMasses) -> None:
        centers = points.center.astype(np.float32)
        scales = np.cbrt(points.mass).astype(np.float32)
        if self._balls is not None and len(self._balls.batched_positions) != len(centers):
            self._balls.remove()
            self._balls = None
        if self._balls is None:
            ball = icosphere(subdivisions=2, radius=BALL)
            self._balls = self._scene.add_batched_meshes_simple(
                "/masses/centers", ball.vertices, ball.faces,
                np.tile([1.0, 0.0, 0.0, 0.0], (len(centers), 1)), centers,
                batched_scales=scales, batched_colors=points.color,
                lod="off", cast_shadow=False, receive_shadow=False,
            )  # fmt: skip
        self._balls.batched_positions = centers
        self._balls.batched_scales = scales

    def _draw_arrows(self, points: PointMasses, gravity: float) -> None:
        arrows = gravity_arrows(points, gravity).astype(np.float32)
        if self._arrows is None:
            self._arrows = self._scene.add_arrows(
                "/masses/gravity", arrows, linear_colors(palette.INK)[0],
                shaft_radius=0.0028, head_radius=0.0075, head_length=0.018,
            )  # fmt: skip
        self._arrows.points = arrows
