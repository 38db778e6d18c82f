"""Least distances of many pairs of bodies in a list of poses; compiled by `kernels`.

Enclosing boxes and capsules tell which pairs cannot be the nearest: first of whole bodies, then of
their solids. The pair that was nearest in the pose before is looked at first, since neighbors in a
list are mostly alike.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from paminsa_viz.clearance.distance import TOUCH, solid_distance
from paminsa_viz.clearance.nearest import (
    CAPSULE,
    convex_solid,
    nearest_on_segment,
    nearest_point,
)


def rod_way(a: Any, i: int, b: Any, j: int) -> tuple[Any, Any, Any]:
    """Return the shortest way from the core of a capsule to that of another one [m].

    Capsules are rows of (..., 7): the two ends of the core and the radius [m].
    """
    ux, uy, uz = a[i, 3] - a[i, 0], a[i, 4] - a[i, 1], a[i, 5] - a[i, 2]
    vx, vy, vz = b[j, 3] - b[j, 0], b[j, 4] - b[j, 1], b[j, 5] - b[j, 2]
    wx, wy, wz = a[i, 0] - b[j, 0], a[i, 1] - b[j, 1], a[i, 2] - b[j, 2]
    uu, vv = ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz
    uv = ux * vx + uy * vy + uz * vz
    uw, vw = ux * wx + uy * wy + uz * wz, vx * wx + vy * wy + vz * wz
    across = uu * vv - uv * uv
    s = 0.0
    if across > 1e-12 * uu * vv:
        s = min(max((uv * vw - vv * uw) / across, 0.0), 1.0)
    t = min(max((uv * s + vw) / vv, 0.0), 1.0) if vv > 0.0 else 0.0
    if uu > 0.0:
        s = min(max((uv * t - uw) / uu, 0.0), 1.0)
    return t * vx - s * ux - wx, t * vy - s * uy - wy, t * vz - s * uz - wz


def rod_gap(a: Any, i: int, b: Any, j: int) -> Any:
    """Return the distance of two capsules, rows of (..., 7) as in `rod_way` [m]."""
    dx, dy, dz = rod_way(a, i, b, j)
    return np.sqrt(dx * dx + dy * dy + dz * dz) - a[i, 6] - b[j, 6]


def rods_normal(a: Any, i: int, b: Any, j: int) -> tuple[Any, Any, Any]:
    """Return a direction across the cores of two capsules, as in `rod_way`, of any length."""
    ux, uy, uz = a[i, 3] - a[i, 0], a[i, 4] - a[i, 1], a[i, 5] - a[i, 2]
    vx, vy, vz = b[j, 3] - b[j, 0], b[j, 4] - b[j, 1], b[j, 5] - b[j, 2]
    uu, vv = ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    if nx * nx + ny * ny + nz * nz > 1e-12 * uu * vv:
        return nx, ny, nz
    if vv > uu:
        ux, uy, uz = vx, vy, vz
    if ux * ux + uy * uy > uz * uz:
        return -uy, ux, 0.0
    return uz if uz != 0.0 else 1.0, 0.0, -ux


def solid_way(rods: Any, i: int, solid: Any, frame: Any) -> tuple[Any, Any, Any]:
    """Return the shortest way from the core of a capsule to a solid, in the solid's frame [m].

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
    return qx - px, qy - py, qz - pz


def rod_distance(rods: Any, i: int, solid: Any, frame: Any) -> Any:
    """Return the distance of a capsule to a solid, minus infinity where its core is inside.

    Arguments as of `solid_way`.
    """
    dx, dy, dz = solid_way(rods, i, solid, frame)
    gap = np.sqrt(dx * dx + dy * dy + dz * dz)
    return gap - solid.radius - rods[i, 6] if gap > 0.0 else -np.inf


def part_capsules(s: Any, a: int, b: int, world: Any, rods: Any, bound: Any, best: Any) -> None:
    """Write the ends of the shift that parts two overlapping solids with capsules about them.

    Where cores meet it is across both of them.

    Args:
        s: `ShapeArrays`.
        a, b: The solids.
        world, rods: Frames of all solids, and capsules about them, in the world.
        bound: The largest of the distances of the two capsules, and of each to the other solid,
            negative [m].
        best: (7,) holds two points from index 1 and 4 on, whose middle is kept.
    """
    x, y, z = rod_way(rods, a, rods, b)
    most = rod_gap(rods, a, rods, b)
    for own, other, sign in ((a, b, 1.0), (b, a, -1.0)):
        solid, f = convex_solid(s, other), world[other]
        gap = rod_distance(rods, own, solid, f)
        if gap > most:
            most = gap
            dx, dy, dz = solid_way(rods, own, solid, f)
            x = sign * (f[0] * dx + f[1] * dy + f[2] * dz)
            y = sign * (f[3] * dx + f[4] * dy + f[5] * dz)
            z = sign * (f[6] * dx + f[7] * dy + f[8] * dz)
    if x * x + y * y + z * z < TOUCH:
        x, y, z = rods_normal(rods, a, rods, b)
    half = 0.5 * bound / np.sqrt(x * x + y * y + z * z)
    for row in range(3):
        middle = 0.5 * (best[1 + row] + best[4 + row])
        shift = half * (x if row == 0 else y if row == 1 else z)
        best[1 + row], best[4 + row] = middle - shift, middle + shift


