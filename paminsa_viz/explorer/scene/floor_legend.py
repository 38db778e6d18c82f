"""The legend that lies beside the map on the ground: what its colours mean."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.figures import axes
from paminsa_viz.figures.canvas import Canvas, text_width
from paminsa_viz.figures.maps import MapData
from paminsa_viz.figures.raster import OVER, UNDER, lut
from paminsa_viz.figures.scale import Scale
from paminsa_viz.model import Assembly, Geometry
from paminsa_viz.model.reach import workspace_radius
from paminsa_viz.palette import INK, rgb
from paminsa_viz.shapes.frame import plinth_radius

LEGEND_SIZE: Final = (0.48, 0.1286)
"""Width and height on the ground [m]."""
PIXELS: Final = 400
"""Pixels along the width."""
DIRECTION: Final = np.radians(-52.0)
"""Where it lies, seen from the robot's axis: in front for the 3D camera."""


def legend_place(
    geometry: Geometry, assembly: Assembly
) -> tuple[tuple[float, float], tuple[float, float, float, float]]:
    """Return where the legend's centre lies (x, y) [m] and how it is turned (wxyz)."""
    half_width, height = LEGEND_SIZE[0] / 2, LEGEND_SIZE[1]
    # Beside the map, but not so far out that its outer corners leave the plinth.
    outer = np.sqrt(max((plinth_radius(geometry, assembly) - 0.03) ** 2 - half_width**2, 0.0))
    beside = workspace_radius(geometry) + height / 2 + 0.03
    radius = float(max(min(beside, outer - height / 2), height))
    turn = DIRECTION + np.pi / 2
    place = (radius * float(np.cos(DIRECTION)), radius * float(np.sin(DIRECTION)))
    return place, (float(np.cos(turn / 2)), 0.0, 0.0, float(np.sin(turn / 2)))


def legend_image(data: MapData, scale: Scale) -> NDArray[np.uint8]:
    """Draw name, unit, colours and numbers, as RGBA with row 0 at the bottom, clear around."""
    width, height = PIXELS, round(PIXELS * LEGEND_SIZE[1] / LEGEND_SIZE[0])
    canvas = Canvas(width, height)
    factor, unit = data.display
    words = f"{data.names[0]}  {axes.unit_label(unit)}".rstrip()
    canvas.text(width / 2, 4, words, 30, INK, down="top", bold=True)
    side, thick, top, size = 38, 25, 41, 30
    arrow = round(0.8 * thick)
    table = lut(scale)[:, :3]
    length = width - 2 * side - 2 * arrow
    bar = np.full((thick, length + 2 * arrow, 3), 255, dtype=np.uint8)
    bar[:, arrow : arrow + length] = table[1 + (np.arange(length) * 2 + 1) * 256 // (2 * length)]
    half = np.abs(np.arange(thick) - (thick - 1) / 2)
    pointed = half[:, None] <= (np.arange(arrow)[None, :] + 0.5) / arrow * thick / 2
    bar[:, :arrow][pointed] = table[UNDER]
    bar[:, arrow + length :][pointed[:, ::-1]] = table[OVER]
    canvas.paste(side, top, bar)
    for mark in axes.bar_marks(factor, scale, length, lambda text: 1.6 * text_width(text, size)):
        x = side + arrow + mark.where * length
        canvas.fill(round(x) - 1, top + thick, 3, 5, INK)
        canvas.text(x, top + thick + 5, mark.words, size, INK, down="top")
    return _on_clear(canvas.pixels, slice(top, top + thick))[::-1]


def _on_clear(pixels: NDArray[np.uint8], opaque: slice) -> NDArray[np.uint8]:
    """Turn dark letters on white into letters on nothing; rows ``opaque`` keep their colours."""
    ink = np.array(rgb(INK), dtype=np.float64)
    cover = (255.0 - pixels.min(axis=2)) / (255.0 - ink.min())
    image = np.empty((*pixels.shape[:2], 4), dtype=np.uint8)
    image[..., :3] = rgb(INK)
    image[..., 3] = np.clip(255 * cover, 0, 255)
    coloured = pixels[opaque]
    image[opaque, :, :3] = coloured
    image[opaque, :, 3] = np.where((coloured == 255).all(axis=2), 0, 255)
    return image
