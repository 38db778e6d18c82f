"""Solids with chamfered edges and normals that keep edges crisp, in meters.

Round ones are turned by `trimesh.creation.revolve`; what has no axis is a `loft`, a skin over a row
of closed loops of equal point count.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar

import numpy as np
import trimesh
from scipy.spatial.transform import Rotation

from paminsa_viz.dimensions.fixed_parts import RING_STEP
from paminsa_viz.model.arrays import Array

CREASE = np.radians(32.0)
"""Faces that meet at a sharper angle than this are shaded as an edge [rad]."""
PLAIN_CREASE = np.radians(65.0)
"""The same for plain shapes, whose round sides have as few as six faces [rad]."""

FLAT_SHARE = 10.0
"""A flat side of more than this part of a solid's area (1/10) is shaded flat."""

_Solids = dict[tuple[str, bytes], trimesh.Trimesh]

_plain: ContextVar[_Solids | None] = ContextVar("plain", default=None)
"""The plain solids made so far, by what they are made of."""


@contextmanager
def plain_shapes() -> Iterator[None]:
    """Make solids with few faces: sharp edges, and round sides that only look round.

    A browser without a graphics card takes two microseconds for every triangle of every frame. A
    solid that is made again from the same numbers is the same object: a body that is made with one
    length changed shares most of its solids with the body that it was.
    """
    before = _plain.set({})
    try:
        yield
    finally:
        _plain.reset(before)


def is_plain() -> bool:
    """Whether solids are being made with few faces."""
    return _plain.get() is not None


def shaded(mesh: trimesh.Trimesh) -> trimesh.Trimesh:
    """Return a mesh whose vertices are split along its edges; see `CREASE`."""
    mesh.merge_vertices(merge_norm=True)
    mesh.update_faces(mesh.nondegenerate_faces())
    creased = mesh.face_adjacency_angles < (PLAIN_CREASE if is_plain() else CREASE)
    joined = mesh.face_adjacency[creased]
    if not is_plain():
        areas, least = mesh.area_faces, mesh.area / FLAT_SHARE
        flat = [facet for facet in mesh.facets if areas[facet].sum() > least]
        alone = np.zeros(len(mesh.faces), dtype=bool)
        for facet in flat:
            alone[facet] = True
        joined = joined[~alone[joined].any(axis=1)]
        joined = np.vstack([joined, *(np.column_stack([f[:-1], f[1:]]) for f in flat)])
    return _split(mesh, joined)


def _split(mesh: trimesh.Trimesh, joined: Array) -> trimesh.Trimesh:
    """Return a mesh of patches without common vertices, from the pairs of faces in one (n, 2).

    Patches are in the order of their first faces, on every processor and with every trimesh.
    """
    labels = trimesh.graph.connected_component_labels(joined, node_count=len(mesh.faces))
    _, first, label = np.unique(labels, return_index=True, return_inverse=True)
    patch, count = first[label], len(mesh.vertices)
    order = np.argsort(patch, kind="stable")
    corners, faces = np.unique(patch[order, None] * count + mesh.faces[order], return_inverse=True)
    return trimesh.Trimesh(mesh.vertices[corners % count], faces.reshape(-1, 3), process=False)


def _made_once(kind: str, numbers: Array, make: Callable[[], trimesh.Trimesh]) -> trimesh.Trimesh:
    """Return a shaded solid; within `plain_shapes` the one already made from these numbers."""
    made = _plain.get()
    if made is None:
        return shaded(make())
    key = kind, numbers.tobytes()
    if key not in made:
        made[key] = shaded(make())
    return made[key]


def loft(loops: Sequence[Array]) -> trimesh.Trimesh:
    """Skin a row of loops, each (N, 3), counter-clockwise seen from the far end of the row.

    Both ends are capped with fans from the middle of the end loop, so an end loop has to be
    star-shaped about its middle.
    """
    stack = np.asarray(loops, dtype=np.float64)
    return _made_once(f"loft {stack.shape}", stack, lambda: _skin(stack))


def _skin(stack: Array) -> trimesh.Trimesh:
    """Return the skin of a `loft` over loops (rows, N, 3)."""
    rows, count = stack.shape[:2]
    vertices = stack.reshape(-1, 3)
    i = np.arange(count)
    j = (i + 1) % count
    faces = []
    for low in range(0, (rows - 1) * count, count):
        high = low + count
        faces.append(np.stack([low + i, low + j, high + j], axis=1))
        faces.append(np.stack([low + i, high + j, high + i], axis=1))
    middle = np.stack([stack[0].mean(axis=0), stack[-1].mean(axis=0)])
    first, last = len(vertices), len(vertices) + 1
    vertices = np.vstack([vertices, middle])
    end = (rows - 1) * count
    faces.append(np.stack([np.full(count, first), j, i], axis=1))
    faces.append(np.stack([np.full(count, last), end + i, end + j], axis=1))
    return trimesh.Trimesh(vertices, np.vstack(faces))


