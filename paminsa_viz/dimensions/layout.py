"""Layout of the machine's frame: heights and radii that follow from the geometry.

The frame is drawn around the mechanism; the paper does not give it. With the lower knee the
robot hangs from a mast with one arm: M1..M3 sit on a base plate above the guides and M4 is a column
on that plate, whose carriage slides along fixed rods. With the upper knee the base plate lies
below the guides and the platform above them, so M4 hangs from a second arm and pushes its carriage
down with a ram.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from paminsa_viz.dimensions import fixed_parts as size
from paminsa_viz.dimensions import layers as at
from paminsa_viz.kept import kept
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Geometry, KneeBranch
from paminsa_viz.model.kinematics import AXIS_ANGLES
from paminsa_viz.model.reach import workspace_radius

MAST_ANGLE: Final = float(np.radians(150.0))
"""Direction of the mast, midway between legs 1 and 3 [rad]."""

MAST: Final = (0.090, 0.066)
"""Depth (along its direction) and width of the mast [m]."""

TONGUE: Final = (0.105, 0.095)
"""How far the plinth goes on behind the middle of the mast, and half its width there [m]."""

HANG: Final = 0.18
"""Room between the lowest platform and the ground, for the payload [m]."""

STRETCHED: Final = 0.07
"""Room between the lowest joints and the ground [m]."""

TABLE: Final = 0.30
"""Least height of the guides above the ground with the upper knee [m]."""


CUTS: Final = 3
"""Edges that each rounded corner of the platform's plate is made of; they lie outside of it."""


@dataclass(frozen=True)
class FrameLayout:
    """Heights (world z) and radii of the frame [m].

    Attributes:
        ground: Height of the ground's surface.
        mast_radius: Distance of the mast from the robot's axis.
        mast_top: Height of the mast's upper end.
        column_top: Lower knee: underside of M4's end plate. Upper knee: underside of the bridge.
        lift_low, lift_high: Range of Z that M4's column or ram spans.
        platform_low, platform_high: Range of z in which the drawn bodies stay clear of the frame
            with the platform near the center; equal where there is no such height.
    """

    ground: float
    mast_radius: float
    mast_top: float
    column_top: float
    lift_low: float
    lift_high: float
    platform_low: float
    platform_high: float


def mast_radius(geometry: Geometry) -> float:
    """Return the mast's distance from the axis, out of reach of any link at any angle [m]."""
    reach = max(
        geometry.guide_link_length + at.SLIDER_HALF,
        geometry.stroke + at.SLIDER_HALF,
        1.16 * geometry.crank_length,
    )
    clear = reach + float(np.hypot(*MAST)) / 2 + 0.012
    radius = geometry.base_radius
    # Mast, leg axis and robot axis form a triangle with 60 degrees at the robot axis.
    inside = clear**2 - 0.75 * radius**2
    outer = radius / 2 + np.sqrt(inside) if inside > 0 else 0.0
    return float(max(outer, radius + 0.12))


@kept(64)
def layout(geometry: Geometry) -> FrameLayout:
    """Return the frame's heights and radii for a geometry."""
    reach = geometry.crank_length + geometry.coupler_length
    # Depth of joints 5 with the pantographs fully stretched and the platform in the middle.
    deepest = float(np.sqrt(max(reach**2 - geometry.home_span**2, 0.0025)))
    factor = geometry.magnification
    lowest_arm = at.QUILL_TOP + at.ARM_BEARING_HALF + 0.008
    radius = mast_radius(geometry)
    if geometry.knee is KneeBranch.LOWER:
        by_arms = factor * (geometry.shaft_length - lowest_arm)
        depth = max(min(deepest, by_arms), 0.1)
        low = -depth - geometry.platform_joint_height
        high = max(geometry.shaft_length, lowest_arm + 0.05) + 0.004
        return FrameLayout(
            ground=_rounded(min(low - HANG, -deepest - STRETCHED)),
            mast_radius=radius,
            mast_top=at.MOUNT + 0.105,
            column_top=high + at.CARRIAGE_HALF + 0.012,
            lift_low=lowest_arm,
            lift_high=high,
            platform_low=low,
            platform_high=max(low, -_near_guides(geometry) - geometry.platform_joint_height),
        )
    high = geometry.shaft_length + deepest / factor + 0.01
    bridge = high + at.CARRIAGE_HALF + 0.03
    # The arms travel above the platform; they meet where Z comes down to the forks.
    meet = (geometry.shaft_length - at.CARRIAGE_HALF - 0.02) / (1 - 1 / factor)
    low = _near_guides(geometry)
    # Joints 9 turn about the guides on B8; with the pantographs folded they come to hang from them.
    hanging = geometry.crank_length + STRETCHED
    return FrameLayout(
        ground=_rounded(-max(TABLE, hanging)),
        mast_radius=radius,
        mast_top=bridge + 0.085,
        column_top=bridge,
        lift_low=geometry.shaft_length,
        lift_high=high,
        platform_low=low - geometry.platform_joint_height,
        platform_high=min(deepest, max(meet, low + 0.01)) - geometry.platform_joint_height,
    )


