"""Names of the actuators beside their bodies."""

from __future__ import annotations

import numpy as np
from viser import LabelHandle, SceneApi

from paminsa_viz.meshes import layers as at
from paminsa_viz.meshes.frame import lift_motor_height
from paminsa_viz.model.design import Geometry
from paminsa_viz.model.kinematics import AXIS_ANGLES


def label_places(geometry: Geometry) -> list[tuple[float, float, float]]:
    """Return where the names of M1..M4 stand [m]."""
    radius = geometry.base_radius + 0.165
    height = geometry.knee.sign * (at.MOUNT + at.PLATE + 0.018)
    around = [(float(radius * np.cos(a)), float(radius * np.sin(a)), height) for a in AXIS_ANGLES]
    return [*around, (0.0, 0.0, lift_motor_height(geometry) + 0.02)]


class ActuatorLabels:
    """The names M1..M4 in the scene."""

    def __init__(self, scene: SceneApi, geometry: Geometry, root: str = "/actuators") -> None:
        self._labels: list[LabelHandle] = [
            scene.add_label(
                f"{root}/m{i + 1}",
                f"M{i + 1}",
                position=place,
                font_screen_scale=1.0,
                anchor="bottom-center",
            )
            for i, place in enumerate(label_places(geometry))
        ]

    def rebuild(self, geometry: Geometry) -> None:
        """Move the names to the actuators of a geometry."""
        for label, place in zip(self._labels, label_places(geometry), strict=True):
            label.position = place

    @property
    def visible(self) -> bool:
        """Whether the names are shown."""
        return self._labels[0].visible

    @visible.setter
    def visible(self, visible: bool) -> None:
        for label in self._labels:
            label.visible = visible
