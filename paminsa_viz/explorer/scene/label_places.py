"""Keeps labels apart on the screen, from wherever the camera looks."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from paminsa_viz.model.arrays import Array


class Projection(NamedTuple):
    """How a camera sees points.

    Attributes:
        position: Of the camera (3,) [m].
        right, up, back: Its axes, (3,) each.
        focal: Pixels for a slope of 1.
    """

    position: Array
    right: Array
    up: Array
    back: Array
    focal: float

    @classmethod
    def of(cls, camera: Any) -> Projection | None:
        """Return that of a tab's camera, or None where it has none yet."""
        position = np.array(camera.position, dtype=np.float64)
        back = position - np.array(camera.look_at, dtype=np.float64)
        right = np.cross(np.array(camera.up_direction, dtype=np.float64), back)
        lengths = np.linalg.norm(back), np.linalg.norm(right)
        if not np.isfinite(lengths).all() or min(lengths) < 1e-9 or not camera.image_height > 0:
            return None
        back, right = back / lengths[0], right / lengths[1]
        focal = camera.image_height / 2 / np.tan(camera.fov / 2)
        return cls(position, right, np.cross(back, right), back, float(focal))

    def seen(self, points: Array) -> tuple[Array, Array]:
        """Return points (n, 3) [m] on the screen, (n, 2) [px], y up; and their depths (n,) [m]."""
        local = points - self.position
        depth = -(local @ self.back)
        flat = np.stack([local @ self.right, local @ self.up], axis=1)
        return self.focal * flat / np.where(depth > 1e-6, depth, np.nan)[:, None], depth


def lifts(places: Array, size: tuple[float, float]) -> Array:
    """Return how far up labels have to go so that none covers another, (n,) [px].

    The lowest stays, the next is put on top of what it would cover.

    Args:
        places: (n, 2) where they are [px], y up; NaN for one that is not seen.
        size: Width and height of a label [px].
    """
    width, height = size
    out = np.zeros(len(places))
    settled: list[tuple[float, float]] = []
    for index in np.argsort(places[:, 1], kind="stable"):
        x, y = places[index]
        if not np.isfinite(x):
            continue
        start = y
        for other_x, other_y in sorted(settled, key=lambda other: other[1]):
            if abs(x - other_x) < width and abs(y - other_y) < height:
                y = other_y + height
        settled.append((x, y))
        out[index] = y - start
    return out


def apart(places: Array, camera: Any, size: tuple[float, float]) -> Array:
    """Return places (n, 3) [m] of labels moved up on the screen until none covers another."""
    projection = Projection.of(camera)
    if projection is None:
        return places
    seen, depth = projection.seen(places)
    lift = lifts(seen, size) * np.maximum(depth, 0.0) / projection.focal
    return places + lift[:, None] * projection.up


def hung(places: Array, down: Array, camera: Any) -> Array:
    """Return places (n, 3) [m] of labels that are as far below on the screen as they are in space.

    Args:
        places: Where they are in space.
        down: How far below what they are of, (n,) [m].
        camera: The tab's camera.
    """
    projection = Projection.of(camera)
    if projection is None:
        return places
    return places + down[:, None] * (np.array([0.0, 0.0, 1.0]) - projection.up)
