"""Ready-made motions, sized for a robot: they fit Appendix 4's, and grow with the lengths.

None of them is a motion of the paper: the curves of its Figs. 8-11 are not in its text.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from paminsa_viz.model.arguments import geometry_of, of_geometry
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design, Geometry
from paminsa_viz.model.reach import workspace_height
from paminsa_viz.model.resizing import radius_ratio
from paminsa_viz.trajectory.plan import Plan
from paminsa_viz.trajectory.planners import PLACE, arch, circle, line, point_to_point, via_points
from paminsa_viz.trajectory.time_laws import Profile, TimeLaw

_FROM = (-0.08, 0.06, -0.4, -0.08)
_TO = (0.1, -0.05, 0.5, 0.08)


@of_geometry
def preset_center(geometry: Geometry) -> Array:
    """Return the pose (4,) about which the presets lie, in the middle of the workspace.

    It is somewhat nearer to the guides than `model.reach.home_pose`, so that all of them have room.

    Args:
        geometry: Lengths of the mechanism.

    Returns:
        (x, y, theta, z) [m, m, rad, m]: (0, 0, 0, -0.5 m) for Appendix 4's robot. With the upper
        knee the joints 5 are as high above the guides as they are below them with the lower one.
    """
    height = 0.4725 * workspace_height(geometry) / workspace_height(Geometry())
    return np.array([0.0, 0.0, 0.0, -geometry.knee.sign * height - geometry.platform_joint_height])


class PresetFrame:
    """Poses of a preset, given relative to `preset_center` as they are for Appendix 4's robot."""

    def __init__(self, geometry: Geometry) -> None:
        across = radius_ratio(geometry)
        up = workspace_height(geometry) / workspace_height(Geometry())
        self.scale = np.array([across, across, 1.0, up])
        self.center = preset_center(geometry)

    def pose(self, x: float, y: float, theta: float, z: float) -> Array:
        """Return the pose at a displacement from the center [m, m, rad, m], scaled to the robot."""
        return self.center + self.scale * np.array([x, y, theta, z])


@dataclass(frozen=True)
class Preset:
    """A ready-made motion.

    Attributes:
        key: Short name for files and links.
        label: What a person reads.
        planner: Makes the plan for a robot's lengths.
    """

    key: str
    label: str
    planner: Callable[[Geometry], Plan]

    def build(self, geometry: Geometry | Design) -> Plan:
        """Return the motion for a robot.

        Raises:
            InvalidInput: If it is neither a geometry nor a design.
        """
        return self.planner(geometry_of(geometry))


@of_geometry
def paper_like(geometry: Geometry) -> Plan:
    """Return a move of all four coordinates whose largest acceleration is exactly 1 m/s^2.

    The acceleration is that of the platform's position; its duration follows from that.
    """
    frame = PresetFrame(geometry)
    start, goal = frame.pose(*_FROM), frame.pose(*_TO)
    # the largest acceleration of the quintic law in unit time is 10 / sqrt(3)
    duration = np.sqrt(10 / np.sqrt(3) * np.linalg.norm((goal - start)[PLACE]))
    plan = point_to_point(start, goal, float(duration), name="four coordinates, 1 m/s²")
    note = (
        "A quintic move of all four coordinates with a largest acceleration of 1 m/s², which is "
        "what the paper’s text gives of its motion. It is not the motion of the paper’s "
        "Figs. 8-11, whose curves the text does not give."
    )
    return replace(plan, notes=(note,))


def _move(profile: Profile, geometry: Geometry) -> Plan:
    frame, name = PresetFrame(geometry), f"{profile.value} move"
    return point_to_point(frame.pose(*_FROM), frame.pose(*_TO), 1.5, TimeLaw(profile), name=name)


def _line(geometry: Geometry) -> Plan:
    frame = PresetFrame(geometry)
    start, goal = frame.pose(-0.12, -0.04, 0.2, 0.0), frame.pose(0.12, 0.04, 0.2, 0.0)
    return line(start, goal[PLACE], 1.5)


def _circle(geometry: Geometry) -> Plan:
    frame = PresetFrame(geometry)
    return circle(frame.center, 0.1 * frame.scale[0], 3.0)


def _arch(geometry: Geometry) -> Plan:
    frame = PresetFrame(geometry)
    start, goal = frame.pose(-0.12, 0.02, -0.3, -0.06), frame.pose(0.12, -0.02, 0.3, -0.06)
    return arch(start, goal, 0.12 * frame.scale[3], 1.2, name="pick-and-place arch")


_WAYPOINTS = (
    (0.0, 0.0, 0.0, 0.0), (0.1, 0.02, 0.3, -0.05), (0.04, 0.1, 0.0, 0.04),
    (-0.1, 0.03, -0.4, 0.06), (-0.03, -0.09, -0.1, -0.04), (0.0, 0.0, 0.0, 0.0),
)  # fmt: skip


def _waypoints(geometry: Geometry) -> Plan:
    frame = PresetFrame(geometry)
    return via_points([frame.pose(*waypoint) for waypoint in _WAYPOINTS], 4.0, geometry=geometry)


PRESETS: tuple[Preset, ...] = (
    Preset("paper-like", "Four coordinates, 1 m/s²", paper_like),
    Preset("quintic", "Quintic move", partial(_move, Profile.QUINTIC)),
    Preset("trapezoid", "Trapezoidal-velocity move", partial(_move, Profile.TRAPEZOID)),
    Preset("s-curve", "S-curve move", partial(_move, Profile.S_CURVE)),
    Preset("waypoints", "Through waypoints", _waypoints),
    Preset("line", "Straight line", _line),
    Preset("circle", "Circle", _circle),
    Preset("arch", "Pick-and-place arch", _arch),
)
"""All presets, in the order in which a page offers them."""

PRESET: dict[str, Preset] = {preset.key: preset for preset in PRESETS}
"""All presets by key."""
