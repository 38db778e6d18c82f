"""Numbers beside the curves: the value at the time cursor, the largest one, the RMS."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from paminsa_viz.explorer.motion.traces import Chart, Trace
from paminsa_viz.trajectory.integrals import rms


@dataclass(frozen=True)
class Reading:
    """What a table says of one curve, in the chart's unit.

    Attributes:
        trace: The curve.
        unit: Its unit.
        peak: Its value of largest size, before the motion fails; NaN if it fails at once.
        peak_t: When [s].
        rms: Root mean square over time, until there.
    """

    trace: Trace
    unit: str
    peak: float
    peak_t: float
    rms: float


def readings(chart: Chart) -> tuple[Reading, ...]:
    """Return the numbers of every curve of a chart; marks are no curves."""
    return tuple(_reading(chart, trace) for trace in chart.traces if not trace.marks)


def _reading(chart: Chart, trace: Trace) -> Reading:
    # A reference may fail where the present design does not.
    known = np.isnan(trace.values[: chart.until])
    until = int(known.argmax()) if known.any() else chart.until
    if until == 0:
        return Reading(trace, chart.unit, np.nan, np.nan, np.nan)
    t, values = chart.t[:until], trace.values[:until]
    index = int(np.abs(values).argmax())
    mean = float(rms(t, values[:, None])[0])
    return Reading(trace, chart.unit, float(values[index]), float(t[index]), mean)


def value_at(chart: Chart, trace: Trace, time: float) -> float:
    """Return a curve at a time [s], by the line between samples; NaN where there is none."""
    if not chart.t[0] <= time <= chart.t[-1]:
        return float("nan")
    right = int(np.searchsorted(chart.t, time))
    if chart.t[right] == time:
        return float(trace.values[right])
    left = right - 1
    share = (time - chart.t[left]) / (chart.t[right] - chart.t[left])
    return float((1 - share) * trace.values[left] + share * trace.values[right])
