"""The chart of a calibration: by how much each measured pose is missed, before and after."""

from __future__ import annotations

from typing import Any

import numpy as np

from paminsa_viz.explorer.features.calibration.actions import CALIBRATE
from paminsa_viz.explorer.kit.chart import LEGEND_ABOVE, Tree, figure
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model.arrays import Array
from paminsa_viz.palette import INK, MUTED
from paminsa_viz.precision import Calibration
from paminsa_viz.units import display_unit


def shown_residuals(state: State) -> tuple[Calibration] | None:
    """Return what the chart shows, or None."""
    found = CALIBRATE.result(state)
    return None if found is None else (found,)


def residual_sizes(residuals: Array) -> tuple[Array, Array]:
    """Return distances of position [µm] and of heading [″] of residuals (n, c), each (n,)."""
    position = np.linalg.norm(residuals[:, [0, 1, 3]], axis=1)
    factors = (display_unit(unit).factor for unit in ("m:um", "rad:arcsec"))
    along, around = factors
    return along * position, around * np.abs(residuals[:, 2])


def residual_figure(found: Calibration) -> Tree:
    """Return the figure of the residuals over the poses, on logarithmic axes."""
    number = np.arange(1, len(found.held) + 1)
    kinds = [
        ("before", found.residuals_before, MUTED, ~found.held, "circle-open"),
        ("before, held back", found.residuals_before, MUTED, found.held, "square-open"),
        ("after", found.residuals_after, INK, ~found.held, "circle"),
        ("after, held back", found.residuals_after, INK, found.held, "square"),
    ]
    data: list[Tree] = []
    for name, residuals, color, chosen, symbol in kinds:
        if not chosen.any():
            continue
        for axis, unit, sizes in zip(
            ("", "2"), ("µm", "″"), residual_sizes(residuals), strict=True
        ):
            trace: dict[str, Any] = {
                "type": "scatter", "mode": "markers", "name": name, "legendgroup": name,
                "showlegend": not axis, "x": number[chosen].tolist(), "y": sizes[chosen].tolist(),
                "yaxis": f"y{axis}", "xaxis": "x", "cliponaxis": False,
                "marker": {"color": color, "size": 6, "symbol": symbol, "opacity": 1},
                "hovertemplate": f"pose %{{x}}, {name}: %{{y:.3~r}} {unit}<extra></extra>",
            }  # fmt: skip
            data.append(trace)
    titles = ("measured pose", "position [µm]", "heading [″]")
    shown = figure(data, *titles, legend=LEGEND_ABOVE)
    for axis in ("yaxis", "yaxis2"):
        shown["layout"][axis] |= {"type": "log", "tickformatstops": [], "dtick": 1}
    return shown
