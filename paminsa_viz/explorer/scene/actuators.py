"""The actuators in the scene: their names, and arrows of their static torques and of F_4."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray
from viser import MeshHandle

from paminsa_viz import palette
from paminsa_viz.dimensions import layers as at
from paminsa_viz.dimensions.layout import lift_motor_height
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.scene.label_places import SpacedLabels
from paminsa_viz.explorer.scene.layers import SceneContext
from paminsa_viz.model import lift_constant, lumped_coefficients
from paminsa_viz.model.design import Design, Geometry
from paminsa_viz.model.kinematics import AXIS_ANGLES

Array = NDArray[np.float64]

ARC_RADIUS: Final = 0.100
ARC_HEIGHT: Final = at.MOUNT + at.PLATE + 0.026
FULL_TURN: Final = np.radians(300.0)
"""Sweep of an arc at full scale [rad]."""

FULL_LENGTH: Final = 0.26
"""Length of the force arrow at full scale [m]."""

THIN, THICK = 0.0045, 0.0095
"""Radius of an arrow's shaft at zero and at full scale [m]."""

NEXT_TO_LIFT: Final = 0.072 * np.array([np.cos(np.pi / 6), np.sin(np.pi / 6)])
"""Place of the force arrow next to the lift's axis, (x, y) [m]."""

_RINGS, _SIDES = 24, 8

_AROUND: Final = 2 * np.pi * np.arange(_SIDES) / _SIDES
_COS: Final = np.cos(_AROUND)
_SIN: Final = np.sin(_AROUND)


def _skin() -> NDArray[np.uint32]:
    """Return the triangles over a row of rings, the same for every arrow."""
    i, j = np.arange(_SIDES), (np.arange(_SIDES) + 1) % _SIDES
    low = _SIDES * np.arange(_RINGS - 1)[:, None]
    high = low + _SIDES
    pairs = [
        np.stack([low + i, high + j, low + j], -1),
        np.stack([low + i, high + i, high + j], -1),
    ]
    return np.stack(pairs, axis=2).reshape(-1, 3).astype(np.uint32)


FACES: Final = _skin()
"""Triangles of every arrow."""


def _rings(fraction: float, length: float, scale: float) -> tuple[Array, Array]:
    """Return where the rings of an arrow lie along it and how wide they are, both (rings,).

    The shaft is ``length`` long, the head follows; ``scale`` turns meters into units of length.
    """
    radius = THIN + (THICK - THIN) * abs(fraction)
    along = np.empty(_RINGS)
    along[0] = 0.0
    along[1:-2] = np.linspace(0.0, length, _RINGS - 3)
    along[-2:] = length, length + 4.5 * radius * scale
    wide = np.full(_RINGS, radius)
    wide[0] = wide[-1] = 0.0
    wide[-2] = 2.7 * radius
    return along, wide


def arc_arrow(fraction: float) -> Array:
    """Return the corners of an arc arrow about z for a torque as a fraction of full scale.

    Positive values turn counter-clockwise seen from above. The arc's shaft is centered on the
    direction x; values beyond full scale are drawn as full.
    """
    fraction = float(np.clip(fraction, -1.0, 1.0))
    sweep = max(abs(fraction) * FULL_TURN, 1e-3)
    along, wide = _rings(fraction, sweep, 1 / ARC_RADIUS)
    turning = 1.0 if fraction >= 0 else -1.0
    angle = turning * (along - sweep / 2)
    out = np.empty((_RINGS, _SIDES, 3))
    distance = ARC_RADIUS + wide[:, None] * _COS
    out[..., 0] = distance * np.cos(angle)[:, None]
    out[..., 1] = distance * np.sin(angle)[:, None]
    out[..., 2] = wide[:, None] * _SIN
    return out.reshape(-1, 3)


def force_arrow(fraction: float) -> Array:
    """Return the corners of a vertical arrow from the origin for a force as a fraction, + up."""
    fraction = float(np.clip(fraction, -1.0, 1.0))
    along, wide = _rings(fraction, max(abs(fraction) * FULL_LENGTH, 1e-3), 1.0)
    out = np.empty((_RINGS, _SIDES, 3))
    out[..., 0] = wide[:, None] * _COS
    out[..., 1] = wide[:, None] * _SIN
    out[..., 2] = (along if fraction >= 0 else -along)[:, None]
    return out.reshape(-1, 3)


