"""Two solids in many places: our distances, and what any two convex solids must satisfy."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from paminsa_viz.clearance import kernels
from paminsa_viz.clearance.nearest import BOX, CAPSULE, CYLINDER, PRISM
from paminsa_viz.clearance.shapes import arrays_of
from paminsa_viz.clearance.solids import NO_CORNERS, Body, BodyPart, Primitive
from paminsa_viz.dimensions.placement import BODIES
from paminsa_viz.model.arrays import Array

KINDS = {"capsule": CAPSULE, "box": BOX, "cylinder": CYLINDER, "prism": PRISM}


class Found(NamedTuple):
    distance: Array  # (n,)
    points: Array  # (n, 2, 3)


def random_solid(kind: str, rng: np.random.Generator) -> Primitive:
    """Return a solid about its own origin, of some centimeters to half a meter."""
    half = 10 ** rng.uniform(-2, -0.4, 3)
    radius, corners = 0.0, NO_CORNERS
    if kind == "capsule":
        radius, half = float(half[0]), np.array([0.0, 0.0, half[2]])
    elif kind == "cylinder":
        half[1] = half[0]
    elif kind == "prism":
        angle = np.sort(rng.uniform(0, 2 * np.pi / 9, 7)) + 2 * np.pi * np.arange(7) / 7
        corners = half[0] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        half[:2] = np.abs(corners).max(axis=0)
    return Primitive(KINDS[kind], half, radius, corners, np.eye(3), np.zeros(3))


def distances(one: Primitive, other: Primitive, place: Array, wxyz: Array) -> Found:
    """Return distances of two solids; places (n, 2, 3) and unit quaternions (n, 2, 4)."""
    frames = BODIES[:2]
    bodies = tuple(
        Body(name, name, frame, BodyPart.FRAME, 0, (solid,))
        for name, frame, solid in zip("ab", frames, (one, other), strict=True)
    )
    n, pair = len(place), np.zeros(1, np.int64)
    # the last frame is the world's
    place = np.concatenate([place, np.zeros((n, 1, 3))], axis=1)
    wxyz = np.concatenate([wxyz, np.tile([1.0, 0.0, 0.0, 0.0], (n, 1, 1))], axis=1)
    distance, nearest = np.empty((n, 1)), np.empty((n, 1), np.int64)
    points = np.empty((n, 1, 6))
    kernels.compiled()(
        arrays_of(bodies), place, wxyz, pair, pair + 1, pair, distance, nearest, points,
    )  # fmt: skip
    return Found(distance[:, 0], points.reshape(n, 2, 3))


def extent(solid: Primitive, rotation: Array, place: Array, direction: Array) -> Array:
    """Return how far a placed solid reaches along directions; all batched, (n,)."""
    local = np.einsum("nij,ni->nj", rotation, direction)
    reach = np.einsum("ni,ni->n", place, direction) + solid.size[2] * np.abs(local[:, 2])
    if solid.kind == CYLINDER:
        return reach + solid.size[0] * np.hypot(local[:, 0], local[:, 1])
    if solid.kind == PRISM:
        return reach + (local[:, :2] @ solid.corners.T).max(axis=1)
    norm = np.linalg.norm(direction, axis=1)
    return reach + np.abs(local[:, :2]) @ solid.size[:2] + solid.radius * norm


def outside(solid: Primitive, points: Array) -> Array:
    """Return how far points (..., 3) of the body's frame are outside, 0 inside (...) [m]."""
    p = (np.asarray(points) - solid.center) @ solid.rotation
    high = np.maximum(np.abs(p[..., 2]) - solid.size[2], 0.0)
    if solid.kind == CYLINDER:
        flat = np.maximum(np.hypot(p[..., 0], p[..., 1]) - solid.size[0], 0.0)
    elif solid.kind == PRISM:
        edges = np.roll(solid.corners, -1, axis=0) - solid.corners
        from_corner = p[..., None, :2] - solid.corners
        along = np.sum(from_corner * edges, axis=-1) / np.sum(edges**2, axis=-1)
        nearest = solid.corners + np.clip(along, 0.0, 1.0)[..., None] * edges
        flat = np.linalg.norm(p[..., None, :2] - nearest, axis=-1).min(axis=-1)
        cross = edges[:, 0] * from_corner[..., 1] - edges[:, 1] * from_corner[..., 0]
        flat = np.where((cross >= 0.0).all(axis=-1), 0.0, flat)
    else:
        flat = np.hypot(*np.moveaxis(np.maximum(np.abs(p[..., :2]) - solid.size[:2], 0.0), -1, 0))
    return np.maximum(np.hypot(flat, high) - solid.radius, 0.0)


def may_meet(one: Body, a: Primitive, other: Body, b: Primitive) -> bool:
    """Say whether two solids of a pair of bodies count: not if they pass each other for sure."""
    legs = (BodyPart.LEG, BodyPart.COUNTERWEIGHT)
    if one.part in legs and other.part in legs and one.leg == other.leg:
        if a.extent[0, 1] >= b.extent[1, 1] or b.extent[0, 1] >= a.extent[1, 1]:
            return False
    elif one.part in legs and other.part in legs:
        return True
    return a.joint not in other.joints and b.joint not in one.joints
