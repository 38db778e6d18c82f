"""The parts of fixed shape: actuators and frame, joints, platform and payload.

Each function of `PARTS` returns a part in its own frame; its docstring says what the part is and
where its frame lies. Faces in a leg's or M4's color carry the material "accent".
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np

from paminsa_viz.dimensions import fixed_parts as size
from paminsa_viz.dimensions import layers as at
from paminsa_viz.dimensions.attached import PAYLOAD_HEIGHT
from paminsa_viz.meshes.bodies import collar, pin
from paminsa_viz.meshes.part import MeshPart
from paminsa_viz.meshes.solids import (
    ACROSS,
    ALONG,
    box,
    is_plain,
    moved,
    prism,
    revolve,
    rod,
    rounded_rectangle,
    tube,
)


def bolts(
    radius: float, height: float, count: int, head: float = 0.0032, start: float = 0.0
) -> MeshPart:
    """Return a circle of socket-head bolts about z, standing on ``height``."""
    part = MeshPart()
    for i in range(count):
        angle = start + 2 * np.pi * i / count
        where = (radius * np.cos(angle), radius * np.sin(angle), height)
        part.add("steel", moved(rod(head, 0.0, 0.0028, 0.0, 6), where))
    return part


def rotary_actuator() -> MeshPart:
    """Housing of M1 to M3: a flat motor with a bore for the quill.

    Origin on the leg axis, on the face that lies on the base plate; +z away from the guides, the
    connector toward +x.
    """
    top = at.MOTOR_HEIGHT
    bore, radius = at.QUILL_RADIUS + 0.0006, size.MOTOR_RADIUS
    profile = [
        (bore, 0.0), (radius, 0.0), (radius, 0.0055), (0.0635, 0.007), (0.056, 0.007),
        (0.056, 0.0145), (0.0535, 0.0148), (0.0535, 0.0190), (0.056, 0.0193), (0.056, top - 0.004),
        (0.052, top), (bore, top),
    ]  # fmt: skip
    part = MeshPart().add("body", revolve([*profile, profile[0]], 24))
    part.add("accent", tube(0.055, 0.0566, 0.0240, 0.0305, 0.0, 24))
    part.add("steel", tube(bore, 0.030, top - 0.001, top + size.MOTOR_FACE, 0.0, 16))
    part.join(bolts(0.0605, 0.007, 6, start=np.pi / 6))
    part.add("dark", box((0.022, size.CONNECTOR_WIDTH, 0.018), (0.064, 0.0, 0.017), 0.003))
    gland = moved(rod(0.0055, 0.0, 0.014, 0.0, 8), (0.074, 0.0, 0.017), ALONG)
    return part.add("steel", gland)


def quill() -> MeshPart:
    """Hollow shaft that M1 to M3 turn, with the block that holds the guide link.

    Origin on the leg axis at the height of the guides; +z toward the actuator, the guide link
    toward -x.
    """
    part = MeshPart()
    part.add("steel", tube(at.QUILL_BORE, at.QUILL_RADIUS, -0.016, at.QUILL_TOP - 0.004, 0.0, 12))
    low, top = at.QUILL_TOP - size.QUILL_COLLAR, at.QUILL_TOP
    part.add("body", tube(at.QUILL_BORE, size.QUILL_COLLAR_RADIUS, low, top, 0.0, 16))
    half = at.CORE - 0.0005
    angle = np.linspace(-np.pi / 2, np.pi / 2, 5 if is_plain() else 9)
    nose = half * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    outline = np.vstack([nose, [[-0.024, half, 0.0], [-0.027, half - 0.003, 0.0]]])
    outline = np.vstack([outline, [[-0.027, 0.003 - half, 0.0], [-0.024, -half, 0.0]]])
    part.add("body", prism(outline, -0.019, 0.019, 0.002))
    part.add("dark", rod(0.0145, size.QUILL_LOW, -0.0185, 0.0, 12))
    return part.add("accent", box((0.0065, 0.006, 0.0015), (0.021, 0.0, at.QUILL_TOP), 0.0))


def lift_carriage() -> MeshPart:
    """Carriage of M4; origin on the robot's axis at the height of the arms, +z up."""
    half, collar_radius = at.CARRIAGE_HALF, size.CARRIAGE_COLLAR_RADIUS
    below, above = size.CARRIAGE_COLLAR
    part = MeshPart().add("accent", rod(size.CARRIAGE_RADIUS, -half, half, 0.003, 24))
    part.add("steel", rod(collar_radius, half - 0.001, half + above, 0.0, 14))
    part.add("steel", rod(collar_radius, -half - below, 0.001 - half, 0.0, 14))
    for angle in at.ROD_ANGLES:
        where = (at.ROD_CIRCLE * np.cos(angle), at.ROD_CIRCLE * np.sin(angle), 0.0)
        for side in (-1.0, 1.0):
            cap = rod(0.0098, side * (half - 0.001), side * (half + size.CARRIAGE_CAP), 0.0, 10)
            part.add("dark", moved(cap, where))
    return part


