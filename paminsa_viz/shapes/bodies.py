"""The moving bodies, made to the design's lengths out of fixed parts and tubes.

`make_body` gives any body by its name in its own frame (see `paminsa_viz.shapes.placement`);
`lengths_of` tells which lengths it depends on, so that a viewer rebuilds only what changed.
"""

from __future__ import annotations

from functools import lru_cache
from itertools import pairwise
from typing import Final

import numpy as np
import trimesh

from paminsa_viz import palette
from paminsa_viz.model.design import Assembly, Geometry
from paminsa_viz.model.kinematics import AXIS_ANGLES
from paminsa_viz.shapes import frame
from paminsa_viz.shapes import layers as at
from paminsa_viz.shapes.joint_parts import PAYLOAD_HEIGHT, pin
from paminsa_viz.shapes.layout import layout
from paminsa_viz.shapes.library import fixed_part
from paminsa_viz.shapes.part import Part
from paminsa_viz.shapes.placement import BODIES
from paminsa_viz.shapes.solids import (
    ACROSS,
    ALONG,
    Array,
    beam,
    box,
    loft,
    moved,
    prism,
    rod,
    rounded_polygon,
    tube,
    turn,
)

STANDING: Final = ("ground", "base", "m1", "m2", "m3", "m4")
"""Names of the bodies that do not move."""

ACTUATOR_NAMES: Final = ("m1", "m2", "m3", "m4")


def colour_of(body: str) -> str:
    """Return the colour (``#rrggbb``) of a body's coloured faces."""
    if body.startswith("leg"):
        return palette.LEG_COLOURS[int(body[3]) - 1]
    if body in ACTUATOR_NAMES:
        return palette.ACTUATOR_COLOURS[int(body[1]) - 1]
    return palette.LIFT_COLOUR if body == "carriage" else palette.PLATFORM


def lengths_of(
    body: str, geometry: Geometry, assembly: Assembly = Assembly.PRINTED
) -> tuple[object, ...]:
    """Return what a body's shape depends on; equal tuples mean an equal shape.

    Raises:
        KeyError: If there is no such body.
    """
    g = geometry
    if body in STANDING:
        return (layout(g, assembly), g.base_radius, assembly)
    if body == "carriage":
        place = layout(g, assembly)
        ram = place.lift_high - place.lift_low if assembly is Assembly.MIRROR else 0.0
        return (g.base_radius, g.arm_length, ram)
    if body == "platform":
        return (g.platform_radius, g.platform_joint_height)
    kind = body.partition("/")[2] if body in BODIES else body
    depends: dict[str, tuple[object, ...]] = {
        "guide": (g.guide_link_length, assembly),
        "shaft": (g.shaft_length,),
        "slider": (),
        "swivel": (),
        "b3": (g.crank_length, g.magnification),
        "b4": (g.coupler_length, g.magnification),
        "b7": (g.short_coupler_length,),
        "b8": (g.crank_length,),
    }
    return depends[kind]


def make_body(body: str, geometry: Geometry, assembly: Assembly = Assembly.PRINTED) -> Part:
    """Return a body by its name, in its own frame [m]; standing bodies in the world frame.

    Raises:
        KeyError: If there is no such body.
    """
    g = geometry
    if body == "ground":
        return frame.ground(g, assembly)
    if body == "base":
        return frame.base(g, assembly)
    if body in ACTUATOR_NAMES:
        return frame.actuators(g, assembly)[ACTUATOR_NAMES.index(body)][0]
    if body == "carriage":
        return carriage(g, assembly)
    if body == "platform":
        return platform(g)
    kind = body.partition("/")[2] if body in BODIES else ""
    if kind in ("slider", "swivel"):
        return fixed_part(kind)
    if kind == "guide":
        return guide(g, assembly)
    if kind == "shaft":
        return shaft(g)
    if kind == "b3":
        return bar_b3(g)
    if kind == "b4":
        return bar_b4(g)
    if kind in ("b7", "b8"):
        return bar(kind, g.short_coupler_length if kind == "b7" else g.crank_length)
    raise KeyError(body)


