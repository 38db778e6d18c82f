"""Where the platform's center may be within the drives' errors, drawn to a stated scale."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from paminsa_viz import palette
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.scene.curves import circles, segments
from paminsa_viz.explorer.scene.forces import BAR, round_scale, scale_text
from paminsa_viz.explorer.scene.nodes import Node, label_below, lines, mesh
from paminsa_viz.explorer.scene.sizes import symbol_size
from paminsa_viz.kept import kept
from paminsa_viz.model import DriveAccuracy, Geometry, jacobian
from paminsa_viz.model.arrays import Array, Pose
from paminsa_viz.precision.drive_errors import DriveErrors, drive_errors
from paminsa_viz.units import display_unit, number

FARTHEST: Final = 0.30
"""Largest distance of the drawn errors from the platform's center [m]."""

RING: Final = 48
"""Points of a ring of the ellipsoid."""

FLAT: Final = 1e-9
"""Points whose width is this share of their length are in a line."""

ERROR_COLOR: Final = palette.BAD
RMS_COLOR: Final = palette.INK


def shown_errors(frame: Frame) -> DriveErrors:
    """Return the errors at the pose where the robot is shown."""
    design = frame.shown_design
    return _errors(design.geometry, design.accuracy, frame.state.last_reachable.pose)


@kept(8)
def _errors(geometry: Geometry, accuracy: DriveAccuracy, pose: Pose) -> DriveErrors:
    return drive_errors(geometry, accuracy, pose)


def outline(points: Array) -> Array:
    """Return the corners of the convex hull of points in a plane (n, 2), counterclockwise (m, 2).

    Points in a line give its two ends, equal points one.
    """
    ordered = np.unique(points, axis=0)
    size = np.ptp(ordered, axis=0).max()
    if size == 0 or np.linalg.matrix_rank((ordered - ordered[0]) / size, tol=FLAT) < 2:
        return ordered[[0, -1]] if size else ordered[:1]
    return ordered[ConvexHull(ordered / size).vertices]


def prism(found: DriveErrors) -> tuple[Array, NDArray[np.uint32], Array]:
    """Return the solid of the corners' errors (x, y, z) about the center, its triangles and edges.

    Returns:
        Vertices (2 m, 3) [m], lower and upper outline; triangles (t, 3); edges (e, 2, 3) [m].
    """
    around = outline(found.corners[:, :2])
    count, lift = len(around), float(found.worst[3])
    below, above = (np.column_stack([around, np.full(count, z)]) for z in (-lift, lift))
    index = np.arange(count)
    following = np.roll(index, -1)
    sides = [(index, following, following + count), (index, following + count, index + count)]
    fan = np.array([(0, i, i + 1) for i in range(1, count - 1)], dtype=np.int64).reshape(-1, 3)
    faces = np.concatenate([*(np.stack(side, axis=1) for side in sides), fan[:, ::-1], fan + count])
    loops = [segments(np.vstack([loop, loop[:1]])) for loop in (below, above)]
    edges = np.concatenate([*loops, np.stack([below, above], axis=1)])
    return np.concatenate([below, above]), faces.astype(np.uint32), edges


def rms_rings(found: DriveErrors, geometry: Geometry) -> Array:
    """Return three rings of the ellipsoid of one standard deviation, (n, 2, 3) [m]."""
    j, deviation = jacobian(geometry, found.pose), np.array(found.accuracy.deviations)
    root = j[[0, 1, 3]] * deviation
    u, size, _ = np.linalg.svd(root, full_matrices=False)
    circle, axes = circles(1.0, RING), (u * size).T
    return np.concatenate([segments(circle @ axes[pair]) for pair in ([0, 1], [1, 2], [2, 0])])


def drive_error_nodes(frame: Frame) -> Iterator[Node]:
    """Draw the layer ``drive_errors``: the worst as a solid, one standard deviation as rings."""
    geometry, pose = frame.shown_design.geometry, frame.configuration.pose
    if not np.isfinite(pose).all():
        return
    found, center, size = shown_errors(frame), pose[[0, 1, 3]], symbol_size(geometry)
    reason, text = found.reason(), ""
    if reason:
        text = f"no bound: {reason}"
    elif not any(found.accuracy.half_widths):  # what is left is rounding
        text = "the drives make no error"
    else:
        vertices, faces, edges = prism(found)
        scale = round_scale(float(np.linalg.norm(vertices, axis=1).max()), FARTHEST * size)
        text = error_text(found, scale, size)
        drawn = BAR / scale
        if len(vertices) > 4:
            yield mesh(
                "/drive_errors/solid", center + vertices * drawn, faces, ERROR_COLOR,
                opacity=0.3, flat_shading=True,
            )  # fmt: skip
        yield lines("/drive_errors/edges", center + edges * drawn, ERROR_COLOR, 2.5)
        rings = center + rms_rings(found, geometry) * drawn
        yield lines("/drive_errors/rms", rings, frame.state.theme.shown(RMS_COLOR), 2.0)
    yield label_below("/drive_errors/label", text, center, "drive_errors", size)


def error_text(found: DriveErrors, scale: float, size: float) -> str:
    """Return the label: the worst errors, and what `BAR` stands for [m], for symbols of a size."""
    plane, lift = (number(1e6 * float(v), 3) for v in (found.horizontal, found.worst[3]))
    turn = display_unit("rad:arcsec").format(float(found.worst[2]), 3)
    stated = scale_text(1e6 * scale, size, "µm")
    return f"± {plane} µm, z ± {lift} µm, θ ± {turn} ({stated})"
