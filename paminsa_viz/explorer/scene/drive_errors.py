"""Where the platform's center may be within the drives' errors, drawn to a stated scale."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from paminsa_viz import palette
from paminsa_viz.explorer.accuracy import no_bound, shown_errors
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.scene.curves import linear_colors
from paminsa_viz.explorer.scene.forces import BAR, BELOW, force_scale
from paminsa_viz.explorer.scene.layers import SceneContext
from paminsa_viz.model import jacobian
from paminsa_viz.precision.drive_errors import DriveErrors
from paminsa_viz.units import display_unit, number

Array = NDArray[np.float64]

FARTHEST: Final = 0.30
"""Largest distance of the drawn errors from the platform's center [m]."""

RING: Final = 48
"""Points of a ring of the ellipsoid."""

ERROR_COLOR: Final = palette.BAD
RMS_COLOR: Final = palette.INK


def outline(points: Array) -> Array:
    """Return the corners of the convex hull of points in a plane (n, 2), counterclockwise (m, 2).

    Points in a line give its two ends, equal points one.
    """
    ordered = sorted({(x, y) for x, y in points.tolist()})
    if len(ordered) < 3:
        return np.array(ordered)
    halves = []
    for sequence in (ordered, ordered[::-1]):
        half: list[tuple[float, float]] = []
        for x, y in sequence:
            while len(half) > 1:
                (ax, ay), (bx, by) = half[-2:]
                if (bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0:
                    break
                half.pop()
            half.append((x, y))
        halves += half[:-1]
    return np.array(halves)


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
    edges = np.stack(
        [
            np.concatenate([below, above, below]),
            np.concatenate([below[following], above[following], above]),
        ],
        axis=1,
    )
    return np.concatenate([below, above]), faces.astype(np.uint32), edges


def rms_rings(found: DriveErrors, geometry: Any) -> Array:
    """Return three rings of the ellipsoid of one standard deviation, (n, 2, 3) [m]."""
    j, deviation = jacobian(geometry, found.pose), np.array(found.accuracy.deviations)
    root = j[[0, 1, 3]] * deviation
    u, size, _ = np.linalg.svd(root, full_matrices=False)
    angle = np.linspace(0, 2 * np.pi, RING + 1)
    lines = []
    for first, second in ((0, 1), (1, 2), (2, 0)):
        ring = (
            np.cos(angle)[:, None] * u[:, first] * size[first]
            + np.sin(angle)[:, None] * u[:, second] * size[second]
        )
        lines.append(np.stack([ring[:-1], ring[1:]], axis=1))
    return np.concatenate(lines)


class DriveErrorView:
    """The layer ``drive_errors``: the worst errors as a solid, one standard deviation as rings."""

    def __init__(self, context: SceneContext) -> None:
        self._scene = context.scene
        self._drawn: tuple[object, ...] = ()
        self._nodes: dict[str, Any] = {}

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Follow pose, lengths and accuracy; nothing is sent while hidden."""
        del dragging
        shown = "drive_errors" in frame.state.layers
        design, pose = frame.shown_design, frame.configuration.pose
        theme = frame.state.theme
        key = (shown, design.geometry, design.accuracy, tuple(pose.tolist()), theme)
        if key == self._drawn:
            return
        self._drawn = key
        for node in self._nodes.values():
            node.remove()
        self._nodes.clear()
        if shown and np.isfinite(pose).all():
            self._draw(shown_errors(frame), design.geometry, pose[[0, 1, 3]], theme)

    def _draw(self, found: DriveErrors, geometry: Any, center: Array, theme: palette.Theme) -> None:
        reason = no_bound(found)
        place = center - np.array([0.0, 0.0, BELOW])
        if reason:
            self._label(f"no bound: {reason}", place)
            return
        if not any(found.accuracy.half_widths):  # what is left is rounding
            self._label("the drives make no error", place)
            return
        vertices, faces, edges = prism(found)
        scale = force_scale(float(np.linalg.norm(vertices, axis=1).max()), FARTHEST)
        if len(vertices) > 4:
            self._nodes["solid"] = self._scene.add_mesh_simple(
                "/drive_errors/solid", (center + vertices * BAR / scale).astype(np.float32), faces,
                color=palette.rgb(ERROR_COLOR), opacity=0.3, side="double", flat_shading=True,
                cast_shadow=False, receive_shadow=False,
            )  # fmt: skip
        self._lines("edges", center + edges * BAR / scale, ERROR_COLOR, 2.5)
        rings = center + rms_rings(found, geometry) * BAR / scale
        self._lines("rms", rings, theme.shown(RMS_COLOR), 2.0)
        self._label(error_text(found, scale), place)

    def _lines(self, name: str, lines: Array, color: str, width: float) -> None:
        found = linear_colors(*[color] * len(lines))[:, None].repeat(2, axis=1)
        self._nodes[name] = self._scene.add_line_segments(
            f"/drive_errors/{name}", lines.astype(np.float32), found,
            thickness=width, thickness_units="screen",
        )  # fmt: skip

    def _label(self, text: str, place: Array) -> None:
        self._nodes["label"] = self._scene.add_label(
            "/drive_errors/label", text, font_screen_scale=0.9, anchor="top-center", position=place
        )


def error_text(found: DriveErrors, scale: float) -> str:
    """Return the label: the worst errors, and what `BAR` stands for [m]."""
    plane, lift = (number(1e6 * float(v), 3) for v in (found.horizontal, found.worst[3]))
    turn = display_unit("rad:arcsec").format(float(found.worst[2]), 3)
    stated = f"{1e3 * BAR:.0f} mm = {number(1e6 * scale, 3)} µm"
    return f"± {plane} µm, z ± {lift} µm, θ ± {turn} ({stated})"
