"""The color axis and bar of a plotly map, and the unit beside it."""

from __future__ import annotations

from typing import Any

import numpy as np

from paminsa_viz.palette import INK
from paminsa_viz.plots import axes, colors, raster
from paminsa_viz.plots.canvas import text_width
from paminsa_viz.plots.layout import Box, Layout
from paminsa_viz.plots.maps import MapData
from paminsa_viz.plots.scale import Scale

Parts = dict[str, Any]

SIZE = 11  # of numbers [page pixels]

_BEYOND = 0.045  # of the color bar, for each block of the color beyond the range


def color_axis(data: MapData, scale: Scale, box: Box, place: Layout) -> Parts:
    """Return a plotly color axis over positions on the bar, with blocks for what is beyond it."""
    table = raster.lut(scale)[1 : raster.OVER, :3]
    steps = np.linspace(0, colors.SIZE - 1, 65).round().astype(int)
    body = 1 - 2 * _BEYOND
    inner = np.linspace(_BEYOND, 1 - _BEYOND, steps.size).tolist()  # plotly wants no step back
    under, over = scale.beyond
    stops: list[list[Any]] = [[0.0, under], [inner[0], under]]
    for where, color in zip(inner, table[steps].tolist(), strict=True):
        stops.append([where, f"rgb{tuple(color)}"])
    stops += [[inner[-1], over], [1.0, over]]
    upright = place.upright
    length = (box.height if upright else box.width) * body

    def room(words: str) -> float:
        return 1.3 * SIZE if upright else text_width(words, SIZE)

    marks = axes.bar_marks(data.display[0], scale, length, room)
    bar = {
        "orientation": "v" if upright else "h",
        "x": box.left / place.width,
        "y": 1 - box.top / place.height,
        "xanchor": "left",
        "yanchor": "top",
        "xpad": 0,
        "ypad": 0,
        "thicknessmode": "pixels",
        "thickness": box.width if upright else box.height,
        "lenmode": "fraction",
        "len": box.height / place.height if upright else box.width / place.width,
        "outlinewidth": 0,
        "tickmode": "array",
        "tickvals": [mark.where for mark in marks],
        "ticktext": [mark.words for mark in marks],
        "ticks": "outside",
        "ticklen": 3,
        "tickcolor": INK,
    }
    return {
        "cmin": -_BEYOND / body,
        "cmax": 1 + _BEYOND / body,
        "autocolorscale": False,
        "colorscale": stops,
        "colorbar": bar,
    }


def unit_note(data: MapData, box: Box, place: Layout) -> Parts:
    """Return the unit as a plotly annotation at its color bar."""
    if place.upright:
        left, top, across, down = box.left - 2, box.top - 5, "left", "bottom"
    else:
        left, top, across, down = box.left + box.width / 2, box.bottom + 16, "center", "top"
    return {
        "text": axes.unit_label(data.display[1]) or " ",
        "showarrow": False,
        "xref": "paper",
        "yref": "paper",
        "x": left / place.width,
        "y": 1 - top / place.height,
        "xanchor": across,
        "yanchor": down,
        "borderpad": 0,
    }
