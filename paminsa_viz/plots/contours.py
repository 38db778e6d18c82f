"""Lines on a map: contours, the boundary of the workspace, the singular circle.

A line is an array (n, 2) of x and y [m]; a point that is not finite separates two pieces, as
matplotlib and plotly have it.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from contourpy import FillType, LineType, contour_generator
from numpy.typing import NDArray

from paminsa_viz.model.reach import Limit
from paminsa_viz.plots.map_values import MapData
from paminsa_viz.plots.scale import Scale

Line = NDArray[np.float64]

NO_LINE: Line = np.empty((0, 2))


class FloorPath(NamedTuple):
    """A motion seen from above: lines that the robot can follow, and that it cannot [m]."""

    good: Line
    bad: Line


LABELS = 2
"""Most numbers for one contour level."""


def contour_lines(
    data: MapData, panel: int, scale: Scale, most: int | None = None
) -> dict[float, Line]:
    """Return the contour lines of one panel by level; levels without a line are left out.

    Args:
        data: The maps.
        panel: Index of the panel.
        scale: Its scale, which knows the levels.
        most: About how many points along an axis to use at most, for quick drawings; None for all.
    """
    stride = 1 if most is None else max(1, min(data.x.size, data.y.size) // most)
    x, y, field = contour_field(data, panel, scale, stride)
    shown = field[np.isfinite(field)]
    if shown.size == 0 or min(field.shape) < 2:
        return {}
    low, high = float(shown.min()), float(shown.max())
    generator = _generator(x, y, field)
    found = ((level, _lines(generator, level)) for level in scale.levels if low <= level <= high)
    return {level: line for level, line in found if line.size}


def contour_field(
    data: MapData, panel: int, scale: Scale, stride: int = 1
) -> tuple[Line, Line, NDArray[np.float64]]:
    """Return x, y [m] and the values (ny, nx) of one panel to contour, NaN where they are hidden.

    Torques change sign through infinity on the singular circle, where every contour would seem to
    run; cells next to the circle that lie beyond the range are therefore hidden. For the same
    reason cells beyond one end of the range are hidden next to cells beyond the other end.
    """
    x, y = data.x[::stride], data.y[::stride]
    values = data.values[panel, ::stride, ::stride]
    with np.errstate(invalid="ignore"):
        beyond = (values < scale.low) | (values > scale.high)
        hidden = ~np.isfinite(values) | _torn(values, scale)
    if x.size > 1 and y.size > 1:
        hidden |= beyond & _near_circle(x, y, data.singular_radius)
    return x, y, np.where(hidden, np.nan, values)


def boundary(data: MapData) -> Line:
    """Return the boundary of the workspace: where the margin is zero, or along the cells."""
    field, level = _reached(data)
    return _lines(_generator(data.x, data.y, field), level)


def reached_area(data: MapData) -> tuple[Line, NDArray[np.uint8]] | None:
    """Return the area within `boundary` as points (n, 2) [m] and codes of matplotlib's ``Path``."""
    field, level = _reached(data)
    chunks: Any = _generator(data.x, data.y, field).filled(level, np.inf)
    points, codes = chunks[0][0], chunks[1][0]
    return None if points is None else (points, codes)


def singular_circle(data: MapData) -> Line:
    """Return the singular circle about the origin where the map shows it, possibly nothing."""
    radius = data.singular_radius
    if not radius:
        return NO_LINE
    left, right, bottom, top = data.extent
    circle = _circle(radius, 181)
    x, y = circle.T
    inside = (x >= left) & (x <= right) & (y >= bottom) & (y <= top)
    return np.where(inside[:, None], circle, np.nan) if inside.any() else NO_LINE


def label_places(
    data: MapData, found: dict[float, Line], room: dict[float, float], margin: float
) -> list[tuple[float, float]]:
    """Choose places for the numbers of contour lines, clear of other lines and of the pose.

    Args:
        data: The maps, whose boundary, singular circle and pose are kept clear.
        found: Lines by level, as `contour_lines` gives them.
        room: How far from the middle of each level's number other lines have to be [m].
        margin: Distance between a number and anything else [m].

    Returns:
        Points (x, y) on the lines [m], at most `LABELS` a level.
    """
    from scipy.spatial import KDTree  # late: a page that starts and tables of maps have no numbers

    taken = [boundary(data), singular_circle(data), data.pose[None, :2]]
    places: list[tuple[float, float]] = []
    for level in sorted(found, key=abs):
        others = [line for other, line in found.items() if other != level]
        longest = sorted(pieces(found[level]), key=len, reverse=True)
        for line in longest[:LABELS]:
            reach = max(len(line) // 8, 2)  # ends of a line are no place for a number
            points = line[reach:-reach]
            obstacles = np.concatenate([*taken, *others])
            tree = KDTree(obstacles[np.isfinite(obstacles).all(axis=1)])
            if not len(points):
                continue
            clear, _ = tree.query(points)
            best = int(np.argmax(clear))
            if clear[best] > room[level] + margin:
                x, y = points[best]
                places.append((float(x), float(y)))
                taken.append(_circle(room[level] + margin, 12) + points[best])
    return places


def _circle(radius: float, points: int) -> Line:
    angle = np.linspace(0.0, 2 * np.pi, points)
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def pieces(line: Line) -> list[Line]:
    """Return the pieces of a line that have at least two points."""
    finite = np.isfinite(line).all(axis=1)
    parts = np.split(line, np.flatnonzero(np.diff(finite.astype(np.int8))) + 1)
    return [part for part in parts if len(part) > 1 and np.isfinite(part[0, 0])]


def joined(lines: list[Line]) -> Line:
    """Return several lines as one."""
    gap = np.full((1, 2), np.nan)
    return np.concatenate([part for line in lines for part in (line, gap)]) if lines else NO_LINE


def _generator(x: Line, y: Line, field: Any) -> Any:
    return contour_generator(
        x, y, field, name="serial", line_type=LineType.ChunkCombinedNan,
        fill_type=FillType.ChunkCombinedCode,
    )  # fmt: skip


def _lines(generator: Any, level: float) -> Line:
    found = generator.lines(level)[0][0]
    return NO_LINE if found is None else found


def _reached(data: MapData) -> tuple[NDArray[np.float64], float]:
    if data.margin is not None and np.isfinite(data.margin).any():
        return np.ma.masked_invalid(data.margin), 0.0
    # Singular cells lie inside the workspace; they are no boundary.
    reached = (data.status == Limit.OK) | (data.status == Limit.SINGULAR)
    return reached.astype(np.float64), 0.5


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
    """Return the cells of a mask and their eight neighbors."""
    wide = mask.copy()
    wide[1:] |= mask[:-1]
    wide[:-1] |= mask[1:]
    wider = wide.copy()
    wider[:, 1:] |= wide[:, :-1]
    wider[:, :-1] |= wide[:, 1:]
    return wider
