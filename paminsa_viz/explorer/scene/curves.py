"""Curves on a level plane or in space: workspace boundary, singularity circle, path."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike, NDArray
from viser import LineSegmentsHandle, SceneApi

from paminsa_viz import palette
from paminsa_viz.meshes.part import srgb_to_linear

Array = NDArray[np.float64]


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
    """Cut segments (m, 2, 3) of one curve into dashes and gaps of a ``length`` [m] each."""
    if len(lines) == 0:
        return lines
    step = np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1)
    ends = np.cumsum(step)
    count = max(int(ends[-1] // (2 * length)), 1)
    starts = np.arange(count) * (ends[-1] / count)
    out = []
    for start in starts:
        out.append([_at(lines, ends, step, s) for s in (start, start + ends[-1] / count / 2)])
    return np.array(out)


def _at(lines: Array, ends: Array, step: Array, distance: float) -> Array:
    i = min(int(np.searchsorted(ends, distance)), len(lines) - 1)
    part = 1.0 - (ends[i] - distance) / max(step[i], 1e-12)
    return lines[i, 0] + part * (lines[i, 1] - lines[i, 0])


class Curve:
    """One or several curves drawn as one node, made when first drawn.

    Args:
        scene: Scene of a client or a server.
        name: Scene name of the node.
        color: ``#rrggbb``.
        thickness: On the screen [px].
        dash: Length of a dash and of a gap [m]; None draws a full line.
    """

    def __init__(
        self,
        scene: SceneApi,
        name: str,
        color: str = palette.INK,
        thickness: float = 2.0,
        dash: float | None = None,
    ) -> None:
        self._scene = scene
        self._name = name
        self._color = linear_colors(color)[0]
        self._thickness = thickness
        self._dash = dash
        self._node: LineSegmentsHandle | None = None
        self._visible = True
        self._empty = True

    def draw(self, curves: Iterable[ArrayLike], height: float = 0.0) -> None:
        """Draw curves (n, 2) at a height, or (n, 3) in space [m], in place of the last ones."""
        parts = [segments(curve, height) for curve in curves]
        if self._dash is not None:
            parts = [dashes(part, self._dash) for part in parts]
        lines = np.concatenate([np.zeros((0, 2, 3)), *parts]).astype(np.float32)
        self._empty = len(lines) == 0
        if self._empty:
            self.visible = self._visible
            return
        if self._node is None:
            self._node = self._scene.add_line_segments(
                self._name, lines, self._color,
                thickness=self._thickness, thickness_units="screen", visible=self._visible,
            )  # fmt: skip
            return
        self._node.points = lines
        self.visible = self._visible

    def recolor(self, color: str) -> None:
        """Draw in another color ``#rrggbb``."""
        self._color = linear_colors(color)[0]
        if self._node is not None:
            self._node.colors = self._color

    @property
    def visible(self) -> bool:
        """Whether the curve is shown (once it has something to show)."""
        return self._visible

    @visible.setter
    def visible(self, visible: bool) -> None:
        self._visible = visible
        if self._node is not None:
            self._node.visible = visible and not self._empty
