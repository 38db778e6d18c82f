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
