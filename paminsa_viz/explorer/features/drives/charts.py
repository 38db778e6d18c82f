"""The chart of a drive: the motions' torques over the motor's speeds, inside its envelope."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.actuation.duty import ActuatorLoad, DutyCycle
from paminsa_viz.actuation.selection import DriveFigures, cloud
from paminsa_viz.blocks.drives import RPM
from paminsa_viz.explorer.core.motion_results import in_piece
from paminsa_viz.explorer.core.planning import planned
from paminsa_viz.explorer.kit.chart import LEGEND_ABOVE, Tree, figure
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.drive import ACTUATORS
from paminsa_viz.palette import ACTUATOR_COLORS, INK, MUTED

MOST_POINTS = 600
"""About how many samples of a motion are drawn."""

HOVER = "%{x:.0f} rpm, %{y:.3~r} N·m<extra></extra>"


class Plotted(NamedTuple):
    """What the motion plots show of a cycle's motions.

    Attributes:
        motions: Which motions of the cycle are the one that is plotted.
        origin: Its time where they begin [s].
        slower: Factor that the cycle stretches its time by.
        piece: The piece of its time that is shown (from, to) [s], None for all of it.
    """

    motions: tuple[int, ...]
    origin: float
    slower: float
    piece: tuple[float, float] | None

    def times(self, load: ActuatorLoad) -> Array:
        """Return the plotted motion's time of all samples of a load, NaN of others (n,) [s]."""
        return np.concatenate(
            [
                self.origin + passage.t / self.slower
                if i in self.motions
                else np.full(passage.t.shape, np.nan)
                for i, passage in enumerate(load.passages)
            ]
        )


Shown = tuple[DriveFigures, DutyCycle, int, tuple[int, ...], Plotted | None]


def shown_drive(state: State) -> Shown | None:
    """Return what the chart shows: drive, cycle, actuator, all with such a drive, what is plotted.

    The last is None if the motion that is plotted is not in the cycle.
    """
    drives = state.drives
    if drives.shown is None or drives.result is None:
        return None
    actuator, cycle = drives.actuator, drives.result.selection.cycle
    return drives.shown, cycle, actuator, drives.shared(actuator), _plotted(state, cycle)


def _plotted(state: State, cycle: DutyCycle) -> Plotted | None:
    motion = planned(state.document.motion, state.document.design).trajectory
    own = tuple(i for i, duty in enumerate(cycle.duties) if duty.trajectory is motion)
    if motion is None or not own:
        return None
    return Plotted(own, float(motion.t[0]), cycle.slower, state.playback.piece)


def _some(count: int) -> NDArray[np.intp]:
    """Return the indices of about `MOST_POINTS` samples, evenly spread."""
    return np.linspace(0, count - 1, min(count, MOST_POINTS)).round().astype(np.intp)


def _cloud(actuator: int, samples: Array, piece: tuple[float, float] | None) -> list[Tree]:
    """Return the traces of an actuator: all samples, and those of a piece of time.

    The page marks where the robot is at a sample's time.

    Args:
        actuator: Its index.
        samples: Speed [rpm], torque [N m] and time [s] of samples, (3, n).
        piece: The piece of time (from, to) [s].
    """
    color, name = ACTUATOR_COLORS[actuator], ACTUATORS[actuator]

    def trace(which: NDArray[np.intp], **more: Any) -> Tree:
        x, y, times = samples[:, which]
        return {
            "type": "scatter", "mode": "lines+markers", "name": name,
            "x": x.tolist(), "y": y.tolist(),
            "customdata": [None if np.isnan(t) else float(t) for t in times],
            "line": {"color": color, "width": 1}, "marker": {"color": color, "size": 3},
            "hovertemplate": HOVER,
        } | more  # fmt: skip

    everything = _some(samples.shape[1])
    if piece is None:
        return [trace(everything)]
    inside = np.flatnonzero(in_piece(samples[2], piece))
    more = {"name": f"{name}, plotted", "mode": "markers", "marker": {"color": color, "size": 5}}
    return [trace(everything, opacity=0.3), trace(inside[_some(inside.size)], **more)]


def chart_figure(
    one: DriveFigures,
    cycle: DutyCycle,
    actuator: int,
    shared: tuple[int, ...],
    plotted: Plotted | None = None,
) -> Tree:
    """Return the figure of a drive's torques over its speeds, inside its envelope."""
    drive = one.drive
    clouds = [cloud(cycle.loads[j], drive) for j in shared]
    top = max(1.25 * max(float(np.abs(speed).max()) for speed, _ in clouds), 1e-6)
    corners = [(min(s, top) if math.isinf(s) else s, t) for s, t in drive.corners]
    corners = [(s, t) for s, t in corners if math.isfinite(t)]
    around = [*corners, *[(s, -t) for s, t in reversed(corners)]]
    around += [(-s, -t) for s, t in corners] + [(-s, t) for s, t in reversed(corners)]
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
        times = np.full(len(speed), np.nan) if plotted is None else plotted.times(cycle.loads[j])
        samples = np.stack([RPM * speed, torque, times])
        data += _cloud(j, samples, None if plotted is None else plotted.piece)
    mean = RPM * drive.ratio * cycle.loads[actuator].mean_speed
    data.append(
        {
            "type": "scatter", "mode": "markers", "name": f"RMS {ACTUATORS[actuator]}",
            "x": [mean], "y": [one.rms],
            "marker": {"color": INK, "size": 10, "symbol": "x"}, "hovertemplate": HOVER,
        }
    )  # fmt: skip
    return figure(data, "motor speed [rpm]", "motor torque [N·m]", legend=LEGEND_ABOVE)
