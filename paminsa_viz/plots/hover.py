"""Hover and clicks on maps: position and value at the pointer, or why there is no value.

A plotly figure without colors lies over the image of `map_figure.LiveMaps` and has its layout.
Only the image changes while a slider moves, so that nothing jumps when it stops.
"""

from __future__ import annotations

import json
from base64 import b64encode
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from paminsa_viz.model.reach import Limit
from paminsa_viz.plots.map_layout import MapLayout
from paminsa_viz.plots.map_values import MapData
from paminsa_viz.units import MM, number

FONT = "DejaVu Sans, Verdana, Helvetica, Arial, sans-serif"

REASON_CELLS = 72
"""Cells along a side, at most, with a reason for a missing value; texts are long."""


def reasons(data: MapData, panel: int, stride: int = 1) -> NDArray[np.str_]:
    """Return for every ``stride``-th cell of a panel why it has no value, or an empty text."""
    picked = (slice(stride // 2, None, stride),) * 2
    status = data.status[picked]
    leg = np.full(status.shape, -1) if data.leg is None else data.leg[picked]
    texts = np.array([[limit.reason(leg) for leg in range(-1, 3)] for limit in Limit])
    found = texts[status, leg + 1]
    if data.missing is not None:
        code = data.missing.code[picked]
        found = np.where((status == 0) & (code != 0), np.array(data.missing.texts)[code], found)
    empty = (status != 0) | np.isnan(data.values[panel][picked])
    return np.where(empty, found, "")


def emptiness(data: MapData, panel: int) -> str:
    """Return why a panel shows no values, or an empty text if it shows some."""
    if not np.isnan(data.values[panel]).all():
        return ""
    if set(np.unique(data.status)) == {Limit.SINGULAR}:
        return "singular everywhere"
    return "no value here" if (data.status == 0).any() else "nothing reachable here"


def value_text(data: MapData, panel: int, value: str = "z") -> str:
    """Return plotly's template for a cell with a value."""
    quantity = f"{data.names[panel]} = %{{{value}:.4~g}} {data.display.text}".rstrip()
    return f"<b>{quantity}</b>{_place(data)}"


def reason_text(data: MapData) -> str:
    """Return plotly's template for a cell without a value."""
    return f"<b>%{{text}}</b>{_place(data)}"


def _place(data: MapData) -> str:
    pose = f"θ = {number(np.degrees(data.theta))}°, z = {number(MM * data.z)} mm"
    return f"<br>x = %{{x:.1f}} mm, y = %{{y:.1f}} mm<br>{pose}<extra></extra>"


class HoverFigure:
    """A figure for viser, which only calls `to_json`.

    Plotly's own classes would take ten times as long, and half a second to import.
    """

    def __init__(self, data: MapData, layout: MapLayout, name: str) -> None:
        """Prepare the figure for maps; ``name`` comes back with every click."""
        traces = [
            trace
            for index in range(data.panels)
            for trace in (_reasons(data, index), _values(data, index))
        ]
        config = {"displayModeBar": False, "doubleClick": False, "scrollZoom": False}
        self._tree = {"data": traces, "layout": _layout(data, layout, name), "config": config}

    def to_json(self) -> str:
        """Return the figure as Plotly's JSON."""
        return json.dumps(self._tree, separators=(",", ":"))


def _layout(data: MapData, layout: MapLayout, name: str) -> dict[str, Any]:
    left, right, bottom, top = (MM * edge for edge in data.extent)
    width, height = layout.width, layout.height
    out: dict[str, Any] = {
        "meta": name,
        "width": width,
        "height": height,
        "margin": {"l": 0, "r": 0, "t": 0, "b": 0, "pad": 0},
        "paper_bgcolor": "rgba(0,0,0,0)",
        "plot_bgcolor": "rgba(0,0,0,0)",
        "showlegend": False,
        "dragmode": False,
        "hovermode": "closest",
        "hoverlabel": {"font": {"family": FONT, "size": 12}},
    }
    for index, panel in enumerate(layout.panels):
        number = axis_number(index)
        fixed = {"visible": False, "fixedrange": True}
        across = [panel.left / width, min(panel.right / width, 1.0)]
        up = [max(1 - panel.bottom / height, 0.0), 1 - panel.top / height]
        x_axis = {"anchor": f"y{number}", "range": [left, right], "domain": across}
        y_axis = {"anchor": f"x{number}", "range": [bottom, top], "domain": up}
        out |= {f"xaxis{number}": fixed | x_axis, f"yaxis{number}": fixed | y_axis}
    return out


def _values(data: MapData, index: int) -> dict[str, Any]:
    # Beyond single precision Plotly would see a gap.
    values = np.clip(data.values[index] * data.display[0], -1e30, 1e30)
    trace = _heatmap(data.x, data.y, values, index)
    return trace | {"zmin": 0, "zmax": 1, "hovertemplate": value_text(data, index)}


def _reasons(data: MapData, index: int) -> dict[str, Any]:
    stride = max(1, -(-data.x.size // REASON_CELLS))
    texts = reasons(data, index, stride)
    picked = slice(stride // 2, None, stride)
    trace = _heatmap(data.x[picked], data.y[picked], np.where(texts == "", np.nan, 0.0), index)
    return trace | {"text": texts.tolist(), "hovertemplate": reason_text(data)}


def _heatmap(
    x: NDArray[np.float64], y: NDArray[np.float64], z: ArrayLike, index: int
) -> dict[str, Any]:
    number = axis_number(index)
    return {
        "type": "heatmap",
        "x": _packed(MM * x),
        "y": _packed(MM * y),
        "z": _packed(z),
        "xaxis": f"x{number}",
        "yaxis": f"y{number}",
        "opacity": 0,
        "showscale": False,
        "hoverongaps": False,
    }


def axis_number(index: int) -> str:
    """Return how plotly numbers the axes of a panel: nothing for the first, then 2, 3."""
    return "" if index == 0 else str(index + 1)


def _packed(array: ArrayLike) -> dict[str, str]:
    """Return an array as Plotly's base64 form, in single precision."""
    numbers = np.ascontiguousarray(array, dtype="<f4")
    packed = {"dtype": "f4", "bdata": b64encode(numbers.tobytes()).decode()}
    if numbers.ndim > 1:
        packed["shape"] = ", ".join(map(str, numbers.shape))
    return packed
