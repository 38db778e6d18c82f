"""Layout of the machine's frame: heights and radii that follow from the geometry.

The frame is drawn around the mechanism; the paper does not give it. With the lower knee the
robot hangs from a mast with one arm: M1..M3 sit on a base plate above the guides and M4 is a column
on that plate, whose carriage slides along fixed rods. With the upper knee the base plate lies
below the guides and the platform above them, so M4 hangs from a second arm and pushes its carriage
down with a ram.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final, NamedTuple

import numpy as np

from paminsa_viz.dimensions import fixed_parts as size
from paminsa_viz.dimensions import layers as at
from paminsa_viz.dimensions.body_scale import times_body_scale
from paminsa_viz.dimensions.layers import CARRIAGE_HALF, SLIDER_HALF
from paminsa_viz.kept import kept
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Geometry, KneeBranch
from paminsa_viz.model.kinematics import AXIS_ANGLES
from paminsa_viz.model.leg import Mechanism, mechanism
from paminsa_viz.model.measures import workspace_circle
from paminsa_viz.model.robot import where

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

MAST_HALF: Final = float(np.hypot(*MAST)) / 2
MAST_GAP: Final = 0.012
BAR_REACH: Final = 1.16
MAST_ROOM: Final = 0.12
"""Of the mast: half its diagonal, its distance from the links, how far B8 with all that it carries
reaches over its length, and the least distance of the mast from a leg's axis [m]."""

LOWEST_ARM: Final = at.QUILL_TOP + at.ARM_BEARING_HALF + 0.008
"""Least height of joint 2 with the lower knee, above the quills [m]."""

LEAST_LIFT: Final = 0.05
ABOVE_LIFT: Final = 0.004
ABOVE_CARRIAGE: Final = 0.012
MAST_TOP: Final = at.MOUNT + 0.105
"""Lower knee: least stroke of M4's column, room above its end and above the carriage there, and the
height of the mast [m]."""

ABOVE_RAM: Final = 0.01
BELOW_BRIDGE: Final = 0.03
ABOVE_BRIDGE: Final = 0.085
"""Upper knee: room above M4's stroke, below the bridge, and height of the mast above that [m]."""

LEAST_DEEPEST: Final = 0.0025
LEAST_DEPTH: Final = 0.1
"""Least square of the depth of the stretched pantographs [m^2], and least depth of joints 5 [m]."""

ROOM_OF_7: Final = at.MOUNT - at.BARREL_RADIUS - 0.004
LEAST_NEAR: Final = 0.03
"""Room of joint 7 below the base plate, and least distance of joints 5 from the guides [m]."""

LEAST_PLINTH: Final = 0.15
PLINTH_EDGE: Final = 0.04
"""Least workspace that a plinth is made for, and how far it goes beyond it [m]."""

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


class FrameLengths(NamedTuple):
    """The frame's lengths as `FrameLayout` explains them, and the radius of the plinth [m]."""

    ground: Any
    mast_radius: Any
    mast_top: Any
    column_top: Any
    lift_low: Any
    lift_high: Any
    plinth_radius: Any


def frame_lengths(m: Mechanism, guide_link: Any) -> FrameLengths:
    """Return the lengths of the frame, a plain formula for every robot; not in the paper.

    As all functions here that take no geometry, it is for bodies of the prototype's size; for
    others see `body_scale`.

    Args:
        m: The mechanism.
        guide_link: l_B10 [m].
    """
    deepest = _deepest(m)
    lower = m.root > 0.0

    low = -_depth(m, deepest) - m.joint_height
    room = where(low - HANG < -deepest - STRETCHED, low - HANG, -deepest - STRETCHED)
    top = np.maximum(m.shaft, LOWEST_ARM + LEAST_LIFT) + ABOVE_LIFT
    # Joints 9 turn about the guides on B8; with folded pantographs they hang from them.
    table = -np.maximum(TABLE, m.crank + STRETCHED)
    high = m.shaft + deepest / m.k + ABOVE_RAM
    bridge = high + CARRIAGE_HALF + BELOW_BRIDGE

    # The mast is out of reach of any link at any angle.
    links = np.maximum(
        np.maximum(guide_link + SLIDER_HALF, m.stroke + SLIDER_HALF), BAR_REACH * m.crank
    )
    clear = links + MAST_HALF + MAST_GAP
    # Mast, leg axis and robot axis form a triangle with 60 degrees at the robot axis.
    inside = clear * clear - 0.75 * (m.base_radius * m.base_radius)
    outer = where(inside > 0.0, m.base_radius / 2.0 + np.sqrt(np.maximum(inside, 0.0)), 0.0)
    return FrameLengths(
        _rounded(where(lower, room, table)),
        np.maximum(outer, m.base_radius + MAST_ROOM),
        where(lower, MAST_TOP, bridge + ABOVE_BRIDGE),
        where(lower, top + CARRIAGE_HALF + ABOVE_CARRIAGE, bridge),
        where(lower, LOWEST_ARM, m.shaft),
        where(lower, top, high),
        np.maximum(workspace_circle(m), LEAST_PLINTH) + PLINTH_EDGE,
    )


