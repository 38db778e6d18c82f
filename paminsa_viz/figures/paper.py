"""Figures for print: PNG, SVG and PDF by matplotlib, without a browser or a global figure.

One figure is drawn at a time, since matplotlib's settings and font caches belong to the process;
any thread may ask. Equal input gives equal bytes.
"""

from __future__ import annotations

import threading
from collections.abc import Sequence
from io import BytesIO
from typing import Any, Literal

import matplotlib as mpl
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.colors import ListedColormap, Normalize, SymLogNorm
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch, Rectangle
from matplotlib.path import Path
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from paminsa_viz.figures import axes, colours, lines, raster, ticks
from paminsa_viz.figures.caption import caption as caption_text
from paminsa_viz.figures.caption import summary
from paminsa_viz.figures.layout import Box, Layout, Room, arrange
from paminsa_viz.figures.lettering import Lettering
from paminsa_viz.figures.maps import MapData
from paminsa_viz.figures.ranges import per_panel
from paminsa_viz.figures.scale import Scale
from paminsa_viz.model.errors import InvalidInput
from paminsa_viz.palette import INK

Kind = Literal["png", "svg", "pdf"]
KINDS: tuple[Kind, ...] = ("png", "svg", "pdf")

INCH = 25.4  # mm
NARROWEST, WIDEST = 50.0, 1000.0  # mm
MOST_PIXELS = 20_000  # along the width of a PNG
LEAST_PANEL = 15.0  # mm; below it numbers would run into each other
LABELLED_PANEL = 30.0  # mm; contours of smaller panels carry no numbers

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
_SETTINGS: dict[str, Any] = {
    "font.family": "DejaVu Sans",  # comes with matplotlib, so it is the same everywhere
    "pdf.fonttype": 42,  # whole outlines, as journals ask
    "svg.fonttype": "path",
    "svg.hashsalt": "paminsa_viz",  # names of SVG elements, random otherwise
    "axes.unicode_minus": True,
}
_drawing = threading.Lock()


def render(
    data: MapData,
    scale: Scale | Sequence[Scale],
    kind: Kind = "png",
    *,
    width_mm: float = 170.0,
    dpi: float = 300.0,
    title: str | None = None,
    caption: bool = True,
) -> bytes:
    """Draw one or several maps as a figure for print; the height follows from the width.

    Args:
        data: The maps.
        scale: One colour scale for all panels, or one for each.
        kind: ``"png"``, ``"svg"`` or ``"pdf"``.
        width_mm: Width on paper [mm]; 85 is a column, 170 a page.
        dpi: Pixels per inch: of a PNG, and of the coloured cells inside SVG and PDF.
        title: Heading of the figure; None for the map's own title, empty for none.
        caption: Whether design, pose, line styles and version stand below.

    Returns:
        The file. A PNG is exactly ``round(width_mm / 25.4 * dpi)`` pixels wide.

    Raises:
        InvalidInput: If kind, width or resolution is not possible.
        InvalidScale: If the number of scales is not that of the panels.
    """
    _check(data, kind, width_mm, dpi)
    scales = per_panel(data, scale)
    with _drawing, mpl.rc_context():
        mpl.rcdefaults()  # whatever a person's matplotlibrc says
        mpl.rcParams.update(_SETTINGS)
        figure = _figure(
            data, scales, width_mm, dpi, data.title if title is None else title, caption
        )
        stream = BytesIO()
        figure.savefig(stream, format=kind, dpi=dpi, metadata=_metadata(data, kind))
    return stream.getvalue()


