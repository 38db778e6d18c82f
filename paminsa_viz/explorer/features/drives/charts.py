"""The chart of a drive: the motions' torques over the motor's speeds, inside its envelope."""

from __future__ import annotations

import math

import numpy as np

from paminsa_viz.actuation.duty import DutyCycle
from paminsa_viz.actuation.selection import DriveFigures, cloud
from paminsa_viz.explorer.kit.chart import Tree, figure
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model.drive import ACTUATORS
from paminsa_viz.palette import ACTUATOR_COLORS, INK, MUTED

MOST_POINTS = 600
"""About how many samples of a motion are drawn."""

RPM = 30 / math.pi


def shown_drive(state: State) -> tuple[DriveFigures, DutyCycle, int, tuple[int, ...]] | None:
    """Return what the chart shows: a drive, its cycle, its actuator, and all with such a drive."""
    drives = state.drives
    if drives.shown is None or drives.result is None:
        return None
    actuator = drives.actuator
    return drives.shown, drives.result.selection.cycle, actuator, drives.shared(actuator)


def chart_figure(
    one: DriveFigures, cycle: DutyCycle, actuator: int, shared: tuple[int, ...]
) -> Tree:
    """Return the figure of a drive's torques over its speeds, inside its envelope."""
    drive = one.drive
    clouds = [cloud(cycle.loads[j], drive) for j in shared]
    top = max(1.25 * max(float(np.abs(speed).max()) for speed, _ in clouds), 1e-6)
    corners = [(min(s, top) if math.isinf(s) else s, t) for s, t in drive.corners]
    corners = [(s, t) for s, t in corners if math.isfinite(t)]
    around = [*corners, *[(s, -t) for s, t in reversed(corners)]]
    around += [(-s, -t) for s, t in corners] + [(-s, t) for s, t in reversed(corners)]
    hover = "%{x:.0f} rpm, %{y:.3~g} N·m<extra></extra>"
    data: list[Tree] = []
    if corners:
        data.append(
            {
                "type": "scatter", "mode": "lines", "name": "envelope", "fill": "toself",
                "x": [s * RPM for s, _ in around], "y": [t for _, t in around],
                "line": {"color": MUTED, "width": 1.5}, "fillcolor": "rgba(120,130,140,0.10)",
                "hoverinfo": "skip",
            }
        )  # fmt: skip
    if drive.rated_torque is not None and drive.rated_speed is not None:
        s, t = drive.rated_speed * RPM, drive.rated_torque
        data.append(
            {
                "type": "scatter", "mode": "lines", "name": "rated",
                "x": [s, s, -s, -s, s], "y": [-t, t, t, -t, -t],
                "line": {"color": MUTED, "width": 1, "dash": "dash"}, "hoverinfo": "skip",
            }
        )  # fmt: skip
    for j, (speed, torque) in zip(shared, clouds, strict=True):
        kept = np.linspace(0, len(speed) - 1, min(len(speed), MOST_POINTS)).round().astype(int)
        color = ACTUATOR_COLORS[j]
        data.append(
            {
                "type": "scatter", "mode": "lines+markers", "name": ACTUATORS[j],
                "x": (RPM * speed[kept]).tolist(), "y": torque[kept].tolist(),
                "line": {"color": color, "width": 1}, "marker": {"color": color, "size": 3},
                "hovertemplate": hover,
            }
        )  # fmt: skip
    mean = RPM * drive.ratio * cycle.loads[actuator].mean_speed
    data.append(
        {
            "type": "scatter", "mode": "markers", "name": f"RMS {ACTUATORS[actuator]}",
            "x": [mean], "y": [one.rms],
            "marker": {"color": INK, "size": 10, "symbol": "x"}, "hovertemplate": hover,
        }
    )  # fmt: skip
    legend = {"orientation": "h", "x": 0, "y": 1.02, "yanchor": "bottom"}
    return figure(data, "motor speed [rpm]", "motor torque [N·m]", legend=legend)
