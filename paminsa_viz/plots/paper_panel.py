"""One panel of a printed map: cells, contours with numbers, boundary, circle, pose, frame."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.patches import PathPatch, Rectangle
from matplotlib.path import Path
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from paminsa_viz.palette import INK
from paminsa_viz.plots import axes, colors, lines, raster
from paminsa_viz.plots.formats import INCH
from paminsa_viz.plots.labels import Label, place_labels
from paminsa_viz.plots.layout import Box
from paminsa_viz.plots.lettering import TextMetrics
from paminsa_viz.plots.maps import MapData
from paminsa_viz.plots.page import Page
from paminsa_viz.plots.scale import Scale
from paminsa_viz.units import MM, number

LABELLED_PANEL = 30.0  # mm; contours of smaller panels carry no numbers, and lines are finer

_RING = np.stack([np.cos(np.linspace(0, 6.3, 13)), np.sin(np.linspace(0, 6.3, 13))], axis=1)


def draw_panel(
    page: Page, data: MapData, index: int, scale: Scale, box: Box, letters: TextMetrics
) -> None:
    """Draw one panel into its box."""
    panel = page.axes(box)
    thin = 1.0 if box.width >= LABELLED_PANEL else 0.75
    left, right, bottom, top = (edge * MM for edge in data.extent)
    panel.set(xlim=(left, right), ylim=(bottom, top))
    hatching = Rectangle(
        (left, bottom), right - left, top - bottom, fc=colors.REACHLESS, ec=colors.HATCH
    )
    hatching.set(hatch="//////", linewidth=0, zorder=0)
    hatching.set_hatch_linewidth(0.35)
    panel.add_patch(hatching)
    _cells(panel, data, index, scale)
    _contours(panel, data, index, scale, box, letters, thin)
    line: dict[str, Any] = {"solid_capstyle": "round", "solid_joinstyle": "round"}
    for part in lines.boundary(data):
        panel.plot(
            *(part * MM).T,
            color=INK,
            lw=0.9 * thin,
            zorder=4,
            **line,
        )
    for part in lines.singular_circle(data):
        panel.plot(*(part * MM).T, color="white", lw=1.3 * thin, zorder=5, **line)
        panel.plot(*(part * MM).T, color=INK, lw=0.8 * thin, dashes=(3.5, 2.5), zorder=5)
    x, y = (float(v) * MM for v in data.pose[:2])
    ring: dict[str, Any] = {"marker": "o", "ls": "none", "zorder": 6, "clip_on": True}
    panel.plot(x, y, ms=6.4 * thin, mfc="white", mec="white", mew=0, **ring)
    panel.plot(x, y, ms=4.6 * thin, mfc="white", mec=INK, mew=0.8, **ring)
    panel.plot(x, y, ms=1.6 * thin, mfc=INK, mec=INK, mew=0, **ring)
    why = axes.emptiness(data, index)
    if why:
        back = {"fc": "white", "ec": "none", "pad": 1.5}
        panel.text(0.5, 0.8, why, ha="center", va="center", size=letters.size - 1,
                   transform=panel.transAxes, bbox=back, zorder=7, color=INK)  # fmt: skip
    _frame(page, panel, data, index, box, letters)


def _cells(panel: Axes, data: MapData, index: int, scale: Scale) -> None:
    """Draw the colored cells; with a margin they end at the true boundary, not at cell edges."""
    values, status = data.values[index], data.status
    area: Artist | None = None
    if data.margin is not None:
        values, status = _widened(values, status)
        paths = []
        for points, offsets in lines.reached_area(data):
            kinds = np.full(len(points), Path.LINETO, dtype=np.uint8)
            kinds[offsets[:-1]] = Path.MOVETO
            kinds[offsets[1:] - 1] = Path.CLOSEPOLY
            paths.append(Path(points * MM, kinds))
        if not paths:
            return
        area = PathPatch(Path.make_compound_path(*paths), transform=panel.transData)
    left, right, bottom, top = (edge * MM for edge in data.extent)
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
    """Give cells without a value that of a neighbor, so that those on the boundary are full."""
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
    panel: Axes,
    data: MapData,
    index: int,
    scale: Scale,
    box: Box,
    letters: TextMetrics,
    thin: float,
) -> None:
    left, _, bottom, _ = data.extent
    paper = box.width / (data.extent[1] - left)  # mm on paper for a meter
    origin = np.array([left, bottom])

    def onto(line: lines.Line) -> lines.Line:
        return (line - origin) * paper

    found = {
        level: [onto(line) for line in parts]
        for level, parts in lines.contour_lines(data, index, scale).items()
    }
    words = {level: number(level * data.display[0]) for level in found}
    small = TextMetrics(letters.size - 2)
    placed: list[Label] = []
    if box.width >= LABELLED_PANEL:
        marker = onto(data.pose[:2] + 0.9 / paper * _RING)
        others = [onto(part) for part in lines.boundary(data) + lines.singular_circle(data)]
        edge = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]]) * [box.width, box.height]
        placed, found = place_labels(
            found,
            lambda level: small.width(words[level]),
            0.75 * small.size * INCH / 72,
            [*others, marker, edge],
        )
    fine = 0.4 * thin
    for level, parts in found.items():
        back = [(line / paper + origin) * MM for line in parts]
        width = 2 * fine if level == 0 else fine
        panel.add_collection(
            LineCollection(
                back, colors=scale.ink(level), linewidths=width, zorder=3, capstyle="butt"
            )
        )
    for label in placed:
        x, y = (np.array([label.x, label.y]) / paper + origin) * MM
        panel.text(x, y, words[label.level], size=small.size, rotation=label.angle, color=INK,
                   ha="center", va="center_baseline", rotation_mode="anchor", zorder=5.5,
                   path_effects=[withStroke(linewidth=1.2, foreground="white")])  # fmt: skip


def _frame(
    page: Page, panel: Axes, data: MapData, index: int, box: Box, letters: TextMetrics
) -> None:
    x_marks = axes.length_marks(*data.extent[:2], box.width, letters.width, 1.3)
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
        page.text(box.left - 10.8, y, axes.axis_label("y"), ha="left", va="center",
                  rotation=90, **style)  # fmt: skip
    page.text(middle, box.top - 1.0, data.names[index], ha="center", va="baseline",
              size=letters.size + 1, color=data.colors[index], weight="bold")  # fmt: skip
