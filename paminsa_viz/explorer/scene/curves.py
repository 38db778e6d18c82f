"""Curves on a level plane or in space: workspace boundary, singularity circle, path."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from paminsa_viz.meshes.part import srgb_to_linear
from paminsa_viz.model.arrays import Array

MOST_DASHES = 1000
"""Most dashes of a curve."""


def linear_colors(*colors: str) -> NDArray[np.uint8]:
    """Return ``#rrggbb`` colors for lines, batched meshes and arrows, (n, 3).

    The viewer reads their colors as linear light, but those of plain meshes as they are seen. What
    is given here looks like the palette either way.
    """
    return np.rint(255 * np.array([srgb_to_linear(color) for color in colors])).astype(np.uint8)


def segments(curve: ArrayLike, height: float = 0.0) -> Array:
    """Return the segments of a curve (n, 2) or (n, 3) as (m, 2, 3) [m].

    A plane curve lies at ``height``. A point that is not finite breaks the curve.
    """
    points = np.atleast_2d(np.asarray(curve, dtype=np.float64))
    if points.size == 0:
        return np.zeros((0, 2, 3))
    if points.shape[1] == 2:
        points = np.hstack([points, np.full((len(points), 1), height)])
    pairs = np.stack([points[:-1], points[1:]], axis=1)
    return pairs[np.isfinite(pairs).all(axis=(1, 2))]


def resampled(curve: ArrayLike, count: int) -> Array:
    """Return ``count`` points of a curve (n, 2), equally far along it, both ends among them."""
    points = np.asarray(curve, dtype=np.float64)
    way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    at = np.linspace(0.0, way[-1], count)
    return np.stack([np.interp(at, way, points[:, i]) for i in range(2)], axis=1)


def circles(radii: ArrayLike, count: int = 40) -> Array:
    """Return circles about the origin of radii (...) [m], (..., count + 1, 2), closed."""
    angle = np.linspace(0.0, 2 * np.pi, count + 1)
    return np.multiply.outer(radii, np.stack([np.cos(angle), np.sin(angle)], axis=-1))


def bands(curves: Array, width: ArrayLike) -> tuple[Array, NDArray[np.uint32]]:
    """Return plane curves (k, n, 2) as flat bands of a width [m], one for all or (k,).

    Edges meet where a curve bends, up to a right angle, and where it ends at its first point.

    Returns:
        Corners (2 k n, 2) [m], and triangles (2 k (n - 1), 3) of their indices.
    """
    steps = np.diff(curves, axis=1)
    along = steps / np.maximum(np.linalg.norm(steps, axis=-1, keepdims=True), 1e-12)
    closed = np.isclose(curves[:, :1], curves[:, -1:]).all(axis=-1, keepdims=True)
    before = np.concatenate([np.where(closed, along[:, -1:], along[:, :1]), along], axis=1)
    after = np.concatenate([along, np.where(closed, along[:, :1], along[:, -1:])], axis=1)
    middle = before + after
    # Both edges are along the bisector, further away by the cosine of half the bend.
    middle /= np.maximum(np.sum(middle**2, axis=-1, keepdims=True) / 2, 1.0)
    half = 0.5 * np.reshape(width, (-1, 1, 1))
    aside = half * np.stack([-middle[..., 1], middle[..., 0]], axis=-1)
    corners = np.stack([curves + aside, curves - aside], axis=2)
    count, points = curves.shape[:2]
    first = 2 * (points * np.arange(count)[:, None] + np.arange(points - 1))
    faces = np.stack([first, first + 1, first + 2, first + 1, first + 3, first + 2], axis=-1)
    return corners.reshape(-1, 2), faces.reshape(-1, 3).astype(np.uint32)


def dashes(lines: Array, length: float) -> Array:
    """Cut segments (m, 2, 3) of one curve into dashes and gaps of a ``length`` [m] each.

    They are longer where there would be more than `MOST_DASHES`: a motion from a file may go on for
    kilometers.
    """
    if len(lines) == 0:
        return lines
    step = np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1)
    ends = np.cumsum(step)
    count = int(min(max(ends[-1] // (2 * length), 1), MOST_DASHES))
    period = ends[-1] / count
    distance = period * (np.arange(count)[:, None] + [0.0, 0.5])
    i = np.minimum(np.searchsorted(ends, distance), len(lines) - 1)
    part = 1.0 - (ends[i] - distance) / np.maximum(step[i], 1e-12)
    return lines[i, 0] + part[..., None] * (lines[i, 1] - lines[i, 0])