def bar(layer: str, length: float, middle: float | None = None) -> Part:
    """Return a bar along +x with barrels at 0, at ``length`` and, if given, at ``middle`` [m].

    The bar is drawn at its layer's offset across the leg plane; its origin lies on the plane.
    """
    radius = at.TUBE_RADIUS[layer]
    stops = [0.0, length] if middle is None else [0.0, middle, length]
    part = Part()
    socket = 0.014
    if length > 2 * socket:
        part.add("accent", moved(rod(radius, socket, length - socket, 0.0005, 24), rotation=ALONG))
    for stop in stops:
        part.join(fixed_part("barrel").moved((stop, 0.0, 0.0)))
    gaps = [high - low for low, high in pairwise(stops)]
    for i, stop in enumerate(stops):
        if i < len(gaps) and gaps[i] > 0.062:
            part.join(fixed_part("bar_end").moved((stop, 0.0, 0.0)))
        if i > 0 and gaps[i - 1] > 0.062:
            part.join(fixed_part("bar_end").moved((stop, 0.0, 0.0), turn("z", np.pi)))
    return part.moved((0.0, at.LAYER[layer], 0.0))


def bar_b4(geometry: Geometry) -> Part:
    """Return bar B4 (joints 9-4-5) with the pins of 9 and 4; origin at 9, x toward 5."""
    at_4 = geometry.coupler_length / geometry.magnification
    part = bar("b4", geometry.coupler_length, at_4)
    low, high = at.span("b4")
    part.join(pin_with_collar(at.span("b8")[0], high, (at.span("b8")[1], low)))
    crossing = pin_with_collar(low, at.span("b3")[1], (high, at.span("b3")[0]))
    return part.join(crossing.moved((at_4, 0.0, 0.0)))


def bar_b3(geometry: Geometry) -> Part:
    """Return bar B3 (joints 4-3-7) with the pin of 7; origin at 3, x toward 7."""
    length = geometry.crank_length
    to_3 = length * (1 - 1 / geometry.magnification)
    part = bar("b3", length, to_3)
    crossing = pin_with_collar(
        at.span("b3")[0], at.span("b7")[1], (at.span("b3")[1], at.span("b7")[0])
    )
    return part.join(crossing.moved((length, 0.0, 0.0))).moved((-to_3, 0.0, 0.0))


def pin_with_collar(low: float, high: float, gap: tuple[float, float]) -> Part:
    """Return a pin from ``low`` to ``high`` across the plane with a spacer in the ``gap`` [m]."""
    spacer = rod(0.0098, gap[0] - 0.0002, gap[1] + 0.0002, 0.0003, 16)
    return pin(low, high).add("steel", moved(spacer, rotation=ACROSS))


def shaft(geometry: Geometry) -> Part:
    """Return shaft B2 with the pin of joint 3; origin at 3, +z up to joint 2."""
    top = geometry.shaft_length + at.ARM_BEARING_HALF + 0.004
    part = fixed_part("shaft_end")
    part.add("steel", splined(at.SHAFT_RADIUS, 0.02, top))
    return part.join(fixed_part("shaft_nut").moved((0.0, 0.0, geometry.shaft_length)))


def splined(radius: float, bottom: float, top: float) -> trimesh.Trimesh:
    """Return a shaft with six shallow grooves along z, which show that it turns."""
    angle = 2 * np.pi * np.arange(36) / 36
    depth = np.where(np.arange(36) % 6 == 0, 0.0016, 0.0)
    flat = (radius - depth)[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)

    def level(height: float) -> Array:
        return np.hstack([flat, np.full((36, 1), height)])

    return loft([level(bottom), level(top)])


def guide(geometry: Geometry, assembly: Assembly) -> Part:
    """Return guide link B10 with the quill that M1..M3 turn; origin on the leg axis, link to -x."""
    length = geometry.guide_link_length
    part = fixed_part("quill")
    if assembly is Assembly.MIRROR:
        part = part.moved(rotation=turn("x", np.pi))
    rail = beam(0.02, length - 0.001, (0.022, 0.021), (0.022, 0.021), 0.002, 0.0005)
    part.add("body", moved(rail, rotation=turn("z", np.pi)))
    for side in (-1.0, 1.0):
        strip = box((max(length - 0.045, 0.01), 0.003, 0.007), chamfer=0.0006)
        part.add("steel", moved(strip, (-(length + 0.015) / 2, side * 0.0112, 0.0)))
    part.add("accent", box((0.010, 0.034, 0.032), (-length - 0.005, 0.0, 0.0), 0.002))
    return part


