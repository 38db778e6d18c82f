"""Least distances between a point, a segment or a circle and a solid, in the solid's own frame.

Plain functions of numbers, run as they are on few poses and compiled by `kernels` on many. A solid
is a `ConvexSolid`: numbers that stay in registers, and rows of an array of corners.

| kind | solid |
|---|---|
| CAPSULE | its core alone, the segment from -c to c along z (a = b = 0); the radius comes later |
| BOX | half extents a, b, c |
| CYLINDER | radius a, half height c, axis z |
| PRISM | convex polygon in x and y, half height c along z |

The distance to a convex solid is a convex function of the point. Along a line its square has a
derivative that never falls. For boxes and segments that is piecewise linear with at most six kinks,
so its root is found in closed form; for cylinders and prisms by a bracketing secant, to rounding.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

CAPSULE, BOX, CYLINDER, PRISM = 0, 1, 2, 3

STEPS = 200
"""Most steps of an iteration; eight are usual, and 150 past edges that are nearly parallel."""

SAMPLES = 24
"""Places on a circle from which its nearest points are searched."""

_TURN = 2.0 * np.pi / SAMPLES
_COSINES, _SINES = np.cos(_TURN * np.arange(SAMPLES)), np.sin(_TURN * np.arange(SAMPLES))


class ConvexSolid(NamedTuple):
    """A solid: half extents along x, y and z, the radius around a capsule's core [m].

    A prism has rows ``first`` to ``last`` of ``corners`` (counter-clockwise).
    """

    kind: Any
    a: Any
    b: Any
    c: Any
    radius: Any
    corners: Any
    first: Any
    last: Any


def convex_solid(s: Any, index: int) -> ConvexSolid:
    """Return a solid of `ShapeArrays`."""
    return ConvexSolid(
        s.kind[index], s.size[index, 0], s.size[index, 1], s.size[index, 2], s.radius[index],
        s.corners, s.first[index], s.last[index],
    )  # fmt: skip


def _nearest_in_polygon(solid: Any, x: Any, y: Any) -> tuple[Any, Any]:
    """Return the point of a prism's polygon that is nearest to (x, y)."""
    inside = True
    best, bx, by = np.inf, x, y
    px, py = solid.corners[solid.last - 1, 0], solid.corners[solid.last - 1, 1]
    for i in range(solid.first, solid.last):
        qx, qy = solid.corners[i, 0], solid.corners[i, 1]
        ex, ey = qx - px, qy - py
        rx, ry = x - px, y - py
        if ex * ry - ey * rx < 0.0:  # outside of this edge
            inside = False
            t = min(max((rx * ex + ry * ey) / (ex * ex + ey * ey), 0.0), 1.0)
            dx, dy = rx - t * ex, ry - t * ey
            d2 = dx * dx + dy * dy
            if d2 < best:
                best, bx, by = d2, px + t * ex, py + t * ey
        px, py = qx, qy
    if inside:
        return x, y
    return bx, by


def nearest_point(solid: Any, x: Any, y: Any, z: Any) -> tuple[Any, Any, Any]:
    """Return the point of a solid that is nearest to (x, y, z): itself if it is inside."""
    a, b = solid.a, solid.b
    qz = min(max(z, -solid.c), solid.c)
    if solid.kind == CYLINDER:
        rho2 = x * x + y * y
        if rho2 > a * a:
            scale = a / np.sqrt(rho2)
            return x * scale, y * scale, qz
        return x, y, qz
    if solid.kind == PRISM:
        qx, qy = _nearest_in_polygon(solid, x, y)
        return qx, qy, qz
    return min(max(x, -a), a), min(max(y, -b), b), qz


def _slope(solid: Any, x: Any, y: Any, z: Any, dx: Any, dy: Any, dz: Any) -> Any:
    """Return half the derivative of the squared distance along (dx, dy, dz)."""
    qx, qy, qz = nearest_point(solid, x, y, z)
    return (x - qx) * dx + (y - qy) * dy + (z - qz) * dz


def _narrowed(
    t: Any, g: Any, low: Any, g_low: Any, high: Any, g_high: Any, side: int
) -> tuple[Any, Any, Any, Any, int]:
    """Return a bracket of a root, narrowed to a place t with the value g.

    The end that stays counts half, so that it moves as well (Illinois); ``side`` is the last one
    that moved.
    """
    if g < 0.0:
        return t, g, high, 0.5 * g_high if side == -1 else g_high, -1
    return low, 0.5 * g_low if side == 1 else g_low, t, g, 1


