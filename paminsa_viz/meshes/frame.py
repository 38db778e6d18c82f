"""The fixed part of the machine: ground, posts, base plate with M1..M3, and M4's column."""

from __future__ import annotations

import numpy as np

from paminsa_viz.dimensions import fixed_parts as size
from paminsa_viz.dimensions import layers as at
from paminsa_viz.dimensions.layout import (
    MAST,
    MAST_ANGLE,
    FrameLayout,
    column_heights,
    cylinder_length,
    outline_about,
    polar,
    ring_arcs,
)
from paminsa_viz.meshes.part import MeshPart, fixed_part
from paminsa_viz.meshes.solids import (
    Array,
    arc_beam,
    beam,
    box,
    fan,
    flat_rings,
    loft,
    moved,
    prism,
    rod,
    rounded_rectangle,
    tube,
    turn,
)
from paminsa_viz.model.design import KneeBranch
from paminsa_viz.model.kinematics import AXIS_ANGLES

FLIP = turn("y", np.pi)
"""Turns the base plate over; it keeps the three leg directions where they are."""


MOST_CIRCLES = 540
"""Circles on the ground at most, as many as `packed` has points for: below a huge robot, or one of
tiny bodies, they are ten times as far apart, or a hundred times."""


def ground(radius: float, place: FrameLayout) -> MeshPart:
    """Return the plinth the machine stands on; its upper face is the ground. World frame."""
    outline, top = outline_about(radius, place.mast_radius), place.ground
    low, high = (
        np.column_stack([outline, np.full(len(outline), h)])
        for h in (top - size.PLINTH_HEIGHT, top - 0.0015)
    )
    part = MeshPart().add("floor", fan(outline * (1 - 0.002 / radius), top))
    part.add("rim", loft([low, high]))
    # Circles every 0.2 m for scale; they protrude by less than the images on the floor.
    step = 0.2
    while radius > MOST_CIRCLES * step:
        step *= 10
    lines = np.arange(step, radius - 0.05, step)
    if lines.size:
        part.add("line", flat_rings(lines, 0.0036, top + 0.0006, 60))
    return part


def base(radius: float, place: FrameLayout, knee: KneeBranch) -> MeshPart:
    """Return the frame that does not move, without the actuators' bodies. World frame."""
    plate = _base_plate(radius)
    if knee is KneeBranch.LOWER:
        arm = _cantilever(place, at.MOUNT + size.CANTILEVER_RISE, *size.CANTILEVER)
        return plate.join(_mast(place), arm, _column(place))
    top = -at.MOUNT - size.CANTILEVER_RISE
    arm = _cantilever(place, top, *size.CANTILEVER)
    # Mirrored in the plane of its straight edge: deep side down.
    arm = arm.moved((0.0, 0.0, 2 * top), FLIP @ turn("z", np.pi - 2 * MAST_ANGLE))
    return plate.moved(rotation=FLIP).join(_mast(place), arm, _bridge(place))


def motor(leg: int, radius: float, knee: KneeBranch) -> MeshPart:
    """Return the actuator of a leg (index 0 to 2) in the world frame."""
    angle = AXIS_ANGLES[leg]
    seat, rotation = polar(radius, angle, at.MOUNT + at.PLATE), turn("z", angle)
    if knee is KneeBranch.UPPER:
        # Turned over, legs 1 and 2 change places, so each motor goes to the other's seat.
        seat, rotation = FLIP @ seat * [-1, 1, 1], rotation @ turn("x", np.pi)
    return fixed_part("rotary_actuator").moved(seat, rotation)


def lift(place: FrameLayout, knee: KneeBranch) -> MeshPart:
    """Return the fixed body of M4 in the world frame; with the upper knee it has a cylinder."""
    if knee is KneeBranch.LOWER:
        return fixed_part("lift_motor").moved((0.0, 0.0, place.column_top))
    foot = place.column_top + at.PLATE_OF_BRIDGE
    top = foot + cylinder_length(place)
    part = fixed_part("lift_foot").moved((0.0, 0.0, foot - 0.002))
    part.add("frame", rod(at.CYLINDER_RADIUS, foot, top, 0.002, 32))
    part.add("accent", tube(0.03, at.CYLINDER_RADIUS + 0.0015, top - 0.02, top - 0.010, 0.001, 32))
    return part.join(fixed_part("lift_motor").moved((0.0, 0.0, top)))


