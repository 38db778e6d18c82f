"""Draws the picture of the frames in `notation.md`: ``python docs/frames.py``."""

from __future__ import annotations

import io
from collections.abc import Mapping
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from paminsa_viz.model import APPENDIX_4, inverse_kinematics
from paminsa_viz.palette import ACTUATOR_COLORS, INK, MUTED

PICTURE = Path(__file__).parent / "images" / "frames.svg"
POSE = np.array([0.03, 0.02, 0.5, -0.55])
"""The pose drawn: turned by some 29°, so that the platform's axes are seen beside the base's."""

JOINED = ((8, 9), (9, 4), (4, 5), (4, 3), (3, 7), (7, 8), (3, 2))
"""Joints at the ends of the bars, parts of B4 and B3 each."""


def place(point: np.ndarray) -> tuple[float, float]:
    """Return a point as two numbers."""
    return float(point[0]), float(point[1])


def arrow(axes: Axes, start: np.ndarray, along: np.ndarray, text: str, color: str) -> None:
    """Draw an axis of a frame with its name."""
    style = {"arrowstyle": "-|>", "color": color, "lw": 1.6, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", place(start + along), place(start), arrowprops=style)
    axes.text(*place(start + 1.12 * along), text, color=color, ha="center", va="center")


def from_above(axes: Axes, points: Mapping[int, np.ndarray]) -> None:
    """Draw base and platform with their frames, seen along z."""
    theta = POSE[2]
    turn = np.array([[np.cos(theta), -np.sin(theta)], [np.sin(theta), np.cos(theta)]])
    radius = APPENDIX_4.geometry.base_radius
    corners = points[5][:, :2]
    axes.add_patch(Circle((0, 0), radius, fill=False, color=MUTED, ls=":"))
    axes.fill(*corners.T, color=MUTED, alpha=0.25, lw=0)
    for leg, degrees in enumerate((210, -30, 90)):
        angle = np.radians(degrees)
        axis = radius * np.array([np.cos(angle), np.sin(angle)])
        color = ACTUATOR_COLORS[leg]
        axes.plot(*np.stack([axis, corners[leg]]).T, color=color, lw=2)
        axes.plot(*axis, "o", color=color)
        axes.text(*place(1.17 * axis), f"leg {leg + 1}", color=color, ha="center", va="center")
    axes.text(0.0, -1.2 * radius, f"R_b = {radius:g} m, θ = {np.degrees(theta):.0f}°", ha="center")
    for along, text in (((0.13, 0), "x"), ((0, 0.13), "y")):
        arrow(axes, np.zeros(2), np.array(along), text, INK)
        arrow(axes, POSE[:2], 0.8 * (turn @ along), f"{text}′", ACTUATOR_COLORS[3])
    axes.set_title("base frame x, y and platform frame x′, y′ at P", fontsize=10)


def from_the_side(axes: Axes, points: Mapping[int, np.ndarray]) -> None:
    """Draw a leg in its plane, r from the leg's axis toward the platform."""
    angle = np.radians(210)
    origin = APPENDIX_4.geometry.base_radius * np.array([np.cos(angle), np.sin(angle)])
    toward = points[5][0, :2] - origin
    toward = toward / np.linalg.norm(toward)
    flat = {
        joint: np.array([(place[0, :2] - origin) @ toward, place[0, 2]])
        for joint, place in points.items()
    }
    for first, last in JOINED:
        axes.plot(*np.stack([flat[first], flat[last]]).T, color=ACTUATOR_COLORS[0], lw=2)
    used = sorted({joint for bar in JOINED for joint in bar})
    for joint in used:
        axes.plot(*flat[joint], "o", color=INK, ms=4)
        axes.annotate(str(joint), place(flat[joint]), (5, 5), textcoords="offset points")
    axes.axhline(0.0, color=MUTED, ls=":", lw=1)
    axes.axvline(0.0, color=MUTED, ls=":", lw=1)
    arrow(axes, np.zeros(2), np.array([0.15, 0.0]), "r", INK)
    arrow(axes, np.zeros(2), np.array([0.0, 0.15]), "z", INK)
    axes.set_title("leg 1 in its plane, guides at z = 0", fontsize=10)


def main() -> None:
    """Draw both views from the inverse kinematics of one pose."""
    points = inverse_kinematics(APPENDIX_4, POSE).points
    mpl.rcParams.update({"svg.hashsalt": "frames", "svg.fonttype": "path", "font.size": 9})
    figure = Figure(figsize=(8.2, 4.2), layout="constrained")
    left, right = figure.subplots(1, 2)
    from_above(left, points)
    from_the_side(right, points)
    for axes in (left, right):
        axes.set_aspect("equal")
        axes.axis("off")
        axes.margins(0.12)
    picture = io.StringIO()
    figure.savefig(picture, format="svg", metadata={"Date": None})
    lines = (line.rstrip() for line in picture.getvalue().splitlines())  # as pre-commit wants it
    PICTURE.write_text("\n".join(lines) + "\n", encoding="utf-8")
    print(f"{PICTURE.name}: written")


if __name__ == "__main__":
    main()