def carriage(geometry: Geometry, assembly: Assembly) -> Part:
    """Return M4's carriage with the arms B1 and the bearings of joint 2; origin on the axis."""
    part = fixed_part("lift_carriage")
    tip = geometry.base_radius
    root = tip - geometry.arm_length
    for angle in AXIS_ANGLES:
        spin = turn("z", angle)
        start = min(max(root, 0.0), tip) - 0.006
        if root > 0.042:
            # The arm begins further out than the carriage is wide: a neck bridges the rest.
            part.add("body", moved(beam(0.03, root, (0.024, 0.026), (0.024, 0.026)), rotation=spin))
        if tip - 0.02 > start:
            arm = beam(start, tip - 0.02, (0.034, 0.048), (0.021, 0.026), 0.006, 0.002)
            part.add("accent", moved(arm, rotation=spin))
        part.join(fixed_part("arm_bearing").moved(frame.polar(tip, angle)))
    if assembly is Assembly.MIRROR:
        place = layout(geometry, assembly)
        top = at.CARRIAGE_HALF + place.column_top - place.lift_low + 0.02
        part.add("steel", rod(frame.RAM_RADIUS, at.CARRIAGE_HALF, top, 0.001, 36))
        part.add("body", rod(0.026, at.CARRIAGE_HALF - 0.001, at.CARRIAGE_HALF + 0.012, 0.002, 40))
        part.add("body", rod(0.026, -at.CARRIAGE_HALF - 0.004, 0.001 - at.CARRIAGE_HALF, 0.002, 40))
    return part


def platform(geometry: Geometry) -> Part:
    """Return the platform without its swivels; origin at the paper's point P of the platform."""
    top = geometry.platform_joint_height - at.PLATE_BELOW_5
    corners = np.array([frame.polar(geometry.platform_radius, a)[:2] for a in sorted(AXIS_ANGLES)])
    part = Part()
    plate = prism(rounded_polygon(corners, 0.025, steps=12), top - 0.010, top, 0.0016, 3)
    part.add("platform", plate)
    part.add("body", tube(0.016, 0.030, top - 0.001, top + 0.0025, 0.0008, 48))
    return part.join(fixed_part("tool_flange").moved((0.0, 0.0, top - 0.010)))


def leg_axis(geometry: Geometry, leg: int) -> tuple[float, float, float]:
    """Return where a leg's axis (index 0 to 2) crosses the plane of the guides [m]."""
    x, y, z = frame.polar(geometry.base_radius, AXIS_ANGLES[leg])
    return float(x), float(y), float(z)


@lru_cache(maxsize=256)
def body_glb(body: str, geometry: Geometry, assembly: Assembly = Assembly.PRINTED) -> bytes:
    """Return a body as a coloured GLB in its own frame, z up; the last ones made are kept."""
    return make_body(body, geometry, assembly).glb(colour_of(body))


@lru_cache(maxsize=1)
def payload_glb() -> bytes:
    """Return the payload of 1 kg as a GLB in its own frame."""
    return fixed_part("payload").glb()


def payload_scale(mass: float) -> float:
    """Return the size of the payload's mesh for a mass [kg]; its volume is in proportion."""
    return float(np.cbrt(max(mass, 0.0)))


def payload_offset(geometry: Geometry, assembly: Assembly) -> tuple[float, float, float]:
    """Return where the payload's upper face sits in the platform's frame [m].

    It hangs below the platform where the robot hangs, and stands on it in the mirror assembly
    (there the mesh is turned over).
    """
    top = geometry.platform_joint_height - at.PLATE_BELOW_5
    below = assembly is Assembly.PRINTED
    return (0.0, 0.0, top - 0.0215 if below else top + 0.0025)


def payload_transform(geometry: Geometry, assembly: Assembly, mass: float) -> Array:
    """Return the payload's size and place in the platform's frame as a matrix, (4, 4)."""
    over = assembly is Assembly.MIRROR
    out = np.eye(4)
    out[:3, :3] = payload_scale(mass) * (turn("x", np.pi) if over else np.eye(3))
    out[:3, 3] = payload_offset(geometry, assembly)
    return out


def payload_centre(geometry: Geometry, assembly: Assembly, mass: float) -> Array:
    """Return the middle of the payload in the platform's frame, (3,) [m]."""
    x, y, top = payload_offset(geometry, assembly)
    half = PAYLOAD_HEIGHT * payload_scale(mass) / 2
    return np.array([x, y, top - half if assembly is Assembly.PRINTED else top + half])
