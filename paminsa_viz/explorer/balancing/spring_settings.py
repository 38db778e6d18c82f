"""Springs next to the design, as plain data: where they are, the fit that runs, what came of it."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum

from paminsa_viz.balancing import SpringFit, SpringPlace, at_joint, on_guide, on_slider
from paminsa_viz.model import Design

HEIGHTS = (0.005, 1.0)
"""Lowest and highest mast or post [m]."""

LENGTHS = (0.0, 1.0)
"""Shortest and longest free length [m]."""


class SpringsFrom(Enum):
    """Where the springs start; they end at joint 9 of their leg."""

    SLIDER = "mast on slider 8"
    GUIDE = "post on guide link"


@dataclass(frozen=True)
class SpringSettings:
    """What a person set.

    Attributes:
        start: Where the springs start.
        height: Of the mast or post, above the guides [m].
        radius: Of the post, from the leg axis toward the platform [m].
        least, most: Range of the free length [m].
    """

    start: SpringsFrom = SpringsFrom.SLIDER
    height: float = 0.1
    radius: float = 0.05
    least: float = 0.0
    most: float = 0.0

    @property
    def possible(self) -> bool:
        """Whether the page can set all of it."""
        (lowest, highest), (shortest, longest) = HEIGHTS, LENGTHS
        lengths = (self.radius, self.least, self.most)
        return lowest <= self.height <= highest and all(
            shortest <= length <= longest for length in lengths
        )

    @property
    def place(self) -> SpringPlace:
        """The anchors and ranges of the fit."""
        slider = self.start is SpringsFrom.SLIDER
        first = on_slider(self.height) if slider else on_guide(self.radius, self.height)
        return SpringPlace(
            first, at_joint(9), min_free_length=self.least, max_free_length=self.most
        )


@dataclass(frozen=True, eq=False)
class SpringJob:
    """A fit with all it depends on.

    Attributes:
        design: The robot.
        theta, z: The plane of the poses, that of the maps [rad, m].
        settings: Where the springs are.
        condition_limit: Largest condition number of a pose that counts.
    """

    design: Design
    theta: float
    z: float
    settings: SpringSettings
    condition_limit: float

    def same(self, other: SpringJob) -> bool:
        """Whether another job has the same result."""
        return vars(self) == vars(other)


@dataclass(frozen=True, eq=False)
class SpringOutcome:
    """What came of a fit: the springs, or why there are none."""

    job: SpringJob
    fit: SpringFit | None
    problem: str = ""


@dataclass(frozen=True)
class Springing:
    """The springs of a session.

    Attributes:
        settings: What a person set.
        running: The fit that runs, or None.
        outcome: The last result, or None.
    """

    settings: SpringSettings = field(default_factory=SpringSettings)
    running: SpringJob | None = None
    outcome: SpringOutcome | None = None
