"""The robot's bodies as one block of bytes, each with how its points move with the lengths.

For viewers that cannot make bodies: the points of a body are linear in a few lengths, so that it
can be stretched to others than those it was made for. Not linear are only arcs of the frame.
"""

from __future__ import annotations

import base64
from collections.abc import Callable
from dataclasses import fields, replace
from functools import partial
from typing import Any, Final, NamedTuple

import numpy as np

from paminsa_viz.dimensions.attached import payload_offset
from paminsa_viz.dimensions.body_scale import geometry_over_scale
from paminsa_viz.dimensions.fixed_parts import CARRIAGE_RADIUS
from paminsa_viz.dimensions.layout import FrameLayout, frame_lengths
from paminsa_viz.meshes import bodies, frame
from paminsa_viz.meshes.part import SURFACES, MeshPart, fixed_part, srgb_to_linear
from paminsa_viz.meshes.solids import Array, plain_shapes
from paminsa_viz.model.design import Geometry, KneeBranch
from paminsa_viz.model.leg import mechanism

STEP: Final = 0.02
"""Change of a length that shows how points move with it, as a share of it."""

LEAST_STEP: Final = 1e-3
"""Least change of a length [m]."""

DIGITS: Final = 7
"""Decimals of what a point moves by for 1 m of a length."""

GRAIN: Final = 1e-7
"""Step of the points' coordinates [m]."""

LONGEST: Final = 150.0
"""Length from which on the step grows, as coordinates are whole numbers of 32 bits [m]."""

TIE: Final = 1e-3
"""Moves what is to be rounded off the middle of two steps, where rounding errors would decide; as
a share of a step."""

MATERIALS: Final = tuple(SURFACES)
"""Materials by their numbers in `pack_bodies`."""


class _Shape(NamedTuple):
    """A body by the lengths that decide it, which its maker takes in this order.

    Attributes:
        names: The lengths' names in `body_lengths`.
        make: The maker.
        instead: Lengths that take the place of a robot's, for a shape that it may not have.
    """

    names: tuple[str, ...]
    make: Callable[..., MeshPart]
    instead: dict[str, float] | None = None


def pack_bodies(geometry: Geometry) -> dict[str, Any]:
    """Return the bodies with both knees and few faces, as data that can be written as JSON.

    They are of the prototype's size, for a robot of the lengths over the size of its bodies. Points
    count from the body's own frame, standing bodies' from the world frame.

    Returns:
        ``materials``: linear color, metallic, roughness, whether it is lit. ``bodies``: by name,
        with the ending ``.lower`` or ``.upper`` where the knee decides. Each has the ``names`` of
        its lengths and the values ``at`` which it was made [m], the numbers of its ``points`` and
        ``faces``, and ``moves``: for each group of points and each length what a point moves by
        (x, y, z) for 1 m. ``grain``: step of the points' coordinates [m]. ``block``: all bodies
        one after the other in base64, little-endian: points (n, 3) int32, normals (n, 3) int8,
        materials (n,) uint8, groups (n,) uint8, faces (m, 3) uint16, each array filled up to
        4 bytes. Carriages with the ending ``.neck`` are for arms that begin beyond ``neck`` [m].
        ``payload``: the payload's height over the joints of the platform by knee [m].
    """
    packed, blocks = {}, []
    of_knee = {knee: geometry_over_scale(replace(geometry, knee=knee)) for knee in KneeBranch}
    longest = max(abs(one) for each in of_knee.values() for one in body_lengths(each).values())
    grain = GRAIN * max(1.0, longest / LONGEST)
    with plain_shapes():
        for name, knee, shape in _shapes():
            body = of_knee[geometry.knee if knee is None else knee]
            packed[name], block = _packed(shape, body, grain)
            blocks.append(block)
    return {
        "materials": {
            name: [*(round(v, 4) for v in srgb_to_linear(s.color)), s.metallic, s.roughness, s.lit]
            for name, s in SURFACES.items()
        },
        "bodies": packed,
        "grain": grain,
        "neck": CARRIAGE_RADIUS,
        "payload": {
            knee.value: round(payload_offset(each)[2] - each.platform_joint_height, 6)
            for knee, each in of_knee.items()
        },
        "block": base64.b64encode(b"".join(blocks)).decode("ascii"),
    }


def _shapes() -> list[tuple[str, KneeBranch | None, _Shape]]:
    """Return the bodies' names, their knees if these decide, and their shapes.

    M2 and M3 are M1 at other legs, and all legs are alike.
    """
    found: list[tuple[str, KneeBranch | None, _Shape]] = [
        (name, None, shape)
        for name, shape in {
            "ground": _Shape(("plinth_radius", *_MAST[:2]), _ground),
            "platform": _Shape(("platform_radius", "joint_height"), bodies.platform),
            "payload": _Shape((), partial(fixed_part, "payload")),
            "shaft": _Shape(("shaft",), bodies.shaft),
            "slider": _Shape((), partial(fixed_part, "slider")),
            "swivel": _Shape((), bodies.swivel),
            "b3": _Shape(("crank", "crank_part"), lambda a, b: bodies.bar_b3(a, a / b)),
            "b4": _Shape(("coupler", "coupler_part"), lambda a, b: bodies.bar_b4(a, a / b)),
            "b7": _Shape(("coupler_part",), partial(bodies.bar, "b7")),
            "b8": _Shape(("crank",), partial(bodies.bar, "b8")),
        }.items()
    ]
    for knee in KneeBranch:
        ram = () if knee is KneeBranch.LOWER else _RAM[:2]
        shapes = {
            "base": _Shape(("base_radius", *_MAST), partial(_base, knee)),
            "m1": _Shape(("base_radius",), partial(_motor, knee)),
            "m4": _Shape(_RAM, partial(_lift, knee)),
            "carriage": _Shape(("base_radius", "arm_start", *ram), _carriage, _NO_NECK),
            "guide": _Shape(("guide_link",), partial(_guide, knee)),
        }
        found += [(f"{name}.{knee.value}", knee, shape) for name, shape in shapes.items()]
        neck = _Shape(("base_radius", "arm_start", *ram), _carriage, _NECK)
        found.append((f"carriage.{knee.value}.neck", knee, neck))
    return found


