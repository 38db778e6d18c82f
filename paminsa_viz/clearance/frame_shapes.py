"""Solids of the machine's frame, of M4's carriage with the arms, and of platform and payload."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from paminsa_viz.clearance.solids import OVER, WORLD, Body, BodyPart, Primitive, box, prism
from paminsa_viz.clearance.solids import cylinder as rod
from paminsa_viz.dimensions import fixed_parts as size
from paminsa_viz.dimensions import layers as at
from paminsa_viz.dimensions.attached import PAYLOAD_HEIGHT, payload_offset, payload_scale
from paminsa_viz.dimensions.layout import (
    MAST,
    MAST_ANGLE,
    TONGUE,
    FrameLayout,
    column_heights,
    cylinder_length,
    layout,
    lift_motor_base,
    plate_corners,
    plinth_radius,
    polar,
    ring_arcs,
)
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design, Geometry, KneeBranch
from paminsa_viz.model.kinematics import AXIS_ANGLES

CHORDS = 8
"""Boxes that an arc of the base plate's ring is made of."""

UPRIGHT = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
"""Turns a prism so that its polygon is in x and z."""


def about_z(angle: float) -> Array:
    """Return the rotation about z by an angle [rad]."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def taper(start: float, end: float, first: float, last: float, chamfer: float) -> Array:
    """Return a polygon about a tapered beam along x, of a width at its start and its end (6, 2).

    The drawn beam has its first width up to its chamfer.
    """
    flat = start + min(chamfer, (end - start) / 3)
    low, high = first / 2, last / 2
    return np.array(
        [(start, -low), (flat, -low), (end, -high), (end, high), (flat, low), (start, low)]
    )


def _turned(solid: Primitive, angle: float, place: Array | None = None) -> Primitive:
    return solid.moved(np.zeros(3) if place is None else place, about_z(angle))


def frame_bodies(design: Design) -> Iterator[Body]:
    """Yield the bodies that do not move, in the world frame."""
    g, place = design.geometry, layout(design.geometry)

    def fixed(key: str, name: str, *solids: Primitive) -> Body:
        return Body(key, name, WORLD, BodyPart.FRAME, 0, solids)

    upper = g.knee is KneeBranch.UPPER
    yield fixed(
        "base", "the base plate", *_base_plate(g, upper), *_cantilever_of_base(place, upper)
    )
    for leg, angle in enumerate(AXIS_ANGLES, 1):
        yield fixed(f"m{leg}", f"M{leg}", *_motor(g.base_radius, float(angle), upper))
    yield fixed("m4", "M4", *_lift(g, place))
    yield fixed("column", "the guide of M4", *_column(place, upper))
    yield fixed("mast", "the mast", *_mast(place))
    yield fixed("ground", "the plinth", *_plinth(g, place))


def _plinth(g: Geometry, place: FrameLayout) -> Iterator[Primitive]:
    """Yield the disc below the workspace, and the tongue that carries the mast."""
    low, high = place.ground - size.PLINTH_HEIGHT, place.ground
    radius, end = plinth_radius(g), place.mast_radius + TONGUE[0]
    yield rod(radius, low, high)
    if end > radius:
        yield _turned(box((0.0, -TONGUE[1], low), (end, TONGUE[1], high)), MAST_ANGLE)


def _base_plate(g: Geometry, upper: bool) -> Iterator[Primitive]:
    low, high, radius = at.MOUNT, at.MOUNT + at.PLATE, g.base_radius
    solids = [rod(size.HUB_RADIUS, low, high)]
    start, end = size.SPOKE_END, radius - size.SPOKE_END
    (root, tip), middle, half = size.SPOKE_WIDTHS, low + size.SPOKE_MIDDLE, size.SPOKE_HEIGHT / 2
    for angle in AXIS_ANGLES:
        if end > start:
            flat = taper(start, end, root, tip, size.SPOKE_CHAMFER)
            solids.append(_turned(prism(flat, middle - half, middle + half), angle))
        solids.append(rod(size.SEAT_RADIUS, low, high, polar(radius, angle)))
    bottom, top = (low + height for height in size.RING)
    inner, outer = radius - size.RING_WIDTH / 2, radius + size.RING_WIDTH / 2
    for first, last in ring_arcs(radius):
        step = (last - first) / CHORDS
        for i in range(CHORDS):
            # the drawn ring has straight pieces too, nearer to the axis in their middles
            near = inner * np.cos(step / 2) * np.cos(size.RING_STEP / 2)
            across = outer * np.tan(step / 2)
            chord = box((near, -across, bottom), (outer, across, top))
            solids.append(_turned(chord, first + (i + 0.5) * step))
    if not upper:
        foot = at.MOUNT + at.PLATE
        solids += _lift_foot(foot)
    for solid in solids:
        yield _mirrored(solid) if upper else solid


def _mirrored(solid: Primitive) -> Primitive:
    """Return a solid that is symmetric in its own axes, mirrored in the plane of the guides."""
    center = solid.center * (1.0, 1.0, -1.0)
    flip = np.diag([1.0, 1.0, -1.0])
    # Mirroring turns one of the solid's axes round to stay a rotation; its own z serves.
    rotation = flip @ solid.rotation @ flip
    return Primitive(
        solid.kind, solid.size, solid.radius, solid.corners, rotation, center, solid.joint
    )


def _lift_foot(bottom: float) -> list[Primitive]:
    return [
        rod(size.FOOT_RADIUS, bottom, bottom + size.FOOT_HEIGHT),
        rod(size.FOOT_NECK_RADIUS, bottom, bottom + size.FOOT_NECK_HEIGHT),
    ]


def _cantilever_of_base(place: FrameLayout, upper: bool) -> list[Primitive]:
    low = at.MOUNT + size.CANTILEVER_RISE
    solids = _cantilever(place, low, *size.CANTILEVER)
    return [_upside_down(solid) for solid in solids] if upper else solids


def _upside_down(solid: Primitive) -> Primitive:
    """Return a solid turned over about the horizontal direction of the mast."""
    along = about_z(MAST_ANGLE)
    turn = along @ OVER @ along.T
    return solid.moved(np.zeros(3), turn)


def _cantilever(
    place: FrameLayout, low: float, start: float, inner: tuple[float, float],
    outer: tuple[float, float],
) -> list[Primitive]:  # fmt: skip
    end = place.mast_radius - MAST[0] / 2 + size.CANTILEVER_INTO_MAST
    side = np.array([(start, low), (end, low), (end, low + outer[1]), (start, low + inner[1])])
    arm = prism(side, -outer[0] / 2, outer[0] / 2, UPRIGHT)
    thick, wide, high = size.FLANGE_PLATE
    x, half = end - 0.006, (outer[0] + wide) / 2
    flange = box((x - thick / 2, -half, low - high), (x + thick / 2, half, low + outer[1] + high))
    return [_turned(arm, MAST_ANGLE), _turned(flange, MAST_ANGLE)]


def _motor(base_radius: float, angle: float, upper: bool) -> Iterator[Primitive]:
    seat = at.MOUNT + at.PLATE
    first, last = size.CONNECTOR
    low, high = size.CONNECTOR_HEIGHTS
    half = size.CONNECTOR_WIDTH / 2
    for solid in (
        rod(size.MOTOR_RADIUS, seat, seat + at.MOTOR_HEIGHT + size.MOTOR_FACE),
        box((first, -half, seat + low), (last, half, seat + high)),
    ):
        there = _turned(solid, angle, polar(base_radius, angle))
        yield _mirrored(there) if upper else there


def _lift(g: Geometry, place: FrameLayout) -> Iterator[Primitive]:
    base, half = lift_motor_base(g), size.HEAD_WIDTH / 2
    yield rod(size.HEAD_RADIUS, base, base + size.HEAD_PLATE)
    yield box((-half, -half, base + 0.013), (half, half, base + at.LIFT_MOTOR_HEIGHT))
    extent = np.array(size.HEAD_CONNECTOR)
    x, y, z = size.HEAD_CONNECTOR_AT
    middle = np.array([x, y, base + z])
    yield box(middle - extent / 2, middle + extent / 2)
    if g.knee is KneeBranch.UPPER:
        foot = place.column_top + at.PLATE_OF_BRIDGE
        yield from _lift_foot(foot - 0.002)
        yield rod(at.CYLINDER_RADIUS + 0.0015, foot, foot + cylinder_length(place))


def _column(place: FrameLayout, upper: bool) -> Iterator[Primitive]:
    """Yield what guides M4's carriage: screw and rods, or the bridge that the ram runs through."""
    if upper:
        yield rod(size.BRIDGE_RADIUS, place.column_top, place.column_top + at.PLATE_OF_BRIDGE)
        low = place.column_top + size.CANTILEVER_RISE
        yield from _cantilever(place, low, *size.BRIDGE_CANTILEVER)
        return
    low, high = column_heights(place)
    yield rod(at.SCREW_RADIUS, low, high)
    for angle in at.ROD_ANGLES:
        yield rod(at.ROD_RADIUS, low, high, polar(at.ROD_CIRCLE, angle))


