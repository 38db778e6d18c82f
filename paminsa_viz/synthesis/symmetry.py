"""Poses that stand for others by the robot's symmetry.

Turning (x, y) by 120 degrees with theta kept exchanges the legs, and so does the mirror image
(-x, y, -theta). What does not tell legs apart has the same values there, apart from rounding, for
which `SLACK` is kept free.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.model.arrays import Array
from paminsa_viz.quantities.requirements import WorkspaceShape
from paminsa_viz.synthesis.families import BoundGroup
from paminsa_viz.synthesis.region_margins import PoseRegion

SLACK = 1e-11
"""Margin that is kept where a pose stands for others, as a share of the bound."""

_ALIKE = frozenset({"condition", "conditioning", "determinant", "f_4", "max_torque", "rms_torque"})
"""Quantities that do not tell legs apart, nor the two senses of a turn."""

_TANGENT = 1.0 / np.sqrt(3.0)


@dataclass(frozen=True)
class Symmetry:
    """What poses have to be looked at.

    Attributes:
        third: Positions within 60 degrees of the y-axis stand for all.
        mirror: Headings from 0 on stand for all.
    """

    third: bool
    mirror: bool

    @property
    def any(self) -> bool:
        """Whether poses stand for others."""
        return self.third or self.mirror

    def kept(self, middle: Array, half: Array) -> NDArray[np.bool_]:
        """Return which boxes (n, 4) have poses that stand for others (n,)."""
        if not self.third:
            return np.ones(len(middle), np.bool_)
        nearest = np.maximum(np.abs(middle[:, 0]) - half[:, 0], 0.0)
        return middle[:, 1] + half[:, 1] >= nearest * _TANGENT - SLACK


NONE = Symmetry(False, False)
"""Every pose stands for itself."""


def symmetry(group: BoundGroup, region: PoseRegion) -> Symmetry:
    """Return the symmetry that requirements and the region have in common.

    A horizontal force or a vertical moment on the platform leaves none.
    """
    load = group.design.load
    alike = all(bound.quantity in _ALIKE for bound in group.requirements)
    if not alike or load.force_x or load.force_y or load.moment_z:
        return NONE
    x, y, _ = region.center
    low, high = group.theta
    round_ = region.shape is WorkspaceShape.CYLINDER
    return Symmetry(round_ and x == 0.0 and y == 0.0, x == 0.0 and low == -high and high > 0.0)