def _check(data: MapData, kind: str, width_mm: float, dpi: float) -> None:
    if kind not in KINDS:
        raise InvalidInput("kind", f"one of {', '.join(KINDS)} is needed, not {kind!r}")
    if not NARROWEST <= width_mm <= WIDEST:
        raise InvalidInput("width_mm", f"{NARROWEST:g} to {WIDEST:g} mm are possible")
    if not 20 <= dpi <= 2400:
        raise InvalidInput("dpi", "20 to 2400 pixels per inch are possible")
    if kind == "png" and width_mm / INCH * dpi > MOST_PIXELS:
        raise InvalidInput("dpi", f"the picture would be more than {MOST_PIXELS} pixels wide")
    if arrange(data, width_mm, _ROOM, own_bars=True).panels[0].width < LEAST_PANEL:
        raise InvalidInput("width_mm", f"too narrow for {data.panels} panels side by side")


def _metadata(data: MapData, kind: str) -> dict[str, Any]:
    title, made_by = data.title or "Map", f"paminsa_viz {data.provenance.version}"
    about = summary(data)
    if kind == "png":
        return {"Title": title, "Description": about, "Software": made_by}
    if kind == "svg":
        return {"Title": title, "Description": about, "Creator": made_by, "Date": None}
    fixed = {"Creator": made_by, "Producer": "matplotlib", "CreationDate": None}
    return {"Title": title, "Subject": about, **fixed}


class _Page:
    """A figure measured in mm from its top left corner."""

    def __init__(self, width: float, height: float, dpi: float) -> None:
        self.width, self.height = width, height
        # A hundredth of a pixel more, since the size in pixels is rounded down later.
        self.figure = Figure(
            figsize=tuple((round(v / INCH * dpi) + 0.01) / dpi for v in (width, height)), dpi=dpi
        )
        FigureCanvasAgg(self.figure)

    def axes(self, box: Box) -> Axes:
        """Add axes that fill a box."""
        bottom = self.height - box.bottom
        return self.figure.add_axes(
            (
                box.left / self.width,
                bottom / self.height,
                box.width / self.width,
                box.height / self.height,
            )
        )

    def text(self, x: float, y: float, words: str, **style: Any) -> None:
        """Write plain words at a place [mm]; dollar signs are dollar signs."""
        style = {"color": INK, "parse_math": False, **style}
        self.figure.text(x / self.width, 1 - y / self.height, words, **style)


def _figure(
    data: MapData,
    scales: tuple[Scale, ...],
    width: float,
    dpi: float,
    title: str,
    caption: bool,
) -> Figure:
    size = 7.0 if width < 120 else 8.0
    letters = Lettering(size)
    above = 4.5 if title else 0.0
    room = Room(**{**vars(_ROOM), "top": _ROOM.top + above})
    layout = arrange(data, width, room, own_bars=len(set(scales)) > 1)
    small = Lettering(size - 1)
    note = small.wrapped(caption_text(data, scales), width - 4.0) if caption else []
    foot = 2.0 + len(note) * small.line if note else 0.0
    page = _Page(width, layout.height + foot, dpi)
    if title:
        centre = (layout.panels[0].left + layout.panels[-1].right) / 2
        page.text(
            centre, 1.0, letters.plain(title), size=size + 1.5, ha="center", va="top", weight="bold"
        )
    for index, box in enumerate(layout.panels):
        _panel(page, data, index, scales[index], box, letters)
    for index, box in enumerate(layout.bars):
        _bar(page, data, scales[index], box, layout, letters, shared=len(layout.bars) == 1)
    for row, words in enumerate(note):
        y = layout.height + 2.0 + row * small.line
        page.text(2.0, y, words, size=size - 1, va="top", color=axes.GRID_TEXT)
    return page.figure