def lift_foot() -> MeshPart:
    """Flange at the foot of M4's column; origin on the plate it stands on, +z up."""
    top = size.FOOT_NECK_HEIGHT
    profile = [
        (size.FOOT_RADIUS, 0.0),
        (size.FOOT_RADIUS, 0.006),
        (0.050, 0.008),
        (size.FOOT_NECK_RADIUS, 0.009),
    ]
    profile += [(size.FOOT_NECK_RADIUS, 0.018), (0.037, top), (0.0, top)]
    return (
        MeshPart().add("body", revolve(profile, 22)).join(bolts(0.0465, 0.0082, 6, start=np.pi / 6))
    )


def lift_motor() -> MeshPart:
    """Head of M4: end plate, coupling and motor; origin under the end plate, +z up."""
    part = MeshPart().add("body", rod(size.HEAD_RADIUS, 0.0, 0.014, 0.002, 22))
    part.join(bolts(0.0362, 0.014, 6, start=0.0))
    body = prism(rounded_rectangle(0.054, 0.054, 0.010, steps=4), 0.018, 0.092, 0.002)
    part.add("body", rod(0.024, 0.013, 0.019, 0.0, 24), body)
    ring = prism(
        rounded_rectangle(size.HEAD_WIDTH, size.HEAD_WIDTH, 0.0105, steps=4), 0.058, 0.067, 0.0
    )
    part.add("accent", ring)
    cap = prism(rounded_rectangle(0.048, 0.048, 0.010, steps=4), 0.091, at.LIFT_MOTOR_HEIGHT, 0.004)
    part.add("dark", cap, box(size.HEAD_CONNECTOR, size.HEAD_CONNECTOR_AT, 0.002))
    return part


def mast_foot() -> MeshPart:
    """Foot of the mast; origin on the ground in the mast's middle, +z up."""
    plate = prism(rounded_rectangle(*size.MAST_FOOT[:2], 0.022, steps=4), 0.0, 0.010, 0.002)
    part = MeshPart().add("body", plate)
    sleeve = prism(
        rounded_rectangle(*size.MAST_SLEEVE[:2], 0.016, steps=3), 0.009, size.MAST_SLEEVE[2], 0.002
    )
    part.add("body", sleeve)
    for x in (-0.068, 0.068):
        for y in (-0.058, 0.058):
            part.add("steel", moved(rod(0.0075, 0.009, size.MAST_FOOT[2], 0.001, 6), (x, y, 0.0)))
    return part


def barrel() -> MeshPart:
    """Bearing barrel at a joint of a bar; origin in its middle, its axis along y."""
    half, radius = at.BARREL / 2, at.BARREL_RADIUS
    part = MeshPart().add("steel", moved(rod(radius, -half, half, 0.0, 14), rotation=ACROSS))
    for side in (-1.0, 1.0):
        cap = rod(0.0125, side * (half - 0.001), side * (half + size.BARREL_CAP), 0.0, 8)
        part.add("dark", moved(cap, rotation=ACROSS))
    return part


def bar_end() -> MeshPart:
    """Socket between a barrel and a tube.

    Origin in the middle of the barrel, the tube toward +x. It is scaled to nothing: tubes of every
    bar fit into it.
    """
    profile = [(0.0130, size.SOCKET[0]), (size.SOCKET_RADIUS, size.SOCKET[1])]
    return MeshPart().add("steel", moved(revolve(profile, 10), rotation=ALONG))


def slider() -> MeshPart:
    """Slider with the pin of joint 8, which carries B8 on one side and B7 on the other.

    Origin at joint 8, x along the guide, y across the leg plane.
    """
    half = at.CORE
    part = MeshPart().add("body", box((2 * at.SLIDER_HALF - 0.008, 2 * half, 0.036), chamfer=0.003))
    for end in (-1.0, 1.0):
        wiper = box(
            (0.0042, 2 * half - 0.004, 0.033), (end * (at.SLIDER_HALF - 0.002), 0.0, 0.0), 0.0
        )
        part.add("dark", wiper)
    part.add("accent", box((0.022, 0.020, 0.003), (0.0, 0.0, 0.0175), 0.0))
    part.join(pin(at.span("b8")[0], at.span("b7")[1]))
    part.add("steel", collar(at.span("b8")[1], 0.001 - half))
    return part.add("steel", collar(half - 0.001, at.span("b7")[0]))


