"""What is written at the pointer over maps: position and value, or why there is no value."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.model.reach import Limit
from paminsa_viz.plots.map_values import MapData
from paminsa_viz.units import MM, fixed, number

FONT = "DejaVu Sans, Verdana, Helvetica, Arial, sans-serif"

EVERYWHERE = (slice(None), slice(None))


def reasons(data: MapData, panel: int, cells: tuple[slice, slice] = EVERYWHERE) -> NDArray[np.str_]:
    """Return for each of some cells of a panel why it has no value, or an empty text.

    Args:
        data: The maps.
        panel: Index of one.
        cells: Which rows and columns of the grid.
    """
    status = data.status[cells]
    leg = np.full(status.shape, -1) if data.leg is None else data.leg[cells]
    texts = np.array([[limit.reason(leg) for leg in range(-1, 3)] for limit in Limit])
    found = texts[status, leg + 1]
    if data.missing is not None:
        code = data.missing.code[cells]
        found = np.where((status == 0) & (code != 0), np.array(data.missing.texts)[code], found)
    empty = (status != 0) | np.isnan(data.values[panel][cells])
    return np.where(empty, found, "")


def cell_at(data: MapData, x: float, y: float) -> tuple[int, int] | None:
    """Return row and column of the cell that holds a place [m], or None outside the maps."""
    left, right, bottom, top = data.extent
    if not (left <= x < right and bottom <= y < top):
        return None
    column = int((x - left) / (right - left) * data.x.size)
    return int((y - bottom) / (top - bottom) * data.y.size), column


class Readout(NamedTuple):
    """What a map says at a place.

    Attributes:
        text: The value with its name, or why there is none.
        cell: x and y of the middle of the cell it is of.
        pose: theta and z of the map.
    """

    text: str
    cell: str
    pose: str


def readout(data: MapData, panel: int, x: float, y: float) -> Readout | None:
    """Return what a map says at a place, or None outside it.

    Args:
        data: The maps.
        panel: Index of one.
        x, y: The place [m].
    """
    found = cell_at(data, x, y)
    if found is None:
        return None
    row, column = found
    text = str(reasons(data, panel, (slice(row, row + 1), slice(column, column + 1)))[0, 0])
    if not text:
        value = data.display.format(float(data.values[panel, row, column]))
        text = f"{data.names[panel]} = {value}"
    middle = [fixed(MM * float(axis), 1) for axis in (data.x[column], data.y[row])]
    return Readout(text, f"x = {middle[0]} mm, y = {middle[1]} mm", _pose(data))


def emptiness(data: MapData, panel: int) -> str:
    """Return why a panel shows no values, or an empty text if it shows some."""
    if not np.isnan(data.values[panel]).all():
        return ""
    if (data.status == 0).any():
        return "no value here"
    # Corners of the square are out of reach at every heading.
    singular = (data.status == Limit.SINGULAR).any()
    return "singular everywhere" if singular else "nothing reachable here"


def value_text(data: MapData, panel: int) -> str:
    """Return plotly's template for a cell with a value, which is its text."""
    quantity = f"{data.names[panel]} = %{{text}} {data.display.text}".rstrip()
    return f"<b>{quantity}</b>{_place(data)}"


def reason_text(data: MapData) -> str:
    """Return plotly's template for a cell without a value."""
    return f"<b>%{{text}}</b>{_place(data)}"


PLACE_FORMAT = ".1f"
"""Format of plotly's axes for the place: one within a template would write no minus sign."""


def _place(data: MapData) -> str:
    return f"<br>x = %{{x}} mm, y = %{{y}} mm<br>{_pose(data)}<extra></extra>"


def _pose(data: MapData) -> str:
    return f"θ = {number(np.degrees(data.theta))}°, z = {number(MM * data.z)} mm"


def axis_number(index: int) -> str:
    """Return how plotly numbers the axes of a panel: nothing for the first, then 2, 3."""
    return "" if index == 0 else str(index + 1)
