"""A motion through singularities over its path: speeds that are possible, residual, torques."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from paminsa_viz.model import inverse_dynamics
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.singularity import twist_field
from paminsa_viz.palette import BAD, INK, LEG_COLORS, MUTED, PLATFORM
from paminsa_viz.plots.formats import Credits, arrange, drawing, figure_file
from paminsa_viz.trajectory import TimeOptimalPlan
from paminsa_viz.trajectory.crossing import path_coefficients
from paminsa_viz.trajectory.crossing_measures import UNPLANNED_LAW

SIZE = (3.6, 5.2)
"""Width and height [inches]."""

POINTS = 301

OFF = 1e-4
"""Torques are drawn up to this near to a crossing, in s."""


def residual_along(
    design: Design, found: TimeOptimalPlan, s: Array, rate: Array, growth: Array
) -> Array:
    """Return t_s^T F along the path of a motion, with the formula of t_s off the loci, (n,) [N m].

    Args:
        design: The robot.
        found: The motion.
        s: (n,) points of its path.
        rate: (n,) s' there [1/s].
        growth: (n,) s'' there [1/s^2].
    """
    a, b, c = path_coefficients(design, found.path, s)
    force = a * growth[:, None] + b * rate[:, None] ** 2 + c
    return np.einsum("ni,ni->n", twist_field(design.geometry, found.path(s)), force)


def crossing_svg(design: Design, found: TimeOptimalPlan) -> bytes:
    """Return `draw_crossing` as SVG."""
    with drawing():
        title = "Motion through singularities over its path"
        return figure_file(draw_crossing(design, found), "svg", 72.0, Credits(title, title))


def draw_crossing(design: Design, found: TimeOptimalPlan) -> Figure:
    """Return speeds, residual and torques of M1 to M3 over s, inside `formats.drawing`."""
    page = Figure(figsize=SIZE)
    speed, residual, torque = page.subplots(3, 1, sharex=True)
    s = np.linspace(0.0, 1.0, POINTS)
    low, high = (np.sqrt(np.maximum(z(s), 0.0)) for z in (found.slowest, found.fastest))
    z = found.curve.z
    rate = np.sqrt(np.maximum(z(s), 0.0))
    speed.fill_between(s, low, high, color=PLATFORM, label="possible")
    speed.plot(s, rate, color=INK, lw=1.2, label="planned")
    speed.set(ylabel="ṡ [1/s]", ylim=(0.0, None))
    u = np.linspace(0.0, 1.0, POINTS)
    usual = [UNPLANNED_LAW(u, order) / found.curve.duration**order for order in range(3)]
    residual.plot(
        usual[0], residual_along(design, found, *usual), color=BAD, lw=1.0, label="quintic law"
    )
    residual.plot(
        s, residual_along(design, found, s, rate, 0.5 * z(s, 1)), color=INK, lw=1.2,
        label="planned",
    )  # fmt: skip
    residual.set_ylabel("residual [N·m]")
    residual.axhline(0.0, color=MUTED, lw=0.6)
    _draw_torques(torque, design, found, s)
    for item in found.crossings:
        for axes in (speed, residual, torque):
            axes.axvline(item.crossing.s, color=INK, lw=0.8, ls="--")
        speed.plot(item.crossing.s, item.speed, "o", color=INK, ms=4)
        residual.plot(item.crossing.s, 0.0, "o", color=INK, ms=4)
    for axes in (speed, residual, torque):
        axes.tick_params(labelsize=7)
        axes.yaxis.label.set_size(8)
        axes.legend(
            fontsize=6.5, frameon=False, loc="lower right", bbox_to_anchor=(1.0, 0.97), ncols=3,
            handlelength=1.2, borderpad=0.1,
        )  # fmt: skip
    torque.set(xlim=(0.0, 1.0))
    torque.set_xlabel("s", size=8)
    arrange(page, ConstrainedLayoutEngine())
    return page


def _draw_torques(axes: Axes, design: Design, found: TimeOptimalPlan, s: Array) -> None:
    """Draw torques, friction left out, and those in the limit at the crossings."""
    for item in found.crossings:
        s = s[np.abs(s - item.crossing.s) > OFF]
    z, path = found.curve.z, found.path
    along, square = path(s, 1), np.maximum(z(s), 0.0)[:, None]
    acceleration = path(s, 2) * square + along * 0.5 * z(s, 1)[:, None]
    state = (path(s), along * np.sqrt(square), acceleration)
    torques = inverse_dynamics(design.without_friction(), *state).torque
    for j, color in enumerate(LEG_COLORS):
        axes.plot(s, torques[:, j], color=color, lw=1.0, label=f"M{j + 1}")
        for item in found.crossings:
            axes.plot(item.crossing.s, item.torque[j], "o", color=color, ms=4, mec=INK, mew=0.5)
    axes.set_ylabel("τ [N·m]")
