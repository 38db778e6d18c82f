"""Charts of the tab Loads: N, V and M along a bar, and a joint's force along the motion."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from itertools import pairwise

import numpy as np

from paminsa_viz.elastostatics.bar_diagram import COMPONENTS
from paminsa_viz.elastostatics.bar_loads import bar_loads
from paminsa_viz.elastostatics.joint_forces import JOINT_INDEX, JOINTS
from paminsa_viz.elastostatics.motion_loads import MotionLoads
from paminsa_viz.explorer.loads import Instant, forces_at, instant
from paminsa_viz.explorer.motion.results import MotionStore
from paminsa_viz.explorer.panels.line_chart import Axes, Line, line_chart
from paminsa_viz.explorer.state import State
from paminsa_viz.palette import LEG_COLORS
from paminsa_viz.units import MM

PER_PIECE = 16
"""Points drawn between two forces on a bar."""

MOST_POINTS = 400
"""About how many samples of a motion are drawn."""

UNITS = ("N", "N", "N·m")


def shown(state: State, motions: MotionStore) -> Instant:
    """Return the instant that the robot shows: of the motion that is played, or at rest."""
    here, design = state.last_reachable, state.document.design
    if here.geometry != design.geometry:
        design = replace(design, geometry=here.geometry)
    analysis = motions.analysis(state) if state.playback.following else None
    return instant(design, np.array(here.pose), analysis, state.playback.time)


@lru_cache(maxsize=4)
def section_chart(at: Instant, bar: str, leg: int) -> str:
    """Return N, V and M along a bar of a leg, one above the other."""
    loads = bar_loads(forces_at(at), bar)
    places = loads.places[leg].tolist()
    # both sides of every point load are drawn, so that a jump is upright
    s = np.concatenate(
        [np.linspace(a, max(a, np.nextafter(b, a)), PER_PIECE) for a, b in pairwise(places)]
    )
    values = loads.at(s)[leg]
    axes = [
        Axes(f"{name} [{unit}]", [Line(values[:, i], LEG_COLORS[leg])], fill=True)
        for i, (name, unit) in enumerate(zip(COMPONENTS, UNITS, strict=True))
    ]
    label = f"s along {bar.upper()} of leg {leg + 1} [mm]"
    return line_chart("loads-sections", s * MM, axes, label, height=64.0)


@lru_cache(maxsize=4)
def motion_chart(loads: MotionLoads, joint: str) -> str:
    """Return a joint's force along a motion, of every leg."""
    t, index = loads.trajectory.t, JOINT_INDEX[joint]
    kept = np.unique(np.linspace(0, len(t) - 1, min(len(t), MOST_POINTS)).round().astype(int))
    lines = [
        Line(loads.magnitude[kept, leg, index], LEG_COLORS[leg], f"leg {leg + 1}")
        for leg in range(3)
    ]
    axes = [Axes(f"F {JOINTS[index].label} [N]", lines)]
    return line_chart("loads-curves", t[kept], axes, "t [s]", height=150.0)
