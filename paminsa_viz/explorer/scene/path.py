"""The motion's path: colored by what an actuator has to give, red where the motion fails."""

from __future__ import annotations

from functools import cache
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.dimensions.layout import layout
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.core.motion_results import split_path
from paminsa_viz.explorer.scene.curves import linear_colors, segments
from paminsa_viz.explorer.scene.nodes import Node, curves, lines
from paminsa_viz.kept import kept
from paminsa_viz.model.arrays import Array
from paminsa_viz.palette import BAD, INK
from paminsa_viz.plots import colors
from paminsa_viz.trajectory import TrajectoryAnalysis

WIDTH: Final = 5.0
DASH: Final = 0.008
"""Length of a dash where the motion fails [m]."""
ABOVE: Final = 0.0045
"""Height of the path's shadow over the ground, above the map and below the mark [m]."""
_LIGHTEST: Final = 0.9
"""Share of the color table that is used; its end is too light to be seen against the backdrop."""


class PathScale(NamedTuple):
    """Sizes of torque [N m] or force [N] that the first and the last color mean."""

    low: float
    high: float


def path_scale(analysis: TrajectoryAnalysis, actuator: int) -> PathScale:
    """Return the range of an actuator's torque or force in size, from 0 for torques."""
    size = np.abs(analysis.torque[:, actuator])
    size = size[np.isfinite(size)]
    if size.size == 0:
        return PathScale(0.0, 1.0)
    low = float(size.min()) if actuator == 3 else 0.0
    return PathScale(low, max(float(size.max()), low + 1e-9))


@cache
def _hues() -> tuple[str, ...]:
    """Return the colors from low to high, as ``#rrggbb``."""
    table = colors.table(colors.SEQUENTIAL)[: round(_LIGHTEST * colors.SIZE)]
    return tuple("#{:02x}{:02x}{:02x}".format(*row) for row in np.rint(255 * table).astype(int))


@cache
def _drawn_hues() -> NDArray[np.uint8]:
    return linear_colors(*_hues())


def hue(values: Array, scale: PathScale) -> NDArray[np.intp]:
    """Return the place of torques or forces (...) among the colors."""
    share = np.clip((np.abs(values) - scale.low) / (scale.high - scale.low), 0.0, 1.0)
    return np.rint(share * (len(_hues()) - 1)).astype(np.intp)


def hue_colors(values: Array, scale: PathScale) -> NDArray[np.uint8]:
    """Return the colors of values (n,) for batched meshes, (n, 3)."""
    return _drawn_hues()[hue(values, scale)]


def hue_gradient(scale: PathScale) -> list[str]:
    """Return colors from the low to the high end of a scale, as ``#rrggbb``."""
    return [_hues()[i] for i in hue(np.linspace(scale.low, scale.high, 9), scale)]


def motion_path(frame: Frame) -> tuple[Node, ...]:
    """Draw the layer ``path``, in space and as a line on the ground below it."""
    state = frame.state
    if frame.analysis is None:
        return ()
    height = layout(state.last_reachable.geometry).ground + ABOVE
    return _drawn(frame.analysis, state.plots.color, height)


@kept(4)
def _drawn(analysis: TrajectoryAnalysis, actuator: int, height: float) -> tuple[Node, ...]:
    found = split_path(analysis)
    torque = analysis.torque[found.samples, actuator]
    good = [segments(found.place[run]) for run in found.good]
    values = [np.stack([torque[run][:-1], torque[run][1:]], axis=1) for run in found.good]
    places = hue(np.concatenate([np.zeros((0, 2)), *values]), path_scale(analysis, actuator))
    way = np.concatenate([np.zeros((0, 2, 3)), *good])
    bad = [found.place[run] for run in found.bad]
    return (
        lines("/path/way", way, _drawn_hues()[places], WIDTH),
        curves("/path/failing", bad, BAD, WIDTH, dash=DASH),
        curves("/path/below", [found.place[:, :2]], INK, height=height),
    )