def shaft_end() -> MeshPart:
    """Head at the foot of shaft B2 with the pin of joint 3, which carries B3.

    Origin at joint 3, +z up the shaft, y across the leg plane.
    """
    part = MeshPart()
    block = prism(
        rounded_rectangle(size.SHAFT_BLOCK, 2 * at.CORE - 0.001, 0.007),
        *size.SHAFT_BLOCK_HEIGHTS,
        0.003,
    )
    part.add("body", block)
    part.add(
        "body",
        revolve(
            [
                (0.0155, 0.0185),
                (0.0155, 0.024),
                (0.0125, size.SHAFT_NECK_TOP),
                (0.0, size.SHAFT_NECK_TOP),
            ],
            14,
        ),
    )
    part.add("accent", rod(size.SHAFT_NECK_RADIUS, 0.0195, 0.0225, 0.0, 14))
    low, high = at.span("b3")
    part.join(pin(-at.CORE + 0.0005, high))
    return part.add("steel", collar(at.CORE - 0.001, low))


def arm_bearing() -> MeshPart:
    """Bearing of joint 2 at the tip of an arm; origin at joint 2, +z up."""
    half = at.ARM_BEARING_HALF
    part = MeshPart().add("accent", rod(size.ARM_BEARING_RADIUS, -half, half, 0.003, 16))
    for side in (-1.0, 1.0):
        part.add("dark", rod(0.0205, side * (half - 0.001), side * (half + 0.0006), 0.0, 14))
        part.add(
            "steel",
            rod(0.0145, side * (half - 0.001), side * (half + size.ARM_BEARING_CAP), 0.0, 12),
        )
    return part


def shaft_nut() -> MeshPart:
    """Nut and collar that hold shaft B2 in joint 2; origin at joint 2, +z up."""
    half = at.ARM_BEARING_HALF + 0.0012
    part = MeshPart().add("steel", rod(size.NUT_RADIUS, half, half + 0.008, 0.0, 6))
    part.add("dark", rod(0.0102, half + 0.008, size.NUT[1], 0.0, 12))
    return part.add("steel", rod(0.0135, size.NUT[0], -half, 0.0, 14))


def swivel_disc() -> MeshPart:
    """Round foot of the swivel of joint 5, which looks the same however it is turned.

    Origin at joint 5, +z up.
    """
    floor = -at.PLATE_BELOW_5
    part = MeshPart().add("steel", rod(0.0175, floor - 0.0005, floor + 0.003, 0.0, 14))
    return part.add(
        "accent",
        rod(size.SWIVEL_DISC_RADIUS, floor + 0.003, floor + size.SWIVEL_DISC_HEIGHT, 0.0, 18),
    )


def swivel_head() -> MeshPart:
    """Head of the swivel of joint 5 on the platform, with the pin that carries B4.

    Origin at joint 5, x and y along and across the leg plane; it turns about its z axis.
    """
    floor = -at.PLATE_BELOW_5
    low, high = at.span("b4")
    half, radius, width = low - size.CHEEK_GAP, size.SWIVEL_TOP, size.SWIVEL_HALF
    # An upright cheek, its outline in (x, -z), its thickness along y: a half disc on a foot.
    angle = np.pi + np.pi * np.arange(9) / 8
    arc = [(radius * np.cos(a), radius * np.sin(a), 0.0) for a in angle]
    depth = -(floor + 0.006)
    cheek = np.array([*arc, (width, depth, 0.0), (-width, depth, 0.0)])
    part = MeshPart().add("body", moved(prism(cheek, -half, half, 0.002), rotation=ACROSS))
    part.join(pin(-half, high))
    return part.add("steel", collar(half - 0.001, low))


def tool_flange() -> MeshPart:
    """Flange in the middle of the platform; origin on the plate's lower face, +z up."""
    part = MeshPart().add("body", rod(size.FLANGE_RADIUS, -size.FLANGE_DEPTH, 0.001, 0.0015, 24))
    part.add("steel", rod(size.FLANGE_TIP_RADIUS, -size.FLANGE_TIP_DEPTH, -0.0085, 0.0, 20))
    return part


def payload() -> MeshPart:
    """Load of 1 kg at `LOAD_DENSITY`; origin in the middle of its upper face, +z up."""
    height, radius = PAYLOAD_HEIGHT, PAYLOAD_HEIGHT / size.PAYLOAD_RATIO
    shape = [
        (0.94, 0.0), (1.0, 0.05), (1.0, 0.30), (0.955, 0.30), (0.955, 0.36), (1.0, 0.36),
        (1.0, 0.94), (0.94, 1.0),
    ]  # fmt: skip
    profile = [(r * radius, (h - 1) * height) for r, h in shape]
    return MeshPart().add("load", revolve(profile, 36))


PARTS: Final[tuple[Callable[[], MeshPart], ...]] = (
    rotary_actuator, quill, slider, barrel, bar_end, shaft_end, arm_bearing, shaft_nut,
    lift_carriage, lift_foot, lift_motor, swivel_disc, swivel_head, tool_flange, payload,
    mast_foot,
)  # fmt: skip
"""Makers of the parts that are kept as mesh files, which have their names."""
