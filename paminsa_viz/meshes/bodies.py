"""The moving bodies, made to the design's lengths out of fixed parts and tubes.

`make_body` gives any body by its name in its own frame (see `paminsa_viz.dimensions.placement`);
`lengths_of` gives the lengths it depends on, so that a viewer rebuilds changed bodies only.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from itertools import pairwise
from typing import Final

import numpy as np
import trimesh

from paminsa_viz import palette
from paminsa_viz.checks import kinds_checked
from paminsa_viz.dimensions import fixed_parts as size
from paminsa_viz.dimensions import layers as at
from paminsa_viz.dimensions.body_scale import geometry_over_scale
from paminsa_viz.dimensions.layout import FrameLayout, layout, plinth_radius, polar
from paminsa_viz.dimensions.placement import BODIES
from paminsa_viz.errors import InvalidInput, name_hint
from paminsa_viz.kept import kept
from paminsa_viz.meshes import frame
from paminsa_viz.meshes.part import MeshPart, fixed_part
from paminsa_viz.meshes.solids import (
    ACROSS,
    ALONG,
    Array,
    beam,
    box,
    is_plain,
    loft,
    moved,
    plain_shapes,
    prism,
    rod,
    rounded_polygon,
    tube,
    turn,
)
from paminsa_viz.model.arguments import of_geometry
from paminsa_viz.model.design import Geometry, KneeBranch
from paminsa_viz.model.kinematics import AXIS_ANGLES

STANDING: Final = ("ground", "base", "m1", "m2", "m3", "m4")
"""Names of the bodies that do not move."""

SMALL: Final = 0.028
"""Pieces smaller than this are left out of plain bodies [m]."""


@kinds_checked
def color_of(body: str) -> str:
    """Return the color (``#rrggbb``) of a body's colored faces.

    Raises:
        InvalidInput: If there is no such body.
    """
    _kind(body)
    if body.startswith("leg"):
        return palette.LEG_COLORS[int(body[3]) - 1]
    if body in STANDING[2:]:
        return palette.ACTUATOR_COLORS[int(body[1]) - 1]
    return palette.LIFT_COLOR if body == "carriage" else palette.PLATFORM


@of_geometry
def lengths_of(geometry: Geometry, body: str) -> tuple[object, ...]:
    """Return the lengths that decide a body's shape; equal tuples mean an equal shape.

    Raises:
        InvalidInput: If there is no such body.
    """
    g, scale = geometry_over_scale(geometry), geometry.body_scale
    place = layout(g)
    ram = place.column_top - place.lift_low if g.knee is KneeBranch.UPPER else 0.0
    heights = (place.ground, place.mast_top, place.column_top)
    depends: dict[str, tuple[object, ...]] = {
        "ground": (place.ground, place.mast_radius, plinth_radius(g)),
        "base": (g.base_radius, place.mast_radius, *heights, g.knee),
        **dict.fromkeys(("m1", "m2", "m3"), (g.base_radius, g.knee)),
        "m4": (place.column_top, place.lift_high - place.lift_low, g.knee),
        "carriage": (g.base_radius, g.arm_length, ram),
        "platform": (g.platform_radius, g.platform_joint_height),
        "guide": (g.guide_link_length, g.knee),
        "shaft": (g.shaft_length,),
        "slider": (),
        "swivel": (),
        "b3": (g.crank_length, g.magnification),
        "b4": (g.coupler_length, g.magnification),
        "b7": ("b7", g.short_coupler_length),
        "b8": ("b8", g.crank_length),
    }
    lengths = depends[_kind(body)]
    return lengths if scale == 1.0 else (*lengths, f"times {scale!r}")


@of_geometry
def make_body(geometry: Geometry, body: str) -> MeshPart:
    """Return a body by its name, in its own frame [m]; standing bodies in the world frame.

    Raises:
        InvalidInput: If there is no such body.
    """
    kind, scale = _kind(body), geometry.body_scale
    if scale != 1.0:
        return make_body(geometry_over_scale(geometry), body).times(scale)
    if kind in STANDING:
        return standing_body(kind, geometry, layout(geometry), plinth_radius(geometry))
    return _made(_MOVING_MAKERS[kind], lengths_of(geometry, body), is_plain()).copy()


def standing_body(body: str, geometry: Geometry, place: FrameLayout, plinth: float) -> MeshPart:
    """Return a body that does not move, of the prototype's size, in the world frame [m].

    Args:
        body: One of `STANDING`.
        geometry: The radius of the base and the knee count.
        place: Heights and radii of the frame.
        plinth: Radius of the plinth.
    """
    radius, knee = geometry.base_radius, geometry.knee
    match body:
        case "ground":
            return frame.ground(plinth, place)
        case "base":
            return frame.base(radius, place, knee)
        case "m4":
            return frame.lift(place, knee)
    return frame.motor(int(body[1]) - 1, radius, knee)


@kept(64)
def _made(maker: Callable[..., MeshPart], lengths: tuple[object, ...], plain: bool) -> MeshPart:
    """Return a moving body; the three legs share it."""
    del plain  # only tells one from the other
    return maker(*lengths)


def _kind(body: str) -> str:
    """Return the kind of a body: the same for the three legs."""
    if body not in BODIES and body not in STANDING:
        hint = name_hint(body, (*STANDING, *BODIES))
        raise InvalidInput("body", f"there is no {body!r:.60}; {hint}")
    return body.rpartition("/")[2]


def pin(low: float, high: float, heads: tuple[bool, bool] = (True, True)) -> MeshPart:
    """Return a joint pin across the leg plane from ``low`` to ``high`` [m].

    Heads protrude; an end without one is flush, where another body passes close by.
    """
    part = MeshPart().add("steel", moved(rod(at.PIN_RADIUS, low, high, 0.0, 8), rotation=ACROSS))
    for side, end, headed in ((-1.0, low, heads[0]), (1.0, high, heads[1])):
        if headed:
            head = end + side * at.PIN_HEAD
            outer = rod(size.COLLAR_RADIUS, end - side * 0.0002, head, 0.0, 10)
            socket = rod(0.0048, head - side * 0.001, head + side * 0.0002, 0.0, 4)
            part.add("steel", moved(outer, rotation=ACROSS))
            part.add("dark", moved(socket, rotation=ACROSS))
    return part


def collar(low: float, high: float) -> trimesh.Trimesh:
    """Return a spacer on a pin across the leg plane."""
    return moved(rod(size.COLLAR_RADIUS, low, high, 0.0, 10), rotation=ACROSS)


def bar(layer: str, length: float, middle: float | None = None) -> MeshPart:
    """Return a bar along +x with barrels at 0, at ``length`` and, if given, at ``middle`` [m].

    The bar is drawn at its layer's offset across the leg plane; its origin lies on the plane.
    """
    radius = at.TUBE_RADIUS[layer]
    stops = [0.0, length] if middle is None else [0.0, middle, length]
    part = MeshPart()
    if length > 2 * 0.014:
        part.add("accent", moved(rod(radius, 0.014, length - 0.014, 0.0, 12), rotation=ALONG))
    for stop in stops:
        part.join(fixed_part("barrel").moved((stop, 0.0, 0.0)))
    gaps = [high - low for low, high in pairwise(stops)]
    for i, stop in enumerate(stops):
        if i < len(gaps) and gaps[i] > size.SOCKETS_FROM:
            part.join(fixed_part("bar_end").moved((stop, 0.0, 0.0)))
        if i > 0 and gaps[i - 1] > size.SOCKETS_FROM:
            part.join(fixed_part("bar_end").moved((stop, 0.0, 0.0), turn("z", np.pi)))
    return part.moved((0.0, at.LAYER[layer], 0.0))


def bar_b4(length: float, magnification: float) -> MeshPart:
    """Return bar B4 (joints 9-4-5) with the pins of 9 and 4; origin at 9, x toward 5."""
    to_4 = length / magnification
    part = bar("b4", length, to_4)
    (outside, near_b8), (near, _), (near_b3, far) = (at.span(b) for b in ("b8", "b4", "b3"))
    part.join(pin(outside, at.span("b4")[1])).add("steel", collar(near_b8, near))
    joint_4 = pin(near, far, (False, True)).add("steel", collar(at.span("b4")[1], near_b3))
    return part.join(joint_4.moved((to_4, 0.0, 0.0)))


def bar_b3(length: float, magnification: float) -> MeshPart:
    """Return bar B3 (joints 4-3-7) with the pin of 7; origin at 3, x toward 7."""
    to_3 = length * (1 - 1 / magnification)
    (near, near_b3), (far_b7, far) = at.span("b7"), at.span("b3")
    joint_7 = pin(near, far, (False, True)).add("steel", collar(near_b3, far_b7))
    part = bar("b3", length, to_3).join(joint_7.moved((length, 0.0, 0.0)))
    return part.moved((-to_3, 0.0, 0.0))


def shaft(length: float) -> MeshPart:
    """Return shaft B2 with the pin of joint 3; origin at 3, +z up to joint 2."""
    top = length + at.ARM_BEARING_HALF + 0.004
    part = fixed_part("shaft_end")
    part.add("steel", splined(at.SHAFT_RADIUS, size.SHAFT_LOW, top))
    return part.join(fixed_part("shaft_nut").moved((0.0, 0.0, length)))


def splined(radius: float, bottom: float, top: float) -> trimesh.Trimesh:
    """Return a shaft with six shallow grooves along z, which show that it turns."""
    if is_plain():
        return rod(radius, bottom, top)
    angle = 2 * np.pi * np.arange(24) / 24
    depth = np.where(np.arange(24) % 6 == 0, 0.0016, 0.0)
    flat = (radius - depth)[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)

    def level(height: float) -> Array:
        return np.hstack([flat, np.full((24, 1), height)])

    return loft([level(bottom), level(top)])


def guide(length: float, knee: KneeBranch) -> MeshPart:
    """Return guide link B10 with the quill that M1..M3 turn; origin on the leg axis, link to -x."""
    part = fixed_part("quill")
    if knee is KneeBranch.UPPER:
        part = part.moved(rotation=turn("x", np.pi))
    rail = beam(size.RAIL_START, length - 0.001, (0.022, 0.021), (0.022, 0.021), 0.002, 0.0005)
    part.add("body", moved(rail, rotation=turn("z", np.pi)))
    for side in (-1.0, 1.0):
        strip = box((max(length - 0.045, 0.01), 0.003, 0.007), chamfer=0.0)
        part.add("steel", moved(strip, (-(length + 0.015) / 2, side * 0.0112, 0.0)))
    part.add("accent", box(size.STOP, (-length - size.STOP[0] / 2, 0.0, 0.0), 0.002))
    return part


def carriage(base_radius: float, arm_length: float, ram: float) -> MeshPart:
    """Return M4's carriage with the arms B1 and the bearings of joint 2; origin on the axis."""
    part = fixed_part("lift_carriage")
    tip = base_radius
    root = tip - arm_length
    for angle in AXIS_ANGLES:
        spin = turn("z", angle)
        start = min(max(root, 0.0), tip) - size.ARM_OVERLAP
        if root > size.CARRIAGE_RADIUS:
            # The arm begins further out than the carriage is wide: a neck bridges the rest.
            part.add(
                "body",
                moved(beam(size.NECK_START, root, size.ARM_NECK, size.ARM_NECK), rotation=spin),
            )
        if tip - size.ARM_END > start:
            arm = beam(
                start, tip - size.ARM_END, size.ARM_ROOT, size.ARM_TIP, 0.006, size.ARM_CHAMFER
            )
            part.add("accent", moved(arm, rotation=spin))
        part.join(fixed_part("arm_bearing").moved(polar(tip, angle)))
    if ram:
        top = at.CARRIAGE_HALF + ram + size.RAM_BEYOND
        part.add("steel", rod(at.RAM_RADIUS, at.CARRIAGE_HALF, top, 0.001, 22))
        radius, (below, above) = size.RAM_COLLAR_RADIUS, size.RAM_COLLAR
        half = at.CARRIAGE_HALF
        part.add("body", rod(radius, half - 0.001, half + above, 0.002, 24))
        part.add("body", rod(radius, -half - below, 0.001 - half, 0.002, 24))
    return part


def platform(radius: float, joint_height: float) -> MeshPart:
    """Return the platform without its swivels; origin at the paper's point P of the platform."""
    top = joint_height - at.PLATE_BELOW_5
    corners = np.array([polar(radius, a)[:2] for a in sorted(AXIS_ANGLES)])
    outline = rounded_polygon(corners, size.PLATE_CORNER, 0.0, 3 if is_plain() else 8)
    part = MeshPart()
    plate = prism(outline, top - size.PLATE_THICKNESS, top, 0.0016)
    part.add("platform", plate)
    part.add(
        "body", tube(0.016, size.PLATE_RING_RADIUS, top - 0.001, top + size.PLATE_RING, 0.0, 28)
    )
    return part.join(fixed_part("tool_flange").moved((0.0, 0.0, top - size.PLATE_THICKNESS)))


def swivel() -> MeshPart:
    """Return the swivel of the platform; origin at joint 5."""
    return fixed_part("swivel_disc").join(fixed_part("swivel_head"))


_MOVING_MAKERS: Final[dict[str, Callable[..., MeshPart]]] = {
    "carriage": carriage, "platform": platform, "guide": guide, "shaft": shaft,
    "slider": partial(fixed_part, "slider"),
    "swivel": swivel, "b3": bar_b3, "b4": bar_b4, "b7": bar, "b8": bar,
}  # fmt: skip
"""Makers of bodies by kind; those of moving bodies take what `lengths_of` returns."""


@of_geometry
@kept(256)
def body_glb(geometry: Geometry, body: str, *, fine: bool = True) -> bytes:
    """Return a body as a colored GLB in its own frame, z up; the last ones made are kept.

    One that is not ``fine`` has a quarter of the triangles, no bolts and pins, round sides of few
    faces, and its colors at its points instead of a mesh for each.
    """
    if fine:
        return make_body(geometry, body).glb(color_of(body))
    with plain_shapes():
        part = make_body(geometry_over_scale(geometry), body).without_small(SMALL)
        return part.times(geometry.body_scale).glb(color_of(body), plain=True)


def ground_glb(geometry: Geometry, *, dark: bool) -> bytes:
    """Return the ground as a GLB in the world frame, light or for a dark page."""
    if not dark:
        return body_glb(geometry, "ground", fine=False)
    with plain_shapes():
        return make_body(geometry, "ground").renamed("dark").glb(plain=True)


@of_geometry
def prepare(geometry: Geometry, *, fine: bool) -> None:
    """Make and keep every body's GLB, plain or fine, so that no scene need wait for them."""
    for body in (*STANDING, *BODIES):
        body_glb(geometry, body, fine=fine)
