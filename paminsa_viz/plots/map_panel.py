"""One map of a figure by matplotlib: axes, cells, lines and numbers; and the color bars.

Sizes of letters and widths of lines grow with the em of the layout.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch
from matplotlib.patches import Rectangle as RectanglePatch
from matplotlib.path import Path
from matplotlib.patheffects import withStroke
from matplotlib.ticker import FuncFormatter, MaxNLocator
from numpy.typing import NDArray

from paminsa_viz.palette import BAD, INK, LIGHT, Theme
from paminsa_viz.plots import contours
from paminsa_viz.plots.contours import FloorPath, Line
from paminsa_viz.plots.hover import emptiness
from paminsa_viz.plots.map_layout import MapLayout, Rectangle, room_for_digits
from paminsa_viz.plots.map_values import MapData
from paminsa_viz.plots.outside import add_outside, paint_outside
from paminsa_viz.plots.scale import UNREACHED, Scale, color_codes, color_table, map_pixels
from paminsa_viz.plots.text import text_width
from paminsa_viz.units import MM, number, symbols_math

_LABELED = 85.0  # points; contours of narrower panels carry no numbers
_CONTOUR_POINTS = 50  # along an axis of live maps: faster, and looks the same

_LINES: dict[str, tuple[str, float, Any]] = {
    "light": ("#ffffff", 0.05, "-"),
    "dark": (INK, 0.05, "-"),
    "zero": (INK, 0.1, "-"),
    "boundary": (INK, 0.12, "-"),
    "circle casing": ("#ffffff", 0.18, "-"),
    "circle": (INK, 0.11, (0, (3.8, 2.8))),
    "path casing": ("#ffffff", 0.41, "-"),
    "path": (INK, 0.23, "-"),
    "path bad": (BAD, 0.23, (0, (1.6, 1.2))),
}
"""Color, width [em] and stroke of the lines; later ones lie over earlier ones. All but the
boundary lie on colored cells or on a casing, whatever the theme."""


def add_axes(page: Figure, place: Rectangle) -> Axes:
    """Add axes that fill a rectangle."""
    width, height = (72.0 * float(side) for side in page.get_size_inches())
    return page.add_axes(
        (place.left / width, 1 - place.bottom / height, place.width / width, place.height / height)
    )


class MapPanel:
    """One map of a figure: its frame, and the artists that follow the data.

    Coordinates are in meters; only the numbers at the axes are in millimeters.
    """

    def __init__(
        self, page: Figure, data: MapData, index: int, layout: MapLayout, *, live: bool,
        theme: Theme = LIGHT,
    ) -> None:  # fmt: skip
        self._index, self._em, self._theme = index, layout.em, theme
        place = layout.panels[index]
        self._width = place.width
        axes = self.axes = add_axes(page, place)
        left, right, bottom, top = data.extent
        axes.set(xlim=(left, right), ylim=(bottom, top))
        hatching = RectanglePatch(
            (left, bottom), right - left, top - bottom,
            fc=theme.reachless, ec=theme.hatch, hatch="/" * round(48 / layout.em), lw=0, zorder=0,
        )  # fmt: skip
        hatching.set_hatch_linewidth(0.045 * self._em)
        axes.add_patch(hatching)
        self._frame(data, layout)
        tints, widths, strokes = zip(*_LINES.values(), strict=True)
        tints = [theme.ink if n == "boundary" else t for n, t in zip(_LINES, tints, strict=True)]
        self._lines = LineCollection(
            [], colors=tints, linewidths=[width * self._em for width in widths],
            linestyles=strokes, joinstyle="round", animated=live, zorder=2,
        )  # fmt: skip
        axes.add_collection(self._lines, autolim=False)
        back = {"fc": theme.paper, "ec": "none", "pad": 0.2 * self._em}
        self._note = axes.text(
            0.5, 0.8, "", transform=axes.transAxes, ha="center", va="center", color=theme.ink,
            bbox=back, size=0.9 * self._em, zorder=7, animated=live,
        )  # fmt: skip

    def _frame(self, data: MapData, layout: MapLayout) -> None:
        axes, em, index, theme = self.axes, self._em, self._index, self._theme
        for axis, (low, high) in ((axes.xaxis, data.extent[:2]), (axes.yaxis, data.extent[2:])):
            room = 0.08 * (high - low)  # numbers at the very ends would run into a neighbor's
            needed = (3.2 + room_for_digits(low, high)) * em  # by a number
            least = needed / self._width * (high - low)
            low, high = low + room, high - room
            values = np.empty(0)
            for count in range(7, 0, -1):
                values = MaxNLocator(count, steps=[1, 2, 2.5, 4, 5, 10]).tick_values(low, high)
                if values[1] - values[0] >= least:
                    break
            axis.set_ticks([v for v in values if low <= v <= high])
            axis.set_major_formatter(FuncFormatter(lambda v, _: number(MM * v)))
        axes.tick_params(
            labelsize=em, labelcolor=theme.soft_ink, color=theme.ink, length=0.27 * em,
            width=0.07 * em, pad=0.18 * em, labelleft=layout.leftmost(index),
            labelbottom=layout.lowest(index),
        )  # fmt: skip
        for spine in axes.spines.values():
            spine.set(color=theme.ink, linewidth=0.07 * em)
        if layout.lowest(index):
            axes.set_xlabel("x [mm]", size=em, color=theme.soft_ink, labelpad=0.1 * em)
        if layout.leftmost(index):
            axes.set_ylabel("y [mm]", size=em, color=theme.soft_ink, labelpad=0.05 * em)
        axes.set_title(
            symbols_math(data.names[index]), parse_math=True, size=1.15 * em,
            color=theme.shown(data.colors[index]), weight="bold", pad=0.42 * em,
        )  # fmt: skip

    def paint_cells(self, pixels: NDArray[np.uint8], data: MapData, scale: Scale) -> None:
        """Color the cells on a canvas, RGBA (height, width, 4), and add a note if there are none.

        A matplotlib image looks the same and takes ten times as long.
        """
        height = pixels.shape[0]
        left, bottom, right, top = self.axes.bbox.extents
        columns = _cells_below(round(left), round(right), left, right, data.x.size)
        rows = _cells_below(round(bottom), round(top), bottom, top, data.y.size)[::-1, None]
        codes = color_codes(data.values[self._index], data.status, scale)[rows, columns]
        place = pixels.view(np.uint32)[height - round(top) : height - round(bottom), :, 0]
        table = color_table(scale).view(np.uint32)[:, 0]
        region = place[:, round(left) : round(right)]
        np.copyto(region, table[codes], where=codes != UNREACHED)
        if data.outside is not None:
            em = (right - left) / self._width * self._em  # in pixels
            paint_outside(region, data.outside, rows, columns, em)
        self._note.set_text(emptiness(data, self._index))

    def add_cells(self, data: MapData, scale: Scale) -> None:
        """Add the colored cells, up to the true boundary and not to their own edges."""
        cells = self.axes.imshow(
            map_pixels(data.values[self._index], data.status, scale), extent=data.extent,
            origin="lower", interpolation="nearest", aspect="auto", zorder=1,
        )  # fmt: skip
        self._note.set_text(emptiness(data, self._index))
        if data.margin is not None:
            area = contours.reached_area(data)
            outline = Path(np.zeros((1, 2))) if area is None else Path(*area)
            cells.set_clip_path(PathPatch(outline, transform=self.axes.transData))
        if data.outside is not None:
            add_outside(self.axes, data.outside, data.x, data.y, self._em)

    def show_lines(self, lines: dict[str, Line]) -> None:
        """Draw lines by the names of their styles."""
        self._lines.set_segments([lines.get(name, contours.NO_LINE) for name in _LINES])

    def contours(self, data: MapData, scale: Scale) -> dict[str, Line]:
        """Return the contour lines by the names of their styles, for quick drawings."""
        found: dict[str, list[Line]] = {"light": [], "dark": [], "zero": []}
        for level, line in contours.contour_lines(
            data, self._index, scale, most=_CONTOUR_POINTS
        ).items():
            found[_style(scale, level)].append(line)
        return {name: contours.joined(lines) for name, lines in found.items()}

    def label_contours(self, data: MapData, scale: Scale) -> None:
        """Draw the contour lines with their values along them."""
        found = contours.contour_lines(data, self._index, scale)
        if not found:
            return
        x, y, field = contours.contour_field(data, self._index, scale)
        tints, widths, _ = zip(*(_LINES[_style(scale, v)] for v in found), strict=True)
        drawn = self.axes.contour(
            x, y, field, levels=list(found), zorder=1.5, algorithm="serial", linestyles="solid",
            colors=tints, linewidths=[width * self._em for width in widths],
        )  # fmt: skip
        size, paper = self._em - 2, self._width / (data.extent[1] - data.extent[0])
        if self._width < _LABELED:
            return
        names = {level: number(level * data.display[0]) for level in found}
        room = {v: 0.4 * text_width(name, size) / paper for v, name in names.items()}
        places = contours.label_places(data, found, room, margin=0.15 * size / paper)
        if not places:
            return
        for label in self.axes.clabel(drawn, fmt=names, fontsize=size, manual=places):
            label.set(
                color=INK, zorder=5.5, path_effects=[withStroke(linewidth=1.2, foreground="white")]
            )

    def mark_pose(self, data: MapData) -> None:
        """Draw the ring at the pose."""
        x, y = data.pose[:2]
        for size, face, edge in ((0.8, "white", 0.0), (0.58, "white", 0.1), (0.2, INK, 0.0)):
            self.axes.plot(
                x, y, marker="o", ls="none", ms=size * self._em, mfc=face, mec=INK,
                mew=edge * self._em, zorder=6,
            )  # fmt: skip

    def mark_points(
        self, position: NDArray[np.float64], values: NDArray[Any], scale: Scale
    ) -> None:
        """Draw points (n, 2) [m] in the colors of their values (n,); none where those are NaN."""
        norm, table = scale.matplotlib_colors()
        known = np.isfinite(values)
        self.axes.scatter(
            *position[known].T, c=values[known], norm=norm, cmap=table, s=(0.7 * self._em) ** 2,
            edgecolors=INK, linewidths=0.09 * self._em, zorder=5.8,
        )  # fmt: skip

    def draw(self, renderer: Any) -> None:
        """Draw the artists that follow the data over the background."""
        for artist in (self._lines, self._note):
            artist.draw(renderer)


def _cells_below(first: int, stop: int, low: float, high: float, count: int) -> NDArray[np.intp]:
    """Return the indices of the cells below the middles of pixels from ``first`` to ``stop``.

    The cells are ``count`` equal ones from ``low`` to ``high``.
    """
    share = (np.arange(first, stop) + 0.5 - low) / (high - low)
    return np.clip((share * count).astype(np.intp), 0, count - 1)


def _style(scale: Scale, level: float) -> str:
    if level == 0.0:
        return "zero"
    return "dark" if scale.ink(level) == INK else "light"


def common_lines(data: MapData, path: FloorPath | None) -> dict[str, Line]:
    """Return the lines that all panels share, by the names of their styles."""
    circle = contours.singular_circle(data)
    lines = {"boundary": contours.boundary(data), "circle casing": circle, "circle": circle}
    if path is not None:
        lines |= {
            "path casing": contours.joined([path.good, path.bad]),
            "path": path.good,
            "path bad": path.bad,
        }
    return lines


_EXTENDED = {
    (False, False): "neither", (True, False): "min", (False, True): "max", (True, True): "both",
}  # fmt: skip
"""Matplotlib's words for which ends of a color bar are pointed, the lower and the upper one."""