def rounded_rectangle(
    width: float, depth: float, radius: float, height: float = 0.0, steps: int = 2
) -> Array:
    """Return a rectangle (width along x, depth along y) with round corners about z."""
    radius, steps = (0.0, 0) if is_plain() else (min(radius, width / 2, depth / 2), steps)
    x, y = width / 2 - radius, depth / 2 - radius
    corners = np.array([(x, y), (-x, y), (-x, -y), (x, -y)])
    return rounded_polygon(corners, radius, height, steps)


def rounded_polygon(corners: Array, radius: float, height: float, steps: int) -> Array:
    """Return the outline around equal circles at the corners of a convex polygon, (N, 2) -> (M, 3).

    The corners run counter-clockwise; each becomes an arc of ``steps`` pieces.
    """
    out = []
    for before, here, after in zip(
        np.roll(corners, 1, axis=0), corners, np.roll(corners, -1, axis=0), strict=True
    ):
        start = np.arctan2(*(here - before)[::-1]) - np.pi / 2
        turn = np.arctan2(*(after - here)[::-1]) - np.pi / 2 - start
        angle = start + (turn % (2 * np.pi)) * np.arange(steps + 1) / max(steps, 1)
        out.append(here + radius * np.stack([np.cos(angle), np.sin(angle)], axis=1))
    flat = np.vstack(out)
    return np.hstack([flat, np.full((len(flat), 1), height)])


def revolve(profile: Sequence[tuple[float, float]], segments: int = 20) -> trimesh.Trimesh:
    """Turn a profile of (radius, height) points about z; it runs bottom up on the outside.

    Ends off the axis are capped; a profile that ends where it begins makes a ring. A plain solid
    has a third of the segments.
    """
    points = np.asarray(profile)
    if not np.array_equal(points[0], points[-1]):
        points = np.vstack([[0.0, points[0, 1]], points, [0.0, points[-1, 1]]])
    sections = max(6, round(segments / 3)) if is_plain() else segments
    return _made_once(
        f"revolve {sections}",
        points,
        lambda: trimesh.creation.revolve(points, sections=sections),
    )


def _chamfer(wanted: float, *most: float) -> float:
    """Return how far edges are broken [m]."""
    return 0.0 if is_plain() else min((wanted, *most))


def rod(
    radius: float, bottom: float, top: float, chamfer: float = 0.001, segments: int = 16
) -> trimesh.Trimesh:
    """Return a round bar along z between two heights, in any order, with chamfered ends."""
    bottom, top = sorted((bottom, top))
    c = _chamfer(chamfer, radius / 2, (top - bottom) / 2.5)
    side = [(radius, bottom + c), (radius, top - c)]
    return revolve([(radius - c, bottom), *side, (radius - c, top)], segments)


def tube(
    inner: float, outer: float, bottom: float, top: float, chamfer: float, segments: int
) -> trimesh.Trimesh:
    """Return a hollow cylinder along z with chamfered outer edges."""
    c = _chamfer(chamfer, (outer - inner) / 2, (top - bottom) / 2.5)
    side = [(outer - c, bottom), (outer, bottom + c), (outer, top - c), (outer - c, top)]
    return revolve([(inner, bottom), *side, (inner, top), (inner, bottom)], segments)


def flat_rings(radii: Array, width: float, height: float, segments: int) -> trimesh.Trimesh:
    """Return rings about z that are only seen from above, by the radii of their middles (n,)."""
    angle = 2 * np.pi / segments * np.arange(segments)
    edges = np.stack([radii + width / 2, radii - width / 2], axis=1)[:, None, :, None]
    level = edges * np.stack([np.cos(angle), np.sin(angle)], axis=1)[:, None]
    vertices = np.concatenate([level, np.full((*level.shape[:3], 1), height)], axis=3)
    outer = 2 * np.arange(segments)
    after = np.roll(outer, -1)
    ring = np.stack([outer, after, outer + 1, outer + 1, after, after + 1], axis=1)
    faces = ring.reshape(-1, 3) + 2 * segments * np.arange(len(radii))[:, None, None]
    return trimesh.Trimesh(vertices.reshape(-1, 3), faces.reshape(-1, 3), process=False)


def fan(outline: Array, height: float) -> trimesh.Trimesh:
    """Return a level face that is only seen from above, from an outline (N, 2) about the origin."""
    points = np.column_stack([outline, np.full(len(outline), height)])
    i = np.arange(1, len(points) + 1)
    faces = np.stack([np.zeros_like(i), i, np.roll(i, -1)], axis=1)
    return shaded(trimesh.Trimesh(np.vstack([[0.0, 0.0, height], points]), faces))


