"""The maps as one small raster, quick enough to be made again while a hand drags a slider."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.palette import BAD, INK
from paminsa_viz.plots import axes, lines, raster
from paminsa_viz.plots.canvas import Canvas, Stroke, text_width
from paminsa_viz.plots.layout import Box, Layout, Room, arrange
from paminsa_viz.plots.live_frame import frame, snapped
from paminsa_viz.plots.maps import MapData
from paminsa_viz.plots.ranges import per_panel
from paminsa_viz.plots.scale import InvalidScale, Scale

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


class Way(NamedTuple):
    """A motion seen from above: curves (n, 2) that the robot can run, and that it cannot [m]."""

    good: tuple[lines.Line, ...]
    bad: tuple[lines.Line, ...]


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


def marks(data: MapData, layout: Layout) -> list[tuple[float, float]]:
    """Return where the pose lies on each panel, as shares of the figure's width and height.

    `live_image` does not draw it: what lies over the picture can follow the hand alone. There is
    no mark where the pose is not on the map.
    """
    out = []
    for box in layout.panels:
        factor, shift = _transform(data, box)
        x, y = (float(v) for v in data.pose[:2] * factor + shift)
        if box.left <= x <= box.right and box.top <= y <= box.bottom:
            out.append((x / layout.width, y / layout.height))
    return out


def live_image(
    data: MapData,
    scale: Scale | Sequence[Scale],
    width: int,
    *,
    contours: bool = True,
    pixel_ratio: float = 1.0,
    way: Way | None = None,
) -> NDArray[np.uint8]:
    """Draw all panels side by side with axes and color bar, as RGB (height, width, 3).

    The pose's mark is left to `marks`.

    Args:
        data: The maps.
        scale: One color scale for all panels, or one for each.
        width: Width of the picture [pixels]; the height follows.
        contours: Draw contour lines.
        pixel_ratio: Device pixels for one page pixel; text and lines grow with it.
        way: A motion to draw on every panel.

    Raises:
        InvalidScale: If the number of scales or the width is not possible.
    """
    scales = per_panel(data, scale)
    layout = screen_layout(data, scales, width, pixel_ratio)
    shown = tuple(scales[: len(layout.bars)])
    canvas = Canvas(1, 1)
    canvas.pixels = frame(
        layout, data.extent, data.names, data.colors, data.display, shown, pixel_ratio
    ).copy()
    boxes = [snapped(box) for box in layout.panels]
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
    if way is not None:
        _draw_way(canvas, data, boxes, way, pixel_ratio)
    for index, box in enumerate(boxes):
        _say_why(canvas, axes.emptiness(data, index), box, pixel_ratio)
    return canvas.pixels


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
    thin: dict[str, list[lines.Line]] = {INK: [], "#ffffff": []}
    zeros: list[lines.Line] = []
    edges: list[lines.Line] = []
    circles: list[lines.Line] = []
    for index, box in enumerate(boxes):
        factor, shift = _transform(data, box)
        if contours:
            found = lines.contour_lines(
                data, index, scales[index], most=_CONTOUR_POINTS, joined=True
            )
            for level, parts in found.items():
                kept = zeros if level == 0.0 else thin[scales[index].ink(level)]
                kept.extend(line * factor + shift for line in parts)
        edges.extend(line * factor + shift for line in edge)
        circles.extend(line * factor + shift for line in circle)
    light = [Stroke(thin["#ffffff"], width=ratio, opacity=0.5), Stroke(circles, width=2 * ratio)]
    canvas.strokes(light, "#ffffff")
    ink = [
        Stroke(thin[INK], width=ratio, opacity=0.4),
        Stroke(zeros, width=ratio, opacity=0.9),
        Stroke(edges, width=1.5 * ratio),
        Stroke(circles, width=1.5 * ratio, dash=(5 * ratio, 4 * ratio)),
    ]
    canvas.strokes(ink, INK)


def _draw_way(canvas: Canvas, data: MapData, boxes: list[Box], way: Way, ratio: float) -> None:
    good: list[lines.Line] = []
    bad: list[lines.Line] = []
    left, right, bottom, top = data.extent
    for box in boxes:
        factor, shift = _transform(data, box)
        for found, curves in ((good, way.good), (bad, way.bad)):
            for curve in curves:
                # The part beyond the map would run over its neighbor.
                x, y = curve.T
                inside = (x >= left) & (x <= right) & (y >= bottom) & (y <= top)
                found.extend(
                    curve[part] * factor + shift
                    for part in np.ma.clump_unmasked(np.ma.array(x, mask=~inside))
                )
    canvas.strokes([Stroke([*good, *bad], width=4.5 * ratio)], "#ffffff")
    canvas.strokes([Stroke(good, width=2.5 * ratio)], INK)
    canvas.strokes([Stroke(bad, width=2.5 * ratio, dash=(4 * ratio, 3 * ratio))], BAD)


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
