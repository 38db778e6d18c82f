"""What stays around live maps through most of a drag: axes, headings, color bars."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.palette import INK
from paminsa_viz.plots import axes, raster
from paminsa_viz.plots.canvas import Across, Canvas, Down, text_width
from paminsa_viz.plots.layout import Box, Layout
from paminsa_viz.plots.scale import Scale


@lru_cache(maxsize=8)
def frame(
    layout: Layout,
    extent: tuple[float, float, float, float],
    names: tuple[str, ...],
    colors: tuple[str, ...],
    display: tuple[float, str],
    scales: tuple[Scale, ...],
    ratio: float,
) -> NDArray[np.uint8]:
    """Draw everything but the maps, as RGB; it is kept, so whoever draws on it copies it first."""
    canvas = Canvas(round(layout.width), round(layout.height))
    size = round(11 * ratio)
    for index, box in enumerate(layout.panels):
        canvas_axes = _Axes(canvas, extent, snapped(box), size, ratio)
        canvas_axes.draw(names[index], colors[index], first=index == 0)
    for scale, box in zip(scales, layout.bars, strict=True):
        _bar(canvas, display, scale, snapped(box), layout.upright, size, ratio)
    canvas.pixels.flags.writeable = False
    return canvas.pixels


def snapped(box: Box) -> Box:
    """Return a box moved to whole pixels."""
    left, top = round(box.left), round(box.top)
    return Box(left, top, round(box.right) - left, round(box.bottom) - top)


@dataclass(frozen=True)
class _Axes:
    """Draws the frame, ticks and labels of one panel."""

    canvas: Canvas
    extent: tuple[float, float, float, float]
    box: Box
    size: int
    ratio: float

    def draw(self, name: str, color: str, first: bool) -> None:
        """Draw all; y numbers only at the first panel."""
        box, ratio = self.box, self.ratio
        left, top = int(box.left), int(box.top)
        right, bottom = int(box.right), int(box.bottom)
        line = max(1, round(ratio))
        tick = round(3 * ratio)
        fill = self.canvas.fill
        fill(left - line, top - line, right - left + 2 * line, line, INK)
        fill(left - line, bottom, right - left + 2 * line, line, INK)
        fill(left - line, top, line, bottom - top, INK)
        fill(right, top, line, bottom - top, INK)
        x_low, x_high, y_low, y_high = self.extent

        def across(words: str) -> float:
            return text_width(words, self.size)

        for mark in axes.length_marks(x_low, x_high, box.width, across, 5 * ratio):
            at = left + mark.where * box.width
            fill(round(at), bottom + line, line, tick, INK)
            self._words(at, bottom + line + tick + ratio, mark.words, down="top")
        middle = left + box.width / 2
        self._words(middle, bottom + 17 * ratio, axes.axis_label("x"), down="top")
        self.canvas.text(
            middle, top - 4 * ratio, name, self.size + 2, color, down="bottom", bold=True
        )
        for mark in axes.length_marks(
            y_low, y_high, box.height, lambda _: 1.4 * self.size, 0.5 * self.size
        ):
            at = bottom - mark.where * box.height
            fill(left - line - tick, round(at), tick, line, INK)
            if first:
                self._words(left - line - tick - 2 * ratio, at, mark.words, across="right")
        if first:
            x, y = left - 46 * ratio, top + box.height / 2
            self._words(x, y, axes.axis_label("y"), across="left", upright=True)

    def _words(
        self,
        x: float,
        y: float,
        words: str,
        *,
        across: Across = "middle",
        down: Down = "middle",
        upright: bool = False,
    ) -> None:
        self.canvas.text(
            x, y, words, self.size, axes.GRID_TEXT, across=across, down=down, upright=upright
        )


def _bar(
    canvas: Canvas,
    display: tuple[float, str],
    scale: Scale,
    box: Box,
    upright: bool,
    size: int,
    ratio: float,
) -> None:
    thick = int(box.width if upright else box.height)
    arrow = round(0.8 * thick)
    length = int(box.height if upright else box.width) - 2 * arrow
    table = raster.lut(scale)[:, :3]
    row = table[1 + (np.arange(length) * 2 + 1) * 256 // (2 * length)]
    # Drawn lying from low to high; an upright bar is turned at the end.
    picture = np.full((thick, length + 2 * arrow, 3), 255, dtype=np.uint8)
    picture[:, arrow : arrow + length] = row
    for level in scale.levels:
        at = arrow + min(length - 1, int(float(scale.position(level)) * length))
        picture[:, at] = picture[:, at] * 0.6 + np.array([31, 41, 51]) * 0.4
    half = np.abs(np.arange(thick) - (thick - 1) / 2)
    shape = half[:, None] <= (np.arange(arrow)[None, :] + 0.5) / arrow * thick / 2
    picture[:, :arrow][shape] = table[raster.UNDER]
    picture[:, arrow + length :][shape[:, ::-1]] = table[raster.OVER]
    if upright:
        picture = np.ascontiguousarray(np.rot90(picture))
    canvas.paste(int(box.left), int(box.top), picture)

    line = max(1, round(ratio))
    tick = round(3 * ratio)

    def room(words: str) -> float:
        return 1.3 * size if upright else text_width(words, size)

    for mark in axes.bar_marks(display[0], scale, length, room):
        if upright:
            y = box.bottom - arrow - mark.where * length
            canvas.fill(int(box.right), min(round(y), int(box.bottom) - arrow - 1), tick, line, INK)
            x = box.right + tick + 2 * ratio
            canvas.text(x, y, mark.words, size, axes.GRID_TEXT, across="left")
        else:
            x = box.left + arrow + mark.where * length
            canvas.fill(min(round(x), int(box.right) - arrow - 1), int(box.bottom), line, tick, INK)
            y = box.bottom + tick + ratio
            canvas.text(x, y, mark.words, size, axes.GRID_TEXT, down="top")
    unit = axes.unit_label(display[1])
    if upright:
        x, y = box.left - 2 * ratio, box.top - 5 * ratio
        canvas.text(x, y, unit, size, axes.GRID_TEXT, across="left", down="bottom")
    else:
        x, y = box.left + box.width / 2, box.bottom + 16 * ratio
        canvas.text(x, y, unit, size, axes.GRID_TEXT, down="top")
