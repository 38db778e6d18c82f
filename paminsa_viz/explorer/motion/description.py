"""What motion a person has asked for, as plain numbers; `planning` makes a trajectory of it."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import Enum

from paminsa_viz.trajectory import PRESETS, MotionLimits, Profile, Trajectory

Pose = tuple[float, float, float, float]
"""(x, y, theta, z) [m, m, rad, m]."""

MOST_WAYPOINTS = 40

DURATIONS = (0.05, 600.0)
"""Shortest and longest duration that can be asked for [s]."""

RATES = (50.0, 10_000.0)
"""Lowest and highest rate of samples that can be asked for [1/s]."""

MOST_SAMPLES = 20_000
"""Samples of one motion on the page; a longer motion is sampled less often."""


class Kind(Enum):
    """How a motion is made."""

    PRESET = "preset"
    MOVE = "move"
    LINE = "line"
    ARCH = "arch"
    WAYPOINTS = "waypoints"
    CIRCLE = "circle"
    TABLE = "table"

    @property
    def has_ends(self) -> bool:
        """Whether it runs from one pose to another."""
        return self in (Kind.MOVE, Kind.LINE, Kind.ARCH)

    @property
    def has_law(self) -> bool:
        """Whether a time law can be chosen for it."""
        return self.has_ends or self is Kind.CIRCLE


class Timing(Enum):
    """What decides on the duration of a planned motion."""

    OWN = "its own"
    """The preset's own duration; other motions take `Motion.duration`."""
    GIVEN = "given"
    SHORTEST = "shortest"


DEFAULT_LIMITS = MotionLimits(
    speed=1.0,
    turn_speed=math.radians(360.0),
    acceleration=10.0,
    turn_acceleration=math.radians(3600.0),
    torque=6.0,
    force=400.0,
)
"""Limits to begin with, within what Appendix 4's robot can do; none of them is the paper's."""


@dataclass(frozen=True)
class Motion:
    """A motion of the platform. Numbers of a kind that is not chosen are kept, not used.

    Attributes:
        kind: How it is made.
        preset: Key of the preset.
        start, goal: Ends of a move, a line (which keeps theta) or an arch; None for ends beside
            the middle of the workspace.
        height: How far an arch rises [m].
        waypoints: Poses to pass.
        center: Pose of a circle's center, or None for the middle of the workspace.
        radius: Of the circle [m].
        profile: Time law.
        timing: What decides on the duration.
        duration: The given duration [s].
        limits: What the shortest duration keeps.
        back: Whether the motion is followed by itself run backwards.
        table: Samples from a file; compared by identity.
        rate: Samples a second [1/s].
    """

    kind: Kind = Kind.PRESET
    preset: str = PRESETS[0].key
    start: Pose | None = None
    goal: Pose | None = None
    height: float = 0.1
    waypoints: tuple[Pose, ...] = ()
    center: Pose | None = None
    radius: float = 0.1
    profile: Profile = Profile.QUINTIC
    timing: Timing = Timing.OWN
    duration: float = 1.5
    limits: MotionLimits = field(default=DEFAULT_LIMITS)
    back: bool = False
    table: Trajectory | None = None
    rate: float = 1000.0
