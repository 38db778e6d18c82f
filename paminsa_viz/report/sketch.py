"""A line drawing of the robot in a pose: from above, and from the side."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from paminsa_viz.model.arrays import Array
from paminsa_viz.model.kinematics import AXIS_ANGLES, Configuration
from paminsa_viz.model.singularity import singular_radius
from paminsa_viz.palette import INK, LEG_COLORS, LIFT_COLOR, MUTED, PLATFORM
from paminsa_viz.plots.formats import Credits, drawing, figure_file

WIDTH = 9.0
"""Width of the drawing [inches]."""

BARS = ((9, 5), (8, 9), (4, 7), (7, 8))
"""Joints at the ends of the bars B4, B8, B3 and B7."""


def sketch(configuration: Configuration) -> bytes:
    """Return both views of a configuration of shape () as SVG."""
    with drawing():
        title = "PAMINSA from above and from the side"
        return figure_file(draw_sketch(configuration), "svg", 72.0, Credits(title, title))


def draw_sketch(configuration: Configuration) -> Figure:
    """Return both views of a configuration of shape (), to one scale, inside `formats.drawing`."""
    g = configuration.geometry
    joints = {n: np.asarray(configuration.points[n]) for n in (2, 3, 4, 5, 7, 8, 9)}
    feet = g.base_radius * np.array([[np.cos(a), np.sin(a), 0.0] for a in AXIS_ANGLES])
    plate = joints[5] - [0.0, 0.0, g.platform_joint_height]
    singular = float(singular_radius(g, configuration.pose[2]))
    around = max(g.base_radius, singular)
    everything = np.concatenate([*joints.values(), feet, plate, [[around] * 2 + [0.0]]])
    everything = np.concatenate([everything, [[-around] * 2 + [0.0]]])
    margin = 0.04 * np.ptp(everything[:, 0])
    low, high = everything.min(axis=0) - margin, everything.max(axis=0) + margin
    size = high - low
    words, half = 0.35, 0.48  # room below for words [inches], width of a view as a share
    height = half * WIDTH * max(size[1:]) / size[0] + words
    page = Figure(figsize=(WIDTH, height))
    for up, start, text in ((1, 0.0, "from above: x right, y up"),
                            (2, 1 - half, "from the side: x right, z up")):  # fmt: skip
        area = page.add_axes((start, words / height, half, 1 - words / height))
        area.set(xlim=(low[0], high[0]), ylim=(low[up], high[up]), aspect="equal")
        area.set_axis_off()
        page.text(start + half / 2, 0.1 / height, text, ha="center", color=INK, size=10)
        if up == 1:
            area.plot(0, 0, "+", color=MUTED, ms=8)
            for radius, color, dash in ((g.base_radius, MUTED, "-"), (singular, INK, "--")):
                turn = np.linspace(0, 2 * np.pi, 181)
                area.plot(radius * np.cos(turn), radius * np.sin(turn), dash, color=color, lw=0.8)
        else:
            area.axhline(0, color=MUTED, lw=0.8, ls=":")
            hub = [0.0, 0.0, float(configuration.actuators[3])]
            for arm in joints[2]:
                _line(area, np.array([hub, arm]), up, LIFT_COLOR, 2.2)
            for one, other in zip(plate, joints[5], strict=True):
                _line(area, np.array([one, other]), up, INK, 1.2)
        area.fill(plate[:, 0], plate[:, up], fc=PLATFORM, ec=INK, lw=1.3, alpha=0.8)
        for leg, color in enumerate(LEG_COLORS):
            points = {number: point[leg] for number, point in joints.items()}
            _draw_leg(area, points, feet[leg], up, color)
            place, shift = points[2], np.array([0.0, 9.0])  # points
            if up == 1:
                ahead = points[5] - feet[leg]
                aside = np.array([-ahead[1], ahead[0]]) / max(float(np.hypot(*ahead[:2])), 1e-9)
                place, shift = feet[leg], 13 * aside
            area.annotate(
                str(leg + 1), place[[0, up]], tuple(shift), textcoords="offset points",
                ha="center", va="center", color=color, size=10,
            )  # fmt: skip
    return page


def _draw_leg(area: Axes, points: dict[int, Array], foot: Array, up: int, color: str) -> None:
    _line(area, np.array([foot, points[8]]), up, color, 1.1, "--")
    _line(area, np.array([points[3], points[2]]), up, LIFT_COLOR, 2.2)
    for first, second in BARS:
        _line(area, np.array([points[first], points[second]]), up, color, 2.2)
    rings = np.array([points[number] for number in (3, 4, 5, 7, 8, 9)])
    for at, size in ((foot[None], 9), (rings, 4.5)):
        area.plot(at[:, 0], at[:, up], "o", ms=size, mfc="white", mec=color, mew=1.0)


def _line(area: Axes, ends: Array, up: int, color: str, width: float, dash: str = "-") -> None:
    area.plot(ends[:, 0], ends[:, up], dash, color=color, lw=width, solid_capstyle="round")
