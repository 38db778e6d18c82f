"""Maps as an interactive plotly figure, for notebooks: values under the pointer, and zoom."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import plotly.graph_objects as go
import plotly.io
from plotly.subplots import make_subplots

from paminsa_viz.checks import kinds_checked, require_at_least
from paminsa_viz.palette import INK
from paminsa_viz.plots import colors, contours
from paminsa_viz.plots.contours import Line
from paminsa_viz.plots.hover import (
    FONT,
    PLACE_FORMAT,
    axis_number,
    reason_text,
    reasons,
    value_text,
)
from paminsa_viz.plots.map_values import MapData
from paminsa_viz.plots.ranges import per_panel
from paminsa_viz.plots.scale import Scale
from paminsa_viz.units import MM, number

CONFIG: dict[str, Any] = {"displayModeBar": False, "doubleClick": "reset"}
"""How plotly should behave: no buttons over the headings, double click goes back from a zoom."""

LEAST_WIDTH = 200
"""Least width of a figure [page pixels]; with less there is no room for the maps."""

BY_SCRIPT = ("plotly_mimetype", "jupyterlab", "vscode", "nteract")
"""Plotly's renderers whose output is data alone, which a script of the notebook's program draws."""

WITHOUT_SCRIPT = "Maps, drawn by plotly’s script; write_html(path) writes a page that has it."
"""What a notebook says where that script is missing, as in its export as HTML or PDF."""


class MapFigure(go.Figure):
    """Maps as a plotly figure that a notebook shows without more than its kernel."""

    def _ipython_display_(self) -> None:
        if plotly.io.renderers.default in BY_SCRIPT:
            # By this error IPython knows to ask for the outputs below. Plotly's own needs nbformat,
            # which a kernel in VS Code comes without, and says nothing where its script is missing.
            raise NotImplementedError
        super()._ipython_display_()

    def _repr_mimebundle_(self, *args: Any, **named: Any) -> dict[str, Any]:
        found = super()._repr_mimebundle_(*args, **named)
        # A picture beside the data would be preferred to them in JupyterLab, without any values.
        return found | {"text/plain": WITHOUT_SCRIPT}

    def _repr_html_(self) -> str | None:
        # Plotly's asks the network for its script, and would be preferred too.
        return None if plotly.io.renderers.default in BY_SCRIPT else super()._repr_html_()


@kinds_checked
def interactive_map(data: MapData, scale: Scale | Sequence[Scale], width: int = 900) -> go.Figure:
    """Draw all panels side by side: colors, contours, boundary, singular circle and pose.

    Hover gives position and value, or why there is none. Zooming one panel zooms all.

    Args:
        data: The maps.
        scale: One color scale for all panels, or one for each.
        width: Width of the figure [page pixels]; the height follows.

    Raises:
        InvalidInput: If the width is less than `LEAST_WIDTH`.
        InvalidScale: If the number of scales is not that of the panels.
    """
    require_at_least(width, "width", LEAST_WIDTH, f"at least {LEAST_WIDTH} pixels")
    scales = per_panel(data, scale)
    shared = len(set(scales)) == 1
    figure: Any = make_subplots(
        1, data.panels, shared_yaxes=True, horizontal_spacing=0.03, figure=MapFigure(),
        subplot_titles=[f"<b>{name}</b>" for name in data.names],
    )  # fmt: skip
    for index, (note, color) in enumerate(zip(figure.layout.annotations, data.colors, strict=True)):
        note.update(font={"size": 14, "color": color})
        figure.add_traces(
            _cells(data, index, scales[index], 0 if shared else index)
            + _lines(data, index, scales[index]),
            rows=1, cols=index + 1,
        )  # fmt: skip
    left, right, bottom, top = (MM * edge for edge in data.extent)
    line = {"ticks": "outside", "showgrid": False, "zeroline": False, "mirror": True,
            "showline": True, "linecolor": INK, "constrain": "domain",
            "hoverformat": PLACE_FORMAT}  # fmt: skip
    figure.update_xaxes(range=[left, right], title="x [mm]", matches="x", **line)
    figure.update_yaxes(range=[bottom, top], scaleanchor="x", **line)
    figure.update_yaxes(title="y [mm]", col=1)
    for index, each in enumerate(scales[:1] if shared else scales):
        place = {} if shared else _below(index, data.panels)
        figure.layout[f"coloraxis{axis_number(index)}"] = _color_axis(data, each, place)
    figure.update_layout(
        width=width,
        height=round((width - 150) / data.panels * (top - bottom) / (right - left))
        + 110
        + (0 if shared else 60),
        margin={"l": 60, "r": 20, "t": 40, "b": 60},
        plot_bgcolor=colors.REACHLESS,
        paper_bgcolor="white",
        font={"family": FONT, "size": 12, "color": INK},
        showlegend=False,
    )
    return figure


def _cells(data: MapData, index: int, scale: Scale, axis: int) -> list[go.Heatmap]:
    """Return the values, and a transparent layer with the reasons for missing ones."""
    factor = data.display[0]
    values = data.values[index]
    texts = reasons(data, index)
    place: dict[str, Any] = {"x": MM * data.x, "y": MM * data.y, "hoverongaps": False}
    # Colors go by the position on the bar, which serves both kinds of scale and infinite values;
    # hover shows the value itself, as text, since plotly would write a hyphen for a minus sign.
    # Single precision halves the data.
    shown = go.Heatmap(
        z=np.clip(scale.position(values), -1.0, 2.0).astype(np.float32),
        text=[[number(value) for value in row] for row in (values * factor).tolist()],
        coloraxis=f"coloraxis{axis_number(axis)}", hovertemplate=value_text(data, index), **place,
    )  # fmt: skip
    singular = np.char.startswith(texts, "singular")
    clear, gray = "rgba(0,0,0,0)", colors.SINGULAR
    why = go.Heatmap(
        z=np.where(texts == "", np.nan, singular).astype(np.float32), text=texts.astype(object),
        zmin=0, zmax=1, colorscale=[[0, clear], [0.5, clear], [0.5, gray], [1, gray]],
        showscale=False, hovertemplate=reason_text(data), **place,
    )  # fmt: skip
    return [shown, why]


def _lines(data: MapData, index: int, scale: Scale) -> list[go.Scatter]:
    circle = contours.singular_circle(data)
    found = contours.contour_lines(data, index, scale)
    drawn = [
        *(_line(line, scale.ink(level), 1.0 if level else 1.6) for level, line in found.items()),
        _line(contours.boundary(data), INK, 1.6),
        _line(circle, "#ffffff", 2.4),
        _line(circle, INK, 1.6, "5px,4px"),
    ]
    ring = {"size": 10, "color": "#ffffff", "line": {"color": INK, "width": 1.8}}
    x, y = (MM * float(value) for value in data.pose[:2])
    drawn.append(go.Scatter(x=[x], y=[y], mode="markers", marker=ring, hoverinfo="skip"))
    return drawn


def _line(line: Line, color: str, width: float, dash: str | None = None) -> go.Scatter:
    x, y = MM * line.astype(np.float32).T
    style = {"color": color, "width": width, "dash": dash}
    return go.Scatter(x=x, y=y, mode="lines", line=style, hoverinfo="skip")


def _color_axis(data: MapData, scale: Scale, place: dict[str, Any]) -> dict[str, Any]:
    """Return a plotly color axis over positions on the bar, with blocks for values beyond it."""
    edge = 0.045
    steps = np.linspace(0, 255, 65).round().astype(int)
    shades = (255 * scale.table[steps]).round().astype(int).tolist()
    where = np.linspace(edge, 1 - edge, steps.size).tolist()  # plotly wants no step back
    inner = [[at, f"rgb{tuple(shade)}"] for at, shade in zip(where, shades, strict=True)]
    under, over = scale.beyond
    factor, unit = data.display
    values = scale.ticks(6)
    bar = {
        "title": {"text": f"[{unit}]" if unit else ""},
        "tickvals": scale.position(np.array(values)).tolist(),
        "ticktext": [number(value * factor) for value in values],
        "ticks": "outside",
        "tickangle": 0,
        "thickness": 14,
        **place,
    }
    return {
        "cmin": -edge / (1 - 2 * edge),
        "cmax": 1 + edge / (1 - 2 * edge),
        "colorscale": [[0, under], [where[0], under], *inner, [where[-1], over], [1, over]],
        "colorbar": bar,
    }


def _below(index: int, panels: int) -> dict[str, Any]:
    """Return where the color bar of one of several panels lies: below it."""
    middle = (index + 0.5) / panels
    return {"orientation": "h", "x": middle, "y": -0.2, "yanchor": "top", "len": 0.8 / panels}
