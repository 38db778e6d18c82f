"""The required poses: distances that they have from the limits of reach, in closed form.

Over a workspace that is a set of (x, y) times an interval of heights, with an interval of theta, a
leg's X_1 and z_5 vary independently. So the margins of reach over all poses follow from four
numbers a leg: the least and largest X_1, and the least and largest |z_5|. X_1 is the distance of
(x, y) from a point on a circle about the leg axis, a convex function of (x, y).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from paminsa_viz.model.arrays import Array
from paminsa_viz.model.geometry import Geometry
from paminsa_viz.model.robot import AXIS_X, AXIS_Y
from paminsa_viz.quantities.requirements import Range, Workspace, WorkspaceShape

AXES = np.stack([AXIS_X, AXIS_Y], axis=-1)
"""Directions of the leg axes (3, 2)."""

SIGNS = np.array([(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)])
"""Corners of a square."""


class Spans(NamedTuple):
    """Ranges of the legs' lengths over all poses, of n robots each (n,)."""

    rho_least: Array  # least X_1 of any leg [m]
    rho_most: Array
    zeta_least: Array  # least |z_5| [m]
    zeta_most: Array
    beyond: Array  # how far joints 5 get above the guides (lower knee), or below them [m]


def corners(workspace: Workspace) -> Array:
    """Return the corners of a box in the horizontal plane, from its center (4, 2) [m]."""
    return 0.5 * SIGNS * np.array(workspace.size[:2])


def center(workspace: Workspace) -> Array:
    """Return the center in the horizontal plane (2,) [m]."""
    x, y, _ = workspace.center
    return np.array([x or 0.0, y or 0.0])


def farthest(workspace: Workspace) -> float:
    """Return the largest distance of the workspace from the z-axis [m]."""
    middle = center(workspace)
    if workspace.shape is WorkspaceShape.CYLINDER:
        return float(np.hypot(*middle)) + 0.5 * workspace.size[0]
    return float(np.hypot(*(corners(workspace) + middle).T).max())


def extent(workspace: Workspace, direction: Array) -> float:
    """Return how far the workspace extends along a horizontal unit vector (2,), from z [m]."""
    middle = float(center(workspace) @ direction)
    if workspace.shape is WorkspaceShape.CYLINDER:
        return middle + 0.5 * workspace.size[0]
    return middle + float((corners(workspace) @ direction).max())


def ray(workspace: Workspace, direction: Array) -> float:
    """Return how far from the z-axis a horizontal ray leaves the workspace [m], 0 if outside."""
    middle = center(workspace)
    if workspace.shape is WorkspaceShape.CYLINDER:
        along = float(middle @ direction)
        inside = (0.5 * workspace.size[0]) ** 2 - float(middle @ middle)
        return along + float(np.sqrt(along**2 + inside)) if inside >= 0 else 0.0
    half = 0.5 * np.array(workspace.size[:2])
    if (np.abs(middle) > half).any():
        return 0.0
    with np.errstate(divide="ignore"):
        return float(((half + np.sign(direction) * middle) / np.abs(direction)).min())


def spans(geometries: Sequence[Geometry], workspaces: Sequence[Workspace], theta: Range) -> Spans:
    """Return the ranges of the legs' lengths of n robots, each over its workspace.

    Args:
        geometries: Lengths of the mechanisms.
        workspaces: One of each robot, of one shape; their heights are known.
        theta: Least and largest heading [rad].
    """
    first = workspaces[0]
    rb = np.array([g.base_radius for g in geometries])[:, None, None]
    rp = np.array([g.platform_radius for g in geometries])[:, None, None]
    half = 0.5 * np.array([w.size for w in workspaces])
    # Joint 5 relative to the leg axis is q + g + R_pl (cos, sin)(alpha + theta), q in the workspace
    # about its center.
    g = center(first) - rb * AXES  # (n, 3, 2)
    alpha = np.arctan2(AXES[:, 1], AXES[:, 0])[:, None]
    if first.shape is WorkspaceShape.CYLINDER:
        radius = half[:, :1, None]
        far = _distance(g[:, :, None], rp, alpha, theta, largest=True) + radius
        near = _distance(g[:, :, None], rp, alpha, theta, largest=False) - radius
    else:
        at_corners = g[:, :, None] + SIGNS * half[:, None, None, :2]
        far = _distance(at_corners, rp, alpha, theta, largest=True)
        near = _from_box(g, rp, alpha, theta, half[:, :2])
    z = np.array([w.center[2] for w in workspaces], np.float64)
    z = z + np.array([g.platform_joint_height for g in geometries])
    low, high = z - half[:, 2], z + half[:, 2]
    sign = np.array([g.knee.sign for g in geometries])
    return Spans(
        np.maximum(near.min(axis=(1, 2)), 0.0),
        far.max(axis=(1, 2)),
        np.maximum(np.maximum(low, -high), 0.0),
        np.maximum(np.abs(low), np.abs(high)),
        np.where(sign > 0, high, -low),
    )


