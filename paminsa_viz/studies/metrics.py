"""What a study measures of a design: its static loads and its distances to every limit over a
region of the workspace."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from paminsa_viz.balancing.changes import whole_mass
from paminsa_viz.model.design import Design
from paminsa_viz.model.errors import InvalidInput
from paminsa_viz.model.grids import Field, Grid, solve_field
from paminsa_viz.model.reach import Limit
from paminsa_viz.model.singularity import singular_radius, singular_rotation
from paminsa_viz.model.statics import static_imbalance
from paminsa_viz.trajectory.presets import home

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
        max_condition: Condition number above which a pose counts as too near to a singular one for
            its torques to be of interest.

    Raises:
        InvalidInput: If a number is not possible.
    """

    radius: float
    theta: tuple[float, ...]
    z: tuple[float, ...]
    cells: int = 40
    max_condition: float = 10.0

    def __post_init__(self) -> None:
        if not (np.isfinite(self.radius) and self.radius > 0):
            raise InvalidInput("radius", f"a length above 0 is needed, not {self.radius!r}")
        for name, values in (("theta", self.theta), ("z", self.z)):
            if not values or not np.isfinite(values).all():
                raise InvalidInput(name, "one finite number at least is needed")
        if not 2 <= self.cells <= MOST_CELLS:
            problem = f"2 to {MOST_CELLS} cells are possible, not {self.cells}"
            raise InvalidInput("cells", problem)
        if not self.max_condition >= 1:
            raise InvalidInput("max_condition", "1 is the least condition number there is")

    def grid(self) -> Grid:
        """Return the poses, (theta, z, y, x); those outside the disc are for `inside` to drop."""
        side = self.radius * ((2 * np.arange(self.cells) + 1) / self.cells - 1)
        return Grid.over((0.0, 0.0, 0.0, 0.0), theta=self.theta, z=self.z, y=side, x=side)

    def inside(self, grid: Grid) -> np.ndarray:
        """Return which positions (y, x) of the grid lie in the disc."""
        x, y = grid.axes[3][1], grid.axes[2][1]
        return np.hypot(x[None, :], y[:, None]) <= self.radius


def default_region(design: Design) -> Region:
    """Return half the base radius about the center, at 0 and 30 degrees, at the home height."""
    height = float(home(design.geometry)[3])
    return Region(design.geometry.base_radius / 2, (0.0, float(np.radians(30))), (height,))


@dataclass(frozen=True)
class Metric:
    """One number of a design.

    Attributes:
        column: Its name in tables, with its unit.
        meaning: What it is.
    """

    column: str
    meaning: str


METRICS: tuple[Metric, ...] = (
    Metric("Mp2_N", "M_p2, 0 for a robot that is balanced statically (Eq. 8)"),
    Metric("mass_kg", "mass of all that moves, with the payload"),
    Metric("added_mass_kg", "mass beyond that of the first design"),
    Metric("reached_share", "share of the region that can be reached"),
    Metric("usable_share", "share of the region that can be reached with a good condition number"),
    Metric("peak_torque_Nm", "largest static torque of M1 to M3 over the usable poses"),
    Metric("rms_torque_Nm", "RMS of the static torques of M1 to M3 over the usable poses"),
    Metric("peak_force_N", "largest static force of M4 over the usable poses"),
    Metric("worst_condition", "largest condition number over the poses that can be reached"),
    Metric("median_condition", "median condition number over the poses that can be reached"),
    Metric("reach_margin_m", "least distance of the region to a limit of reach, negative beyond"),
    Metric("singular_distance_m", "from the region to the singular circle, negative if it crosses"),
    Metric("singular_turn_rad", "from the region to the singular angle; none if R_pl > R_b"),
)
"""Everything that is measured, in the order of a table's columns."""


def measure_design(
    design: Design,
    region: Region,
    *,
    base_mass: float = 0.0,
) -> tuple[float, ...]:
    """Return the `METRICS` of a design [SI]; NaN where there is none, as without a usable pose.

    Args:
        design: The robot.
        region: The poses.
        base_mass: What the added mass is counted from [kg].
    """
    grid = region.grid()
    field = solve_field(design.geometry, grid, threads=1)
    inside = np.broadcast_to(region.inside(grid), field.status.shape)
    poses = int(inside.sum())
    reached = inside & (field.status == Limit.OK)
    condition = field.condition
    usable = reached & (condition <= region.max_condition)
    known = condition[reached]
    mass = whole_mass(design)
    turn = max(abs(angle) for angle in region.theta)
    circle = float(singular_radius(design.geometry, region.theta).min())
    return (
        static_imbalance(design),
        mass,
        mass - base_mass,
        int(reached.sum()) / poses,
        int(usable.sum()) / poses,
        *_loads(design, field, usable),
        float(known.max()) if known.size else np.nan,
        float(np.median(known)) if known.size else np.nan,
        float(field.margin[inside].min()),
        circle - region.radius,
        singular_rotation(design.geometry) - turn,
    )


def _loads(design: Design, field: Field, usable: np.ndarray) -> tuple[float, float, float]:
    """Return peak and RMS of the rotary torques [N m] and the peak of the lifting force [N]."""
    if not usable.any():
        return np.nan, np.nan, np.nan
    torque = field.torques(design)[:, usable]
    rotary = torque[:3]
    rms = float(np.sqrt(np.mean(rotary**2)))
    return float(np.abs(rotary).max()), rms, float(np.abs(torque[3]).max())
