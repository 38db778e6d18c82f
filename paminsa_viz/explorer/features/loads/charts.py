"""Charts of the tab Loads: N, V and M along a bar, and a joint's force along the motion."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from paminsa_viz.elastostatics.bar_loads import COMPONENTS, bar_loads
from paminsa_viz.elastostatics.joint_forces import JOINT_INDEX, JOINTS
from paminsa_viz.elastostatics.motion_loads import MotionLoads
from paminsa_viz.explorer.features.loads.solving import Instant, forces_at, found, instant
from paminsa_viz.explorer.kit.chart import LAYOUT, NUMBERS, Tree, figure
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model import Limit
from paminsa_viz.palette import LEG_COLORS
from paminsa_viz.plots.series import thinned
from paminsa_viz.units import MM, number

PER_PIECE = 16
"""Points drawn between two forces on a bar."""

MOST_POINTS = 400
"""About how many samples of a motion are drawn."""

UNITS = ("N", "N", "N·m")


def shown_section(state: State) -> tuple[Instant, str, int] | None:
    """Return what the chart of the bar shows, or None where there are no forces."""
    at = instant(state)
    known = state.document.pose == at.pose and forces_at(at).status == Limit.OK
    return (at, state.loads.settings.bar, state.loads.settings.leg) if known else None


def section_figure(at: Instant, bar: str, leg: int) -> Tree:
    """Return the figure of N, V and M along a bar of a leg, one above the other."""
    loads = bar_loads(forces_at(at), bar)
    # both sides of every point load are drawn, so that a jump is upright
    s = np.concatenate(
        [
            np.linspace(a, max(a, np.nextafter(b, a)), PER_PIECE)
            for a, b in pairwise(loads.places[leg].tolist())
        ]
    )
    data: list[Tree] = [
        {
            "type": "scatter", "mode": "lines", "x": (MM * s).tolist(), "y": values.tolist(),
            "yaxis": f"y{axis}", "fill": "tozeroy", "fillcolor": f"{LEG_COLORS[leg]}22",
            "line": {"color": LEG_COLORS[leg], "width": 1.5},
            "hovertemplate": f"{name} = %{{customdata}} {unit}<extra></extra>",
            "customdata": [number(value, 3) for value in values.tolist()],
        }
        for axis, name, unit, values in zip(
            NUMBERS, COMPONENTS, UNITS, loads.at(s)[leg].T, strict=True
        )
    ]  # fmt: skip
    titles = [f"{name} [{unit}]" for name, unit in zip(COMPONENTS, UNITS, strict=True)]
    return figure(
        data, f"s along {bar.upper()} of leg {leg + 1} [mm]", *titles, showlegend=False
    )  # fmt: skip


def shown_curves(state: State) -> tuple[MotionLoads, str] | None:
    """Return what the chart along the motion shows, or None."""
    loads = found(state)
    return None if loads is None else (loads, state.loads.settings.joint)


def curves_figure(loads: MotionLoads, joint: str) -> Tree:
    """Return the figure of a joint's force along the motion, of every leg."""
    index = JOINT_INDEX[joint]
    force, t = loads.magnitude[:, :, index], loads.trajectory.t
    kept = thinned(list(force.T), MOST_POINTS)
    data: list[Tree] = [
        {
            "type": "scatter", "mode": "lines", "name": f"leg {leg + 1}", "x": t[kept].tolist(),
            "y": force[kept, leg].tolist(), "line": {"color": color, "width": 1.5},
            "hovertemplate": "%{y:.3~r} N at %{x:.3~f} s",
        }
        for leg, color in enumerate(LEG_COLORS)
    ]  # fmt: skip
    shown = figure(
        data, "t [s]", f"F at {JOINTS[index].name} [N]", legend=LAYOUT["legend"] | {"y": 0}
    )
    shown["layout"]["yaxis"]["rangemode"] = "tozero"
    return shown
