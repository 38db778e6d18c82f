"""The required poses: distances that they have from the limits of reach, in closed form.

Over a workspace that is a set of (x, y) times an interval of heights, with an interval of theta, a
leg's X_1 and z_5 vary independently. So the margins of reach over all poses follow from four
numbers a leg: the least and largest X_1, and the least and largest |z_5|. X_1 is the distance of
(x, y) from a point on a circle about the leg axis, a convex function of (x, y).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from paminsa_viz.model.arrays import Array
from paminsa_viz.model.geometry import Geometry
from paminsa_viz.quantities.requirements import Range, Workspace
from paminsa_viz.synthesis.volume.reach import leg_distances


class Spans(NamedTuple):
    """Ranges of the legs' lengths over all poses, of n robots each (n,)."""

    rho_least: Array  # least X_1 of any leg [m]
    rho_most: Array
    zeta_least: Array  # least |z_5| [m]
    zeta_most: Array
    beyond: Array  # how far joints 5 get above the guides (lower knee), or below them [m]

    def diagonals(self, magnification: Array) -> Array:
        """Return the least and largest distance of joints 8 and 5, (n, 2) [m].

        X_1 and z_5 are independent of each other, so that both are reached.
        """
        wide = magnification / (magnification - 1)
        near = np.hypot(wide * self.rho_least, self.zeta_least)
        return np.stack([near, np.hypot(wide * self.rho_most, self.zeta_most)], axis=-1)


def center(workspace: Workspace) -> Array:
    """Return the center in the horizontal plane (2,) [m]."""
    x, y, _ = workspace.center
    return np.array([x or 0.0, y or 0.0])


def half_extents(workspace: Workspace) -> Array:
    """Return the half extents in the horizontal plane (2,) [m]."""
    return 0.5 * np.array(workspace.size[:2])


def farthest(workspace: Workspace) -> float:
    """Return the largest distance of the workspace from the z-axis [m]."""
    return workspace.shape.section.farthest(center(workspace), half_extents(workspace))


def extent(workspace: Workspace, direction: Array) -> float:
    """Return how far the workspace extends along a horizontal unit vector (2,), from z [m]."""
    beyond = workspace.shape.section.extent(half_extents(workspace), direction)
    return float(center(workspace) @ direction) + beyond


def ray(workspace: Workspace, direction: Array) -> float:
    """Return how far from the z-axis a horizontal ray leaves the workspace [m], 0 if outside."""
    section = workspace.shape.section
    return section.ray(center(workspace), half_extents(workspace), direction)


def spans(geometries: Sequence[Geometry], workspaces: Sequence[Workspace], theta: Range) -> Spans:
    """Return the ranges of the legs' lengths of n robots, each over its workspace.

    Args:
        geometries: Lengths of the mechanisms.
        workspaces: One of each robot, of one shape; their heights are known.
        theta: Least and largest heading [rad].
    """
    first = workspaces[0]
    half = 0.5 * np.array([w.size for w in workspaces])
    near, far = leg_distances(
        np.array([g.base_radius for g in geometries]),
        np.array([g.platform_radius for g in geometries]),
        center(first), half, theta, first.shape,
    )  # fmt: skip
    z = np.array([w.center[2] for w in workspaces], np.float64)
    z = z + np.array([g.platform_joint_height for g in geometries])
    low, high = z - half[:, 2], z + half[:, 2]
    sign = np.array([g.knee.sign for g in geometries])
    return Spans(
        near.min(axis=1),
        far.max(axis=1),
        np.maximum(np.maximum(low, -high), 0.0),
        np.maximum(-low, high),
        np.where(sign > 0, high, -low),
    )


def reach_margins(geometries: Sequence[Geometry], found: Spans) -> Array:
    """Return the least margins of n robots over all poses (n, 4) [m].

    In the order of `reach.MARGINS`.
    """
    crank = np.array([g.crank_length for g in geometries])
    coupler = np.array([g.coupler_length for g in geometries])
    k = np.array([g.magnification for g in geometries])
    near, far = found.diagonals(k).T
    return np.stack(
        [
            crank + coupler - far,
            near - np.abs(crank - coupler),
            np.array([g.stroke for g in geometries]) - found.rho_most / (k - 1),
            found.rho_least - np.array([g.axis_clearance for g in geometries]),
        ],
        axis=-1,
    )


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

SPARSE = Density(around=4, rings=2, theta=3, z=3)
"""How close they lie for what takes long in a pose: distances of bodies, stiffness."""


@dataclass(frozen=True, eq=False)
class TrialSamples:
    """Positions and headings of a workspace of width 1, and heights as shares of its height.

    Attributes:
        within: Positions inside and on its outline, of radius 1 or half-widths (1, 1) (m, 2).
        theta: Headings (k,) [rad].
        share: Heights from -1/2 to 1/2 (l,).
        wrench: The load's (f_x, f_y, m_z) at the headings (k, 3) [N, N m]; none if empty.
    """

    within: Array
    theta: Array
    share: Array
    wrench: Array = field(default_factory=lambda: np.empty((0, 3)))

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
    centered, section = not center(workspace).any(), workspace.shape.section
    third = alike and centered and section.threefold
    mirrored = alike and workspace.center[0] == 0.0 and theta[0] == -theta[1]

    outer = section.ring(density.around, third=third)
    half = section.ring(max(1, density.around // 2), third=third)
    inner = [share * half for share in np.linspace(1.0, 0.0, density.rings)[1:-1]]
    within = np.concatenate([outer, *inner, np.zeros((1, 2))])
    low = 0.0 if mirrored else theta[0]
    turns = max(2, (density.theta + 1) // 2) if mirrored else density.theta
    angles = np.linspace(low, theta[1], turns) if theta[1] > low else np.array([low])
    return TrialSamples(within, angles, np.linspace(-0.5, 0.5, density.z))
