"""The maps as an interactive plotly figure, for when the hand rests.

Panels and color bars lie where `live.live_image` draws them, so that one can replace the other.
"""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Sequence
from functools import lru_cache
from io import BytesIO
from typing import Any

import numpy as np
import plotly.graph_objects as go
from PIL import Image

from paminsa_viz.palette import INK, rgb
from paminsa_viz.plots import axes, colors, lines, raster
from paminsa_viz.plots.canvas import text_width
from paminsa_viz.plots.layout import Box, Layout
from paminsa_viz.plots.live import screen_layout
from paminsa_viz.plots.maps import MapData
from paminsa_viz.plots.ranges import per_panel
from paminsa_viz.plots.scale import Scale
from paminsa_viz.plots.screen_bar import SIZE, Parts, color_axis, unit_note
from paminsa_viz.units import MM, number

FONT = "DejaVu Sans, Verdana, Helvetica, Arial, sans-serif"
CONFIG: dict[str, Any] = {"displayModeBar": False, "doubleClick": "reset"}
"""How plotly should behave: no buttons over the headings, double click goes back from a zoom."""


def screen_figure(data: MapData, scale: Scale | Sequence[Scale], width: int = 700) -> go.Figure:
    """Draw all panels side by side: colors, contours, boundary, singular circle and pose.

    Hover gives position and value, or why there is none. Zooming one panel zooms all. A page that
    stretches the figure should keep the proportion that `aspect` gives, and pass `CONFIG`.

    Args:
        data: The maps.
        scale: One color scale for all panels, or one for each.
        width: Width of the figure [page pixels]; the height follows.

    Raises:
        InvalidScale: If the number of scales or the width is not possible.
    """
    scales = per_panel(data, scale)
    place = screen_layout(data, scales, width)
    layout: Parts = {
        "width": width,
        "height": round(place.height),
        "margin": {"l": 0, "r": 0, "t": 0, "b": 0, "pad": 0, "autoexpand": False},
        "paper_bgcolor": "white",
        "plot_bgcolor": colors.REACHLESS,
        "font": {"family": FONT, "size": SIZE, "color": axes.GRID_TEXT},
        "hoverlabel": {"font": {"family": FONT, "size": SIZE + 1}},
        "showlegend": False,
        "dragmode": "zoom",
        "hovermode": "closest",
        "template": None,
        "annotations": [],
        "images": [],
    }
    for index, box in enumerate(place.bars):
        layout[_numbered("coloraxis", index)] = color_axis(data, scales[index], box, place)
        layout["annotations"].append(unit_note(data, box, place))
    traces: list[Parts] = []
    edge, circle = lines.boundary(data), lines.singular_circle(data)
    for index, box in enumerate(place.panels):
        _add_axes(layout, data, index, box, place)
        at = {"xaxis": _numbered("x", index), "yaxis": _numbered("y", index)}
        axis_name = _numbered("coloraxis", index if len(place.bars) > 1 else 0)
        drawn = [_values(data, index, scales[index], axis_name), *_reasons(data, index)]
        thin: dict[str, list[lines.Line]] = {INK: [], "#ffffff": []}
        zeros: list[lines.Line] = []
        for level, parts in lines.contour_lines(data, index, scales[index]).items():
            (zeros if level == 0.0 else thin[scales[index].ink(level)]).extend(parts)
        for color, found in thin.items():
            drawn += _lines(found, f"rgba{(*rgb(color), 0.45)}", 1.0)
        drawn += _lines(zeros, INK, 1.0) + _lines(edge, INK, 1.5)
        drawn += _lines(circle, "#ffffff", 2.2) + _lines(circle, INK, 1.6, "5px,4px")
        drawn += [_dot(data, 10, "#ffffff", 1.6), _dot(data, 3.4, INK, 0)]
        traces += [{**trace, **at} for trace in drawn]
    return go.Figure(data=traces, layout=layout)


def aspect(figure: go.Figure) -> float:
    """Return height over width of a figure, as viser's plotly element wants it."""
    layout: Any = figure.layout
    return float(layout.height / layout.width)


def _numbered(name: str, index: int) -> str:
    return name if index == 0 else f"{name}{index + 1}"


