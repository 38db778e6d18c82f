"""The shift that parts two solids whose cores overlap.

It is the least over all normals of faces and all products of edges, which holds all that can be
least between capsules, boxes and prisms: these are the faces of the solids' difference. For
cylinders it is the least among some directions: never less than the true one, and never of the
wrong sign.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from paminsa_viz.clearance.nearest import BOX, CAPSULE, CYLINDER, PRISM


def _extent(
    kind: int, size: Any, polygons: Any, first: int, last: int, frame: Any, n: Any, sign: Any
) -> Any:
    """Return how far a solid reaches along ``sign`` times a world direction [m]."""
    x = sign * (frame[0] * n[0] + frame[3] * n[1] + frame[6] * n[2])
    y = sign * (frame[1] * n[0] + frame[4] * n[1] + frame[7] * n[2])
    z = sign * (frame[2] * n[0] + frame[5] * n[1] + frame[8] * n[2])
    at = sign * (frame[9] * n[0] + frame[10] * n[1] + frame[11] * n[2])
    reach = at + size[2] * abs(z)
    if kind == CYLINDER:
        return reach + size[0] * np.sqrt(x * x + y * y)
    if kind == PRISM:
        most = -np.inf
        for i in range(first, last):
            most = max(most, polygons[i, 0] * x + polygons[i, 1] * y)
        return reach + most
    return reach + size[0] * abs(x) + size[1] * abs(y)


def _direction(
    kind: int, polygons: Any, first: int, last: int, frame: Any, index: int, edge: bool, out: Any
) -> None:
    """Write the ``index``-th edge direction, or face normal, of a solid in the world."""
    x, y, z = 0.0, 0.0, 0.0
    if kind == BOX:
        if index == 0:
            x = 1.0
        elif index == 1:
            y = 1.0
        else:
            z = 1.0
    elif index == 0:
        z = 1.0
    else:
        i = first + index - 1
        before = last - 1 if index == 1 else i - 1
        x, y = polygons[i, 0] - polygons[before, 0], polygons[i, 1] - polygons[before, 1]
        length = np.sqrt(x * x + y * y)
        x, y = x / length, y / length
        if not edge:
            x, y = y, -x
    for row in range(3):
        out[row] = frame[3 * row] * x + frame[3 * row + 1] * y + frame[3 * row + 2] * z


def _directions(kind: int, first: int, last: int) -> int:
    if kind == BOX:
        return 3
    return 1 + last - first if kind == PRISM else 1


def least_shift(
    kind: int, size: Any, first: int, last: int, frame: Any,
    other: int, other_size: Any, other_first: int, other_last: int, other_frame: Any,
    polygons: Any, normal: Any,
) -> Any:  # fmt: skip
    """Return the least shift that parts overlapping cores [m], and write its direction."""
    least = np.inf
    n, u, v = np.zeros(3), np.zeros(3), np.zeros(3)
    mine, theirs = _directions(kind, first, last), _directions(other, other_first, other_last)
    # normals of each, products of edges, and directions from a cylinder's axis to the other solid
    for index in range(mine + theirs + mine * theirs + 2):
        if index < mine:
            _direction(kind, polygons, first, last, frame, index, False, n)
        elif index < mine + theirs:
            _direction(
                other, polygons, other_first, other_last, other_frame, index - mine, False, n
            )
        elif index < mine + theirs + mine * theirs:
            i, j = (index - mine - theirs) // theirs, (index - mine - theirs) % theirs
            _direction(kind, polygons, first, last, frame, i, True, u)
            _direction(other, polygons, other_first, other_last, other_frame, j, True, v)
            n[0] = u[1] * v[2] - u[2] * v[1]
            n[1] = u[2] * v[0] - u[0] * v[2]
            n[2] = u[0] * v[1] - u[1] * v[0]
        else:
            own = index == mine + theirs + mine * theirs
            if (kind if own else other) != CYLINDER:
                continue
            _direction(CYLINDER, polygons, 0, 0, frame if own else other_frame, 0, True, u)
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
            shift = _extent(kind, size, polygons, first, last, frame, n, sign) + _extent(
                other, other_size, polygons, other_first, other_last, other_frame, n, -sign
            )
            if shift < least:
                least = shift
                for row in range(3):
                    normal[row] = sign * n[row]
    if kind == CAPSULE and other == CAPSULE:
        return 0.0
    return max(least, 0.0)
