"""What the page says of a motion in plain words."""

from __future__ import annotations

import math

from paminsa_viz.explorer.motion import actions as motions
from paminsa_viz.explorer.state import Pose, State
from paminsa_viz.trajectory import TrajectoryAnalysis
from paminsa_viz.units import number


def status_line(state: State, analysis: TrajectoryAnalysis | None) -> tuple[bool, str]:
    """Return whether a motion is fine, and the plain line that says so or says why not."""
    found = motions.planned(state)
    if analysis is None or found.trajectory is None:
        return False, found.problem
    if found.problem:
        return False, found.problem
    check = analysis.check
    if check.first is not None:
        return False, f"fails {check.first.explanation}"
    near = check.closest
    leg = f" of leg {near.leg + 1}" if near.leg >= 0 else ""
    words = f"{number(found.trajectory.duration, 4)} s, {found.trajectory.size} samples"
    words += f"; nearest limit: {near.limit.noun}{leg}, "
    words += f"{1e3 * near.margin:.0f} mm away at {number(near.t, 3)} s"
    return True, words


def pose_words(pose: Pose) -> str:
    """Return a pose in millimeters and degrees."""
    x, y, theta, z = pose
    mm = [number(round(1e3 * value, 1), 6) for value in (x, y, z)]
    return f"x {mm[0]}, y {mm[1]}, z {mm[2]} mm, θ {number(round(math.degrees(theta), 1))}°"
