"""A line drawing of the robot in a pose: from above, and from the side."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from paminsa_viz.model.arrays import Array
from paminsa_viz.model.kinematics import AXIS_ANGLES, Configuration
from paminsa_viz.model.singularity import singular_radius
from paminsa_viz.palette import INK, LEG_COLORS, LIFT_COLOR, MUTED, PLATFORM

WIDTH = 900.0
"""Width of the drawing [its own units]."""

GAP, EDGE, FOOT = 60.0, 22.0, 30.0
"""Between the views, around each of them, and below them for words."""

BARS = ((9, 5), (8, 9), (4, 7), (7, 8))
"""Joints at the ends of the bars B4, B8, B3 and B7."""

Point = tuple[float, float]
Place = Callable[[Array], Point]


def sketch(configuration: Configuration) -> bytes:
    """Return both views of a configuration of shape (), to one scale, as SVG."""
    g = configuration.geometry
    joints = {n: np.asarray(configuration.points[n]) for n in (2, 3, 4, 5, 7, 8, 9)}
    axes = g.base_radius * np.array([[np.cos(a), np.sin(a), 0.0] for a in AXIS_ANGLES])
    around = max(g.base_radius, float(singular_radius(g, configuration.pose[2])))
    ring = np.array([[s * around, t * around, 0.0] for s in (-1, 1) for t in (-1, 1)])
    plate = joints[5] - [0.0, 0.0, g.platform_joint_height]
    everything = np.concatenate([*joints.values(), axes, plate, ring])
    low, high = everything.min(axis=0), everything.max(axis=0)
    size = high - low
    scale = (WIDTH - GAP - 4 * EDGE) / (2 * size[0])
    tall = scale * max(size[1], size[2]) + 2 * EDGE
    side = (WIDTH - GAP) / 2

    def view(up: int, left: float) -> Place:
        spare = (tall - scale * size[up]) / 2

        def place(point: Array) -> Point:
            across = left + EDGE + scale * (point[0] - low[0])
            return float(across), float(spare + scale * (high[up] - point[up]))

        return place

    top_view, side_view = view(1, 0.0), view(2, side + GAP)
    middle = top_view(np.zeros(3))
    hub = np.array([0.0, 0.0, float(configuration.actuators[3])])
    ends = [side_view(np.array([end, 0.0, 0.0])) for end in (low[0], high[0])]
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH:g} {tall + FOOT:.0f}" '
        'font-family="DejaVu Sans, Segoe UI, Helvetica, sans-serif" font-size="14">',
        _circle(middle, scale * g.base_radius, MUTED, 1.0),
        _circle(middle, scale * float(singular_radius(g, configuration.pose[2])), INK, 1.0, "6 5"),
        _line((middle[0] - 5, middle[1]), (middle[0] + 5, middle[1]), MUTED, 1.0),
        _line((middle[0], middle[1] - 5), (middle[0], middle[1] + 5), MUTED, 1.0),
        _polygon([top_view(point) for point in plate]),
        _line(ends[0], ends[1], MUTED, 1.0, "2 4"),
        *(_line(side_view(hub), side_view(arm), LIFT_COLOR, 3.0) for arm in joints[2]),
        _polygon([side_view(point) for point in plate]),
        *(
            _line(side_view(a), side_view(b), INK, 1.6)
            for a, b in zip(plate, joints[5], strict=True)
        ),
    ]
    for leg, color in enumerate(LEG_COLORS):
        points = {number: point[leg] for number, point in joints.items()}
        parts += _leg(points, axes[leg], top_view, color)
        parts += _leg(points, axes[leg], side_view, color)
        ahead = points[5] - axes[leg]
        aside = np.array([-ahead[1], ahead[0]]) / max(float(np.hypot(*ahead[:2])), 1e-9)
        x, y = top_view(axes[leg])
        parts.append(_words((x + 18 * aside[0], y - 18 * aside[1] + 5), str(leg + 1), color))
        x, y = side_view(points[2])
        parts.append(_words((x, y - 9), str(leg + 1), color))
    parts += [
        _words((side / 2, tall + 20), "from above: x right, y up"),
        _words((1.5 * side + GAP, tall + 20), "from the side: x right, z up"),
        "</svg>",
    ]
    return "\n".join(parts).encode()


def _leg(points: dict[int, Array], axis: Array, place: Place, color: str) -> list[str]:
    at = {number: place(point) for number, point in points.items()}
    foot = place(axis)
    return [
        _line(foot, at[8], color, 1.4, "5 3"),
        _line(at[3], at[2], LIFT_COLOR, 3.0),
        *(_line(at[first], at[second], color, 3.0) for first, second in BARS),
        _circle(foot, 6.0, color, 1.6, fill="white"),
        *(_circle(at[number], 3.0, color, 1.2, fill="white") for number in (3, 4, 5, 7, 8, 9)),
    ]


def _line(start: Point, end: Point, color: str, width: float, dash: str = "") -> str:
    return (
        f'<line x1="{start[0]:.2f}" y1="{start[1]:.2f}" x2="{end[0]:.2f}" y2="{end[1]:.2f}" '
        f'stroke="{color}" stroke-width="{width:g}" stroke-linecap="round"{_dashes(dash)}/>'
    )


def _circle(
    center: Point, radius: float, color: str, width: float, dash: str = "", fill: str = "none"
) -> str:
    return (
        f'<circle cx="{center[0]:.2f}" cy="{center[1]:.2f}" r="{radius:.2f}" fill="{fill}" '
        f'stroke="{color}" stroke-width="{width:g}"{_dashes(dash)}/>'
    )


def _polygon(corners: list[Point]) -> str:
    path = " ".join(f"{x:.2f},{y:.2f}" for x, y in corners)
    return (
        f'<polygon points="{path}" fill="{PLATFORM}" fill-opacity="0.7" stroke="{INK}" '
        'stroke-width="1.8" stroke-linejoin="round"/>'
    )


def _words(place: Point, text: str, color: str = INK) -> str:
    x, y = place
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="middle" fill="{color}">{text}</text>'


def _dashes(dash: str) -> str:
    return f' stroke-dasharray="{dash}"' if dash else ""
