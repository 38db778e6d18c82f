"""Least distance of two solids: exact for all pairs of capsules, boxes, cylinders and prisms.

Two convex solids that are apart are nearest at an edge of one of them (a segment, or a circle for
a cylinder), or between the round sides of two cylinders, on the common perpendicular of their axes:
two flat faces that are nearest to each other are parallel, and the border of where they face each
other belongs to an edge. So the least distance is that of all edges of each to the other solid
(see `nearest`). Solids overlap where an edge of one, or the axis of a cylinder, meets the other, or
the sides of two cylinders cross.

Where cores overlap the distance is minus a shift that parts them. It is the least over all normals
of faces and all products of edges, which holds all that can be least between capsules, boxes and
prisms: these are the faces of the solids' difference. For cylinders it is the least among some
directions: never less than the true one, and never of the wrong sign.

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


def _extent(solid: Any, frame: Any, n: Any, sign: Any) -> Any:
    """Return how far a solid reaches along ``sign`` times a world direction [m]."""
    x = sign * (frame[0] * n[0] + frame[3] * n[1] + frame[6] * n[2])
    y = sign * (frame[1] * n[0] + frame[4] * n[1] + frame[7] * n[2])
    z = sign * (frame[2] * n[0] + frame[5] * n[1] + frame[8] * n[2])
    at = sign * (frame[9] * n[0] + frame[10] * n[1] + frame[11] * n[2])
    reach = at + solid.c * abs(z)
    if solid.kind == CYLINDER:
        return reach + solid.a * np.sqrt(x * x + y * y)
    if solid.kind == PRISM:
        most = -np.inf
        for i in range(solid.first, solid.last):
            most = max(most, solid.corners[i, 0] * x + solid.corners[i, 1] * y)
        return reach + most
    return reach + solid.a * abs(x) + solid.b * abs(y)


def _direction(solid: Any, frame: Any, index: int, edge: bool, out: Any) -> None:
    """Write the ``index``-th edge direction, or face normal, of a solid in the world."""
    x, y, z = 0.0, 0.0, 0.0
    if solid.kind == BOX:
        if index == 0:
            x = 1.0
        elif index == 1:
            y = 1.0
        else:
            z = 1.0
    elif index == 0:
        z = 1.0
    else:
        i = solid.first + index - 1
        before = solid.last - 1 if index == 1 else i - 1
        x, y = (
            solid.corners[i, 0] - solid.corners[before, 0],
            solid.corners[i, 1] - solid.corners[before, 1],
        )
        length = np.sqrt(x * x + y * y)
        x, y = x / length, y / length
        if not edge:
            x, y = y, -x
    for row in range(3):
        out[row] = frame[3 * row] * x + frame[3 * row + 1] * y + frame[3 * row + 2] * z


def _directions(solid: Any) -> int:
    """Return how many directions `_direction` has."""
    if solid.kind == BOX:
        return 3
    return 1 + solid.last - solid.first if solid.kind == PRISM else 1


def least_shift(solid: Any, frame: Any, other: Any, other_frame: Any, normal: Any) -> Any:
    """Return the least shift that parts overlapping cores [m], and write its direction."""
    least = np.inf
    n, u, v = np.zeros(3), np.zeros(3), np.zeros(3)
    mine, theirs = _directions(solid), _directions(other)
    # normals of each, products of edges, and directions from a cylinder's axis to the other solid
    for index in range(mine + theirs + mine * theirs + 2):
        if index < mine:
            _direction(solid, frame, index, False, n)
        elif index < mine + theirs:
            _direction(other, other_frame, index - mine, False, n)
        elif index < mine + theirs + mine * theirs:
            i, j = (index - mine - theirs) // theirs, (index - mine - theirs) % theirs
            _direction(solid, frame, i, True, u)
            _direction(other, other_frame, j, True, v)
            n[0] = u[1] * v[2] - u[2] * v[1]
            n[1] = u[2] * v[0] - u[0] * v[2]
            n[2] = u[0] * v[1] - u[1] * v[0]
        else:
            own = index == mine + theirs + mine * theirs
            which = solid if own else other
            if which.kind != CYLINDER:
                continue
            _direction(which, frame if own else other_frame, 0, True, u)
            for row in range(3):
                n[row] = other_frame[9 + row] - frame[9 + row]
            along = n[0] * u[0] + n[1] * u[1] + n[2] * u[2]
            for row in range(3):
                n[row] -= along * u[row]
        length = np.sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2])
        if length < 1e-9:
            continue
        for row in range(3):
            n[row] /= length
        for side in range(2):
            sign = 1.0 if side else -1.0
            shift = _extent(solid, frame, n, sign) + _extent(other, other_frame, n, -sign)
            if shift < least:
                least = shift
                for row in range(3):
                    normal[row] = sign * n[row]
    if solid.kind == CAPSULE and other.kind == CAPSULE:
        return 0.0
    return max(least, 0.0)


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
