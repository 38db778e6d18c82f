"""Light and ground around the robot."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray
from viser import SceneApi

from paminsa_viz.meshes.bodies import body_glb, lengths_of
from paminsa_viz.meshes.layout import layout
from paminsa_viz.model.design import Geometry

SKY_PLAIN: Final = 1.75
SKY_RICH: Final = 0.55
"""Light from the sky without and with an environment map, which brings light of its own."""

KEY_LIGHT: Final = (1.6, -2.2, 3.0)
FILL_LIGHT: Final = (-2.0, -1.2, 0.4)
"""Directions that the two lamps shine from."""

SKY: Final = (255, 255, 255)
FLOOR_GLOW: Final = (168, 174, 184)
"""Colors of the light from above and from below."""

SHADE_PIXELS: Final = 128

SHADOW: Final = "/stage/ground/below"
"""Scene name of the soft shadow below the platform."""


def soft_spot(strength: float, sharpness: float = 2.0) -> NDArray[np.uint8]:
    """Return a round soft shadow as an RGBA image, darkest in the middle."""
    axis = np.linspace(-1.0, 1.0, SHADE_PIXELS)
    distance = np.hypot(*np.meshgrid(axis, axis))
    alpha = strength * np.clip(1.0 - distance, 0.0, 1.0) ** sharpness
    image = np.zeros((SHADE_PIXELS, SHADE_PIXELS, 4))
    image[..., :3] = (31, 41, 51)
    image[..., 3] = 255 * alpha
    return np.rint(image).astype(np.uint8)


class Stage:
    """Lights, plinth and a soft shadow below the platform, which is all a pose moves.

    Unless `shadows` asks for it there is no environment map, and the ground is unlit: reflections
    cost several times as much as all the rest where the browser draws without a graphics card.

    Args:
        scene: Scene of a client or a server.
        geometry: Lengths that the plinth's size follows.
    """

    def __init__(self, scene: SceneApi, geometry: Geometry) -> None:
        scene.configure_default_lights(False)
        scene.configure_environment_map(None)
        self._scene = scene
        self._sky = scene.add_light_hemisphere(
            "/stage/sky", sky_color=SKY, ground_color=FLOOR_GLOW, intensity=SKY_PLAIN
        )
        self._key = scene.add_light_directional(
            "/stage/key", intensity=2.1, position=KEY_LIGHT, cast_shadow=False
        )
        scene.add_light_directional("/stage/fill", intensity=0.7, position=FILL_LIGHT)
        self._lengths = lengths_of("ground", geometry)
        self._ground = scene.add_glb(
            "/stage/ground",
            body_glb("ground", geometry, fine=False),
            cast_shadow=False,
            receive_shadow=False,
        )
        self._below = scene.add_image(
            SHADOW,
            soft_spot(0.42, 1.6),
            0.62,
            0.62,
            cast_shadow=False,
            receive_shadow=False,
        )
        self._place(geometry)

    def rebuild(self, geometry: Geometry) -> bool:
        """Remake the ground if its size or height changed; return whether it did."""
        lengths = lengths_of("ground", geometry)
        if lengths == self._lengths:
            return False
        self._lengths = lengths
        self._ground.glb_data = body_glb("ground", geometry, fine=False)
        self._place(geometry)
        return True

    def _place(self, geometry: Geometry) -> None:
        self._height = layout(geometry).ground
        self._below.position = (0.0, 0.0, self._height + 0.0012)

    def pose(self, x: float, y: float) -> None:
        """Move the soft shadow below the platform [m]."""
        self._below.position = self.shadow_place(x, y)

    def shadow_place(self, x: float, y: float) -> tuple[float, float, float]:
        """Return where the soft shadow `SHADOW` lies below the platform [m]."""
        return (x, y, self._height + 0.0012)

    @property
    def visible(self) -> bool:
        """Whether the ground is shown; the light stays."""
        return self._ground.visible

    @visible.setter
    def visible(self, visible: bool) -> None:
        self._ground.visible = visible

    @property
    def spot(self) -> bool:
        """Whether the soft shadow below the platform is shown."""
        return self._below.visible

    @spot.setter
    def spot(self, visible: bool) -> None:
        self._below.visible = visible

    @property
    def shadows(self) -> bool:
        """Whether there are true shadows and reflections; without a graphics card they are slow."""
        return self._key.cast_shadow

    @shadows.setter
    def shadows(self, shadows: bool) -> None:
        if shadows == self._key.cast_shadow:
            return
        self._key.cast_shadow = shadows
        self._sky.intensity = SKY_RICH if shadows else SKY_PLAIN
        self._scene.configure_environment_map(
            "warehouse" if shadows else None, environment_intensity=0.45
        )
        self._ground.receive_shadow = 0.22 if shadows else False
