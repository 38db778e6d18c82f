"""Parts of fixed shape that belong to the actuators and the frame.

Each function returns one part in its own frame, stated in its docstring. Faces in a leg's or M4's
color carry the material "accent".
"""

from __future__ import annotations

import numpy as np

from paminsa_viz.meshes import layers as at
from paminsa_viz.meshes.part import MeshPart
from paminsa_viz.meshes.solids import (
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
    radius: float, height: float, count: int, size: float = 0.0032, start: float = 0.0
) -> MeshPart:
    """Return a circle of socket-head bolts about z, standing on ``height``."""
    part = MeshPart()
    for i in range(count):
        angle = start + 2 * np.pi * i / count
        where = (radius * np.cos(angle), radius * np.sin(angle), height)
        part.add("steel", moved(rod(size, 0.0, 0.0028, 0.0, 6), where))
    return part


def rotary_actuator() -> MeshPart:
    """Housing of M1..M3: a flat motor with a bore for the quill.

    Origin on the leg axis, on the face that lies on the base plate; +z away from the guides, the
    connector toward +x.
    """
    top = at.MOTOR_HEIGHT
    bore = at.QUILL_RADIUS + 0.0006
    profile = [
        (bore, 0.0),
        (0.065, 0.0),
        (0.065, 0.0055),
        (0.0635, 0.007),
        (0.056, 0.007),
        (0.056, 0.0145),
        (0.0535, 0.0148),
        (0.0535, 0.0190),
        (0.056, 0.0193),
        (0.056, top - 0.004),
        (0.052, top),
        (bore, top),
    ]
    part = MeshPart().add("body", revolve([*profile, profile[0]], 24))
    part.add("accent", tube(0.055, 0.0566, 0.0240, 0.0305, 0.0, 24))
    part.add("steel", tube(bore, 0.030, top - 0.001, top + 0.0012, 0.0, 16))
    part.join(bolts(0.0605, 0.007, 6, start=np.pi / 6))
    part.add("dark", box((0.022, 0.026, 0.018), (0.064, 0.0, 0.017), 0.003))
    gland = moved(rod(0.0055, 0.0, 0.014, 0.0, 8), (0.074, 0.0, 0.017), ALONG)
    return part.add("steel", gland)


def quill() -> MeshPart:
    """Return the hollow shaft that M1..M3 turn, with the block that holds the guide link.

    Origin on the leg axis at the height of the guides; +z toward the actuator, the guide link
    toward -x.
    """
    part = MeshPart()
    part.add("steel", tube(at.QUILL_BORE, at.QUILL_RADIUS, -0.016, at.QUILL_TOP - 0.004, 0.0, 12))
    part.add("body", tube(at.QUILL_BORE, 0.026, at.QUILL_TOP - 0.0045, at.QUILL_TOP, 0.0, 16))
    half = at.CORE - 0.0005
    angle = np.linspace(-np.pi / 2, np.pi / 2, 5 if is_plain() else 9)
    nose = half * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    outline = np.vstack([nose, [[-0.024, half, 0.0], [-0.027, half - 0.003, 0.0]]])
    outline = np.vstack([outline, [[-0.027, 0.003 - half, 0.0], [-0.024, -half, 0.0]]])
    part.add("body", prism(outline, -0.019, 0.019, 0.002))
    part.add("dark", rod(0.0145, -0.0215, -0.0185, 0.0, 12))
    return part.add("accent", box((0.0065, 0.006, 0.0015), (0.021, 0.0, at.QUILL_TOP), 0.0))


def lift_carriage() -> MeshPart:
    """Return the carriage of M4; origin on the robot's axis at the height of the arms, +z up."""
    half = at.CARRIAGE_HALF
    part = MeshPart().add("accent", rod(0.042, -half, half, 0.003, 24))
    part.add("steel", rod(0.0165, half - 0.001, half + 0.008, 0.0, 14))
    part.add("steel", rod(0.0165, -half - 0.002, 0.001 - half, 0.0, 14))
    for angle in at.ROD_ANGLES:
        where = (at.ROD_CIRCLE * np.cos(angle), at.ROD_CIRCLE * np.sin(angle), 0.0)
        for side in (-1.0, 1.0):
            inner, outer = sorted((side * (half - 0.001), side * (half + 0.003)))
            part.add("dark", moved(rod(0.0098, inner, outer, 0.0, 10), where))
    return part


def lift_foot() -> MeshPart:
    """Return the flange at the foot of M4's column; origin on the plate it stands on, +z up."""
    profile = [(0.052, 0.0), (0.052, 0.006), (0.050, 0.008), (0.0385, 0.009)]
    profile += [(0.0385, 0.018), (0.037, 0.0195), (0.0, 0.0195)]
    return (
        MeshPart().add("body", revolve(profile, 22)).join(bolts(0.0465, 0.0082, 6, start=np.pi / 6))
    )


def lift_motor() -> MeshPart:
    """Head of M4: end plate, coupling and motor; origin under the end plate, +z up."""
    part = MeshPart().add("body", rod(0.042, 0.0, 0.014, 0.002, 22))
    part.join(bolts(0.0362, 0.014, 6, start=0.0))
    body = prism(rounded_rectangle(0.054, 0.054, 0.010, steps=4), 0.018, 0.092, 0.002)
    part.add("body", rod(0.024, 0.013, 0.019, 0.0, 24), body)
    ring = prism(rounded_rectangle(0.0552, 0.0552, 0.0105, steps=4), 0.058, 0.067, 0.0)
    part.add("accent", ring)
    cap = prism(rounded_rectangle(0.048, 0.048, 0.010, steps=4), 0.091, 0.104, 0.004)
    part.add("dark", cap, box((0.018, 0.016, 0.016), (0.0, 0.033, 0.079), 0.002))
    return part


def mast_foot() -> MeshPart:
    """Return the foot of the mast; origin on the ground in the mast's middle, +z up."""
    plate = prism(rounded_rectangle(0.170, 0.150, 0.022, steps=4), 0.0, 0.010, 0.002)
    part = MeshPart().add("body", plate)
    sleeve = prism(rounded_rectangle(0.106, 0.082, 0.016, steps=3), 0.009, 0.042, 0.002)
    part.add("body", sleeve)
    for x in (-0.068, 0.068):
        for y in (-0.058, 0.058):
            part.add("steel", moved(rod(0.0075, 0.009, 0.0155, 0.001, 6), (x, y, 0.0)))
    return part
