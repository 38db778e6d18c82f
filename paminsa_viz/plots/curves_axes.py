"""Numbers on the axes of figures over time."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.plots import ticks
from paminsa_viz.plots.axes import Mark
from paminsa_viz.plots.curves_data import Panel
from paminsa_viz.plots.lettering import TextMetrics
from paminsa_viz.units import number, power_of_ten

_ROUNDING = 1e-9
"""Share of a value's size below which its changes are rounding errors."""

_PADDING = 0.07
"""Room above and below the curves, as a share of their range."""


@dataclass(frozen=True)
class Scale:
    """The value axis of a panel, in shown units divided by a power of ten.

    Attributes:
        factor: From stored values to those on the axis.
        low: Lower end.
        high: Upper end.
        marks: Its ticks.
        label: What it says, with the unit.
    """

    factor: float
    low: float
    high: float
    marks: tuple[Mark, ...]
    label: str


def value_scale(panel: Panel, parts: int = 6) -> Scale:
    """Return the value axis that shows all of a panel's curves, marks and levels.

    Values below 0.01 or from 100 000 on are given as multiples of a power of ten. Where nothing
    changes but by rounding errors, the axis is wide enough not to show those. Without any value
    there are no numbers.
    """
    factor, unit = panel.display
    known = np.concatenate(
        [
            *(trace.values[np.isfinite(trace.values)] for trace in panel.traces),
            [level.value for level in panel.levels],
        ]
    )
    if not known.size:
        return Scale(factor, 0.0, 1.0, (), panel.label)
    low, high = float(known.min()), float(known.max())
    low, high = low * factor, high * factor
    largest = max(abs(low), abs(high))
    power = 0
    if largest > 0 and not 1e-2 <= largest < 1e5:
        power = 3 * math.floor(math.log10(largest) / 3)
    low, high, largest = (v / 10.0**power for v in (low, high, largest))
    if high - low <= _ROUNDING * largest or largest == 0:
        half = 0.1 * largest if largest else 1.0
        low, high = low - half, high + half
    room = _PADDING * (high - low)
    low, high = low - room, high + room
    step = ticks.nice_step(high - low, parts)
    marks = tuple(
        Mark((v - low) / (high - low), number(v, 6), v) for v in ticks.multiples(low, high, step)
    )
    label = panel.label if not power else f"{panel.symbol} [{power_of_ten(power)} {unit}]"
    return Scale(factor / 10.0**power, low, high, marks, label)


def time_marks(time: NDArray[np.float64], length: float, letters: TextMetrics) -> tuple[Mark, ...]:
    """Return the ticks of a time axis ``length`` mm long."""
    begin, end = float(time[0]), float(time[-1])
    for count in range(10, 0, -1):
        step = ticks.nice_step(end - begin, count)
        marks = tuple(
            Mark((v - begin) / (end - begin), number(v), v)
            for v in ticks.multiples(begin, end, step)
        )
        widest = max((letters.width(mark.words) for mark in marks), default=0.0)
        if step / (end - begin) * length > 1.6 * widest:
            return marks
    return ()
