"""Signed distances from margins, and the volume that a distance of zero encloses."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.model.arrays import Array
from paminsa_viz.model.reach import MARGINS, Limit
from paminsa_viz.synthesis.causes import FIRST_REACH, SINGULAR
from paminsa_viz.synthesis.reach_bounds import ReachBounds


def reach_distances(bounds: ReachBounds, z: Array) -> tuple[Array, NDArray[np.uint8]]:
    """Return the distance to the end of what can be reached, and the code of what ends it (...).

    The distance is negative beyond [m]; to first order, exact for guide, leg axis and the circle of
    singular positions.

    Args:
        bounds: Extremes of X_1 over the headings, at positions.
        z: Heights that broadcast against the positions [m].
    """
    g = bounds.geometry
    ratio2 = g.span_ratio**2
    zeta2 = (z + g.platform_joint_height) ** 2

    def bars(radius: Array, limit: float) -> Array:
        """Return (|85| - limit) over the size of its gradient."""
        w2 = ratio2 * radius**2
        length = np.sqrt(w2 + zeta2)
        with np.errstate(all="ignore"):
            slope = np.sqrt(ratio2 * w2 + zeta2) / length
            return np.where(length > 0.0, (length - limit) / slope, -limit)

    position = bounds.position
    if bounds.turn <= 0.0:  # every position is singular, the center least of all
        position = position - 2.0 * np.abs(position).max()
    limits = {
        Limit.STRETCHED: -bars(bounds.far, g.crank_length + g.coupler_length),
        Limit.FOLDED: bars(bounds.near, abs(g.coupler_length - g.crank_length)),
        Limit.GUIDE: g.stroke * (g.magnification - 1) - bounds.far,
        Limit.AXIS: bounds.near - g.axis_clearance,
    }
    least, code = position, np.full(position.shape, SINGULAR, np.uint8)
    for limit, distance in limits.items():
        leg = bounds.far_leg if limit in (Limit.STRETCHED, Limit.GUIDE) else bounds.near_leg
        nearer = distance < least
        tag = FIRST_REACH + len(MARGINS) * leg + MARGINS.index(limit)
        least, code = np.where(nearer, distance, least), np.where(nearer, tag, code)
    return least, code.astype(np.uint8)


def margin_slope(margin: Array) -> Array:
    """Return the size of a margin's gradient (x, y, z) [a node's distance], at least.

    Of the two differences along an axis the larger counts; what is not finite does not.
    """
    finite = np.where(np.isfinite(margin), margin, np.nan)
    squared = np.zeros(margin.shape)
    for axis in range(3):
        change = np.abs(np.diff(finite, axis=axis))
        slope = np.zeros(margin.shape)
        for part in (slice(None, -1), slice(1, None)):
            view = slope[(slice(None),) * axis + (part,)]
            np.fmax(view, change, out=view)
        squared += slope * slope
    return np.sqrt(squared)


def margin_distance(margin: Array, slope: Array, step: float) -> Array:
    """Return a margin over its slope, the distance to where it is zero to first order [m].

    NaN where the margin is NaN; where it is infinite, a step on its side.

    Args:
        margin: (x, y, z) on nodes.
        slope: (x, y, z) as of `margin_slope`.
        step: Distance of the nodes [m].
    """
    # A constant margin has no slope, and is as far away as can be.
    far = step * max(margin.shape)
    with np.errstate(all="ignore"):
        found = np.clip(margin * (step / slope), -far, far)
    found = np.where(np.isinf(margin), np.copysign(step, margin), found)
    return np.where(margin == 0.0, 0.0, found)


def enclosed_volume(depth: Array, step: float) -> float:
    """Return the volume of the body where a depth on nodes (x, y, z) is positive [m^3]."""
    if not (depth > 0.0).any():
        return 0.0
    vertices, faces = zero_surface(depth)
    a, b, c = (vertices[corner] for corner in faces.T)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0) * step**3


def zero_surface(depth: Array) -> tuple[Array, NDArray[np.int64]]:
    """Return the closed surface where a depth is zero: vertices [nodes] and faces.

    By marching cubes (Lorensen and Cline 1987). Beyond the last nodes is outside, and the faces'
    normals point there.
    """
    # Late: needed only where there is a volume.
    import mcubes

    size = float(np.abs(depth).max())
    edge = np.pad(depth, 1, constant_values=-size)
    vertices, faces = mcubes.marching_cubes(edge, 0.0)
    return vertices - 1.0, faces.astype(np.int64)