def reach_margins(geometries: Sequence[Geometry], found: Spans) -> Array:
    """Return the least margins of n robots over all poses (n, 4) [m].

    In the order of `reach.MARGINS`.
    """
    crank = np.array([g.crank_length for g in geometries])
    coupler = np.array([g.coupler_length for g in geometries])
    k = np.array([g.magnification for g in geometries])
    wide = k / (k - 1)
    return np.stack(
        [
            crank + coupler - np.hypot(wide * found.rho_most, found.zeta_most),
            np.hypot(wide * found.rho_least, found.zeta_least) - np.abs(crank - coupler),
            np.array([g.stroke for g in geometries]) - found.rho_most / (k - 1),
            found.rho_least - np.array([g.axis_clearance for g in geometries]),
        ],
        axis=-1,
    )


def _distance(g: Array, radius: Array, alpha: Array, theta: Range, *, largest: bool) -> Array:
    """Return extremes of |g + radius (cos, sin)(alpha + theta)| over theta (n, 3, p).

    Of vectors g (n, 3, p, 2).
    """
    angle = np.arctan2(g[..., 1], g[..., 0]) + (0.0 if largest else np.pi)
    inside = (angle - alpha - theta[0]) % (2 * np.pi) <= theta[1] - theta[0]
    length = np.hypot(g[..., 0], g[..., 1])
    ends = np.stack([_at(g, radius, alpha + end) for end in theta])
    if largest:
        return np.where(inside, length + radius, ends.max(axis=0))
    return np.where(inside, np.abs(length - radius), ends.min(axis=0))


def _at(g: Array, radius: Array, angle: Array) -> Array:
    return np.hypot(g[..., 0] + radius * np.cos(angle), g[..., 1] + radius * np.sin(angle))


def _from_box(g: Array, radius: Array, alpha: Array, theta: Range, half: Array) -> Array:
    """Return the least distances of arcs -(g + radius (cos, sin)(alpha + theta)) from a box.

    Of vectors g (n, 3, 2) and boxes of half-widths (n, 2) about the origin; (n, 3, 1). It is at an
    end of the arc, nearest to a corner, where the arc is parallel to a side, or zero where it
    crosses a side.
    """
    n = len(g)
    toward = g[:, :, None] + SIGNS * half[:, None, None]
    nearest = np.arctan2(-toward[..., 1], -toward[..., 0])
    parallel = np.broadcast_to(0.5 * np.pi * np.arange(4), (n, 3, 4))
    sides = np.array([1.0, -1.0])
    with np.errstate(invalid="ignore"):
        x = np.arccos((sides * half[:, :1, None] - g[..., :1]) / radius)
        y = np.arcsin((sides * half[:, 1:, None] - g[..., 1:]) / radius)
    crossing = np.concatenate([x, -x, y, np.pi - y], axis=-1)
    angles = np.concatenate([nearest, parallel, crossing], axis=-1)
    inside = (angles - alpha - theta[0]) % (2 * np.pi) <= theta[1] - theta[0]
    ends = np.broadcast_to(alpha + np.array(theta), (n, 3, 2))
    angles = np.concatenate([np.where(inside, angles, ends[..., :1]), ends], axis=-1)
    px = np.abs(g[..., :1] + radius * np.cos(angles)) - half[:, None, :1]
    py = np.abs(g[..., 1:] + radius * np.sin(angles)) - half[:, None, 1:]
    away = np.hypot(np.maximum(px, 0.0), np.maximum(py, 0.0))
    # On a crossing rounding decides over inside or outside.
    return np.where(away < 1e-12, 0.0, away).min(axis=-1, keepdims=True)