def nearest_on_segment(solid: Any, x: Any, y: Any, z: Any, dx: Any, dy: Any, dz: Any) -> Any:
    """Return where on a segment from (x, y, z) along (dx, dy, dz) it is nearest, from 0 to 1."""
    low, high = 0.0, 1.0
    g_low = _slope(solid, x, y, z, dx, dy, dz)
    if g_low >= 0.0:
        return 0.0
    g_high = _slope(solid, x + dx, y + dy, z + dz, dx, dy, dz)
    if g_high <= 0.0:
        return 1.0
    if solid.kind in (CAPSULE, BOX):
        for axis in range(3):
            if axis == 0:
                p, d, half = x, dx, solid.a
            elif axis == 1:
                p, d, half = y, dy, solid.b
            else:
                p, d, half = z, dz, solid.c
            if d == 0.0:
                continue
            for side in range(2):
                t = ((half if side else -half) - p) / d
                if low < t < high:
                    g = _slope(solid, x + t * dx, y + t * dy, z + t * dz, dx, dy, dz)
                    if g <= 0.0:
                        low, g_low = t, g
                    else:
                        high, g_high = t, g
        # linear between two kinks
        return low - (high - low) * g_low / (g_high - g_low)
    side, least, found = 0, np.inf, 0.0
    for step in range(STEPS):
        t = low - (high - low) * g_low / (g_high - g_low)
        if step % 4 == 3 or not low < t < high:
            t = 0.5 * (low + high)
        g = _slope(solid, x + t * dx, y + t * dy, z + t * dz, dx, dy, dz)
        same = t == found
        if abs(g) < least:
            least, found = abs(g), t
        if g == 0.0 or same or high - low < 1e-15:
            break
        low, g_low, high, g_high, side = _narrowed(t, g, low, g_low, high, g_high, side)
    return found


def nearest_on_circle(
    solid: Any, x: Any, y: Any, z: Any,
    ux: Any, uy: Any, uz: Any, vx: Any, vy: Any, vz: Any,
) -> tuple[Any, Any]:  # fmt: skip
    """Return cosine and sine of the place on a circle that is nearest.

    The circle is (x, y, z) + cos (ux, uy, uz) + sin (vx, vy, vz). Every local minimum that samples
    show is refined, unless it cannot become the least.
    """
    values = np.empty(SAMPLES)
    best, worst, which = np.inf, 0.0, 0
    for i in range(SAMPLES):
        cosine, sine = _COSINES[i], _SINES[i]
        px = x + cosine * ux + sine * vx
        py = y + cosine * uy + sine * vy
        pz = z + cosine * uz + sine * vz
        qx, qy, qz = nearest_point(solid, px, py, pz)
        d2 = (px - qx) ** 2 + (py - qy) ** 2 + (pz - qz) ** 2
        values[i] = d2
        worst = max(worst, d2)
        if d2 < best:
            best, which = d2, i
    found_cosine, found_sine = _COSINES[which], _SINES[which]
    if best == 0.0 or worst - best < 1e-14 * worst:
        return found_cosine, found_sine
    # No place between two samples is nearer than either by more than half the way between them.
    gain = 0.5 * _TURN * np.sqrt(ux * ux + uy * uy + uz * uz)
    limit = np.sqrt(best) + gain
    for i in range(SAMPLES):
        if (
            values[i] > limit * limit
            or values[i] > values[i - 1]
            or values[i] > values[(i + 1) % SAMPLES]
        ):
            continue
        low, high = i * _TURN, i * _TURN
        cosine, sine = _COSINES[i], _SINES[i]
        g = _slope(
            solid,
            x + cosine * ux + sine * vx, y + cosine * uy + sine * vy, z + cosine * uz + sine * vz,
            cosine * vx - sine * ux, cosine * vy - sine * uy, cosine * vz - sine * uz,
        )  # fmt: skip
        g_low, g_high, side, known = g, g, 0, False  # known: the slopes of both ends
        if g < 0.0:
            high += _TURN
        else:
            low -= _TURN
        for step in range(STEPS):
            middle = 0.5 * (low + high)
            if known and step % 4 != 3:
                guess = low - (high - low) * g_low / (g_high - g_low)
                if low < guess < high:
                    middle = guess
            cosine, sine = np.cos(middle), np.sin(middle)
            px = x + cosine * ux + sine * vx
            py = y + cosine * uy + sine * vy
            pz = z + cosine * uz + sine * vz
            qx, qy, qz = nearest_point(solid, px, py, pz)
            d2 = (px - qx) ** 2 + (py - qy) ** 2 + (pz - qz) ** 2
            if d2 < best:
                best, found_cosine, found_sine = d2, cosine, sine
            slope = (
                (px - qx) * (cosine * vx - sine * ux)
                + (py - qy) * (cosine * vy - sine * uy)
                + (pz - qz) * (cosine * vz - sine * uz)
            )
            if slope == 0.0 or high - low < 1e-15:
                break
            low, g_low, high, g_high, side = _narrowed(
                middle, slope, low, g_low, high, g_high, side
            )
            known = g_low < 0.0 < g_high
    return found_cosine, found_sine
