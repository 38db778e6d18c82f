"""What the actuators give, drawn: arc arrows about the leg axes, an upright arrow for F_4."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray
from viser import MeshHandle, SceneApi

from paminsa_viz import palette
from paminsa_viz.meshes import layers as at
from paminsa_viz.model.design import Geometry
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
    """Return the corners of an upright arrow from the origin for a force as a fraction, + up."""
    fraction = float(np.clip(fraction, -1.0, 1.0))
    along, wide = _rings(fraction, max(abs(fraction) * FULL_LENGTH, 1e-3), 1.0)
    out = np.empty((_RINGS, _SIDES, 3))
    out[..., 0] = wide[:, None] * _COS
    out[..., 1] = wide[:, None] * _SIN
    out[..., 2] = (along if fraction >= 0 else -along)[:, None]
    return out.reshape(-1, 3)


class EffortArrows:
    """Arrows of the torques of M1..M3 and the force of M4; made when first shown.

    Args:
        scene: Scene of a client or a server.
        geometry: Says where the leg axes are.
    """

    def __init__(self, scene: SceneApi, geometry: Geometry, root: str = "/efforts") -> None:
        self._scene = scene
        self._root = root
        self._nodes: list[MeshHandle] = []
        self._fractions = np.zeros(4)
        self._visible = False
        self._lift = 0.0
        self.rebuild(geometry)

    def rebuild(self, geometry: Geometry) -> None:
        """Move the arrows to the leg axes of a geometry."""
        height = ARC_HEIGHT * geometry.knee.sign
        self._seats = [
            (
                geometry.base_radius * float(np.cos(a)),
                geometry.base_radius * float(np.sin(a)),
                height,
            )
            for a in AXIS_ANGLES
        ]
        self._place()

    def values(self, efforts: ArrayLike, full_torque: float, full_force: float) -> None:
        """Draw actuator efforts (4,) = (tau_1, tau_2, tau_3, F_4) [N m, N m, N m, N].

        Args:
            efforts: The values; those that are not finite are not drawn.
            full_torque: Torque of the longest arc [N m]; greater ones are drawn as long.
            full_force: Force of the longest arrow [N].
        """
        scale = np.array([full_torque, full_torque, full_torque, full_force], dtype=np.float64)
        with np.errstate(all="ignore"):
            self._fractions = np.asarray(efforts, dtype=np.float64) / scale
        if self._visible:
            self._draw()

    def pose(self, lift: float) -> None:
        """Carry the force arrow to the height Z of the arms [m]."""
        self._lift = lift
        if self._visible:
            self._place()

    def _draw(self) -> None:
        drawn = np.nan_to_num(self._fractions, nan=0.0, posinf=1.0, neginf=-1.0)
        shapes = [*map(arc_arrow, drawn[:3]), force_arrow(drawn[3])]
        if not self._nodes:
            for index, vertices in enumerate(shapes):
                color = palette.rgb(palette.ACTUATOR_COLORS[index])
                turn = AXIS_ANGLES[index] / 2 if index < 3 else 0.0
                node = self._scene.add_mesh_simple(
                    f"{self._root}/m{index + 1}", vertices.astype(np.float32), FACES,
                    color=color, side="double", cast_shadow=False, receive_shadow=False,
                    wxyz=(float(np.cos(turn)), 0.0, 0.0, float(np.sin(turn))),
                )  # fmt: skip
                self._nodes.append(node)
            self._place()
        else:
            for node, vertices in zip(self._nodes, shapes, strict=True):
                node.vertices = vertices.astype(np.float32)
        for node, fraction in zip(self._nodes, self._fractions, strict=True):
            node.visible = bool(np.isfinite(fraction) and abs(fraction) > 1e-4)

    def _place(self) -> None:
        beside = 0.072 * np.array([np.cos(np.pi / 6), np.sin(np.pi / 6)])
        for node, seat in zip(self._nodes, self._seats, strict=False):
            node.position = seat
        if self._nodes:
            self._nodes[3].position = (float(beside[0]), float(beside[1]), self._lift)

    @property
    def visible(self) -> bool:
        """Whether the arrows are shown."""
        return self._visible

    @visible.setter
    def visible(self, visible: bool) -> None:
        self._visible = visible
        if visible:
            self._place()
            self._draw()
            return
        for node in self._nodes:
            node.visible = False
