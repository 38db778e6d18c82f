"""Shapes that a required workspace may have: all that depends on which of them it is.

A workspace is upright: a section in the horizontal plane times an interval of heights. A section
lies about its own center and has half extents (h_x, h_y) [m]; positions are (x, y) from that
center [m].
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from enum import Enum
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.model.arrays import Array

Size = tuple[float, float, float]
"""Extents along (x, y, z) [m]."""

Range = tuple[float, float]

Plane = Sequence[float] | Array
"""Two lengths, along x and y [m]."""

EDGE = 64
"""Straight pieces that a round edge is drawn with."""

DIRECTIONS = 12
"""Directions of samples on the innermost ring; the legs' own are among them."""

TURN = 2.0 * np.pi

_LONGER = 1e-9
"""By how much an arc is taken longer at both ends when it is looked for an extreme [rad]."""

_CORNERS = np.array([(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)])
"""Corners of a square."""


class CrossSection(ABC):
    """Horizontal section of a workspace, whatever its size.

    Attributes:
        sizes: Keys of the sizes that it and its height are given by, in files.
        threefold: Whether a turn by 120 degrees about its center changes nothing.
        fill: Its area over that of the rectangle around it.
        rule: What is wrong with a size that is not `fitted`.
    """

    sizes: ClassVar[tuple[str, ...]]
    threefold: ClassVar[bool]
    fill: ClassVar[float]
    rule: ClassVar[str] = ""

    @abstractmethod
    def fitted(self, size: Size) -> Size:
        """Return a size that the shape can have, of another one as far as it goes."""

    @abstractmethod
    def size(self, *sizes: float) -> Size:
        """Return the extents for what `sizes` names [m]."""

    @abstractmethod
    def given(self, size: Size) -> tuple[float, ...]:
        """Return what `sizes` names for the extents [m]."""

    @abstractmethod
    def text(self, x: str, y: str, z: str) -> str:
        """Return the shape with its extents for people, before their unit."""

    @abstractmethod
    def gauge_squared(self, x: Array, y: Array, half: Plane) -> Array:
        """Return the square of the scale at which positions are on the edge; NaN for 0 over 0."""

    @abstractmethod
    def clipped(self, position: Array, half: Plane) -> Array:
        """Return positions (..., 2), those outside moved to the edge [m]."""

    @abstractmethod
    def on_nodes(self, x: NDArray[Any], y: NDArray[Any], half: Plane) -> NDArray[np.bool_]:
        """Return which nodes of a grid over the extents, to the nearest node, are in it (n, m)."""

    @abstractmethod
    def spread(self, share: Array) -> Array:
        """Return positions that are even over it for ones that are over the unit square (n, 2).

        The square is about zero; they are for extents of 1.
        """

    @abstractmethod
    def farthest(self, center: Plane, half: Plane) -> float:
        """Return its largest distance from a point, from which its center is given (2,) [m]."""

    @abstractmethod
    def extent(self, half: Plane, direction: Array) -> float:
        """Return how far it extends from its center along a unit vector (2,) [m]."""

    @abstractmethod
    def ray(self, center: Array, half: Array, direction: Array) -> float:
        """Return how far a ray from a point runs in it [m], 0 if that is outside.

        Args:
            center: Its center from the point (2,) [m].
            half: Its half extents (2,) [m].
            direction: A unit vector (2,).
        """

    @abstractmethod
    def ring(self, count: int, *, third: bool) -> Array:
        """Return positions on its edge (n, 2), for half extents of 1.

        Args:
            count: Positions for every 120 degrees.
            third: Whether those of a third are enough, where the section is threefold.
        """

    @abstractmethod
    def filled(self, density: int, half: Plane) -> Array:
        """Return positions over it, its edge among them, so many from center to edge (n, 2) [m]."""

    @abstractmethod
    def edge(self) -> tuple[Array, slice]:
        """Return its edge, a closed line (n, 2) for half extents of 1, and which stand upright."""

    @abstractmethod
    def arc_distances(
        self, center: Array, radius: Array, alpha: Array, theta: Range, half: Array
    ) -> tuple[Array, Array]:
        """Return the least and largest distances of arcs from sections, each (n, 3) [m].

        Args:
            center: Of the sections from the arcs' own centers (n, 3, 2) [m].
            radius: Of the arcs (n, 1, 1) [m]; their points are at radius (cos, sin)(alpha + theta)
                against the center.
            alpha: Where they are at theta = 0 (3, 1) [rad].
            theta: Least and largest [rad].
            half: Half extents, the first two columns of (n, 2 or 3) [m].
        """


