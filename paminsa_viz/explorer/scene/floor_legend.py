"""The legend next to the map on the ground: what its colors mean.

The colors lie on the ground; name and numbers are next to them in letters of one size on the
screen, which stay legible however flat a camera looks at the ground.
"""

from __future__ import annotations

from typing import Any, Final

import numpy as np
import viser
from numpy.typing import NDArray

from paminsa_viz.dimensions.layout import plinth_radius
from paminsa_viz.model import Geometry
from paminsa_viz.model.reach import workspace_radius
from paminsa_viz.palette import INK, rgb
from paminsa_viz.plots.map_data import MapData
from paminsa_viz.plots.scale import OVER, UNDER, Scale, color_table
from paminsa_viz.units import number

LEGEND_SIZE: Final = (0.44, 0.04)
"""Width and height of the colored bar on the ground [m]."""
PIXELS: Final = 440
"""Pixels along the width."""
DIRECTION: Final = np.radians(-52.0)
"""Where it lies, seen from the robot's axis: in front for the 3D camera."""
LETTERS: Final = 0.72
"""Size of the letters, as a share of that of the actuators' names."""


def legend_place(
    geometry: Geometry,
) -> tuple[tuple[float, float], tuple[float, float, float, float]]:
    """Return where the legend's center lies (x, y) [m] and how it is turned (wxyz)."""
    half_width, height = LEGEND_SIZE[0] / 2, LEGEND_SIZE[1]
    # Next to the map, but not so far out that its outer corners leave the plinth.
    outer = np.sqrt(max((plinth_radius(geometry) - 0.03) ** 2 - half_width**2, 0.0))
    near = workspace_radius(geometry) + height / 2 + 0.03
    radius = float(max(min(near, outer - height / 2), height))
    turn = DIRECTION + np.pi / 2
    place = (radius * float(np.cos(DIRECTION)), radius * float(np.sin(DIRECTION)))
    return place, (float(np.cos(turn / 2)), 0.0, 0.0, float(np.sin(turn / 2)))


def legend_image(scale: Scale) -> NDArray[np.uint8]:
    """Draw the colors from low to high between arrows for what lies beyond, as RGBA, clear around.

    Row 0 is at the bottom.
    """
    rows = round(PIXELS * LEGEND_SIZE[1] / LEGEND_SIZE[0])
    arrow = round(0.8 * rows)
    table = color_table(scale)[:, :3]
    length = PIXELS - 2 * arrow
    image = np.zeros((rows, PIXELS, 4), dtype=np.uint8)
    image[..., :3] = rgb(INK)
    image[:, arrow:-arrow, :3] = table[1 + (np.arange(length) * 2 + 1) * 256 // (2 * length)]
    image[:, arrow:-arrow, 3] = 255
    half = np.abs(np.arange(rows) - (rows - 1) / 2)
    pointed = half[:, None] <= (np.arange(arrow)[None, :] + 0.5) / arrow * rows / 2
    for end, color in ((image[:, :arrow], UNDER), (image[:, -arrow:][:, ::-1], OVER)):
        end[pointed, :3] = table[color]
        end[pointed, 3] = 255
    return image


class FloorLegend:
    """The legend of one session's floor map."""

    def __init__(self, scene: viser.SceneApi) -> None:
        clear = np.zeros((2, 2, 4), dtype=np.uint8)
        self.bar = scene.add_image(
            "/floor/legend", clear, *LEGEND_SIZE,
            cast_shadow=False, receive_shadow=False, visible=False,
        )  # fmt: skip
        out, across = LEGEND_SIZE[0] / 2 + 0.012, -LEGEND_SIZE[1] / 2 - 0.012
        looks: dict[str, Any] = {"text": "", "font_screen_scale": LETTERS, "visible": False}
        self._labels = {
            "low": scene.add_label(
                "/floor/legend/low", position=(-out, 0.0, 0.0), anchor="center-right", **looks
            ),
            "high": scene.add_label(
                "/floor/legend/high", position=(out, 0.0, 0.0), anchor="center-left", **looks
            ),
            "name": scene.add_label(
                "/floor/legend/name", position=(0.0, across, 0.0), anchor="top-center", **looks
            ),
        }

    def draw(self, data: MapData, scale: Scale) -> None:
        """Show a map's name and scale."""
        self.bar.image = legend_image(scale)
        factor, unit = data.display
        texts = {
            "low": number(scale.low * factor),
            "high": number(scale.high * factor),
            "name": f"{data.names[0]}  {f'[{unit}]' if unit else ''}".rstrip(),
        }
        for name, text in texts.items():
            self._labels[name].text = text

    def stand(self, geometry: Geometry, height: float) -> None:
        """Lie next to the map at a height [m]."""
        (x, y), wxyz = legend_place(geometry)
        self.bar.position = (x, y, height)
        self.bar.wxyz = wxyz

    @property
    def visible(self) -> bool:
        """Whether it is shown."""
        return self.bar.visible

    @visible.setter
    def visible(self, visible: bool) -> None:
        self.bar.visible = visible
        for label in self._labels.values():
            label.visible = visible