def box_gap(a: Any, i: int, b: Any, j: int) -> Any:
    """Return a bound of the distance of two upright boxes, rows of (..., 6) [m]."""
    gap = max(a[i, 0] - b[j, 3], b[j, 0] - a[i, 3])
    gap = max(gap, max(a[i, 1] - b[j, 4], b[j, 1] - a[i, 4]))
    return max(gap, max(a[i, 2] - b[j, 5], b[j, 2] - a[i, 5]))


def box_gaps(boxes: Any, gaps: Any) -> None:
    """Write bounds of the distances of all upright boxes (6, n) to each other, (n, n) [m].

    Without branches, along rows, so that the compiler works on several at a time.
    """
    count = boxes.shape[1]
    for i in range(count):
        for j in range(count):
            gaps[i, j] = -np.inf
        for axis in range(3):
            low, high = boxes[axis, i], boxes[3 + axis, i]
            for j in range(count):
                before, after = low - boxes[3 + axis, j], boxes[axis, j] - high
                gap = before if before > after else after
                gaps[i, j] = gap if gap > gaps[i, j] else gaps[i, j]


def place_rod(rods: Any, i: int, frame: Any, out: Any) -> None:
    """Write a capsule of a body's frame in the world."""
    for row in range(3):
        f0, f1, f2, f3 = frame[3 * row], frame[3 * row + 1], frame[3 * row + 2], frame[9 + row]
        out[i, row] = f0 * rods[i, 0] + f1 * rods[i, 1] + f2 * rods[i, 2] + f3
        out[i, 3 + row] = f0 * rods[i, 3] + f1 * rods[i, 4] + f2 * rods[i, 5] + f3
    out[i, 6] = rods[i, 6]


def place_box(center: Any, half: Any, i: int, frame: Any, boxes: Any) -> None:
    """Write the upright box about a box of a frame, given by its center and half extents."""
    for row in range(3):
        f0, f1, f2 = frame[3 * row], frame[3 * row + 1], frame[3 * row + 2]
        middle = f0 * center[i, 0] + f1 * center[i, 1] + f2 * center[i, 2] + frame[9 + row]
        extent = abs(f0) * half[i, 0] + abs(f1) * half[i, 1] + abs(f2) * half[i, 2]
        boxes[i, row], boxes[i, 3 + row] = middle - extent, middle + extent


def place_solid(local: Any, frame: Any, out: Any) -> None:
    """Write a solid's frame in the world."""
    for row in range(3):
        f0, f1, f2 = frame[3 * row], frame[3 * row + 1], frame[3 * row + 2]
        for column in range(3):
            out[3 * row + column] = (
                f0 * local[column] + f1 * local[3 + column] + f2 * local[6 + column]
            )
        out[9 + row] = f0 * local[9] + f1 * local[10] + f2 * local[11] + frame[9 + row]


def place_frames(position: Any, quaternion: Any, out: Any) -> bool:
    """Write frames (n, 12) from positions (n, 3) and quaternions (n, 4); say if all are finite."""
    finite = True
    for i in range(position.shape[0]):
        w, x, y, z = quaternion[i, 0], quaternion[i, 1], quaternion[i, 2], quaternion[i, 3]
        out[i, 0], out[i, 4], out[i, 8] = (
            1.0 - 2.0 * (y * y + z * z), 1.0 - 2.0 * (x * x + z * z), 1.0 - 2.0 * (x * x + y * y)
        )  # fmt: skip
        out[i, 1], out[i, 3] = 2.0 * (x * y - w * z), 2.0 * (x * y + w * z)
        out[i, 2], out[i, 6] = 2.0 * (x * z + w * y), 2.0 * (x * z - w * y)
        out[i, 5], out[i, 7] = 2.0 * (y * z - w * x), 2.0 * (y * z + w * x)
        total = w + x + y + z
        for row in range(3):
            out[i, 9 + row] = position[i, row]
            total += position[i, row]
        finite = finite and np.isfinite(total)
    return finite


