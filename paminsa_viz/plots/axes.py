"""What the axes and color bars of a figure say, the same on screen and in print."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.model.reach import Limit
from paminsa_viz.plots import ticks
from paminsa_viz.plots.maps import MapData
from paminsa_viz.plots.scale import Scale
from paminsa_viz.units import MM, number

MARKER_FILL = "#ffffff"
GRID_TEXT = "#3b4754"


@dataclass(frozen=True)
class Mark:
    """A tick: where it is, from 0 to 1 along the axis, what it says, and its value.

    The value is in mm on an axis, and in the unit of the data on a color bar.
    """

    where: float
    words: str
    value: float


def length_marks(
    low: float, high: float, length: float, width_of: Callable[[str], float], overhang: float
) -> tuple[Mark, ...]:
    """Return marks in mm for an axis from ``low`` to ``high`` [m].

    Args:
        low: Start of the axis [m].
        high: End of the axis [m].
        length: Drawn length, in the unit of ``width_of``.
        width_of: How much room a label takes along the axis.
        overhang: How far a label may reach beyond the ends.
    """
    low, high = low * MM, high * MM
    for count in range(9, 0, -1):
        step = ticks.nice_step(high - low, count)
        values = ticks.multiples(low, high, step)
        marks = [Mark((v - low) / (high - low), number(v), v) for v in values]
        marks = [
            m
            for m in marks
            if min(m.where, 1 - m.where) * length + overhang >= width_of(m.words) / 2
        ]
        if _have_room(marks, length, width_of, 0.6 * width_of("0")):
            return tuple(marks)
    return ()


def bar_marks(
    factor: float, scale: Scale, length: float, width_of: Callable[[str], float]
) -> tuple[Mark, ...]:
    """Return the marks of a color bar, as many as have room; ``factor`` leads to shown values."""
    marks: tuple[Mark, ...] = ()
    for count in (8, 6, 5, 4, 3, 2, 1):
        values = scale.ticks(count)
        where = scale.position(np.array(values))
        marks = tuple(
            Mark(float(p), number(v * factor), v) for p, v in zip(where, values, strict=True)
        )
        if _have_room(marks, length, width_of, 0.5 * width_of("0")):
            break
    return marks


def _have_room(
    marks: Sequence[Mark], length: float, width_of: Callable[[str], float], between: float
) -> bool:
    """Return whether no two neighbors are closer than ``between``."""
    for a, b in pairwise(marks):
        half_widths = (width_of(a.words) + width_of(b.words)) / 2
        if (b.where - a.where) * length - half_widths < between:
            return False
    return True


def axis_label(axis: str) -> str:
    """Return the label of the x or y axis."""
    return f"{axis} [mm]"


def unit_label(unit: str) -> str:
    """Return a shown unit in brackets, or nothing for pure numbers."""
    return f"[{unit}]" if unit else ""


def emptiness(data: MapData, panel: int) -> str:
    """Return why a panel shows no values, or an empty string if it shows some."""
    if not np.isnan(data.values[panel]).all():
        return ""
    if (data.status == Limit.SINGULAR).any() and not (
        (data.status != 0) & (data.status != Limit.SINGULAR)
    ).any():
        return "singular everywhere"
    return "no value here" if (data.status == 0).any() else "nothing reachable here"


def reasons(data: MapData) -> NDArray[np.str_]:
    """Return for every cell (ny, nx) why it has no value, in words for people."""
    table = np.array([[reason(limit, leg) for leg in range(-1, 3)] for limit in Limit])
    leg = np.full(data.status.shape, -1) if data.leg is None else data.leg
    return table[data.status, leg + 1]


def reason(limit: Limit, leg: int) -> str:
    """Return why there is no value, in words; ``leg`` is its index, -1 for none."""
    return _REASONS[limit].format(who=_WHO[leg + 1])


_WHO = ("a leg", "leg 1", "leg 2", "leg 3")

_REASONS = {
    Limit.OK: "not defined",
    Limit.NOT_FINITE: "not finite",
    Limit.STRETCHED: "{who} over-stretched",
    Limit.FOLDED: "{who} folded too far",
    Limit.GUIDE: "{who} at the end of its guide",
    Limit.AXIS: "{who} on its axis",
    Limit.SINGULAR: "singular",
}
