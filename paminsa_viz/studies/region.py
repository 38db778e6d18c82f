"""A region of the workspace, and a design solved over it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.checks import require_positive
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.grids import Field, Grid, solve_field
from paminsa_viz.model.reach import Limit, home_pose
from paminsa_viz.model.singular_limit import CONDITION_LIMIT, counting, require_condition
from paminsa_viz.units import format_value

if TYPE_CHECKING:
    from paminsa_viz.quantities import Quantity

MOST_CELLS = 1000
"""Most cells along a side."""


@dataclass(frozen=True)
class Region:
    """The poses that designs are measured over: a disc of positions, at some angles and heights.

    Attributes:
        radius: Of the disc about the center [m].
        theta: Angles of the platform [rad].
        z: Heights of the platform [m].
        cells: Positions along the disc's diameter.
        max_condition: Largest condition number of a pose whose torques count, see
            `paminsa_viz.model.singular_limit`.

    Raises:
        InvalidInput: If a number is not possible.
    """

    radius: float
    theta: tuple[float, ...]
    z: tuple[float, ...]
    cells: int = 40
    max_condition: float = CONDITION_LIMIT

    def __post_init__(self) -> None:
        require_positive(self.radius, "radius", "a length above 0")
        for name, values in (("theta", self.theta), ("z", self.z)):
            if not values or not np.isfinite(values).all():
                raise InvalidInput(name, "one finite number at least is needed")
        if not 2 <= self.cells <= MOST_CELLS:
            raise InvalidInput("cells", f"2 to {MOST_CELLS} cells are possible, not {self.cells}")
        require_condition(self.max_condition)

    @property
    def words(self) -> str:
        """Where its poses are: ``within 175 mm of the axis at θ 0°, 30° and z −552 mm``."""
        angles = ", ".join(format_value(angle, "rad") for angle in self.theta)
        heights = ", ".join(format_value(z, "m") for z in self.z)
        return f"within {format_value(self.radius, 'm')} of the axis at θ {angles} and z {heights}"

    def grid(self) -> Grid:
        """Return the poses, (theta, z, y, x); those outside the disc are for `inside` to drop."""
        side = self.radius * ((2 * np.arange(self.cells) + 1) / self.cells - 1)
        return Grid.over((0.0, 0.0, 0.0, 0.0), theta=self.theta, z=self.z, y=side, x=side)

    def inside(self, grid: Grid) -> np.ndarray:
        """Return which positions (y, x) of the grid lie in the disc."""
        x, y = grid.axes[3][1], grid.axes[2][1]
        return np.hypot(x[None, :], y[:, None]) <= self.radius


@of_design
def default_region(design: Design) -> Region:
    """Return half the base radius about the center, at 0 and 30 degrees, at the home height."""
    height = home_pose(design.geometry)[3]
    return Region(design.geometry.base_radius / 2, (0.0, float(np.radians(30))), (height,))


@dataclass(frozen=True)
class RegionResults:
    """A design solved over a region; the masks have the shape of the grid, (theta, z, y, x).

    Attributes:
        design, region: The robot and the poses.
        base_mass: What the added mass is counted from [kg].
    """

    design: Design
    region: Region
    base_mass: float = 0.0

    @cached_property
    def field(self) -> Field:
        """The solved grid."""
        return solve_field(self.design.geometry, self.region.grid(), threads=1)

    @cached_property
    def inside(self) -> NDArray[np.bool_]:
        """Where a pose belongs to the region."""
        return np.broadcast_to(self.region.inside(self.field.grid), self.field.status.shape)

    @cached_property
    def reached(self) -> NDArray[np.bool_]:
        """Where a pose of the region can be reached."""
        return self.inside & (self.field.status == Limit.OK)

    @cached_property
    def usable(self) -> NDArray[np.bool_]:
        """Where it is not too close to a singularity either."""
        return self.reached & counting(self.field, self.region.max_condition)

    @cached_property
    def torques(self) -> Array:
        """Static torques of the usable poses, (4, n) [N m, N]."""
        return self.field.torques(self.design)[:, self.usable]

    @cached_property
    def conditions(self) -> Array:
        """Condition numbers of the poses that can be reached, (n,)."""
        return self.field.condition[self.reached]

    def values(self, quantity: Quantity) -> Array:
        """Return a quantity at the poses that can be reached and have a value, (n,) [SI]."""
        values = quantity.over(self.field, self.design)[self.reached]
        return values[~np.isnan(values)]

    def share(self, poses: NDArray[np.bool_]) -> float:
        """Return the share of the region's poses that a mask holds."""
        return int(poses.sum()) / int(self.inside.sum())