def _deepest(m: Mechanism) -> Any:
    """Return how far joints 5 are from the guides, the pantographs stretched, in the middle [m]."""
    bars = m.crank + m.coupler
    span = m.span_ratio * np.abs(m.base_radius - m.platform_radius)
    return np.sqrt(np.maximum(bars * bars - span * span, LEAST_DEEPEST))


def _depth(m: Mechanism, deepest: Any) -> Any:
    """Return how far the platform's joints hang below the guides at most, lower knee [m]."""
    by_arms = m.k * (m.shaft - LOWEST_ARM)
    return np.maximum(where(deepest < by_arms, deepest, by_arms), LEAST_DEPTH)


def _rounded(height: Any) -> Any:
    """Return a height rounded down to a full centimeter, but for rounding errors [m]."""
    steps = height * 100.0 + 5e-7
    return (steps - np.mod(steps, 1.0)) / 100.0


class PlatformRange(NamedTuple):
    """The heights z that `FrameLayout` calls ``platform_low`` and ``platform_high`` [m]."""

    low: Any
    high: Any


def platform_range(m: Mechanism) -> PlatformRange:
    """Return the heights in which the drawn bodies stay clear of the frame, a plain formula."""
    deepest = _deepest(m)
    # How far joint 5 stays from the guides, so that B7 clears the base plate. Joint 7 is at
    # z_7 = (z_5 - z_9)/k; it comes nearest with the knee 9 straight below (or above) the guide.
    near = np.maximum(m.crank - m.k * ROOM_OF_7, LEAST_NEAR)
    deep = -_depth(m, deepest)
    # With the upper knee the arms travel above the platform; they meet where Z comes down to the
    # forks.
    meet = np.maximum((m.shaft - CARRIAGE_HALF - 0.02) / (1.0 - 1.0 / m.k), near + 0.01)
    high = where(deepest < meet, deepest, meet)
    lower = m.root > 0.0
    return PlatformRange(
        where(lower, deep, near) - m.joint_height,
        where(lower, np.maximum(deep, -near), high) - m.joint_height,
    )


@kept(64)
@times_body_scale
def layout(geometry: Geometry) -> FrameLayout:
    """Return the frame's heights and radii for a geometry."""
    m = mechanism(geometry)
    place = FrameLengths(*map(float, frame_lengths(m, geometry.guide_link_length)))
    low, high = map(float, platform_range(m))
    return FrameLayout(*place[:6], platform_low=low, platform_high=high)


def polar(radius: float, angle: float, height: float = 0.0) -> Array:
    """Return the point at a radius and angle [rad] about the robot's axis, at a height [m]."""
    return np.array([radius * np.cos(angle), radius * np.sin(angle), height])


@times_body_scale
def plinth_radius(geometry: Geometry) -> float:
    """Return the radius of the plinth below the workspace [m]."""
    return float(frame_lengths(mechanism(geometry), geometry.guide_link_length).plinth_radius)


@times_body_scale
def plinth_outline(geometry: Geometry) -> Array:
    """Return the plinth seen from above, counterclockwise (n, 2) [m]."""
    return outline_about(plinth_radius(geometry), layout(geometry).mast_radius)


def outline_about(radius: float, mast: float) -> Array:
    """Return a plinth's outline by its radius and the mast's distance, counterclockwise (n, 2) [m].

    A disc below the workspace with a tongue that carries the mast's foot.
    """
    end = mast + TONGUE[0]
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


@times_body_scale
def lift_motor_base(geometry: Geometry) -> float:
    """Return the height of the face that M4's head stands on [m]."""
    place = layout(geometry)
    if geometry.knee is KneeBranch.LOWER:
        return place.column_top
    return place.column_top + at.PLATE_OF_BRIDGE + cylinder_length(place)


@times_body_scale
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
