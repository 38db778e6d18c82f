"""Parts of fixed shape that belong to the joints, the platform and the payload.

Each function returns one part in its own frame, stated in its docstring. Faces in a leg's or M4's
color carry the material "accent".
"""

from __future__ import annotations

import numpy as np

from paminsa_viz.meshes import layers as at
from paminsa_viz.meshes.bodies import collar, pin
from paminsa_viz.meshes.load import PAYLOAD_HEIGHT
from paminsa_viz.meshes.part import MeshPart
from paminsa_viz.meshes.solids import (
    ACROSS,
    ALONG,
    box,
    moved,
    prism,
    revolve,
    rod,
    rounded_rectangle,
)


def barrel() -> MeshPart:
    """Return the bearing barrel at a joint of a bar; origin in its middle, its axis along y."""
    half, radius = at.BARREL / 2, at.BARREL_RADIUS
    part = MeshPart().add("steel", moved(rod(radius, -half, half, 0.0, 14), rotation=ACROSS))
    for side in (-1.0, 1.0):
        inner, outer = sorted((side * (half - 0.001), side * (half + 0.0004)))
        part.add("dark", moved(rod(0.0125, inner, outer, 0.0, 8), rotation=ACROSS))
    return part


def bar_end() -> MeshPart:
    """Return the socket between a barrel and a tube.

    Origin in the middle of the barrel, the tube toward +x. It is scaled to nothing: tubes of every
    bar fit into it.
    """
    profile = [(0.0130, 0.010), (0.0135, 0.0290)]
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
    """Return the head at the foot of shaft B2 with the pin of joint 3, which carries B3.

    Origin at joint 3, +z up the shaft, y across the leg plane.
    """
    part = MeshPart()
    block = prism(rounded_rectangle(0.032, 2 * at.CORE - 0.001, 0.007), -0.0175, 0.019, 0.003)
    part.add("body", block)
    part.add(
        "body", revolve([(0.0155, 0.0185), (0.0155, 0.024), (0.0125, 0.031), (0.0, 0.031)], 14)
    )
    part.add("accent", rod(0.0158, 0.0195, 0.0225, 0.0, 14))
    low, high = at.span("b3")
    part.join(pin(-at.CORE + 0.0005, high))
    return part.add("steel", collar(at.CORE - 0.001, low))


def arm_bearing() -> MeshPart:
    """Return the bearing of joint 2 at the tip of an arm; origin at joint 2, +z up."""
    half = at.ARM_BEARING_HALF
    part = MeshPart().add("accent", rod(0.0265, -half, half, 0.003, 16))
    for side in (-1.0, 1.0):
        inner, outer = sorted((side * (half - 0.001), side * (half + 0.0006)))
        part.add("dark", rod(0.0205, inner, outer, 0.0, 14))
        inner, outer = sorted((side * (half - 0.001), side * (half + 0.0012)))
        part.add("steel", rod(0.0145, inner, outer, 0.0, 12))
    return part


def shaft_nut() -> MeshPart:
    """Return the nut and collar that hold shaft B2 in joint 2; origin at joint 2, +z up."""
    half = at.ARM_BEARING_HALF + 0.0012
    part = MeshPart().add("steel", rod(0.0138, half, half + 0.008, 0.0, 6))
    part.add("dark", rod(0.0102, half + 0.008, half + 0.0105, 0.0, 12))
    return part.add("steel", rod(0.0135, -half - 0.006, -half, 0.0, 14))


def swivel_disc() -> MeshPart:
    """Return the round foot of the swivel of joint 5, which looks the same however it is turned.

    Origin at joint 5, +z up.
    """
    floor = -at.PLATE_BELOW_5
    part = MeshPart().add("steel", rod(0.0175, floor - 0.0005, floor + 0.003, 0.0, 14))
    return part.add("accent", rod(0.0205, floor + 0.003, floor + 0.0068, 0.0, 18))


def swivel_head() -> MeshPart:
    """Return the head of the swivel of joint 5 on the platform, with the pin that carries B4.

    Origin at joint 5, x and y along and across the leg plane; it turns about its z axis.
    """
    floor = -at.PLATE_BELOW_5
    low, high = at.span("b4")
    half = low - 0.004
    # An upright cheek with a round head, its outline in (x, -z), its thickness along y.
    cheek = np.array([[x, y, 0.0] for x, y in _cheek(0.0115, -(floor + 0.006), 0.0125)])
    part = MeshPart().add("body", moved(prism(cheek, -half, half, 0.002), rotation=ACROSS))
    part.join(pin(-half, high))
    return part.add("steel", collar(half - 0.001, low))


def _cheek(radius: float, depth: float, foot: float) -> list[tuple[float, float]]:
    """Outline of an upright: a half disc of ``radius`` on a foot ``depth`` away."""
    angle = np.pi + np.pi * np.arange(9) / 8
    arc = [(radius * np.cos(a), radius * np.sin(a)) for a in angle]
    return [*arc, (foot, depth), (-foot, depth)]


def tool_flange() -> MeshPart:
    """Return the flange in the middle of the platform; origin on the plate's lower face, +z up."""
    part = MeshPart().add("body", rod(0.032, -0.009, 0.001, 0.0015, 24))
    part.add("steel", rod(0.0215, -0.0115, -0.0085, 0.0, 20))
    return part


def payload() -> MeshPart:
    """Return a load of 1 kg at `LOAD_DENSITY`; origin in the middle of its upper face, +z up."""
    height = PAYLOAD_HEIGHT
    radius = height / 1.25
    part = MeshPart()
    groove = [(0.955, 0.36), (0.955, 0.30)]
    side = [(0.94, 0.0), (1.0, 0.05), (1.0, 0.30)]
    profile = [(r * radius, -height + h * height) for r, h in side]
    profile += [(r * radius, -height + h * height) for r, h in reversed(groove)]
    profile += [(1.0 * radius, -height * 0.64), (1.0 * radius, -height * 0.06)]
    profile += [(0.94 * radius, 0.0)]
    return part.add("load", revolve(profile, 36))
