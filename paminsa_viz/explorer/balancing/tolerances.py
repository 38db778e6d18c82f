"""A balance within tolerances: of masses at a pose, of lengths on the map."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

from paminsa_viz.balancing.tolerance import (
    LengthTolerance,
    MassTolerance,
    length_tolerance,
    mass_tolerance,
)
from paminsa_viz.model import Design, PaminsaError
from paminsa_viz.model.singular_limit import counting
from paminsa_viz.plots.map_data import workspace_field

CELLS = 21
"""Poses along each side of the map that lengths are looked at on."""

ROBOTS = 200
"""Robots that are drawn."""

MASSES, LENGTHS = (0.0, 0.5), (0.0, 0.1)
"""Relative tolerances that can be set."""


@dataclass(frozen=True)
class ToleranceSettings:
    """Relative tolerances, each even to both sides.

    Attributes:
        mass: Of the masses of joints, links and counterweights.
        length: Of the lengths that static torques depend on.
    """

    mass: float = 0.02
    length: float = 0.001

    @property
    def possible(self) -> bool:
        """Whether the page can set both."""
        (low, high), (least, most) = MASSES, LENGTHS
        return low <= self.mass <= high and least <= self.length <= most


@dataclass(frozen=True)
class LengthJob:
    """A sample of robots with all it depends on.

    Attributes:
        design: The robot.
        theta, z: The plane of the poses, that of the maps [rad, m].
        length: Relative tolerance.
        condition_limit: Largest condition number of a pose that counts.
    """

    design: Design
    theta: float
    z: float
    length: float
    condition_limit: float


@dataclass(frozen=True, eq=False)
class LengthOutcome:
    """What came of a sample, or why there is none."""

    job: LengthJob
    found: LengthTolerance | None
    problem: str = ""


@dataclass(frozen=True)
class Tolerating:
    """Tolerances of a session: what was set, what runs, and the last result."""

    settings: ToleranceSettings = ToleranceSettings()
    running: LengthJob | None = None
    outcome: LengthOutcome | None = None


@lru_cache(maxsize=4)
def of_masses(design: Design, pose: tuple[float, ...], mass: float) -> MassTolerance:
    """Return the spread of M_p2 and of the torques at a pose from the tolerance of masses."""
    return mass_tolerance(replace(design, name=""), mass, pose)


def run(job: LengthJob) -> LengthOutcome:
    """Draw robots; raises nothing that is the robot's or the person's fault."""
    try:
        field = workspace_field(job.design.geometry, job.theta, job.z, CELLS)
        poses = field.grid.poses()[counting(field, job.condition_limit)]
        return LengthOutcome(
            job, length_tolerance(job.design, job.length, poses, samples=ROBOTS)
        )  # fmt: skip
    except PaminsaError as error:
        return LengthOutcome(job, None, str(error))
