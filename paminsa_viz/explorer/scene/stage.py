"""Around the robot: light and ground."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray
from viser import GlbHandle

from paminsa_viz.dimensions.layout import layout
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.scene.context import SceneContext
from paminsa_viz.meshes.bodies import ground_glb, lengths_of
from paminsa_viz.model.design import Geometry
from paminsa_viz.model.kinematics import Configuration

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

SPOT_ABOVE: Final = 0.0012
"""Height of the soft shadow over the ground, for the prototype's bodies [m]."""

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
    """Lights, plinth and a soft shadow below the platform: the layer ``shadows``.

    Without true shadows there is no environment map, and the ground is unlit: reflections cost
    several times as much as all the rest where the browser draws without a graphics card.
    """

    def __init__(self, context: SceneContext) -> None:
        scene = self._scene = context.scene
        scene.configure_default_lights(False)
        scene.configure_environment_map(None)
        self._sky = scene.add_light_hemisphere(
            "/stage/sky", sky_color=SKY, ground_color=FLOOR_GLOW, intensity=SKY_PLAIN
        )
        self._key = scene.add_light_directional(
            "/stage/key", intensity=2.1, position=KEY_LIGHT, cast_shadow=False
        )
        scene.add_light_directional("/stage/fill", intensity=0.7, position=FILL_LIGHT)
        self._drawn: object = None
        self._height = 0.0
        self._ground: GlbHandle | None = None
        self._spot = scene.add_image(
            SHADOW, soft_spot(0.42, 1.6), 0.62, 0.62, cast_shadow=False, receive_shadow=False
        )

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Follow the geometry, the platform, and what is shown."""
        del dragging
        layers = frame.state.layers
        geometry, dark = frame.shown_design.geometry, frame.state.theme.dark
        key = (lengths_of(geometry, "ground"), dark)
        if key != self._drawn:
            self._drawn = key
            self._build(geometry, dark)
        if frame.drawable:
            self._spot.position = self.shadow_place(frame.configuration)
        # Over a map it would only dim the colors, and true shadows need no help.
        self._spot.visible = not layers & {"floor_map", "shadows"}
        self._cast_shadows("shadows" in layers)

    def shadow_place(self, configuration: Configuration) -> tuple[float, float, float]:
        """Return where the soft shadow `SHADOW` lies below the platform [m]."""
        x, y = configuration.pose[:2]
        return (float(x), float(y), self._height)

    def _build(self, geometry: Geometry, dark: bool) -> None:
        self._height = layout(geometry).ground + SPOT_ABOVE * geometry.body_scale
        self._spot.scale = geometry.body_scale
        data = ground_glb(geometry, dark=dark)
        if self._ground is None:
            self._ground = self._scene.add_glb(
                "/stage/ground", data, cast_shadow=False, receive_shadow=False
            )
        else:
            self._ground.glb_data = data

    def _cast_shadows(self, shadows: bool) -> None:
        if shadows == self._key.cast_shadow or self._ground is None:
            return
        self._key.cast_shadow = shadows
        self._sky.intensity = SKY_RICH if shadows else SKY_PLAIN
        self._scene.configure_environment_map(
            "warehouse" if shadows else None, environment_intensity=0.45
        )
        self._ground.receive_shadow = 0.22 if shadows else False