def _mast(place: FrameLayout) -> Iterator[Primitive]:
    low, top, where = place.ground, place.mast_top, polar(place.mast_radius, MAST_ANGLE)
    more, above = size.MAST_CAP
    shapes = (
        (size.MAST_FOOT[:2], low, low + size.MAST_FOOT[2]),
        (size.MAST_SLEEVE[:2], low, low + size.MAST_SLEEVE[2]),
        (MAST, low + size.MAST_START, top),
        ((MAST[0] + more, MAST[1] + more), top - 0.001, top + above),
    )
    for (depth, width), bottom, end in shapes:
        solid = box((-depth / 2, -width / 2, bottom), (depth / 2, width / 2, end))
        yield _turned(solid, MAST_ANGLE, where)


def moving_bodies(design: Design) -> Iterator[Body]:
    """Yield M4's carriage, its arms, the platform and the payload."""
    g, half = design.geometry, at.CARRIAGE_HALF
    below, above = size.CARRIAGE_COLLAR
    carriage = [
        rod(size.CARRIAGE_RADIUS, -half - size.CARRIAGE_CAP, half + size.CARRIAGE_CAP),
        rod(size.CARRIAGE_COLLAR_RADIUS, -half - below, half + above),
    ]
    if g.knee is KneeBranch.UPPER:
        place = layout(g)
        ram = place.column_top - place.lift_low
        below, above = size.RAM_COLLAR
        carriage.append(rod(at.RAM_RADIUS, half, half + ram + size.RAM_BEYOND))
        carriage.append(rod(size.RAM_COLLAR_RADIUS, -half - below, half + above))
    yield Body("carriage", "M4’s carriage", "carriage", BodyPart.CARRIAGE, 0, tuple(carriage))
    for leg, angle in enumerate(AXIS_ANGLES, 1):
        solids = tuple(_turned(solid, float(angle)) for solid in _arm(g.base_radius, g.arm_length))
        yield Body(
            "arm", f"arm B1 of leg {leg}", "carriage", BodyPart.CARRIAGE, leg, solids, "carriage"
        )
    yield Body(
        "platform",
        "the platform",
        "platform",
        BodyPart.PLATFORM,
        0,
        tuple(_platform(g)),
        joints=(5,),
    )
    mass = design.payload.mass
    if mass > 0:
        scale, (x, y, top) = payload_scale(mass), payload_offset(g)
        height = PAYLOAD_HEIGHT * scale
        low, high = (top - height, top) if g.knee is KneeBranch.LOWER else (top, top + height)
        drum = rod(height / size.PAYLOAD_RATIO, low, high, (x, y, 0.0))
        yield Body("payload", "the payload", "platform", BodyPart.PAYLOAD, 0, (drum,), "platform")


