"""Poses of a workspace at which a trial robot is evaluated."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from paminsa_viz.model.arrays import Array
from paminsa_viz.quantities.requirements import Range, Workspace, WorkspaceShape
from paminsa_viz.synthesis.region import center


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
