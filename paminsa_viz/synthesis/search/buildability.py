"""Whether a robot can be built as it is drawn, and how stiff it is, over a required workspace.

The table of it beside the reference's is `blocks.synthesis.buildability_table`, which the command,
the report and the page print alike.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from paminsa_viz.clearance import clearance
from paminsa_viz.dimensions.needs import needed_guide, needed_shaft
from paminsa_viz.kept import kept
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.lumped import mass_vector
from paminsa_viz.model.reach import check_reach
from paminsa_viz.progress import Progress, go_on, of_part
from paminsa_viz.quantities.requirements import Range, Workspace
from paminsa_viz.synthesis.search.extremes import OVER_POSES, Extent, Valued, least_over
from paminsa_viz.synthesis.search.objectives import legs_and_platform
from paminsa_viz.synthesis.search.region import SPARSE, reach_margins, spans

RANDOM = 1000
"""Poses of which the share that overlaps is counted."""

HEIGHTS = 81
"""Heights at which a reference is tried."""


@dataclass(frozen=True, eq=False)
class Buildability:
    """How a robot is drawn, and how stiff it is, over a workspace.

    Extremes are those of samples and a pattern search from the worst of them, over the poses that
    can be taken; NaN where there is none.

    Attributes:
        center: Center of the workspace [m].
        within_reach: Share of the poses that can be taken.
        clearance: Least distance of two bodies as they are drawn, negative where they overlap [m].
        bodies: Names of the two.
        worst: The pose where it is (4,) [m, m, rad, m].
        overlapping: Share of the poses in which bodies overlap, of those that can be taken.
        stiffness: Least stiffness in the softest horizontal direction [N/m].
        frequency: Least first natural frequency, motors locked [Hz].
        guide, needed_guide: Length of B10, and the least one that carries the whole slider [m].
        shaft, needed_shaft: Length of B2, and the least one that keeps the arms above the drives,
            or with the upper knee above the platform [m].
        moving_mass: Mass of the platform and of all legs with their counterweights [kg].
    """

    center: tuple[float, float, float]
    within_reach: float
    clearance: float
    bodies: tuple[str, str]
    worst: Array
    overlapping: float
    stiffness: float
    frequency: float
    guide: float
    needed_guide: float
    shaft: float
    needed_shaft: float
    moving_mass: float

    @property
    def clear(self) -> bool:
        """Whether no two bodies overlap, and guide and shaft are long enough."""
        long = self.guide >= self.needed_guide and self.shaft >= self.needed_shaft
        return self.clearance > 0 and self.overlapping == 0 and long


def best_height(design: Design, workspace: Workspace, theta: Range) -> Workspace:
    """Return a workspace at the height where a robot has the largest margin of reach."""
    bars = design.geometry.crank_length + design.geometry.coupler_length
    side = -design.geometry.knee.sign
    far, near = side * (bars + workspace.size[2]), side * 0.5 * workspace.size[2]
    x, y, _ = workspace.center
    heights = np.linspace(far, near, HEIGHTS) - design.geometry.platform_joint_height
    placed = [replace(workspace, center=(x, y, float(z))) for z in heights]
    robots = [design.geometry] * len(placed)
    margins = reach_margins(robots, spans(robots, placed, theta))
    return placed[int(np.argmax(margins.min(axis=1)))]


@of_design
@kept(16)
def buildability(
    design: Design, workspace: Workspace, theta: Range, *, progress: Progress = go_on
) -> Buildability:
    """Return whether a robot can be built as it is drawn, and how stiff it is.

    It is kept: a search, its prices and its report ask for the same reference again.

    Args:
        design: The robot.
        workspace: The workspace, its height known.
        theta: Least and largest heading [rad].
        progress: Called while extremes are looked for.

    Raises:
        Canceled: If ``progress`` ends it.
    """
    extent, geometry = Extent(workspace, theta), design.geometry
    pose = extent.random(RANDOM)
    reach = check_reach(geometry, pose).ok
    overlaps = clearance(design, pose[reach]).least < 0

    def least(quantity: str, starts: int, before: int) -> tuple[float, Array]:
        def values(poses: Array) -> Valued:
            found = OVER_POSES[quantity](design, poses)
            return found._replace(
                value=np.where(check_reach(geometry, poses).ok, found.value, np.inf)
            )

        density = SPARSE.finer(2 if starts > 2 else 1)
        part = of_part(progress, before / 3, (before + 1) / 3)
        found = least_over(values, extent, density, starts=starts, progress=part)
        # rounding is no overlap
        value = round(found.value, 9) + 0.0 if np.isfinite(found.value) else np.nan
        return value, found.pose

    apart, worst = least("clearance", 6, 0)
    bodies = ("", "")
    if np.isfinite(apart):
        found = clearance(design, worst)
        bodies = found.pairs[int(found.pair)]
    ranges = spans([geometry], [workspace], theta)
    k = np.array([geometry.magnification])
    x, y, z = (float(place or 0.0) for place in workspace.center)
    shaft = needed_shaft(design, ranges.zeta_most, k)
    return Buildability(
        center=(x, y, z),
        within_reach=float(reach.mean()),
        clearance=apart,
        bodies=bodies,
        worst=worst,
        overlapping=float(overlaps.mean()) if len(overlaps) else float("nan"),
        stiffness=least("stiffness_horizontal", 4, 1)[0],
        frequency=least("frequency_1", 1, 2)[0],
        guide=geometry.guide_link_length,
        needed_guide=float(needed_guide(ranges.rho_most / (k - 1), geometry.body_scale)[0]),
        shaft=geometry.shaft_length,
        needed_shaft=float(shaft[0]),
        moving_mass=legs_and_platform(mass_vector(design), design),
    )
