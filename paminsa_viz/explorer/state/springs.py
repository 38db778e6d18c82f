"""Springs next to the design: where they are, and their fit."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum

from paminsa_viz.balancing import (
    SpringFit,
    SpringPlace,
    at_joint,
    on_guide,
    on_slider,
)
from paminsa_viz.explorer.state.outcome import TaskState
from paminsa_viz.explorer.state.plane import PlaneJob
from paminsa_viz.explorer.state.settings import MILLIMETERS, Settings, followed, setting
from paminsa_viz.model import Geometry, InvalidInput
from paminsa_viz.model.resizing import length_ratio

LENGTHS = (0.0, 1.0)
"""Shortest and longest free length [m]."""

HEIGHTS = (1e-4, 1.0)
"""Lowest and highest mast or post [m]."""


class SpringsFrom(Enum):
    """Where the springs start; they end at joint 9 of their leg."""

    SLIDER = "mast on slider 8"
    GUIDE = "post on guide link"


@dataclass(frozen=True)
class SpringSettings(Settings):
    """Where springs are; ``least`` and ``most`` are the range of their free length [m]."""

    start: SpringsFrom = setting(
        SpringsFrom.SLIDER, "Springs from",
        "One on each leg, to the knee 9. A mast on slider 8 travels along the guide; with a "
        "free length of zero its spring balances exactly",
    )  # fmt: skip
    height: float = setting(
        0.1, "Height [mm]", "Of the mast or post, above the guides", range=HEIGHTS,
        unit=MILLIMETERS,
    )  # fmt: skip
    radius: float = setting(
        0.05, "Radius [mm]", "Of the post, from the leg axis toward the platform", range=LENGTHS,
        unit=MILLIMETERS,
    )  # fmt: skip
    least: float = setting(0.0, "Free length [mm]", range=LENGTHS, unit=MILLIMETERS)
    most: float = setting(0.0, "Free length [mm]", range=LENGTHS, unit=MILLIMETERS)

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.least > self.most:
            raise InvalidInput("free length", "its range has to end above where it starts")

    @property
    def place(self) -> SpringPlace:
        """The anchors and ranges of the fit."""
        slider = self.start is SpringsFrom.SLIDER
        first = on_slider(self.height) if slider else on_guide(self.radius, self.height)
        return SpringPlace(
            first, at_joint(9), min_free_length=self.least, max_free_length=self.most
        )


def sized_springs(settings: SpringSettings, was: Geometry, now: Geometry) -> SpringSettings:
    """Return places that follow the robot's lengths, but for those that a person has chosen."""
    powers = {"height": (1, HEIGHTS), "radius": (1, LENGTHS)}
    return followed(settings, SpringSettings(), powers, length_ratio(was), length_ratio(now))


@dataclass(frozen=True)
class SpringsState(TaskState[PlaneJob, SpringFit]):
    """The springs of a session: their fit and its settings."""

    settings: SpringSettings = field(default_factory=SpringSettings)