def _panel(
    page: _Page, data: MapData, index: int, scale: Scale, box: Box, letters: Lettering
) -> None:
    panel = page.axes(box)
    left, right, bottom, top = (edge * axes.MM for edge in data.extent)
    panel.set(xlim=(left, right), ylim=(bottom, top))
    hatching = Rectangle(
        (left, bottom), right - left, top - bottom, fc=colours.REACHLESS, ec=colours.HATCH
    )
    hatching.set(hatch="//////", linewidth=0, zorder=0)
    hatching.set_hatch_linewidth(0.35)
    panel.add_patch(hatching)
    _cells(panel, data, index, scale)
    _contours(panel, data, index, scale, box, letters)
    line: dict[str, Any] = {"solid_capstyle": "round", "solid_joinstyle": "round"}
    for part in lines.boundary(data):
        panel.plot(*(part * axes.MM).T, color=INK, lw=0.9, zorder=4, **line)
    for part in lines.singular_circle(data):
        panel.plot(*(part * axes.MM).T, color="white", lw=1.3, zorder=5, **line)
        panel.plot(*(part * axes.MM).T, color=INK, lw=0.8, dashes=(3.5, 2.5), zorder=5)
    x, y = (float(v) * axes.MM for v in data.pose[:2])
    ring: dict[str, Any] = {"marker": "o", "ls": "none", "zorder": 6, "clip_on": True}
    panel.plot(x, y, ms=6.4, mfc="white", mec="white", mew=0, **ring)
    panel.plot(x, y, ms=4.6, mfc="white", mec=INK, mew=0.8, **ring)
    panel.plot(x, y, ms=1.6, mfc=INK, mec=INK, mew=0, **ring)
    why = axes.emptiness(data, index)
    if why:
        back = {"fc": "white", "ec": "none", "pad": 1.5}
        panel.text(0.5, 0.8, why, ha="center", va="center", size=letters.size - 1,
                   transform=panel.transAxes, bbox=back, zorder=7, color=INK)  # fmt: skip
    _frame(page, panel, data, index, box, letters)


def _cells(panel: Axes, data: MapData, index: int, scale: Scale) -> None:
    """Draw the coloured cells; with a margin they end at the true boundary, not at cell edges."""
    values, status = data.values[index], data.status
    area: Artist | None = None
    if data.margin is not None:
        values, status = _widened(values, status)
        paths = []
        for points, offsets in lines.reached_area(data):
            kinds = np.full(len(points), Path.LINETO, dtype=np.uint8)
            kinds[offsets[:-1]] = Path.MOVETO
            kinds[offsets[1:] - 1] = Path.CLOSEPOLY
            paths.append(Path(points * axes.MM, kinds))
        if not paths:
            return
        area = PathPatch(Path.make_compound_path(*paths), transform=panel.transData)
    left, right, bottom, top = (edge * axes.MM for edge in data.extent)
    image = panel.imshow(
        raster.map_image(values, status, scale),
        extent=(left, right, bottom, top),
        origin="lower",
        interpolation="nearest",
        aspect="auto",
        zorder=1,
    )
    if area is not None:
        image.set_clip_path(area)  # type: ignore[arg-type]


def _widened(
    values: NDArray[np.float64], status: NDArray[np.uint8]
) -> tuple[NDArray[np.float64], NDArray[np.uint8]]:
    """Give cells without a value that of a neighbour, so that those on the boundary are full."""
    values, status = values.copy(), status.copy()
    for axis in (0, 1):
        for step in (1, -1):
            near, near_status = np.roll(values, step, axis), np.roll(status, step, axis)
            edge: list[Any] = [slice(None), slice(None)]
            edge[axis] = 0 if step == 1 else -1
            near_status[tuple(edge)] = 1
            take = (status != 0) & (near_status == 0) & ~np.isnan(near)
            values[take], status[take] = near[take], 0
    return values, status


def _contours(
    panel: Axes, data: MapData, index: int, scale: Scale, box: Box, letters: Lettering
) -> None:
    x, y, field = lines.contour_field(data, index, scale)
    shown = field.compressed()
    levels = [v for v in scale.levels if shown.size and shown.min() < v < shown.max()]
    if not levels:
        return
    widths = [0.8 if level == 0 else 0.4 for level in levels]
    drawn = panel.contour(
        x * axes.MM, y * axes.MM, field, levels=levels, colors=INK, linewidths=widths, zorder=3
    )
    drawn.set_linestyle("solid")
    if box.width < LABELLED_PANEL:
        return
    factor = data.display[0]
    labels = panel.clabel(
        drawn,
        fontsize=letters.size - 2,
        inline=True,
        inline_spacing=2,
        fmt={level: ticks.number(level * factor) for level in levels},
        zorder=5.5,
    )
    for label in labels:
        label.set_path_effects([withStroke(linewidth=1.3, foreground="white")])


