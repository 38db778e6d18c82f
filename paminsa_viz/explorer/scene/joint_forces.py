"""Forces at the joints as arrows, and the bars colored by their utilization."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray
from trimesh.creation import cylinder
from viser import ArrowsHandle, BatchedMeshHandle, LabelHandle

from paminsa_viz import palette
from paminsa_viz.dimensions.layers import LAYER, SHAFT_RADIUS, TUBE_RADIUS
from paminsa_viz.elastostatics.joint_forces import JOINTS, JointForces
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.loads import bars_at, forces_at, instant
from paminsa_viz.explorer.scene.curves import linear_colors
from paminsa_viz.explorer.scene.forces import BAR, force_scale, scale_text
from paminsa_viz.explorer.scene.layers import SceneContext
from paminsa_viz.explorer.scene.mechanism import sticks
from paminsa_viz.explorer.scene.path import PathScale, hue_colors
from paminsa_viz.model import Limit
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.elastic import BARS
from paminsa_viz.model.kinematics import Configuration
from paminsa_viz.units import number

LONGEST: Final = 0.30
"""Longest arrow of a joint force [m]."""

ABOVE: Final = 0.10
"""Height of the label over the highest joint 2 [m]."""

SLEEVES: Final = {bar: radius + 0.0015 for bar, radius in TUBE_RADIUS.items()} | {
    "b2": SHAFT_RADIUS + 0.0015, "b1": 0.021, "b10": 0.017,
}  # fmt: skip
"""Radii of the colored sleeves about the bars [m]."""

PLACES: Final = {"m": 3, "guide": 8, "8_b8": 8, "8_b7": 8}
"""Joints by key whose place is another joint's; M_k is on the leg axis, at the guides' height."""

_STICKS: Final = ("b4", "b3", "b7", "b8", "b2", "b1", "b10")
"""Bars in the order of `mechanism.sticks`."""


def force_arrows(forces: JointForces, configuration: Configuration) -> tuple[Array, float]:
    """Return the arrows from the joints, (30, 2, 3) [m], and their scale [N for `BAR`].

    Each is the force on the body nearer to the platform, in the leg's plane; at joint 5 in space.
    """
    beta = configuration.beta
    zero = np.zeros(3)
    radial = np.stack([np.cos(beta), np.sin(beta), zero], axis=-1)
    across = np.stack([-np.sin(beta), np.cos(beta), zero], axis=-1)
    scale = force_scale(float(forces.magnitude.max()), LONGEST)
    starts, ends = [], []
    for index, joint in enumerate(JOINTS):
        start = configuration.points[PLACES.get(joint.key) or int(joint.key)].copy()
        if joint.key == "m":
            start[:, 2] = 0.0
        r, t, z = np.nan_to_num(forces.force[:, index]).T[..., None]
        force = r * radial + t * across + z * np.array([0.0, 0.0, 1.0])
        starts.append(start)
        ends.append(start + force * (BAR / scale))
    arrows = np.stack([np.stack(starts, axis=1), np.stack(ends, axis=1)], axis=2)
    return arrows.reshape(-1, 2, 3), scale


class JointForceView:
    """The layers ``joint_forces`` and ``utilization``; at rest, or of a motion that is played."""

    def __init__(self, context: SceneContext) -> None:
        self._scene = context.scene
        self._motions = context.motions
        self._drawn: tuple[object, ...] = ()
        self._arrows: ArrowsHandle | None = None
        self._sleeves: BatchedMeshHandle | None = None
        self._labels: dict[str, LabelHandle] = {}

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Follow design, pose and motion; nothing is sent while hidden."""
        del dragging
        state = frame.state
        shown = state.layers & {"joint_forces", "utilization"} if frame.drawable else frozenset()
        known = False
        if shown:
            playing = state.playback.following and self._motions is not None
            analysis = self._motions.analysis(state) if playing and self._motions else None
            at = instant(
                frame.shown_design, frame.configuration.pose, analysis, state.playback.time
            )
            forces = forces_at(at)
            known = bool(forces.status == Limit.OK)
            if known and (shown, at) != self._drawn:
                self._drawn = (shown, at)
                if "joint_forces" in shown:
                    self._draw_arrows(forces, frame.configuration)
                if "utilization" in shown:
                    self._draw_sleeves(bars_at(at)[1], frame.configuration)
        if self._arrows is not None:
            self._arrows.colors = linear_colors(state.theme.ink)[0]
        for key, nodes in (
            ("joint_forces", (self._arrows, self._labels.get("joint_forces"))),
            ("utilization", (self._sleeves, self._labels.get("utilization"))),
        ):
            for node in nodes:
                if node is not None:
                    node.visible = known and key in shown

    def _draw_arrows(self, forces: JointForces, configuration: Configuration) -> None:
        arrows, scale = force_arrows(forces, configuration)
        points = arrows.astype(np.float32)
        if self._arrows is None:
            self._arrows = self._scene.add_arrows(
                "/joint_forces/arrows", points, linear_colors(palette.INK)[0],
                shaft_radius=0.0035, head_radius=0.009, head_length=0.022,
            )  # fmt: skip
        self._arrows.points = points
        size = forces.magnitude
        leg, index = np.unravel_index(int(size.argmax()), size.shape)
        text = f"largest {number(float(size.max()), 3)} N at joint {JOINTS[index].label}"
        text += f", leg {leg + 1} ({scale_text(scale)})"
        self._label("joint_forces", text, configuration, 1.0)

    def _draw_sleeves(self, use: Array, configuration: Configuration) -> None:
        largest = float(use.max())
        lines = bar_lines(configuration)
        values = use[:, [BARS.index(bar) for bar in _STICKS]].reshape(-1)
        colors = hue_colors(values, PathScale(0.0, max(largest, 1e-12)))
        positions, turns, scales = sleeve_places(lines)
        if self._sleeves is None:
            tube = cylinder(radius=1.0, height=1.0, sections=20)
            self._sleeves = self._scene.add_batched_meshes_simple(
                "/joint_forces/bars", tube.vertices, tube.faces, turns, positions,
                batched_scales=scales, batched_colors=colors,
                lod="off", cast_shadow=False, receive_shadow=False,
            )  # fmt: skip
        self._sleeves.batched_positions = positions
        self._sleeves.batched_wxyzs = turns
        self._sleeves.batched_scales = scales
        self._sleeves.batched_colors = colors
        leg, index = np.unravel_index(int(use.argmax()), use.shape)
        text = f"stress up to {number(100 * largest, 2)} % of yield, {BARS[index].upper()} of leg "
        text += f"{leg + 1} (light; dark is 0)"
        self._label("utilization", text, configuration, 1.6)

    def _label(self, key: str, text: str, configuration: Configuration, high: float) -> None:
        label = self._labels.get(key)
        if label is None:
            label = self._labels[key] = self._scene.add_label(
                f"/joint_forces/label_{key}", text, font_screen_scale=0.9, anchor="bottom-center"
            )
        label.text = text
        top = float(configuration.actuators[3])
        label.position = np.array([0.0, 0.0, top + high * ABOVE])


