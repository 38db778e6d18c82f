"""Least distance of two solids: exact for all pairs of capsules, boxes, cylinders and prisms.

Two convex solids that are apart are nearest at an edge of one of them (a segment, or a circle for
a cylinder), or between the round sides of two cylinders, on the common perpendicular of their axes:
two flat faces that are nearest to each other are parallel, and the border of where they face each
other belongs to an edge. So the least distance is that of all edges of each to the other solid
(see `nearest`). Solids overlap where an edge of one, or the axis of a cylinder, meets the other, or
the sides of two cylinders cross.

Where cores overlap the distance is minus a shift that parts them, see `overlap`.

A frame is twelve numbers: a rotation row by row, and the origin [m].
"""

from __future__ import annotations

from typing import Any

import numpy as np

from paminsa_viz.clearance.nearest import (
    BOX,
    CAPSULE,
    CYLINDER,
    PRISM,
    nearest_on_circle,
    nearest_on_segment,
    nearest_point,
)
from paminsa_viz.clearance.overlap import least_shift

TOUCH = 1e-24
"""Squared distance of cores below which they count as overlapping [m^2]."""


def relative_frame(frame: Any, other: Any, out: Any) -> None:
    """Write a frame as seen from another one."""
    for row in range(3):
        for column in range(3):
            out[3 * row + column] = (
                other[row] * frame[column]
                + other[3 + row] * frame[3 + column]
                + other[6 + row] * frame[6 + column]
            )
        out[9 + row] = (
            other[row] * (frame[9] - other[9])
            + other[3 + row] * (frame[10] - other[10])
            + other[6 + row] * (frame[11] - other[11])
        )


def _keep_nearest(solid: Any, x: Any, y: Any, z: Any, frame: Any, swapped: bool, best: Any) -> None:
    """Keep a point and the solid's point nearest to it, in the world, if they are the nearest."""
    qx, qy, qz = nearest_point(solid, x, y, z)
    d2 = (x - qx) ** 2 + (y - qy) ** 2 + (z - qz) ** 2
    if not d2 < best[0]:
        return
    best[0] = d2
    here, there = (4, 1) if swapped else (1, 4)
    for row in range(3):
        f0, f1, f2, f3 = frame[3 * row], frame[3 * row + 1], frame[3 * row + 2], frame[9 + row]
        best[here + row] = f0 * x + f1 * y + f2 * z + f3
        best[there + row] = f0 * qx + f1 * qy + f2 * qz + f3


def _try_segment(
    solid: Any, r: Any,
    x: Any, y: Any, z: Any, dx: Any, dy: Any, dz: Any, frame: Any, swapped: bool, best: Any,
) -> None:  # fmt: skip
    """Try the segment from (x, y, z) along (dx, dy, dz), given in the frame ``r`` of its solid."""
    px = r[0] * x + r[1] * y + r[2] * z + r[9]
    py = r[3] * x + r[4] * y + r[5] * z + r[10]
    pz = r[6] * x + r[7] * y + r[8] * z + r[11]
    ex = r[0] * dx + r[1] * dy + r[2] * dz
    ey = r[3] * dx + r[4] * dy + r[5] * dz
    ez = r[6] * dx + r[7] * dy + r[8] * dz
    t = nearest_on_segment(solid, px, py, pz, ex, ey, ez)
    _keep_nearest(solid, px + t * ex, py + t * ey, pz + t * ez, frame, swapped, best)


def _try_edges(solid: Any, other: Any, r: Any, frame: Any, swapped: bool, best: Any) -> None:
    """Try all edges of a solid in the frame ``r``, as seen from another solid's ``frame``."""
    kind, a, b, c = solid.kind, solid.a, solid.b, solid.c
    if kind in (CAPSULE, CYLINDER):
        _try_segment(other, r, 0.0, 0.0, -c, 0.0, 0.0, 2.0 * c, frame, swapped, best)
    if kind == CYLINDER:
        for side in range(2):
            h = c if side else -c
            x, y, z = r[2] * h + r[9], r[5] * h + r[10], r[8] * h + r[11]
            cosine, sine = nearest_on_circle(
                other, x, y, z, a * r[0], a * r[3], a * r[6], a * r[1], a * r[4], a * r[7],
            )  # fmt: skip
            _keep_nearest(
                other,
                x + a * (cosine * r[0] + sine * r[1]),
                y + a * (cosine * r[3] + sine * r[4]),
                z + a * (cosine * r[6] + sine * r[7]),
                frame, swapped, best,
            )  # fmt: skip
    elif kind == BOX:
        for edge in range(12):
            u = a if edge & 1 else -a
            v = b if edge & 1 else -b
            w = b if edge & 2 else -b
            h = c if edge & 2 else -c
            if edge < 4:
                x, y, z, dx, dy, dz = -a, v, h, 2.0 * a, 0.0, 0.0
            elif edge < 8:
                x, y, z, dx, dy, dz = u, -b, h, 0.0, 2.0 * b, 0.0
            else:
                x, y, z, dx, dy, dz = u, w, -c, 0.0, 0.0, 2.0 * c
            _try_segment(other, r, x, y, z, dx, dy, dz, frame, swapped, best)
    elif kind == PRISM:
        px, py = solid.corners[solid.last - 1, 0], solid.corners[solid.last - 1, 1]
        for i in range(solid.first, solid.last):
            qx, qy = solid.corners[i, 0], solid.corners[i, 1]
            for edge in range(3):
                if edge == 0:
                    z, dx, dy, dz = -c, qx - px, qy - py, 0.0
                elif edge == 1:
                    z, dx, dy, dz = c, qx - px, qy - py, 0.0
                else:
                    z, dx, dy, dz = -c, 0.0, 0.0, 2.0 * c
                _try_segment(other, r, px, py, z, dx, dy, dz, frame, swapped, best)
            px, py = qx, qy