def arrow_scales(design: Design) -> tuple[float, float]:
    """Return the torque [N m] and the force [N] of an arrow at full size.

    They follow the weight of the design, so that the arrows of a balanced one are seen to shrink
    only because its torques do.
    """
    c = lumped_coefficients(design)
    weight = float(abs(c[0]) + abs(c[1]) + abs(c[2]))
    torque = 0.5 * weight * design.geometry.base_radius
    return max(torque, 1e-6), max(1.5 * lift_constant(design), 1e-6)


class TorqueArrows:
    """The layer ``torques``: torques of M1..M3 and the force of M4; made when first shown.

    The longest arrow is a full scale, see `arrow_scales`; greater values are drawn as
    long, and values that are not finite are not drawn.
    """

    def __init__(self, context: SceneContext) -> None:
        self._scene = context.scene
        self._nodes: list[MeshHandle] = []
        self._fractions = np.full(4, np.nan)
        self._geometry: Geometry | None = None

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Follow the torques and the arms; nothing is sent while hidden."""
        del dragging
        if "torques" not in frame.state.layers:
            for node in self._nodes:
                node.visible = False
            return
        torque, force = arrow_scales(frame.shown_design)
        with np.errstate(all="ignore"):
            fractions = frame.torques / [torque, torque, torque, force]
        if not self._nodes or not np.array_equal(fractions, self._fractions, equal_nan=True):
            self._fractions = fractions
            self._draw_arrows()
        for node, fraction in zip(self._nodes, fractions, strict=True):
            node.visible = bool(np.isfinite(fraction) and abs(fraction) > 1e-4)
        geometry = frame.shown_design.geometry
        if geometry is not self._geometry:
            self._geometry = geometry
            for node, angle in zip(self._nodes, AXIS_ANGLES, strict=False):
                x, y = geometry.base_radius * np.array([np.cos(angle), np.sin(angle)])
                node.position = (float(x), float(y), ARC_HEIGHT * geometry.knee.sign)
        if frame.drawable:
            self._nodes[3].position = (*NEXT_TO_LIFT.tolist(), frame.configuration.actuators[3])

    def _draw_arrows(self) -> None:
        drawn = np.nan_to_num(self._fractions, nan=0.0, posinf=1.0, neginf=-1.0)
        shapes = [*map(arc_arrow, drawn[:3]), force_arrow(drawn[3])]
        for index, corners in enumerate(shapes):
            vertices = corners.astype(np.float32)
            if index < len(self._nodes):
                self._nodes[index].vertices = vertices
                continue
            turn = AXIS_ANGLES[index] / 2 if index < 3 else 0.0
            node = self._scene.add_mesh_simple(
                f"/efforts/m{index + 1}", vertices, FACES,
                color=palette.rgb(palette.ACTUATOR_COLORS[index]), side="double",
                cast_shadow=False, receive_shadow=False,
                wxyz=(float(np.cos(turn)), 0.0, 0.0, float(np.sin(turn))),
            )  # fmt: skip
            self._nodes.append(node)


def label_places(geometry: Geometry) -> list[tuple[float, float, float]]:
    """Return the places of the names M1..M4 [m]."""
    radius = geometry.base_radius + 0.165
    height = geometry.knee.sign * (at.MOUNT + at.PLATE + 0.018)
    around = [(float(radius * np.cos(a)), float(radius * np.sin(a)), height) for a in AXIS_ANGLES]
    return [*around, (0.0, 0.0, lift_motor_height(geometry) + 0.02)]


NAME_SIZE: Final = (30.0, 21.0)
"""Width and height of a name on the screen [px]."""


class ActuatorLabels:
    """The layer ``labels``: the names M1..M4 next to their bodies, none over another."""

    def __init__(self, context: SceneContext) -> None:
        self._geometry: Geometry | None = None
        labels = [
            context.scene.add_label(
                f"/actuators/m{number}", f"M{number}", font_screen_scale=1.0,
                anchor="bottom-center",
            )
            for number in (1, 2, 3, 4)
        ]  # fmt: skip
        self._labels = SpacedLabels(labels, NAME_SIZE, context.camera)

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Follow the actuators of the geometry."""
        del dragging
        geometry = frame.shown_design.geometry
        if geometry is not self._geometry:
            self._geometry = geometry
            self._labels.place(np.array(label_places(geometry)))
        self._labels.show("labels" in frame.state.layers)
