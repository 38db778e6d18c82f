"""The motion in the scene: its path, and where the robot should be while a simulation is shown.

The path has the color of what an actuator has to give, and is red where the motion fails.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from paminsa_viz.dimensions.layout import layout
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.core.motion_results import in_piece, split_path
from paminsa_viz.explorer.core.simulated import wanted_pose
from paminsa_viz.explorer.scene.curves import linear_colors, segments
from paminsa_viz.explorer.scene.ghost import Ghost
from paminsa_viz.explorer.scene.hues import ForceScale, drawn_hues, hue
from paminsa_viz.explorer.scene.nodes import Node, curves, lines
from paminsa_viz.kept import kept
from paminsa_viz.model import Design
from paminsa_viz.model.kinematics import Configuration, inverse_kinematics
from paminsa_viz.palette import INK, MUTED
from paminsa_viz.trajectory import TrajectoryAnalysis

WIDTH: Final = 5.0
DASH: Final = 0.008
"""Length of a dash where the motion fails [m]."""
ABOVE: Final = 0.0045
"""Height of the path's shadow over the ground, above the map and below the mark [m].

Both are beside the prototype's bodies."""


def path_scale(analysis: TrajectoryAnalysis, actuator: int) -> ForceScale:
    """Return the range of an actuator's torque or force in size, from 0 for torques."""
    size = np.abs(analysis.torque[:, actuator])
    size = size[np.isfinite(size)]
    if size.size == 0:
        return ForceScale(0.0, 1.0)
    low = float(size.min()) if actuator == 3 else 0.0
    return ForceScale(low, max(float(size.max()), low + 1e-9))


def motion_path(frame: Frame) -> tuple[Node, ...]:
    """Draw the layer ``path``, in space and as a line on the ground below it."""
    state = frame.state
    if frame.analysis is None:
        return ()
    geometry = state.last_reachable.geometry
    size = geometry.body_scale
    height, bad = layout(geometry).ground + size * ABOVE, state.theme.bad_fill
    return _drawn(frame.analysis, state.plots.color, height, state.playback.piece, size, bad)


@kept(4)
def _drawn(
    analysis: TrajectoryAnalysis,
    actuator: int,
    height: float,
    piece: tuple[float, float] | None,
    size: float,
    bad_color: str,
) -> tuple[Node, ...]:
    found = split_path(analysis)
    torque = analysis.torque[found.samples, actuator]
    good = [segments(found.place[run]) for run in found.good]
    values = [np.stack([torque[run][:-1], torque[run][1:]], axis=1) for run in found.good]
    places = hue(np.concatenate([np.zeros((0, 2)), *values]), path_scale(analysis, actuator))
    way = np.concatenate([np.zeros((0, 2, 3)), *good])
    colors = drawn_hues()[places]
    inside = in_piece(analysis.trajectory.t[found.samples], piece)
    shown = [inside[run][:-1] & inside[run][1:] for run in found.good]
    colors[~np.concatenate([np.zeros(0, bool), *shown])] = linear_colors(MUTED)[0]
    bad = [found.place[run] for run in found.bad]
    return (
        lines("/path/way", way, colors, WIDTH),
        curves("/path/failing", bad, bad_color, WIDTH, dash=size * DASH),
        curves("/path/below", [found.place[:, :2]], INK, height=height),
    )


class WantedPose(Ghost):
    """The layer ``wanted_pose``: where the robot should be, while a simulation is shown."""

    root = "/wanted"

    def seen(self, frame: Frame) -> tuple[Design, Configuration] | None:
        state, design = frame.state, frame.shown_design
        pose = wanted_pose(state) if "wanted_pose" in state.layers else None
        return None if pose is None else (design, inverse_kinematics(design.geometry, pose))
