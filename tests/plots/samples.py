"""Maps for the tests: made up, random, and of the real robot."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from io import BytesIO
from typing import Any

import numpy as np
from hypothesis import strategies as st
from PIL import Image

from paminsa_viz.model import APPENDIX_4, Design, solve_field, xy_grid
from paminsa_viz.model.reach import Limit
from paminsa_viz.palette import LEG_COLORS
from paminsa_viz.plots import colors
from paminsa_viz.plots.contours import FloorPath
from paminsa_viz.plots.map_figure import LiveMaps
from paminsa_viz.plots.map_values import MapData, map_data
from paminsa_viz.plots.scale import Scale
from paminsa_viz.quantities import TORQUES

SAMPLE = replace(APPENDIX_4, name="Sample")


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
        "design": SAMPLE,
        "title": "Made-up torques",
        "margin": margin,
        "leg": np.where(margin > 0, -1, 1).astype(np.int8),
    }
    return MapData(**{**fields, **changes})


@cache
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
    table = draw(st.sampled_from([colors.DIVERGING, colors.SEQUENTIAL]))
    return Scale(low, high, kind, threshold, table)


SCALE = Scale(-5.0, 5.0)
SCALES = (SCALE,) * 3
OWN = (Scale(-1.0, 1.0), Scale(-2.0, 2.0), Scale(-3.0, 3.0))
SWEEP = np.stack([np.linspace(-0.6, 0.6, 200), np.linspace(-0.1, 0.1, 200)], axis=1)
PATH = FloorPath(SWEEP[:150], SWEEP[149:])
EMPTY = made_up(
    values=np.full((3, 27, 31), np.nan),
    status=np.full((27, 31), 2, np.uint8),
    margin=np.full((27, 31), -0.1),
)


def pixels(content: bytes) -> np.ndarray:
    return np.asarray(Image.open(BytesIO(content)).convert("RGB"))


def crop(image: np.ndarray, place: Any, scale: float = 1.0) -> np.ndarray:
    """Return the pixels inside a panel, without its frame."""
    left, right, top, bottom = (
        round(scale * edge) for edge in (place.left, place.right, place.top, place.bottom)
    )
    return image[top + 2 : bottom - 2, left + 2 : right - 2]


def panel_and_same(panel: int) -> tuple[MapData, MapData]:
    """Return two maps, and maps that are both one of them."""
    data = made_up(nx=61, ny=61, panels=2)
    return data, replace(data, values=np.repeat(data.values[panel : panel + 1], 2, axis=0))


def live(data: MapData, scales: Any, width: int, ratio: float = 1.0, **options: Any) -> np.ndarray:
    return LiveMaps().draw(data, scales, width, ratio, **options)
