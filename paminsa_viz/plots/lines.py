"""Lines on a map: contours, the boundary of the workspace, the singular circle.

Lines are lists of (n, 2) arrays of x and y [m].
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from contourpy import LineType, contour_generator
from numpy.typing import NDArray

from paminsa_viz.model.reach import Limit
from paminsa_viz.plots.maps import MapData
from paminsa_viz.plots.scale import Scale

Line = NDArray[np.float64]


def contour_lines(
    data: MapData, panel: int, scale: Scale, most: int | None = None, joined: bool = False
) -> dict[float, list[Line]]:
    """Return the contour lines of one panel by level.

    Torques change sign through infinity on the singular circle, where every contour would seem to
    run; lines therefore stop at cells next to the circle that lie beyond the range. For the same
    reason no line runs between cells that lie beyond opposite ends of the range.

    Args:
        data: The maps.
        panel: Index of the panel.
        scale: Its scale, which knows the levels.
        most: About how many points along an axis to use at most, for quick drawings; None for all.
        joined: Return one array a level, in which a point that is not finite parts two lines.
    """
    stride = 1 if most is None else max(1, min(data.x.size, data.y.size) // most)
    x, y, field = contour_field(data, panel, scale, stride)
    shown = field.compressed()
    if shown.size == 0 or min(field.shape) < 2:
        return {}
    low, high = float(shown.min()), float(shown.max())
    kind = LineType.ChunkCombinedNan if joined else LineType.Separate
    generator = contour_generator(x, y, field, name="serial", line_type=kind)
    found: dict[float, list[Line]] = {}
    for level in scale.levels:
        if not low <= level <= high:
            continue
        lines: Any = generator.lines(level)
        parts = [part for part in (lines[0] if joined else lines) if part is not None]
        if parts:
            found[level] = parts
    return found


def contour_field(
    data: MapData, panel: int, scale: Scale, stride: int = 1
) -> tuple[Line, Line, np.ma.MaskedArray]:
    """Return x, y [m] and the values (ny, nx) to contour, masked as `contour_lines` says."""
    x, y = data.x[::stride], data.y[::stride]
    values = data.values[panel, ::stride, ::stride]
    with np.errstate(invalid="ignore"):
        beyond = (values < scale.low) | (values > scale.high)
        hidden = ~np.isfinite(values) | _torn(values, scale)
    if x.size > 1 and y.size > 1:
        hidden |= beyond & _near_circle(x, y, data.singular_radius)
    return x, y, np.ma.array(values, mask=hidden)


def boundary(data: MapData) -> list[Line]:
    """Return the boundary of what is reached: where the margin is zero, or along the cells."""
    field, level = _reached(data)
    generator = contour_generator(data.x, data.y, field, name="serial", line_type=LineType.Separate)
    return list(generator.lines(level))  # type: ignore[arg-type]


def reached_area(data: MapData) -> list[tuple[Line, NDArray[np.uint32]]]:
    """Return the area that `boundary` encloses as polygons with holes.

    Each is an array of points (n, 2) [m] and the offsets at which its rings start and end, the
    outer ring first.
    """
    field, level = _reached(data)
    generator = contour_generator(data.x, data.y, field, name="serial", fill_type="OuterOffset")
    points, offsets = generator.filled(level, np.inf)  # type: ignore[misc]
    return list(zip(points, offsets, strict=True))  # type: ignore[arg-type]


def _reached(data: MapData) -> tuple[NDArray[np.float64], float]:
    if data.margin is not None and np.isfinite(data.margin).any():
        return np.ma.masked_invalid(data.margin), 0.0
    # Singular cells lie inside the workspace; they are no boundary.
    reached = (data.status == Limit.OK) | (data.status == Limit.SINGULAR)
    return reached.astype(np.float64), 0.5


def singular_circle(data: MapData, points: int = 181) -> list[Line]:
    """Return the singular circle about the origin, if there is one and the map shows some of it."""
    radius = data.singular_radius
    if not radius:
        return []
    left, right, bottom, top = data.extent
    if radius > math.hypot(max(-left, right), max(-bottom, top)):
        return []
    angle = np.linspace(0.0, 2 * np.pi, points)
    circle = radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    inside = (
        (circle[:, 0] >= left)
        & (circle[:, 0] <= right)
        & (circle[:, 1] >= bottom)
        & (circle[:, 1] <= top)
    )
    cuts = np.flatnonzero(np.diff(inside.astype(np.int8))) + 1
    runs = np.split(np.arange(points), cuts)
    return [circle[run] for run in runs if run.size > 1 and inside[run[0]]]


def _near_circle(x: Line, y: Line, radius: float | None) -> NDArray[np.bool_]:
    """Return the points (ny, nx) so close to the circle that no cell without one crosses it.

    Two corners of a cell are at most its diagonal apart, so if the circle runs between them, one
    is within half of that.
    """
    if not radius:
        return np.zeros((y.size, x.size), dtype=np.bool_)
    half = 0.5001 * math.hypot(x[1] - x[0], y[1] - y[0])
    square = x[None, :] ** 2 + y[:, None] ** 2
    return (square > max(radius - half, 0.0) ** 2) & (square < (radius + half) ** 2)


def _torn(values: NDArray[np.float64], scale: Scale) -> NDArray[np.bool_]:
    """Return the cells beyond one end of the range that touch a cell beyond the other end."""
    with np.errstate(invalid="ignore"):
        under, over = values < scale.low, values > scale.high
    return (under & _spread(over)) | (over & _spread(under))


def _spread(mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
    wide = mask.copy()
    wide[1:] |= mask[:-1]
    wide[:-1] |= mask[1:]
    wider = wide.copy()
    wider[:, 1:] |= wide[:, :-1]
    wider[:, :-1] |= wide[:, 1:]
    return wider
