"""Measured and predicted torques of a log as series, for figures and for the page."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from paminsa_viz.identification.findings import Findings
from paminsa_viz.identification.results import Identification
from paminsa_viz.model.drive import TORQUE_UNITS
from paminsa_viz.palette import ACTUATOR_COLORS, INK
from paminsa_viz.plots.series import (
    Dash,
    EngineTorques,
    SeriesData,
    SeriesSources,
    Trace,
    Values,
)
from paminsa_viz.plots.series_builders import SYMBOLS, build_series
from paminsa_viz.plots.series_uplot import Chart
from paminsa_viz.trajectory import analyze
from paminsa_viz.units import display_unit


def log_series(findings: Findings) -> SeriesData:
    """Return measured and predicted torques of each actuator, and their difference.

    Of the first piece of the log without gaps; the analysis is that of the nearest design.
    """
    found, motion = findings.identification, findings.motion
    measured, predicted = found.measured[: motion.size], found.predicted[: motion.size]
    analysis = analyze(findings.nearest.design, motion)
    sources = SeriesSources(analysis, engine=EngineTorques("measured", measured))
    data = build_series("comparison", sources)
    panels = []
    for place, panel in enumerate(data.panels):
        j = place // 2
        if place % 2 == 0:
            own, other = panel.traces
            own = replace(own, label="predicted", values=predicted[:, j])
            panels.append(replace(panel, traces=(own, other)))
        else:
            residual = predicted[:, j] - measured[:, j]
            trace = replace(panel.traces[0], values=residual, peak=None)
            note = f"RMS {display_unit(TORQUE_UNITS[j]).format(float(np.std(residual)), 3)}"
            panels.append(replace(panel, traces=(trace,), notes=((note, INK),)))
    failing = np.zeros(motion.size, dtype=bool)
    return replace(
        data, title="Measured and predicted torques", panels=tuple(panels),
        failing=failing, until=motion.size,
    )  # fmt: skip


def log_charts(found: Identification, actuator: int) -> tuple[Chart, Chart]:
    """Return the charts of one actuator: measured and predicted torque, and the residual.

    Values that belong to other pieces of the log are apart by gaps.
    """
    t = found.signals.t
    gaps = np.flatnonzero(np.diff(found.signals.segment)) + 1
    unit, color = display_unit(TORQUE_UNITS[actuator]), ACTUATOR_COLORS[actuator]

    def curve(label: str, values: Values, line: str, dash: Dash, width: float) -> Trace:
        whole = np.insert(unit.factor * values[:, actuator], gaps, np.nan)
        return Trace(label, whole, line, dash, width)

    times = np.insert(t, gaps, t[gaps - 1] + 1e-9 if gaps.size else t[:0])
    failing = np.zeros(times.size, dtype=bool)
    name = f"{SYMBOLS[actuator]} [{unit.text}]"
    torque = (
        curve("measured", found.measured, color, "solid", 1.6),
        curve("predicted", found.predicted, INK, "dashed", 0.9),
    )
    rest = (curve("residual", found.residual, color, "solid", 0.9),)
    return (
        Chart(f"Measured, and predicted (dashed): {name}", unit.text, times, torque, failing),
        Chart(f"Residual: {name}", unit.text, times, rest, failing),
    )