def _try_sides(solid: Any, other: Any, r: Any, frame: Any, best: Any) -> None:
    """Try the round sides of two cylinders on the common perpendicular of their axes."""
    # axis of the first as seen from the second, whose axis is z
    ax, ay, az = r[2], r[5], r[8]
    across = ax * ax + ay * ay
    if across < 1e-18:
        return  # parallel: their rims are as near
    s = -(r[9] * ax + r[10] * ay) / across
    x, y, z = r[9] + s * ax, r[10] + s * ay, r[11] + s * az
    if abs(s) > solid.c or abs(z) > other.c:
        return
    gap = np.sqrt(x * x + y * y)
    if gap <= solid.a + other.a:
        near, left = min(other.a, gap), 0.0
        far = near
    else:
        near, far = other.a, gap - solid.a
        left = (far - near) ** 2
    if not left < best[0]:
        return
    best[0] = left
    scale = 1.0 / gap if gap > 0.0 else 0.0
    for row in range(3):
        f0, f1, f2, f3 = frame[3 * row], frame[3 * row + 1], frame[3 * row + 2], frame[9 + row]
        best[1 + row] = (f0 * x + f1 * y) * far * scale + f2 * z + f3
        best[4 + row] = (f0 * x + f1 * y) * near * scale + f2 * z + f3


def rod_distance(rods: Any, i: int, solid: Any, frame: Any) -> Any:
    """Return the distance of a capsule to a solid, minus infinity where its core is inside.

    ``rods`` (..., 7) holds the ends of the core, and the radius, in the world [m].
    """
    x, y, z = rods[i, 0] - frame[9], rods[i, 1] - frame[10], rods[i, 2] - frame[11]
    dx, dy, dz = rods[i, 3] - rods[i, 0], rods[i, 4] - rods[i, 1], rods[i, 5] - rods[i, 2]
    px = frame[0] * x + frame[3] * y + frame[6] * z
    py = frame[1] * x + frame[4] * y + frame[7] * z
    pz = frame[2] * x + frame[5] * y + frame[8] * z
    ex = frame[0] * dx + frame[3] * dy + frame[6] * dz
    ey = frame[1] * dx + frame[4] * dy + frame[7] * dz
    ez = frame[2] * dx + frame[5] * dy + frame[8] * dz
    t = nearest_on_segment(solid, px, py, pz, ex, ey, ez)
    px, py, pz = px + t * ex, py + t * ey, pz + t * ez
    qx, qy, qz = nearest_point(solid, px, py, pz)
    gap = np.sqrt((px - qx) ** 2 + (py - qy) ** 2 + (pz - qz) ** 2)
    return gap - solid.radius - rods[i, 6] if gap > 0.0 else -np.inf


def solid_distance(
    solid: Any, frame: Any, other: Any, other_frame: Any, work: Any, best: Any
) -> Any:
    """Return the least distance of two solids, negative where they overlap [m].

    Writes the nearest points into ``best`` (7,) from index 1 and 4 on; ``work`` is of shape (12,).
    """
    best[0] = np.inf
    if other.kind != CAPSULE or solid.kind == CAPSULE:
        relative_frame(frame, other_frame, work)
        _try_edges(solid, other, work, other_frame, False, best)
        if solid.kind == CYLINDER and other.kind == CYLINDER:
            _try_sides(solid, other, work, other_frame, best)
    if solid.kind != CAPSULE:
        relative_frame(other_frame, frame, work)
        _try_edges(other, solid, work, frame, True, best)
    if best[0] > TOUCH:
        gap = np.sqrt(best[0])
        for row in range(3):
            n = (best[4 + row] - best[1 + row]) / gap
            best[1 + row] += solid.radius * n
            best[4 + row] -= other.radius * n
        return gap - solid.radius - other.radius
    normal = work[:3]
    shift = least_shift(solid, frame, other, other_frame, normal)
    depth = shift + solid.radius + other.radius
    for row in range(3):
        middle = 0.5 * (best[1 + row] + best[4 + row])
        best[1 + row] = middle + 0.5 * depth * normal[row]
        best[4 + row] = middle - 0.5 * depth * normal[row]
    return -depth
