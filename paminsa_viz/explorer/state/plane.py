"""The plane of the maps, on which static torques are balanced."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from paminsa_viz.kept import kept
from paminsa_viz.model import Design, Field, Geometry, Limit
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.singular_limit import counting
from paminsa_viz.plots.map_values import FULL, frame_half, workspace_field


@dataclass(frozen=True)
class PlaneJob:
    """A job on a design at the poses of the maps, with all it depends on.

    Attributes:
        design: The robot.
        theta, z: The plane of the poses [rad, m].
        condition_limit: Largest condition number of a pose that counts.
        settings: What a person set.
    """

    design: Design
    theta: float
    z: float
    condition_limit: float
    settings: Any

    def plane(self, cells: int) -> Field:
        """Return the plane with some cells along each side; poses that do not count are singular.

        Torques have no bound there: a peak would be that of the cell that happens to come nearest.
        """
        return _plane(self.design.geometry, self.theta, self.z, cells, self.condition_limit)

    def of_maps(self) -> Field:
        """Return the plane on the cells of the maps and of their files, as `plane` does."""
        half = frame_half(self.design.geometry, self.theta, self.z)
        return _plane(self.design.geometry, self.theta, self.z, FULL, self.condition_limit, half)

    def poses(self, cells: int) -> Array:
        """Return the poses of the plane that count, (n, 4)."""
        field = self.plane(cells)
        return field.grid.poses()[field.status == Limit.OK]


@kept(4)
def _plane(
    geometry: Geometry,
    theta: float,
    z: float,
    cells: int,
    limit: float,
    half: float | None = None,
) -> Field:
    field = workspace_field(geometry, theta, z, cells, half)
    near = (field.status == Limit.OK) & ~counting(field, limit)
    return replace(field, status=np.where(near, np.uint8(Limit.SINGULAR), field.status))
