"""The maps as one small raster, quick enough to be made anew while a hand drags a slider."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.figures import axes, lines, raster
from paminsa_viz.figures.canvas import Across, Canvas, Down, Stroke, text_width
from paminsa_viz.figures.layout import Box, Layout, Room, arrange
from paminsa_viz.figures.maps import MapData
from paminsa_viz.figures.ranges import per_panel
from paminsa_viz.figures.scale import InvalidScale, Scale
from paminsa_viz.palette import INK

LEAST_WIDTH = 200
"""Narrowest figure [pixels]; below it numbers would run into each other."""
LARGEST_WIDTH = 8000

_CONTOUR_POINTS = 50  # along an axis; the eye sees no difference, the clock does

_ROOM = Room(
    left=48,
    right=8,
    top=20,
    axis=32,
    gap=10,
    bar=11,
    bar_gap=10,
    bar_text=52,
    bar_foot=30,
    bottom=3,
    largest=460,
    upright=600,
)


def screen_room(ratio: float = 1.0) -> Room:
    """Return the room around panels on screen [pixels], for pixels ``ratio`` times as fine."""
    return Room(**{name: value * ratio for name, value in vars(_ROOM).items()})


def screen_layout(
    data: MapData, scale: Scale | Sequence[Scale], width: int, ratio: float = 1.0
) -> Layout:
    """Return the layout that `live_image` and `screen.screen_figure` share.

    Raises:
        InvalidScale: If the number of scales or the width is not possible.
    """
    if not width / ratio >= LEAST_WIDTH or width > LARGEST_WIDTH:
        raise InvalidScale("width", f"{LEAST_WIDTH} to {LARGEST_WIDTH} pixels, not {width!r}")
    scales = per_panel(data, scale)
    return arrange(data, width, screen_room(ratio), own_bars=len(set(scales)) > 1)


def live_image(
    data: MapData,
    scale: Scale | Sequence[Scale],
    width: int,
    *,
    contours: bool = True,
    pixel_ratio: float = 1.0,
) -> NDArray[np.uint8]:
    """Draw all panels side by side with axes and colour bar, as RGB (height, width, 3).

    Args:
        data: The maps.
        scale: One colour scale for all panels, or one for each.
        width: Width of the picture [pixels]; the height follows.
        contours: Draw contour lines.
        pixel_ratio: Device pixels for one page pixel; text and lines grow with it.

    Raises:
        InvalidScale: If the number of scales or the width is not possible.
    """
    scales = per_panel(data, scale)
    layout = screen_layout(data, scales, width, pixel_ratio)
    shown = tuple(scales[: len(layout.bars)])
    canvas = Canvas(1, 1)
    canvas.pixels = _frame(
        layout, data.extent, data.names, data.colours, data.display, shown, pixel_ratio
    ).copy()
    boxes = [_snapped(box) for box in layout.panels]
    for index, box in enumerate(boxes):
        picture = raster.picture(
            data.values[index],
            data.status,
            scales[index],
            int(box.height),
            int(box.width),
            round(7 * pixel_ratio),
        )
        canvas.paste(int(box.left), int(box.top), picture[:, :, :3])
    _draw_lines(canvas, data, scales, boxes, contours, pixel_ratio)
    for index, box in enumerate(boxes):
        _marker(canvas, data, box, pixel_ratio)
        _say_why(canvas, axes.emptiness(data, index), box, pixel_ratio)
    return canvas.pixels


@lru_cache(maxsize=8)
def _frame(
    layout: Layout,
    extent: tuple[float, float, float, float],
    names: tuple[str, ...],
    colours: tuple[str, ...],
    display: tuple[float, str],
    scales: tuple[Scale, ...],
    ratio: float,
) -> NDArray[np.uint8]:
    """Draw everything but the maps; it stays the same through most of a drag, so it is kept."""
    canvas = Canvas(round(layout.width), round(layout.height))
    size = round(11 * ratio)
    for index, box in enumerate(layout.panels):
        canvas_axes = _Axes(canvas, extent, _snapped(box), size, ratio)
        canvas_axes.draw(names[index], colours[index], first=index == 0)
    for scale, box in zip(scales, layout.bars, strict=True):
        _bar(canvas, display, scale, _snapped(box), layout.upright, size, ratio)
    return canvas.pixels


def _snapped(box: Box) -> Box:
    left, top = round(box.left), round(box.top)
    return Box(left, top, round(box.right) - left, round(box.bottom) - top)


def _transform(data: MapData, box: Box) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return factor (2,) and shift (2,) from x, y [m] to pixels."""
    left, right, bottom, top = data.extent
    scale_x, scale_y = box.width / (right - left), box.height / (top - bottom)
    shift = np.array([box.left - left * scale_x, box.top + top * scale_y])
    return np.array([scale_x, -scale_y]), shift


def _draw_lines(
    canvas: Canvas,
    data: MapData,
    scales: tuple[Scale, ...],
    boxes: list[Box],
    contours: bool,
    ratio: float,
) -> None:
    edge, circle = lines.boundary(data), lines.singular_circle(data)
    thin: list[lines.Line] = []
    zeros: list[lines.Line] = []
    edges: list[lines.Line] = []
    circles: list[lines.Line] = []
    for index, box in enumerate(boxes):
        factor, shift = _transform(data, box)
        if contours:
            found = lines.contour_lines(data, index, scales[index], most=_CONTOUR_POINTS)
            for level, parts in found.items():
                kept = zeros if level == 0.0 else thin
                kept.extend(line * factor + shift for line in parts)
        edges.extend(line * factor + shift for line in edge)
        circles.extend(line * factor + shift for line in circle)
    canvas.strokes([Stroke(circles, width=2 * ratio)], "#ffffff")
    ink = [
        Stroke(thin, width=ratio, opacity=0.4),
        Stroke(zeros, width=ratio, opacity=0.9),
        Stroke(edges, width=1.5 * ratio),
        Stroke(circles, width=1.5 * ratio, dash=(5 * ratio, 4 * ratio)),
    ]
    canvas.strokes(ink, INK)


def _marker(canvas: Canvas, data: MapData, box: Box, ratio: float) -> None:
    factor, shift = _transform(data, box)
    x, y = (float(v) for v in data.pose[:2] * factor + shift)
    if box.left <= x <= box.right and box.top <= y <= box.bottom:
        for radius, colour in ((6.5, "#ffffff"), (5.5, INK), (4.0, "#ffffff"), (1.7, INK)):
            canvas.disc(x, y, radius * ratio, colour)


def _say_why(canvas: Canvas, why: str, box: Box, ratio: float) -> None:
    if not why:
        return
    size = round(11 * ratio)
    words = text_width(why, size)
    middle = box.top + box.height / 5
    pad = round(4 * ratio)
    left = round(box.left + (box.width - words) / 2) - pad
    canvas.fill(left, round(middle - 9 * ratio), words + 2 * pad, round(18 * ratio), "#ffffff")
    canvas.text(box.left + box.width / 2, middle, why, size, INK)


@dataclass(frozen=True)
class _Axes:
    """Draws the frame, ticks and labels of one panel."""

    canvas: Canvas
    extent: tuple[float, float, float, float]
    box: Box
    size: int
    ratio: float

    def draw(self, name: str, colour: str, first: bool) -> None:
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
            middle, top - 4 * ratio, name, self.size + 2, colour, down="bottom", bold=True
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
