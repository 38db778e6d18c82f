"""What the charts of the balance have in common, as parts of Plotly's JSON."""

from __future__ import annotations

from typing import Any

from paminsa_viz.palette import INK, MUTED
from paminsa_viz.plots.hover import FONT

AXIS: dict[str, Any] = {
    "fixedrange": True, "gridcolor": "#e4e8ec", "zerolinecolor": "#b9c1c9", "linecolor": MUTED,
    "ticks": "outside", "tickcolor": MUTED, "automargin": True,
}  # fmt: skip

LAYOUT: dict[str, Any] = {
    "font": {"family": FONT, "size": 12, "color": INK}, "dragmode": False, "hovermode": "closest",
    "margin": {"l": 8, "r": 26, "t": 8, "b": 8}, "showlegend": True,
    "paper_bgcolor": "rgba(0,0,0,0)", "plot_bgcolor": "rgba(0,0,0,0)",
    "legend": {"x": 1, "y": 1, "xanchor": "right", "bgcolor": "rgba(255,255,255,0.7)"},
}  # fmt: skip

CONFIG = {"displayModeBar": False, "doubleClick": False}
