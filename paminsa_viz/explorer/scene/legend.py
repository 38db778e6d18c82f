"""The legend over the 3D view: the colors of the floor map, and what the arrows mean.

It lies over the picture and not in the scene, so that it can be read from every side. Pictures of
the view that are exported get it too.
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.explorer.browser.bridge import Bridge
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.kit.text import render
from paminsa_viz.explorer.scene.places import found_at
from paminsa_viz.explorer.state.layers import LAYERS
from paminsa_viz.palette import LIGHT, rgb
from paminsa_viz.plots.map_values import MapData
from paminsa_viz.plots.scale import OVER, UNDER, Scale, color_table
from paminsa_viz.units import number

COLORS = 24
"""Colors that stand for a scale's 256."""


class ColorBar(NamedTuple):
    """What the colors of the floor map mean.

    Attributes:
        name: The quantity, with its unit.
        low, high: Ends of the scale as they are written.
        colors: ``#rrggbb`` from low to high.
        under, over: Colors of what lies beyond the ends.
    """

    name: str
    low: str
    high: str
    colors: tuple[str, ...]
    under: str
    over: str


class Legend(NamedTuple):
    """What the legend says.

    Attributes:
        rows: What a layer's arrows mean: colors ``#rrggbb`` and a text each.
        bar: The floor map's colors; None while it is hidden.
    """

    rows: tuple[tuple[tuple[str, ...], str], ...]
    bar: ColorBar | None

    @property
    def html(self) -> str:
        """The legend for the page; empty where there is nothing to say."""
        return render("scene/legend.j2", rows=self.rows, bar=self.bar) if any(self) else ""


NO_LEGEND = Legend((), None)


def color_bar(data: MapData, scale: Scale) -> ColorBar:
    """Return the color bar of a map."""
    factor, unit = data.display
    table = ["#{:02x}{:02x}{:02x}".format(*row) for row in color_table(scale)[:, :3]]
    index = 1 + np.linspace(0, 255, COLORS).round().astype(int)
    return ColorBar(
        f"{data.names[0]}  {f'[{unit}]' if unit else ''}".rstrip(),
        number(scale.low * factor), number(scale.high * factor),
        tuple(table[i] for i in index), table[UNDER], table[OVER],
    )  # fmt: skip


def arrow_rows(frame: Frame) -> tuple[tuple[tuple[str, ...], str], ...]:
    """Return what the arrows of the visible layers mean."""
    rows = []
    for key, layer in LAYERS.items():
        if layer.legend and key in frame.state.layers:
            row = found_at(layer.legend)(frame)
            if row is not None:
                rows.append(row)
    return tuple(rows)


class SceneLegend:
    """The legend of one session.

    Attributes:
        bar: The floor map's colors as drawn last; the floor map sets it.
        shown: What the page shows.
    """

    def __init__(self, bridge: Bridge) -> None:
        self._bridge = bridge
        self.bar: ColorBar | None = None
        self.shown = NO_LEGEND

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Say what is shown, if that has changed."""
        del dragging
        legend = self.of(frame)
        if legend == self.shown:
            return
        self.shown = legend
        self._bridge.call("showLegend", legend.html)

    def of(self, frame: Frame) -> Legend:
        """Return the legend of a frame, with the colors that the floor map has."""
        return Legend(arrow_rows(frame), self.bar if "floor_map" in frame.state.layers else None)


def with_legend(
    picture: NDArray[np.uint8], legend: Legend, size: float = 13.0
) -> NDArray[np.uint8]:
    """Return a picture of the view (h, w, 3) with the legend in its lower left corner.

    Args:
        picture: The picture, on light ground.
        legend: What to say.
        size: Of the letters [px].
    """
    if not any(legend):
        return picture
    import matplotlib as mpl  # it brings the letters
    from PIL import Image, ImageDraw, ImageFont

    path = Path(mpl.get_data_path(), "fonts", "ttf", "DejaVuSans.ttf")
    font = ImageFont.truetype(str(path), round(size))
    image = Image.fromarray(picture)
    pen = ImageDraw.Draw(image)
    line, left = round(1.5 * size), round(size)
    top = picture.shape[0] - left - line * (len(legend.rows) + 2 * (legend.bar is not None))
    for strokes, text in legend.rows:
        middle, long = top + line / 2, 1.4 * size / len(strokes)
        for i, color in enumerate(strokes):
            ends = [(left + i * long, middle), (left + (i + 1) * long, middle)]
            pen.line(ends, rgb(color), max(round(size / 5), 1))
        pen.text((left + 2 * size, top), text, rgb(LIGHT.ink), font)
        top += line
    if legend.bar is not None:
        bar, width = legend.bar, round(18 * size)
        pen.text((left, top), bar.name, rgb(LIGHT.ink), font)
        top += line
        pen.text((left, top), bar.low, rgb(LIGHT.ink), font)
        start = left + pen.textlength(bar.low, font) + size / 2
        colors = (bar.under, *bar.colors, bar.over)
        step = width / len(colors)
        for i, color in enumerate(colors):
            box = (start + i * step, top + 0.2 * size, start + (i + 1) * step, top + 1.1 * size)
            pen.rectangle(box, rgb(color))
        pen.text((start + width + size / 2, top), bar.high, rgb(LIGHT.ink), font)
    return np.asarray(image)
