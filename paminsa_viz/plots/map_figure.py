"""Maps by matplotlib: one figure, drawn whole for print and by blitting while a slider moves."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from paminsa_viz.checks import kinds_checked
from paminsa_viz.files.published_table import PublishedMap
from paminsa_viz.palette import INK, LIGHT, Theme
from paminsa_viz.plots.caption import caption as caption_text
from paminsa_viz.plots.caption import summary
from paminsa_viz.plots.contours import FloorPath
from paminsa_viz.plots.formats import (
    POINT,
    Credits,
    check_size,
    drawing,
    drawing_lock,
    figure_file,
)
from paminsa_viz.plots.map_layout import PAGE_EM, MapLayout, Rectangle, map_layout
from paminsa_viz.plots.map_panel import MapPanel, add_color_bar, common_lines
from paminsa_viz.plots.map_values import MapData
from paminsa_viz.plots.ranges import per_panel
from paminsa_viz.plots.scale import Scale
from paminsa_viz.plots.text import wrapped
from paminsa_viz.quantities import TORQUES, find

TORQUE_SYMBOLS = tuple(quantity.symbol for quantity in find((*TORQUES, "f_4")))
"""Names of the maps of torques, in the order of published ones."""

_KEPT = 3  # live figures: idle, dragging, and one to go back to
_KEPT_SCALES = 8  # color bars of one live figure; a drag to and fro meets a few scales again

_Piece = tuple[tuple[slice, slice], NDArray[np.uint8]]
"""A piece of a picture: its rows and columns, and its pixels, RGBA."""


class LiveMaps:
    """Maps that are drawn many times a second.

    Axes, headings, hatching and color bars are drawn once and kept; cells and lines are drawn over
    them. Safe to use from threads.
    """

    def __init__(self) -> None:
        self._figures: OrderedDict[tuple[Any, ...], _LiveFigure] = OrderedDict()

    def draw(
        self,
        data: MapData,
        scales: Sequence[Scale],
        width: int,
        ratio: float = 1.0,
        path: FloorPath | None = None,
        columns: int | None = None,
        theme: Theme = LIGHT,
    ) -> NDArray[np.uint8]:
        """Draw all panels in rows, as RGB (height, width * ratio, 3).

        The pose is left out: a marker over the image can follow a slider alone, at
        `MapLayout.positions`.

        Args:
            data: The maps.
            scales: Color scales, one a panel.
            width: Width [page pixels].
            ratio: Device pixels for one page pixel.
            path: A motion to draw on every panel.
            columns: Panels in a row; all if None.
            theme: Colors of all but the cells.

        Raises:
            InvalidInput: If the width is not enough for the panels.
        """
        layout = map_layout(data, scales, width, PAGE_EM, columns=columns)
        key = (layout, ratio, data.extent, data.names, data.colors, data.display, theme)
        with drawing_lock:
            figure = self._figures.pop(key, None)
        if figure is None:
            with drawing():
                figure = _LiveFigure(data, layout, 72.0 * ratio, theme)
        with drawing_lock:
            self._figures[key] = figure
            while len(self._figures) > _KEPT:
                self._figures.popitem(last=False)
            return figure.draw(data, tuple(scales), path)


class _LiveFigure:
    """One figure of live maps, with what does not change kept as pixels."""

    def __init__(self, data: MapData, layout: MapLayout, dpi: float, theme: Theme) -> None:
        self._layout, self._theme = layout, theme
        self._page, self._canvas = _new_page(layout.width, layout.height, dpi)
        self._page.set_facecolor(theme.paper)
        self._panels = [
            MapPanel(self._page, data, i, layout, live=True, theme=theme)
            for i in range(data.panels)
        ]
        self._canvas.draw()
        self._frame = self._canvas.copy_from_bbox(self._page.bbox)
        self._bars: OrderedDict[tuple[Scale, ...], list[_Piece]] = OrderedDict()

    def draw(
        self, data: MapData, scales: tuple[Scale, ...], path: FloorPath | None
    ) -> NDArray[np.uint8]:
        canvas: Any = self._canvas
        canvas.restore_region(self._frame)
        pixels = np.asarray(canvas.buffer_rgba())
        bars = self._bars.pop(scales, None)
        if bars is None:
            places = zip(scales, self._layout.bars, strict=False)
            bars = [self._draw_bar(pixels, data, *one) for one in places]
            if len(self._bars) == _KEPT_SCALES:
                self._bars.popitem(last=False)
        else:
            for part, piece in bars:
                pixels[part] = piece
        self._bars[scales] = bars
        common = common_lines(data, path)
        for panel, scale in zip(self._panels, scales, strict=True):
            panel.paint_cells(pixels, data, scale)
            panel.show_lines(common | panel.contours(data, scale))
            panel.draw(canvas.get_renderer())
        return pixels[..., :3].copy()

    def _draw_bar(
        self, pixels: NDArray[np.uint8], data: MapData, scale: Scale, place: Rectangle
    ) -> _Piece:
        """Draw a color bar, and return the piece of the picture that it has changed."""
        whole = pixels.view(np.uint32)[..., 0]  # four bytes at once
        before = whole.copy()
        bar = add_color_bar(self._page, data, scale, self._layout, place, self._theme)
        bar.draw(self._canvas.get_renderer())
        bar.remove()
        changed = whole != before
        part = _span(changed.any(axis=1)), _span(changed.any(axis=0))
        return part, pixels[part].copy()


def _span(flags: NDArray[np.bool_]) -> slice:
    """Return the range from the first to the last that is set."""
    found = np.flatnonzero(flags)
    return slice(found[0], found[-1] + 1) if found.size else slice(0)


@kinds_checked
def render_maps(
    data: MapData,
    scale: Scale | Sequence[Scale],
    format: str = "png",
    *,
    width_mm: float = 170.0,
    dpi: float = 300.0,
    title: str | None = None,
    caption: bool = True,
    published: PublishedMap | None = None,
) -> bytes:
    """Draw one or several maps as a figure for print; the height follows from the width.

    Args:
        data: The maps.
        scale: One color scale for all panels, or one for each.
        format: Name of a figure format.
        width_mm: Width on paper [mm]; 85 is a column, 170 a page.
        dpi: Pixels per inch: of a PNG, and of the colored cells inside SVG and PDF.
        title: Heading of the figure; None for the map's own title, empty for none.
        caption: Whether design, pose, line styles and version are named below.
        published: Torques from elsewhere, drawn as points in the colors of their own values on the
            maps of the same torques.

    Returns:
        The file. A PNG is exactly ``round(width_mm / 25.4 * dpi)`` pixels wide.

    Raises:
        InvalidInput: If format, width or resolution is not possible.
        InvalidScale: If the number of scales is not that of the panels.
    """
    check_size(format, width_mm, dpi)
    scales = per_panel(data, scale)
    heading = data.title if title is None else title
    if not set(data.names) & set(TORQUE_SYMBOLS):
        published = None
    circles = "" if published is None else published.name
    note = caption_text(data, scales, circles) if caption else ""
    with drawing():
        page = _printed(data, scales, width_mm / POINT, dpi, heading, note, published)
        credits = Credits(data.title or "Map", summary(data))
        return figure_file(page, format, dpi, credits)


def _printed(
    data: MapData,
    scales: tuple[Scale, ...],
    width: float,
    dpi: float,
    title: str,
    caption: str,
    published: PublishedMap | None,
) -> Figure:
    em = 7.0 if width < 340 else 8.0  # points; 120 mm
    heading = wrapped(title, 1.19 * em, 0.92 * width, "bold")
    layout = map_layout(data, scales, width, em, head=1.5 * em * len(heading))
    note_size = em - 1
    note = wrapped(caption, note_size, width - 1.5 * em)
    foot = 0.6 * em + 1.27 * note_size * len(note) if note else 0.0
    page, _ = _new_page(width, layout.height + foot, dpi)
    height = layout.height + foot
    text: dict[str, Any] = {"va": "top", "linespacing": 1.27}
    center = (layout.panels[0].left + layout.panels[-1].right) / 2
    if len(heading) > 1:
        center = width / 2
    page.text(
        center / width, 1 - 0.35 * em / height, "\n".join(heading), ha="center", color=INK,
        size=1.19 * em, weight="bold", **text,
    )  # fmt: skip
    common = common_lines(data, None)
    for index, scale in enumerate(scales):
        panel = MapPanel(page, data, index, layout, live=False)
        panel.add_cells(data, scale)
        panel.show_lines(common)
        panel.label_contours(data, scale)
        if published is not None and data.names[index] in TORQUE_SYMBOLS:
            column = TORQUE_SYMBOLS.index(data.names[index])
            panel.mark_points(published.position, published.torque[:, column], scale)
        panel.mark_pose(data)
    for index, place in enumerate(layout.bars):
        values = data.values if len(layout.bars) == 1 else data.values[index]
        pointed = scales[index].exceeded(values)
        add_color_bar(page, data, scales[index], layout, place, pointed=pointed)
    page.text(
        0.75 * em / width, 1 - (layout.height + 0.3 * em) / height, "\n".join(note), ha="left",
        size=note_size, color=LIGHT.soft_ink, **text,
    )  # fmt: skip
    return page


def _new_page(width: float, height: float, dpi: float) -> tuple[Figure, FigureCanvasAgg]:
    """Return an empty figure [points] and its canvas."""
    # A hundredth of a pixel more, since the size in pixels is rounded down later.
    inches = [(round(length / 72 * dpi) + 0.01) / dpi for length in (width, height)]
    page = Figure(figsize=(inches[0], inches[1]), dpi=dpi)
    return page, FigureCanvasAgg(page)