def add_color_bar(
    page: Figure, data: MapData, scale: Scale, layout: MapLayout, place: Rectangle,
    theme: Theme = LIGHT, *, pointed: tuple[bool, bool] = (True, True),
) -> Axes:  # fmt: skip
    """Add the color bar of a scale, with pointed ends for what lies below and above it.

    An end without a point leaves its room free: numbers stand where they would with it.
    """
    em = layout.em
    long = place.height if layout.vertical else place.width
    share = 0.8 * em / long  # of a point, in the length between the points
    below, above = (0.0 if there else share * long / (1 + 2 * share) for there in pointed)
    if layout.vertical:
        inner = Rectangle(place.left, place.top + above, place.width, place.height - below - above)
    else:
        inner = Rectangle(place.left + below, place.top, place.width - below - above, place.height)
    axes = add_axes(page, inner)
    norm, table = scale.matplotlib_colors()
    bar = page.colorbar(
        ScalarMappable(norm, table), cax=axes, extend=_EXTENDED[pointed],
        extendfrac=share, orientation="vertical" if layout.vertical else "horizontal",
    )  # fmt: skip
    factor, unit = data.display
    fits = long / em / (2.2 if layout.vertical else 3.2)
    values = scale.ticks(int(min(max(fits, 2), 8)))
    bar.set_ticks(list(values), labels=[number(value * factor) for value in values])
    bar.minorticks_off()
    axes.tick_params(
        labelsize=em, labelcolor=theme.soft_ink, color=theme.ink, length=0.27 * em, width=0.07 * em,
        pad=0.18 * em,
    )  # fmt: skip
    outline: Any = bar.outline
    outline.set(edgecolor=theme.ink, linewidth=0.07 * em)
    label = f"[{unit}]" if unit else ""
    if layout.vertical:
        axes.set_title(label, size=em, color=theme.soft_ink, pad=0.3 * em + above, loc="left")
    else:
        axes.set_xlabel(label, size=em, color=theme.soft_ink, labelpad=0.1 * em)
    return axes