def bar_lines(configuration: Configuration) -> Array:
    """Return the bars' center lines as they are drawn, beside the leg's plane, (21, 2, 3) [m]."""
    lines = sticks(configuration)[:, : len(_STICKS)].copy()
    beta = configuration.beta
    across = np.stack([-np.sin(beta), np.cos(beta), np.zeros(3)], axis=-1)
    aside = np.array([LAYER.get(bar, 0.0) for bar in _STICKS])
    lines += aside[:, None, None] * across[:, None, None, :]
    return lines.reshape(-1, 2, 3)


def sleeve_places(
    lines: Array,
) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32]]:
    """Return middles, quaternions and scales of cylinders along z that cover lines (n, 2, 3)."""
    along = lines[:, 1] - lines[:, 0]
    length = np.linalg.norm(along, axis=1)
    direction = along / np.maximum(length, 1e-12)[:, None]
    # half the turn from z to the direction; a line straight down is turned about x
    turns = np.stack(
        [1 + direction[:, 2], -direction[:, 1], direction[:, 0], np.zeros(len(lines))], axis=1
    )
    turns[direction[:, 2] < -1 + 1e-9] = [0.0, 1.0, 0.0, 0.0]
    turns /= np.linalg.norm(turns, axis=1)[:, None]
    radius = np.tile([SLEEVES[bar] for bar in _STICKS], len(lines) // len(_STICKS))
    scales = np.stack([radius, radius, length], axis=1)
    middles = lines.mean(axis=1)
    return middles.astype(np.float32), turns.astype(np.float32), scales.astype(np.float32)