def _add_axes(layout: Parts, data: MapData, index: int, box: Box, place: Layout) -> None:
    left, right, bottom, top = (edge * MM for edge in data.extent)
    x_marks = axes.length_marks(*data.extent[:2], box.width, lambda w: text_width(w, SIZE), 5)
    y_marks = axes.length_marks(*data.extent[2:], box.height, lambda _: 1.4 * SIZE, 0.5 * SIZE)
    x, y = _numbered("x", index), _numbered("y", index)
    common: Parts = {
        "tickmode": "array",
        "ticks": "outside",
        "ticklen": 3,
        "tickcolor": INK,
        "showgrid": False,
        "zeroline": False,
        "showline": True,
        "mirror": True,
        "linecolor": INK,
        "linewidth": 1,
        "constrain": "domain",
        "automargin": False,
    }
    x_axis = {
        **common,
        "anchor": y,
        "domain": [box.left / place.width, box.right / place.width],
        "range": [left, right],
        "tickvals": [mark.value for mark in x_marks],
        "ticktext": [mark.words for mark in x_marks],
        "title": {"text": axes.axis_label("x"), "standoff": 1, "font": {"size": SIZE}},
    }
    y_axis = {
        **common,
        "anchor": x,
        "domain": [1 - box.bottom / place.height, 1 - box.top / place.height],
        "range": [bottom, top],
        "tickvals": [mark.value for mark in y_marks],
        "ticktext": [mark.words for mark in y_marks],
        "showticklabels": index == 0,
    }
    if index == 0:
        y_axis["title"] = {"text": axes.axis_label("y"), "standoff": 1, "font": {"size": SIZE}}
        y_axis["scaleanchor"] = "x"
    else:
        x_axis["matches"], y_axis["matches"] = "x", "y"
    layout[_numbered("xaxis", index)], layout[_numbered("yaxis", index)] = x_axis, y_axis
    on_panel: Parts = {"xref": f"{x} domain", "yref": f"{y} domain"}
    layout["annotations"].append(
        {
            "text": f"<b>{data.names[index]}</b>",
            "font": {"size": SIZE + 2, "color": data.colors[index]},
            "showarrow": False,
            "xref": "paper",
            "yref": "paper",
            "x": (box.left + box.width / 2) / place.width,
            "y": 1 - (box.top - 3) / place.height,
            "xanchor": "center",
            "yanchor": "bottom",
            "borderpad": 0,
        }
    )
    why = axes.emptiness(data, index)
    if why:
        note = {"text": why, "showarrow": False, "x": 0.5, "y": 0.8, "bgcolor": "#ffffff"}
        layout["annotations"].append({**note, **on_panel})
    hatching = _hatch_image(round(box.width), round(box.height))
    fit: Parts = {"x": 0, "y": 1, "sizex": 1, "sizey": 1, "sizing": "stretch", "layer": "below"}
    layout["images"].append({"source": hatching, **fit, **on_panel})


def _values(data: MapData, index: int, scale: Scale, color_axis: str) -> Parts:
    factor, unit = data.display
    values = data.values[index]
    # Colors go by the position on the bar, which serves both kinds of scale and infinite values;
    # what is read off is the value itself. Single precision halves what is sent.
    return {
        "type": "heatmap",
        "x": data.x * MM,
        "y": data.y * MM,
        "z": np.clip(scale.position(values), -1.0, 2.0).astype(np.float32),
        "customdata": (values * factor).astype(np.float32),
        "coloraxis": color_axis,
        "hoverongaps": False,
        "hovertemplate": f"<b>{data.names[index]} = %{{customdata:.4~g}} {unit}</b>{_where(data)}",
    }


def _reasons(data: MapData, index: int) -> list[Parts]:
    """Return a layer that says why there is no value, transparent but where it is singular."""
    masked = np.isnan(data.values[index])
    if not masked.any():
        return []
    dark = raster.codes(data.values[index], data.status, _ANY) == raster.UNDEFINED
    clear = "rgba(0,0,0,0)"
    gray = colors.SINGULAR
    return [
        {
            "type": "heatmap",
            "x": data.x * MM,
            "y": data.y * MM,
            "z": np.where(masked, dark, np.nan).astype(np.float32),
            "text": np.where(masked, axes.reasons(data), "").astype(object),
            "zmin": 0,
            "zmax": 1,
            "colorscale": [[0, clear], [0.5, clear], [0.5, gray], [1, gray]],
            "showscale": False,
            "hoverongaps": False,
            "hovertemplate": f"<b>no value: %{{text}}</b>{_where(data)}",
        }
    ]


_ANY = Scale(0.0, 1.0)


def _where(data: MapData) -> str:
    theta, z = number(np.degrees(data.theta)), number(data.z * MM)
    place = "x = %{x:.1f} mm, y = %{y:.1f} mm"
    return f"<br>{place}<br>θ = {theta}°, z = {z} mm<extra></extra>"


def _lines(
    found: list[lines.Line], color: str, width: float, dash: str | None = None
) -> list[Parts]:
    if not found:
        return []
    gap = np.full((1, 2), np.nan)
    points = np.concatenate([part for line in found for part in (line, gap)])[:-1]
    points = (points * MM).astype(np.float32)
    return [
        {
            "type": "scatter",
            "mode": "lines",
            "x": points[:, 0],
            "y": points[:, 1],
            "line": {"color": color, "width": width, "dash": dash},
            "hoverinfo": "skip",
        }
    ]


def _dot(data: MapData, size: float, color: str, edge: float) -> Parts:
    return {
        "type": "scatter",
        "mode": "markers",
        "x": [float(data.pose[0]) * MM],
        "y": [float(data.pose[1]) * MM],
        "marker": {"size": size, "color": color, "line": {"color": INK, "width": edge}},
        "hoverinfo": "skip",
    }


@lru_cache(maxsize=8)
def _hatch_image(width: int, height: int) -> str:
    """Return hatching for one panel as a picture in a link, at twice the pixels of the page."""
    fine = raster.hatching(2 * height, 2 * width, 14)
    bold = fine | np.roll(fine, 1, axis=1)
    gray = np.where(bold, np.uint8(1), np.uint8(0))
    picture = Image.fromarray(gray, mode="P")
    picture.putpalette([*rgb(colors.REACHLESS), *rgb(colors.HATCH)])
    stream = BytesIO()
    picture.save(stream, format="png", bits=1, optimize=True)
    return "data:image/png;base64," + b64encode(stream.getvalue()).decode()
