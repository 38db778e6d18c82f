"""A Plotly figure that shows nothing and says everything: values under the pointer, and clicks.

It lies over the picture that `paminsa_viz.plots.live.live_image` draws and has its layout. The
picture alone changes while the hand moves, so that nothing jumps or flickers when it rests.
"""

from __future__ import annotations

import json
from base64 import b64encode
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from paminsa_viz.model import Limit
from paminsa_viz.plots.layout import Layout
from paminsa_viz.plots.maps import MapData
from paminsa_viz.plots.screen import FONT
from paminsa_viz.units import MM, number

REASON_CELLS = 72
"""Cells along a side, at most, that say why nothing is there; words are long."""

REASONS = {
    Limit.NOT_FINITE: "out of reach",
    Limit.STRETCHED: "out of reach: over-stretched",
    Limit.FOLDED: "out of reach: folded too far",
    Limit.GUIDE: "out of reach: joint 8 would leave its guide",
    Limit.AXIS: "out of reach: joint 5 on its leg axis",
    Limit.SINGULAR: "singular: no torque holds it",
}


class HoverFigure:
    """A figure as viser wants it: it asks for the JSON and nothing else.

    Plotly's own classes would take ten times as long, and half a second to import.
    """

    def __init__(self, data: MapData, layout: Layout, name: str) -> None:
        """Prepare the figure for maps; ``name`` comes back with every click."""
        self._tree = {
            "data": [
                trace
                for index in range(data.panels)
                for trace in (_reasons(data, index), _values(data, index))
            ],
            "layout": _layout(data, layout, name),
            "config": {"displayModeBar": False, "doubleClick": False, "scrollZoom": False},
        }

    def to_json(self) -> str:
        """Return the figure as Plotly's JSON."""
        return json.dumps(self._tree, separators=(",", ":"))


def _axis(index: int) -> str:
    return "" if index == 0 else str(index + 1)


def _layout(data: MapData, layout: Layout, name: str) -> dict[str, Any]:
    left, right, bottom, top = (edge * MM for edge in data.extent)
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
    for index, box in enumerate(layout.panels):
        still = {"visible": False, "fixedrange": True}
        number = _axis(index)
        out[f"xaxis{number}"] = still | {
            "anchor": f"y{number}",
            "range": [left, right],
            "domain": [box.left / width, min(box.right / width, 1.0)],
        }
        out[f"yaxis{number}"] = still | {
            "anchor": f"x{number}",
            "range": [bottom, top],
            "domain": [max(1 - box.bottom / height, 0.0), 1 - box.top / height],
        }
    return out


def _values(data: MapData, index: int) -> dict[str, Any]:
    factor, unit = data.display
    values = data.values[index] * factor
    # Beyond single precision Plotly would see a gap.
    values = np.clip(values, -1e30, 1e30)
    quantity = f"<b>{data.names[index]} = %{{z:.4~g}}{' ' + unit if unit else ''}</b>"
    return _heatmap(data.x, data.y, values, index) | {
        "zmin": 0,
        "zmax": 1,
        "hovertemplate": f"{quantity}<br>{_where(data)}",
    }


def _reasons(data: MapData, index: int) -> dict[str, Any]:
    step = max(1, -(-data.x.size // REASON_CELLS))
    picked = slice(step // 2, None, step)
    status = data.status[picked, picked]
    masked = (status != 0) | np.isnan(data.values[index][picked, picked])
    kinds = status.astype(np.int64) * 4
    if data.leg is not None:
        kinds += data.leg[picked, picked] + 1
    names = np.array([_reason(code // 4, code % 4) for code in range(4 * len(Limit))])
    words = np.where(masked, names[kinds], "")
    z = np.where(masked, 0.0, np.nan)
    return _heatmap(data.x[picked], data.y[picked], z, index) | {
        "text": words.tolist(),
        "hovertemplate": f"<b>%{{text}}</b><br>{_where(data)}",
    }


def _reason(status: int, leg: int) -> str:
    words = REASONS.get(Limit(status), "no value")
    return f"{words} (leg {leg})" if leg else words


def _where(data: MapData) -> str:
    pose = f"θ = {number(np.degrees(data.theta))}°, z = {number(data.z * MM)} mm"
    return f"x = %{{x:.1f}} mm, y = %{{y:.1f}} mm<br>{pose}<extra></extra>"


def _heatmap(
    x: NDArray[np.float64], y: NDArray[np.float64], z: ArrayLike, index: int
) -> dict[str, Any]:
    number = _axis(index)
    return {
        "type": "heatmap",
        "x": _packed(x * MM),
        "y": _packed(y * MM),
        "z": _packed(z),
        "xaxis": f"x{number}",
        "yaxis": f"y{number}",
        "opacity": 0,
        "showscale": False,
        "hoverongaps": False,
    }


def _packed(array: ArrayLike) -> dict[str, str]:
    """Return an array as Plotly's base64 form, in single precision."""
    numbers = np.ascontiguousarray(array, dtype="<f4")
    packed = {"dtype": "f4", "bdata": b64encode(numbers.tobytes()).decode()}
    if numbers.ndim > 1:
        packed["shape"] = ", ".join(map(str, numbers.shape))
    return packed