@dataclass(frozen=True)
class Density:
    """How closely poses lie.

    Attributes:
        around: Positions on the outline of the workspace, for every 120 degrees.
        rings: Outlines, from the center to the outermost; those within have half as many.
        theta: Headings.
        z: Heights.
    """

    around: int = 12
    rings: int = 4
    theta: int = 5
    z: int = 5

    def finer(self, times: int) -> Density:
        """Return the same with poses that are closer in each direction."""
        return replace(
            self,
            around=times * self.around,
            rings=times * (self.rings - 1) + 1,
            theta=times * (self.theta - 1) + 1,
            z=times * (self.z - 1) + 1,
        )


TRIAL = Density()
"""How close the poses of a trial lie."""


@dataclass(frozen=True, eq=False)
class TrialSamples:
    """Positions and headings of a workspace of width 1, and heights as shares of its height.

    Attributes:
        outline: Positions on its outline (n, 2), of the radius 1 or the half-widths (1, 1).
        within: Positions inside, and the outline (m, 2).
        theta: Headings (k,) [rad].
        share: Heights from -1/2 to 1/2 (l,).
    """

    outline: Array
    within: Array
    theta: Array
    share: Array

    @cached_property
    def turns(self) -> Array:
        """Cosine and sine of the headings (k, 2)."""
        return np.stack([np.cos(self.theta), np.sin(self.theta)], axis=-1)

    @property
    def poses(self) -> int:
        """How many poses there are."""
        return len(self.within) * len(self.theta) * len(self.share)

    def place(self, positions: Array, workspace: Workspace) -> Array:
        """Return the positions in a workspace (n, 2) [m]."""
        return center(workspace) + 0.5 * positions * np.array(workspace.size[:2])


def sample(
    workspace: Workspace, theta: Range, density: Density, *, alike: bool = False
) -> TrialSamples:
    """Return samples of a workspace.

    Args:
        workspace: The workspace, of which only shape and center count.
        theta: Least and largest heading [rad].
        density: How close they lie.
        alike: Whether nothing tells the three legs from each other, in a load or a bound. A third
            of a cylinder about the z-axis then has all values, and so has one half of the headings
            if they are the same to both sides.
    """
    centered = not center(workspace).any()
    cylinder = workspace.shape is WorkspaceShape.CYLINDER
    third = alike and centered and cylinder
    mirrored = alike and workspace.center[0] == 0.0 and theta[0] == -theta[1]

    def ring(count: int) -> Array:
        if cylinder:
            angle = np.arange(count if third else 3 * count) * (2 * np.pi / (3 * count))
            # legs stand at -30, 90 and 210 degrees: the extremes are about there
            angle = angle + np.pi / 2
            return np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        along = np.linspace(-1.0, 1.0, max(2, (3 * count) // 4 + 1))[:-1]
        ones = np.ones_like(along)
        sides = [(along, -ones), (ones, along), (-along, ones), (-ones, -along)]
        return np.concatenate([np.stack(side, axis=-1) for side in sides])

    outline = ring(density.around)
    inner = [
        share * ring(max(1, density.around // 2))
        for share in np.linspace(1.0, 0.0, density.rings)[1:-1]
    ]
    within = np.concatenate([outline, *inner, np.zeros((1, 2))])
    low = 0.0 if mirrored else theta[0]
    turns = max(2, (density.theta + 1) // 2) if mirrored else density.theta
    angles = np.linspace(low, theta[1], turns) if theta[1] > low else np.array([low])
    return TrialSamples(outline, within, angles, np.linspace(-0.5, 0.5, density.z))