_MAST: Final = ("ground", "mast_radius", "mast_top", "column_top")
_RAM: Final = ("column_top", "lift_low", "lift_high")
_NO_NECK: Final = {"base_radius": 8 * CARRIAGE_RADIUS, "arm_start": CARRIAGE_RADIUS / 2}
_NECK: Final = {"base_radius": 8 * CARRIAGE_RADIUS, "arm_start": CARRIAGE_RADIUS * 2}


def _layout(names: tuple[str, ...], heights: tuple[float, ...]) -> FrameLayout:
    """Return a layout of which a body needs no more than some lengths."""
    given = dict(zip(names, heights, strict=True))
    return FrameLayout(**{item.name: given.get(item.name, 0.0) for item in fields(FrameLayout)})


def _ground(radius: float, *heights: float) -> MeshPart:
    return frame.ground(radius, _layout(_MAST[:2], heights))


def _base(knee: KneeBranch, radius: float, *heights: float) -> MeshPart:
    return frame.base(radius, _layout(_MAST, heights), knee)


def _lift(knee: KneeBranch, *heights: float) -> MeshPart:
    return frame.lift(_layout(_RAM, heights), knee)


def _motor(knee: KneeBranch, radius: float) -> MeshPart:
    return frame.motor(0, radius, knee)


def _carriage(radius: float, start: float, top: float = 0.0, low: float = 0.0) -> MeshPart:
    return bodies.carriage(radius, radius - start, top - low)


def _guide(knee: KneeBranch, length: float) -> MeshPart:
    return bodies.guide(length, knee)


def body_lengths(geometry: Geometry) -> dict[str, float]:
    """Return every length that the shape of a body depends on, over the size of the bodies [m]."""
    geometry = geometry_over_scale(geometry)
    m = mechanism(geometry)
    place = frame_lengths(m, geometry.guide_link_length)
    return {
        **{name: float(value) for name, value in place._asdict().items()},
        "base_radius": m.base_radius, "platform_radius": m.platform_radius,
        "joint_height": m.joint_height, "shaft": m.shaft, "crank": m.crank, "coupler": m.coupler,
        "crank_part": m.crank / m.k, "coupler_part": m.coupler / m.k,
        "guide_link": geometry.guide_link_length,
        "arm_start": min(max(m.base_radius - geometry.arm_length, 0.0), m.base_radius),
    }  # fmt: skip


def _packed(shape: _Shape, geometry: Geometry, grain: float) -> tuple[dict[str, Any], bytes]:
    """Return what is said of a body, and its bytes."""
    lengths = body_lengths(geometry) | (shape.instead or {})
    values = [lengths[name] for name in shape.names]
    part = shape.make(*values)
    points = _points(part)
    moves = [_moves(shape, values, number, points) for number in range(len(values))]
    kept_lengths = [number for number, move in enumerate(moves) if move.any()]
    moved = np.array([moves[number] for number in kept_lengths]).reshape(-1, *points.shape)
    table = np.moveaxis(moved, 0, 1).reshape(len(points), -1)
    groups, group = np.unique(table, axis=0, return_inverse=True)
    normals = np.vstack([solid.mesh.vertex_normals for solid in part.solids])
    counts = [len(solid.mesh.vertices) for solid in part.solids]
    materials = np.repeat([MATERIALS.index(solid.material) for solid in part.solids], counts)
    first = np.cumsum([0, *counts[:-1]])
    faces = np.vstack([s.mesh.faces + n for s, n in zip(part.solids, first, strict=True)])
    if len(groups) > 256 or len(points) > 65535:
        raise ValueError("a body has too many points")
    said = {
        "names": [shape.names[number] for number in kept_lengths],
        "at": [round(values[number], 9) for number in kept_lengths],
        "points": len(points),
        "faces": len(faces),
        "moves": groups.tolist(),
    }
    arrays = (
        np.rint(points / grain + TIE).astype("<i4"),
        np.rint(127 * normals + TIE).astype("i1"),
        materials.astype("u1"),
        group.reshape(-1).astype("u1"),
        faces.astype("<u2"),
    )
    return said, b"".join(_filled(array.tobytes()) for array in arrays)


def _points(part: MeshPart) -> Array:
    return np.vstack([solid.mesh.vertices for solid in part.solids])


def _moves(shape: _Shape, values: list[float], number: int, points: Array) -> Array:
    """Return what points move by for 1 m of a length, zero where they are not the same ones."""
    step = max(STEP * abs(values[number]), LEAST_STEP)
    for change in (step, -step):
        other = [value + change * (place == number) for place, value in enumerate(values)]
        found = _points(shape.make(*other))
        if found.shape == points.shape:
            return np.round((found - points) / change + TIE * 0.1**DIGITS, DIGITS) + 0.0
    return np.zeros_like(points)


def _filled(data: bytes) -> bytes:
    return data + bytes(-len(data) % 4)
