"""Maps for print: PNG, SVG and PDF by matplotlib, without a browser or a global figure."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure

from paminsa_viz.model.errors import InvalidInput
from paminsa_viz.plots import axes
from paminsa_viz.plots.caption import caption as caption_text
from paminsa_viz.plots.caption import summary
from paminsa_viz.plots.formats import Credits, check_size, drawing, figure_file
from paminsa_viz.plots.layout import Room, arrange
from paminsa_viz.plots.lettering import TextMetrics
from paminsa_viz.plots.maps import MapData
from paminsa_viz.plots.page import Page
from paminsa_viz.plots.paper_bar import draw_bar
from paminsa_viz.plots.paper_panel import draw_panel
from paminsa_viz.plots.ranges import per_panel
from paminsa_viz.plots.scale import Scale

LEAST_PANEL = 15.0  # mm; below it numbers would run into each other

_ROOM = Room(
    left=12.0,
    right=2.0,
    top=5.0,
    axis=9.0,
    gap=3.0,
    bar=2.6,
    bar_gap=2.2,
    bar_text=12.0,
    bar_foot=7.5,
    bottom=1.0,
    largest=120.0,
    upright=120.0,
)


def render(
    data: MapData,
    scale: Scale | Sequence[Scale],
    kind: str = "png",
    *,
    width_mm: float = 170.0,
    dpi: float = 300.0,
    title: str | None = None,
    caption: bool = True,
) -> bytes:
    """Draw one or several maps as a figure for print; the height follows from the width.

    Args:
        data: The maps.
        scale: One color scale for all panels, or one for each.
        kind: Name of a figure format.
        width_mm: Width on paper [mm]; 85 is a column, 170 a page.
        dpi: Pixels per inch: of a PNG, and of the colored cells inside SVG and PDF.
        title: Heading of the figure; None for the map's own title, empty for none.
        caption: Whether design, pose, line styles and version stand below.

    Returns:
        The file. A PNG is exactly ``round(width_mm / 25.4 * dpi)`` pixels wide.

    Raises:
        InvalidInput: If kind, width or resolution is not possible.
        InvalidScale: If the number of scales is not that of the panels.
    """
    check_size(kind, width_mm, dpi)
    if arrange(data, width_mm, _ROOM, own_bars=True).panels[0].width < LEAST_PANEL:
        raise InvalidInput("width_mm", f"too narrow for {data.panels} panels side by side")
    scales = per_panel(data, scale)
    with drawing():
        figure = _figure(
            data, scales, width_mm, dpi, data.title if title is None else title, caption
        )
        credits = Credits(data.title or "Map", summary(data), data.provenance.version)
        return figure_file(figure, kind, dpi, credits)


def _figure(
    data: MapData,
    scales: tuple[Scale, ...],
    width: float,
    dpi: float,
    title: str,
    caption: bool,
) -> Figure:
    size = 7.0 if width < 120 else 8.0
    letters = TextMetrics(size)
    large = TextMetrics(size + 1.5, "bold")
    heading = large.wrapped(title, 0.96 * width - 2.0)
    above = 0.5 + len(heading) * large.line if heading else 0.0
    room = Room(**{**vars(_ROOM), "top": _ROOM.top + above})
    layout = arrange(data, width, room, own_bars=len(set(scales)) > 1)
    small = TextMetrics(size - 1)
    note = small.wrapped(caption_text(data, scales), 0.98 * width - 4.0) if caption else []
    foot = 2.0 + len(note) * small.line if note else 0.0
    page = Page(width, layout.height + foot, dpi)
    center = (layout.panels[0].left + layout.panels[-1].right) / 2
    for row, words in enumerate(heading):
        half = large.width(words) / 2 + 1.0
        x = min(max(center, half), width - half)
        y = 1.0 + row * large.line
        page.text(x, y, words, size=large.size, ha="center", va="top", weight="bold")
    for index, box in enumerate(layout.panels):
        draw_panel(page, data, index, scales[index], box, letters)
    for index, box in enumerate(layout.bars):
        draw_bar(
            page,
            data,
            scales[index],
            box,
            letters,
            upright=layout.upright,
            shared=len(layout.bars) == 1,
        )
    for row, words in enumerate(note):
        y = layout.height + 2.0 + row * small.line
        page.text(2.0, y, words, size=size - 1, va="top", color=axes.GRID_TEXT)
    return page.figure