def prism(
    outline: Array, bottom: float, top: float, chamfer: float = 0.001, steps: int = 1
) -> trimesh.Trimesh:
    """Raise an outline (N, 3; star-shaped, heights ignored) from ``bottom`` to ``top``.

    Both rims are broken by ``chamfer``; with ``steps`` > 1 they are rounded.
    """
    flat = np.asarray(outline)[:, :2]
    c, steps = _chamfer(chamfer, (top - bottom) / 2.5), 1 if is_plain() else steps
    nudge = np.roll(flat, -1, axis=0) - np.roll(flat, 1, axis=0)
    inward = np.stack([-nudge[:, 1], nudge[:, 0]], axis=1)
    inward /= np.linalg.norm(inward, axis=1)[:, None]

    def level(shrink: float, height: float) -> Array:
        return np.hstack([flat + shrink * inward, np.full((len(flat), 1), height)])

    angles = np.pi / 2 * np.arange(steps + 1) / steps
    rim = [(c * (1 - np.sin(a)), c * (1 - np.cos(a))) for a in angles]
    loops = [level(s, bottom + h) for s, h in rim]
    loops += [level(s, top - h) for s, h in reversed(rim)]
    return loft(loops)


def box(
    size: tuple[float, float, float],
    center: tuple[float, float, float] = (0.0, 0.0, 0.0),
    chamfer: float = 0.0015,
) -> trimesh.Trimesh:
    """Return a box with broken edges, or with sharp ones where ``chamfer`` is 0."""
    width, depth, height = size
    if is_plain() or not chamfer:
        solid = _made_once("box", np.array(size), lambda: trimesh.creation.box(size))
        return moved(solid, center)
    outline = rounded_rectangle(width, depth, min(chamfer * 1.5, width / 3, depth / 3), steps=1)
    return moved(prism(outline, -height / 2, height / 2, chamfer), center)


def beam(
    start: float,
    end: float,
    section_start: tuple[float, float],
    section_end: tuple[float, float],
    radius: float = 0.004,
    chamfer: float = 0.0015,
) -> trimesh.Trimesh:
    """Return a tapered beam along +x; a section is (width along y, height along z)."""

    def loop(x: float, section: tuple[float, float], shrink: float) -> Array:
        flat = rounded_rectangle(section[0] - 2 * shrink, section[1] - 2 * shrink, radius - shrink)
        return np.stack([np.full(len(flat), x), flat[:, 0], flat[:, 1]], axis=1)

    c = _chamfer(chamfer, (end - start) / 3)
    return loft(
        [
            loop(start, section_start, c),
            loop(start + c, section_start, 0.0),
            loop(end - c, section_end, 0.0),
            loop(end, section_end, c),
        ]
    )


def arc_beam(
    radius: float,
    width: float,
    bottom: float,
    top: float,
    start: float,
    end: float,
    chamfer: float = 0.002,
) -> trimesh.Trimesh:
    """Return a piece of a flat ring about z, ``width`` wide about ``radius``.

    It runs from the angle ``start`` counter-clockwise to ``end`` [rad].
    """
    c, half = _chamfer(chamfer), width / 2
    section = [
        (half, bottom), (half, top - c), (half - c, top), (c - half, top), (-half, top - c),
        (-half, bottom),
    ]  # fmt: skip
    step = np.radians(20.0) if is_plain() else RING_STEP
    angles = np.linspace(start, end, max(int(np.ceil((end - start) / step)), 1) + 1)
    # Seen from the far end of the sweep the section runs counter-clockwise.
    out, up = np.array(section[::-1]).T
    return loft(
        [
            np.stack([(radius + out) * np.cos(a), (radius + out) * np.sin(a), up], axis=1)
            for a in angles
        ]
    )


def moved(
    mesh: trimesh.Trimesh,
    offset: tuple[float, float, float] | Array = (0.0, 0.0, 0.0),
    rotation: Array | None = None,
) -> trimesh.Trimesh:
    """Return a copy turned by ``rotation`` (3, 3), then shifted by ``offset`` [m]."""
    vertices, normals = mesh.vertices, mesh.vertex_normals
    if rotation is not None:
        vertices, normals = vertices @ rotation.T, normals @ rotation.T
    return trimesh.Trimesh(
        vertices=vertices + np.asarray(offset),
        faces=mesh.faces,
        vertex_normals=normals,
        process=False,
    )


def turn(axis: str, angle: float) -> Array:
    """Return the rotation matrix about ``"x"``, ``"y"`` or ``"z"`` by ``angle`` [rad]."""
    return Rotation.from_euler(axis, angle).as_matrix()


ACROSS = turn("x", -np.pi / 2)
"""Turns z to +y: an axis across the leg plane."""

ALONG = turn("y", np.pi / 2)
"""Turns z to +x: an axis along a bar."""
