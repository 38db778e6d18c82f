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


def thinned(curve: ArrayLike, most: int) -> Array:
    """Return at most about ``most`` points of a fine curve (n, 2) or (n, 3), both ends among them.

    A thick line costs a browser without a graphics card as much as a body, segment by segment.
    """
    points = np.atleast_2d(np.asarray(curve, dtype=np.float64))
    if len(points) <= most:
        return points
    return points[np.linspace(0, len(points) - 1, most).round().astype(int)]


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