def _base_plate(radius: float) -> MeshPart:
    """The plate above the guides: hub, spokes to the motors, ring."""
    low, high = at.MOUNT, at.MOUNT + at.PLATE
    part = MeshPart().add("frame", rod(size.HUB_RADIUS, low, high, 0.002, 32))
    for angle in AXIS_ANGLES:
        spin = turn("z", angle)
        # Spokes stand on edge above the plate's lower face, clear of the bars below.
        inner, outer = ((width, size.SPOKE_HEIGHT) for width in size.SPOKE_WIDTHS)
        ends = size.SPOKE_END, radius - size.SPOKE_END
        spoke = beam(*ends, inner, outer, 0.003, size.SPOKE_CHAMFER)
        part.add("frame", moved(spoke, (0.0, 0.0, low + size.SPOKE_MIDDLE), spin))
        seat = tube(at.QUILL_RADIUS + 0.001, size.SEAT_RADIUS, low + 0.0003, high, 0.0015, 28)
        part.add("frame", moved(seat, polar(radius, angle)))
    bottom, top = (low + height for height in size.RING)
    for start, end in ring_arcs(radius):
        part.add("frame", arc_beam(radius, size.RING_WIDTH, bottom, top, start, end))
    return part


def _mast(place: FrameLayout) -> MeshPart:
    """The mast behind the robot, on its foot."""
    spin = turn("z", MAST_ANGLE)
    where = polar(place.mast_radius, MAST_ANGLE)
    low, top = place.ground, place.mast_top
    part = fixed_part("mast_foot").moved(where + polar(0.0, 0.0, low), spin)
    profile = prism(rounded_rectangle(*MAST, 0.010, steps=3), low + size.MAST_START, top, 0.001)
    part.add("frame", moved(profile, where, spin))
    for side in (-1.0, 1.0):
        # Dark inlays in the profile's grooves; they protrude by less than can be seen.
        for offset in (-0.022, 0.022):
            groove = box((0.008, 0.002, top - low - 0.07), chamfer=0.0)
            across = np.array([offset, side * (MAST[1] / 2 - 0.0006), (top + low) / 2])
            part.add("body", moved(moved(groove, across), where, spin))
    more, above = size.MAST_CAP
    cap = prism(rounded_rectangle(MAST[0] + more, MAST[1] + more, 0.011), top - 0.001, top + above)
    return part.add("dark", moved(cap, where, spin))


def _cantilever(
    place: FrameLayout,
    low: float,
    start: float,
    inner: tuple[float, float],
    outer: tuple[float, float],
) -> MeshPart:
    """An arm from the mast to the robot's axis, level below and sloping above.

    ``inner`` and ``outer`` are its (width, height) at the axis and at the mast.
    """
    end = place.mast_radius - MAST[0] / 2 + size.CANTILEVER_INTO_MAST
    spin = turn("z", MAST_ANGLE)

    def loop(x: float, size: tuple[float, float]) -> Array:
        flat = rounded_rectangle(size[0], size[1], 0.006, steps=3)
        height = low + size[1] / 2 + flat[:, 1]
        return np.stack([np.full(len(flat), x), flat[:, 0], height], axis=1)

    arm = loft([loop(start, inner), loop(end, outer)])
    part = MeshPart().add("frame", moved(arm, rotation=spin))
    thick, wide, high = size.FLANGE_PLATE
    flange = rounded_rectangle(thick, outer[0] + wide, 0.003)
    plate = prism(flange, low - high, low + outer[1] + high)
    return part.add("body", moved(plate, polar(end - 0.006, MAST_ANGLE), spin))


def _column(place: FrameLayout) -> MeshPart:
    """M4's column with the lower knee: foot, three guide rods and the screw."""
    bottom = at.MOUNT + at.PLATE
    low, high = column_heights(place)
    part = fixed_part("lift_foot").moved((0.0, 0.0, bottom))
    part.add("steel", rod(at.SCREW_RADIUS, low, high, 0.0, 10))
    for angle in at.ROD_ANGLES:
        guide = rod(at.ROD_RADIUS, low, high, 0.0, 8)
        part.add("steel", moved(guide, polar(at.ROD_CIRCLE, angle)))
    return part


def _bridge(place: FrameLayout) -> MeshPart:
    """The arm over the robot with the upper knee, which carries M4."""
    low, high = place.column_top, place.column_top + at.PLATE_OF_BRIDGE
    part = MeshPart().add(
        "frame", tube(at.RAM_RADIUS + 0.002, size.BRIDGE_RADIUS, low, high, 0.002, 40)
    )
    return part.join(_cantilever(place, low + size.CANTILEVER_RISE, *size.BRIDGE_CANTILEVER))
