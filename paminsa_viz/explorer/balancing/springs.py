"""Springs next to the design: where they are, their fit, and what the actuators hold with them.

Springs are no part of a design: all else on the page is of the robot without them.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from typing import TYPE_CHECKING

from paminsa_viz.balancing import (
    SpringFit,
    SpringPlace,
    at_joint,
    fit_springs,
    on_guide,
    on_slider,
    spring_torques,
)
from paminsa_viz.explorer import tasks
from paminsa_viz.explorer.balancing.plane import PlaneJob
from paminsa_viz.explorer.settings import MILLIMETERS, Settings, setting
from paminsa_viz.explorer.tasks import TaskState
from paminsa_viz.model import InvalidInput
from paminsa_viz.model.arrays import Array

if TYPE_CHECKING:
    from paminsa_viz.explorer.state import State

CELLS = 41
"""Poses along each side of the map that springs are fitted on."""

LENGTHS = (0.0, 1.0)
"""Shortest and longest free length [m]."""


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
        0.1, "Height [mm]", "Of the mast or post, above the guides", range=(0.005, 1.0),
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


@dataclass(frozen=True)
class Springing(TaskState[PlaneJob, SpringFit]):
    """The springs of a session: their fit and its settings."""

    settings: SpringSettings = field(default_factory=SpringSettings)


def wanted(state: State) -> PlaneJob:
    """Return the fit of the current state."""
    return PlaneJob.of(state, state.springing.settings)


def start(state: State) -> State:
    """Start the fit of the current state."""
    return tasks.start(state, "springing", wanted(state))


def clear(state: State) -> State:
    """Forget the springs."""
    return state.updated("springing", running=None, outcome=None)


def fit(job: PlaneJob, _: object) -> SpringFit:
    """Fit the springs.

    Raises:
        PaminsaError: If there are none, or no pose to fit them on.
    """
    return fit_springs(job.design, [job.settings.place], job.poses(CELLS))


def relieved(state: State, torques: Array) -> Array | None:
    """Return static torques at the last reachable pose with the springs, (4,) [N m, N].

    Args:
        state: The state; its springs may have been fitted to another design.
        torques: The same without springs.

    Returns:
        None without springs.
    """
    found, last = state.springing.result, state.last_reachable
    if found is None:
        return None
    return torques + spring_torques(last.geometry, found.springs, last.pose)