def _near_guides(geometry: Geometry) -> float:
    """Return how far joint 5 has to stay from the guides, so that B7 clears the base plate [m].

    Joint 7 is at z_7 = (z_5 - z_9)/k; it comes nearest to the plate with the knee 9 straight
    below (or above) the guide.
    """
    room = at.MOUNT - at.BARREL_RADIUS - 0.004
    return float(max(geometry.crank_length - geometry.magnification * room, 0.03))


def _rounded(height: float) -> float:
    """Return a height rounded down to a full centimeter [m]."""
    return float(np.floor(round(height * 100, 6)) / 100)


def polar(radius: float, angle: float, height: float = 0.0) -> Array:
    """Return the point at a radius and angle [rad] about the robot's axis, at a height [m]."""
    return np.array([radius * np.cos(angle), radius * np.sin(angle), height])


def plinth_radius(geometry: Geometry) -> float:
    """Return the radius of the plinth below the workspace [m]."""
    return max(workspace_radius(geometry), 0.15) + 0.04


def plinth_outline(geometry: Geometry) -> Array:
    """Return the plinth seen from above, counterclockwise (n, 2) [m].

    A disc below the workspace with a tongue that carries the mast's foot.
    """
    radius, end = plinth_radius(geometry), layout(geometry).mast_radius + TONGUE[0]
    half = min(TONGUE[1], 0.9 * radius)
    if end <= radius:
        angle = np.linspace(0.0, 2 * np.pi, 72, endpoint=False)
        return radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    gap = np.arcsin(half / radius)
    angle = np.linspace(gap, 2 * np.pi - gap, 68)
    around = radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    corner = 0.025
    tip = [(end - corner, -half), (end, corner - half), (end, half - corner), (end - corner, half)]
    points = np.vstack([around, tip])
    c, s = np.cos(MAST_ANGLE), np.sin(MAST_ANGLE)
    return points @ np.array([[c, s], [-s, c]])


def cylinder_length(place: FrameLayout) -> float:
    """Return the length of M4's cylinder with the upper knee: it takes in the whole ram [m]."""
    return place.lift_high - place.lift_low + 0.03


def lift_motor_base(geometry: Geometry) -> float:
    """Return the height of the face that M4's head stands on [m]."""
    place = layout(geometry)
    if geometry.knee is KneeBranch.LOWER:
        return place.column_top
    return place.column_top + at.PLATE_OF_BRIDGE + cylinder_length(place)


def lift_motor_height(geometry: Geometry) -> float:
    """Return the height of the top of M4's motor [m]."""
    return lift_motor_base(geometry) + at.LIFT_MOTOR_HEIGHT


def column_heights(place: FrameLayout) -> tuple[float, float]:
    """Return the ends of M4's screw and rods with the lower knee [m]."""
    start, into = size.COLUMN_INTO
    return at.MOUNT + at.PLATE + start, place.column_top + into


def ring_arcs(radius: float) -> list[tuple[float, float]]:
    """Return the arcs of the base plate's ring between the motors (start, end) [rad]."""
    gap = 2 * np.arcsin(min(size.RING_GAP / (2 * radius), 1.0))
    arcs = [(angle + gap, angle + 2 * np.pi / 3 - gap) for angle in AXIS_ANGLES]
    return [(float(start), float(end)) for start, end in arcs if end > start]


def plate_corners(radius: float) -> Array:
    """Return a polygon about the plate with its rounded corners, (n, 2) [m].

    Each corner, a turn of 120 degrees, is replaced by tangents `CUTS` times.
    """
    step = 2 * np.pi / 3 / CUTS
    beyond = size.PLATE_CORNER / np.cos(step / 2)
    corners = []
    for angle in sorted(AXIS_ANGLES):
        for i in range(CUTS):
            turn = angle + (i + 0.5 - CUTS / 2) * step
            corners.append(polar(radius, angle)[:2] + beyond * polar(1.0, turn)[:2])
    return np.array(corners)