def _arm(tip: float, length: float) -> Iterator[Primitive]:
    """Yield arm B1 along x from the robot's axis, with the bearing of joint 2."""
    root, end = tip - length, tip - size.ARM_END
    start = min(max(root, 0.0), tip) - size.ARM_OVERLAP
    if root > size.CARRIAGE_RADIUS:
        width, height = size.ARM_NECK[0] / 2, size.ARM_NECK[1] / 2
        yield box((size.NECK_START, -width, -height), (root, width, height))
    if end > start:
        (width, first), (_, last) = size.ARM_ROOT, size.ARM_TIP
        side = taper(start, end, first, last, size.ARM_CHAMFER)
        yield prism(side, -width / 2, width / 2, UPRIGHT)
    half = at.ARM_BEARING_HALF + size.ARM_BEARING_CAP
    yield rod(size.ARM_BEARING_RADIUS, -half, half, (tip, 0.0, 0.0))


def _platform(g: Geometry) -> Iterator[Primitive]:
    """Yield plate, ring and flange of the platform."""
    top = g.platform_joint_height - at.PLATE_BELOW_5
    low = top - size.PLATE_THICKNESS
    yield prism(plate_corners(g.platform_radius), low, top)
    yield rod(size.PLATE_RING_RADIUS, top - 0.001, top + size.PLATE_RING)
    yield rod(size.FLANGE_RADIUS, low - size.FLANGE_DEPTH, low)
    yield rod(size.FLANGE_TIP_RADIUS, low - size.FLANGE_TIP_DEPTH, low)