def _frame(
    page: _Page, panel: Axes, data: MapData, index: int, box: Box, letters: Lettering
) -> None:
    x_marks = axes.length_marks(*data.extent[:2], box.width, letters.width, _ROOM.gap / 2 - 0.2)
    y_marks = axes.length_marks(*data.extent[2:], box.height, letters.width, letters.line / 4)
    panel.set_xticks([m.value for m in x_marks])
    panel.set_xticklabels([m.words for m in x_marks])
    panel.set_yticks([m.value for m in y_marks])
    panel.set_yticklabels([m.words for m in y_marks] if index == 0 else [])
    panel.tick_params(
        labelsize=letters.size, labelcolor=INK, color=INK, length=2.0, width=0.5, pad=1.5
    )
    panel.set_zorder(2)
    for spine in panel.spines.values():
        spine.set(color=INK, linewidth=0.5)
    middle = box.left + box.width / 2
    style: dict[str, Any] = {"size": letters.size, "color": INK}
    page.text(middle, box.bottom + 4.6, axes.axis_label("x"), ha="center", va="top", **style)
    if index == 0:
        y = box.top + box.height / 2
        page.text(box.left - _ROOM.left + 1.2, y, axes.axis_label("y"), ha="left", va="center",
                  rotation=90, **style)  # fmt: skip
    page.text(middle, box.top - 1.0, data.names[index], ha="center", va="baseline",
              size=letters.size + 1, color=data.colours[index], weight="bold")  # fmt: skip


def matplotlib_colours(scale: Scale) -> tuple[Normalize, ListedColormap]:
    """Return matplotlib's own norm and colour map for a scale."""
    table = ListedColormap(scale.table, name=scale.colours)
    under, over = scale.beyond
    table = table.with_extremes(under=under, over=over, bad=(0.0, 0.0, 0.0, 0.0))
    if scale.kind == "linear":
        return Normalize(scale.low, scale.high), table
    norm = SymLogNorm(scale.threshold, linscale=1.0, vmin=scale.low, vmax=scale.high, base=10)
    return norm, table


def _bar(
    page: _Page,
    data: MapData,
    scale: Scale,
    box: Box,
    layout: Layout,
    letters: Lettering,
    shared: bool,
) -> None:
    panel = page.axes(box)
    norm, table = matplotlib_colours(scale)
    arrow = 0.06 if shared else 0.1
    bar = page.figure.colorbar(
        ScalarMappable(norm, table),
        cax=panel,
        orientation="vertical" if layout.upright else "horizontal",
        extend="both",
        extendfrac=arrow,
    )
    length = (box.height if layout.upright else box.width) / (1 + 2 * arrow)

    def room(words: str) -> float:
        return letters.line * 1.2 if layout.upright else letters.width(words)

    factor, unit = data.display
    marks = axes.bar_marks(factor, scale, length, room)
    bar.set_ticks([m.value for m in marks], labels=[m.words for m in marks])
    bar.minorticks_off()
    panel.tick_params(
        labelsize=letters.size, labelcolor=INK, color=INK, length=2.0, width=0.5, pad=1.5
    )
    bar.outline.set(edgecolor=INK, linewidth=0.5)  # type: ignore[operator]
    label = axes.unit_label(unit)
    style: dict[str, Any] = {"size": letters.size}
    if layout.upright:
        page.text(box.left - 0.5, box.top - 1.0, label, ha="left", va="baseline", **style)
    else:
        middle = box.left + box.width / 2
        page.text(middle, box.bottom + 4.4, label, ha="center", va="top", **style)
