"""Maps for the tests: made up, random, and of the real robot."""

from __future__ import annotations

from typing import Any

import numpy as np
from hypothesis import strategies as st

from paminsa_viz.model import APPENDIX_4, Design, solve_field, xy_grid
from paminsa_viz.model.design import KneeBranch
from paminsa_viz.model.reach import Limit
from paminsa_viz.palette import LEG_COLORS
from paminsa_viz.plots.map_data import MapData, Provenance, map_data
from paminsa_viz.plots.scale import Scale
from paminsa_viz.quantities import TORQUES

SOURCE = Provenance(
    "Sample", KneeBranch.LOWER, "0.0.1", (("M", 1.25, "N"),), (("links.b3 [kg]", 0.4),)
)


def made_up(nx: int = 31, ny: int = 27, panels: int = 3, **changes: Any) -> MapData:
    """Return maps with a pole on the circle r = 0.25 m, cut off beyond an ellipse."""
    x, y = np.linspace(-0.42, 0.42, nx), np.linspace(-0.36, 0.36, ny)
    right, up = np.meshgrid(x, y)
    radius = np.hypot(right, up)
    with np.errstate(divide="ignore"):
        pole = 1.0 / (0.25 - radius)
    turn = np.arange(panels)[:, None, None] * 2 * np.pi / 3
    values = 0.3 * pole * np.cos(np.arctan2(up, right) + turn) + 0.5
    margin = 0.3 - np.hypot(right / 1.3, up)
    status = np.where(margin > 0, Limit.OK, Limit.STRETCHED).astype(np.uint8)
    values[:, status != 0] = np.nan
    fields: dict[str, Any] = {
        "x": x,
        "y": y,
        "values": values,
        "status": status,
        "names": tuple(f"τ{'₁₂₃'[i]}" for i in range(panels)),
        "unit": "N m",
        "colors": LEG_COLORS[:panels],
        "pose": (0.05, -0.03, 1.0, -0.5),
        "singular_radius": 0.25,
        "provenance": SOURCE,
        "title": "Made-up torques",
        "margin": margin,
        "leg": np.where(margin > 0, -1, 1).astype(np.int8),
    }
    return MapData(**{**fields, **changes})


def real(
    cells: int = 61,
    theta: float = np.pi / 3,
    z: float = -0.5,
    quantities: tuple[str, ...] = TORQUES,
    design: Design = APPENDIX_4,
) -> MapData:
    """Return maps of the robot."""
    axis = np.linspace(-0.4, 0.4, cells)
    field = solve_field(design.geometry, xy_grid(axis, axis, theta, z))
    return map_data(field, design, (0.05, -0.03, theta, z), quantities)


sizes = st.floats(1e-6, 1e6)


@st.composite
def scales(draw: st.DrawFn) -> Scale:
    """Draw any sensible scale: diverging or sequential, linear or log, centered or not."""
    low = draw(st.one_of(st.just(0.0), sizes, sizes.map(lambda v: -v)))
    high = low + draw(st.floats(1e-3, 1e3)) * max(abs(low), 1e-3)
    if draw(st.booleans()):
        high = draw(sizes)
        low = -high
    kind = draw(st.sampled_from(["linear", "symlog"]))
    threshold = draw(st.floats(1e-4, 0.9)) * max(abs(low), abs(high))
    table = draw(st.sampled_from(["blue-vermillion", "RdBu_r", "PuOr_r", "viridis", "cividis"]))
    return Scale(low, high, kind, threshold, table)
