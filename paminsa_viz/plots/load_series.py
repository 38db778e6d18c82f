"""Series of joint forces and bar loads along a motion."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from paminsa_viz.elastostatics.joint_forces import JOINT_INDEX, JOINTS
from paminsa_viz.elastostatics.motion_loads import motion_loads
from paminsa_viz.palette import INK, LEG_COLORS
from paminsa_viz.plots.series import SeriesPanel, SeriesSources, Trace, Values
from paminsa_viz.units import format_value

PERCENT = 100.0

PLOTTED = ("2", "4", "guide", "5")
"""Joints that are plotted, by their keys."""


def load_panels(sources: SeriesSources) -> Iterator[SeriesPanel]:
    """Yield the forces at joints of every leg, and the largest bending moment and utilization."""
    analysis = sources.analysis
    found = motion_loads(analysis)
    time = analysis.trajectory.t

    def traces(values: Values | None) -> tuple[Trace, ...]:
        drawn = np.full((time.size, 3), np.nan)
        if found is not None and values is not None:
            drawn[np.searchsorted(time, found.trajectory.t)] = values
        made = []
        for leg, color in enumerate(LEG_COLORS):
            column = drawn[:, leg]
            peak = None
            if np.isfinite(column).any():
                top = int(np.nanargmax(column))
                peak = (float(time[top]), float(column[top]))
            made.append(
                Trace(f"leg {leg + 1}", column, color, peak=peak, until=analysis.check.until)
            )
        return tuple(made)

    def panel(name: str, symbol: str, unit: str, values: Values | None) -> SeriesPanel:
        drawn = traces(values)
        notes = tuple(
            (f"peak {format_value(trace.peak[1], unit, 3)}", trace.color)
            for trace in drawn
            if trace.peak is not None
        )
        return SeriesPanel(name, name, symbol, unit, INK, drawn, notes)

    for key in PLOTTED:
        index = JOINT_INDEX[key]
        label = JOINTS[index].label
        name = f"Force at joint {label}" if key.isdigit() else f"Force at the {label}"
        values = None if found is None else found.magnitude[:, :, index]
        yield panel(name, f"F {label}", "N", values)
    bending = None if found is None else np.abs(found.bars[..., 2]).max(axis=-1)
    yield panel("Largest bending moment", "max M", "N m", bending)
    share = None if found is None else PERCENT * found.utilization.max(axis=-1)
    yield panel("Utilization of the bars", "σ/R_p", "%", share)