def body_distance(
    s: Any, i: int, j: int, least: Any, world: Any, rods: Any, boxes: Any, work: Any, best: Any,
    points: Any,
) -> Any:  # fmt: skip
    """Return the distance of two bodies, or ``least`` if it is not less [m].

    ``world`` (solids, 12), ``rods`` and ``boxes`` hold their solids. Writes the nearest points.
    """
    in_plane = s.leg[i] > 0 and s.leg[i] == s.leg[j]
    # only pins of its own leg may go through what is mounted around a joint
    around = in_plane or s.leg[i] == 0 or s.leg[j] == 0
    for a in range(s.start[i], s.start[i + 1]):
        for b in range(s.start[j], s.start[j + 1]):
            if around and (s.joints[i] & s.joint[b] or s.joints[j] & s.joint[a]):
                continue
            if in_plane and (s.low[a] >= s.high[b] or s.low[b] >= s.high[a]):
                continue
            if box_gap(boxes, a, boxes, b) >= max(least, 0.0):  # of boxes that overlap it is none
                continue
            bound = rod_gap(rods, a, rods, b)
            if bound >= least:
                continue
            # Two solids with many edges: first with a capsule in place of one of them.
            if s.kind[a] != CAPSULE and s.kind[b] != CAPSULE:
                bound = max(bound, rod_distance(rods, a, convex_solid(s, b), world[b]))
                if bound < least:
                    bound = max(bound, rod_distance(rods, b, convex_solid(s, a), world[a]))
                if bound >= least:
                    continue
            distance = solid_distance(
                convex_solid(s, a), world[a], convex_solid(s, b), world[b], work, best
            )
            # What parts the capsules parts the solids: a shift that is found there may be less.
            if distance < bound < 0.0:
                part_capsules(s, a, b, world, rods, bound, best)
            distance = max(distance, bound)
            if distance < least:
                least = distance
                for row in range(6):
                    points[row] = best[1 + row]
    return least


def least_distances(
    s: Any, position: Any, quaternion: Any, first: Any, second: Any, slot: Any,
    distance: Any, nearest: Any, points: Any,
) -> None:  # fmt: skip
    """Find the least distance of the pairs of each slot in each pose.

    Args:
        s: `ShapeArrays`.
        position, quaternion: (n, frames, 3) and (n, frames, 4) placements; the last is the world.
        first, second: (pairs,) bodies of the pairs.
        slot: (pairs,) which of the least distances a pair counts for.
        distance: (n, slots) is filled with distances [m]; NaN where a placement is not finite.
        nearest: (n, slots) is filled with indices of pairs, -1 for none.
        points: (n, slots, 6) is filled with the nearest points of the two bodies [m].
    """
    bodies, solids, slots = s.frame.size, s.kind.size, distance.shape[1]
    still = position.shape[1] - 1  # the frame of what does not move
    frames = np.empty((position.shape[1], 12))
    body_rods, upright = np.empty_like(s.body_rod), np.empty((bodies, 6))
    body_boxes, gaps = np.empty((6, bodies)), np.empty((bodies, bodies))
    world, rods, boxes = np.empty_like(s.local), np.empty_like(s.rod), np.empty((solids, 6))
    placed = np.zeros(bodies, np.bool_)
    work, best, found = np.empty(12), np.empty(7), np.empty(6)
    before = np.full(slots, -1, np.int64)
    for n in range(position.shape[0]):
        for k in range(slots):
            distance[n, k], nearest[n, k] = np.nan, -1
            for row in range(6):
                points[n, k, row] = np.nan
        if not place_frames(position[n], quaternion[n], frames):
            continue
        for i in range(bodies):
            place_rod(s.body_rod, i, frames[s.frame[i]], body_rods)
            place_box(s.body_center, s.body_half, i, frames[s.frame[i]], upright)
            for row in range(6):
                body_boxes[row, i] = upright[i, row]
            placed[i] = placed[i] and s.frame[i] == still
        box_gaps(body_boxes, gaps)
        for k in range(slots):
            distance[n, k] = np.inf
        for turn in range(slots + first.size):
            pair = before[turn] if turn < slots else turn - slots
            if pair < 0:
                continue
            i, j = first[pair], second[pair]
            k = slot[pair]
            least = distance[n, k]
            if gaps[i, j] >= max(least, 0.0) or (turn >= slots and pair == before[k]):
                continue
            if rod_gap(body_rods, i, body_rods, j) >= least:
                continue
            for side in range(2):
                body = j if side else i
                if not placed[body]:
                    placed[body] = True
                    for a in range(s.start[body], s.start[body + 1]):
                        place_solid(s.local[a], frames[s.frame[body]], world[a])
                        place_rod(s.rod, a, frames[s.frame[body]], rods)
                        place_box(s.center, s.half, a, frames[s.frame[body]], boxes)
            gap = body_distance(s, i, j, least, world, rods, boxes, work, best, found)
            if gap < least:
                distance[n, k], nearest[n, k] = gap, pair
                for row in range(6):
                    points[n, k, row] = found[row]
        for k in range(slots):
            before[k] = nearest[n, k]
            if nearest[n, k] < 0:
                distance[n, k] = np.nan
