"""How finely solids are made, and where their surfaces look round and where they have edges."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

import numpy as np
import trimesh
from numpy.typing import NDArray

Array = NDArray[np.float64]

CREASE = np.radians(32.0)
"""Faces that meet at a sharper angle than this are shaded as an edge [rad]."""
PLAIN_CREASE = np.radians(65.0)
"""The same for plain shapes, whose round sides have as few as six faces [rad]."""

_plain = ContextVar("plain", default=False)


@contextmanager
def plain_shapes() -> Iterator[None]:
    """Make solids with few faces: sharp edges, and round sides that only look round.

    A browser without a graphics card takes two microseconds for every triangle of every picture.
    """
    before = _plain.set(True)
    try:
        yield
    finally:
        _plain.reset(before)


def is_plain() -> bool:
    """Whether solids are being made with few faces."""
    return _plain.get()


def _corner_normals(vertices: Array, faces: NDArray[np.int64], crease: float) -> Array:
    """Return a normal for each corner of each face, (F, 3, 3).

    A corner averages the faces around its vertex that lie within ``crease`` of its own face,
    weighted by area and angle, so that a flat side stays flat beside its chamfer and the way a
    side is cut into triangles does not show.
    """
    point = vertices[faces]
    forward = np.roll(point, -1, axis=1) - point
    backward = np.roll(point, 1, axis=1) - point
    normal = np.cross(forward[:, 0], backward[:, 0])
    unit = normal / np.linalg.norm(normal, axis=1)[:, None]
    across = np.linalg.norm(np.cross(forward, backward), axis=2)
    angle = np.arctan2(across, np.einsum("ijk,ijk->ij", forward, backward))
    weighted = (normal[:, None] * angle[..., None]).reshape(-1, 3)
    corner = faces.reshape(-1)
    order = np.argsort(corner, kind="stable")
    count = np.bincount(corner, minlength=len(vertices))
    first = np.cumsum(count) - count
    # Every corner paired with every corner at the same vertex.
    around = count[corner]
    mine = np.repeat(np.arange(len(corner)), around)
    step = np.arange(len(mine)) - np.repeat(np.cumsum(around) - around, around)
    theirs = order[first[corner[mine]] + step]
    smooth = np.einsum("ij,ij->i", unit[mine // 3], unit[theirs // 3]) >= np.cos(crease)
    mine, theirs = mine[smooth], theirs[smooth]
    total = np.stack(
        [np.bincount(mine, weighted[theirs, axis], len(corner)) for axis in range(3)], axis=1
    )
    return (total / np.linalg.norm(total, axis=1)[:, None]).reshape(-1, 3, 3)


def shade(vertices: Array, faces: NDArray[np.int64]) -> trimesh.Trimesh:
    """Return a mesh whose vertices are split along its edges; see `CREASE`."""
    crease = PLAIN_CREASE if is_plain() else CREASE
    vertices = np.asarray(vertices, dtype=np.float64)
    joined, index = np.unique(vertices.round(9) + 0.0, axis=0, return_inverse=True)
    faces = index.reshape(-1)[np.asarray(faces)]
    a, b, c = (joined[faces[:, i]] for i in range(3))
    faces = faces[np.linalg.norm(np.cross(b - a, c - a), axis=1) > 1e-14]
    normals = _corner_normals(joined, faces, crease).reshape(-1, 3).round(6) + 0.0
    corners = np.hstack([joined[faces.reshape(-1)], normals])
    unique, index = np.unique(corners, axis=0, return_inverse=True)
    return trimesh.Trimesh(
        vertices=unique[:, :3],
        faces=index.reshape(-1, 3),
        vertex_normals=unique[:, 3:],
        process=False,
    )