class CylinderSection(CrossSection):
    """A disc: the section of an upright cylinder."""

    sizes = ("diameter_m", "height_m")
    threefold = True
    fill = math.pi / 4
    rule = "a cylinder has one diameter along x and y"

    def fitted(self, size: Size) -> Size:
        return size[0], size[0], size[2]

    def size(self, *sizes: float) -> Size:
        diameter, height = sizes
        return diameter, diameter, height

    def given(self, size: Size) -> tuple[float, ...]:
        return size[1:]

    def text(self, x: str, y: str, z: str) -> str:
        return f"cylinder ⌀ {x} × {z}"

    def gauge_squared(self, x: Array, y: Array, half: Plane) -> Array:
        return (x * x + y * y) / (half[0] * half[0])

    def clipped(self, position: Array, half: Plane) -> Array:
        radius = np.hypot(position[..., 0], position[..., 1])
        return position / np.maximum(1.0, radius / half[0])[..., None]

    def on_nodes(self, x: NDArray[Any], y: NDArray[Any], half: Plane) -> NDArray[np.bool_]:
        return np.hypot(x[:, None], y) <= half[0]

    def spread(self, share: Array) -> Array:
        radius, angle = 0.5 * np.sqrt(share[:, 0] + 0.5), TURN * share[:, 1]
        return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=-1)

    def farthest(self, center: Plane, half: Plane) -> float:
        return math.hypot(*center) + float(half[0])

    def extent(self, half: Plane, direction: Array) -> float:
        return float(half[0])

    def ray(self, center: Array, half: Array, direction: Array) -> float:
        along = float(center @ direction)
        inside = float(half[0] ** 2 - center @ center)
        return along + math.sqrt(along**2 + inside) if inside >= 0 else 0.0

    def ring(self, count: int, *, third: bool) -> Array:
        angle = np.arange(count if third else 3 * count) * (TURN / (3 * count))
        # legs stand at -30, 90 and 210 degrees: the extremes are about there
        angle = angle + np.pi / 2
        return np.stack([np.cos(angle), np.sin(angle)], axis=-1)

    def filled(self, density: int, half: Plane) -> Array:
        rings = [np.zeros((1, 2))]
        for radius in np.linspace(0.0, half[0], density + 1)[1:]:
            count = DIRECTIONS * max(1, round(density * radius / half[0] / 2))
            angle = np.radians(30.0) + TURN * np.arange(count) / count
            rings.append(radius * np.column_stack([np.cos(angle), np.sin(angle)]))
        return np.concatenate(rings)

    def edge(self) -> tuple[Array, slice]:
        angle = np.linspace(0.0, TURN, EDGE + 1)
        return np.column_stack([np.cos(angle), np.sin(angle)]), slice(0, EDGE, EDGE // 8)

    def arc_distances(
        self, center: Array, radius: Array, alpha: Array, theta: Range, half: Array
    ) -> tuple[Array, Array]:
        near, far = _from_points(center[:, :, None], radius, alpha, theta)
        return near[..., 0] - half[:, :1], far[..., 0] + half[:, :1]


class BoxSection(CrossSection):
    """A rectangle along x and y: the section of a box."""

    sizes = ("size_x_m", "size_y_m", "size_z_m")
    threefold = False
    fill = 1.0

    def fitted(self, size: Size) -> Size:
        return size

    def size(self, *sizes: float) -> Size:
        x, y, z = sizes
        return x, y, z

    def given(self, size: Size) -> tuple[float, ...]:
        return size

    def text(self, x: str, y: str, z: str) -> str:
        return f"box {x} × {y} × {z}"

    def gauge_squared(self, x: Array, y: Array, half: Plane) -> Array:
        return np.fmax((x / half[0]) ** 2, (y / half[1]) ** 2)

    def clipped(self, position: Array, half: Plane) -> Array:
        return np.clip(position, -np.asarray(half), half)

    def on_nodes(self, x: NDArray[Any], y: NDArray[Any], half: Plane) -> NDArray[np.bool_]:
        return np.ones((len(x), len(y)), np.bool_)

    def spread(self, share: Array) -> Array:
        return share

    def farthest(self, center: Plane, half: Plane) -> float:
        return math.hypot(abs(center[0]) + half[0], abs(center[1]) + half[1])

    def extent(self, half: Plane, direction: Array) -> float:
        return float(np.abs(direction) @ half)

    def ray(self, center: Array, half: Array, direction: Array) -> float:
        if (np.abs(center) > half).any():
            return 0.0
        with np.errstate(divide="ignore"):
            return float(((half + np.sign(direction) * center) / np.abs(direction)).min())

    def ring(self, count: int, *, third: bool) -> Array:
        along = np.linspace(-1.0, 1.0, max(2, (3 * count) // 4 + 1))[:-1]
        ones = np.ones_like(along)
        sides = [(along, -ones), (ones, along), (-along, ones), (-ones, -along)]
        return np.concatenate([np.stack(side, axis=-1) for side in sides])

    def filled(self, density: int, half: Plane) -> Array:
        side = np.linspace(-1.0, 1.0, 2 * density + 1)
        x, y = np.meshgrid(half[0] * side, half[1] * side, indexing="ij")
        return np.stack([x, y], axis=-1).reshape(-1, 2)

    def edge(self) -> tuple[Array, slice]:
        return np.concatenate([_CORNERS, _CORNERS[:1]]), slice(0, 4)

    def arc_distances(
        self, center: Array, radius: Array, alpha: Array, theta: Range, half: Array
    ) -> tuple[Array, Array]:
        corners = center[:, :, None] + _CORNERS * half[:, None, None, :2]
        _, far = _from_points(corners, radius, alpha, theta)
        return _from_rectangle(center, radius, alpha, theta, half[:, :2]), far.max(axis=-1)


class WorkspaceShape(Enum):
    """Shape of a regular workspace; its axis is vertical."""

    CYLINDER = "cylinder"
    BOX = "box"

    @property
    def section(self) -> CrossSection:
        """Its horizontal section."""
        return _SECTIONS[self]


_SECTIONS: dict[WorkspaceShape, CrossSection] = {
    WorkspaceShape.CYLINDER: CylinderSection(),
    WorkspaceShape.BOX: BoxSection(),
}


def _from_points(g: Array, radius: Array, alpha: Array, theta: Range) -> tuple[Array, Array]:
    """Return extremes of |g + radius (cos, sin)(alpha + theta)| over theta, each (n, 3, p).

    Of vectors g (n, 3, p, 2).
    """
    angle, length = np.arctan2(g[..., 1], g[..., 0]) - alpha, np.hypot(g[..., 0], g[..., 1])
    ends = np.stack([_at(g, radius, alpha + end) for end in theta])
    near = np.where(_on_arc(angle + np.pi, theta), np.abs(length - radius), ends.min(axis=0))
    return near, np.where(_on_arc(angle, theta), length + radius, ends.max(axis=0))


def _on_arc(angle: Array, theta: Range) -> NDArray[np.bool_]:
    """Return which angles are in a range, which rounding may not make shorter, to whole turns."""
    return (angle - theta[0] + _LONGER) % TURN <= theta[1] - theta[0] + 2.0 * _LONGER


def _at(g: Array, radius: Array, angle: Array) -> Array:
    return np.hypot(g[..., 0] + radius * np.cos(angle), g[..., 1] + radius * np.sin(angle))


def _from_rectangle(g: Array, radius: Array, alpha: Array, theta: Range, half: Array) -> Array:
    """Return the least distances of arcs -(g + radius (cos, sin)(alpha + theta)) from rectangles.

    Of vectors g (n, 3, 2) and rectangles of half-widths (n, 2) about the origin; (n, 3). It is at
    an end of the arc, nearest to a corner, where the arc is parallel to a side, or zero where it
    crosses a side.
    """
    n = len(g)
    toward = g[:, :, None] + _CORNERS * half[:, None, None]
    nearest = np.arctan2(-toward[..., 1], -toward[..., 0])
    parallel = np.broadcast_to(0.5 * np.pi * np.arange(4), (n, 3, 4))
    sides = np.array([1.0, -1.0])
    with np.errstate(invalid="ignore"):
        x = np.arccos((sides * half[:, :1, None] - g[..., :1]) / radius)
        y = np.arcsin((sides * half[:, 1:, None] - g[..., 1:]) / radius)
    crossing = np.concatenate([x, -x, y, np.pi - y], axis=-1)
    angles = np.concatenate([nearest, parallel, crossing], axis=-1)
    inside = _on_arc(angles - alpha, theta)
    ends = np.broadcast_to(alpha + np.array(theta), (n, 3, 2))
    angles = np.concatenate([np.where(inside, angles, ends[..., :1]), ends], axis=-1)
    px = np.abs(g[..., :1] + radius * np.cos(angles)) - half[:, None, :1]
    py = np.abs(g[..., 1:] + radius * np.sin(angles)) - half[:, None, 1:]
    away = np.hypot(np.maximum(px, 0.0), np.maximum(py, 0.0))
    # On a crossing rounding decides over inside or outside.
    return np.where(away < 1e-12, 0.0, away).min(axis=-1)
